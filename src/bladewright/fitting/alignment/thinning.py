"""Fewer points that are spread evenly, and those that stand alone left out."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.nurbs.basis import Reals

MOST = 50_000
"""points that are looked at: more say nothing new about where a blade lies"""
FINEST = 12
"""halvings of the extent in the finest grid"""
NEIGHBOURS, ALONE = 5, 6.0
"""a point stands alone whose fifth neighbour is so many times further away than is usual"""


def drawn(points: Reals, count: int) -> Reals:
    """At most `count` of points (n, d), drawn at random but always the same."""
    if len(points) <= count:
        return points
    return points[np.sort(np.random.default_rng(0).choice(len(points), count, replace=False))]


def thinned(points: Reals, count: int) -> NDArray[np.intp]:
    """Indices of at most `count` of points (n, d), one in each cell of the finest grid that has so few."""
    if len(points) <= count:
        return np.arange(len(points))
    offset = points - points.min(axis=0)
    size = float(offset.max()) * (1.0 + 1e-9) or 1.0
    coarse, fine = 0.0, float(FINEST)
    kept = np.zeros(1, dtype=np.intp)
    for _ in range(9):
        middle = 0.5 * (coarse + fine)
        cells = int(2.0**middle)
        keys = np.floor(offset / size * cells).astype(np.int64) @ (cells + 1) ** np.arange(points.shape[1])
        trial = np.unique(keys, return_index=True)[1]
        if len(trial) <= count:
            kept, coarse = trial, middle
        else:
            fine = middle
    return np.sort(kept)


def accompanied(points: Reals) -> NDArray[np.bool_]:
    """Whether points (n, d) have neighbours: strewn outliers have none."""
    if len(points) <= 2 * NEIGHBOURS:
        return np.ones(len(points), dtype=bool)
    reach = cKDTree(points).query(points, k=NEIGHBOURS + 1)[0][:, -1]
    return np.asarray(reach <= ALONE * np.median(reach))
