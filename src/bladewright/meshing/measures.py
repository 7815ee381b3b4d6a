"""Measures of a mesh against the native passage: nodes on their surfaces, a boundary without holes."""

from collections.abc import Mapping

import numpy as np

from bladewright.blade.blade import Faces
from bladewright.meshing.names import group_of
from bladewright.meshing.quality import FACETS, Indices
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.closest import closest_on_surface
from bladewright.nurbs.trimmed import TrimmedSurface

LIMIT = 1e-8, 1e-7
"""[m], and of the chord: how far a node may lie off its native surface, what the round trip allows a trimmed end"""
AGAIN = 200
"""nodes that are searched for more closely where the first places found are further away than allowed"""


def limit(chord: float) -> float:
    """How far a node may lie off its native surface [m]."""
    return max(LIMIT[0], LIMIT[1] * chord)


def deviations(faces: Faces, group: str, points: Reals, allowed: float) -> Reals:
    """Distances (n,) of points (n, 3) from the native surfaces of a group [m], infinite where there are none.

    Each is that of the place which a descent from the nearest sample reaches; the worst of those above `allowed` are
    searched for again, globally.
    """
    best = np.full(len(points), np.inf)
    for name, face in faces.items():
        if group_of(name) != group:
            continue
        surface = face.surface if isinstance(face, TrimmedSurface) else face
        found = closest_on_surface(surface, points, tolerance=1.0).distances.real
        off = np.argsort(found)[::-1][:AGAIN]
        off = off[found[off] > allowed]
        if len(off):
            found = np.array(found)
            found[off] = closest_on_surface(surface, points[off], tolerance=1e-7).distances.real
        best = np.minimum(best, found)
    return best


def loose_facets(tetrahedra: Indices, groups: Mapping[str, Indices]) -> int:
    """How many sides belong to one tetrahedron and no triangle, or more than twice, and how many triangles to none.

    0 says that the groups together are the whole boundary, each piece of it once.
    """
    sides = np.sort(tetrahedra[:, FACETS].reshape(-1, 3), axis=1)
    triangles = np.sort(np.concatenate([*groups.values(), np.zeros((0, 3), dtype=np.intp)]), axis=1)
    _, uses = np.unique(np.concatenate([sides, triangles]), axis=0, return_counts=True)
    return int(np.count_nonzero(uses != 2))
