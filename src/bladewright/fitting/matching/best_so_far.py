"""The nearest designs that searches have reached, for when a match is interrupted or cannot be built."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any

import numpy as np

from bladewright.errors import BladewrightError, FitError

KEPT_DESIGNS = 3
"""designs of as many parameters that are kept, as the nearest may not be built (design/matching_constants.md)"""


@dataclass(frozen=True, eq=False)
class BestSoFar:
    """The nearest matches so far, by their number of parameters, as the last may be interrupted, or cannot be built."""

    found: dict[int, list[Any]] = field(default_factory=dict)

    def note(self, found: Any) -> None:
        """Keeps the end of a round if few of as many parameters are nearer."""
        if np.isfinite(found.mean_distance):
            alike = [*self.found.get(count := len(found.problem.paths), ()), found]
            self.found[count] = sorted(alike, key=lambda each: each.mean_distance)[:KEPT_DESIGNS]

    def built(
        self, least_tolerance: float = 0.0, suits: Callable[[Any], bool] = lambda _: True
    ) -> tuple[Any, Any] | None:
        """The nearest match that suits and can be built, no finer than a tolerance, and what it builds, or None."""
        suitable = filter(suits, chain.from_iterable(self.found.values()))
        for found in sorted(suitable, key=lambda each: each.mean_distance):
            tolerance = getattr(found.design, "tolerance", None)
            design = found.design.changed({} if tolerance is None else {"tolerance": max(tolerance, least_tolerance)})
            try:
                return replace(found, design=design), design.build()
            except BladewrightError:
                continue
        return None

    def instead_of(self, refused: Any, error: Exception, *, structured: bool) -> tuple[Any, Any, str]:
        """The same of the family of a match that cannot be built, and a note; raises FitError where there is none.

        It has as many parameters at most, and the same ones where the structure is given (`structured`).
        """
        paths = refused.problem.paths

        def suits(found: Any) -> bool:
            alike = found.problem.paths == paths if structured else len(found.problem.paths) <= len(paths)
            return alike and isinstance(found.design, type(refused.design))

        found, refusal = self.built(suits=suits), f"the nearest design cannot be built ({error})"
        if found is None:
            raise FitError(f"{refusal}; give a start design, or bounds that keep off it") from error
        return *found, f"{refusal}, and the nearest that can is given"
