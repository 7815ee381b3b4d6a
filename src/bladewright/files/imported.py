"""A design imported from another program's file, with what was changed and points to measure it with."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from bladewright.designs import Design
from bladewright.errors import DesignError
from bladewright.nurbs.basis import Reals

AnyDesign = TypeVar("AnyDesign", bound=Design)
"""the family that a program's designs belong to"""
DISTANCE_TOLERANCE = 1e-5
"""of the blade's extent: how much nearer a place may be that is passed over while distances are measured"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Imported(Generic[AnyDesign]):
    """A design from another program's file."""

    design: AnyDesign
    program: str
    """whose file it is"""
    kept: tuple[str, ...]
    """what is as it was, each a sentence"""
    changed: tuple[str, ...]
    """what is not, each a sentence"""
    notes: tuple[str, ...] = ()
    """what else is to be known of the file, each a sentence"""
    points: Mapping[str, Reals]
    """points (k, 2) or (k, 3) [m] of the other program's sides, by the side that they should lie on"""
    source: str = "its own sides"
    """where the points are from"""

    def distances(self, built: Any) -> Reals:
        """Distances (n,) [m] of the other program's points from the sides of what the design builds."""
        from bladewright.nurbs.closest import closest_on_curve, closest_on_surface

        found = []
        for name, points in self.points.items():
            if points.shape[1] == 2:
                found.append(closest_on_curve(built.curves[name], points).distances)
            else:
                found.append(closest_on_surface(built.surfaces[name], points, tolerance=DISTANCE_TOLERANCE).distances)
        return np.concatenate(found)


def most_blades_apart(most: int, check: Callable[[int], None]) -> int:
    """The largest number of blades, at most `most`, at which `check` does not refuse the design's blade_count.

    Raises DesignError where it refuses something else.
    """

    def apart(count: int) -> bool:
        try:
            check(count)
        except DesignError as error:
            if "blade_count" in str(error):
                return False
            raise
        return True

    if apart(most):
        return most
    low, high = 1, most
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if apart(middle) else (low, middle)
    return low
