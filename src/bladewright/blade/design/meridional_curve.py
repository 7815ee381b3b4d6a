"""A meridian as a design: a curve in (x, r) through points, on control points, or of straight and arc pieces."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, ClassVar, Literal

import numpy as np

from bladewright.blade.flow_path.meridional_curve import MeridionalCurve, rounded_corners, spline_on, spline_through
from bladewright.designs import Part, Points, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section import checks
from bladewright.section.laws import stacked
from bladewright.section.tagged_unions import ByKey


class MeridianDesign(Part, ABC):
    """Base of the kinds of meridians."""

    polygon: ClassVar[bool]
    """whether the given points are control points or corners, and do not lie on the curve"""

    @property
    @abstractmethod
    def given(self) -> Points:
        """The points that the curve is given by."""

    @abstractmethod
    def line(self, metre: float) -> MeridionalCurve:
        """The native curve in metres of a design whose length unit is `metre` metres."""

    def points_within(self, metre: float, low: Reals, high: Reals) -> Reals:  # noqa: ARG002 - it has ends of its own
        """Points (n, 2) [m] of the real curve, for pictures."""
        return self.line(metre).drawn_points


@dataclass(frozen=True, kw_only=True)
class ThroughPoints(MeridianDesign):
    """The cubic spline with two continuous derivatives through points in (x, r)."""

    polygon: ClassVar[bool] = False

    points: Points = parameter("length")
    """points on the curve, two or more, no two in a row the same [length]"""
    spacing: Literal["length", "conformal"] = "length"
    """the spline's parameter: the sum of the chords, or of the chords over their mean radius, as m' is in T-Blade3"""
    ends: Literal["smooth", "released"] = "smooth"
    """one cubic over the first two and the last two intervals; or, as in T-Blade3, no second derivative at the first
    and no third at the last point"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", _apart("points", self.points))
        checks.choice("spacing", self.spacing, ["length", "conformal"])
        checks.choice("ends", self.ends, ["smooth", "released"])
        if self.spacing == "conformal":
            for i, point in enumerate(self.points):
                if np.min(np.real(point.r)) <= 0.0:
                    raise DesignError(
                        f"points[{i}].r is {float(np.min(np.real(point.r))):g}: spacing 'conformal' divides by the "
                        "radius, which must be positive; move the point off the axis, or take spacing 'length'"
                    )

    @property
    def given(self) -> Points:
        return self.points

    def line(self, metre: float) -> MeridionalCurve:
        return spline_through(_array(self.points, metre), conformal=self.spacing == "conformal", ends=self.ends)


@dataclass(frozen=True, kw_only=True)
class ControlPolygon(MeridianDesign):
    """The clamped uniform B-spline on control points in (x, r)."""

    polygon: ClassVar[bool] = True

    control_points: Points = parameter("length")
    """control points, two or more, no two in a row the same [length]"""
    degree: Literal[1, 2, 3, 4, 5] = 3
    """highest degree; the curve has min(n - 1, degree) with n control points"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "control_points", _apart("control_points", self.control_points))
        checks.integer("degree", self.degree, 1, 5, "a whole number is needed")

    @property
    def given(self) -> Points:
        return self.control_points

    def line(self, metre: float) -> MeridionalCurve:
        points = _array(self.control_points, metre)
        return spline_on(points, min(len(self.control_points) - 1, self.degree))


@dataclass(frozen=True, kw_only=True)
class StraightsAndArcs(MeridianDesign):
    """Straight pieces between corners in (x, r), each inner corner rounded by an arc that is tangent to both.

    An arc may use up the straight pieces beside it: a quarter bend is three corners and one radius. A corner whose
    radius is 0 stays one, and the curve has a joint without a continuous direction there.
    """

    polygon: ClassVar[bool] = True

    corners: Points = parameter("length")
    """first point, inner corners and last point, no two in a row the same [length]"""
    radii: tuple[float, ...] = parameter("length", default=())
    """radius of the arc at each inner corner, 0 where it is to stay one; none given: all stay [length]"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "corners", _apart("corners", self.corners))
        inner = len(self.corners) - 2
        if not checks.is_sequence(self.radii):
            raise DesignError(
                f"radii is {self.radii!r}: a list with one radius for each of the inner corners is needed"
            )
        radii = tuple(checks.number(f"radii[{i}]", value) for i, value in enumerate(self.radii)) or (0.0,) * inner
        if len(radii) != inner:
            raise DesignError(
                f"radii has {len(radii)} entries, but corners has {inner} inner corners: give one radius for each"
            )
        for i, radius in enumerate(radii):
            checks.between(f"radii[{i}]", radius, 0.0, np.inf, "a radius must not be negative", closed=True)
        object.__setattr__(self, "radii", radii)

    @property
    def given(self) -> Points:
        return self.corners

    def line(self, metre: float) -> MeridionalCurve:
        radii = metre * stacked(self.radii) if self.radii else np.zeros(0)
        return rounded_corners(_array(self.corners, metre), radii, metre)


Meridian = Annotated[ThroughPoints | ControlPolygon | StraightsAndArcs, ByKey()]
"""A curve in (x, r) of any kind: which one follows from what is given."""


def meridian_at(path: str, value: object) -> Meridian:
    """The value where it is a meridian, or a refusal."""
    if isinstance(value, ThroughPoints | ControlPolygon | StraightsAndArcs):
        return value
    raise DesignError(
        f"{path} is {value!r}: a curve in (x, r) is needed: its points, its control_points, or its corners with radii"
    )


def _apart(path: str, value: object) -> Points:
    """At least two points, no two in a row the same."""
    points = checks.points(path, value, 2)
    for i, (before, after) in enumerate(pairwise(points)):
        square = (np.real(after.x) - np.real(before.x)) ** 2 + (np.real(after.r) - np.real(before.r)) ** 2
        if not np.all(square > 0.0):
            raise DesignError(
                f"{path}[{i}] and {path}[{i + 1}] are the same point, "
                f"({float(np.ravel(np.real(after.x))[0]):g}, {float(np.ravel(np.real(after.r))[0]):g}): a curve cannot "
                "go through a point twice in a row; drop one of them"
            )
    return points


def _array(points: Points, metre: float) -> Array:
    flat = stacked([coordinate for point in points for coordinate in point])
    return metre * flat.reshape(*flat.shape[:-1], len(points), 2)
