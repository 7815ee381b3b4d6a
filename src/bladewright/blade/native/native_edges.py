"""Faces of cut edges as native ones, from side to side, along which a ball can roll.

The face of a cut edge is a trimmed piece of the surface of revolution that cuts it. The native one goes straight in
(t, theta) of that surface, t along its meridian, from the upper to the lower side, as one polynomial of degree 5; along
v it has the knots of the sides, and their ends for its own. It is as short as the edge is thick: the cut edge of the
pump impeller is 3e-9 of the chord off its cylinder.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import numpy as np

from bladewright.blade.native.cut_faces import around, face_inside, near_on_wall
from bladewright.blade.native.end_faces import EDGES, WallSurface, nearest_on_wall
from bladewright.blade.native.knots import DEGREE
from bladewright.blade.native.lazy_faces import Face, LazyFaces
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array, concatenated
from bladewright.numerics.solving import solved
from bladewright.nurbs.basis import basis, greville
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade

ACROSS = np.arange(1, DEGREE) / DEGREE
"""Places across a face at which it is interpolated, besides its ends."""


def with_native_edges(blade: Blade) -> Blade:
    """The blade with the faces of its cut edges as native ones, and with ends within their curves."""
    cut = [edge for edge in EDGES if edge in blade.walls]
    if not cut:
        return blade
    sides, revolved = blade.sides, blade.plain.exact.mapping.revolved
    edges = {edge: cast(Surface, blade.surfaces[edge]) for edge in EDGES if edge in blade.surfaces and edge not in cut}
    edges |= {edge: _native(blade, edge, revolved=revolved) for edge in cut}
    outlines = {name: around(sides, edges, {}, row) for name, row in zip(blade.design.ends, (0, -1), strict=True)}

    def ends() -> dict[str, Face]:
        chord = float(np.real(blade.chord))
        return {
            name: face_inside(outline, *blade.end_wall(name), revolved=revolved, chord=chord)
            for name, outline in outlines.items()
        }

    native = {"upper": sides[0], "lower": sides[1], **edges}
    faces: Mapping[str, Face] = LazyFaces[Face](native, (*native, *blade.design.ends), ends)
    return replace(blade, surfaces=faces, outlines=FrozenMapping(outlines), edges=(), moments=None)


def _native(blade: Blade, edge: str, *, revolved: bool) -> Surface:
    meridian, inner = blade.walls[edge]
    wall = WallSurface(meridian=meridian, inner=inner, revolved=revolved, low=0.0, high=1.0)
    at, (upper, lower) = -1 if edge == "trailing_edge" else 0, blade.sides
    places = greville(upper.knots_v, DEGREE)
    found = []
    for side in (upper, lower):
        line = Curve(control_points=side.control_points[at], knots=side.knots_v, degree=DEGREE)
        found.append(nearest_on_wall(wall, line, near_on_wall(meridian, line, revolved=revolved), places))
    (start, first), (end, last) = found
    if revolved:
        last = last - 2.0 * np.pi * np.round(np.real(last - first)[0] / (2.0 * np.pi))
    share = ACROSS[:, None]
    points = _on_wall(wall, start + share * (end - start), first + share * (last - first))
    rows = solved(basis(upper.knots_v, DEGREE, places), points.reshape(*points.shape[:-2], -1, 3))
    clamped = np.repeat([0.0, 1.0], DEGREE + 1)
    along = basis(clamped, DEGREE, ACROSS)
    ends = np.stack([upper.control_points[at], lower.control_points[at]])
    right = rows - np.tensordot(along[:, [0, -1]], ends, axes=1)
    inside = solved(along[:, 1:-1], right.reshape(len(ACROSS), -1)).reshape(right.shape)
    return Surface(
        control_points=concatenated([ends[:1], inside, ends[1:]], axis=0),
        knots_u=clamped,
        knots_v=upper.knots_v,
        degree_u=DEGREE,
        degree_v=DEGREE,
    )


def _on_wall(wall: WallSurface, u: Array, across: Array) -> Array:
    """Points (..., 3) at u of the meridian and theta, or y."""
    x, r = np.moveaxis(wall.meridian(u), -1, 0)
    if not wall.revolved:
        return np.stack([x, across, r], axis=-1)
    return np.stack([x, r * np.sin(across), r * np.cos(across)], axis=-1)
