"""Points that belong to the blade, and few enough of them."""

import numpy as np
from scipy.spatial import cKDTree

from bladewright.nurbs.basis import Reals


def usual(points: Reals, neighbours: int = 5) -> Reals:
    """The points that have neighbours about as near as their neighbours have."""
    tree = cKDTree(points)
    distances, index = tree.query(points, k=neighbours + 1)
    own = np.mean(distances[:, 1:], axis=1)
    around = np.median(own[index[:, 1:]], axis=1)
    lonely = (own > 4.0 * around) & (own > 2.0 * np.median(own))
    lonely |= own > 6.0 * np.percentile(own, 75.0)
    if np.mean(lonely) > 0.12:
        lonely &= own >= np.percentile(own, 90.0)
    return np.asarray(points[~lonely])


def thinned(points: Reals, most: int) -> Reals:
    """At most `most` points, spread evenly over the cloud."""
    if len(points) <= most:
        return points
    low, extent = np.min(points, axis=0), float(np.max(np.ptp(points, axis=0)))
    shuffled = np.random.default_rng(0).permutation(len(points))
    cell = extent / 2000.0
    while True:
        keys = np.floor((points[shuffled] - low) / cell).astype(np.int64)
        _, first = np.unique(keys, axis=0, return_index=True)
        if len(first) <= most:
            return np.asarray(points[shuffled[first]])
        cell *= 1.15
