"""The order of points along a curve, where none is given."""

import numpy as np
from scipy.sparse.csgraph import dijkstra, minimum_spanning_tree
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from bladewright.nurbs.basis import Reals
from bladewright.nurbs.closest import Descents
from bladewright.nurbs.curve import Curve

GRID_CELLS = 150
"""cells along the extent of the points in which neighbours become one, so that noise does not fold the path."""
MOST_CELLS = 1500
"""cells of which all distances are compared; it bounds time and memory."""
IN_ORDER_SHARE = 0.9
"""share of points whose nearest point is next to them in the list, from which the list is an order."""
LONGEST_DETOUR = 3.0
"""length of the way through the list, of the length through the tree, from which the list is no order."""


def sites_along(points: Reals, *, closed: bool) -> Reals:
    """Rough places (n,) in [0, 1] of points (n, d) along a curve, by the length of a path through them.

    The path is the list of points where that is an order already. Otherwise it is the longest one in the minimum
    spanning tree of the points, thinned to a grid: right where the curve keeps away from itself by more than its
    points are apart. A closed curve is opened at the widest gap.
    """
    path = _tree_path(points)
    own = np.sqrt(np.sum(np.diff(points, axis=0) ** 2, axis=-1))
    if _listed_in_order(points, own) and own.sum() <= LONGEST_DETOUR * _length(path):
        path, sites = points, np.concatenate([[0.0], np.cumsum(own)])
        whole = sites[-1] + (np.sqrt(np.sum((points[0] - points[-1]) ** 2)) if closed else 0.0)
        return np.asarray(sites / whole)
    # the outermost points lie past the path's ends, which are means of cells
    path = np.concatenate(
        [path, path[:1]] if closed else [2.0 * path[:1] - path[1:2], path, 2.0 * path[-1:] - path[-2:-1]]
    )
    ends = np.concatenate([[0.0], np.cumsum(np.sqrt(np.sum(np.diff(path, axis=0) ** 2, axis=-1)))])
    line = Curve(control_points=path, knots=np.concatenate([ends[:1], ends, ends[-1:]]), degree=1)
    sites = Descents((line,)).nearest(points).u
    low, high = (0.0, ends[-1]) if closed else (sites.min(), sites.max())
    return np.asarray((sites - low) / (high - low))


def _listed_in_order(points: Reals, steps: Reals) -> bool:
    distance, _ = cKDTree(points).query(points, k=2)
    beside = np.minimum(np.append(steps, np.inf), np.append(np.inf, steps))
    return bool(np.mean(beside <= distance[:, 1] * (1.0 + 1e-9)) >= IN_ORDER_SHARE)


def _tree_path(points: Reals) -> Reals:
    cells = GRID_CELLS
    while True:
        centres = _thinned(points, cells)
        if len(centres) <= MOST_CELLS:
            break
        cells = cells * 2 // 3
    if len(centres) < 3:
        return points[np.lexsort(points.T)][[0, -1]] if len(centres) < 2 else centres
    tree = minimum_spanning_tree(cdist(centres, centres))
    first = int(np.argmax(dijkstra(tree, directed=False, indices=0)))
    distances, before = dijkstra(tree, directed=False, indices=first, return_predecessors=True)
    path = [int(np.argmax(distances))]
    while path[-1] != first:
        path.append(int(before[path[-1]]))
    return np.asarray(centres[path[::-1]])


def _thinned(points: Reals, cells: int) -> Reals:
    low = points.min(axis=0)
    size = np.ptp(points, axis=0).max() / cells
    index = np.floor((points - low) / size).astype(np.int64)
    _, cell = np.unique(index, axis=0, return_inverse=True)
    count = np.bincount(cell)
    return np.stack([np.bincount(cell, weights=column) / count for column in points.T], axis=-1)


def _length(path: Reals) -> float:
    return float(np.sum(np.sqrt(np.sum(np.diff(path, axis=0) ** 2, axis=-1))))
