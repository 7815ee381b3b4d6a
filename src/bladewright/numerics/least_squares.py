"""Least squares under inequalities: Levenberg's damped steps, each the solution of the linearised problem.

A penalty alone would stop a search at the kink where an inequality begins to hold; a step that knows the linearised
inequality slides along it. Where the last step gained little, the next one follows the second derivative of the
residuals along it: trials of exact sections then converge that had stalled in a curved valley.
References: Lawson and Hanson 1974, chapter 23 (least distance programming by non-negative least squares); Nielsen 1999
(damping); Transtrum and Sethna 2012 (second derivative).
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import qr, solve_triangular  # real: residuals of measured points
from scipy.linalg.lapack import dormqr
from scipy.optimize import nnls

from bladewright.numerics.elementary import Reals

FIRST_DAMPING = 1e-6
"""first damping, relative to the largest squared column of the Jacobian (Nielsen 1999 recommends 1e-6 for a start that
is believed to be near)."""
LARGEST_CHANGE = 1.0
"""largest change of a scaled variable in one step: one scale is what matters in a parameter, and linearisations reach
about so far."""
PENALTY = 4.0
"""merit of a violated inequality, in multiples of the largest multiplier seen. The penalty is exact above 1; more makes
steps short."""
CORRECTED_SHARES = (1.0, 0.5, 0.2, 0.05, 0.0)
"""shares of a violation that a step is asked to correct, in turn; the largest that the bounds and the other
inequalities allow is taken."""
PROBE_SHARE = 0.1
"""share of a step at which the second derivative of the residuals along it is measured: small against the step, large
against rounding."""
GOOD_GAIN = 0.8
"""ratio of actual to predicted reduction of the last step from which the next one needs no second derivative."""
EXPECTED_REST = 0.05
"""share of what a good step predicted that the next one is expected to predict at least, even where the step kept all
of it."""
LARGEST_BEND = 0.4
"""largest change of a step by the second derivative, of the step; beyond it the second-order model is not trusted
(Transtrum and Sethna 2012)."""
ACTIVE_SET_CHANGES = 20
"""changes of the set of active inequalities in one step at most; a step that needs more is given up."""
LARGEST_EASING = 1.0 / 5.0
"""ratio by which a good step eases the damping at most: by a tenth every second step of a rich match is refused, by a
third damping lags behind (design/matching.md)"""
MIN_REDUCTION = 1e-6
"""predicted relative reduction of the cost below which a step is not worth its evaluation."""


class ConstrainedProblem(ABC):
    """Residuals to be made small and values that may not be positive, both functions of variables (k,)."""

    @property
    @abstractmethod
    def bounds(self) -> tuple[Reals, Reals]:
        """Lowest and highest values (k,)."""

    @abstractmethod
    def values(self, z: Reals) -> tuple[Reals, Reals] | None:
        """Residuals (m,) and constrained values (c,); None where the variables describe no shape."""

    @abstractmethod
    def derivatives(self, z: Reals) -> tuple[Reals, Reals] | None:
        """Their derivatives (m, k) and (c, k); None where there is no shape beside it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ConstrainedMinimum:
    """Where a descent ended."""

    z: Reals
    converged: bool
    """whether no further step predicted a reduction worth its evaluation"""
    damping: float
    """the last one, for a descent that goes on from here"""


def constrained_minimum(
    problem: ConstrainedProblem,
    start: Reals,
    *,
    steps: int,
    damping: float = FIRST_DAMPING,
    min_reduction: float = MIN_REDUCTION,
    accelerated: bool = True,
) -> ConstrainedMinimum:
    """The variables after at most `steps` evaluations of the residuals.

    `min_reduction` is the predicted relative reduction of the cost up to which a step is not worth it. Steps that are
    `accelerated` follow second derivatives, which are to be smooth: places of points that cross an edge make them jump.
    """
    low, high = problem.bounds
    z = np.clip(start, low, high)
    found = problem.values(z)
    if found is None:
        return ConstrainedMinimum(z=z, converged=False, damping=damping)
    penalty, growth, gain, done = 0.0, 2.0, 1.0, 1
    linearised = problem.derivatives(z)
    while done < steps and linearised is not None:
        (residuals, constrained), (slopes, constraint_slopes) = found, linearised
        matrix, reduced = _factored(slopes)
        rhs = reduced(-residuals)
        scale = float(np.max(np.sum(slopes**2, axis=0), initial=1e-300))
        sizes = np.sqrt(np.sum(slopes**2, axis=0) + damping * scale)
        while done < steps:
            within = (
                damping * scale,
                constraint_slopes,
                constrained,
                np.maximum(low - z, -LARGEST_CHANGE),
                np.minimum(high - z, LARGEST_CHANGE),
            )
            step, largest = _step(matrix, rhs, *within)
            penalty = max(penalty, PENALTY * largest)
            before, linear = _merit(found, penalty), rhs - matrix @ step
            eased = np.maximum(constrained, 0.0) - np.maximum(constrained + constraint_slopes @ step, 0.0)
            predicted = float(rhs @ rhs) - float(linear @ linear) + penalty * float(np.sum(eased))
            if not predicted > min_reduction * before:
                return ConstrainedMinimum(z=z, converged=True, damping=damping)
            bend = _second_derivative(problem, z, step, residuals, slopes) if accelerated and gain < GOOD_GAIN else None
            if bend is not None:
                curved, _ = _step(matrix, reduced(-residuals - 0.5 * bend), *within)
                if np.sum(((curved - step) * sizes) ** 2) <= LARGEST_BEND**2 * np.sum((step * sizes) ** 2):
                    step = curved
            trial = np.clip(z + step, low, high)
            fresh = problem.values(trial)
            done += 1
            after = np.inf if fresh is None else _merit(fresh, penalty)
            gain = (before - after) / predicted
            ends = gain > GOOD_GAIN and max(1.0 - gain, EXPECTED_REST) * predicted < min_reduction * after
            following = problem.derivatives(trial) if gain > 1e-3 and done < steps and not ends else None
            if gain > 1e-3 and fresh is not None and (ends or done >= steps or following is not None):
                z, found, linearised = trial, fresh, following
                damping *= max(LARGEST_EASING, 1.0 - (2.0 * min(gain, 1.0) - 1.0) ** 3)
                damping, growth = max(damping, 1e-16), 2.0
                if ends:
                    return ConstrainedMinimum(z=z, converged=True, damping=damping)
                break
            damping *= growth
            growth *= 2.0
        else:
            break
    return ConstrainedMinimum(z=z, converged=False, damping=damping)


def _merit(values: tuple[Reals, Reals], penalty: float) -> float:
    """The sum of squared residuals (m,) and the penalty of the constrained values (c,) that are positive."""
    residuals, constrained = values
    return float(residuals @ residuals) + penalty * float(np.sum(np.maximum(constrained, 0.0)))


def _factored(slopes: Reals) -> tuple[Reals, Callable[[Reals], Reals]]:
    """The triangle (k, k) of slopes (m, k), and the right sides (k,) by those (m,) of the same problem."""
    (packed, factors), triangle = qr(slopes, mode="raw")  # real: derivatives of measured points' residuals

    def reduced(rhs: Reals) -> Reals:
        turned, _, _ = dormqr("L", "T", packed, factors, rhs[:, None], lwork=len(rhs))
        return np.asarray(turned[: len(triangle), 0])

    return triangle, reduced


def _second_derivative(
    problem: ConstrainedProblem, z: Reals, step: Reals, residuals: Reals, slopes: Reals
) -> Reals | None:
    """Second derivative of the residuals (m,) along a step; None where a probe would leave the bounds."""
    low, high = problem.bounds
    part = PROBE_SHARE * step
    if np.any(z + part < low) or np.any(z + part > high):
        return None
    probe = problem.values(z + part)
    if probe is None:
        return None
    return np.asarray(2.0 / PROBE_SHARE * ((probe[0] - residuals) / PROBE_SHARE - slopes @ step))


def _step(
    matrix: Reals, rhs: Reals, damping: float, constraint_slopes: Reals, constrained: Reals, low: Reals, high: Reals
) -> tuple[Reals, float]:
    """The damped step within the linearised inequalities, and the largest multiplier of an inequality."""
    count = matrix.shape[1]
    rows = np.vstack([matrix, np.sqrt(damping) * np.eye(count)])
    triangle = np.asarray(
        np.linalg.qr(np.column_stack([rows, np.append(rhs, np.zeros(count))]), mode="r")  # real: as these rows
    )
    upper, right = triangle[:count, :count], triangle[:count, -1]
    unconstrained = solve_triangular(upper, right)
    rows = np.vstack([constraint_slopes, np.eye(count), -np.eye(count)])
    for share in CORRECTED_SHARES:
        limit = np.concatenate([np.where(constrained > 0.0, -share * constrained, -constrained), high, -low])
        found = _nearest_feasible(upper, unconstrained, rows, limit)
        if found is not None:
            return found[0], float(np.max(found[1][: len(constraint_slopes)], initial=0.0))
    return np.zeros(count), 0.0


def _nearest_feasible(upper: Reals, unconstrained: Reals, rows: Reals, limit: Reals) -> tuple[Reals, Reals] | None:
    """The step with rows @ step <= limit nearest to the free one, and the multipliers; None if there is none.

    Distances are measured through the triangle `upper`. Inequalities join the active set as a step breaks them.
    """
    step, multipliers = unconstrained, np.zeros(len(rows))
    working = np.zeros(len(rows), dtype=bool)
    rhs = np.append(np.zeros(len(unconstrained)), 1.0)
    for _ in range(ACTIVE_SET_CHANGES):
        broken = rows @ step - limit > 1e-12 * (1.0 + np.abs(limit))  # real: as these rows
        if not np.any(broken & ~working):
            return step, multipliers
        working |= broken
        within = rows[working]
        orthogonal = solve_triangular(upper, within.T, trans="T")
        system = np.vstack([-orthogonal, (within @ unconstrained - limit[working])[None]])
        weights, _ = nnls(system, rhs, maxiter=50 * len(unconstrained))
        short = float(1.0 - system[-1] @ weights)
        if not short > 1e-14:
            return None
        step = unconstrained - solve_triangular(upper, orthogonal @ (weights / short))
        multipliers = np.zeros(len(rows))
        multipliers[working] = weights / short
    return None
