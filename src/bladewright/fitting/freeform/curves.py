"""NURBS curves fitted to points of any dimension."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, final

import numpy as np
from numpy.typing import ArrayLike

from bladewright.errors import FitError, GeometryError
from bladewright.fitting.freeform.fits import (
    FreeformFit,
    checked_ends,
    checked_options,
    checked_points,
    figures_of,
    unit_of,
)
from bladewright.fitting.freeform.net import Net, log_weights, net_of
from bladewright.fitting.freeform.ordering import sites_along
from bladewright.fitting.freeform.refinement import matched_within
from bladewright.fitting.freeform.search import Target
from bladewright.nurbs.basis import Reals, checked_knots, uniform_knots
from bladewright.nurbs.curve import Curve

FIRST_STIFFNESS = 1e-8
"""weight of the bending of the first curve: enough to hold control points that no point is near."""


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
    unit = unit_of(given)
    pair, scaled = checked_ends(ends, unit), unit.scaled(given)
    options = checked_options(
        weights=weights, power=power, robust=robust, tolerance=tolerance, extent=unit.extent, progress=progress
    )
    if start is None:
        shares = sites_along(scaled, closed=closed)
        net = _empty(degree, control_points, knots, weights, scaled.shape[1], closed=closed)
        net = net.through(scaled, shares[:, None], FIRST_STIFFNESS)
    else:
        net = net_of(replace(start, control_points=unit.scaled(start.control_points)), closed=closed)
        shares = net.nearest(scaled)[:, 0]
    target = Target(points=scaled, weights=np.ones(len(scaled)))
    if not closed:
        outermost = np.array([np.argmin(shares), np.argmax(shares)])
        if isinstance(ends, str) and ends == "free":
            target = replace(target, held=(outermost, net.domain))
        else:
            first, last = scaled[outermost] if pair is None else pair
            net = replace(net, held="corners", points=np.stack([first, *net.points[1:-1], last]))
    _check_numbers(net, scaled, weights_free=options.weights_free)
    match, inliers, notes = matched_within(net, target, options, warm=start is not None)
    parameters, figures = figures_of(match, inliers, scaled, unit.extent, *notes)
    curve = match.shape.shape
    assert isinstance(curve, Curve)  # noqa: S101 - one direction
    curve = replace(curve, control_points=unit.restored(curve.control_points))
    return CurveFit(curve=curve, u=parameters[:, 0], tolerance=tolerance, **figures)


def _empty(
    degree: int,
    control_points: int,
    knots: ArrayLike | None,
    weights: str | ArrayLike,
    dimension: int,
    *,
    closed: bool,
) -> Net:
    """A net whose control points are all zero."""
    if degree < 1:
        raise FitError(f"a curve of degree {degree} was asked for: it must be at least 1")
    count = control_points if knots is None else len(np.atleast_1d(knots)) - (1 if closed else degree + 1)
    if count < degree + 1:
        raise FitError(
            f"a curve of degree {degree} with {count} control points was asked for: at least {degree + 1} are needed; "
            "lower the degree or give more control points"
        )
    if closed:
        own = np.linspace(0.0, 1.0, count + 1) if knots is None else np.array(knots, dtype=np.float64)
        if not (np.diff(own) > 0.0).all():
            raise FitError(f"the knots {own.tolist()} of a closed curve must be distinct and increasing; sort them")
    else:
        try:
            own = uniform_knots(count, degree) if knots is None else checked_knots(knots, degree, count, "knots")
        except GeometryError as error:
            raise FitError(f"the knots cannot carry a curve: {error}") from error
    return Net(
        knots=(own,),
        degrees=(degree,),
        points=np.zeros((count, dimension)),
        log_weights=log_weights(weights, (count,)),
        closed=closed,
    )


def _check_numbers(net: Net, points: Reals, *, weights_free: bool) -> None:
    unknowns = int(net.free.sum()) * points.shape[1] + (len(net.points) - 1 if weights_free else 0)
    rows = len(np.unique(points, axis=0)) * (points.shape[1] - 1)
    if unknowns > rows:
        raise FitError(
            f"{len(points)} points, which give {rows} distances, were to determine {unknowns} unknowns of a curve with "
            f"{len(net.points)} control points: take fewer control points, fixed weights, or more points"
        )
