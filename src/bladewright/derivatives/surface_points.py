"""Numbered points on the surfaces of what a design builds, such as a solver's, which move with the design."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from bladewright.derivatives.net_jacobian import Shape, faces_of, untrimmed
from bladewright.designs import unknown
from bladewright.errors import DerivativeError
from bladewright.numerics.elementary import Array, length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.closest import closest_on_curve, closest_on_surface
from bladewright.nurbs.curve import Curve

SAME = 1e-9
"""Distance, in units of the points' extent, below which points of two faces are one: they differ by rounding."""
BESIDE = "_strip_", "_fillet_"
"""Parts of the names of faces between those of a blade and its walls, also at and about blunt and sharp edges."""
NEAR = 1e-4
"""Default of `near`, in units of the points' extent: how far a given point may lie off the surfaces. Meshes from files
with few digits must be accepted, and those of another design, or in millimetres, refused."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SurfacePoints:
    """Points on named surfaces, or curves, each with its number in a solver."""

    ids: NDArray[np.int64]
    """(n,) numbers, each once"""
    names: tuple[str, ...]
    """(n,) the surface of each"""
    u: Reals
    """(n,)"""
    v: Reals
    """(n,); 0 on a curve"""
    points: Reals
    """(n, 3), or (n, 2) on the curves of a 2D design [m]"""

    def on(self, built: Any) -> Self:
        """The points at the same parameters on what another design builds."""
        faces, moved = faces_of(built), np.empty_like(self.points)
        for name, which in self._by_name().items():
            moved[which] = np.real(_at(untrimmed(_face(faces, name)), self.u[which], self.v[which]))
        return replace(self, points=moved)

    def bars(self, values: ArrayLike) -> dict[str, tuple[Reals, ...]]:
        """Derivatives (n, d) of a scalar by the points, as `pullback` takes them.

        Raises DerivativeError where their shape is another.
        """
        rows = np.asarray(values, dtype=np.float64)
        if rows.shape != self.points.shape:
            raise DerivativeError(
                f"values have shape {rows.shape}: one row for each point is needed, {self.points.shape}"
            )
        plane = self.points.shape[1] == 2
        return {
            name: (self.u[which], rows[which]) if plane else (self.u[which], self.v[which], rows[which])
            for name, which in self._by_name().items()
        }

    def _by_name(self) -> dict[str, NDArray[np.intp]]:
        names = np.array(self.names)
        return {name: np.flatnonzero(names == name) for name in dict.fromkeys(self.names)}


def surface_points(
    built: Any, *, along: int = 81, across: int = 21, names: Sequence[str] | None = None
) -> SurfacePoints:
    """Points on surfaces of a blade or passage, or on the curves of a section, numbered from 0.

    `names` are those of the surfaces, without which the sides with their strips and fillets are taken. `along` is the
    number of points in u, where they are closer at both ends, and `across` that in v, where they are equally
    spaced; a point that two surfaces share is listed once, on the first of them. Raises DerivativeError for
    an unknown name, or fewer than 2 points either way.
    """
    if along < 2 or across < 2:
        raise DerivativeError(f"{along} x {across} points were asked for: at least 2 x 2 are needed")
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, along))) / 2.0
    rows: list[Reals] = []
    places: list[tuple[str, Reals, Reals]] = []
    for name in _sides(built) if names is None else names:
        shape = untrimmed(_face(faces_of(built), name))
        v = np.zeros(1) if isinstance(shape, Curve) else np.linspace(0.0, 1.0, across)
        at_u, at_v = (part.ravel() for part in np.meshgrid(u, v, indexing="ij"))
        rows.append(np.real(_at(shape, at_u, at_v)))
        places.append((name, at_u, at_v))
    points = np.concatenate(rows)
    kept = _first_of_same(points)
    labels = [name for (name, at_u, _) in places for _ in at_u]
    return SurfacePoints(
        ids=np.arange(len(kept)),
        names=tuple(labels[i] for i in kept),
        u=np.concatenate([at_u for _, at_u, _ in places])[kept],
        v=np.concatenate([at_v for _, _, at_v in places])[kept],
        points=points[kept],
    )


def placed_points(
    built: Any, ids: ArrayLike, points: ArrayLike, *, names: Sequence[str] | None = None, near: float = NEAR
) -> SurfacePoints:
    """The points on the surfaces closest to given ones (n, 3), or (n, 2) of a 2D design, with numbers `ids` (n,).

    So a mesh made elsewhere can follow a design. Raises DerivativeError where a number occurs twice, or a point lies
    further than `near` times the extent of all off the surfaces.
    """
    names = _sides(built) if names is None else names
    numbers, given = np.asarray(ids, dtype=np.int64), np.asarray(points, dtype=np.float64)
    repeated = np.flatnonzero(np.bincount(np.unique(numbers, return_inverse=True)[1]) > 1)
    if len(repeated):
        raise DerivativeError(f"the number {np.unique(numbers)[repeated[0]]} is given to more than one point")
    best = np.full(len(given), np.inf)
    u, v, face = np.zeros(len(given)), np.zeros(len(given)), np.zeros(len(given), dtype=np.intp)
    reached = np.empty_like(given)
    for place, name in enumerate(names):
        at_u, at_v, on = _nearest(untrimmed(_face(faces_of(built), name)), given)
        away = length(on - given)
        nearer = away < best
        best[nearer], face[nearer], reached[nearer] = away[nearer], place, on[nearer]
        u[nearer], v[nearer] = at_u[nearer], at_v[nearer]
    far, limit = int(np.argmax(best)), near * float(np.ptp(given, axis=0).max())
    if best[far] > limit:
        raise DerivativeError(
            f"point {numbers[far]} lies {best[far]:.3g} m off {', '.join(names)}: at most {limit:.3g} m is allowed; is "
            "the mesh that of this design, and in metres?"
        )
    return SurfacePoints(ids=numbers, names=tuple(names[int(i)] for i in face), u=u, v=v, points=reached)


def _at(shape: Shape, u: Reals, v: Reals) -> Array:
    return shape(u) if isinstance(shape, Curve) else shape(u, v)


def _nearest(shape: Shape, points: Reals) -> tuple[Reals, Reals, Reals]:
    """u, v (n,) and the points there."""
    if isinstance(shape, Curve):
        on_curve = closest_on_curve(shape, points)
        return on_curve.u, np.zeros(len(points)), on_curve.points
    found = closest_on_surface(shape, points)
    return found.u, found.v, found.points


def _sides(built: Any) -> list[str]:
    """The sides of a blade or section, with what lies between them and the walls."""
    return ["upper", "lower", *(name for name in faces_of(built) if any(part in name for part in BESIDE))]


def _face(faces: Mapping[str, Any], name: str) -> Any:
    if name not in faces:
        raise DerivativeError(unknown(f"the surface '{name}'", name, list(faces)))
    return faces[name]


def _first_of_same(points: Reals) -> NDArray[np.intp]:
    """Indices of the points (n, d) that do not coincide with an earlier one."""
    pairs = cKDTree(points).query_pairs(SAME * float(np.ptp(points, axis=0).max()), output_type="ndarray")
    return np.setdiff1d(np.arange(len(points)), pairs.max(axis=1) if len(pairs) else [])
