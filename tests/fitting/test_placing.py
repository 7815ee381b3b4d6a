"""Matches of moved clouds take away the motion that a start off the shape has left."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from bladewright.domain.row import turn_matrix
from bladewright.fitting import placing
from bladewright.fitting.assessment.result import Motion
from bladewright.fitting.fit import fit
from bladewright.fitting.free_parameters import FreeParameters
from bladewright.fitting.matching.footpoints import nearest_footpoints
from bladewright.fitting.matching.residuals import PlacedCloud
from bladewright.fitting.matching.search import Task, evaluated
from bladewright.fitting.registration import motion_by, motion_rates
from machines import COARSE, built, example

TRUTH = example("turbine-section")
PLACE = ("leading_edge_x", "leading_edge_y", "stagger")
"""what moves a section"""
AWAY = Motion(rotation=np.array([[-0.6, -0.8], [0.8, -0.6]]), translation=np.array([0.3, -0.1]))


def moved_cloud():
    return AWAY(np.concatenate([curve(np.linspace(0.0, 1.0, 80)) for curve in built(TRUTH).curves.values()]))


def start_beside():
    """A section with other angles, 6 % thicker on one side."""
    thickness = {f"thickness_upper[{i}]": 1.06 * each for i, each in enumerate(TRUTH.thickness_upper)}
    return TRUTH.changed(
        {"metal_angle_in": 1.05 * TRUTH.metal_angle_in + 2.0, "metal_angle_out": 0.97 * TRUTH.metal_angle_out}
        | thickness
    )


def test_a_section_that_is_held_in_its_place_is_found_with_the_motion_there(monkeypatch):
    points, chord = moved_cloud(), float(built(TRUTH).chord)
    found = fit(points, start_beside(), align=True, fixed=PLACE)
    assert found.passed
    assert found.maximum < 1e-4 * chord
    assert found.motion(points) == pytest.approx(found.cloud, abs=1e-15)
    # what one registration leaves
    monkeypatch.setattr(placing, "MOST_REALIGNMENTS", 0)
    assert fit(points, start_beside(), align=True, fixed=PLACE).maximum > 1e-3 * chord


def test_a_match_that_is_interrupted_after_a_realignment_hands_back_the_motion_of_its_design(monkeypatch):
    plain, steps = placing.motion_by, []

    def interrupting(*given):
        steps.append(1)
        if len(steps) == 2:
            raise KeyboardInterrupt
        return plain(*given)

    monkeypatch.setattr(placing, "motion_by", interrupting)
    points = moved_cloud()
    found = fit(points, start_beside(), align=True, fixed=PLACE)
    assert found.interrupted
    assert found.motion(points) == pytest.approx(found.cloud, abs=1e-15)
    assert found.maximum < 5e-4 * float(found.built.chord)


def test_residuals_change_with_the_motion_as_differences_say():
    design, random = example("compressor-stator").changed("tolerance", COARSE), np.random.default_rng(0)
    v = np.repeat([0.0, 0.0, 0.3, 0.6, 1.0, 1.0], 12)
    points = np.concatenate([side(random.random(len(v)), v) for side in built(design).sides])
    points = points + 1e-5 * random.normal(size=points.shape)
    task = Task(points=points, weights=np.ones(len(points)), free=FreeParameters(), bounds={})
    match = evaluated(task, design, noise=1e-4)
    cloud, shape = match.problem.cloud_residuals, match.state.shape
    assert len(cloud.ends.walls) == 2
    slopes = cloud.motion_slopes(match.state, motion_rates(points))

    def residuals(change):
        there = motion_by(change, points)(points)
        radius = np.hypot(there[:, 1], there[:, 2])
        walls = {
            name: replace(wall, places=np.stack([there[:, 0], radius], axis=-1)[wall.rows])
            for name, wall in cloud.ends.walls.items()
        }
        at = PlacedCloud(shape=shape, footpoints=nearest_footpoints(there, shape.sides))
        return replace(cloud, points=there, ends=replace(cloud.ends, walls=walls)).residuals(at)

    # past an end the normal turns with the point, which steps of Gauss and Newton leave out
    compared = np.ones(len(slopes), dtype=bool)
    compared[: len(points)] = np.all(match.state.footpoints.beyond == 0.0, axis=1)
    for k, step in enumerate(1e-8 * np.eye(6)):
        difference = (residuals(step) - residuals(-step))[: len(slopes)] / 2e-8
        assert slopes[compared, k] == pytest.approx(difference[compared], abs=3e-3 * np.max(np.abs(slopes[:, k])))
    assert np.count_nonzero(compared) > 200


def test_a_match_of_points_turned_about_the_axis_says_by_how_much():
    given = np.random.default_rng(1).normal(size=(5, 3))
    motion = Motion(rotation=turn_matrix(0.2), translation=np.array([0.1, 0.0, 0.3]))
    task = Task(points=motion(given), weights=np.ones(5), free=FreeParameters(), bounds={})
    here = placing.PlacedTask(motion=motion, notes=(), start=None, every=task, shown=task, hidden=None)
    assert placing.turned_with(here, SimpleNamespace(turn=0.0)) is here
    there = placing.turned_with(here, SimpleNamespace(turn=0.5, design=SimpleNamespace(arrangement="annular")))
    assert there.motion(given) == pytest.approx(there.every.points, abs=1e-15)
    assert there.every.turn == 0.5
    assert "by 28.6479 deg" in there.notes[0]
    cascade = placing.turned_with(here, SimpleNamespace(turn=0.5, design=SimpleNamespace(arrangement="linear")))
    assert cascade.notes == (placing.UPRIGHT_NOTE,)
    theta, before = (np.arctan2(points[:, 1], points[:, 2]) for points in (there.every.points, task.points))
    assert np.mod(theta - before, 2.0 * np.pi) == pytest.approx(0.5, abs=1e-12)
