"""Whether a cloud is a blade around the machine axis or one of a linear cascade."""

from typing import Literal

import numpy as np

from bladewright.fitting.first.hypotheses import coordinates, ranked
from bladewright.fitting.first.inliers import usual
from bladewright.fitting.thinning import spread
from bladewright.nurbs.basis import Reals

Arrangement = Literal["annular", "linear"]
MOST = 600
"""points that decide"""
NEAR = 3e-3
"""of the chord: a mean distance with which a blade around the axis is taken without asking for another"""


def found_arrangement(points: Reals) -> Arrangement:
    """How the blade of points (n, 3) [m] stands: as sections lie closer, on surfaces of revolution or on planes.

    A blade that reaches the machine axis, or goes around it, is one of a cascade.
    """
    points = np.asarray(points, dtype=np.float64)
    y, z = points[:, 1], points[:, 2]
    radius = np.sqrt(y**2 + z**2)
    around = np.sort(np.arctan2(y, z))
    gaps = np.diff(np.concatenate([around, around[:1] + 2.0 * np.pi]))
    if np.min(radius) < 0.02 * np.max(radius) or np.max(gaps) < np.pi:
        return "linear"
    if np.ptp(z) < 0.05 * np.ptp(radius):
        return "annular"
    some = usual(np.unique(points, axis=0))
    some = some[spread(some, MOST)]
    away: list[float] = []
    for name in ("annular", "linear"):
        _, found = ranked(coordinates(some, name), revolved=name == "annular")
        away.append(found[0].match.mean)
        if away[0] < NEAR * found[0].laid.chord:
            return "annular"
    return "linear" if away[1] < 0.5 * away[0] else "annular"
