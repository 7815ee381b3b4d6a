"""Uniform quartic B-splines: their polynomials a segment, and a thickness whose parameter they are."""

import numpy as np

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.numerics.roots import bracketed_root
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span
from bladewright.section.outline import Joint
from bladewright.section.thickness.law import EdgeKind, Thickness
from bladewright.section.thickness.pieces import check_positive
from bladewright.section.thickness.series import Series, joined_series, polynomial, variable

QUARTIC = np.array(
    [[1, 11, 11, 1, 0], [-4, -12, 12, 4, 0], [6, -6, -6, 6, 0], [-4, 12, -12, 4, 0], [1, -4, 6, -4, 1]]
) / np.array(24.0)
"""row k: coefficients of t^k, 0 <= t <= 1, from a segment's five control points"""


def segments(controls: Array) -> Array:
    """Coefficients (..., n - 4, 5) of the powers of t on each segment of control points (..., n)."""
    count = controls.shape[-1] - 4
    windows = np.stack([controls[..., k : k + 5] for k in range(count)], axis=-2)
    return windows @ QUARTIC.T


def value_at(coefficients: Array, tau: Array) -> tuple[Array, Array]:
    """Values and slopes (..., k) at tau (..., k), counted in segments, of polynomials (..., n, 5)."""
    shape = np.broadcast_shapes(coefficients.shape[:-2], tau.shape[:-1])
    index = np.clip(np.floor(np.real(tau)), 0, coefficients.shape[-2] - 1).astype(np.intp)
    index = np.broadcast_to(index, (*shape, tau.shape[-1]))
    spread = np.broadcast_to(coefficients, (*shape, *coefficients.shape[-2:]))
    chosen = np.take_along_axis(spread, index[..., None], axis=-2)
    local, value, slope = tau - index, chosen[..., 4], 4.0 * chosen[..., 4]
    for power in (3, 2, 1, 0):
        value = value * local + chosen[..., power]
        slope = slope * local + power * chosen[..., power] if power else slope
    return value, slope


def parameter_of(coefficients: Array, values: Array, low: float, high: float) -> Array:
    """The tau (..., k) between low and high where rising polynomials (..., n, 5) have values (..., k)."""
    shape = np.broadcast_shapes((*coefficients.shape[:-2], 1), values.shape)

    def function(tau: Array) -> tuple[Array, Array]:
        value, slope = value_at(coefficients, tau)
        return value - values, slope

    return bracketed_root(function, np.full(shape, low), np.full(shape, high))


class UniformThickness(Thickness):
    """Control points (..., m, n) of chord fraction and half thickness from the leading to the trailing edge."""

    def __init__(self, u: Array, half: Array, *, leading: EdgeKind, trailing: EdgeKind) -> None:
        self._u, self._half = segments(u), segments(half)
        self._leading, self._trailing = leading, trailing
        if leading == "round":
            # even and odd about the edge to the bit, so that nothing cancels near it
            self._u[..., 0, [0, 1, 3]] = 0.0
            self._half[..., 0, [0, 2]] = 0.0

    @property
    def joints(self) -> tuple[Joint, ...]:
        count = self._count
        return tuple(Joint(k / count, 3) for k in range(1, count))

    @property
    def leading(self) -> EdgeKind:
        return self._leading

    @property
    def trailing(self) -> EdgeKind:
        return self._trailing

    @property
    def _count(self) -> int:
        return int(self._u.shape[-2])

    def series(self, s: Reals, order: int) -> tuple[Series, Series]:
        tau = s * self._count
        owner = np.clip(np.floor(tau), 0, self._count - 1).astype(np.intp)
        u: list[Series] = []
        half: list[Series] = []
        for k in np.unique(owner):
            local = variable(tau[owner == k] - k, order, float(self._count))
            for parts, all_segments in ((u, self._u), (half, self._half)):
                parts.append(polynomial([all_segments[..., k, power, None] for power in range(5)], local))
        return joined_series(u), joined_series(half)

    def half_at(self, u: Reals) -> Array:
        return value_at(self._half, parameter_of(self._u, u, 0.0, float(self._count)))[0]

    def check(self, path: str, span: Span) -> None:
        """Refuse a chord fraction that falls and a thickness that is not positive; raises DesignError."""
        s = np.linspace(0.0, 1.0, 20 * self._count + 1)[1:-1]
        u, slope = (np.real(each) for each in self.series(s, 1)[0].coefficients)
        if not np.all(slope > 0.0):
            worst = np.unravel_index(np.argmin(slope), slope.shape)
            place = span.v[worst[-2]] if slope.shape[-2] == len(span.v) else span.v[0]
            raise DesignError(
                f"{path} folds back at u = {u[worst]:.3g}, span fraction {place:.4g}: its spline must run forwards; "
                f"put the maximum near 0.3 of the chord, where this law works, or take another law"
            )
        check_positive(self, path, span)
