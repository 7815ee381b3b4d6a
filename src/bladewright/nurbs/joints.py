"""Knots of a curve that follows something less smooth than itself."""

from collections.abc import Iterable

import numpy as np

from bladewright.nurbs.basis import Reals

SNAPPED = 1e-9
"""distance from a joint, of the knots' range, below which the joint takes the place of a knot"""


def jointed(knots: Reals, degree: int, joints: Iterable[tuple[float, int]]) -> Reals:
    """Knots with joints: places strictly inside, each with the number of derivatives that are continuous there.

    A curve of `degree` on these knots may have a jump in the next derivative at each joint.
    """
    start, end = knots[0], knots[-1]
    near = SNAPPED * (end - start)
    for place, smooth in joints:
        if not start + near < place < end - near:
            continue
        beside = np.square(knots - place) < near**2
        times = max(int(np.sum(beside)), degree - smooth)
        knots = np.sort(np.concatenate([knots[~beside], np.full(min(times, degree), place)]))
    return knots
