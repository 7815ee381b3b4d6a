"""Whether closed outlines cross themselves or their neighbours."""

import numpy as np
from numpy.typing import NDArray

from bladewright.nurbs.basis import Reals


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
