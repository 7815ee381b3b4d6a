"""The least of one figure between limits, by scipy's SLSQP or trust-constr with exact gradients at held knots.

Within a round the knots of the surfaces are held. After it the designs choose theirs anew, and another round begins
where the conditions of an optimum no longer hold, with a fresh estimate of the second derivatives.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np
from scipy.optimize import Bounds, NonlinearConstraint, minimize

from bladewright.errors import DesignError, GeometryError
from bladewright.nurbs.basis import Reals
from bladewright.studies.goals import Aim, Limit
from bladewright.studies.optimality import Optimality, Rows, optimality
from bladewright.studies.problem import Problem

ROUNDS = 6
"""Most rounds: two or three meet a tolerance of 1e-6, the more of them the less smooth the figures are."""
WITHIN = 0.01
"""Of the tolerance: where a round ends before scipy ends it, so that new knots leave room."""
REFUSED = 1e3
"""What a refused design has as cost and as violation, in sizes: far more than any that can be built."""
CHANGE = 1e-15
"""Change of the scaled cost at which scipy ends a round: rounding, as the conditions of an optimum decide."""


@final
class Program:
    """The least of an aim between limits, as a function of the vector of a problem."""

    def __init__(self, problem: Problem, aim: Aim, limits: Sequence[Limit]) -> None:
        self.problem, self.aim, self.limits = problem, aim, tuple(limits)
        self.equal = tuple(limit.equal for limit in limits for _ in _sides(limit))
        self.names = tuple(f"{limit.figure}{word}" for limit in limits for word, _, _ in _sides(limit))
        self.refusal = ""
        self.evaluations = 0
        """how many designs were built"""
        self._last: tuple[bytes, float, Reals] = (b"", 0.0, np.zeros(0))
        self._last_slopes: tuple[bytes, Reals, Reals] = (b"", np.zeros(0), np.zeros(0))

    def values(self, x: Reals) -> tuple[float, Reals]:
        """The scaled cost and the scaled rows (m,), of which none may be below 0; REFUSED where there is no design."""
        if x.tobytes() != self._last[0]:
            self.evaluations += 1
            try:
                self._last = (x.tobytes(), *self._values(x))
            except (DesignError, GeometryError) as error:
                self.refusal = str(error)
                self._last = x.tobytes(), REFUSED, np.full(len(self.names), -REFUSED)
        return self._last[1:]

    def slopes(self, x: Reals) -> tuple[Reals, Reals]:
        """Their derivatives (n,) and (m, n)."""
        if x.tobytes() != self._last_slopes[0]:
            rates = self.problem.gradients(x)
            rows = [sign * rates[limit.figure] / limit.size for limit in self.limits for _, sign, _ in _sides(limit)]
            slopes = np.array(rows).reshape(len(rows), len(x))
            self._last_slopes = x.tobytes(), self.aim.cost(rates) / self.aim.size, slopes
        return self._last_slopes[1:]

    def rows(self, x: Reals) -> Rows:
        """Everything at a vector; DesignError where there is no design."""
        (cost, rows), (slope, slopes) = self._values(x), self.slopes(x)
        return Rows(cost=cost, slope=slope, names=self.names, rows=rows, slopes=slopes, equal=self.equal)

    def optimality(self, x: Reals) -> Optimality:
        """How well a vector meets the conditions of an optimum."""
        return optimality(x, self.rows(x), tuple(variable.name for variable in self.problem.variables))

    def renewed(self, x: Reals) -> Program:
        """The same at the knots that the designs of a vector select."""
        return Program(self.problem.renewed(x), self.aim, self.limits)

    def _values(self, x: Reals) -> tuple[float, Reals]:
        figures = self.problem.figures(x)
        rows = [
            sign * (figures[limit.figure] - value) / limit.size
            for limit in self.limits
            for _, sign, value in _sides(limit)
        ]
        return float(self.aim.cost(figures)) / self.aim.size, np.array(rows)


def _sides(limit: Limit) -> list[tuple[str, float, float]]:
    """The rows of a limit: words after its figure, sign and value."""
    if limit.equal:
        return [("", 1.0, limit.lower)]
    both = [(" at its lower limit", 1.0, limit.lower), (" at its upper limit", -1.0, limit.upper)]
    return [each for each in both if math.isfinite(each[2])]


@final
@dataclass(frozen=True, kw_only=True)
class Found:
    """Where a search has come to."""

    x: Reals
    """(n,) the vector"""
    figures: Mapping[str, float]
    """of its designs, at knots of their own"""
    optimality: Optimality
    """at the same knots"""
    rounds: int
    iterations: int
    evaluations: int
    """how many designs were built"""
    refusal: str
    """why the design was refused at which a round had to end; empty where none was"""


Watch = Callable[[Reals, Mapping[str, float]], object]
"""Called with the vector and the figures of each iteration."""


def least(
    problem: Problem,
    x: Reals,
    aim: Aim,
    limits: Sequence[Limit],
    *,
    method: str = "slsqp",
    tolerance: float = 1e-6,
    iterations: int = 200,
    watch: Watch = lambda *_: None,
) -> Found:
    """Search the least of an aim from a vector, until no condition of an optimum is missed by more than `tolerance`.

    Raises DesignError where the first design is impossible, and DerivativeError where a figure has no derivative.
    """
    program, spent, evaluations, refusal = Program(problem.renewed(x), aim, limits), 0, 0, ""
    found, rounds, moved = program.optimality(x), 0, True
    while found.worst > tolerance and moved and rounds < ROUNDS:
        rounds += 1
        end, used = _round(program, x, method, iterations, tolerance, watch)
        spent, evaluations = spent + used, evaluations + program.evaluations
        refusal, moved = program.refusal, not np.array_equal(end, x)
        x, program = end, program.renewed(end)
        found = program.optimality(x)
    return Found(
        x=x,
        figures=program.problem.figures(x),
        optimality=found,
        rounds=rounds,
        iterations=spent,
        evaluations=evaluations,
        refusal=refusal if found.worst > tolerance else "",
    )


class _EndedError(Exception):
    """A round ends before scipy ends it: at an optimum, or because a design that it has accepted is refused."""


def _round(
    program: Program, x: Reals, method: str, iterations: int, tolerance: float, watch: Watch
) -> tuple[Reals, int]:
    """The vector that a round ends at, and the number of iterations."""
    accepted = [x]

    def slopes(x: Reals) -> tuple[Reals, Reals]:
        if program.values(x)[0] == REFUSED:
            raise _EndedError
        if not np.array_equal(accepted[-1], x):
            accepted.append(x.copy())
            watch(x, program.problem.figures(x))
            if program.optimality(x).worst <= WITHIN * tolerance:
                raise _EndedError
        return program.slopes(x)

    search = {"slsqp": _slsqp, "trust-constr": _trust_constr}[method]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a step beyond a bound by rounding, a second derivative that does not change
        try:
            end = np.clip(search(program, x, slopes, iterations).x, 0.0, 1.0)
            if program.values(end)[0] < REFUSED:
                accepted.append(end)
        except _EndedError:
            pass
    return accepted[-1], len(accepted) - 1


Slopes = Callable[[Reals], tuple[Reals, Reals]]


def _slsqp(program: Program, x: Reals, slopes: Slopes, iterations: int) -> Any:
    """Kraft 1988."""
    constraints = []
    for kind, wanted in (("ineq", False), ("eq", True)):
        part = np.array(program.equal, dtype=bool) == wanted
        if part.any():
            constraints.append(
                {
                    "type": kind,
                    "fun": lambda x, part=part: program.values(x)[1][part],
                    "jac": lambda x, part=part: slopes(x)[1][part],
                }
            )
    return minimize(
        lambda x: program.values(x)[0],
        x,
        jac=lambda x: slopes(x)[0],
        bounds=[(0.0, 1.0)] * len(x),
        constraints=constraints,
        method="SLSQP",
        options={"maxiter": iterations, "ftol": CHANGE},
    )


def _trust_constr(program: Program, x: Reals, slopes: Slopes, iterations: int) -> Any:
    """Byrd, Hribar and Nocedal 1999."""
    equal = np.array(program.equal, dtype=bool)
    constraints = [
        NonlinearConstraint(
            lambda x: program.values(x)[1],
            np.zeros(len(equal)),
            np.where(equal, 0.0, np.inf),
            jac=lambda x: slopes(x)[1],
        )
    ]
    return minimize(
        lambda x: program.values(x)[0],
        x,
        jac=lambda x: slopes(x)[0],
        bounds=Bounds(0.0, 1.0),
        constraints=constraints if equal.size else [],
        method="trust-constr",
        # gtol is met at any barrier, wherever as many rows as variables are near: multipliers cancel the gradient there
        options={"maxiter": iterations, "gtol": 0.0, "xtol": 1e-10},
    )
