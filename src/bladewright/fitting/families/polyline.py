"""The places on a polyline that are nearest to points."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from bladewright.nurbs.basis import Reals


@dataclass(frozen=True, kw_only=True, eq=False)
class PolylineFootpoints:
    """The nearest places of m points on a polyline."""

    points: Reals
    """(m, 2) the nearest places"""
    tangents: Reals
    """(m, 2) unit vectors along the line"""
    heights: Reals
    """(m,) signed distances of the points from the line, positive on its left"""

    @property
    def normals(self) -> Reals:
        """(m, 2) unit normals to the left."""
        return np.stack([-self.tangents[:, 1], self.tangents[:, 0]], axis=-1)


def nearest_on(line: Reals, points: Reals) -> PolylineFootpoints:
    """The nearest places of points (m, 2) on a polyline (n, 2), which continues straight past its ends."""
    start, along = line[:-1], np.diff(line, axis=0)
    size = np.sqrt(np.sum(along**2, axis=1))
    kept = size > 1e-12 * float(np.sum(size))
    start, along = start[kept], along[kept] / size[kept, None]
    size = size[kept]
    vertex = cKDTree(start).query(points)[1]
    best = np.full(len(points), np.inf)
    place, tangent = np.zeros_like(points), np.zeros_like(points)
    for shift in (-1, 0, 1):
        piece = np.clip(vertex + shift, 0, len(start) - 1)
        way = np.sum((points - start[piece]) * along[piece], axis=1)
        low = np.where(piece == 0, -np.inf, 0.0)
        high = np.where(piece == len(start) - 1, np.inf, size[piece])
        at = start[piece] + np.clip(way, low, high)[:, None] * along[piece]
        square = np.sum((points - at) ** 2, axis=1)
        nearer = square < best
        best[nearer], place[nearer], tangent[nearer] = square[nearer], at[nearer], along[piece][nearer]
    miss = points - place
    side = np.sign(tangent[:, 0] * miss[:, 1] - tangent[:, 1] * miss[:, 0])
    return PolylineFootpoints(points=place, tangents=tangent, heights=side * np.sqrt(best))
