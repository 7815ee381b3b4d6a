"""A Pareto set: the designs of a search of which none is better than another in every aim."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, final

import numpy as np

from bladewright.display import Shown
from bladewright.nurbs.basis import Reals
from bladewright.studies.goals import Goals, Limit
from bladewright.studies.optimality import Optimality
from bladewright.studies.runs import Runs

FEASIBLE = 1e-6
"""Largest violation of a constraint, in its size, that a member may have."""
COLUMNS = 8
"""Most figures that the text has a column for; of more, those of the aims alone."""
SHOWN = 20
"""Most members that the text lists."""


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class ParetoSet(Shown):
    """The members of a search's front, and all its runs."""

    shown_as: ClassVar[str] = "pareto"

    name: str
    """of the study"""
    runs: Runs
    """all designs that were looked at"""
    goals: Goals
    """what the search was after"""
    start_figures: Mapping[str, float]
    """those that it began with"""
    optimality: Mapping[int, Optimality]
    """how well the conditions of an optimum hold, by number of the run, where the search had derivatives"""

    tolerance: float
    """of these conditions"""

    @cached_property
    def members(self) -> tuple[int, ...]:
        """Numbers of the runs in the set, in the order of the first aim."""
        costs = np.array([self.goals.costs(row) for row in self._held.values()]).reshape(-1, len(self.goals.aims))
        numbers = list(self._held)
        chosen = sorted(np.flatnonzero(nondominated(costs)), key=lambda place: tuple(costs[place]))
        return tuple(numbers[place] for place in chosen)

    @property
    def passed(self) -> bool:
        """Whether there are members, and every search with derivatives has ended at an optimum."""
        return bool(self.members) and not self.failures

    @property
    def failures(self) -> tuple[str, ...]:
        """A sentence for each member at which a search with derivatives has not ended at an optimum."""
        return tuple(
            f"run {number}: {each}"
            for number, found in self.optimality.items()
            for each in found.failures(self.tolerance)
        )

    @property
    def headings(self) -> list[str]:
        """Names and units of the figures of `table`."""
        return [self.runs.heading(name) for name in self._shown]

    @property
    def table(self) -> Reals:
        """(m, k) figures of the members: those of the aims, then those of the limits."""
        return self._figures(self.members)

    @property
    def others(self) -> Reals:
        """(n, k) the same of all other designs that keep the limits."""
        return self._figures([number for number in self._held if number not in set(self.members)])

    @property
    def aims(self) -> list[str]:
        """Names and units of what is to be small or large."""
        return [self.runs.heading(aim.figure) for aim in self.goals.aims]

    @property
    def start(self) -> Reals:
        """(k,) figures that the search began with, in the order of `table`."""
        return np.array([self.start_figures[name] for name in self._shown])

    @cached_property
    def best(self) -> Runs:
        """The members alone, with the figures of aims and limits."""
        places = [self.runs.numbers.index(number) for number in self.members]
        return replace(
            self.runs,
            numbers=self.members,
            parameters={name: [values[place] for place in places] for name, values in self.runs.parameters.items()},
            figures={name: self.runs.figures[name][places] for name in self._shown},
            verdicts=tuple(self.runs.verdicts[place] for place in places),
            reasons={},
            files={},
        )

    @property
    def nearest(self) -> tuple[int, Limit, float] | None:
        """The run that comes nearest to keeping all limits, the limit that it misses most, and by how much of its size.

        None where no run has figures, or the search has no limits.
        """
        if not (self.goals.limits and self._measured):
            return None
        excesses = {number: self.goals.excesses(row) for number, row in self._measured.items()}
        number = min(excesses, key=lambda each: float(np.max(excesses[each])))
        worst = int(np.argmax(excesses[number]))
        return number, self.goals.limits[worst], float(excesses[number][worst])

    def design(self, member: int) -> Any:
        """The design of a member by the number of its run; where the study has several, all of them by name."""
        return self.runs.design(member)

    def to_csv(self, path: str | Path | None = None) -> str:
        """One line a member under a line of names with units, as text; written to `path` where one is given.

        Raises FileError where the file cannot be written.
        """
        return self.best.to_csv(path)

    def to_dict(self) -> dict[str, Any]:
        """Members, their figures and how well they meet the conditions of an optimum, for JSON."""
        return {
            "name": self.name,
            "runs": len(self.runs),
            "passed": self.passed,
            "aims": [{"figure": aim.figure, "maximise": aim.maximise} for aim in self.goals.aims],
            "members": list(self.members),
            "figures": {name: self.table[:, place].tolist() for place, name in enumerate(self._shown)},
            "parameters": {name: list(values) for name, values in self.best.parameters.items()},
            "kkt": {str(number): found.worst for number, found in self.optimality.items()},
            "failures": list(self.failures),
        }

    def __str__(self) -> str:
        words = " and ".join(f"{'most' if aim.maximise else 'least'} {aim.figure}" for aim in self.goals.aims)
        lines = [f"{self.name}: {len(self.members)} of {len(self.runs)} designs are Pareto optimal in {words}"]
        shown = self.members if len(self.members) <= SHOWN else self._spread()
        count = len(self._shown) if len(self._shown) <= COLUMNS else len(self.goals.aims)
        rows = [["run", *self.headings[:count], *(["KKT"] if self.optimality else [])]]
        for number, figures in zip(shown, self._figures(shown), strict=True):
            kkt = [f"{self.optimality[number].worst:.1e}"] if number in self.optimality else []
            rows.append([str(number), *(f"{value:.6g}" for value in figures[:count]), *kkt])
        widths = [max(len(row[place]) for row in rows if place < len(row)) for place in range(len(rows[0]))]
        lines += ["  " + "  ".join(map(str.rjust, row, widths)) for row in rows]
        if len(shown) < len(self.members):
            lines.append(f"  {len(self.members) - len(shown)} more stand between these; to_csv has all")
        return "\n".join([*lines, *self.failures])

    def __repr__(self) -> str:
        return f"<ParetoSet of {self.name}: {len(self.members)} of {len(self.runs)} designs>"

    @property
    def _shown(self) -> list[str]:
        aims, limits = self.goals.aims, self.goals.limits
        return list(dict.fromkeys([*(aim.figure for aim in aims), *(limit.figure for limit in limits)]))

    @cached_property
    def _measured(self) -> dict[int, Mapping[str, float]]:
        """The figures of all designs that have some, by number."""
        return {
            self.runs.numbers[place]: {name: float(values[place]) for name, values in self.runs.figures.items()}
            for place in np.flatnonzero(self.runs.good)
        }

    @cached_property
    def _held(self) -> dict[int, Mapping[str, float]]:
        """The same of those that keep the limits."""
        return {number: row for number, row in self._measured.items() if np.all(self.goals.excesses(row) <= FEASIBLE)}

    def _figures(self, numbers: Sequence[int]) -> Reals:
        rows = [[self._held[number][name] for name in self._shown] for number in numbers]
        return np.array(rows).reshape(-1, len(self._shown))

    def _spread(self) -> tuple[int, ...]:
        """Members at equal steps along the first aim's order."""
        places = np.linspace(0, len(self.members) - 1, SHOWN).round().astype(int)
        return tuple(self.members[place] for place in places)


def nondominated(costs: Reals) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Whether each row (n,) of costs (n, k) is dominated by no other: none is as small everywhere; of equals the first.

    >>> nondominated(np.array([[1.0, 3.0], [2.0, 2.0], [2.0, 4.0], [1.0, 3.0]])).tolist()
    [True, True, False, False]
    """
    kept = np.empty((0, costs.shape[1]))
    found = np.zeros(len(costs), dtype=bool)
    for place in np.lexsort(costs.T[::-1]):
        if not np.any(np.all(kept <= costs[place], axis=1)):
            found[place], kept = True, np.vstack([kept, costs[place]])
    return found
