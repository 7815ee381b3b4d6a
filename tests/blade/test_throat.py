"""The throat between neighbouring blades: closed forms, an independent search, its derivative."""

from dataclasses import replace

import numpy as np
import pytest

import bladewright as bw
from bladewright.blade.native.throat import throat
from bladewright.designs import unit_at
from bladewright.errors import DesignError
from machines.unified import CASCADE, FAN, IMPELLER


@pytest.mark.parametrize("design", [FAN, IMPELLER, CASCADE], ids=lambda design: design.name)
def test_no_two_points_of_neighbouring_outlines_are_closer(design):
    blade = design.build()
    found = throat(blade)
    s = np.concatenate([np.linspace(0.0, 0.1, 60), np.linspace(0.1, 0.9, 240), np.linspace(0.9, 1.0, 60)])
    pitch = 2.0 * np.pi / design.blade_count if design.blade_count else design.pitch * 1e-3
    for i in range(0, len(found.v), 7):
        outline = np.concatenate([side(s, found.v[i]) for side in blade.sides])
        x, y, z = outline.T
        if design.blade_count:
            y, z = y * np.cos(pitch) + z * np.sin(pitch), z * np.cos(pitch) - y * np.sin(pitch)
        else:
            y = y + pitch
        gaps = np.linalg.norm(np.stack([x, y, z], axis=-1)[None] - outline[:, None], axis=-1)
        # the samples stand some 0.4 % of the chord apart, and miss the least by a part of that squared
        assert found.width[i] <= gaps.min() * (1.0 + 1e-12)
        assert found.width[i] == pytest.approx(gaps.min(), rel=1e-3)


def test_both_ends_lie_on_outlines_and_across_them():
    blade = FAN.build()
    found = throat(blade)
    own, neighbour = found.ends
    assert np.linalg.norm(neighbour - own, axis=-1) == pytest.approx(found.width, rel=1e-14)
    on_upper = found.places[0] > 1.0
    assert on_upper.all()
    u, v = 2.0 - found.places[0], found.v
    upper = blade.surfaces["upper"]
    assert upper(u, v) == pytest.approx(own, abs=1e-15)
    slope = upper.derivative(u, v)
    across = np.einsum("ij,ij->i", slope, neighbour - own) / np.linalg.norm(slope, axis=-1) / found.width
    assert across == pytest.approx(np.zeros(len(v)), abs=1e-10)


def test_the_throat_of_a_prismatic_cascade_is_its_width_times_its_height():
    flat = replace(
        CASCADE,
        leading_edge_y=0.0,
        stagger=-35.0,
        metal_angle_in=20.0,
        channel=replace(
            CASCADE.channel,
            leading_edge=((0.0, 0.0), (0.0, 80.0)),
            trailing_edge=((60.0, 0.0), (60.0, 80.0)),
            hub=(),
            shroud=(),
        ),
    )
    found = throat(flat.build())
    assert np.ptp(found.width) < 1e-14
    assert found.area == pytest.approx(0.08 * found.width[0], rel=1e-12)


@pytest.mark.parametrize("design", [FAN, CASCADE], ids=lambda design: design.name)
def test_the_throat_grows_with_the_square_of_all_lengths(design):
    lengths = [path for path in design.parameters() if unit_at(design, path) == "length"]
    knots = design.build().knots
    found = bw.sensitivity(design, lambda blade: throat(blade).area, free=lengths, knots=knots)
    total = sum(found[path] * design.parameters()[path] for path in lengths)
    assert total == pytest.approx(2.0 * throat(design.build(knots=knots)).area, rel=1e-9)


def test_a_pitch_that_grows_opens_the_throat_along_it():
    # by the envelope theorem: dw / d pitch is the tangential part of the unit vector from blade to neighbour
    found = bw.sensitivity(CASCADE, lambda blade: throat(blade).width, free="pitch")["pitch"]
    now = throat(CASCADE.build())
    across = (now.ends[1] - now.ends[0]) / now.width[:, None]
    assert found == pytest.approx(1e-3 * across[:, 1], abs=1e-12)


def test_a_single_blade_has_no_throat():
    with pytest.raises(DesignError, match="blade_count is 1: a throat lies between two blades"):
        throat(FAN.changed("blade_count", 1).build())
