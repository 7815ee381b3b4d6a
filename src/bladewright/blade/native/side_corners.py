"""Corners inside the sides of a blade, which some published profiles have."""

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.knots import DEGREE
from bladewright.nurbs.basis import multiplicities

SEEN = 1e-6
"""Angle [rad] from which a corner is named: that by which a fillet may leave its ball and its wall."""


def side_corner(blade: Blade) -> tuple[str, float, float] | None:
    """The side, u and angle [rad] of the greatest corner on the ends of the sides; None where there is none.

    A joint of the section is a knot at which the side keeps no derivative, so the lines of control points before and
    behind it are the directions there.
    """
    found = []
    for name, side in zip(("upper", "lower"), blade.sides, strict=True):
        knots, counts = multiplicities(side.knots_u)
        for u in knots[counts == DEGREE]:
            at = int(np.searchsorted(side.knots_u, u)) - 1
            before, behind = np.diff(np.real(side.control_points[at - 1 : at + 2][:, [0, -1]]), axis=0)
            sizes = np.sqrt(np.sum(before**2, axis=-1) * np.sum(behind**2, axis=-1))
            crossed = np.sqrt(np.sum(np.cross(before, behind) ** 2, axis=-1))
            found.append((float(np.max(np.arcsin(crossed / sizes))), name, float(u)))
    angle, name, u = max(found, default=(0.0, "", 0.0))
    return (name, u, angle) if angle > SEEN else None
