"""NURBS curve of any degree and dimension."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import final

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BSpline

from bladewright.errors import GeometryError
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, frozen
from bladewright.nurbs.basis import checked_knots
from bladewright.nurbs.rational import curve_quotients, homogeneous


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Curve(FrozenRecord):
    """A NURBS curve C(u) = sum N_i(u) w_i P_i / sum N_i(u) w_i (Piegl and Tiller 1997, eq. 4.1).

    Its parameter runs over [knots[0], knots[-1]]; outside, the end polynomials (the end quotients of polynomials,
    where there are weights) are continued. An imaginary part of a parameter is carried to first order, as a complex
    step needs. Raises GeometryError where shapes, knots, degree and weights do not fit together.
    """

    control_points: Array
    """(n, d), real or complex"""
    knots: Array
    """(n + degree + 1,), clamped, non-decreasing"""
    degree: int
    weights: Array | None = None
    """(n,) with positive real parts, or None for a B-spline"""

    def __post_init__(self) -> None:
        points = frozen(self.control_points)
        if points.ndim == 0:
            raise GeometryError("control points of a curve have shape (): it must be (n, d)")
        object.__setattr__(self, "control_points", points)
        object.__setattr__(self, "knots", checked_knots(self.knots, self.degree, len(points), "knots"))
        if self.weights is not None:
            object.__setattr__(self, "weights", checked_weights(self.weights, points.shape[:-1]))

    def __repr__(self) -> str:
        kind = "" if self.weights is None else ", weighted"
        return f"<Curve: {len(self.control_points)} control points{kind}, degree {self.degree}>"

    @property
    def domain(self) -> tuple[float, float]:
        """The first and the last parameter."""
        return float(self.knots[0]), float(self.knots[-1])

    @cached_property
    def homogeneous(self) -> Array:
        """Control points (n, d), or (w P, w) of shape (n, d + 1) where there are weights."""
        return frozen(homogeneous(self.control_points, self.weights))

    @cached_property
    def _spline(self) -> BSpline:
        return BSpline.construct_fast(self.knots, self.homogeneous, self.degree)

    def __call__(self, u: ArrayLike) -> Array:
        """Points (..., d) at parameters u (...)."""
        return self.derivative(u, 0)

    def derivative(self, u: ArrayLike, order: int = 1) -> Array:
        """Derivatives (..., d) of the given order with respect to u."""
        if self.weights is not None or np.iscomplexobj(u):
            return self.derivatives(u, order)[order]
        found: Array = self._spline(np.asarray(u, dtype=np.float64), nu=order)
        return found

    def derivatives(self, u: ArrayLike, order: int) -> list[Array]:
        """The point and all derivatives up to `order`, [C, C', C'', ...], each (..., d)."""
        if np.iscomplexobj(u):
            real = self.derivatives(np.real(u), order + 1)
            step = 1j * np.reshape(np.imag(u), np.shape(u) + (1,) * (self.control_points.ndim - 1))
            return [value + step * slope for value, slope in pairwise(real)]
        u = np.asarray(u, dtype=np.float64)
        found = [self._spline(u, nu=k) for k in range(order + 1)]
        return found if self.weights is None else curve_quotients(found)


def checked_weights(weights: ArrayLike, shape: tuple[int, ...]) -> Array:
    """The weights as a read-only array; GeometryError where their shape is another or a real part is not positive."""
    values = frozen(weights)
    if values.shape != shape:
        raise GeometryError(f"weights have shape {values.shape}: one is needed for each control point, {shape}")
    if not (values.real > 0.0).all():
        raise GeometryError(f"the smallest weight is {values.real.min():g}: weights must be positive; raise it")
    return values
