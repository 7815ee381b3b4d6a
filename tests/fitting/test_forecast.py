"""What matches of other structures leave is foreseen from the motion of one design."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from bladewright.fitting.free_parameters import corner_radii, free_parameters_of
from bladewright.fitting.matching.search import Task, searched
from bladewright.fitting.model_selection.best_structure import best_match_of_size, best_structure, ranked_steps
from bladewright.fitting.model_selection.forecast import forecast_of, regularised_step
from bladewright.fitting.model_selection.reshaping import reshaped
from bladewright.fitting.model_selection.steps import steps_down, widest_reach
from bladewright.fitting.model_selection.structure import structure_of
from bladewright.fitting.model_selection.tolerance import reduced_blade
from bladewright.fitting.models.model import Model
from machines import built, example

NAMES = ("aachen-stator", "compressor-stator")


@cache
def task(name, count=120):
    random = np.random.default_rng(2)
    points = np.concatenate([side(*random.random((2, count))) for side in built(example(name)).sides])
    return Task(
        points=points, weights=np.ones(len(points)), free=free_parameters_of(None, None, started=True), bounds={}
    )


@cache
def met(name):
    """The match of a design's own points, before any search."""
    return searched(task(name), example(name), rounds=0, noise=1e-3)


@cache
def forecast():
    found = met("aachen-stator")
    return found, forecast_of(found, widest_reach(structure_of(found.design)))


@pytest.mark.parametrize("name", NAMES)
def test_places_move_with_whole_laws_as_with_their_control_points(name):
    found = met(name)
    places, paths = found.problem.cloud_residuals.places(found.state), found.problem.paths
    whole = found.model.along(found.state.shape, *places, paths)
    single = Model.along(found.model, found.state.shape, *places, paths)
    # sums of as many terms as there are sections, in another order
    np.testing.assert_allclose(whole, single, atol=1e-11 * np.max(np.abs(single)))


def test_the_structure_that_is_there_is_foreseen_as_its_own_least_squares():
    found, _ = forecast()
    own = structure_of(found.design)
    about = forecast_of(found, own)
    slopes = found.problem.cloud_residuals.slopes(found.state, found.problem.paths) * found.problem.scales.size
    rows = found.problem.cloud_residuals.residuals(found.state)
    held = found.problem.noise * np.eye(slopes.shape[1])
    system, target = np.concatenate([slopes, held]), np.concatenate([rows, np.zeros(len(held))])
    left = target - system @ np.linalg.lstsq(system, target, rcond=None)[0]
    told = about.prediction(own)
    assert told.parameters == slopes.shape[1]
    # products of rows lose half the digits
    np.testing.assert_allclose(told.cost, left @ left, rtol=1e-6, atol=1e-6 * (rows @ rows) + 1e-20)


def test_what_steps_back_leave_is_foreseen_alike_one_by_one_and_together():
    found, about = forecast()
    own = structure_of(found.design)
    steps = [step for step in steps_down(own) if step.law in set(about.names())]
    together = about.costs(own, [(step.law, step.structure) for step in steps], None)
    alone = [about.prediction(step.structure).cost for step in steps]
    np.testing.assert_allclose(together, alone, rtol=1e-4, atol=1e-5 * max(alone))


def test_laws_that_do_alike_are_foreseen_of_an_exact_cloud_too():
    random = np.random.default_rng(3)
    columns, rows = random.normal(size=(40, 5)), random.normal(size=40)
    alike = np.column_stack([columns, columns[:, 0], np.zeros(40)])
    step = regularised_step(alike.T @ alike, alike.T @ rows, 0.0)
    left = rows - columns @ np.linalg.lstsq(columns, rows, rcond=None)[0]
    # what is held leaves more by the rounding of the products alone
    assert np.sum((rows - alike @ step) ** 2) == pytest.approx(left @ left, rel=1e-9)


def test_the_law_along_the_span_that_is_short_of_a_control_point_is_foreseen_to_gain_most():
    base = example("aachen-stator")
    truth = replace(base, metal_angle_in=tuple(base.metal_angle_in + change for change in (-4.0, 4.0, -4.0, 4.0)))
    random = np.random.default_rng(2)
    points = np.concatenate([side(*random.random((2, 120))) for side in truth.build().sides])
    short = reshaped(truth, replace(structure_of(truth), span={**structure_of(truth).span, "metal_angle_in": 3}))
    found = searched(replace(task("aachen-stator"), points=points), short, rounds=0, noise=1e-3)
    about = forecast_of(found, widest_reach(structure_of(short)))
    assert ranked_steps(about, structure_of(short))[0][1].law == "metal_angle_in"


def test_a_structure_of_so_many_parameters_is_no_worse_foreseen_than_the_one_that_was_there():
    found, about = forecast()
    own = structure_of(found.design)
    most = about.prediction(own).parameters
    best = best_structure(about, widest_reach(own), most)
    assert about.prediction(best).parameters <= most
    assert about.prediction(best).cost <= 1.001 * about.prediction(own).cost
    fewer = best_structure(about, own, most - 6)
    assert about.prediction(fewer).parameters <= most - 6


def test_the_foreseen_design_has_the_structure():
    found, about = forecast()
    structure = best_structure(about, structure_of(found.design), 24)
    told = about.designed(structure, about.prediction(structure))
    assert structure_of(told) == structure


def test_radii_of_corners_that_are_held_stay_where_they_are():
    name = "aachen-stator"
    corners = corner_radii(example(name))
    held = replace(task(name), free=free_parameters_of(None, corners, started=True))
    found = searched(held, example(name), rounds=0, noise=1e-3)
    about = forecast_of(found, structure_of(found.design))
    assert len(about.held) == len(corners)
    own = structure_of(found.design)
    assert about.prediction(own).parameters == len(found.problem.paths)
    told = about.designed(own, about.prediction(own))
    for path in corners:
        assert told.parameters()[path] == pytest.approx(found.design.parameters()[path], rel=1e-12)


def test_blades_with_a_clearance_have_no_forecast():
    found = met("compressor-stator")
    assert found.design.hub_clearance is not None
    assert forecast_of(found, structure_of(found.design)) is None
    assert best_match_of_size(task("compressor-stator"), found, 40) is None


@pytest.mark.slow
def test_a_blade_within_a_tolerance_loses_the_control_points_that_it_does_not_need():
    name = "aachen-stator"
    wide = reshaped(example(name), widest_reach(structure_of(example(name))))
    found = searched(task(name), wide, rounds=1, noise=1e-4, min_reduction=1e-2)
    tolerance = max(1e-3 * found.model.chord, 1.2 * found.maximum)
    fewer = reduced_blade(task(name), found, tolerance)
    assert len(fewer.problem.paths) < len(found.problem.paths) - 3
    assert fewer.maximum <= tolerance
