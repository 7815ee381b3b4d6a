"""NURBS curves fitted to points of any dimension."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, final

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse.csgraph import dijkstra, minimum_spanning_tree
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from bladewright.fitting.clouds.thinning import random_subset
from bladewright.fitting.freeform.fits import (
    FreeformFit,
    Unit,
    checked_ends,
    checked_options,
    checked_points,
    figures_of,
)
from bladewright.fitting.freeform.net import empty_net, net_of
from bladewright.fitting.freeform.refinement import matched_within
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


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class CurveFit(FreeformFit):
    """A curve fitted to n points."""

    curve: Curve
    u: Reals
    """(n,) parameters of the nearest places"""


def fit_curve(
    points: ArrayLike,
    *,
    degree: int = 3,
    control_points: int = 6,
    knots: ArrayLike | None = None,
    weights: Literal["fixed", "free"] | ArrayLike = "fixed",
    ends: Literal["fixed", "free"] | tuple[ArrayLike, ArrayLike] = "fixed",
    closed: bool = False,
    power: float = 2.0,
    start: Curve | None = None,
    tolerance: float | None = None,
    robust: bool = False,
    progress: Callable[[str], None] | None = None,
) -> CurveFit:
    """The NURBS curve from which the mean `power` of the true distances of points (n, d) is least.

    Points come in any order and dimension. A list that is in order is taken as it is; otherwise the order is the
    longest path of the minimum spanning tree, which needs a curve that keeps away from itself by more than its points
    are apart; where it does not, give `start`, whose degree, knots, control points and weights are then the first ones.

    `knots` are uniform by default; those of a closed curve are the n + 1 distinct ones of a period. `weights` are one,
    (n,) given ones, or `free`; free ones are positive, and the mean of their logarithms is zero (without inner knots
    their logarithms have no linear trend either), which leaves out what changes no shape. `ends` of an open curve are
    `fixed` at the first and the last point along it, `free` (the ends are matched to these points as others to their
    nearest places), or two points. `power` 2 is least squares, 4 the objective of the source. The bending is as large
    as raises the root mean square by at most 0.2 %. With `tolerance` (in the unit of the points) knots are added where
    the deviation is until no inlier is further away; notes say where noise stops it. `robust` finds outliers and leaves
    them out.

    Raises FitError where points are too few, not finite or all the same, or a choice is unknown. Source: the objective
    and its 'true distance by Newton' of the freeform NURBS blading paper, section 4.1, here with exact derivatives (a
    point is linear in the control points; at its nearest place the distance does not change with the parameter) and
    Levenberg-Marquardt steps in place of finite differences.
    """
    given = checked_points(points, "a curve")
    unit = Unit(given)
    pair, scaled = checked_ends(ends, unit), unit.scaled(given)
    options = checked_options(
        weights=weights, power=power, robust=robust, tolerance=tolerance, extent=unit.extent, progress=progress
    )
    if start is None:
        shares = sites_along(scaled, closed=closed)
        own = None if knots is None else (knots,)
        net = empty_net((degree,), (control_points,), own, weights, scaled.shape[1], closed=closed)
        net = net.through(scaled, shares[:, None])
    else:
        net = net_of(replace(start, control_points=unit.scaled(start.control_points)), closed=closed)
        shares = net.nearest(scaled)[:, 0]
    if not closed:
        outermost = int(np.argmin(shares)), int(np.argmax(shares))
        if isinstance(ends, str) and ends == "free":
            net = replace(net, ends=outermost)
        else:
            first, last = scaled[list(outermost)] if pair is None else pair
            net = replace(net, held="corners", points=np.stack([first, *net.points[1:-1], last]))
    match, notes = matched_within(net, scaled, options, warm=start is not None)
    curve = match.shape.shape
    assert isinstance(curve, Curve)  # noqa: S101 - one direction
    curve = replace(curve, control_points=unit.restored(curve.control_points))
    figures = figures_of(match, unit.extent, *notes)
    return CurveFit(curve=curve, u=match.parameters[:, 0], tolerance=tolerance, **figures)


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
