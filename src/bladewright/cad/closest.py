"""Nearest points of faces, for thousands of points at once."""

import numpy as np
from scipy.spatial import cKDTree

from bladewright.cad.region import Region
from bladewright.numerics.elementary import Array

STEPS = 12
"""most Gauss-Newton steps; from the nearest of some thousand seeds three or four are needed"""
SEEDS = 4_000
"""points of a face from the nearest of which the search starts"""


class Target:
    """A face that many points are brought to; what the search needs is prepared once."""

    def __init__(self, region: Region, seeds: Array | None = None) -> None:
        self.region = region
        uv = region.sampled(SEEDS) if seeds is None else seeds
        points = region.points(uv)
        # a side that is a single point would fill the list of neighbours with itself
        grain = 1e-9 * max(float(np.ptp(points, axis=0).max()), 1e-300)
        _, kept = np.unique(np.round(points / grain), axis=0, return_index=True)
        self.uv = uv[kept]
        self.tree = cKDTree(points[kept])
        self.spacing = float(self.tree.query(points[kept], k=min(5, len(kept)))[0].max())

    def closest(self, points: Array, limit: float) -> tuple[Array, Array]:
        """Parameters (n, 2) and distances (n,) [mm] of the nearest points of the face to points (n, 3).

        Where the first start ends further away than `limit`, the next nearest seeds are tried too, so that a local
        minimum is not taken for the answer; not so where all seeds are so far that the answer is beyond it.
        """
        seed, near = self.tree.query(points)
        uv, distance = self._from(points, self.uv[near])
        doubtful = np.flatnonzero((distance > limit) & (seed < limit + 3.0 * self.spacing))
        if len(doubtful):
            _, candidates = self.tree.query(points[doubtful], k=min(8, len(self.uv)))
            for k in range(1, candidates.shape[1], 3):
                again, away = self._from(points[doubtful], self.uv[candidates[:, k]])
                better = away < distance[doubtful]
                uv[doubtful[better]], distance[doubtful[better]] = again[better], away[better]
        return uv, distance

    def _from(self, points: Array, start: Array) -> tuple[Array, Array]:
        uv, distance = self._feet(points, start)
        if self.region.chains:
            outside = np.flatnonzero(~self.region.contains(uv))
            if len(outside):
                uv[outside], distance[outside] = self.region.rim.closest(points[outside])
        return uv, distance

    def _feet(self, points: Array, start: Array) -> tuple[Array, Array]:
        """Nearest points of the untrimmed carrier."""
        best, uv = np.array(start), np.array(start)
        distance = np.full(len(points), np.inf)
        active = np.arange(len(points))
        for _ in range(STEPS):
            at, along, across = self.region.carrier.frame(uv[active])
            miss = points[active] - at
            away = np.sqrt(_dot(miss, miss))
            better = away < distance[active]
            best[active[better]], distance[active[better]] = uv[active[better]], away[better]
            a, b, c = _dot(along, along), _dot(along, across), _dot(across, across)
            e, f = _dot(along, miss), _dot(across, miss)
            # where a side of the face is a single point, one of the derivatives vanishes
            a, c = a + 1e-12 * self.region.scale[0] ** 2, c + 1e-12 * self.region.scale[1] ** 2
            determinant = a * c - b * b
            step = np.stack([c * e - b * f, a * f - b * e], axis=-1) / determinant[:, None]
            moved = self.region.brought_near(uv[active] + step)
            shift = (moved - uv[active]) * self.region.scale
            uv[active] = moved
            # below this the distance changes by less than rounding
            active = active[_dot(shift, shift) > (1e-9 * np.maximum(away, 1e-3)) ** 2]
            if len(active) == 0:
                break
        return best, distance


def _dot(a: Array, b: Array) -> Array:
    return np.einsum("ij,ij->i", a, b)
