"""NURBS curves of any dimension, and surfaces in space, fitted to points."""

from __future__ import annotations

from collections.abc import Callable, Sized
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, Literal, final

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse.csgraph import dijkstra, minimum_spanning_tree
from scipy.spatial import ConvexHull, cKDTree
from scipy.spatial.distance import cdist

from bladewright.errors import FitError, GeometryError
from bladewright.fitting.checks import check_kind, check_whole, reals, refusing
from bladewright.fitting.clouds.thinning import random_subset
from bladewright.fitting.freeform.fits import FreeformFit, Request
from bladewright.fitting.freeform.net import DIRECTIONS, Net, laid, matched_net, net_of
from bladewright.numerics.elementary import cumulative_length
from bladewright.numerics.single_thread import single_threaded
from bladewright.nurbs.basis import Reals, uniform_knots
from bladewright.nurbs.closest import Descents
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import extended, reparametrised
from bladewright.nurbs.refine import direction_of
from bladewright.nurbs.surface import Surface

GRID_CELLS = 150
"""cells along the extent in which neighbours become one, so that noise does not fold the path (design/freeform.md)"""
MOST_CELLS = 1500
"""cells of which all distances are compared; it bounds time and memory (design/matching_constants.md)"""
MARGIN = 0.05
"""length, of the domain, by which the surface is continued past its edges while it moves (design/freeform.md)"""


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class CurveFit(FreeformFit):
    """A curve fitted to n points."""

    curve: Curve
    u: Reals
    """(n,) parameters of the nearest places"""


@single_threaded
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
    (n,) given ones, or `free`: positive ones, of whose logarithms mean and, without inner knots, linear trend are zero,
    as these change no shape. `ends` of an open curve are `fixed` at the first and the last point along it, two points,
    or `free`: where the nearest places end, by which inner knots move a little. `power` 2 is least squares, 4 the
    objective of the source. Where the points leave control points open, the bending decides. With `tolerance` (in the
    unit of the points) knots are added where the deviation is until no inlier is further away; notes say where noise
    stops it. `robust` leaves outliers out.

    Raises FitError where points are too few, not finite or all the same, or a choice is unknown. Source: the freeform
    NURBS blading paper, section 4.1 (true distances by Newton), here with exact derivatives and Levenberg-Marquardt
    steps in place of finite differences.
    """
    request = Request("a curve", points, power, tolerance, progress, weights=weights, robust=robust)
    check_whole(degree=degree, control_points=control_points)
    check_kind(start, Curve)
    if closed and not (isinstance(ends, str) and ends == "fixed"):
        raise FitError("closed and ends are both given: a closed curve has no ends; leave one out")
    pair, scaled = request.ends(ends), request.points
    if start is None:
        shares = sites_along(scaled, closed=closed)
        with refusing():
            own = _knots(knots, control_points, degree, closed=closed)
            flat = Curve(control_points=np.zeros((len(own) - degree - 1, scaled.shape[1])), knots=own, degree=degree)
            net = laid(net_of(flat, closed=closed), scaled, shares[:, None], weights)
    else:
        net = net_of(replace(start, control_points=request.scaled(start.control_points)), closed=closed)
        shares = net.nearest(scaled)[:, 0]
    if not closed and not (pair is None and ends == "free"):
        first, last = scaled[[np.argmin(shares), np.argmax(shares)]] if pair is None else pair
        net = replace(net, boundary="corners", points=np.stack([first, *net.points[1:-1], last]))
    curve, parameters, figures = _matched(net, request, warm=start is not None)
    return CurveFit(curve=curve, u=parameters[:, 0], **figures)


def _matched(net: Net, request: Request, *, warm: bool) -> tuple[Any, Reals, dict[str, Any]]:
    """The curve or surface of a match, the parameters (n, k) of the nearest places, and the figures.

    A free boundary is continued while it moves, as one that moves inwards past a point is a wall for the descent:
    hundreds of steps where a dozen are enough. At last it is cut where the places end.
    """
    low, high = net.domain
    free = net.boundary == "free" and not net.closed
    if free:
        # weights that fall towards an edge would not stay positive past it
        with suppress(GeometryError):
            net = net_of(_over(net.shape, low - MARGIN * (high - low), high + MARGIN * (high - low)))
    match, notes = matched_net(net, request, warm=warm)
    shape, parameters = match.shape.shape, match.parameters
    if free:
        inner = parameters[match.inliers]
        first, last = np.min(inner, axis=0), np.max(inner, axis=0)
        shape = _over(shape, first, last)
        parameters = np.clip(low + (parameters - first) / (last - first) * (high - low), low, high)
    return request.restored(shape), parameters, match.figures(request, *notes)


def _over(shape: Any, first: Reals, last: Reals) -> Any:
    """A curve or surface from its first to its last parameters (k,), where it is cut or continued; its domain stays."""
    for direction, start, end in zip(DIRECTIONS, first, last, strict=False):
        knots, _ = direction_of(shape, direction)
        shape = reparametrised(extended(shape, float(start), float(end), direction), knots[0], knots[-1], direction)
    return shape


def _knots(given: ArrayLike | None, count: int, degree: int, *, closed: bool = False) -> Reals:
    """Clamped knots, uniform or as given; those given of a closed curve are the distinct ones of a period."""
    own = None if given is None else np.atleast_1d(reals("knots", given, "give an increasing list"))
    uniform = uniform_knots(count if own is None else len(own) - (1 if closed else degree + 1), degree)
    if not closed:
        return uniform if own is None else own
    period = np.linspace(0.0, 1.0, count + 1) if own is None else own
    if not (np.diff(period) > 0.0).all():
        raise FitError(f"the knots {period.tolist()} of a closed curve must be distinct and increasing; sort them")
    return np.pad(period, degree, "edge")


def sites_along(points: Reals, *, closed: bool) -> Reals:
    """Rough places (n,) in [0, 1] of points (n, d) along a curve, by the length of a path through them.

    The path is the list itself if in order, or the longest in the minimum spanning tree, right where the curve keeps
    away from itself by more than its points are apart. A closed curve is opened at the widest gap.
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
    """Whether the nearest point of most is next to them in the list; in a list in no order, that of next to none is."""
    nearest, steps = cKDTree(points).query(points, k=2)[0][:, 1], np.diff(cumulative_length(points))
    beside = np.minimum(np.append(steps, np.inf), np.append(np.inf, steps))
    return bool(np.median(beside - nearest * (1.0 + 1e-9)) <= 0.0)


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


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SurfaceFit(FreeformFit):
    """A surface fitted to n points."""

    surface: Surface
    u: Reals
    """(n,) parameters of the nearest places"""
    v: Reals
    """(n,)"""


@single_threaded
def fit_surface(
    points: ArrayLike,
    *,
    degrees: tuple[int, int] = (3, 3),
    control_points: tuple[int, int] = (6, 6),
    knots: tuple[ArrayLike, ArrayLike] | None = None,
    weights: Literal["fixed", "free"] | ArrayLike = "fixed",
    boundary: Literal["free", "corners", "fixed"] = "free",
    power: float = 2.0,
    start: Surface | None = None,
    tolerance: float | None = None,
    robust: bool = False,
    progress: Callable[[str], None] | None = None,
) -> SurfaceFit:
    """The NURBS surface from which the mean `power` of the true distances of scattered points (n, 3) is least.

    The points are those of a roughly rectangular patch that can be seen whole from one direction: their first
    parameters are those of the smallest rectangle around them in their principal plane, u along its longer side. For
    others give `start`, whose degrees, knots, control points and weights are then the first ones.

    `boundary` is `free`, or the `corners` are held at four of the points (at those of `start`), or all outer control
    points are `fixed` at those of `start`. With `tolerance` knots are added along u or v, whichever gains more for a
    control point. `weights` are one, (n_u, n_v) given ones, or `free`; they and the others are those of `fit_curve`.

    Raises FitError where points are too few, not finite or on a line, or a choice is unknown. Source: as of
    `fit_curve`; the bending is that of a thin plate under tension (Franke 1985) in the surface's parameters.
    """
    request = Request("a surface", points, power, tolerance, progress, dimension=3, weights=weights, robust=robust)
    if boundary not in ("free", "corners", "fixed"):
        raise FitError(f"boundary {boundary!r} is unknown: `free`, `corners`, or `fixed` at that of `start`")
    if boundary == "fixed" and start is None:
        raise FitError("a fixed boundary was asked for without `start`: give the surface whose boundary is to stay")
    check_kind(start, Surface)
    pairs: tuple[Any, ...] = degrees, control_points, (0, 0) if knots is None else knots
    if not all(isinstance(each, Sized) and len(each) == 2 for each in pairs):
        raise FitError(
            "a surface has two degrees, two numbers of control points, and two arrays of knots: one for u and v"
        )
    for degree, count in zip(degrees, control_points, strict=True):
        check_whole(degree=degree, control_points=count)
    scaled = request.points
    if start is None:
        shares = _rectangle(scaled)
        with refusing():
            own = (None, None) if knots is None else knots
            u, v = (_knots(*each) for each in zip(own, control_points, degrees, strict=True))
            none = np.zeros((len(u) - degrees[0] - 1, len(v) - degrees[1] - 1, 3))
            flat = Surface(control_points=none, knots_u=u, knots_v=v, degree_u=degrees[0], degree_v=degrees[1])
            net = laid(net_of(flat), scaled, shares, weights)
        if boundary == "corners":
            corners = [np.argmin(np.sum((shares - corner) ** 2, axis=1)) for corner in np.ndindex(2, 2)]
            net.points[~replace(net, boundary="corners").free] = scaled[corners]
    else:
        net = net_of(replace(start, control_points=request.scaled(start.control_points)))
    surface, parameters, figures = _matched(replace(net, boundary=boundary), request, warm=start is not None)
    u, v = parameters.T
    return SurfaceFit(surface=surface, u=u, v=v, **figures)


def _rectangle(points: Reals) -> Reals:
    """Places (n, 2) in [0, 1] of points (n, 3) in the smallest rectangle around them in their principal plane.

    One of its sides lies along one of the convex hull (Freeman and Shapira 1975); u runs along the longer side.
    """
    away = points - points.mean(axis=0)
    axes = np.linalg.svd(away, full_matrices=False)[2]
    if np.linalg.matrix_rank(away) < 2:
        raise FitError(f"the {len(points)} points lie on a line: a surface needs points beside it")
    plane = points @ axes[:2].T
    hull = plane[ConvexHull(plane).vertices]
    along = np.roll(hull, -1, axis=0) - hull
    along /= np.sqrt(np.sum(along**2, axis=1))[:, None]
    turns = np.stack([along, along[:, ::-1] * [-1.0, 1.0]], axis=-1)
    turned = plane @ turns[np.argmin(np.prod(np.ptp(hull @ turns, axis=1), axis=1))]
    size = np.ptp(turned, axis=0)
    shares = (turned - turned.min(axis=0)) / size
    return shares if size[0] >= size[1] else shares[:, ::-1]
