"""Edges around which a cloud has no points are said, and half a blade is known by them."""

import numpy as np
import pytest

from bladewright.fitting.assessment.coverage import uncovered_edges
from bladewright.fitting.fit import fit
from bladewright.fitting.free_parameters import free_parameters_of
from bladewright.fitting.matching.search import Task, searched
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


def test_half_a_blade_does_not_pass_and_is_called_so():
    design = DESIGNS["turbine-section"]
    found = fit(cloud("turbine-section", 0.0, 0.5), start=design, free="leading_edge_x")
    assert any("half a blade" in failure for failure in found.failures)
