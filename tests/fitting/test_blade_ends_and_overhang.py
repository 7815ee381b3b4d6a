"""What a cloud says of a blade's ends and of its edges."""

from dataclasses import replace
from functools import cache

import matching_clouds
import numpy as np
import pytest

from bladewright.designs import Point
from bladewright.fitting.matching import blade_ends
from bladewright.fitting.matching.blade_ends import WallPoints, blade_ends_of, edge_overhang_of, outward_at_edges
from bladewright.fitting.matching.footpoints import footpoints_at, nearest_footpoints
from bladewright.fitting.matching.search import Task, evaluated
from bladewright.fitting.models.model import model_of
from machines import example

BLADE = "centrifugal-impeller"


@cache
def shape(name):
    design = example(name)
    model = model_of(design)
    return design, model, model.shape(design)


@cache
def made(seed):
    """A blade drawn at random, and 5,000 points of it."""
    design = matching_clouds.blade(seed)
    return design.build(), matching_clouds.cloud_of(design, seed).points


def sides_cloud(name, count, rows=0):
    """Points of both sides, and rows at both ends."""
    random = np.random.default_rng(5)
    _, _, found = shape(name)
    u, v = random.random(count), random.uniform(0.06, 0.94, count)
    parts = [side(u, v) for side in found.sides]
    along = np.linspace(0.05, 0.95, rows)
    return np.concatenate(parts + [side(along, np.full(rows, end)) for side in found.sides for end in (0.0, 1.0)])


def ends(name, points):
    _, _, found = shape(name)
    on = nearest_footpoints(points, found.sides)
    return blade_ends_of(points, on, found, np.ones(len(points), dtype=bool)), on


def test_rows_at_both_ends_lie_on_the_walls():
    points = sides_cloud(BLADE, 200, rows=20)
    found, _ = ends(BLADE, points)
    _, model, there = shape(BLADE)
    assert set(found.walls) == {"hub", "shroud"}
    for wall in found.walls.values():
        assert len(wall.places) >= 40
        # native sides follow the exact blade within 1e-6 of the chord
        assert np.max(np.abs(wall.located(there.exact)[2])) < 3e-6 * model.chord
        assert wall.spread < 1e-6 * model.chord
    assert not found.on_end_face.any()


def test_a_row_is_found_among_points_beside_it_where_its_wall_is_not_known_yet():
    design, model, there = shape(BLADE)
    random = np.random.default_rng(8)
    u, v = random.random((2, 500))
    u = (1.0 - np.cos(np.pi * u)) / 2.0
    # a third of the points at an end are of the sides alone, and not on the wall by as much as the wall is off
    scattered = [side(u, end + (1.0 - 2.0 * end) * 0.05 * v) for side in there.sides for end in (0.0, 1.0)]
    row = (1.0 - np.cos(np.pi * random.random(300))) / 2.0
    points = np.concatenate([*scattered, *(side(row, np.full(300, e)) for side in there.sides for e in (0.0, 1.0))])
    other = model.shape(
        design.changed(
            {f"channel.{name}[1].r": 1.01 * design.parameters()[f"channel.{name}[1].r"] for name in ("hub", "shroud")}
        )
    )
    found = blade_ends_of(points, nearest_footpoints(points, other.sides), other, np.ones(len(points), dtype=bool))
    for name in ("hub", "shroud"):
        off = found.walls[name].located(there.exact)[2]
        assert len(off) < 660
        assert np.count_nonzero(np.abs(off) < 3e-6 * model.chord) >= 600
        assert np.max(np.abs(found.walls[name].located(other.exact)[2])) > 3e-4 * model.chord


CROWDED = {
    "compressor-stator": [(7.7, 182.19), (21.1, 182.60), (30.9, 182.70), (35.6, 182.81), (39.7, 182.83)],
    BLADE: [(44.1, 33.3), (56.8, 45.1), (61.3, 53.8), (64.1, 64.3), (65.2, 70.1)],
}
"""points of a hub [mm] that is straight, and of one that turns by a right angle"""


@pytest.mark.parametrize("name", CROWDED)
def test_a_row_is_found_where_the_control_points_of_its_wall_crowd(name):
    design = replace(example(name), hub_clearance=None)
    model = model_of(design)
    crowded = tuple(Point(*place) for place in CROWDED[name])
    found = replace(design, channel=replace(design.channel, hub=crowded))
    other = model_of(found).shape(found)
    row = np.linspace(0.0, 1.0, 120)
    points = np.concatenate([side(row, np.full(120, e)) for side in model.shape(design).sides for e in (0.0, 1.0)])
    ends = blade_ends_of(points, nearest_footpoints(points, other.sides), other, np.ones(len(points), dtype=bool))
    wall = ends.walls["hub"]
    # so far off, the wall is no polynomial of its own parameter over the row, which is as smooth as native sides are
    assert np.max(np.abs(wall.located(other.exact)[2])) > 2e-3 * model.chord
    assert wall.spread < 1e-6 * model.chord


def test_ends_of_another_row_are_none_of_the_outermost():
    """A tip row and the ends of a row 38 mm below were met to 1e-10 m by a line across both."""
    design = example("propeller")
    points = matching_clouds.rows(design.build().sides)
    wrong = tuple(Point(*place) for place in [(-4.03, 954.3), (0.7, 947.7), (3.58, 947.83), (7.86, 952.68)])
    found = replace(design, channel=replace(design.channel, shroud=wrong))
    other = model_of(found).shape(found)
    ends = blade_ends_of(points, nearest_footpoints(points, other.sides), other, np.ones(len(points), dtype=bool))
    tip = np.max(np.hypot(*points[:, 1:].T))
    assert len(ends.walls["shroud"].places) == 160
    assert np.min(ends.walls["shroud"].places[:, 1]) > 0.999 * tip


def test_places_past_a_wall_s_continuation_are_off_it():
    """Its last normal leads past them, along which they were near."""
    exact = shape(BLADE)[2].exact
    wall, t = exact.wall("hub"), np.linspace(0.0, 1.0, 40)
    along = np.real(wall.values(np.array([1.1]), 1))[0]
    past = np.real(wall.values(np.array([1.1])))[0] + np.linspace(0.02, 0.03, 10)[:, None] * along / np.hypot(*along)
    on = np.real(wall.values(t)) + 1e-5 * np.random.default_rng(0).normal(size=(40, 2))
    off = blade_ends._off_row(WallPoints(name="hub", places=np.concatenate([on, past])), exact)
    assert np.max(off[:40]) < 1e-4
    assert np.min(off[40:]) > 0.015


@pytest.mark.parametrize("places", [[0.5], [0.3, 0.5, 0.6], [0.5] * 12])
def test_a_wall_of_few_places_beside_the_blade_is_one_all_the_same(places):
    _, _, there = shape(BLADE)
    points, hub = sides_cloud(BLADE, 50), np.real(there.exact.wall("hub").values(np.array(places)))
    on = nearest_footpoints(points, there.sides)
    wall = blade_ends_of(points, on, there, np.ones(len(points), dtype=bool), [hub]).walls["hub"]
    assert len(wall.places) == len(places)
    assert np.max(np.abs(wall.located(there.exact)[2])) < 1e-12


def test_points_a_little_inside_beside_an_end_are_no_end_face():
    design, model, _ = shape(BLADE)
    blunt = model.shape(
        design.changed({"trailing_edge_radius[1]": 2.0 * design.parameters()["trailing_edge_radius[1]"]})
    )
    points = sides_cloud(BLADE, 300, rows=60)
    found = blade_ends_of(points, nearest_footpoints(points, blunt.sides), blunt, np.ones(len(points), dtype=bool))
    assert not found.on_end_face.any()


def test_a_corner_that_has_slid_past_its_row_is_still_shown_by_it():
    """It was held by nothing, and slid on: a radial turbine's hub stood 2 mm out of its points at the leading edge."""
    design, model, there = shape(BLADE)
    edge = [design.channel.leading_edge[i] for i in (0, -1)]
    slid = design.changed("channel.leading_edge[0].r", edge[0].r - 0.03 * (edge[1].r - edge[0].r))
    points = sides_cloud(BLADE, 300, rows=60)
    feet = nearest_footpoints(points, model.shape(slid).sides)
    found = blade_ends_of(points, feet, model.shape(slid), np.ones(len(points), dtype=bool))
    hub = found.walls["hub"]
    row = np.flatnonzero(np.abs(hub.located(there.exact)[2]) < 1e-6 * model.chord)
    # of 120, some of them farther than 1.5 % of the span
    assert len(row) >= 100
    assert np.max(feet.v[hub.rows[row]]) > 0.015


def test_without_points_at_the_ends_there_are_no_walls():
    found, _ = ends(BLADE, sides_cloud(BLADE, 200))
    assert not found.walls


def test_where_nobody_says_where_a_blade_ends_its_outermost_points_do():
    design, points = example(BLADE), sides_cloud(BLADE, 2000)
    task = Task(points=points, weights=np.ones(len(points)))
    assert not evaluated(task, design, noise=1e-3).ends.walls
    # the walls of an outline are its points' own
    guessed = replace(task, outline=(points[:, :2],))
    assert set(evaluated(guessed, design, noise=1e-3).ends.walls) == {"hub", "shroud"}


def test_points_past_an_end_are_near_it():
    points = sides_cloud(BLADE, 100, rows=10)
    found, on = ends(BLADE, points)
    assert set(range(200, len(points))) <= set(found.near.tolist())
    assert np.all((on.v[found.near] < 0.05) | (on.v[found.near] > 0.95))


def between(v):
    """Points inside the blade (25, 3), midway between its sides."""
    _, _, there = shape(BLADE)
    u = np.linspace(0.2, 0.8, 25)
    upper, lower = (side(u, np.broadcast_to(v, 25)) for side in there.sides)
    theta = [np.arctan2(each[:, 1], each[:, 2]) for each in (upper, lower)]
    radius = [np.hypot(each[:, 1], each[:, 2]) for each in (upper, lower)]
    middle, r = (theta[0] + theta[1]) / 2.0, (radius[0] + radius[1]) / 2.0
    return np.stack([(upper[:, 0] + lower[:, 0]) / 2.0, r * np.sin(middle), r * np.cos(middle)], axis=-1)


def test_points_of_an_end_face_are_told_from_those_of_the_sides():
    points = np.concatenate([sides_cloud(BLADE, 300), between(1.0)])
    found, _ = ends(BLADE, points)
    assert found.on_end_face[600:].all()
    assert not found.on_end_face[:600].any()
    assert len(found.walls["shroud"].places) == 25


@pytest.mark.parametrize(
    ("v", "belong"), [(1.0, True), (0.98, True), (np.random.default_rng(6).uniform(0.95, 1.0, 25), False)]
)
def test_outliers_belong_to_an_end_face_where_they_stand_in_its_row(v, belong):
    points = np.concatenate([sides_cloud(BLADE, 300), between(v)])
    _, _, there = shape(BLADE)
    found = blade_ends_of(points, nearest_footpoints(points, there.sides), there, np.arange(len(points)) < 600)
    assert np.all(found.on_end_face == (belong & (np.arange(len(points)) >= 600)))
    assert set(found.walls) == ({"shroud"} if belong else set())


@pytest.mark.parametrize("end", ["hub", "shroud"])
def test_places_on_a_wall_move_as_central_differences_say(end):
    design, _, there = shape(BLADE)
    found, _ = ends(BLADE, sides_cloud(BLADE, 50, rows=20))
    wall = found.walls[end]
    t, _, _ = wall.located(there.exact)
    paths = [path for path in design.parameters() if path.startswith("channel.")] + ["stagger[0]"]
    rates, values = wall.rates(there, t, paths), design.parameters()
    for i, path in enumerate(paths):
        step = 1e-4
        ahead, behind = (
            there.exact.moved_to(design.changed(path, values[path] + sign * step)).channel.line(end).values(t)
            for sign in (1.0, -1.0)
        )
        # metres a millimetre: rounding of metres over a step
        np.testing.assert_allclose(rates[:, i], (ahead - behind) / (2.0 * step), atol=1e-10)
    assert not rates[:, -1].any()
    assert np.any(rates)


def test_edges_within_their_cloud_stand_out_no_further_than_allowed():
    for name in (BLADE, "turbine-section"):
        _, model, there = shape(name)
        u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 60))) / 2.0
        grid = [np.repeat(u, 40), np.tile(np.linspace(0.0, 1.0, 40), 60)]
        points = np.concatenate([side(u) if name == "turbine-section" else side(*grid) for side in there.sides])
        reach = edge_overhang_of(points, there.sides, np.ones(len(points), dtype=bool))
        assert np.all(reach.excess(reach.edges(there.sides)) <= 0.0)
        assert np.all(reach.allowed < 0.1 * model.chord)
        assert set(reach.u) == {0.0, 1.0}


@pytest.mark.parametrize(("edge", "path", "sign"), [(0, "leading_edge_x", -1.0), (1, "axial_chord", 1.0)])
def test_an_edge_that_sticks_out_of_its_cloud_stands_out_by_that_much(edge, path, sign):
    design, model, there = shape("turbine-section")
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 100))) / 2.0
    points = np.concatenate([side(u) for side in there.sides])
    longer = model.shape(design.changed(path, getattr(design, path) + sign)).sides
    reach = edge_overhang_of(points, longer, np.ones(len(points), dtype=bool))
    excess = reach.excess(reach.edges(longer))
    away = longer[0](np.array([float(edge)])) - there.sides[0](np.array([float(edge)]))
    away = np.sqrt(np.sum(away**2))
    assert 0.3 * away < excess[edge] <= away
    again = footpoints_at(reach.points, longer, np.zeros(2, dtype=int), reach.u, reach.v)
    assert np.sum(again.miss[edge] * again.normals[edge]) < 0.0


@pytest.mark.parametrize(
    ("name", "edge"), [("vaned-diffuser", 1), ("inlet-guide-vane", 1), ("wedge-diffuser", 1), (BLADE, 0), (BLADE, 1)]
)
def test_out_of_a_blade_is_along_the_camber_whatever_its_edge(name, edge):
    """A sharp or blunt edge past all points cost nothing while its side's normal was taken for the way out."""
    sides = example(name).build().sides
    v = np.linspace(0.1, 0.9, 5)
    at, before = (np.mean([side(np.full(5, u), v) for side in sides], axis=0) for u in (float(edge), abs(edge - 0.4)))
    way = at - before
    out = outward_at_edges(sides, np.full(5, float(edge)), v)
    np.testing.assert_allclose(np.sum(out**2, axis=1), 1.0)
    assert np.all(np.sum(out * way, axis=1) > 0.8 * np.sqrt(np.sum(way**2, axis=1)))
    along = np.real(sides[0].derivative(np.full(5, float(edge)), v, 0, 1))
    assert np.max(np.abs(np.sum(out * along, axis=1))) < 1e-12 * np.max(np.abs(along))


def test_a_true_oblique_edge_costs_nothing_beside_a_dense_row_at_its_end():
    """The nearest point to a place on an edge may be one of the end's row, far along the edge, which is no overhang."""
    built = example("inlet-guide-vane").build()
    random = np.random.default_rng(1)
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 100))) / 2.0
    points = [side(random.random(50), random.random(50)) for side in built.sides]
    points = np.concatenate([*points, *(side(u, np.full(100, v)) for side in built.sides for v in (0.0, 1.0))])
    reach = edge_overhang_of(points, built.sides, np.ones(len(points), dtype=bool), exact=True)
    assert np.max(reach.excess(reach.edges(built.sides))) < 0.0


@pytest.mark.parametrize(("shown", "held"), [(1.0, True), (0.7, False)])
def test_the_ends_of_an_edge_are_held_where_the_cloud_shows_them(shown, held):
    _, _, there = shape(BLADE)
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 60))) / 2.0
    grid = [np.repeat(u, 40), np.tile(np.linspace(0.0, shown, 40), 60)]
    points = np.concatenate([side(*grid) for side in there.sides])
    reach = edge_overhang_of(points, there.sides, np.ones(len(points), dtype=bool))
    assert np.all(np.isfinite(reach.allowed[reach.v == 1.0]) == held)
    assert np.all(np.isfinite(reach.allowed[reach.v < 1.0]))


def test_a_true_edge_costs_nothing_in_an_exact_cloud_whose_points_happen_to_lie_far_from_it():
    built, points = made(10)
    every = np.ones(len(points), dtype=bool)
    excess = []
    for exact in (False, True):
        reach = edge_overhang_of(points, built.sides, every, exact=exact)
        excess.append(float(np.max(reach.excess(reach.edges(built.sides)))) / built.chord)
    # beside the edge two points are much nearer to each other than to it
    assert excess[0] > 1e-4
    assert excess[1] < 0.0
