"""Whether closed outlines cross themselves or their neighbours."""

import numpy as np

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


def _crossed(first: Reals, second: Reals) -> np.ndarray:
    """Mask (n, m) of the pairs of segments of two closed outlines that cross."""
    a, b = first, np.roll(first, -1, axis=0)
    c, d = second, np.roll(second, -1, axis=0)

    def turn(p: Reals, q: Reals, r: Reals) -> Reals:
        return (q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1]) - (q[..., 1] - p[..., 1]) * (r[..., 0] - p[..., 0])

    a, b, c, d = a[:, None], b[:, None], c[None], d[None]
    return (turn(a, b, c) * turn(a, b, d) < 0.0) & (turn(c, d, a) * turn(c, d, b) < 0.0)
