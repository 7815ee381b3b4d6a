"""NURBS curves fitted to points of any dimension."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Literal, final

import numpy as np
from numpy.typing import ArrayLike

from bladewright.errors import FitError, GeometryError
from bladewright.fitting.freeform.net import Net, NetTarget, periodic
from bladewright.fitting.freeform.options import FreeformFit, checked_logs, checked_options, checked_points
from bladewright.fitting.freeform.ordering import sites_along
from bladewright.fitting.freeform.projection import certified_parameters, nearer_projections, projected
from bladewright.fitting.freeform.stages import FitOptions, StagedMatch, staged_match_within
from bladewright.nurbs.basis import Reals, breaks, checked_knots, uniform_knots
from bladewright.nurbs.curve import Curve

FIRST_STIFFNESS = 1e-8
"""weight of the bending of the first curve: enough to hold control points that no point is near."""
SYSTEMATIC_RATIO = 3.0
"""root mean square of the distances, of the noise, from which the curve is searched a second way."""
NOISE_RATIO = 1.25
"""root mean square of a knot span's distances, of the noise, up to which they are noise."""


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
    nearest places), or two points. `power` 2 is least squares, 4 the objective of the source. With `tolerance` (in the
    unit of the points) knots are added where the deviation is until no inlier is further away; notes say where noise
    stops it. `robust` finds outliers and leaves them out.

    Raises FitError where points are too few, not finite or all the same, or a choice is unknown. Source: the objective
    and its 'true distance by Newton' of the freeform NURBS blading paper, section 4.1, here with exact derivatives (a
    point is linear in the control points; at its nearest place the distance does not change with the parameter) and a
    trust region in place of finite differences.
    """
    given = checked_points(points, "a curve")
    _check_ends(ends)
    centre, extent = np.mean(given, axis=0), float(np.ptp(given, axis=0).max())
    scaled = (given - centre) / extent
    options = checked_options(
        weights=weights, power=power, robust=robust, tolerance=tolerance, extent=extent, progress=progress
    )
    if start is None:
        sites = sites_along(scaled, closed=closed)
        net = _through(scaled, sites, _empty(degree, control_points, knots, weights, scaled.shape[1], closed=closed))
    else:
        net = _net_of_curve(replace(start, control_points=(start.control_points - centre) / extent), closed=closed)
        sites = projected(net.shape, scaled, closed=closed).parameters[:, 0]
    held = None
    if not closed:
        outermost = np.array([np.argmin(sites), np.argmax(sites)])
        if isinstance(ends, str) and ends == "free":
            held = (outermost, net.knots[0][[0, -1]][:, None])
        else:
            pair = scaled[outermost] if isinstance(ends, str) else _ends(ends, centre, extent)
            inner = net.points[1:-1]
            net = replace(net, held="corners", points=np.concatenate([pair[:1], inner, pair[1:]]))
    target = NetTarget(points=scaled, weights=np.ones(len(scaled)), held=held)
    _check_numbers(net, scaled, weights_free=options.weights_free)
    found, notes = staged_match_within(net, target, options, _further_knots, warm=start is not None)
    if start is None and _systematic(found, target):
        # a stiff first curve cuts the corners of a bent one; a soft one from the same start ends elsewhere
        other = staged_match_within(net, target, options, _further_knots, warm=True)
        found, notes = min((found, notes), other, key=lambda each: _cost(each[0], power, notes=each[1]))
    net = found.match.net
    shape = net.curve
    footpoints = projected(shape, scaled, closed=closed)
    footpoints = projected(shape, scaled, certified_parameters(shape, scaled, footpoints), closed=closed)
    if held is None:
        footpoints = nearer_projections(footpoints, found.match.footpoints, found.inliers)
    if found.rank < len(found.singular_values):
        notes += (
            (
                f"the points determine {found.rank} of {len(found.singular_values)} directions of the unknowns: "
                "the others bend the curve as little as they can"
            ),
        )
    return CurveFit(
        curve=replace(shape, control_points=shape.control_points * extent + centre),
        u=footpoints.parameters[:, 0],
        distances=footpoints.distances * extent,
        inliers=found.inliers,
        iterations=found.evaluations,
        converged=found.match.converged,
        singular_values=found.singular_values,
        rank=found.rank,
        noise=noise_along(footpoints.parameters[found.inliers, 0], (footpoints.points - scaled)[found.inliers])
        * extent,
        tolerance=tolerance,
        notes=notes,
    )


def noise_along(u: Reals, misses: Reals) -> float:
    """Standard deviation of a coordinate across a curve, by how misses (n, d) at parameters (n,) vary locally.

    Each is compared with the straight line between the one before and the one after it; what changes slowly along the
    curve cancels.
    """
    if len(u) < 3:
        return 0.0
    order = np.argsort(u, kind="stable")
    at, miss = u[order], misses[order]
    width = at[2:] - at[:-2]
    share = np.where(width > 0.0, (at[1:-1] - at[:-2]) / np.where(width > 0.0, width, 1.0), 0.5)
    off = miss[1:-1] - (1.0 - share)[:, None] * miss[:-2] - share[:, None] * miss[2:]
    square = np.sum(off**2, axis=-1) / (1.0 + share**2 + (1.0 - share) ** 2)
    return float(np.sqrt(np.mean(square) / (misses.shape[1] - 1)))


def _further_knots(match: StagedMatch, target: NetTarget, options: FitOptions, limit: float) -> tuple[Net | None, str]:
    """A knot in each span that is too far off for other reasons than noise, or why there is none."""
    extent = options.extent
    net, footpoints = match.match.net, match.match.footpoints
    u, distances = footpoints.parameters[:, 0], footpoints.distances
    misses = footpoints.points - target.points[match.inliers]
    codimension = misses.shape[1] - 1
    noise = noise_along(u, misses)
    ends = breaks(net.knots[0])
    knots: list[float] = []
    noisy = sparse = 0
    for low, high in pairwise(ends):
        here = (u >= low) & (u <= high)
        if not here.any() or distances[here].max() <= limit:
            continue
        if np.sqrt(np.mean(distances[here] ** 2) / codimension) <= NOISE_RATIO * noise:
            noisy += 1
            continue
        order = np.argsort(u[here])
        square = np.cumsum(distances[here][order] ** 2)
        middle = u[here][order][np.searchsorted(square, 0.5 * square[-1])]
        knot = float(np.clip(middle, low + 0.25 * (high - low), high - 0.25 * (high - low)))
        fewest = min(np.sum(u[here] < knot), np.sum(u[here] > knot))
        unknowns = len(match.singular_values) + len(knots) * (codimension + 2)
        if fewest < 2 or unknowns >= codimension * len(u):
            sparse += 1
        else:
            knots.append(knot)
    if knots:
        return net.refined(knots), ""
    worst = f"the largest distance is {distances.max() * extent:.3g} where {limit * extent:.3g} was asked for"
    if sparse and not noisy:
        return None, f"{worst}: the points are too few for further knots"
    return None, f"{worst}: noise of a standard deviation of about {noise * extent:.3g} stops further knots"


def _systematic(match: StagedMatch, target: NetTarget) -> bool:
    """Whether the distances are more than noise."""
    footpoints = match.match.footpoints
    noise = noise_along(footpoints.parameters[:, 0], footpoints.points - target.points[match.inliers])
    return float(np.sqrt(np.mean(footpoints.distances**2))) > SYSTEMATIC_RATIO * noise


def _cost(match: StagedMatch, power: float, notes: tuple[str, ...]) -> tuple[bool, int, float]:
    """What is less for a better match: within its tolerance, of fewer control points, at lower distances."""
    distances = match.match.footpoints.distances
    return bool(notes), len(match.match.net.points), float(np.mean((distances / 1e-3) ** power))


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
    elif knots is None:
        own = uniform_knots(count, degree)
    else:
        try:
            own = checked_knots(knots, degree, count, "knots")
        except GeometryError as error:
            raise FitError(f"the knots cannot carry a curve: {error}") from error
    log_weights = checked_logs(weights, (count,))
    return Net(
        knots=(own,), degrees=(degree,), points=np.zeros((count, dimension)), log_weights=log_weights, closed=closed
    )


def _through(points: Reals, sites: Reals, net: Net) -> Net:
    """The net nearest to points at sites (n,) in [0, 1], with a weak bending."""
    low, high = net.knots[0][[0, -1]]
    return net.through(points, (low + (high - low) * sites)[:, None], FIRST_STIFFNESS)


def _net_of_curve(curve: Curve, *, closed: bool) -> Net:
    net = Net(
        knots=(curve.knots,),
        degrees=(curve.degree,),
        points=np.array(curve.control_points),
        log_weights=None if curve.weights is None else np.log(curve.weights),
    )
    return periodic(net, curve) if closed else net


def _ends(ends: Any, centre: Reals, extent: float) -> Reals:
    try:
        pair = np.array(ends, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise FitError(f"ends {ends!r} were given: `fixed`, `free`, or the first and the last point") from error
    if pair.shape != (2, len(centre)) or not np.isfinite(pair).all():
        raise FitError(f"ends of shape {pair.shape} were given: two finite points of {len(centre)} coordinates")
    return np.asarray((pair - centre) / extent)


def _check_ends(ends: object) -> None:
    if isinstance(ends, str) and ends not in ("fixed", "free"):
        raise FitError(f"ends {ends!r} are unknown: `fixed`, `free`, or the first and the last point")


def _check_numbers(net: Net, points: Reals, *, weights_free: bool) -> None:
    unknowns = int(net.free.sum()) * points.shape[1] + (len(net.points) - 1 if weights_free else 0)
    rows = len(np.unique(points, axis=0)) * (points.shape[1] - 1)
    if unknowns > rows:
        raise FitError(
            f"{len(points)} points, which give {rows} distances, were to determine {unknowns} unknowns of a curve with "
            f"{len(net.points)} control points: take fewer control points, fixed weights, or more points"
        )
