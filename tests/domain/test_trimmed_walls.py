"""Passages of trimmed walls: the ring, equal volumes, holes, periodic boundaries, derivatives, refusals."""

from functools import cache

import numpy as np
import pytest
import random_parts

from bladewright.blade.design.fillet import Fillet
from bladewright.domain.build import passage
from bladewright.domain.skin import wall_face
from bladewright.errors import DesignError
from bladewright.nurbs.closest import closest_on_curve
from bladewright.nurbs.trimmed import TrimmedSurface
from machines import COARSE, built, example
from machines.passages import passage_case

NAMES = ("rotor", "cascade", "impeller with a gap", "wedge diffuser")


@cache
def trimmed(name):
    case = passage_case(name)
    return passage(case.blade, walls="trimmed", **case.asked)


@pytest.fixture(params=NAMES)
def made(request):
    return trimmed(request.param)


@cache
def filleted():
    design = example("nasa-rotor-67").changed({"hub_fillet": Fillet(radius=3.0), "tolerance": COARSE})
    return passage(design.build())


def crowded():
    """A cascade so close that each stout blade stands in its neighbour's half of the pitch."""
    design = passage_case("cascade").blade.design
    upper = design.thickness_upper
    stout = tuple(2.0 * value if 1 < i < len(upper) - 1 else value for i, value in enumerate(upper))
    return built(design.changed({"thickness_upper": stout, "pitch": 38.0}))


def test_each_wall_is_one_face_with_the_blades_end_as_a_hole(made):
    for wall in ("hub", "shroud"):
        face = made.surfaces[wall]
        assert isinstance(face, TrimmedSurface)
        assert len(face.holes) == (1 if wall in made.blade.surfaces else 0)
        for hole in face.holes:
            points = np.concatenate([face.surface(*curve(np.linspace(*curve.domain, 101)).T) for curve in hole])
            away = [closest_on_curve(edge, points).distances for edge in made.blade.end_outline(wall)]
            # the outline lies as far off the wall, 1e-7 of the chord, as the blade may
            assert np.max(np.min(away, axis=0)) < 1.1e-7 * made.blade.chord


def test_passages_and_blades_fill_the_ring(made):
    assert abs(made.ring_error) < 1e-8
    assert made.wall_error < 1e-7
    assert made.properties.openness < 1e-9


@pytest.mark.parametrize("name", NAMES)
def test_the_volume_is_that_of_the_passage_with_untrimmed_walls(name):
    other = passage_case(name).passage
    assert (trimmed(name).knots.low, trimmed(name).knots.high) == (other.knots.low, other.knots.high)
    assert trimmed(name).properties.volume == pytest.approx(other.properties.volume, rel=1e-7)
    np.testing.assert_allclose(
        trimmed(name).properties.centroid, other.properties.centroid, rtol=0, atol=1e-6 * other.blade.chord
    )


def test_periodic_boundaries_are_one_pitch_apart_and_end_in_the_rims(made):
    lower, upper = (made.surfaces[f"periodic_{half}"].control_points for half in ("lower", "upper"))
    x, y, z = np.moveaxis(lower, -1, 0)
    by = 2.0 * float(made.half_pitch)
    turned = (x, y * np.cos(by) + z * np.sin(by), z * np.cos(by) - y * np.sin(by))
    moved = np.stack(turned if made.duct.revolved else (x, y + by, z), axis=-1)
    np.testing.assert_allclose(upper, moved, rtol=0, atol=1e-12 * np.ptp(lower.reshape(-1, 3), axis=0).max())
    for end, name in ((0, "inlet"), (-1, "outlet")):
        np.testing.assert_array_equal(made.surfaces[name].control_points[0], lower[end])
        np.testing.assert_array_equal(made.surfaces[name].control_points[-1], upper[end])


def test_rims_are_circles_about_the_axis():
    rim = trimmed("rotor").surfaces["inlet"].grid(np.linspace(0.0, 1.0, 33), np.array([0.0, 0.4, 1.0]))
    radius = np.hypot(rim[..., 1], rim[..., 2])
    np.testing.assert_allclose(radius, radius[:1] + 0.0 * radius, rtol=1e-14)
    np.testing.assert_allclose(rim[..., 0], rim[:1, :, 0] + 0.0 * radius, rtol=0, atol=1e-16)


def test_a_wall_between_two_places_is_a_part_of_the_whole():
    skin = trimmed("rotor").skin
    start, end = skin.places("hub")
    middle = start + 0.3 * (end - start)
    whole = wall_face(skin, "hub", hole=False).parametric_area
    parts = [wall_face(skin, "hub", *ends, hole=False).parametric_area for ends in ((None, middle), (middle, None))]
    assert sum(parts) == pytest.approx(whole, rel=1e-10)
    ahead, behind = skin.rim("hub", middle, 1), skin.rim("hub", middle, 0)
    np.testing.assert_array_equal(ahead.control_points, behind.control_points)


def test_a_blade_that_reaches_past_its_camber_lines_pitch_gets_a_passage():
    made = passage(crowded())
    assert made.knots.walls == "trimmed"
    assert made.knots.shift is not None
    assert abs(made.ring_error) < 1e-8


def test_extents_shorten_where_a_wall_would_wind_more_than_a_turn():
    blade = built(example("pump-inducer").changed("tolerance", COARSE))
    made = passage(blade, walls="trimmed")
    assert made.knots.upstream < blade.exact.meridional_extent.path_end(0)
    assert abs(made.ring_error) < 1e-8
    with pytest.raises(DesignError, match=r"winds 3\d\d deg around the axis at the shroud"):
        passage(blade, walls="trimmed", upstream=0.8, downstream=0.8)


def test_fillets_are_faces_of_the_passage_and_their_foot_is_the_hole():
    made = filleted()
    assert {"blade_hub_fillet_upper", "blade_hub_fillet_lower"} < set(made.surfaces)
    assert abs(made.ring_error) < 1e-8
    assert made.properties.openness < 1e-9
    with pytest.raises(DesignError, match=r"walls is 'patches', and the blade has a cut or fillets"):
        passage(made.blade, walls="patches")


def test_a_fillet_is_no_cut_of_the_walls():
    design = example("nasa-rotor-67").changed({"hub_fillet": Fillet(radius=2.0), "tolerance": COARSE})
    skin = passage(design.build()).skin
    assert not any(skin.is_cut(wall) for wall in ("hub", "shroud"))


def test_held_knots_give_the_same_passage():
    first = trimmed("rotor")
    again = passage(first.blade, knots=first.knots)
    for name in ("periodic_upper", "inlet"):
        np.testing.assert_array_equal(again.surfaces[name].control_points, first.surfaces[name].control_points)
    with pytest.raises(DesignError, match=r"walls is 'patches', but the knots given hold 'trimmed'"):
        passage(first.blade, knots=first.knots, walls="patches")


def test_what_is_no_kind_of_wall_is_refused():
    with pytest.raises(DesignError, match=r"walls is 'paper': choose 'auto', 'patches', 'trimmed'"):
        passage(trimmed("rotor").blade, walls="paper")


@pytest.mark.parametrize(
    ("name", "path"), [pytest.param("rotor", "stagger[4]", marks=pytest.mark.slow), ("cascade", "pitch")]
)
def test_poles_and_volumes_follow_the_parameters(name, path):
    """By the complex step against central differences at held knots."""
    made = trimmed(name)
    design, asked = made.blade.design, passage_case(name).asked

    def figures(value):
        blade = design.changed(path, value).build(knots=made.blade.knots)
        again = passage(blade, knots=made.knots, **asked)
        poles = [again.surfaces[each].control_points.ravel() / 0.1 for each in ("periodic_upper", "inlet")]
        return np.concatenate([*poles, np.atleast_1d(again.properties.volume / float(made.properties.volume))])

    value = design.parameters()[path]
    exact = np.imag(figures(value + 1e-30j)) / 1e-30

    def difference(h):
        return (figures(value + h) - figures(value - h)) / (2.0 * h)

    # Richardson's step leaves an error of the fourth power of the step, and rounding over it
    found = (4.0 * difference(1e-3) - difference(2e-3)) / 3.0
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-6 * np.max(np.abs(exact)))


def test_passages_fill_the_ring_where_the_middle_surface_twists_by_half_a_turn():
    made = passage(random_parts.random_design(389).plain.build())
    edge = (
        made.surfaces["inlet"](np.linspace(0.0, 1.0, 101), 0.5),
        made.surfaces["inlet"](0.5, np.linspace(0.0, 1.0, 101)),
    )
    twist = [np.ptp(np.unwrap(np.arctan2(line[:, 1], line[:, 2]))) for line in edge]
    assert max(twist) > np.pi
    assert abs(made.ring_error) < 1e-8
