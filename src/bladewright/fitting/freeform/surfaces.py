"""NURBS surfaces fitted to scattered points in space."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, final

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import ConvexHull

from bladewright.errors import FitError, GeometryError
from bladewright.fitting.freeform.fits import FreeformFit, checked_options, checked_points, figures_of, unit_of
from bladewright.fitting.freeform.net import DIRECTIONS, Net, log_weights, net_of
from bladewright.fitting.freeform.refinement import matched_within
from bladewright.fitting.freeform.search import Target
from bladewright.nurbs.basis import Reals, checked_knots, uniform_knots
from bladewright.nurbs.domain import extended, reparametrised
from bladewright.nurbs.surface import Surface

FIRST_STIFFNESS = 1e-6
"""weight of the bending of the first surface: enough to hold control points that no point is near."""
CONTINUED_SHARE = 0.05
"""length, of the domain, by which the surface is continued past its edges while it moves."""
HELD_BY_BOUNDARY: dict[str, Literal["none", "corners", "boundary"]] = {
    "free": "none",
    "corners": "corners",
    "fixed": "boundary",
}
"""control points that a boundary holds"""
ON_A_LINE = 1e-9
"""second extent of the points, of the first, below which they lie on a line."""


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SurfaceFit(FreeformFit):
    """A surface fitted to n points."""

    surface: Surface
    u: Reals
    """(n,) parameters of the nearest places"""
    v: Reals
    """(n,)"""


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

    `weights` are one, (n_u, n_v) given ones, or `free` ones, whose logarithms have no mean (and no trend along a
    direction without inner knots). `boundary` is `free`, or the `corners` are held at four of the points (at those of
    `start`), or all outer control points are `fixed` at those of `start`. Where the points leave control points open,
    the bending of the surface decides; `rank` says how many directions the points determine. With `tolerance` knots are
    added along u or v, whichever gains more for a control point, until no inlier is further away; notes say where noise
    stops it. The other arguments are those of `fit_curve`.

    Raises FitError where points are too few, not finite or on a line, or a choice is unknown. Source: as of
    `fit_curve`; the bending is the thin-plate energy (Duchon 1977) in the surface's parameters.
    """
    given = checked_points(points, "a surface", (3,))
    if boundary not in HELD_BY_BOUNDARY:
        raise FitError(f"boundary {boundary!r} is unknown: `free`, `corners`, or `fixed` at that of `start`")
    if boundary == "fixed" and start is None:
        raise FitError("a fixed boundary was asked for without `start`: give the surface whose boundary is to stay")
    unit = unit_of(given)
    scaled = unit.scaled(given)
    options = checked_options(
        weights=weights, power=power, robust=robust, tolerance=tolerance, extent=unit.extent, progress=progress
    )
    plane = _rectangle(scaled)
    if start is None:
        net = _empty(degrees, control_points, knots, weights).through(scaled, plane, FIRST_STIFFNESS)
        if boundary == "corners":
            own = net.points.reshape(*net.counts, 3)
            for i, j in ((0, 0), (0, -1), (-1, 0), (-1, -1)):
                own[i, j] = scaled[np.argmin(np.sum((plane + np.array([i, j])) ** 2, axis=1))]
            net = replace(net, points=own.reshape(-1, 3))
    else:
        net = net_of(replace(start, control_points=unit.scaled(start.control_points)))
    low, high = net.domain
    # where points leave control points open, a surface continued past its edges may swing back among the points
    near = None if start is None else net.nearest(scaled)
    if boundary == "free":
        net = net_of(_widened(_surface_of(net)))
    net = replace(net, held=HELD_BY_BOUNDARY[boundary])
    _check_numbers(net, scaled, weights_free=options.weights_free)
    target = Target(points=scaled, weights=np.ones(len(scaled)))
    match, inliers, notes = matched_within(net, target, options, warm=start is not None, near=near)
    if boundary == "free":
        first, last = (getattr(np, end)(match.parameters, axis=0) for end in ("min", "max"))
        net = replace(net_of(_cut(_surface_of(match.shape), first, last, low, high)), weighted=options.weights_free)
        mapped = low + (match.parameters - first) / (last - first) * (high - low)
        match = replace(match, shape=net, parameters=np.clip(mapped, low, high))
    parameters, figures = figures_of(match, inliers, scaled, unit.extent, *notes)
    surface = _surface_of(match.shape)
    surface = replace(surface, control_points=unit.restored(surface.control_points))
    return SurfaceFit(surface=surface, u=parameters[:, 0], v=parameters[:, 1], tolerance=tolerance, **figures)


def _surface_of(net: Net) -> Surface:
    assert isinstance(net.shape, Surface)  # noqa: S101 - two directions
    return net.shape


def _widened(surface: Surface) -> Surface:
    """The surface continued past its edges, so that no place is held at one while it moves.

    An edge that moves inwards past a point is a wall for the descent: hundreds of steps where a dozen are enough.
    """
    try:
        for direction in DIRECTIONS:
            low, high = surface.domain_u if direction == "u" else surface.domain_v
            margin = CONTINUED_SHARE * (high - low)
            surface = extended(surface, low - margin, high + margin, direction)
    except GeometryError:
        # weights that fall towards an edge would not stay positive
        return surface
    return surface


def _cut(surface: Surface, first: Reals, last: Reals, low: Reals, high: Reals) -> Surface:
    """The surface from its first to its last parameters (2,), which become `low` and `high` (2,)."""
    for k, direction in enumerate(DIRECTIONS):
        cut = extended(surface, float(first[k]), float(last[k]), direction)
        surface = reparametrised(cut, float(low[k]), float(high[k]), direction)
    return surface


def _rectangle(points: Reals) -> Reals:
    """Places (n, 2) in [0, 1] of points (n, 3) in the smallest rectangle around them in their principal plane.

    One of its sides lies along one of the convex hull (Freeman and Shapira 1975); u runs along the longer side.
    """
    _, size, axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    if size[1] <= ON_A_LINE * size[0]:
        raise FitError(f"the {len(points)} points lie on a line: a surface needs points beside it")
    plane = points @ axes[:2].T
    hull = plane[ConvexHull(plane).vertices]
    sides = np.roll(hull, -1, axis=0) - hull
    angles = np.arctan2(sides[:, 1], sides[:, 0])
    turns = np.moveaxis(np.array([[np.cos(angles), -np.sin(angles)], [np.sin(angles), np.cos(angles)]]), 2, 0)
    turn = turns[np.argmin(np.prod(np.ptp(hull @ turns, axis=1), axis=1))]
    turned = plane @ turn
    size = np.ptp(turned, axis=0)
    shares = (turned - turned.min(axis=0)) / size
    return shares if size[0] >= size[1] else shares[:, ::-1]


def _empty(
    degrees: tuple[int, int],
    control_points: tuple[int, int],
    knots: tuple[ArrayLike, ArrayLike] | None,
    weights: str | ArrayLike,
) -> Net:
    """A net whose control points are all zero."""
    if {len(degrees), len(control_points), 2 if knots is None else len(knots)} != {2}:
        raise FitError(
            "a surface has two degrees, two numbers of control points, and two arrays of knots: one for u and v"
        )
    counts = control_points if knots is None else tuple(
        len(np.atleast_1d(own)) - degree - 1 for own, degree in zip(knots, degrees, strict=True)
    )  # fmt: skip
    try:
        own = tuple(
            uniform_knots(counts[k], degrees[k])
            if knots is None
            else checked_knots(knots[k], degrees[k], counts[k], f"knots_{'uv'[k]}")
            for k in range(2)
        )
        if min(degrees) < 1:
            raise FitError(f"a surface of degrees {degrees} was asked for: both must be at least 1")
    except GeometryError as error:
        raise FitError(f"a surface of degrees {degrees} with {counts} control points: {error}") from error
    logs = log_weights(weights, (counts[0], counts[1]))
    return Net(knots=own, degrees=degrees, points=np.zeros((counts[0] * counts[1], 3)), log_weights=logs)


def _check_numbers(net: Net, points: Reals, *, weights_free: bool) -> None:
    unknowns = int(net.free.sum()) + (len(net.points) - 1 if weights_free else 0)
    if unknowns > len(np.unique(points, axis=0)):
        raise FitError(
            f"{len(points)} points were to determine a surface with {net.counts[0]} x {net.counts[1]} control points"
            f"{' and free weights' if weights_free else ''}: {unknowns} different ones are needed at least; "
            "take fewer control points, fixed weights, or more points"
        )
