"""NURBS surface of any degrees and dimension."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import NdBSpline

from bladewright.numerics.elementary import Array, frozen, unit
from bladewright.nurbs.basis import basis


@dataclass(frozen=True, kw_only=True, eq=False)
class Surface:
    """A NURBS surface S(u, v) (Piegl and Tiller 1997, eq. 4.11) over [0, 1] x [0, 1]."""

    control_points: Array
    """(n_u, n_v, d), real or complex"""
    knots_u: Array
    knots_v: Array
    degree_u: int
    degree_v: int
    weights: Array | None = None
    """(n_u, n_v) or None for a B-spline"""

    def __post_init__(self) -> None:
        for field in ("control_points", "knots_u", "knots_v", "weights"):
            value = getattr(self, field)
            if value is not None:
                object.__setattr__(self, field, frozen(value))

    def __call__(self, u: ArrayLike, v: ArrayLike) -> Array:
        """Points (..., d) at real parameters u, v, which broadcast."""
        return self.derivative(u, v, du=0, dv=0)

    def derivative(self, u: ArrayLike, v: ArrayLike, du: int = 1, dv: int = 0) -> Array:
        """Partial derivatives (..., d), `du` times in u and `dv` times in v."""
        if self.weights is not None:
            raise NotImplementedError
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        spline = NdBSpline((self.knots_u, self.knots_v), self.control_points, (self.degree_u, self.degree_v))
        return spline(np.stack([u, v], axis=-1), nu=(du, dv))

    def grid(self, u: ArrayLike, v: ArrayLike, du: int = 0, dv: int = 0) -> Array:
        """Points or derivatives (len(u), len(v), d) on the tensor grid of u (m,) and v (k,)."""
        if self.weights is not None:
            raise NotImplementedError
        along_u = basis(self.knots_u, self.degree_u, u, du)
        along_v = basis(self.knots_v, self.degree_v, v, dv)
        return np.einsum("iu,uvd,jv->ijd", along_u, self.control_points, along_v, optimize=True)

    def normal(self, u: ArrayLike, v: ArrayLike) -> Array:
        """Unit normals (..., 3): the direction of dS/du x dS/dv."""
        return unit(np.cross(self.derivative(u, v, 1, 0), self.derivative(u, v, 0, 1)))
