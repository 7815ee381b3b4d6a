"""What is noise in a cloud, and what lies off it: both told by a point's neighbours, whatever the fit still misses.

A misfit of the design varies slowly along the surface; noise and outliers do not.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.fitting.feet import Feet
from bladewright.nurbs.basis import Reals

NEIGHBOURS = {2: 4, 3: 8}
"""neighbours asked, by dimension"""
OUTLYING = 8.0
"""robust standard deviations by which an outlier differs from its neighbours"""
USUAL, AT_EDGES = 6.0, 60.0
"""usual distances that an outlier exceeds, and near an edge, where a misfit is large and neighbours are few"""
NEAR = 1e-6
"""distance up to which no point is an outlier, of the cloud's extent"""
EDGE = 0.03
"""how near, in u"""
STANDARD = 1.4826
"""standard deviation of normal noise over its median magnitude"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scatter:
    """How the heights of a cloud above a surface scatter."""

    noise: float
    """standard deviation of what neighbours do not share [m]"""
    inliers: NDArray[np.bool_]
    """(n,)"""
    shared: float
    """part of the inliers' variance that neighbours share: 0 for pure noise, 1 for a misfit of the design"""

    def alone(self, parameters: int) -> float:
        """Part of the points that tell something of their own, as far as a design of so many parameters can follow.

        A misfit is shared by as many neighbours as there are points for two parameters.
        """
        points = float(np.count_nonzero(self.inliers)) / (2.0 * parameters)
        return 1.0 / (1.0 + self.shared * max(points - 1.0, 0.0))


def scatter_of(points: Reals, on: Feet, *, outlying: bool = True) -> Scatter:
    """The scatter of points (n, d) about their feet; where not `outlying`, every point is an inlier."""
    count = NEIGHBOURS[points.shape[1]]
    heights, distances = on.heights, on.distances
    around = _neighbours(points, on, count)
    middle = np.median(heights[around], axis=1)
    off = heights - middle
    noise = STANDARD * float(np.median(np.abs(off)))
    inliers = np.ones(len(points), dtype=bool)
    if outlying:
        local = STANDARD * np.median(np.abs(heights[around] - middle[:, None]), axis=1)
        past = np.sqrt(np.sum((on.miss - heights[:, None] * on.normals) ** 2, axis=-1))
        near = NEAR * float(np.ptp(points, axis=0).max())
        least = near + np.where((on.u < EDGE) | (on.u > 1.0 - EDGE), AT_EDGES, USUAL) * STANDARD * np.median(distances)
        inliers = ~((np.abs(off) + past > OUTLYING * np.maximum(noise, local)) & (distances > least))
    # a mean of k neighbours has 1 / k of the variance
    kept = inliers & inliers[around].all(axis=1)
    kept = kept if np.any(kept) else np.ones(len(points), dtype=bool)
    rest = heights[kept] - np.mean(heights[around[kept]], axis=1)
    variance = float(np.mean(heights[kept] ** 2))
    own = float(np.mean(rest**2)) / (1.0 + 1.0 / count)
    robust = STANDARD * float(np.median(np.abs(rest))) / np.sqrt(1.0 + 1.0 / count)
    shared = float(np.clip(1.0 - own / variance, 0.0, 1.0)) if variance > 0.0 else 0.0
    return Scatter(noise=robust, inliers=inliers, shared=shared)


def _neighbours(points: Reals, on: Feet, count: int) -> NDArray[np.intp]:
    """Indices (n, count) of the nearest points on the same side."""
    found = np.empty((len(points), count), dtype=np.intp)
    for number in (0, 1):
        rows = np.flatnonzero(on.side == number)
        if len(rows) == 0:
            continue
        asked = min(count + 1, len(rows))
        _, index = cKDTree(on.points[rows]).query(on.points[rows], k=asked)
        index = np.reshape(index, (len(rows), asked))[:, 1:] if asked > 1 else np.zeros((len(rows), 1), dtype=np.intp)
        found[rows] = rows[np.pad(index, ((0, 0), (0, count - index.shape[1])), mode="edge")]
    return found
