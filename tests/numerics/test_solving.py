"""Linear systems with one real matrix, against numpy's general solver."""

import numpy as np
import pytest

from bladewright.numerics.solving import banded_solved, solved
from bladewright.nurbs.basis import basis, greville, uniform_knots

KNOTS = uniform_knots(40, 5)
MATRIX = basis(KNOTS, 5, greville(KNOTS, 5))
RANDOM = np.random.default_rng(1)


@pytest.mark.parametrize("solver", [solved, lambda matrix, values: banded_solved(matrix, values, 5)])
@pytest.mark.parametrize(
    "values", [RANDOM.normal(size=(40, 2)), RANDOM.normal(size=(3, 40, 4)) @ np.diag([1, 1j, 2, 3])]
)
def test_every_column_of_a_batch_is_solved(solver, values):
    np.testing.assert_allclose(solver(MATRIX, values), np.linalg.solve(MATRIX, values), rtol=0.0, atol=1e-12)


def test_a_complex_step_is_carried_through_the_bands():
    values = RANDOM.normal(size=(40, 2))
    found = banded_solved(MATRIX, values + 1e-30j * values[::-1], 5)
    np.testing.assert_allclose(found.imag, 1e-30 * np.linalg.solve(MATRIX, values[::-1]), rtol=1e-10)


@pytest.mark.parametrize("count", range(1, 7))
def test_a_matrix_narrower_than_its_band_is_solved(count):
    matrix, values = RANDOM.normal(size=(count, count)) + 5.0 * np.eye(count), RANDOM.normal(size=(count, 2))
    np.testing.assert_allclose(banded_solved(matrix, values, 5), np.linalg.solve(matrix, values), rtol=0.0, atol=1e-12)
