"""Several blades in one cloud: a wheel that turns onto itself, or pieces that stand apart and are each other's copies.

A single blade does neither: the further it is turned about the axis, the further it is from itself; and its pieces are
rows or sides, none of which has a thickness.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from bladewright.fitting.clouds.sheet import is_one_sided
from bladewright.fitting.clouds.thinning import even_subset, random_subset
from bladewright.nurbs.basis import Reals

COMPARED_POINTS = 6000, 2000
"""points among which neighbours are joined: many part blades that stand close, few join the rows of one."""
NEIGHBOURS = 8
"""neighbours with which a point may be joined; it bounds the time"""
GAP = {2: 4.5, 3: 2.5}
"""distance that parts pieces, in the spacing of the points, by dimension"""
FEWEST_POINTS = {2: 24, 3: 50}
"""points of the smallest piece, by dimension"""
SAME_SHAPE = 0.005
"""distance within which copies lie on each other, of their extent"""
BLADE_COUNTS = range(2, 152)
"""numbers of blades around the axis that are tried"""
TURNED_POINTS = 300
"""points that are turned by each trial pitch; it bounds the time."""


def pitch_found(points: Reals) -> str | None:
    """By how much, in words, a blade in the cloud (n, 2) or (n, 3) [m] lies beside the next; None of a single blade."""
    wheel = _pitch_of_wheel(points) if points.shape[1] == 3 else None
    if wheel is not None:
        return wheel
    for count in COMPARED_POINTS:
        some = points[even_subset(points, count)]
        pieces = [some[rows] for rows in _pieces(some)]
        if len(pieces) < 2 or is_one_sided(pieces[0]):
            continue
        found = [each for each in (_moved_onto(pieces[0], other) for other in pieces[1:]) if each is not None]
        if found:
            return min(found)[1]
    return None


def _pieces(points: Reals) -> list[NDArray[np.intp]]:
    """Indices of the points of each piece that stands apart, largest first."""
    near, index = cKDTree(points).query(points, k=NEIGHBOURS + 1)
    dimension = points.shape[1]
    rows, columns = np.nonzero(near < GAP[dimension] * float(np.percentile(near[:, 1], 95.0)))
    graph = coo_array((np.ones(len(rows)), (rows, index[rows, columns])), shape=(len(points), len(points)))
    _, labels = connected_components(graph, directed=False)
    counts = np.bincount(labels)
    return [np.flatnonzero(labels == i) for i in np.argsort(-counts) if counts[i] >= FEWEST_POINTS[dimension]]


def _moved_onto(piece: Reals, other: Reals) -> tuple[float, str] | None:
    """How far [m] a piece must be moved along y, or turned about x, to lie on another one; None where neither works."""
    if not 0.6 < len(piece) / len(other) < 1.7:
        return None
    tree = cKDTree(other)
    near = SAME_SHAPE * float(np.sqrt(np.sum(np.ptp(piece, axis=0) ** 2)))
    near += 1.5 * float(np.median(tree.query(other, k=2)[0][:, 1]))
    step = np.zeros(piece.shape[1])
    step[1] = np.mean(other[:, 1]) - np.mean(piece[:, 1])
    moved = [(piece + step, abs(float(step[1])), f"{abs(float(step[1])):.4g} m")]
    if piece.shape[1] == 3:
        angles = [np.arctan2(np.mean(p[:, 1]), np.mean(p[:, 2])) for p in (piece, other)]
        turn = float((angles[1] - angles[0] + np.pi) % (2.0 * np.pi) - np.pi)
        radius = float(np.mean(np.sqrt(piece[:, 1] ** 2 + piece[:, 2] ** 2)))
        moved.append((_turned(piece, turn), abs(turn) * radius, f"{abs(np.degrees(turn)):.4g} deg"))
    missed = [max(np.mean(tree.query(copy)[0]), np.mean(cKDTree(copy).query(other)[0])) for copy, *_ in moved]
    best = int(np.argmin(missed))
    return moved[best][1:] if missed[best] < near else None


def _pitch_of_wheel(points: Reals) -> str | None:
    """The pitch of blades all around the axis, in words.

    Turned by the pitch either way, most points lie twice as near to the cloud as turned by half of it.
    """
    tree, some = cKDTree(points), points[random_subset(len(points), TURNED_POINTS)]

    def away(turn: float) -> float:
        return float(np.median(np.max([tree.query(_turned(some, each))[0] for each in (turn, -turn)], axis=0)))

    whole = np.array([away(2.0 * np.pi / count) for count in BLADE_COUNTS])
    inner = range(1, len(whole) - 1)
    lowest = [i for i in inner if whole[i] < min(whole[i - 1], whole[i + 1])]
    counts = [BLADE_COUNTS[i] for i in lowest if whole[i] < 0.5 * away(np.pi / BLADE_COUNTS[i])]
    return f"{360.0 / max(counts):.4g} deg" if counts else None


def _turned(points: Reals, turn: float) -> Reals:
    """Points (n, 3) turned about x [rad], from z towards y."""
    (x, y, z), c, s = points.T, np.cos(turn), np.sin(turn)
    return np.stack([x, c * y + s * z, c * z - s * y], axis=-1)
