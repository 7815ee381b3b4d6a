"""The meridional outline of a cloud: its boundary, and the four corners that divide it into smooth curves."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, Delaunay

from bladewright.numerics.elementary import cross2, length
from bladewright.nurbs.basis import Reals

LEAST_COVERED = 0.985
"""share of the points that the outline must enclose (design/matching_constants.md)"""
RING_PLACES = 120
"""places of the boundary between which corners are sought, in a time of their cube (design/first_guesses.md)"""
FINE_PER_PLACE, CORNER_REACH = 10, 14
"""places of the finer ring for each, and how many beside a cut may be the corner (design/first_guesses.md)"""
NEAR_PLACES = 3
"""places within which two corners are the same (design/first_guesses.md)"""
SHORTEST_CURVE = 0.02
"""shortest of the four curves, of the boundary (design/first_guesses.md)"""
CORNER_WORTH = 0.01
"""what a corner of one radian is worth, in squared distances left by the curves (design/first_guesses.md)"""


def alpha_boundary(places: Reals) -> Reals:
    """The closed boundary (m, 2), anticlockwise, of the area that places (n, 2) cover: an alpha shape."""
    middle = np.mean(places, axis=0)
    spread, axes = np.linalg.eigh(np.cov((places - middle).T))
    white = (places - middle) @ axes / np.sqrt(np.maximum(spread, 1e-8 * spread[-1]))
    mesh = Delaunay(white)
    corners = white[mesh.simplices]
    a, b, c = (np.sqrt(np.sum((corners[:, i] - corners[:, j]) ** 2, axis=-1)) for i, j in ((0, 1), (1, 2), (2, 0)))
    area = np.abs(cross2(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])) / 2.0
    radius = a * b * c / np.maximum(4.0 * area, 1e-12)
    low = float(np.median(np.min(np.stack([a, b, c]), axis=0)))
    for alpha in np.geomspace(low, 50.0, 40):
        loop = _loop(mesh.simplices[radius < alpha], len(places))
        if loop is not None:
            loop = _loop(mesh.simplices[radius < 1.8 * alpha], len(places)) or loop
            break
    else:
        loop = ConvexHull(white).vertices.tolist()
    line = places[loop]
    return line if np.sum(cross2(line, np.roll(line, -1, axis=0))) > 0.0 else line[::-1]


def _loop(triangles: NDArray[np.intp], count: int) -> list[int] | None:
    """The vertices of the single closed boundary of triangles that contain nearly all points, or None."""
    if len(np.unique(triangles)) < LEAST_COVERED * count:
        return None
    edges = {(int(i), int(j)) for i, j in triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)}
    # triangles are anticlockwise, so that two share an edge in both directions
    outer = [(i, j) for i, j in edges if (j, i) not in edges]
    following = dict(outer)
    if len(following) < len(outer):
        return None
    loop = [min(following)]
    while following[loop[-1]] != loop[0]:
        loop.append(following[loop[-1]])
    return loop if len(loop) == len(outer) else None


def corner_sets(line: Reals) -> list[list[Reals]]:
    """Divisions of a closed boundary (m, 2) into four smooth pieces in order, the likeliest first.

    The others lack one of its pieces: an outline that ends in a point does not show which curve is the short one.
    """
    closed = np.concatenate([line, line[:1]])
    spread = np.ptp(line, axis=0)
    way = np.concatenate([[0.0], np.cumsum(length(np.diff(closed, axis=0) / spread))])
    at = np.linspace(0.0, way[-1], FINE_PER_PLACE * RING_PLACES, endpoint=False)
    fine = np.stack([np.interp(at, way, closed[:, i]) for i in (0, 1)], axis=-1)
    ring = fine[::FINE_PER_PLACE]
    cost = _costs(ring / spread) - CORNER_WORTH * _turns(ring / spread)[:, None]
    first = _best_cuts(cost)
    sets = [] if first is None else [first]
    near = np.arange(-NEAR_PLACES, NEAR_PLACES + 1)
    for start, end in zip(first or (), np.roll(first or (), -1), strict=True):
        other = np.array(cost)
        other[np.ix_((start + near) % RING_PLACES, (end + near) % RING_PLACES)] = np.inf
        cuts = _best_cuts(other)
        if cuts is not None and not any(_same(cuts, each) for each in sets):
            sets.append(cuts)
    found = []
    for cuts in sets:
        corners = [_outermost(fine / spread, FINE_PER_PLACE * cut) for cut in cuts]
        ends = [*corners[1:], corners[0] + len(fine)]
        found.append([fine[np.arange(i, j + 1) % len(fine)] for i, j in zip(corners, ends, strict=True)])
    return found


def _same(cuts: list[int], others: list[int]) -> bool:
    """Whether each cut is near one of the others."""
    apart = np.abs(np.array(cuts)[:, None] - np.array(others))
    return bool(np.all(np.min(np.minimum(apart, RING_PLACES - apart), axis=1) <= NEAR_PLACES))


def _outermost(fine: Reals, cut: int) -> int:
    """The place of a ring near a cut that stands out most: the corner."""
    near = np.arange(cut - CORNER_REACH, cut + CORNER_REACH + 1)
    places = fine[near % len(fine)] - fine[(cut - CORNER_REACH) % len(fine)]
    return int(near[np.argmax(cross2(places, places[-1]))])


def _costs(ring: Reals) -> Reals:
    """Squared distances (RING_PLACES, RING_PLACES) left by cubics through pieces, by their first and last place."""
    result = np.full((RING_PLACES, RING_PLACES), np.inf)
    around, first = np.concatenate([ring, ring]), np.arange(RING_PLACES)
    for steps in range(max(2, int(SHORTEST_CURVE * RING_PLACES)), RING_PLACES):
        q, _ = np.linalg.qr(np.vander(np.linspace(-1.0, 1.0, steps + 1), min(4, steps)))
        pieces = np.lib.stride_tricks.sliding_window_view(around, steps + 1, axis=0)[:RING_PLACES]
        left = np.sum(pieces**2, axis=(1, 2)) - np.sum((pieces @ q) ** 2, axis=(1, 2))
        result[first, (first + steps) % RING_PLACES] = np.maximum(left, 0.0)
    return result


def _turns(ring: Reals) -> Reals:
    """Angles (RING_PLACES,) [rad] by which the boundary turns left around each place, at most 1.2."""
    before, after = ring - np.roll(ring, 4, axis=0), np.roll(ring, -4, axis=0) - ring
    return np.clip(np.arctan2(cross2(before, after), np.sum(before * after, axis=-1)), 0.0, 1.2)


def _best_cuts(cost: Reals) -> list[int] | None:
    """The four cuts of the ring with the least sum of costs (n, n) from cut to cut, by pairs of neighbouring pieces."""
    steps = (np.arange(RING_PLACES) - np.arange(RING_PLACES)[:, None]) % RING_PLACES
    pair = cost[:, :, None] + cost
    pair[steps[:, :, None] + steps != steps[:, None]] = np.inf
    middle, least = np.argmin(pair, axis=1), np.min(pair, axis=1)
    i, j = np.unravel_index(int(np.argmin(least + least.T)), least.shape)
    if not np.isfinite(least[i, j] + least[j, i]):
        return None
    return sorted([int(i), int(middle[i, j]), int(j), int(middle[j, i])])
