"""The nearest designs that a match has come to, for when it is interrupted between two searches."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from bladewright.errors import DesignError

MOST = 3
"""designs that are kept: the nearest may be one that cannot be built"""


@dataclass(frozen=True, eq=False)
class Standby:
    """The nearest designs so far, nearest first."""

    found: list[tuple[float, Any]] = field(default_factory=list)

    def note(self, found: Any) -> None:
        """Keep where a round of a search ended, if few are nearer."""
        if np.isfinite(found.off):
            self.found.append((found.off, found))
            self.found.sort(key=lambda each: each[0])
            del self.found[MOST:]

    def built(self) -> tuple[Any, Any] | None:
        """The nearest that can be built, and what it builds; None where there is none."""
        for _, found in self.found:
            try:
                return found, found.design.build()
            except DesignError:
                continue
        return None
