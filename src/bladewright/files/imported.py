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
"""class of the designs that a program's files are read as"""
DISTANCE_TOLERANCE = 1e-5
"""Error, as a fraction of the blade's extent, that a measured distance may have because another point of the surface is
nearer still. Distances are shown with two or three digits; less would cost time for nothing that is seen."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Imported(Generic[AnyDesign]):
    """A design from another program's file."""

    design: AnyDesign
    program: str
    """name of the other program"""
    kept: tuple[str, ...]
    """what the design has exactly as the other program has it, each a sentence"""
    changed: tuple[str, ...]
    """what it has otherwise, each a sentence"""
    notes: tuple[str, ...] = ()
    """remarks on the file, each a sentence"""
    points: Mapping[str, Reals]
    """points (k, 2) or (k, 3) [m] of the other program's blade, by the side that they should lie on"""
    source: str = "its own sides"
    """where the points come from"""

    def distances(self, built: Any) -> Reals:
        """Distances (n,) [m] of the other program's points from the sides of what this design builds."""
        from bladewright.nurbs.closest import closest_on_curve, closest_on_surface

        found = []
        for name, points in self.points.items():
            if points.shape[1] == 2:
                found.append(closest_on_curve(built.curves[name], points).distances)
            else:
                found.append(closest_on_surface(built.surfaces[name], points, tolerance=DISTANCE_TOLERANCE).distances)
        return np.concatenate(found)


def most_blades_apart(most: int, check: Callable[[int], None]) -> int:
    """The largest number of blades, up to `most`, that do not intersect: that `check` does not refuse.

    For files that state no number, or one without effect. Raises DesignError where `check` refuses something other than
    the blade count.
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
