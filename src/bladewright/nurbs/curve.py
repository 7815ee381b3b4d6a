"""NURBS curve of any degree and dimension."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BSpline

from bladewright.numerics.elementary import Array, frozen


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """A NURBS curve C(u) = sum N_i(u) w_i P_i / sum N_i(u) w_i (Piegl and Tiller 1997, eq. 4.1)."""

    control_points: Array
    """(n, d), real or complex"""
    knots: Array
    """(n + degree + 1,), clamped, non-decreasing"""
    degree: int
    weights: Array | None = None
    """(n,) or None for a B-spline"""

    def __post_init__(self) -> None:
        for field in ("control_points", "knots", "weights"):
            value = getattr(self, field)
            if value is not None:
                object.__setattr__(self, field, frozen(value))

    def __call__(self, u: ArrayLike) -> Array:
        """Points (..., d) at real parameters u (...)."""
        return self.derivative(u, 0)

    def derivative(self, u: ArrayLike, order: int = 1) -> Array:
        """Derivatives (..., d) of the given order with respect to u."""
        if self.weights is not None:
            raise NotImplementedError
        return BSpline(self.knots, self.control_points, self.degree)(np.asarray(u, dtype=float), nu=order)
