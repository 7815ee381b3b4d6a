"""The order of points along a curve, where none is given."""

import numpy as np
from scipy.sparse.csgraph import dijkstra, minimum_spanning_tree
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from bladewright.fitting.clouds.thinning import random_subset
from bladewright.numerics.elementary import cumulative_length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.closest import Descents
from bladewright.nurbs.curve import Curve

GRID_CELLS = 150
"""cells along the extent of the points in which neighbours become one, so that noise does not fold the path
(design/freeform.md)"""
MOST_CELLS = 1500
"""cells of which all distances are compared; it bounds time and memory."""
IN_ORDER_SHARE = 0.9
"""share of points whose nearest point is next to them in the list, from which the list is an order: a list in no order
has next to none."""


def sites_along(points: Reals, *, closed: bool) -> Reals:
    """Rough places (n,) in [0, 1] of points (n, d) along a curve, by the length of a path through them.

    The path is the list of points where that is an order already. Otherwise it is the longest one in the minimum
    spanning tree of the points, thinned to a grid: right where the curve keeps away from itself by more than its
    points are apart. A closed curve is opened at the widest gap.
    """
    if _in_order(points):
        sites = cumulative_length(np.concatenate([points, points[:1]]) if closed else points)
        return np.asarray(sites[: len(points)] / sites[-1])
    path = _tree_path(points)
    # the outermost points lie past the path's ends, which are means of cells
    path = np.concatenate(
        [path, path[:1]] if closed else [2.0 * path[:1] - path[1:2], path, 2.0 * path[-1:] - path[-2:-1]]
    )
    ends = cumulative_length(path)
    line = Curve(control_points=path, knots=np.concatenate([ends[:1], ends, ends[-1:]]), degree=1)
    sites = Descents((line,)).nearest(points).u
    low, high = (0.0, ends[-1]) if closed else (sites.min(), sites.max())
    return np.asarray((sites - low) / (high - low))


def _in_order(points: Reals) -> bool:
    nearest, steps = cKDTree(points).query(points, k=2)[0][:, 1], np.diff(cumulative_length(points))
    beside = np.minimum(np.append(steps, np.inf), np.append(np.inf, steps))
    return bool(np.mean(beside <= nearest * (1.0 + 1e-9)) >= IN_ORDER_SHARE)


def _tree_path(points: Reals) -> Reals:
    cells = np.floor((points - points.min(axis=0)) / (np.ptp(points, axis=0).max() / GRID_CELLS)).astype(np.int64)
    _, cell = np.unique(cells, axis=0, return_inverse=True)
    centres = np.stack([np.bincount(cell, weights=column) / np.bincount(cell) for column in points.T], axis=-1)
    centres = centres[random_subset(len(centres), MOST_CELLS)]
    tree = minimum_spanning_tree(cdist(centres, centres))
    first = int(np.argmax(dijkstra(tree, directed=False, indices=0)))
    distances, before = dijkstra(tree, directed=False, indices=first, return_predecessors=True)
    path = [int(np.argmax(distances))]
    while path[-1] != first:
        path.append(int(before[path[-1]]))
    return np.asarray(centres[path[::-1]])
