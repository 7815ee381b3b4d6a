"""What is called a failure, by what was asked."""

import numpy as np
import pytest

from bladewright.fitting.assessment.acceptance import failures_of
from bladewright.fitting.assessment.measurement import measured
from bladewright.fitting.free_parameters import free_parameters_of
from bladewright.fitting.matching.search import Task, searched
from bladewright.fitting.model_selection.stopping import MatchTarget
from machines import example

STATOR = example("aachen-stator")


@pytest.mark.parametrize(("moved", "failures"), [(False, 1), (True, 0)])
def test_a_given_structure_is_met_exactly_but_in_axes_that_a_start_shows(moved, failures):
    """Axes that are off by a few millionths of the chord leave as much of a misfit."""
    built = STATOR.build()
    u, v = (
        each.ravel() for each in np.meshgrid((1.0 - np.cos(np.pi * np.linspace(0, 1, 40))) / 2, np.linspace(0, 1, 9))
    )
    points = np.concatenate([np.real(side(u, v)) for side in built.sides])
    tilt = 1e-5 * (points[:, 0] - points[0, 0])
    points[:, 1] += tilt
    task = Task(
        points=points, weights=np.ones(len(points)), free=free_parameters_of("stagger", None, started=True), bounds={}
    )
    found = searched(task, STATOR, rounds=0)
    at = measured(points, built)
    said = failures_of(
        np.abs(at.deviations),
        at.noise_estimate.inliers,
        at.regions,
        found,
        MatchTarget(structured=True, registered=moved),
    )
    assert len(said) == failures
    assert all("misfit of the given structure" in each for each in said)


def test_points_of_a_solid_on_its_end_faces_are_said_to_be_there():
    built = STATOR.build()
    random = np.random.default_rng(4)
    u, v, across = random.random((3, 1200))
    sides = np.concatenate([np.real(side(u, v)) for side in built.sides])
    upper, lower = (np.real(side(0.1 + 0.8 * u[:400], np.round(v[:400]))) for side in built.sides)
    face = upper + across[:400, None] * (lower - upper)
    stray = np.mean(sides, axis=0) + 0.5 * np.ptp(sides, axis=0)
    points = np.concatenate([sides, face, stray[None]])
    at = measured(points, built)
    allow_outliers = ~at.noise_estimate.inliers[len(sides) : -1]
    # those beside the outline are as near to the sides, on which an exact cloud has them
    assert np.mean(at.faced[len(sides) : -1][allow_outliers]) > 0.95
    assert not np.any(at.faced[: len(sides)])
    assert not at.faced[-1]
    assert set(at.regions[at.faced]) == {"ends"}
    assert set(at.places[at.faced]) == set(STATOR.ends)
    task = Task(
        points=points, weights=np.ones(len(points)), free=free_parameters_of("stagger", None, started=True), bounds={}
    )
    found, distances = searched(task, STATOR, rounds=0), np.abs(at.deviations)
    said = [
        " ".join(
            failures_of(
                distances, at.noise_estimate.inliers, at.regions, found, MatchTarget(structured=True), faced=faced
            )
        )
        for faced in (0, int(np.count_nonzero(at.faced)))
    ]
    assert "lie off the blade" in said[0]
    assert "lie off the blade" not in said[1]


@pytest.mark.parametrize(("share", "sheet"), [(1.0, False), (0.012, True)])
def test_a_blade_that_is_laid_through_one_side_is_called_a_sheet(share, sheet):
    powers = {"thickness_upper": 1, "thickness_lower": 1, "leading_edge_radius": 2, "trailing_edge_radius": 2}
    values = {path: (value, powers.get(path.partition("[")[0], 0)) for path, value in STATOR.parameters().items()}
    blade = STATOR.changed({path: value * share**power for path, (value, power) in values.items() if power})
    built = blade.build()
    u, v = np.random.default_rng(5).random((2, 300))
    points = np.concatenate([np.real(side(u, v)) for side in built.sides])
    task = Task(
        points=points, weights=np.ones(len(points)), free=free_parameters_of("stagger", None, started=True), bounds={}
    )
    found, at = searched(task, blade, rounds=0), measured(points, built)
    said = failures_of(
        np.abs(at.deviations), at.noise_estimate.inliers, at.regions, found, MatchTarget(structured=True)
    )
    assert any("the blade is a sheet" in each for each in said) == sheet


@pytest.mark.parametrize(("count", "few"), [(20, True), (60, False)])
def test_a_blade_needs_more_points_than_it_has_parameters(count, few):
    built, random = STATOR.build(), np.random.default_rng(6)
    points = np.concatenate([np.real(side(*random.random((2, count)))) for side in built.sides])
    task = Task(
        points=points, weights=np.ones(len(points)), free=free_parameters_of(None, None, started=True), bounds={}
    )
    found, at = searched(task, STATOR, rounds=0), measured(points, built)
    distances, open_aim = np.abs(at.deviations), MatchTarget()
    said = [
        " ".join(failures_of(distances, at.noise_estimate.inliers, at.regions, found, aim))
        for aim in (open_aim, MatchTarget(parameters=30))
    ]
    assert ("points are too few" in said[0]) == few
    assert "points are too few" not in said[1]
