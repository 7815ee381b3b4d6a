"""Whether a cloud is a blade around the machine axis or one of a linear cascade."""

from typing import Literal

import numpy as np

from bladewright.nurbs.basis import Reals


def found_arrangement(points: Reals) -> Literal["annular", "linear"]:
    """How the blade of points (n, 3) [m] stands: a blade that reaches the machine axis is one of a cascade."""
    points = np.asarray(points, dtype=np.float64)
    y, z = points[:, 1], points[:, 2]
    radius = np.sqrt(y**2 + z**2)
    around = np.sort(np.arctan2(y, z))
    gaps = np.diff(np.concatenate([around, around[:1] + 2.0 * np.pi]))
    if np.min(radius) < 0.02 * np.max(radius) or np.max(gaps) < np.pi:
        return "linear"
    return "annular"
