"""The front of two aims with derivatives: one of them is least while the other is held below a falling limit.

This is the epsilon-constraint method (Haimes, Lasdon and Wismer 1971): every member meets the conditions of an optimum,
and the multiplier of its limit is what the one aim costs in the other.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import final

from bladewright.nurbs.basis import Reals
from bladewright.studies.goals import Aim, Goals, Limit
from bladewright.studies.gradient_search import Found, least
from bladewright.studies.problem import Problem

SLACK = 1e-7
"""By how much the aim that is least may grow, in its size, while the other is searched at an end: a tenth of the
tolerance of the conditions of an optimum, so that these can be met."""


@final
@dataclass(frozen=True, kw_only=True)
class Tracing:
    """How a front is traced."""

    members: int
    method: str
    tolerance: float
    iterations: int


def front(
    problem: Problem,
    x: Reals,
    goals: Goals,
    tracing: Tracing,
    *,
    known: Mapping[int, Reals] | None = None,
) -> Iterator[tuple[int, Found]]:
    """Number and place of each member, from the least of the first aim to the least of the second; these come first.

    Members stand at equal steps of the second aim, and each search begins at the member before. `known` are vectors of
    members by number that were found before; they are checked, and searched again where they are none.
    """
    known = known or {}

    def searched(number: int, begin: Reals, aim: Aim, more: tuple[Limit, ...] = ()) -> Found:
        return least(
            problem,
            known.get(number, begin),
            aim,
            (*goals.limits, *more),
            method=tracing.method,
            tolerance=tracing.tolerance,
            iterations=tracing.iterations,
        )

    def end(number: int, aim: Aim, other: Aim) -> Found:
        """The least of an aim, and of the designs that have it the one with the least of the other."""
        alone = searched(number, x, aim)
        both = searched(number, alone.x, other, (_at_most(aim, aim.cost(alone.figures) + SLACK * aim.size),))
        return both if both.optimality.worst <= tracing.tolerance else alone

    first, second = goals.aims
    before, last = end(1, first, second), end(tracing.members, second, first)
    yield 1, before
    yield tracing.members, last
    costs = [second.cost(found.figures) for found in (before, last)]
    for number in range(2, tracing.members):
        level = costs[0] + (number - 1) / (tracing.members - 1) * (costs[1] - costs[0])
        before = searched(number, before.x, first, (_at_most(second, level),))
        yield number, before


def _at_most(aim: Aim, cost: float) -> Limit:
    """The limit that keeps what is to be small from being above a value."""
    lower, upper = (-cost, math.inf) if aim.maximise else (-math.inf, cost)
    return Limit(figure=aim.figure, lower=lower, upper=upper, size=aim.size)
