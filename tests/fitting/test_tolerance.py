"""Fewer control points, and fewer waves, where a tolerance allows."""

from dataclasses import replace
from functools import cache

import numpy as np

from bladewright.blade.native.extrema import extrema_of
from bladewright.fitting.free_parameters import corner_radii, free_parameters_of
from bladewright.fitting.matching.search import Task, searched
from bladewright.fitting.model_selection.identification import (
    identified_section,
    nearest_trial,
    plainest,
    trial_cambers,
)
from bladewright.fitting.model_selection.reshaping import reshaped, with_feasible_edges
from bladewright.fitting.model_selection.steps import intersection_of, losses, steps_down
from bladewright.fitting.model_selection.structure import structure_of
from bladewright.fitting.model_selection.tolerance import reduced, smoothed
from machines import example

BASE = example("turbine-section")
MADE = replace(
    BASE, thickness_upper=(0.05, 0.13, 0.21, 0.16, 0.12, 0.05, 0.03), thickness_lower=(0.04, 0.07, 0.11, 0.05, 0.02)
)


@cache
def match(chordwise):
    """Points of the made section, and the match that starts from it with other numbers of control points."""
    curves, random = MADE.build().curves, np.random.default_rng(4)
    points = np.concatenate([curves[side](random.random(90)) for side in ("upper", "lower")])
    task = Task(points=points, weights=np.ones(180), free=free_parameters_of(None, None, started=True), bounds={})
    start = reshaped(MADE, replace(structure_of(MADE), chordwise=chordwise))
    return task, searched(task, start, rounds=2)


def test_control_points_that_a_tolerance_does_not_need_are_taken_away():
    task, found = match((8, 7))
    tolerance = 2e-3 * found.model.chord
    fewer = reduced(task, found, tolerance)
    assert len(fewer.problem.paths) < len(found.problem.paths) - 2
    assert fewer.maximum <= tolerance
    assert fewer.evaluations > found.evaluations


def test_a_wall_may_lose_its_last_control_point_between_the_corners():
    stator = example("compressor-stator")
    structure = structure_of(stator)
    short = reshaped(stator, replace(structure, channel={**structure.channel, "hub": 3}))
    random = np.random.default_rng(4)
    points = np.concatenate([side(*random.random((2, 60))) for side in short.build().sides])
    task = Task(points=points, weights=np.ones(120), free=free_parameters_of(None, None, started=True), bounds={})
    found = searched(task, short, rounds=0)
    (loss,) = (loss for loss, step in losses(found) if step.fields == ("channel.hub",))
    assert loss >= 0.0


def test_nothing_is_taken_away_where_the_tolerance_is_not_kept_even_now():
    task, found = match((8, 7))
    assert reduced(task, found, 0.5 * found.maximum) is found
    assert smoothed(task, found, 0.5 * found.maximum) is found


def test_the_step_back_that_costs_least_is_foreseen_first():
    _, found = match((8, 7))
    ranked = losses(found)
    assert {step.fields for _, step in ranked} == {("thickness_upper",), ("thickness_lower",)}
    assert [loss for loss, _ in ranked] == sorted(loss for loss, _ in ranked)
    assert intersection_of([step for _, step in ranked]).chordwise == (7, 6)


def test_steps_back_leave_three_control_points_of_a_thickness():
    structure = replace(structure_of(MADE), chordwise=(3, 4))
    assert [step.structure.chordwise for step in steps_down(structure)] == [(3, 3)]


def test_a_wavy_match_is_smoothed_as_far_as_the_tolerance_allows():
    task, found = match((8, 7))
    tolerance = 1e-2 * found.model.chord
    smooth = smoothed(task, found, tolerance)
    assert smooth.maximum <= tolerance
    waves = [sum(extrema_of(each.design.build()).values()) for each in (smooth, found)]
    assert waves[0] <= waves[1]


def test_the_numbers_of_control_points_that_a_section_was_made_with_are_found():
    task, found = match((6, 5))
    known = identified_section(task, found.design)
    assert structure_of(known.design).chordwise == (7, 5)
    assert known.rms < 1e-9


def test_a_section_is_found_from_a_camber_that_leaves_its_edge_the_wrong_way():
    task, _ = match((6, 5))
    hooked = with_feasible_edges(MADE.changed({"metal_angle_out": MADE.stagger + 40.0, "tangent_out": 0.1}))
    direct = searched(task, hooked, noise=3e-3, rounds=6)
    found = nearest_trial(task, hooked, [structure_of(MADE)])
    assert found.rms < 1e-9 < direct.rms


def test_cambers_hold_what_is_not_free():
    others = trial_cambers(MADE, lambda _: ("tangent_in", "tangent_out", "metal_angle_in"))
    assert {each.metal_angle_out for each in others} == {MADE.metal_angle_out}
    assert MADE in others
    assert len({each.metal_angle_in for each in others}) > 1


def test_thicknesses_lose_the_control_points_that_the_shape_does_not_need():
    wider = reshaped(MADE, replace(structure_of(MADE), chordwise=(7, 7)))
    assert structure_of(plainest(wider)).chordwise == (7, 5)
    assert plainest(MADE) is MADE


def test_the_radii_of_the_corners_are_those_of_both_edges_at_both_walls():
    stator = example("compressor-stator")
    last = len(stator.channel.leading_edge) - 1
    assert len(corner_radii(stator)) == 4
    assert {"channel.leading_edge[0].r", f"channel.leading_edge[{last}].r"} < set(corner_radii(stator))
    assert set(corner_radii(stator)) < set(stator.parameters())
    assert corner_radii(BASE) == ()
