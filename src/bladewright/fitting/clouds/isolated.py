"""Isolated points: strewn outliers that have no neighbours at the usual distance."""

import numpy as np
from scipy.spatial import cKDTree

from bladewright.nurbs.basis import Reals


def without_isolated_points(points: Reals, neighbours: int = 5) -> Reals:
    """The points whose neighbours are about as near as those of the points around them."""
    tree = cKDTree(points)
    distances, index = tree.query(points, k=neighbours + 1)
    own = np.mean(distances[:, 1:], axis=1)
    around = np.median(own[index[:, 1:]], axis=1)
    lonely = (own > 4.0 * around) & (own > 2.0 * np.median(own))
    lonely |= own > 6.0 * np.percentile(own, 75.0)
    if np.mean(lonely) > 0.12:
        lonely &= own >= np.percentile(own, 90.0)
    return np.asarray(points[~lonely])
