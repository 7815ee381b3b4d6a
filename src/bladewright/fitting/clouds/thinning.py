"""Fewer points of a cloud: drawn at random, spread evenly, without copies or those that stand alone; and groups."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from bladewright.nurbs.basis import Reals

MOST_POINTS = 20_000
"""points, drawn at random, that stand for a cloud of any size where all would take too long (design/matching.md)"""
NEIGHBOURS, FEWEST_KNOWING = 16, 3
"""nearest neighbours of a point, and the most points that have an isolated one among theirs (design/matching.md)"""
ROUNDS = 6
"""times that isolated points are sought among the rest (design/matching_constants.md)"""


def random_subset(count: int, most: int) -> NDArray[np.intp]:
    """Indices, in order, of at most `most` of `count` points: a random draw, always the same, as dense as the cloud."""
    if count <= most:
        return np.arange(count, dtype=np.intp)
    return np.sort(np.random.default_rng(0).choice(count, most, replace=False))


def even_subset(points: Reals, most: int) -> NDArray[np.intp]:
    """Indices, in order, of at most so many of points (n, d): the middle ones of the cells of the finest grid."""
    if len(points) <= most:
        return np.arange(len(points), dtype=np.intp)
    offset = points - points.min(axis=0)
    size = float(offset.max()) * (1.0 + 1e-9) or 1.0
    # halvings of the extent: 4096 cells along it are the finest
    coarse, fine = 0.0, 12.0
    for _ in range(9):
        middle = 0.5 * (coarse + fine)
        few = len(np.unique(_cells(offset / size, middle)[0])) <= most
        coarse, fine = (middle, fine) if few else (coarse, middle)
    keys, off_middle = _cells(offset / size, coarse)
    inward = np.argsort(off_middle, kind="stable")
    return np.sort(inward[np.unique(keys[inward], return_index=True)[1]])


def _cells(places: Reals, halvings: float) -> tuple[NDArray[np.intp], Reals]:
    """Numbers (n,) of the cells of a grid in which places (n, d) in [0, 1) are, and how far off their middles."""
    count = int(2.0**halvings)
    corner = np.floor(places * count)
    keys = corner.astype(np.intp) @ (count + 1) ** np.arange(places.shape[1])
    return keys, np.sum((places * count - corner - 0.5) ** 2, axis=1)


def without_copies(points: Reals) -> NDArray[np.intp]:
    """Indices, in order, of points (n, d), each place once where most are copies: these share their noise."""
    # points of different x are no copies, which is soon known
    if 2 * len(np.unique(points[:, 0])) > len(points):
        return np.arange(len(points), dtype=np.intp)
    _, first = np.unique(points, axis=0, return_index=True)
    return np.sort(first) if 2 * len(first) <= len(points) else np.arange(len(points), dtype=np.intp)


def groups(linked: NDArray[np.bool_], index: NDArray[np.intp]) -> NDArray[np.intp]:
    """Labels (n,) of the groups that points form with those neighbours (n, k) to which they are linked (n, k)."""
    start, way = np.nonzero(linked)
    graph = csr_array((np.ones(len(start), dtype=np.int8), (start, index[start, way])), shape=(len(index),) * 2)
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.intp)


def isolated_points(points: Reals) -> NDArray[np.bool_]:
    """Which of different points (n, d) stand alone: so few of the others have them among their nearest neighbours.

    Points at the border of a cloud do not, nor where it becomes denser. Outliers are neighbours of outliers, so that it
    is done again. Reference: Hautamaki, Karkkainen and Franti 2004 (outlier detection using indegree number).
    """
    rows = np.arange(len(points))
    for _ in range(ROUNDS):
        if len(rows) <= 2 * NEIGHBOURS:
            break
        index = cKDTree(points[rows]).query(points[rows], k=NEIGHBOURS + 1)[1]
        known = np.bincount(index[:, 1:].ravel(), minlength=len(rows)) > FEWEST_KNOWING
        if np.all(known):
            break
        rows = rows[known]
    return ~np.isin(np.arange(len(points)), rows)


def without_isolated_points(points: Reals) -> Reals:
    """The points that do not stand alone."""
    return np.asarray(points[~isolated_points(points)])
