"""What is called a failure, by what was asked."""

import numpy as np
import pytest

from bladewright.files.examples import example_text
from bladewright.files.reading import design_from, parsed
from bladewright.fitting.freedom import freedom_of
from bladewright.fitting.judgement.judging import judged
from bladewright.fitting.judgement.verdict import failures_of
from bladewright.fitting.matching.search import Task, searched
from bladewright.fitting.structures.aim import Aim

STATOR = design_from(parsed(example_text("aachen-stator"), "stator"), "stator")


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
    task = Task(points=points, weights=np.ones(len(points)), free=freedom_of("stagger", None, started=True), bounds={})
    found = searched(task, STATOR, rounds=0)
    at = judged(points, built)
    said = failures_of(np.abs(at.deviations), at.scatter.inliers, at.regions, found, Aim(structured=True, moved=moved))
    assert len(said) == failures
    assert all("misfit of the given structure" in each for each in said)
