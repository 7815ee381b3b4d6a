"""Least squares under inequalities, against scipy's own."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear, minimize

from bladewright.numerics.least_squares import (
    MIN_REDUCTION,
    ConstrainedProblem,
    constrained_minimum,
)


class Linear(ConstrainedProblem):
    """CloudResiduals `matrix @ z - aim` and constrained values `walls @ z - room`."""

    def __init__(self, matrix, aim, *, walls=None, room=None, low=-np.inf, high=np.inf):
        count = matrix.shape[1]
        self.matrix, self.rhs = matrix, aim
        self.walls = np.empty((0, count)) if walls is None else walls
        self.room = np.empty(0) if room is None else room
        self._bounds = np.broadcast_to(low, count).astype(float), np.broadcast_to(high, count).astype(float)

    @property
    def bounds(self):
        return self._bounds

    def values(self, z):
        return self.matrix @ z - self.rhs, self.walls @ z - self.room

    def derivatives(self, z):  # noqa: ARG002 - as the base has it
        return self.matrix, self.walls


class Valley(ConstrainedProblem):
    """Rosenbrock's valley within a disc."""

    bounds = (np.full(2, -np.inf), np.full(2, np.inf))

    def __init__(self, radius):
        self.radius = radius

    def values(self, z):
        return np.array([10.0 * (z[1] - z[0] ** 2), 1.0 - z[0]]), np.array([z @ z - self.radius**2])

    def derivatives(self, z):
        return np.array([[-20.0 * z[0], 10.0], [-1.0, 0.0]]), 2.0 * z[None]


class Nowhere(Linear):
    """Values that do not exist."""

    def values(self, z):  # noqa: ARG002 - as the base has it
        return None


def made(seed, *, walls=0):
    random = np.random.default_rng(seed)
    matrix, target = random.normal(size=(12, 5)), random.normal(size=12)
    return matrix, target, random.normal(size=(walls, 5)), 0.3 * random.random(walls)


def unsettled(matrix, residuals):
    """How far from the minimum a step may promise less than SLIGHT of the sum of squares."""
    return np.sqrt(MIN_REDUCTION * np.sum(residuals**2)) / np.linalg.svd(matrix, compute_uv=False)[-1]


@pytest.mark.parametrize("seed", range(4))
def test_without_inequalities_the_minimum_is_that_of_the_normal_equations(seed):
    matrix, aim, *_ = made(seed)
    found = constrained_minimum(Linear(matrix, aim), np.zeros(5), steps=40)
    assert found.converged
    best = np.linalg.lstsq(matrix, aim, rcond=None)[0]
    np.testing.assert_allclose(found.z, best, atol=unsettled(matrix, matrix @ best - aim))


@pytest.mark.parametrize("seed", range(6))
def test_within_bounds_the_minimum_is_that_of_scipy(seed):
    matrix, aim, *_ = made(seed)
    aim = 4.0 * aim
    found = constrained_minimum(Linear(matrix, aim, low=-0.3, high=0.4), np.full(5, 2.0), steps=60)
    other = lsq_linear(matrix, aim, bounds=(-0.3, 0.4), method="bvls", tol=1e-14)
    assert found.converged
    assert np.any(other.active_mask)
    np.testing.assert_allclose(found.z, other.x, atol=unsettled(matrix, matrix @ other.x - aim))


@pytest.mark.parametrize("feasible", [True, False])
@pytest.mark.parametrize("seed", range(6))
def test_within_inequalities_and_bounds_the_minimum_is_that_of_scipy(seed, feasible):
    matrix, aim, walls, room = made(seed, walls=4)
    problem = Linear(matrix, 3.0 * aim, walls=walls, room=room, low=-0.6, high=0.5)
    start = np.zeros(5) if feasible else np.where(walls[0] > 0.0, 0.5, -0.6)
    assert feasible == bool(np.all(problem.values(start)[1] <= 0.0))
    found = constrained_minimum(problem, start, steps=80)
    other = minimize(
        lambda z: np.sum((matrix @ z - 3.0 * aim) ** 2),
        np.zeros(5),
        jac=lambda z: 2.0 * matrix.T @ (matrix @ z - 3.0 * aim),
        method="SLSQP",
        bounds=[(-0.6, 0.5)] * 5,
        constraints={"type": "ineq", "fun": lambda z: room - walls @ z, "jac": lambda _: -walls},
        options={"ftol": 1e-15, "maxiter": 300},
    )
    assert found.converged
    assert np.max(problem.values(found.z)[1]) < 1e-9
    np.testing.assert_allclose(found.z, other.x, atol=unsettled(matrix, matrix @ other.x - 3.0 * aim))


def test_a_bent_inequality_is_followed_to_the_minimum_on_it():
    found = constrained_minimum(Valley(0.8), np.array([-0.3, -0.3]), steps=200)
    angle = np.linspace(0.0, 2.0 * np.pi, 400_001)
    ring = 0.8 * np.array([np.cos(angle), np.sin(angle)])
    best = ring[:, np.argmin(100.0 * (ring[1] - ring[0] ** 2) ** 2 + (1.0 - ring[0]) ** 2)]
    assert found.converged
    # the ring's places are 1.3e-5 apart
    np.testing.assert_allclose(found.z, best, atol=2e-5)


def test_an_inequality_that_does_not_hold_at_the_minimum_is_not_felt():
    np.testing.assert_allclose(constrained_minimum(Valley(3.0), np.array([-1.2, 1.0]), steps=200).z, 1.0, atol=1e-6)


def test_inequalities_that_contradict_each_other_end_the_descent():
    walls, room = np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([-1.0, -1.0])
    found = constrained_minimum(Linear(np.eye(2), np.array([0.0, 3.0]), walls=walls, room=room), np.zeros(2), steps=50)
    assert np.all(np.isfinite(found.z))
    # what they say nothing of is found all the same
    assert found.z[1] == pytest.approx(3.0, abs=1e-6)


def test_a_descent_that_runs_out_of_steps_is_not_called_converged():
    assert not constrained_minimum(Valley(3.0), np.array([-1.2, 1.0]), steps=4).converged


def test_a_start_without_values_is_handed_back():
    found = constrained_minimum(Nowhere(np.eye(2), np.zeros(2)), np.array([1.0, 2.0]), steps=9)
    assert not found.converged
    assert found.z.tolist() == [1.0, 2.0]
