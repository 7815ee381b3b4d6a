"""Nearest places on both sides, against the certified global search."""

from functools import cache

import numpy as np
import pytest

from bladewright.fitting.matching.footpoints import footpoints_at, nearest_footpoints
from bladewright.fitting.models.model import sides_of
from bladewright.nurbs.closest import Descents, closest_on_curve, closest_on_surface
from machines import example
from machines.sections import EXAMPLES


@cache
def sides(name):
    built = example(name).build()
    return built.sides if hasattr(built, "sides") else (built.curves["upper"], built.curves["lower"])


@cache
def cloud(name):
    """Off both sides by up to a fiftieth of the extent, a third of it around the leading edge, and beyond the ends."""
    random = np.random.default_rng(1)
    u = np.concatenate([random.random(40), 0.01 * random.random(20), 1.0 - 0.01 * random.random(8)])
    plane = name == "turbine-section"
    found = [side(u) if plane else side(u, random.random(len(u))) for side in sides(name)]
    points = np.concatenate(found)
    extent = np.max(np.ptp(points, axis=0))
    points = points + 0.02 * extent * random.uniform(-1.0, 1.0, points.shape)
    if not plane:
        # past the ends, along the direction in which the sides end
        for side in sides(name):
            for end, sign in ((0.0, -1.0), (1.0, 1.0)):
                v = np.full(4, end)
                points = np.concatenate([points, side(u[:4], v) + 0.05 * sign * side.derivative(u[:4], v, 0, 1)])
    return points, extent


def certified(name):
    points, _ = cloud(name)
    if name == "turbine-section":
        return np.min([closest_on_curve(side, points).distances for side in sides(name)], axis=0)
    return np.min([closest_on_surface(side, points, tolerance=1e-8).distances for side in sides(name)], axis=0)


@pytest.mark.parametrize("name", ["turbine-section", "compressor-stator"])
def test_distances_are_those_of_the_certified_search(name):
    points, extent = cloud(name)
    on = nearest_footpoints(points, sides(name))
    # what the certified search may pass over, of the extent of the control points
    np.testing.assert_allclose(on.distances, certified(name), atol=2e-8 * extent)
    # both sides are nearest to some, also at the leading edge
    assert set(on.side[on.u < 0.01]) == {0, 1}


def test_places_beside_thin_edges_are_their_own_feet():
    name = "mixed-flow-pump"
    random = np.random.default_rng(6)
    u, v = random.random((2, 1500))
    places = np.concatenate([side(1.0 - 0.1 * u, v) for side in sides(name)])
    # the other side is nearer there than the next sample of the own one may be
    found = nearest_footpoints(places, sides(name))
    # descents end with steps of 1e-8 of a patch
    assert np.max(found.distances) < 1e-8 * np.max(np.ptp(places, axis=0))


def test_places_that_descents_leave_deep_inside_are_found_on_the_face_of_a_blunt_edge():
    built, random = example("backswept-impeller").build(), np.random.default_rng(1)
    upper, lower = sides_of(built)
    u, v = 1.0 - 0.06 * random.random(3000) ** 2, random.random(3000)
    places = np.concatenate([side(u, v) for side in (upper, lower)])
    # descents from samples alone end on a side, up to 3e-3 of the chord off
    descents = Descents((upper, lower)).nearest(places)
    wrong = np.count_nonzero(np.sqrt(descents.square) > 1e-6 * built.chord)
    left = np.count_nonzero(nearest_footpoints(places, (upper, lower)).distances > 1e-6 * built.chord)
    assert wrong > 50
    # those that are less deep than a share of the thickness are left
    assert left < 0.05 * wrong


@pytest.mark.parametrize("name", ["turbine-section", "compressor-stator"])
def test_feet_from_a_hint_are_those_without_one(name):
    points, extent = cloud(name)
    random = np.random.default_rng(2)
    known = nearest_footpoints(points, sides(name))
    # as if the sides had moved a little; beside the edges a foot may have been on the other side
    u = np.clip(known.u + 0.005 * random.uniform(-1.0, 1.0, len(points)), 0.0, 1.0)
    v = np.clip(known.v + 0.005 * random.uniform(-1.0, 1.0, len(points)), 0.0, 1.0)
    side = np.where(known.u > 0.995, 1 - known.side, known.side)
    again = nearest_footpoints(points, sides(name), footpoints_at(points, sides(name), side, u, v))
    near = known.distances < 0.01 * extent
    assert np.count_nonzero(near) > 50
    np.testing.assert_allclose(again.distances[near], known.distances[near], atol=1e-9 * extent)


@pytest.mark.parametrize("name", ["turbine-section", "compressor-stator"])
def test_points_of_the_sides_are_their_own_feet(name):
    u, v = np.linspace(0.0, 1.0, 25), np.linspace(0.0, 1.0, 25)
    for number, side in enumerate(sides(name)):
        points = side(u) if name == "turbine-section" else side(u, v)
        on = nearest_footpoints(points, sides(name))
        np.testing.assert_allclose(on.points, points, atol=1e-10 * cloud(name)[1])
        assert set(on.side[1:-1]) == {number}


@pytest.mark.parametrize("name", ["turbine-section", "compressor-stator"])
def test_heights_are_positive_outside_on_both_sides(name):
    for number, side in enumerate(sides(name)):
        u = np.linspace(0.1, 0.9, 9)
        v = np.full(9, 0.5)
        at = side(u) if name == "turbine-section" else side(u, v)
        on = footpoints_at(at, sides(name), np.full(9, number), u, v)
        step = 1e-3 * cloud(name)[1]
        outside = nearest_footpoints(on.points + step * on.normals, sides(name))
        np.testing.assert_allclose(outside.heights, step, rtol=1e-6)
        other = sides(name)[1 - number]
        middle = other(u) if name == "turbine-section" else other(u, v)
        # the other side is inwards
        assert np.all(np.sum((middle - on.points) * on.normals, axis=-1) < 0.0)


def test_past_an_end_the_miss_points_away_from_the_blade():
    side = sides("compressor-stator")[0]
    u = np.linspace(0.2, 0.8, 5)
    for end, sign in ((0.0, -1.0), (1.0, 1.0)):
        v = np.full(5, end)
        on = nearest_footpoints(side(u, v) + 0.05 * sign * side.derivative(u, v, 0, 1), sides("compressor-stator"))
        assert np.all(on.v == end)
        np.testing.assert_allclose(np.sum(on.beyond**2, axis=-1), 1.0, rtol=1e-12)
        np.testing.assert_allclose(np.sum(on.beyond * on.normals, axis=-1), 0.0, atol=1e-12)
        assert np.all(np.sum(on.miss * on.beyond, axis=-1) > 0.0)
    within = nearest_footpoints(side(u, np.full(5, 0.5)), sides("compressor-stator"))
    assert not np.any(within.beyond)


@pytest.mark.parametrize("name", ["camber-angle-blunt", "double-circular-arc-sharp"])
def test_a_point_ahead_of_a_corner_is_as_high_as_it_is_far(name):
    on = sides_of(EXAMPLES[name].design.build())
    # along the sides ahead of their last corner, so far from the sides' own normals
    corner = 0.98 if name.endswith("blunt") else 1.0
    ends, before = (np.concatenate([side(np.array([at])) for side in on]) for at in (corner, corner - 0.03))
    ahead = ends + (ends - before)
    found = nearest_footpoints(ahead, on)
    np.testing.assert_allclose(found.heights, found.distances, rtol=1e-9)
    np.testing.assert_allclose(found.distances, np.sqrt(np.sum((ahead - ends) ** 2, axis=-1)), rtol=0.01)
