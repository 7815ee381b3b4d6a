"""Points that do not stand alone."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.nurbs.basis import Reals

NEIGHBOURS, ALONE = 5, 6.0
"""a point stands alone whose fifth neighbour is so many times further away than is usual"""


def accompanied(points: Reals) -> NDArray[np.bool_]:
    """Whether points (n, d) have neighbours: strewn outliers have none."""
    if len(points) <= 2 * NEIGHBOURS:
        return np.ones(len(points), dtype=bool)
    reach = cKDTree(points).query(points, k=NEIGHBOURS + 1)[0][:, -1]
    return np.asarray(reach <= ALONE * np.median(reach))
