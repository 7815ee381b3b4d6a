"""The four pieces of a section as one closed curve."""

from typing import TYPE_CHECKING

import numpy as np

from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.bezier import bernstein
from bladewright.nurbs.compatible import joined
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import reversed as backwards
from bladewright.section.laws import Span
from bladewright.section.suction_pressure.edge import powers_at
from bladewright.section.suction_pressure.side import DEGREE, Side

if TYPE_CHECKING:
    from bladewright.section.suction_pressure.part import SuctionPressure


def merged(part: "SuctionPressure", v: float = 0.0) -> Curve:
    """One closed B-spline curve, in chords and unstaggered, of a section at v of the span.

    From the corner of the leading edge and the upper side: upper side, trailing edge, lower side backwards, leading
    edge. Its degree is that of the edges, 4 (C1) or 6 (C2), to which the sides are elevated; each piece is one unit of
    its parameter long, and the pieces meet at knots of multiplicity `degree`, tangents and with C2 edges curvatures
    alike. Voss et al. 2025, section 3.
    """
    outline = part.outline(Span(np.array([v])))
    leading, trailing = (_bezier(edge.coefficients[0]) for edge in outline.edges)
    upper, lower = (_spline(side) for side in (outline.upper, outline.lower))
    return joined([upper, backwards(trailing), backwards(lower), leading])


def _spline(side: Side) -> Curve:
    return Curve(control_points=side.controls[0], knots=side.knots, degree=DEGREE)


def _bezier(coefficients: Array) -> Curve:
    """The polynomial over t in [-1, 1] as a Bezier curve over [0, 1], by its values at Chebyshev places."""
    degree = len(coefficients) - 1
    places: Reals = 0.5 * (1.0 - np.cos(np.pi * np.arange(degree + 1) / degree))
    points = powers_at(coefficients, 2.0 * places - 1.0)
    net = np.linalg.solve(bernstein(degree, places), points)
    net[0], net[-1] = points[0], points[-1]
    knots = np.repeat([0.0, 1.0], degree + 1)
    return Curve(control_points=net, knots=knots, degree=degree)
