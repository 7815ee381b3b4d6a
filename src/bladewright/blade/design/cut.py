"""Cuts of a blade by surfaces of revolution, as a design."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Annotated

import numpy as np

from bladewright.blade.design.meridional_curve import ControlPolygon, StraightsAndArcs, ThroughPoints
from bladewright.blade.flow_path.meridional_curve import MeridionalCurve, spline_on
from bladewright.designs import Limits, Part, parameter
from bladewright.errors import DesignError
from bladewright.nurbs.basis import Reals
from bladewright.section import checks
from bladewright.section.tagged_unions import ByKey

RADIUS = Limits(0.0, float("inf"), "a radius must be positive")


@dataclass(frozen=True, kw_only=True)
class AtRadius(Part):
    """A cylinder about the machine axis, or a plane of constant z in a cascade."""

    radius: float = parameter("length", limits=RADIUS)
    """its radius, or z [length]"""

    def __post_init__(self) -> None:
        checks.parameters(self)

    def points_within(self, metre: float, low: Reals, high: Reals) -> Reals:
        """Its two ends (2, 2) [m] in a box of (x, r), for pictures."""
        return np.array([[each[0], metre * np.real(self.radius)] for each in (low, high)])

    def line(self, metre: float) -> MeridionalCurve:
        """A piece of the straight line in (x, r) [m], from x = 0 downstream."""
        radius = metre * np.asarray(self.radius)
        start, end = (np.stack(np.broadcast_arrays(x, radius), axis=-1) for x in (0.0, metre))
        return spline_on(np.stack([start, end], axis=-2), 1)


@dataclass(frozen=True, kw_only=True)
class AtX(Part):
    """A plane across the machine axis."""

    x: float = parameter("length")
    """its axial place [length]"""

    def __post_init__(self) -> None:
        checks.parameters(self)

    def points_within(self, metre: float, low: Reals, high: Reals) -> Reals:
        """Its two ends (2, 2) [m] in a box of (x, r), for pictures."""
        return np.array([[metre * np.real(self.x), each[1]] for each in (low, high)])

    def line(self, metre: float) -> MeridionalCurve:
        """A piece of the straight line in (x, r) [m], from the axis outwards."""
        x = metre * np.asarray(self.x)
        start, end = (np.stack(np.broadcast_arrays(x, r), axis=-1) for r in (0.0, metre))
        return spline_on(np.stack([start, end], axis=-2), 1)


CutCurve = Annotated[AtRadius | AtX | ThroughPoints | ControlPolygon | StraightsAndArcs, ByKey()]
"""Where a blade is cut: at a radius, at an axial place, or along a curve in (x, r)."""


@dataclass(frozen=True, kw_only=True)
class Cut(Part):
    """What is cut off a blade: its ends at hub and tip, and its edges.

    Laws keep the span and the chord of the uncut blade. The cuts of hub and tip are walls of passage and disc.
    """

    hub: CutCurve | None = None
    """the blade begins here, instead of at the hub"""
    tip: CutCurve | None = None
    """the blade ends here, instead of at the shroud"""
    leading_edge: CutCurve | None = None
    """the blade begins here along the flow, with a blunt face"""
    trailing_edge: CutCurve | None = None
    """the blade ends here along the flow, with a blunt face"""

    def __post_init__(self) -> None:
        kinds = (AtRadius, AtX, ThroughPoints, ControlPolygon, StraightsAndArcs)
        given = {each.name: getattr(self, each.name) for each in fields(self)}
        for name, value in given.items():
            if value is not None and not isinstance(value, kinds):
                raise DesignError(
                    f"{name} is {value!r}: a cut is at a radius, at an x, or along a curve in (x, r): write "
                    f"{{ radius = 93 }}, {{ x = 12 }} or {{ points = [[0, 50], [20, 52]] }}"
                )
        if all(value is None for value in given.values()):
            raise DesignError(f"the cut is empty: give {', '.join(given)}, or leave the table out")
