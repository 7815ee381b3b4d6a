"""Footpoints: the nearest places of a cloud on the two sides of a blade or section."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bladewright.numerics.elementary import turned_left
from bladewright.nurbs.basis import Reals, corners
from bladewright.nurbs.closest import CONVERGED, Descents, Places
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface

Side = Curve | Surface
"""one side of a section or of a blade"""
EDGE_PARAMETERS, BETWEEN_EDGES = {"leading edge": 0.0, "trailing edge": 1.0}, 0.1
"""u of the two edges, and distance from them, in u, from which points lie between them"""
DEEP_SHARE, DEEP_EXTENT = 0.25, 1e-5
"""depth of a point inside the blade, of the thickness there and of the cloud's extent, from which both sides are looked
at again: beside a thin edge a descent may end on the wrong one (design/matching_constants.md)"""
STANDING_OUT = 6.0
"""distance of such a point, in usual ones, where it may be an outlier: it is sought globally (design/matching.md)"""
FACING = 0.999
"""cosine of the angle from which a normal faces a point, as smooth sides' do (design/matching_constants.md)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Footpoints:
    """The nearest places of n points on the sides, in d dimensions."""

    side: NDArray[np.intp]
    """(n,) 0 upper, 1 lower"""
    u: Reals
    v: Reals
    """(n,) parameter along the span; 0 on curves"""
    points: Reals
    """(n, d) the footpoints themselves"""
    normals: Reals
    """(n, d) unit normals there, out of the blade"""
    beyond: Reals
    """(n, d) at an end of the blade the unit vector in the surface that points past the end; 0 elsewhere"""
    miss: Reals
    """(n, d) vectors from the footpoints to the points"""

    @property
    def distances(self) -> Reals:
        """(n,) true distances."""
        return np.sqrt(np.sum(self.miss**2, axis=-1))

    @property
    def heights(self) -> Reals:
        """(n,) signed distances along the normals."""
        return np.sum(self.miss * self.normals, axis=-1)

    @property
    def from_edges(self) -> Reals:
        """(n,) distances from the nearer edge, in u."""
        return np.minimum(self.u, 1.0 - self.u)

    def part(self, rows: NDArray[Any]) -> "Footpoints":
        """Some of them, by their numbers or as a mask (n,)."""
        return Footpoints(**{each.name: getattr(self, each.name)[rows] for each in fields(Footpoints)})


def part_of(places: Reals, count: int, side: NDArray[np.intp] | int = 0) -> NDArray[np.intp]:
    """Which of so many equal parts of [0, 1], from 0 on, places (n,) are in; those of side 1 come after those of 0."""
    return side * count + np.minimum((count * places).astype(np.intp), count - 1)


def concatenated(parts: Sequence[Footpoints]) -> Footpoints:
    """Several sets of footpoints as one, in order."""
    names = [each.name for each in fields(Footpoints)]
    return Footpoints(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


def nearest_footpoints(
    points: Reals, sides: Sequence[Side], hint: Footpoints | None = None, *, converged: float = CONVERGED
) -> Footpoints:
    """The nearest places of points (n, d) on the upper and the lower side, by descents (see `nurbs.closest`).

    They start at a `hint`, footpoints on sides that have moved little since; without one, points deep inside that stand
    out are looked for globally. `converged` is the last step in the parameters of a patch.
    """
    search = Descents(tuple(sides))
    start = None if hint is None else Places(shape=hint.side, u=hint.u, v=hint.v)
    found = search.nearest(points, start, converged=converged)
    footpoints = _facing_corners(footpoints_at(points, sides, found.shape, found.u, found.v), sides)
    rows = _deep_inside(footpoints, points, sides)
    if len(rows) == 0:
        return footpoints
    opposite = Places(shape=1 - found.shape[rows], u=found.u[rows], v=found.v[rows])
    tried = [(rows, search.nearest(points[rows], opposite, converged=converged))]
    if hint is None:
        far = rows[footpoints.distances[rows] > STANDING_OUT * np.median(footpoints.distances)]
        tried += [(far, search.globally_nearest(points[far]))] if len(far) else []
    changed = False
    for rows, other in tried:
        nearer = other.square < found.square[rows]
        at, changed = rows[nearer], changed or bool(np.any(nearer))
        for name in ("shape", "u", "v", "square"):
            getattr(found, name)[at] = getattr(other, name)[nearer]
    if not changed:
        return footpoints
    return _facing_corners(footpoints_at(points, sides, found.shape, found.u, found.v), sides)


def _facing_corners(footpoints: Footpoints, sides: Sequence[Side]) -> Footpoints:
    """The footpoints with those at corners, of blunt and sharp edges, facing their points, which lie outside."""
    corner = np.zeros(len(footpoints.u), dtype=bool)
    for number, side in enumerate(sides):
        knots, degree = (side.knots, side.degree) if isinstance(side, Curve) else (side.knots_u, side.degree_u)
        corner |= (footpoints.side == number) & np.isin(footpoints.u, corners(knots, degree))
    # the normal of either side there is across the way to the point, so that one ahead of an edge would cost nothing
    way = footpoints.miss - np.sum(footpoints.miss * footpoints.beyond, axis=-1)[:, None] * footpoints.beyond
    size = np.sqrt(np.sum(way**2, axis=-1))
    corner &= np.abs(np.sum(way * footpoints.normals, axis=-1)) < FACING * size
    normals = np.where(corner[:, None], way / np.where(size > 0.0, size, 1.0)[:, None], footpoints.normals)
    return replace(footpoints, normals=normals)


def _deep_inside(footpoints: Footpoints, points: Reals, sides: Sequence[Side]) -> NDArray[np.intp]:
    """The points so deep inside a blade that their nearest place may lie on its other side."""
    heights = footpoints.heights
    rows = np.flatnonzero(heights < -DEEP_EXTENT * float(np.max(np.ptp(points, axis=0))))
    if len(rows) == 0:
        return rows
    part = footpoints.part(rows)
    opposite = footpoints_at(points[rows], sides, 1 - part.side, part.u, part.v).points
    thickness = -np.sum((opposite - part.points) * part.normals, axis=-1)
    return rows[heights[rows] < -DEEP_SHARE * thickness]


def footpoints_at(
    points: Reals | None, sides: Sequence[Side], side: ArrayLike, u: ArrayLike, v: ArrayLike
) -> Footpoints:
    """Footpoints at known sides and parameters, each (n,) or one for all; without points the places are meant alone."""
    side, u, v = (np.atleast_1d(each) for each in np.broadcast_arrays(side, u, v))
    if points is None:
        points = np.zeros((len(u), np.real(sides[0].control_points).shape[-1]))
    at, normals, beyond = np.empty_like(points), np.empty_like(points), np.zeros_like(points)
    for k, shape in enumerate(sides):
        rows = np.flatnonzero(side == k)
        sign = 1.0 if k == 0 else -1.0
        if isinstance(shape, Curve):
            at[rows] = shape(u[rows])
            along = np.asarray(shape.derivative(u[rows]))
            normals[rows] = sign * unit_or_zero(turned_left(along))
            continue
        at[rows] = shape(u[rows], v[rows])
        along, across = (np.asarray(shape.derivative(u[rows], v[rows], *order)) for order in ((1, 0), (0, 1)))
        normals[rows] = sign * unit_or_zero(np.cross(across, along))
        out = sign * unit_or_zero(np.cross(along, normals[rows]))
        low, high = shape.domain_v
        beyond[rows] = out * ((v[rows] >= high).astype(float) - (v[rows] <= low))[:, None]
    return Footpoints(side=side, u=u, v=v, points=at, normals=normals, beyond=beyond, miss=points - at)


def unit_or_zero(vectors: Reals) -> Reals:
    """Vectors (..., d) divided by their length; zero ones stay."""
    size = np.sqrt(np.sum(vectors**2, axis=-1, keepdims=True))
    return np.asarray(vectors / np.where(size > 0.0, size, 1.0))
