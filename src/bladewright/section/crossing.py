"""Whether closed outlines cross themselves or their neighbours."""

import numpy as np
from numpy.typing import NDArray

from bladewright.errors import DesignError
from bladewright.nurbs.basis import Reals

PLACES = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 49))) / 2.0
"""places along the sides at which outlines are judged, dense at the edges"""


def check_outline(upper: Reals, lower: Reals, s: Reals, where: str) -> Reals:
    """The closed outline (n, 2) of two sides (m, 2) at `s` (m,); refused where it crosses itself, `where` in words."""
    outline = np.concatenate([upper, lower[-2:0:-1]])
    place = self_crossings(outline)
    if place is not None:
        at = s[min(place, 2 * (len(s) - 1) - place)]
        raise DesignError(
            f"thickness_upper and thickness_lower: the sides cross {where}near s = {at:.3f} along the section: raise "
            "the thickness there, lower an edge radius that is larger than the thickness beside it, or lower the "
            "turning of the camber"
        )
    return outline


def self_crossings(outline: Reals) -> int | None:
    """Index of the first segment of a closed outline (n, 2) that another, not its neighbour, crosses; or None."""
    count = len(outline)
    crossed = _crossed(outline, outline)
    index = np.arange(count)
    gap = (index[:, None] - index) % count
    crossed &= (gap > 1) & (gap < count - 1)
    found = np.flatnonzero(np.any(crossed, axis=1))
    return int(found[0]) if len(found) else None


def touches(outline: Reals, pitch: float) -> bool:
    """Whether a closed outline (n, 2) meets itself moved by `pitch` along its ordinate."""
    if np.ptp(outline[:, 1]) < pitch:
        return False
    return bool(np.any(_crossed(outline, outline + np.array([0.0, pitch]))))


def _crossed(first: Reals, second: Reals) -> NDArray[np.bool_]:
    """Mask (n, m) of the pairs of segments of two closed outlines that cross."""
    return _parted(first, second) & _parted(second, first).T


def _parted(lines: Reals, points: Reals) -> NDArray[np.bool_]:
    """Mask (n, m) of the segments of `points` whose ends lie on different sides of the line through each of `lines`."""
    along = np.roll(lines, -1, axis=0) - lines
    turns = np.outer(along[:, 0], points[:, 1]) - np.outer(along[:, 1], points[:, 0])
    turns -= (along[:, 0] * lines[:, 1] - along[:, 1] * lines[:, 0])[:, None]
    return turns * np.roll(turns, -1, axis=1) < 0.0
