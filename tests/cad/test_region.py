"""Which parameters a trimmed face keeps, and the nearest points of its boundary, where that nearly touches itself."""

import numpy as np
import pytest

from bladewright.cad.region import Region
from bladewright.cad.surface_evaluation import PlaneEvaluator
from bladewright.nurbs.curve import Curve

WIDTH = 1e-4
"""of the slit, a twenty-fifth of the distance of the boundary polygon's vertices"""


def line(*points):
    """Straight pieces through points, as one curve."""
    knots = np.linspace(0.0, 1.0, len(points))
    return Curve(control_points=np.array(points), knots=np.concatenate([[0.0], knots, [1.0]]), degree=1)


@pytest.fixture(scope="module")
def slit():
    """A unit square with a slit along y = 0.5 from x = 0.3 to the right, with staggered vertices on its banks."""
    low, high = (0.5 - WIDTH / 2.0, 0.5 + WIDTH / 2.0)
    banks = (
        line((1.0, 0.0), (1.0, low)),
        line((1.0, low), (0.3, low)),
        line((0.3, low), (0.301, high)),
        line((0.301, high), (1.0, high)),
        line((1.0, high), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0), (1.0, 0.0)),
    )
    plane = PlaneEvaluator(origin=np.zeros(3), along=np.array([1.0, 0.0, 0.0]), across=np.array([0.0, 1.0, 0.0]))
    return Region(evaluator=plane, loops=(banks,), low=np.zeros(2), high=np.ones(2))


def test_a_point_beside_a_slit_is_judged_by_the_bank_that_it_lies_on(slit):
    uv = np.random.default_rng(0).random((20000, 2)) * [0.6, 0.01] + [0.35, 0.495]
    kept = np.abs(uv[:, 1] - 0.5) > WIDTH / 2.0
    np.testing.assert_array_equal(slit.contains(uv), kept)
    assert np.sum(~kept) > 100


def test_a_point_of_one_bank_of_a_slit_is_not_sought_on_the_other(slit):
    x = np.linspace(0.35, 0.95, 2001)
    points = np.stack(
        [np.tile(x, 2), np.repeat([0.5 - WIDTH / 2.0, 0.5 + WIDTH / 2.0], len(x)), np.zeros(4002)], axis=1
    )
    uv, distance = slit.boundary.closest(points, 1e-9)
    assert distance.max() < 1e-12
    np.testing.assert_allclose(uv, points[:, :2], atol=1e-12)
