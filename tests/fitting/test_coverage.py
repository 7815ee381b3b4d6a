"""Edges around which a cloud has no points are said, and half a blade is known by them."""

from dataclasses import replace

import numpy as np
import pytest

from bladewright.fitting.assessment.coverage import (
    bare_places,
    bare_stretches,
    shape_bands,
    uncovered_edges,
)
from bladewright.fitting.fit import fit
from bladewright.fitting.free_parameters import free_parameters_of
from bladewright.fitting.matching.footpoints import Footpoints
from bladewright.fitting.matching.search import Task, searched
from bladewright.fitting.model_selection.laws import MOST_SPAN
from bladewright.fitting.model_selection.structure import reshaped, structure_of
from bladewright.fitting.model_selection.structure_search import rows_shown
from machines import example

DESIGNS = {name: example(name) for name in ("turbine-section", "aachen-stator")}


def cloud(name, low, high):
    """Points between two places along the section."""
    built, draw = DESIGNS[name].build(), np.random.default_rng(0)
    u = low + (high - low) * (1.0 - np.cos(np.pi * draw.random(400))) / 2.0
    if name == "turbine-section":
        return np.concatenate([np.real(curve(u)) for curve in (built.curves["upper"], built.curves["lower"])])
    return np.concatenate([np.real(side(u, draw.random(400))) for side in built.sides])


@pytest.mark.parametrize("name", DESIGNS)
@pytest.mark.parametrize(
    ("low", "high", "edge", "least", "most"),
    [
        (0.0, 1.0, None, 0.0, 0.0),
        (0.0, 0.9, "trailing edge", 0.0, 0.5),
        (0.0, 0.5, "trailing edge", 0.5, 1.1),
        (0.4, 1.0, "leading edge", 0.5, 1.1),
    ],
)
def test_an_edge_without_points_is_known_by_how_wide_the_blade_is_there(name, low, high, edge, least, most):
    points = cloud(name, low, high)
    task = Task(
        points=points, weights=np.ones(len(points)), free=free_parameters_of(None, None, started=True), bounds={}
    )
    found = uncovered_edges(searched(task, DESIGNS[name], rounds=0))
    assert set(found) == ({edge} if edge else set())
    assert all(wide > 0.0 and least < share < most for wide, share in found.values())


@pytest.mark.parametrize("name", DESIGNS)
@pytest.mark.parametrize(
    ("upper", "lower", "place"),
    [
        ((0.0, 1.0), (0.0, 1.0), None),
        ((0.0, 1.0), (0.5, 1.0), "lower side from u = "),
        ((0.0, 0.6), (0.0, 1.0), "upper side from u = "),
        ((0.3, 1.0), (0.3, 1.0), "leading edge"),
        ((0.0, 0.7), (0.0, 0.7), "trailing edge"),
        ((0.0, 1.0), None, "lower side from u = 0."),
    ],
)
def test_a_long_way_without_a_point_is_told_with_its_place(name, upper, lower, place):
    sides = [np.split(cloud(name, *(each or (0.0, 1.0))), 2)[k] for k, each in enumerate((upper, lower))]
    design = DESIGNS[name]
    free = free_parameters_of(None, None, started=True)

    def stretches(points):
        task = Task(points=points, weights=np.ones(len(points)), free=free, bounds={})
        match = searched(task, design, rounds=0)
        return match, bare_stretches(match)

    match, found = stretches(np.concatenate(sides))
    if lower is None:
        feet = match.state.footpoints
        shown = (feet.side == 0) | (np.abs(feet.u - 0.45) > 0.15)
        match, found = stretches(np.concatenate(sides)[shown])
    assert [where.startswith(place) for _, where in found] == ([True] * len(found) if place else [])
    assert bool(found) is (place is not None)
    assert all(way > 0.1 * match.model.chord for way, _ in found)


def test_a_side_without_any_point_is_one_long_way():
    design = DESIGNS["turbine-section"]
    points = np.real(design.build().curves["upper"](np.linspace(1e-3, 1.0 - 1e-3, 200)))
    free = free_parameters_of(None, None, started=True)
    match = searched(Task(points=points, weights=np.ones(200), free=free, bounds={}), design, rounds=0)
    assert not np.any(match.state.footpoints.side == 1)
    ((way, place),) = bare_stretches(match)
    assert way > match.model.chord
    assert place.startswith("lower side from u = 0.0")


def test_rows_of_points_across_the_lines_of_a_blade_leave_no_part_out():
    """Near the leading edge the row of a fifth of the span is in the next one: the edge between them is shown."""
    design = DESIGNS["aachen-stator"]
    u = np.linspace(0.0, 1.0, 150)
    rows = [at + np.where(u < 0.2, 0.01, 0.0) for at in np.arange(0.195, 0.99, 0.2)]
    points = np.concatenate([side(u, v) for side in design.build().sides for v in rows])
    task = Task(
        points=points, weights=np.ones(len(points)), free=free_parameters_of(None, None, started=True), bounds={}
    )
    assert not bare_stretches(searched(task, design, rounds=0))


def test_a_side_that_is_not_shown_does_not_pass_where_a_law_goes_on_through_it():
    """The laws found here are the true section's, and said to be known to nothing."""
    sections = example("vki-ls89").build().sections[0].curves
    whole, part = np.linspace(0.0, 1.0, 150), np.linspace(0.4, 1.0, 75)
    found = fit(np.concatenate([np.real(sections["lower"](whole)), np.real(sections["upper"](part))]))
    assert not found.passed
    assert any("no point shows the upper side from u = 0" in failure for failure in found.failures)


def test_half_a_section_with_nothing_given_does_not_pass():
    """Half of the points of the LS89 were met by a section whose edge was one of their ends."""
    u = 0.25 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 120)))
    sections = example("vki-ls89").build().sections[0].curves
    points = np.concatenate([np.real(sections[side](u)) for side in ("upper", "lower")])
    found = fit(points)
    assert not found.passed
    assert any("no point shows the" in failure for failure in found.failures)


def test_half_a_blade_does_not_pass_and_is_called_so():
    design = DESIGNS["turbine-section"]
    found = fit(cloud("turbine-section", 0.0, 0.5), start=design, free="leading_edge_x")
    assert any("half a blade" in failure for failure in found.failures)


@pytest.mark.parametrize("held", [(), ("stagger[1]", "stagger[2]", "stagger[3]")])
@pytest.mark.parametrize(("rows", "said"), [(4, True), (12, False)])
def test_a_blade_that_is_measured_in_fewer_sections_than_its_laws_have_points_is_not_known_between_them(
    rows, said, held
):
    """Nor is it where some of these are held as the sections do not determine them."""
    design, draw = DESIGNS["aachen-stator"], np.random.default_rng(0)
    design = reshaped(design, structure_of(design).resized("stagger", (1, 6)))
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 40))) / 2.0
    places = np.meshgrid(u, np.linspace(0.0, 1.0, rows))
    points = np.concatenate([np.real(side(*map(np.ravel, places))) for side in design.build().sides])
    points += 2e-5 * draw.normal(size=points.shape)
    free = free_parameters_of("stagger[*]", None, started=True)
    task = Task(points=points, weights=np.ones(len(points)), free=free, bounds={}).holding(held)
    found = searched(task, design, rounds=0)
    places, half_widths = shape_bands(found)
    assert bool(np.max(half_widths) > 1e-3 * found.model.chord) is said
    # the rows themselves are known
    assert np.max(half_widths[(places.v == 0.0) | (places.v == 1.0)]) < 1e-3 * found.model.chord


def feet_of(u, v):
    """Footpoints on the upper side alone."""
    none = np.zeros((len(u), 3))
    return Footpoints(side=np.zeros(len(u), dtype=int), u=u, v=v, points=none, normals=none, beyond=none, miss=none)


@pytest.mark.parametrize(
    ("v", "shown"),
    [
        (np.zeros(20), 1),
        (np.array([0.0, 0.33, 0.66, 0.99]), 4),
        (np.linspace(0.0, 1.0, 5), 4),
        (np.linspace(0.0, 1.0, 9), 7),
        (np.linspace(0.0, 1.0, 21), 11),
    ],
)
def test_rows_along_the_span_show_so_many_control_points_of_a_cubic_law_with_a_knot_for_each_third(v, shown):
    u, v = np.meshgrid(np.linspace(0.0, 1.0, 30), v)
    assert rows_shown(feet_of(u.ravel(), v.ravel())) == shown


def test_rows_that_lead_across_the_span_show_fewer_control_points_than_there_are_rows():
    u, v = np.meshgrid(np.linspace(0.0, 1.0, 80), np.linspace(0.0, 1.0, 9))
    across = 0.9 * v.ravel() + 0.1 * u.ravel()
    assert len(np.unique(np.minimum((18 * across).astype(int), 17))) == 18
    assert rows_shown(feet_of(u.ravel(), across)) == 8


def test_points_all_over_a_blade_show_as_many_control_points_as_a_law_may_have():
    u, v = np.random.default_rng(0).random((2, 4000))
    assert rows_shown(feet_of(u, v)) == MOST_SPAN


def test_an_end_without_points_on_a_part_of_the_chord_is_bare_there_alone():
    design, draw = DESIGNS["aachen-stator"], np.random.default_rng(0)
    u, v = np.concatenate([draw.random((2, 2000)), [[0.1, 0.9, 0.9], [0.0, 0.0, 1.0]]], axis=1)
    shown = (v > 0.15) | (u < 0.2) | (u > 0.4)
    points = np.concatenate([np.real(side(u[shown], v[shown])) for side in design.build().sides])
    free = free_parameters_of("stagger", None, started=True)
    found = searched(Task(points=points, weights=np.ones(len(points)), free=free, bounds={}), design, rounds=0)
    side, u, v = np.array([0, 1, 0, 1, 0]), np.array([0.3, 0.3, 0.1, 0.9, 0.3]), np.array([0.0, 0.1, 0.01, 0.01, 0.5])
    past = bare_places(found, replace(feet_of(u, v), side=side), known=np.ones(5, dtype=bool))
    assert (past["hub"] | past["shroud"]).tolist() == [True, True, False, False, False]


def test_an_edge_without_points_on_a_part_of_the_span_is_bare_there_alone():
    design, draw = DESIGNS["aachen-stator"], np.random.default_rng(0)
    u, v = np.concatenate([draw.random((2, 2000)), [[0.01], [0.9]]], axis=1)
    shown = (u > 0.1) | (v > 0.4)
    points = np.concatenate([np.real(side(u[shown], v[shown])) for side in design.build().sides])
    free = free_parameters_of("stagger", None, started=True)
    found = searched(Task(points=points, weights=np.ones(len(points)), free=free, bounds={}), design, rounds=0)
    side, u, v = np.array([0, 1, 0, 1, 0]), np.array([0.0, 0.05, 0.0, 0.05, 0.5]), np.array([0.1, 0.1, 0.9, 0.9, 0.1])
    past = bare_places(found, replace(feet_of(u, v), side=side), known=np.ones(5, dtype=bool))
    assert (past["leading edge"] | past["trailing edge"]).tolist() == [True, True, True, False, False]
