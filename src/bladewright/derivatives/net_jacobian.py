"""Derivatives of control nets by parameters, and from them those of points, in forward and reverse mode.

A point S = sum B_i w_i P_i / sum B_i w_i is a quotient of sums that are linear in the homogeneous control points, so
that one Jacobian of the nets serves any number of points.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array

from bladewright.blade.native.blade import Blade
from bladewright.derivatives.complex_step import STEP, built, face_tangents, stepped
from bladewright.derivatives.patterns import Patterns, chosen
from bladewright.designs import Design, unknown
from bladewright.errors import DerivativeError
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.collocation import collocation
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

Shape = Curve | Surface
Bars = Mapping[str, Sequence[ArrayLike]]
"""(u, v, bar) by name of a surface, or (u, bar) of a curve: bar is the derivative of a scalar by the points there."""
POINTS_AT_ONCE = 50_000
"""Points whose basis functions are held at a time, some 36 for each, which bounds the memory: 20 MB."""


@dataclass(frozen=True, kw_only=True, eq=False)
class NetJacobian:
    """Derivatives of the control points of surfaces, or curves, by a design's parameters, at held knots.

    A trimmed surface is represented by the surface that it is a part of; the derivative of its boundary is left out.
    """

    paths: tuple[str, ...]
    """the k parameters"""
    shapes: Mapping[str, Shape]
    """surfaces, or curves, by name, as the design builds them [m]"""
    homogeneous: Mapping[str, Array]
    """(k, n_u, n_v, d), of the control points, or of (w P, w) where there are weights [m per unit of the field]"""

    @property
    def nets(self) -> Mapping[str, Array]:
        """Derivatives (k, n_u, n_v, 3) of the control points themselves, which are the poles in a CAD file."""
        return FrozenMapping({name: self._net(name) for name in self.shapes})

    @property
    def weights(self) -> Mapping[str, Array | None]:
        """Derivatives (k, n_u, n_v) of the weights; None for a B-spline."""
        return FrozenMapping(
            {
                name: None if shape.weights is None else self.homogeneous[name][..., -1]
                for name, shape in self.shapes.items()
            }
        )

    def points(self, name: str, u: ArrayLike, v: ArrayLike = 0.0) -> Array:
        """Derivatives (k, ..., 3) of points at parameters that broadcast; a curve has no v.

        Time and memory grow with the number of points times the number of parameters. Raises DerivativeError for an
        unknown name.
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


Part = Callable[..., Any]
"""Makes a body with `surfaces` or `curves` by name from what a design builds, such as its passage."""


def net_jacobian(
    design: Design,
    *,
    names: Sequence[str] | None = None,
    free: Patterns = None,
    knots: Any = None,
    of: Part | None = None,
) -> NetJacobian:
    """Derivatives of the control points of what a design builds, by all its parameters or those that `free` matches.

    `names` are the surfaces wanted, where None all that are not trimmed; `knots` those to hold, where None the design's
    own; `of` makes from the build the body whose surfaces are wanted, such as `bladewright.passage`, and is given that
    body's `knots` where it has some. Raises DerivativeError for an unknown name, DesignError where a pattern matches no
    parameter or the design cannot be built.
    """
    base = built(design, knots)
    paths = chosen(design, free)
    body = base if of is None else of(base)
    faces = faces_of(body)
    wanted = tuple(name for name, face in faces.items() if not isinstance(face, TrimmedSurface))
    for name in wanted if names is None else names:
        if name not in faces:
            raise DerivativeError(unknown(f"'{name}'", name, list(faces)))
    wanted = wanted if names is None else tuple(dict.fromkeys(names))
    shapes = {name: untrimmed(faces[name]) for name in wanted}
    return NetJacobian(
        paths=paths,
        shapes=FrozenMapping(shapes),
        homogeneous=FrozenMapping(_rates(design, base, _with_held_knots(of, body), paths, shapes)),
    )


def pullback(
    design: Design, bars: Bars, *, free: Patterns = None, knots: Any = None, of: Part | None = None
) -> dict[str, float]:
    """Sums over all points of bar * dS/dparameter, by path: the gradient of what an adjoint solver gives at points.

    `bars` is {name: (u, v, bar)}, with bar of the shape of S(u, v) the derivative of a scalar by the points [1/m];
    (u, bar) for the curves of a 2D design. Other arguments and errors are those of `net_jacobian`, and of
    `NetJacobian.pulled_back`, which serves many gradients of one design.
    """
    return net_jacobian(design, names=list(bars), free=free, knots=knots, of=of).pulled_back(bars)


def _rates(
    design: Design, base: Any, of: Part | None, paths: tuple[str, ...], shapes: Mapping[str, Shape]
) -> dict[str, Array]:
    if (
        paths
        and of is None
        and isinstance(base, Blade)
        and base.before is None
        and not set(shapes) & set(base.design.ends)
    ):
        parts = list(face_tangents(base, paths))
        return {name: np.concatenate([part[name] for part in parts]) for name in shapes}
    rates = {name: np.empty((len(paths), *shape.homogeneous.shape)) for name, shape in shapes.items()}
    for place, carrying in enumerate(stepped(design, base, paths)):
        faces = faces_of(carrying if of is None else of(carrying))
        for name in shapes:
            rates[name][place] = np.imag(untrimmed(faces[name]).homogeneous) / STEP
    return rates


def _with_held_knots(of: Part | None, body: Any) -> Part | None:
    """The same function with the knots of `body` held, where it has some."""
    knots = getattr(body, "knots", None)
    return of if of is None or knots is None else partial(of, knots=knots)


def faces_of(body: Any) -> Mapping[str, Any]:
    """Surfaces or curves by name; raises DerivativeError where there are none."""
    faces: Mapping[str, Any] | None = getattr(body, "surfaces", None) or getattr(body, "curves", None)
    if faces is None:
        raise DerivativeError(f"a {type(body).__name__} has neither surfaces nor curves to differentiate")
    return faces


def untrimmed(face: Any) -> Shape:
    """The surface that a trimmed one is a part of, or the shape itself."""
    found: Shape = face.surface if isinstance(face, TrimmedSurface) else face
    return found
