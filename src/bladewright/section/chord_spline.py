"""A number along the chord as a quartic B-spline of freely placed control points."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.numerics.elementary import Array, joined
from bladewright.section.piecewise import by_first
from bladewright.section.thickness.series import Series
from bladewright.section.thickness.series import polynomial as composed
from bladewright.section.thickness.uniform import segments


@dataclass(frozen=True, kw_only=True, eq=False)
class ChordSpline:
    """Values f(u) of the quartic B-spline curve (u(t), f(t)) on the uniform basis.

    The control polygon is extended by two points at each end, its reflections in the first and the last control point:
    so the curve meets these, with no second derivative by t. Reference: Nemnem et al. 2014, eqs. 7 and 19.
    """

    places: Array
    """u (..., m, n) of the control points, rising from 0 to 1, n >= 3"""
    values: Array
    """f (..., m, n) of the control points"""

    @cached_property
    def _powers(self) -> Array:
        """Coefficients (..., m, n, 5, 2) of u and f on each segment; the first and the last are used by half."""
        places, values = np.broadcast_arrays(self.places, self.values)
        return np.stack([_segments(places), _segments(values)], axis=-1)

    @property
    def joints(self) -> Array:
        """Places u (..., m, n - 1) where f has three continuous derivatives."""
        return self._powers[..., 1:, 0, 0]

    def derivatives(self, u: Array) -> tuple[Array, Array, Array]:
        """f and its first two derivatives (..., m, k) at u (..., m, k) or (k,) in [0, 1]."""
        point, first, second = by_first(self._powers, u)
        run, rise = first[..., 0], first[..., 1]
        return point[..., 1], rise / run, (second[..., 1] - rise / run * second[..., 0]) / run**2

    def series(self, u: Series) -> Series:
        """Power series of f at a series of u, up to the second power."""
        value, slope, bend = self.derivatives(u.value)
        return composed([value, slope, 0.5 * bend], u - u.value)


def _segments(points: Array) -> Array:
    """Powers (..., n, 5) of a curve with control points (..., n) on its segments."""
    before = 2.0 * points[..., :1] - points[..., 2:0:-1]
    after = 2.0 * points[..., -1:] - points[..., -2:-4:-1]
    return segments(joined([before, points, after], axis=-1))
