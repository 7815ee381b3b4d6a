"""Uniform B-splines of freely placed control points, evaluated by the chord fraction."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.numerics.elementary import Array, concatenated
from bladewright.numerics.roots import bracketed_root
from bladewright.nurbs.basis import Reals
from bladewright.section.power_series import Series
from bladewright.section.power_series import polynomial as composed

NEWTON = 12
"""Newton steps before the bracketed search takes over: 6 suffice for control points unevenly placed
(design/section_constants.py)"""
QUARTIC = np.array(
    [[1, 11, 11, 1, 0], [-4, -12, 12, 4, 0], [6, -6, -6, 6, 0], [-4, 12, -12, 4, 0], [1, -4, 6, -4, 1]]
) / np.array(24.0)
"""row k: coefficients of t^k, 0 <= t <= 1, from a segment's five control points"""


def by_abscissa(powers: Array, values: Array) -> tuple[Array, Array, Array]:
    """Coordinates (..., m, k, d) where the first one has given values, and their two derivatives by the parameter t.

    `powers` (..., m, n, p, d) are coefficients of t^0, t^1 ... on n segments, 0 <= t <= 1 on each; the first coordinate
    rises throughout. `values` (..., m, k) or (k,) lie in its range. Batches that share their real parts, as those of a
    complex step do, are solved once.
    """
    real = _unbatched(np.real(powers[..., 0]), 3)
    wanted = _unbatched(np.real(values), 2)
    segment = np.sum(wanted[..., None] >= real[..., None, 1:, 0], axis=-1)
    shape = np.broadcast_shapes(real.shape[:-2], segment.shape[:-1])
    segment = np.broadcast_to(segment, (*shape, segment.shape[-1]))
    own = np.broadcast_to(real, (*shape, *real.shape[-2:]))
    t = _parameter(np.take_along_axis(own, segment[..., None], axis=-2), wanted)
    found = [_summed(_monomials(t, segment, powers.shape[-3:-1], order), powers) for order in range(3)]
    if not (np.iscomplexobj(powers) or np.iscomplexobj(values)):
        return found[0], found[1], found[2]
    # the parameter's imaginary part, and by it those of all coordinates, to first order
    difference = np.imag(found[0][..., :1] - np.asarray(values)[..., None])
    step = -1j * difference / np.real(found[1][..., :1])
    third = _summed(_monomials(t, segment, powers.shape[-3:-1], 3), np.real(powers))
    rates = [*(np.real(each) for each in found[1:]), third]
    carried = [each + step * rate for each, rate in zip(found, rates, strict=True)]
    return carried[0], carried[1], carried[2]


def derived(powers: Array) -> Array:
    """Coefficients (..., p - 1) of the derivative of polynomials (..., p)."""
    return powers[..., 1:] * np.arange(1.0, powers.shape[-1])


def polynomial(powers: Array, t: Array) -> Array:
    """Values (...) of polynomials (..., p) at t (...)."""
    value = powers[..., -1]
    for k in range(powers.shape[-1] - 2, -1, -1):
        value = value * t + powers[..., k]
    return value


def _parameter(powers: Reals, values: Reals) -> Reals:
    """t (...) in [0, 1] at which rising polynomials (..., p) have the values (...)."""
    slopes = derived(powers)
    t = np.clip((values - powers[..., 0]) / np.sum(powers[..., 1:], axis=-1), 0.0, 1.0)
    for _ in range(NEWTON):
        after = np.clip(t - (polynomial(powers, t) - values) / polynomial(slopes, t), 0.0, 1.0)
        change, t = after - t, after
        if np.all(change**2 < 1e-28):
            return t
    zeros = np.zeros_like(t)
    return bracketed_root(lambda t: (polynomial(powers, t) - values, polynomial(slopes, t)), zeros, zeros + 1.0)


def _monomials(t: Reals, segment: Array, shape: tuple[int, int], order: int) -> Reals:
    """Derivatives (..., m, k, n p) of the powers of t on the segments, zero on all but a point's own."""
    count, terms = shape
    rows = np.zeros((*t.shape, terms))
    factor, power = np.ones(terms), np.ones_like(t)
    for k in range(order):
        factor *= np.arange(terms) - k
    for k in range(order, terms):
        rows[..., k] = factor[k] * power
        power = power * t
    own = segment[..., None] == np.arange(count)
    return (own[..., None] * rows[..., None, :]).reshape(*t.shape, count * terms)


def _summed(matrix: Reals, powers: Array) -> Array:
    """The real matrix (..., k, n p) times coefficients (..., n, p, d)."""
    flat = np.ascontiguousarray(powers.reshape(*powers.shape[:-3], -1, powers.shape[-1]))
    if not np.iscomplexobj(flat):
        return np.asarray(matrix @ flat)
    found: Array = matrix @ flat.view(np.float64)
    return found.view(np.complex128)


def _unbatched(values: Reals, rank: int) -> Reals:
    """One of the values along leading axes beyond `rank` where they are all the same there."""
    while values.ndim > rank and np.array_equal(values, np.broadcast_to(values[:1], values.shape)):
        values = values[0]
    return values


def segments(controls: Array) -> Array:
    """Coefficients (..., n - 4, 5) of the powers of t on each segment of control points (..., n)."""
    count = controls.shape[-1] - 4
    windows = np.stack([controls[..., k : k + 5] for k in range(count)], axis=-2)
    return windows @ QUARTIC.T


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
        point, first, second = by_abscissa(self._powers, u)
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
    return segments(concatenated([before, points, after], axis=-1))
