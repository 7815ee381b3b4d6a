"""Control points of a segment: a uniform cubic B-spline with given point, tangent and curvature vectors at its ends.

The end control points follow from the curve's derivatives at a clamped end, of degree p and with the first two inner
knots at a and b: C' = p (P1 - P0) / a and C'' = p (p - 1) / a ((P2 - P1) / b - (P1 - P0) / a). With the tangent vector
scaled by SF and the curvature vector by SF^2, dy/dx and d2y/dx2 stay as they are. Reference: Tortora et al. 2023,
equations 25 and 30; their 37 and 38 print SF for SF^2, and signs that do not follow from 33 and 34.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from bladewright.numerics.elementary import Array, concatenated
from bladewright.nurbs.basis import Reals, basis, breaks, uniform_knots

DEGREE = 3
"""of the segments"""


@dataclass(frozen=True, kw_only=True, eq=False)
class SegmentEnd:
    """What is given at an end of a segment, its vectors along the segment's sense and for SF = 1."""

    point: Array
    """(..., m, 2)"""
    tangent: Array | None = None
    """(..., m, 2) by the curve's parameter in [0, 1]; None: the control points decide"""
    curvature: Array | None = None
    """(..., m, 2) second derivative by it; None: the control points decide"""
    scale: Array | float = 1.0
    """SF (..., m)"""

    @property
    def continuity(self) -> int:
        """How many derivatives are given."""
        return (self.tangent is not None) + (self.curvature is not None)

    def control_points(self, sign: float, near: float, far: float) -> list[Array]:
        """The 1 + `continuity` control points (..., m, 1, 2) from this end on, its inner knots `near` and `far` away.

        `sign` is 1 at the start of the curve and -1 at its end.
        """
        scale = np.asarray(self.scale)[..., None]
        found = [self.point]
        if self.tangent is not None:
            step = sign * (near / DEGREE) * scale * self.tangent
            found.append(self.point + step)
            if self.curvature is not None:
                bend = near / (DEGREE * (DEGREE - 1)) * scale**2 * self.curvature
                found.append(found[1] + far * (step / near + bend))
        return [each[..., None, :] for each in found]


@cache
def segment_knots(count: int) -> Reals:
    """The clamped uniform knots of a segment with so many control points, read-only."""
    knots = uniform_knots(count, DEGREE)
    knots.setflags(write=False)
    return knots


def control_points(start: SegmentEnd, inner: Array, end: SegmentEnd) -> Array:
    """All control points (..., m, n, 2) of a segment with inner control points (..., m, k, 2)."""
    knots = segment_knots(2 + start.continuity + end.continuity + inner.shape[-2])
    near, far = knots[DEGREE + 1], knots[DEGREE + 2]
    first, last = start.control_points(1.0, near, far), end.control_points(-1.0, near, far)
    return concatenated([*first, inner, *last[::-1]], axis=-2)


def powers(controls: Array) -> Array:
    """Coefficients (..., m, n - 3, 4, 2) of t^0 to t^3, 0 <= t <= 1, on the spans of a segment's curve."""
    count = controls.shape[-2]
    flat = _power_rows(count) @ controls
    return flat.reshape(*controls.shape[:-2], count - DEGREE, DEGREE + 1, 2)


@cache
def _power_rows(count: int) -> Reals:
    """The matrix (4 (n - 3), n) from control points to these coefficients."""
    knots, width = segment_knots(count), 1.0 / (count - DEGREE)
    factors = (1.0, width, width**2 / 2.0, width**3 / 6.0)
    starts = breaks(knots)[:-1]
    rows = np.stack([factor * basis(knots, DEGREE, starts, order) for order, factor in enumerate(factors)], axis=1)
    return rows.reshape(-1, count)
