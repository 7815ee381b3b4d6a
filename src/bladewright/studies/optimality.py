"""How near a point is to an optimum: the conditions of Karush, Kuhn and Tucker (Nocedal and Wright 2006, 12.34)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

import numpy as np
from scipy.optimize import nnls

from bladewright.nurbs.basis import Reals

ACTIVE = 1e-6
"""Distance of a row from its limit, or of an entry of the vector from its bound, below which it counts as held by it.
Rows are divided by their sizes and entries go from 0 to 1; the searches come closer than 1e-7."""


@final
@dataclass(frozen=True, kw_only=True)
class Rows:
    """Rows of a program: the least of `cost` where all of `rows` are at least 0, or are 0 where `equal`."""

    cost: float
    slope: Reals
    """(n,) derivative of the cost by x"""
    names: tuple[str, ...]
    """what each row is"""
    rows: Reals
    """(m,)"""
    slopes: Reals
    """(m, n)"""
    equal: tuple[bool, ...]


@final
@dataclass(frozen=True, kw_only=True)
class Optimality:
    """How well the conditions hold: at 0 no direction that the constraints leave open makes the cost smaller."""

    residual: float
    """largest entry of the gradient of the Lagrangian by the scaled variables, of the scaled cost"""
    violation: float
    """largest violation of a constraint, in its size"""
    multipliers: Mapping[str, float]
    """of the constraints and bounds that hold the optimum: the scaled cost that loosening by one size would save"""

    @property
    def worst(self) -> float:
        """The larger of residual and violation."""
        return max(self.residual, self.violation)

    def failures(self, tolerance: float) -> tuple[str, ...]:
        """A sentence for each condition that is missed by more than a tolerance."""
        pairs = (("the KKT residual", self.residual), ("the largest violation of a constraint", self.violation))
        return tuple(
            f"{what} is {value:.1e}, more than the tolerance of {tolerance:g}"
            for what, value in pairs
            if value > tolerance
        )


def optimality(x: Reals, at: Rows, variables: tuple[str, ...]) -> Optimality:
    """The conditions at a vector x (n,) between 0 and 1, with the multipliers that meet them best."""
    columns: list[Reals] = []
    words: list[str] = []
    for name, row, slope, equal in zip(at.names, at.rows, at.slopes, at.equal, strict=True):
        if equal or row < ACTIVE:
            columns, words = [*columns, -slope], [*words, name]
        if equal:
            columns, words = [*columns, slope], [*words, name]
    for place, (entry, name) in enumerate(zip(x, variables, strict=True)):
        unit = np.eye(len(x))[place]
        if entry < ACTIVE:
            columns, words = [*columns, -unit], [*words, f"{name} at its lower bound"]
        if entry > 1.0 - ACTIVE:
            columns, words = [*columns, unit], [*words, f"{name} at its upper bound"]
    matrix = np.array(columns).reshape(-1, len(x)).T
    factors = nnls(matrix, -at.slope)[0] if words else np.zeros(0)
    equals = [-abs(row) if equal else row for row, equal in zip(at.rows, at.equal, strict=True)]
    return Optimality(
        residual=float(np.abs(at.slope + matrix @ factors).max()),
        violation=float(max(0.0, -min(equals, default=0.0))),
        multipliers={word: float(factor) for word, factor in zip(words, factors, strict=True) if factor > 0.0},
    )
