"""The metal that carries a row of blades: a disc under the hub, or a ring around the shroud, as a design."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bladewright.blade.design.meridional_curve import StraightsAndArcs
from bladewright.designs import Limits, Part, Points, parameter
from bladewright.errors import DesignError
from bladewright.section import checks

SIZE = Limits(0.0, float("inf"), "it must be positive")


@dataclass(frozen=True, kw_only=True)
class Outline(Part):
    """Lines between points in (x, r), inner points rounded by tangent arcs where radii are given.

    Both ends lie on the wall that carries the blades, upstream and downstream of them.
    """

    points: Points = parameter("length")
    """from the wall upstream of the blades to the wall downstream of them, three or more [length]"""
    radii: tuple[float, ...] = parameter("length", default=())
    """radius of the arc at each inner point, 0 where it stays a corner; none given: all stay [length]"""

    def __post_init__(self) -> None:
        points = checks.points("points", self.points, 3)
        for i, point in enumerate(points):
            radius = f"points[{i}].r"
            checks.between(radius, point.r, 0.0, np.inf, "the outline must keep off the axis; leave a bore")
        if checks.is_sequence(self.radii) and self.radii and len(self.radii) != len(points) - 2:
            raise DesignError(
                f"radii has {len(self.radii)} entries, but points has {len(points) - 2} inner points: give one radius "
                "for each, or none"
            )
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "radii", self.pieces.radii if self.radii else ())

    @property
    def pieces(self) -> StraightsAndArcs:
        """The same as a meridian."""
        return StraightsAndArcs(corners=self.points, radii=self.radii)


@dataclass(frozen=True, kw_only=True)
class Disc(Part):
    """What carries the blades: inside an outline, or a thin rim of constant thickness."""

    outline: Outline | None = None
    """its meridional outline, from the wall upstream of the blades to the wall downstream of them"""
    thickness: float | None = parameter("length", limits=SIZE, default=None)
    """instead of an outline: the thickness of a rim along the wall [length]"""
    upstream: float | None = parameter("length", limits=SIZE, default=None)
    """how far a rim reaches upstream of the blade's leading edge along the wall; a tenth of the blade's length where
    not given [length]"""
    downstream: float | None = parameter("length", limits=SIZE, default=None)
    """how far a rim reaches downstream of the blade's trailing edge along the wall; a tenth of the blade's length where
    not given [length]"""

    def __post_init__(self) -> None:
        if (self.outline is None) == (self.thickness is None):
            both = "neither is" if self.outline is None else "both are"
            raise DesignError(f"outline or thickness: {both} given; give one of the two")
        for name in ("upstream", "downstream"):
            if getattr(self, name) is not None and self.outline is not None:
                raise DesignError(f"{name} is given beside an outline, whose ends say how far it reaches: drop it")
        checks.parameters(self)
