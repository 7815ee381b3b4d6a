"""The outline of a section by suction and pressure side: edges and sides in fixed parts of s."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.bezier import bernstein
from bladewright.nurbs.compatible import joined
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import reversed as backwards
from bladewright.section.outline import Edge, EdgeDerivatives, Joint, Outline, by_parts
from bladewright.section.power_series import polynomial_points
from bladewright.section.suction_pressure.edges import Bends, Continuity, Corners, edge_camber, edge_polynomial
from bladewright.section.suction_pressure.limits import check_crossing, check_reparametrisation
from bladewright.section.suction_pressure.side import DEGREE, Side

EDGE = 0.1
"""s that each edge takes: an edge is a few hundredths of the chord long, and its curvature asks for more than its share
of the parameter [-]"""
SHARE = EDGE / (1.0 - 2.0 * EDGE)
"""s of an edge over that of a side [-]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class SuctionPressureOutline(Outline):
    """Sections of two edges and two sides; with C2 edges each side is twice differentiable by s where it joins them."""

    corners: tuple[Corners, Corners]
    """leading and trailing"""
    upper: Side
    lower: Side
    continuity: Continuity
    suction_side: str
    """upper or lower"""
    by_thickness: bool
    """whether the pressure side is given by thicknesses"""

    @cached_property
    def edges(self) -> tuple[Array, Array]:
        """Coefficients (..., 5 or 7, 2) of the leading and the trailing edge in powers of -1 to 1."""
        leading, trailing = (
            edge_polynomial(corners, self._bends(end), self.continuity) for end, corners in enumerate(self.corners)
        )
        return leading, trailing

    def _bends(self, end: int) -> Bends:
        return self.upper.bends[end], self.lower.bends[end]

    @property
    def leading_edge(self) -> Edge:
        """Round: one polynomial across the nose."""
        return _meeting(self.edges[0], 1.0)

    @property
    def trailing_edge(self) -> Edge:
        """Round, as the leading edge."""
        return _meeting(self.edges[1], -1.0)

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The corners, and the inner knots of both sides."""
        knots = np.unique(np.concatenate([side.knots[DEGREE + 1 : -DEGREE - 1] for side in (self.upper, self.lower)]))
        smooth = 1 if self.continuity == "C1" else 2
        inner = [Joint(float(EDGE + w * (1.0 - 2.0 * EDGE)), DEGREE - 1) for w in knots]
        return (Joint(EDGE, smooth), *inner, Joint(1.0 - EDGE, smooth))

    def check_limits(self, where: Sequence[str]) -> None:
        names = ("suction", "pressure") if self.suction_side == "upper" else ("pressure", "suction")
        for name, side in zip(names, (self.upper, self.lower), strict=True):
            check_reparametrisation(name, side, where)
        check_crossing(self.upper, self.lower, where, suction_side=self.suction_side, by_thickness=self.by_thickness)

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., len(s), 2) of both sides."""
        found = []
        for side, sign in ((self.upper, 1.0), (self.lower, -1.0)):
            first, middle, last = _parts(s)
            parts = [
                (first, polynomial_points(self.edges[0], sign * s[first] / EDGE)),
                (middle, side.points(_fractions(s[middle]))),
                (last, polynomial_points(self.edges[1], sign * (1.0 - s[last]) / EDGE)),
            ]
            found.append(by_parts(parts, len(s)))
        return found[0], found[1]

    def camber(self, s: Reals) -> Array:
        """The middle between the sides at equal s, which the edges' camber lines continue to the noses."""
        first, middle, last = _parts(s)
        w = _fractions(s[middle])
        parts = [
            (first, edge_camber(self.corners[0], self._bends(0), s[first] / EDGE)),
            (middle, 0.5 * (self.upper.points(w) + self.lower.points(w))),
            (last, edge_camber(self.corners[1], self._bends(1), (1.0 - s[last]) / EDGE)),
        ]
        return by_parts(parts, len(s))


def _meeting(edge: Array, direction: float) -> Edge:
    point, first, second = (edge[..., k, :] * EDGE**-k for k in range(3))
    return Edge.rounded(EdgeDerivatives(point, direction * first, 2.0 * second))


Mask = NDArray[np.bool_]


def _parts(s: Reals) -> tuple[Mask, Mask, Mask]:
    first, last = s < EDGE, s > 1.0 - EDGE
    return first, ~first & ~last, last


def _fractions(s: Reals) -> Reals:
    return np.clip((s - EDGE) / (1.0 - 2.0 * EDGE), 0.0, 1.0)


def closed_curve(outline: SuctionPressureOutline) -> Curve:
    """One closed B-spline curve, in chords and unstaggered, of the first section of an outline.

    From the corner of the leading edge and the upper side: upper side, trailing edge, lower side backwards, leading
    edge. Its degree is that of the edges, 4 (C1) or 6 (C2), to which the sides are elevated; each piece is one unit of
    its parameter long, and the pieces meet at knots of multiplicity `degree`, tangents and with C2 edges curvatures
    alike. Voss et al. 2025, section 3.
    """
    leading, trailing = (_bezier(edge[0]) for edge in outline.edges)
    upper, lower = (_spline(side) for side in (outline.upper, outline.lower))
    return joined([upper, backwards(trailing), backwards(lower), leading])


def _spline(side: Side) -> Curve:
    return Curve(control_points=side.controls[0], knots=side.knots, degree=DEGREE)


def _bezier(coefficients: Array) -> Curve:
    """The polynomial over t in [-1, 1] as a Bezier curve over [0, 1], by its values at Chebyshev places."""
    degree = len(coefficients) - 1
    places: Reals = 0.5 * (1.0 - np.cos(np.pi * np.arange(degree + 1) / degree))
    points = polynomial_points(coefficients, 2.0 * places - 1.0)
    net = np.linalg.solve(bernstein(degree, places), points)
    net[0], net[-1] = points[0], points[-1]
    knots = np.repeat([0.0, 1.0], degree + 1)
    return Curve(control_points=net, knots=knots, degree=degree)
