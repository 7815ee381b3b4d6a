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

from bladewright.blade.native.contacts import Wall
from bladewright.blade.native.cut_faces import around, face_inside, near_on_wall
from bladewright.blade.native.end_faces import EDGES, WallSurface, nearest_on_wall
from bladewright.blade.native.interpolation import ACROSS_EDGE, edge_face
from bladewright.blade.native.knots import DEGREE
from bladewright.blade.native.lazy_faces import Face, LazyFaces
from bladewright.frozen import FrozenMapping
from bladewright.numerics.solving import solved
from bladewright.nurbs.basis import basis, greville
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade


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
    surface = WallSurface(meridian=meridian, inner=inner, revolved=revolved, low=0.0, high=1.0)
    at, sides = -1 if edge == "trailing_edge" else 0, blade.sides
    places = greville(sides[0].knots_v, DEGREE)
    found = []
    for side in sides:
        line = Curve(control_points=side.control_points[at], knots=side.knots_v, degree=DEGREE)
        found.append(nearest_on_wall(surface, line, near_on_wall(meridian, line, revolved=revolved), places))
    (start, first), (end, last) = found
    if revolved:
        last = last - 2.0 * np.pi * np.round(np.real(last - first)[0] / (2.0 * np.pi))
    share, wall = ACROSS_EDGE[:, None], Wall(meridian=meridian, revolved=revolved, inward=1.0)
    points = wall.point(start + share * (end - start), first + share * (last - first))
    return edge_face(edge, sides, solved(basis(sides[0].knots_v, DEGREE, places), points))
