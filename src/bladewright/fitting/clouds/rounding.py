"""Coordinates that are written with few digits: no design is known exactly from them."""

import numpy as np

from bladewright.nurbs.basis import Reals

EXACT = 1e-8
"""of the extent: digits beyond this tell of an exact cloud"""
LOOKED_AT = 200
"""points that are looked at"""


def rounded(points: Reals) -> bool:
    """Whether all coordinates of points (n, d) are multiples of a power of ten that their extent makes coarse."""
    extent = float(np.max(np.ptp(points, axis=0)))
    finest = int(np.floor(-np.log10(EXACT * extent)))
    some = points[:: max(1, len(points) // LOOKED_AT)]
    # a unit that scales by a power of ten leaves the last digits as they are, but for rounding
    return bool(np.all(np.abs(np.round(some, finest) - some) < 1e-4 * EXACT * extent))
