"""NURBS surface of any degrees and dimension."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import NdBSpline

from bladewright.errors import GeometryError
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, frozen, length, unit
from bladewright.nurbs.basis import basis, checked_knots
from bladewright.nurbs.curve import checked_weights
from bladewright.nurbs.rational import homogeneous, surface_quotients


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Surface(FrozenRecord):
    """A NURBS surface S(u, v) (Piegl and Tiller 1997, eq. 4.11), usually over [0, 1] x [0, 1].

    Its parameters run over [knots_u[0], knots_u[-1]] and [knots_v[0], knots_v[-1]]; outside, the end polynomials (the
    end quotients of polynomials, where there are weights) are continued. An imaginary part of a parameter is carried to
    first order, as a complex step needs. Scattered points come from scipy's NdBSpline, grids from products with the
    bases' matrices: design/nurbs_evaluation.py measures both. Raises GeometryError where shapes, knots, degrees and
    weights do not fit together.
    """

    control_points: Array
    """(n_u, n_v, d), real or complex"""
    knots_u: Array
    """(n_u + degree_u + 1,), clamped, non-decreasing"""
    knots_v: Array
    """(n_v + degree_v + 1,), clamped, non-decreasing"""
    degree_u: int
    degree_v: int
    weights: Array | None = None
    """(n_u, n_v) with positive real parts, or None for a B-spline"""

    def __post_init__(self) -> None:
        points = frozen(self.control_points)
        if points.ndim < 2:
            raise GeometryError(f"control points of a surface have shape {points.shape}: it must be (n_u, n_v, d)")
        object.__setattr__(self, "control_points", points)
        object.__setattr__(self, "knots_u", checked_knots(self.knots_u, self.degree_u, points.shape[0], "knots_u"))
        object.__setattr__(self, "knots_v", checked_knots(self.knots_v, self.degree_v, points.shape[1], "knots_v"))
        if self.weights is not None:
            object.__setattr__(self, "weights", checked_weights(self.weights, points.shape[:-1]))

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self.control_points.shape[:-1]))
        kind = "" if self.weights is None else ", weighted"
        return f"<Surface: {shape} control points{kind}, degrees {self.degree_u} x {self.degree_v}>"

    @property
    def domain_u(self) -> tuple[float, float]:
        """The first and the last u."""
        return float(self.knots_u[0]), float(self.knots_u[-1])

    @property
    def domain_v(self) -> tuple[float, float]:
        """The first and the last v."""
        return float(self.knots_v[0]), float(self.knots_v[-1])

    @cached_property
    def homogeneous(self) -> Array:
        """Control points (n_u, n_v, d), or (w P, w) of shape (n_u, n_v, d + 1) where there are weights."""
        return frozen(homogeneous(self.control_points, self.weights))

    @cached_property
    def _spline(self) -> NdBSpline:
        return NdBSpline((self.knots_u, self.knots_v), self.homogeneous, (self.degree_u, self.degree_v))

    def __call__(self, u: ArrayLike, v: ArrayLike) -> Array:
        """Points (..., d) at parameters u, v, which broadcast."""
        return self.derivative(u, v, du=0, dv=0)

    def derivative(self, u: ArrayLike, v: ArrayLike, du: int = 1, dv: int = 0) -> Array:
        """Partial derivatives (..., d), `du` times in u and `dv` times in v."""
        if np.iscomplexobj(u) or np.iscomplexobj(v):
            return self._stepped(u, v, du, dv)
        if self.weights is not None:
            return self._quotients(*self._parameters(u, v), du, dv)[du, dv]
        found: Array = self._spline(self._sites(u, v), nu=(du, dv))
        return found

    def derivatives(self, u: ArrayLike, v: ArrayLike, order: int) -> dict[tuple[int, int], Array]:
        """All partial derivatives {(du, dv): (..., d)} with du + dv <= order, the point among them; u and v real."""
        u, v = self._parameters(u, v)
        sites = self._sites(u, v)
        orders = [(k, total - k) for total in range(order + 1) for k in range(total + 1)]
        found = {both: self._spline(sites, nu=both) for both in orders}
        return found if self.weights is None else surface_quotients(found)

    def grid(self, u: ArrayLike, v: ArrayLike, du: int = 0, dv: int = 0) -> Array:
        """Points or derivatives (len(u), len(v), d) on the tensor grid of real u (m,) and v (k,)."""
        if self.weights is None:
            return self._grid(u, v, du, dv)
        orders = [(k, l) for k in range(du + 1) for l in range(dv + 1)]  # noqa: E741 - the formula's letters
        return surface_quotients({both: self._grid(u, v, *both) for both in orders})[du, dv]

    def normal(self, u: ArrayLike, v: ArrayLike) -> Array:
        """Unit normals (..., 3) at real u, v: the direction of dS/du x dS/dv, or its limit at a collapsed edge."""
        return unit_normals(self, *self._parameters(u, v))

    def _parameters(self, u: ArrayLike, v: ArrayLike) -> tuple[Array, Array]:
        if np.iscomplexobj(u) or np.iscomplexobj(v):
            raise GeometryError("complex parameters were given where only real ones make sense; take their real parts")
        u, v = np.broadcast_arrays(np.asarray(u, dtype=np.float64), np.asarray(v, dtype=np.float64))
        return u, v

    def _sites(self, u: ArrayLike, v: ArrayLike) -> Array:
        return np.stack(self._parameters(u, v), axis=-1)

    def _stepped(self, u: ArrayLike, v: ArrayLike, du: int, dv: int) -> Array:
        real_u, real_v = np.real(u), np.real(v)
        found = self.derivative(real_u, real_v, du, dv).astype(np.complex128)
        for parameter, slope in ((u, (du + 1, dv)), (v, (du, dv + 1))):
            if np.iscomplexobj(parameter):
                step = np.reshape(np.imag(parameter), np.shape(parameter) + (1,) * (self.control_points.ndim - 2))
                found = found + 1j * step * self.derivative(real_u, real_v, *slope)
        return found

    def _quotients(self, u: Array, v: Array, du: int, dv: int) -> dict[tuple[int, int], Array]:
        sites = np.stack([u, v], axis=-1)
        orders = [(k, l) for k in range(du + 1) for l in range(dv + 1)]  # noqa: E741 - the formula's letters
        return surface_quotients({both: self._spline(sites, nu=both) for both in orders})

    def _grid(self, u: ArrayLike, v: ArrayLike, du: int, dv: int) -> Array:
        along_u = basis(self.knots_u, self.degree_u, u, du)
        along_v = basis(self.knots_v, self.degree_v, v, dv)
        if len(self.knots_u) - self.degree_u >= len(self.knots_v) - self.degree_v:
            return np.swapaxes(_product(along_v, along_u, np.swapaxes(self.homogeneous, 0, 1)), 0, 1)
        return _product(along_u, along_v, self.homogeneous)


def _product(last: Array, first: Array, net: Array) -> Array:
    """last (m, a) times net (a, b, ...) times first (k, b) as (m, k, ...), in two products of full matrices.

    The second product costs m k a: `last` is for the direction with fewer control points.
    """
    if np.iscomplexobj(net):
        # real products, or the real bases would be made complex first
        pairs = np.ascontiguousarray(net)[..., None].view(np.float64)
        return np.asarray(_product(last, first, pairs).view(np.complex128)[..., 0])
    rows = first @ np.swapaxes(net, 0, 1).reshape(net.shape[1], -1)
    columns = np.swapaxes(rows.reshape(len(first), net.shape[0], -1), 0, 1).reshape(net.shape[0], -1)
    return np.asarray((last @ columns).reshape(len(last), len(first), *net.shape[2:]))


COLLAPSED = 1e-10
"""Length of a derivative, in units of the control points' extent, or sine between the two, below which the normal is
taken as the limit from inside: about the root of rounding, where the product of both has no digits left. Normals beside
the pole of a sphere are 4e-7 off; with 1e-14 they are 1e-3 off, with 1e-5 7e-12 (design/nurbs_constants.md)."""


def unit_normals(surface: Surface, u: Array, v: Array) -> Array:
    """Unit normals (..., 3) at real u, v of one shape: the direction of dS/du x dS/dv.

    Where that product vanishes at an end of the surface (the pole of a sphere, the tip of a cone) it is the limit from
    inside along the other parameter: with dS/du = 0 at v = v0, dS/du ~ (v - v0) d2S/dudv.
    """
    along_u, along_v = surface.derivative(u, v, 1, 0), surface.derivative(u, v, 0, 1)
    direction = np.cross(along_u, along_v)
    size_u, size_v = length(along_u.real), length(along_v.real)
    extent = np.ptp(surface.control_points.real, axis=(0, 1)).max()
    bound = np.maximum(size_u, COLLAPSED * extent) * np.maximum(size_v, COLLAPSED * extent)
    flat = length(direction.real) <= COLLAPSED * bound
    flat |= (size_u <= COLLAPSED * extent) | (size_v <= COLLAPSED * extent)
    if flat.any():
        twist = surface.derivative(u[flat], v[flat], 1, 1)
        inward_u = np.where(u[flat] < np.mean(surface.domain_u), 1.0, -1.0)[..., None]
        inward_v = np.where(v[flat] < np.mean(surface.domain_v), 1.0, -1.0)[..., None]
        no_u = (size_u[flat] <= size_v[flat])[..., None]
        limit = np.where(no_u, np.cross(inward_v * twist, along_v[flat]), np.cross(along_u[flat], inward_u * twist))
        direction = np.array(direction, dtype=np.result_type(direction, limit))
        direction[flat] = limit
    return unit(direction)
