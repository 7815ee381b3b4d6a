"""Derivatives of control nets by parameters, and what follows from them for points, forward and in reverse.

A point is S = sum B_i (w P)_i / sum B_i w_i, a quotient of what is linear in the homogeneous control points, so that
one Jacobian of the nets serves any number of points.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array

from bladewright.designs import unknown
from bladewright.errors import DerivativeError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.collocation import collocation
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface

Shape = Curve | Surface
Bars = Mapping[str, Sequence[ArrayLike]]
"""by name (u, v, bar), or (u, bar) for a curve"""
POINTS_AT_ONCE = 50_000
"""points whose basis functions are held at a time: 36 for each"""


@dataclass(frozen=True, kw_only=True, eq=False)
class NetJacobian:
    """Derivatives of the control points of surfaces, or curves, by a design's parameters, at held knots.

    That of a trimmed surface is that of the whole surface below it: a piece of the wall, held where it is.
    """

    paths: tuple[str, ...]
    """the k parameters"""
    shapes: Mapping[str, Shape]
    """surfaces, or curves, by name, as the design builds them [m]"""
    homogeneous: Mapping[str, Array]
    """(k, n_u, n_v, d), of (w P, w) where the shape has weights [m per unit of the field]"""

    @property
    def nets(self) -> Mapping[str, Array]:
        """Derivatives (k, n_u, n_v, 3) of the control points themselves, which are a CAD file's poles."""
        return MappingProxyType({name: self._net(name) for name in self.shapes})

    @property
    def weights(self) -> Mapping[str, Array | None]:
        """Derivatives (k, n_u, n_v) of the weights; None for a B-spline."""
        return MappingProxyType(
            {
                name: None if shape.weights is None else self.homogeneous[name][..., -1]
                for name, shape in self.shapes.items()
            }
        )

    def points(self, name: str, u: ArrayLike, v: ArrayLike = 0.0) -> Array:
        """Derivatives (k, ..., 3) of points at parameters that broadcast; a curve has no v.

        Time and memory grow with the number of points times that of parameters. Raises DerivativeError for an unknown
        name.
        """
        shape = self._shape(name)
        at = _places(name, [u, v])
        rates = self.homogeneous[name]
        count, width = rates.shape[0], rates.shape[-1]
        columns = np.moveaxis(rates, 0, -2).reshape(-1, count * width)
        found = np.empty((at[0].size, count, width))
        for part, matrix in _matrices(shape, at):
            found[part] = (matrix @ columns).reshape(-1, count, width)
        if shape.weights is not None:
            point, weight = _point_and_weight(shape, at)
            found = (found[..., :-1] - point[:, None] * found[..., -1:]) / weight[:, None, None]
        return np.moveaxis(found, 1, 0).reshape(count, *at[0].shape, found.shape[-1])

    def pulled_back(self, bars: Bars) -> dict[str, float]:
        """Sums over all points of bar * dS/dparameter, by path; bar has the shape of S(u, v).

        It takes about as long as one evaluation of the points, however many parameters there are. Raises
        DerivativeError for an unknown name, a bar of another shape, or a number that is not finite.
        """
        total = np.zeros(len(self.paths))
        for name, given in bars.items():
            shape = self._shape(name)
            *at, bar = _checked(name, shape, given)
            gathered = _gathered(shape, at, bar)
            total = total + self.homogeneous[name].reshape(len(self.paths), -1) @ gathered.ravel()
        return {path: float(value) for path, value in zip(self.paths, total, strict=True)}

    def _shape(self, name: str) -> Shape:
        if name not in self.shapes:
            raise DerivativeError(unknown(f"'{name}'", name, list(self.shapes)))
        return self.shapes[name]

    def _net(self, name: str) -> Array:
        rates, shape = self.homogeneous[name], self.shapes[name]
        if shape.weights is None:
            return rates
        return (rates[..., :-1] - shape.control_points * rates[..., -1:]) / shape.weights[..., None]


def _places(name: str, values: Sequence[ArrayLike]) -> list[Reals]:
    at = np.broadcast_arrays(*[np.asarray(value, dtype=np.float64) for value in values])
    if not all(np.isfinite(value).all() for value in at):
        raise DerivativeError(f"'{name}': a parameter u or v is not finite")
    return list(at)


def _checked(name: str, shape: Shape, given: Sequence[ArrayLike]) -> list[Reals]:
    """u, v (m,) and bar (m, d)."""
    count = 2 if isinstance(shape, Surface) else 1
    if len(given) != count + 1:
        form = "(u, v, bar)" if count == 2 else "(u, bar)"
        raise DerivativeError(f"'{name}' has {len(given)} entries: {form} is needed")
    at = _places(name, given[:count])
    if np.iscomplexobj(given[-1]):
        raise DerivativeError(f"'{name}': bar is complex; it is the real derivative of a scalar by the points")
    bar = np.asarray(given[-1], dtype=np.float64)
    if bar.shape != (*at[0].shape, shape.control_points.shape[-1]):
        needed = (*at[0].shape, shape.control_points.shape[-1])
        raise DerivativeError(f"'{name}': bar has shape {bar.shape}: it must be that of the points, {needed}")
    if not np.isfinite(bar).all():
        raise DerivativeError(f"'{name}': {np.count_nonzero(~np.isfinite(bar))} entries of bar are not finite")
    return [*(value.ravel() for value in at), bar.reshape(-1, bar.shape[-1])]


def _matrices(shape: Shape, at: Sequence[Reals]) -> Iterator[tuple[slice, csr_array]]:
    flat = [np.ravel(value) for value in at]
    for first in range(0, flat[0].size, POINTS_AT_ONCE):
        part = slice(first, first + POINTS_AT_ONCE)
        yield part, collocation(shape, *[value[part] for value in flat])


def _point_and_weight(shape: Shape, at: Sequence[Reals]) -> tuple[Reals, Reals]:
    columns = shape.homogeneous.reshape(-1, shape.homogeneous.shape[-1])
    found = np.concatenate([matrix @ columns for _, matrix in _matrices(shape, at)])
    return found[:, :-1] / found[:, -1:], found[:, -1]


def _gathered(shape: Shape, at: Sequence[Reals], bar: Reals) -> Reals:
    """B^T bar (n, d): the derivative of the scalar by the homogeneous control points."""
    columns = shape.homogeneous.reshape(-1, shape.homogeneous.shape[-1])
    total = np.zeros(columns.shape)
    for part, matrix in _matrices(shape, at):
        row = bar[part]
        if shape.weights is not None:
            value = matrix @ columns
            row = row / value[:, -1:]
            row = np.concatenate([row, -np.sum(row * value[:, :-1], axis=1, keepdims=True) / value[:, -1:]], axis=1)
        total += matrix.T @ row
    return total
