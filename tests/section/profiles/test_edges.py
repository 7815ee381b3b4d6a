"""Edges of profiles that are laid around a mean line."""

from dataclasses import replace

import numpy as np
import pytest

from bladewright.errors import DesignError
from bladewright.section.laws import Span
from bladewright.section.profiles.c4 import C4
from bladewright.section.profiles.naca4 import Naca4
from bladewright.section.profiles.naca5 import Naca5
from bladewright.section.profiles.naca6 import Naca6
from bladewright.section.profiles.naca65 import Naca65

SPAN = Span(np.zeros(1))
ROUND = [
    Naca4(thickness=0.12, camber=0.04, camber_position=0.4, trailing_edge="round"),
    Naca5(thickness=0.1, trailing_edge="round", trailing_edge_thickness=0.1),
    C4(thickness=0.1, camber_angle=30.0, trailing_edge="round"),
    Naca65(thickness=0.08, lift_coefficient=0.8, trailing_edge="round"),
]


def radius(start):
    first, second = start.first[0], start.second[0]
    speed = np.linalg.norm(first)
    return speed**3 / abs(first[0] * second[1] - first[1] * second[0])


def test_the_leading_edge_of_naca_0012_has_the_published_radius():
    start = Naca4(thickness=0.12).outline(SPAN).leading_edge.upper
    assert radius(start) == pytest.approx(1.1019 * 0.12**2, rel=1e-4)  # five digits of 1.1019


@pytest.mark.parametrize("profile", ROUND, ids=lambda profile: profile.kind)
def test_a_round_trailing_edge_has_half_the_thickness_as_radius(profile):
    blunt = profile.changed("trailing_edge", "blunt").outline(SPAN).trailing_edge
    thickness = np.linalg.norm(blunt.upper.point - blunt.lower.point)
    assert radius(profile.outline(SPAN).trailing_edge.upper) == pytest.approx(0.5 * thickness, rel=1e-10)


def test_a_round_trailing_edge_takes_from_the_blunt_profile_at_its_very_end_only():
    profile = Naca4(thickness=0.12, trailing_edge="round")
    half = 0.5 * 0.021 * 0.12
    table = np.linspace(0.0, 1.0, 4001)
    blunt = profile.changed("trailing_edge", "blunt").outline(SPAN).points(table)[0][0]
    capped = profile.outline(SPAN).points(table)[0][0]
    x = np.linspace(0.05, 1.0 - 3.2 * half, 400)
    # both from a table of straight pieces
    before, after = (np.interp(x, points[:, 0], points[:, 1]) for points in (blunt, capped))
    assert after == pytest.approx(before, rel=1e-3)
    assert np.interp(1.0 - half, capped[:, 0], capped[:, 1]) < 0.95 * np.interp(1.0 - half, blunt[:, 0], blunt[:, 1])


@pytest.mark.parametrize("share", [0.01, 0.021, 0.2])
def test_a_blunt_trailing_edge_is_as_thick_as_asked(share):
    edge = Naca4(thickness=0.1, trailing_edge="blunt", trailing_edge_thickness=share).outline(SPAN).trailing_edge
    assert np.linalg.norm(edge.upper.point - edge.lower.point) == pytest.approx(0.1 * share, rel=1e-12)


@pytest.mark.parametrize(
    "closed",
    [
        Naca4(thickness=0.12),
        Naca5(thickness=0.1, design_lift=0.0),
        C4(thickness=0.1),
        Naca65(thickness=0.1),
        Naca6(series="64", thickness=0.1),
    ],
    ids=lambda profile: profile.kind,
)
@pytest.mark.parametrize(("opening", "power"), [("linear", 1), ("quartic", 4)])
def test_an_edge_is_opened_by_its_power_of_x(closed, opening, power):
    share = 0.3
    table, x = np.linspace(0.0, 1.0, 4001), np.linspace(0.05, 0.95, 50)

    def half(profile):
        upper, lower = (side[0] for side in profile.outline(SPAN).points(table))
        # from a table of straight pieces
        return 0.5 * (np.interp(x, upper[:, 0], upper[:, 1]) - np.interp(x, lower[:, 0], lower[:, 1]))

    straight = closed.changed("camber_angle", 0.0) if isinstance(closed, C4) else closed
    blunt = replace(straight, trailing_edge="blunt", trailing_edge_thickness=share, trailing_edge_opening=opening)
    added = half(blunt) - half(straight)
    assert added == pytest.approx(0.5 * share * closed.thickness * x**power, abs=2e-6)


def test_what_contradicts_is_refused():
    with pytest.raises(DesignError, match=r"trailing_edge_opening is 'linear' and trailing_edge is 'sharp'"):
        Naca4(thickness=0.1, trailing_edge_opening="linear")
    with pytest.raises(DesignError, match=r"trailing_edge_opening is 'straight'"):
        Naca4(thickness=0.1, trailing_edge="blunt", trailing_edge_opening="straight")
    with pytest.raises(DesignError, match=r"trailing_edge is 'sharp', which has none"):
        Naca4(thickness=0.1, trailing_edge_thickness=0.02)
    with pytest.raises(DesignError, match=r"camber_position is missing"):
        Naca4(thickness=0.1, camber=0.02)
    with pytest.raises(DesignError, match=r"thickness is 0.5"):
        C4(thickness=0.5)
    with pytest.raises(DesignError, match=r"trailing_edge is 'rounded'.*did you mean 'round'"):
        C4(thickness=0.1, trailing_edge="rounded")


@pytest.mark.parametrize("position", [0.1, 0.4, 0.7])
def test_the_joint_of_a_mean_line_stands_at_the_same_s_whatever_its_place(position):
    profile = Naca4(thickness=0.12, camber=0.03, camber_position=position)
    outline = profile.outline(SPAN)
    (joint,) = outline.joints
    assert outline.camber(np.array([joint.s]))[0, 0] == pytest.approx([position, 0.03], abs=1e-14)
