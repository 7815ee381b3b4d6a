"""The meridional outline of a cloud: its boundary, and the four corners that divide it into smooth curves."""

import numpy as np
from scipy.spatial import Delaunay

from bladewright.nurbs.basis import Reals

RING_PLACES = 120
"""places of the boundary between which corners are sought; the search takes their cube in time
(design/first_guesses.md)."""
FINE_PER_PLACE, CORNER_REACH = 10, 14
"""places of the finer ring for each of them, and how far on it the corner is sought around a cut (`CORNER_REACH`)
(design/first_guesses.md)"""
NEAR_PLACES = 3
"""places within which two corners are the same (design/first_guesses.md)"""
SHORTEST_CURVE = 0.02
"""shortest of the four curves, of the boundary (design/first_guesses.md)."""
CORNER_WORTH = 0.01
"""what a corner of one radian is worth, in squared distances left by the curves (design/first_guesses.md)."""


def alpha_boundary(places: Reals) -> Reals:
    """The closed boundary (m, 2), anticlockwise, of the area that places (n, 2) cover: an alpha shape."""
    middle = np.mean(places, axis=0)
    spread, axes = np.linalg.eigh(np.cov((places - middle).T))
    white = (places - middle) @ axes / np.sqrt(np.maximum(spread, 1e-8 * spread[-1]))
    mesh = Delaunay(white)
    corners = white[mesh.simplices]
    a, b, c = (np.sqrt(np.sum((corners[:, i] - corners[:, j]) ** 2, axis=-1)) for i, j in ((0, 1), (1, 2), (2, 0)))
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) / 2.0
    radius = a * b * c / np.maximum(4.0 * area, 1e-12)
    low = float(np.median(np.min(np.stack([a, b, c]), axis=0)))
    found: list[Reals] = []
    for alpha in np.geomspace(low, 50.0, 40):
        loop = _loop(mesh.simplices[radius < alpha], len(places))
        if loop is not None:
            found.append(loop)
            wide = _loop(mesh.simplices[radius < 1.8 * alpha], len(places))
            loop = wide if wide is not None else loop
            break
    else:
        loop = np.asarray(mesh.convex_hull[:, 0])
        order = np.argsort(np.arctan2(*(white[loop] - np.mean(white[loop], axis=0)).T[::-1]))
        loop = loop[order]
    line = places[loop]
    x, y = line.T
    turns = float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    return line if turns > 0.0 else line[::-1]


def _loop(triangles: np.ndarray, count: int) -> np.ndarray | None:
    """The vertices of the single closed boundary of triangles that contain nearly all points, or None."""
    if len(triangles) == 0:
        return None
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, times = np.unique(edges, axis=0, return_counts=True)
    outer = edges[times == 1]
    if np.any(np.bincount(outer.ravel()) > 2):
        return None
    following: dict[int, list[int]] = {}
    for i, j in outer:
        following.setdefault(int(i), []).append(int(j))
        following.setdefault(int(j), []).append(int(i))
    loop = [int(outer[0, 0])]
    before, now = -1, loop[0]
    while True:
        step = [k for k in following[now] if k != before][:1]
        if not step or step[0] == loop[0]:
            break
        before, now = now, step[0]
        loop.append(now)
    if len(loop) != len(outer) or len(np.unique(triangles)) < 0.985 * count:
        return None
    return np.array(loop)


def corner_sets(line: Reals) -> list[list[Reals]]:
    """Divisions of a closed boundary (m, 2) into four smooth pieces in order, the likeliest first.

    The others lack one of the pieces of the first: an outline that ends in a point has three corners, and which of
    these is a short curve does not show.
    """
    closed = np.concatenate([line, line[:1]])
    spread = np.ptp(line, axis=0)
    away = np.sqrt(np.sum((np.diff(closed, axis=0) / spread) ** 2, axis=-1))
    way = np.concatenate([[0.0], np.cumsum(away)])
    at = np.linspace(0.0, way[-1], FINE_PER_PLACE * RING_PLACES, endpoint=False)
    fine = np.stack([np.interp(at, way, closed[:, i]) for i in (0, 1)], axis=-1)
    ring = fine[::FINE_PER_PLACE]
    cost = _costs(ring / spread) - CORNER_WORTH * _turns(ring / spread)[:, None]
    first = _best_cuts(cost)
    sets = [] if first is None else [first]
    for start, end in zip(sets[0], [*sets[0][1:], sets[0][0] + RING_PLACES], strict=True) if sets else ():
        other = np.array(cost)
        places = np.arange(start - NEAR_PLACES, start + NEAR_PLACES + 1) % RING_PLACES
        steps = slice(max(0, end - start - 2 * NEAR_PLACES), end - start + 2 * NEAR_PLACES + 1)
        other[places, steps] = np.inf
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
    along = places[-1]
    return int(near[np.argmax(places[:, 0] * along[1] - places[:, 1] * along[0])])


def _costs(ring: Reals) -> Reals:
    """Squared distances (RING_PLACES, RING_PLACES + 1) left by cubics through pieces, by start and number of steps."""
    result = np.full((RING_PLACES, RING_PLACES + 1), np.inf)
    least = max(2, int(SHORTEST_CURVE * RING_PLACES))
    around = np.concatenate([ring, ring])
    for steps in range(least, RING_PLACES):
        t = np.linspace(-1.0, 1.0, steps + 1)
        q, _ = np.linalg.qr(np.vander(t, min(4, steps)))
        pieces = np.lib.stride_tricks.sliding_window_view(around, steps + 1, axis=0)[:RING_PLACES]
        total = np.sum(pieces**2, axis=(1, 2))
        result[:, steps] = np.maximum(total - np.sum((pieces @ q) ** 2, axis=(1, 2)), 0.0)
    return result


def _turns(ring: Reals, steps_apart: int = 4) -> Reals:
    """Angles (RING_PLACES,) [rad] by which the boundary turns left around each place, at most 1.2."""
    before, after = ring - np.roll(ring, steps_apart, axis=0), np.roll(ring, -steps_apart, axis=0) - ring
    turn = np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], np.sum(before * after, axis=-1))
    return np.clip(turn, 0.0, 1.2)


def _best_cuts(cost: Reals) -> list[int] | None:
    """The four cuts of the ring with the least sum of squared distances."""
    steps = np.arange(RING_PLACES + 1)
    best: tuple[float, list[int]] = (np.inf, [])
    ahead = (np.arange(RING_PLACES)[:, None] + steps) % RING_PLACES
    # from each start the least sum of two pieces, by their steps together, and where they are cut
    two, cut = np.full((RING_PLACES, RING_PLACES + 1), np.inf), np.zeros((RING_PLACES, RING_PLACES + 1), dtype=int)
    for first in range(1, RING_PLACES):
        value = cost[:, [first]] + cost[ahead[:, first]][:, : RING_PLACES + 1 - first]
        part = two[:, first:]
        better = value < part
        cut[:, first:][better] = first
        two[:, first:] = np.minimum(part, value)
    for start in range(RING_PLACES):
        half = np.arange(2, RING_PLACES - 1)
        total = two[start, half] + two[(start + half) % RING_PLACES, RING_PLACES - half]
        i = int(np.argmin(total))
        if total[i] < best[0]:
            middle = int(half[i])
            other = (start + middle) % RING_PLACES
            cuts = [
                start,
                start + cut[start, middle],
                start + middle,
                start + middle + cut[other, RING_PLACES - middle],
            ]
            best = (float(total[i]), cuts)
    if not best[1]:
        return None
    cuts = sorted(c % RING_PLACES for c in best[1])
    return cuts
