"""NURBS surfaces fitted to scattered points in space."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal, final

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import ConvexHull, QhullError, cKDTree

from bladewright.errors import FitError, GeometryError
from bladewright.fitting.freeform.least_squares import Penalty
from bladewright.fitting.freeform.net import DIRECTIONS, Net, NetTarget, quadratic_of
from bladewright.fitting.freeform.options import FreeformFit, checked_logs, checked_options, checked_points
from bladewright.fitting.freeform.projection import nearer_projections, projected
from bladewright.fitting.freeform.stages import FitOptions, StagedMatch, staged_match_within
from bladewright.numerics.elementary import cross2
from bladewright.nurbs.basis import Reals, breaks, checked_knots, uniform_knots
from bladewright.nurbs.domain import extended, reparametrised
from bladewright.nurbs.surface import Surface

FIRST_STIFFNESS = 1e-6
"""weight of the bending of the first surface: enough to hold control points that no point is near."""
CONTINUED_SHARE = 0.05
"""length, of the domain, by which the surface is continued past its edges while it moves."""
SAME_END = 1e-10
"""difference of two ends, of the domain, that is rounding."""
NEIGHBOURS = 6
"""points with which one is compared to estimate noise"""
NOISE_RATIO = 1.25
"""root mean square of a strip's distances, of the noise, up to which they are noise."""
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
    parameters are those of the quadrilateral between four of them in their principal plane, u along its longer sides.
    For others give `start`, whose degrees, knots, control points and weights are then the first ones.

    `weights` are one, (n_u, n_v) given ones, or `free` ones, whose logarithms have no mean (and no trend along a
    direction without inner knots). `boundary` is `free`, or the `corners` are held at four of the points (at those of
    `start`), or all outer control points are `fixed` at those of `start`. Where the points leave control points open,
    or nearly so, the bending of the surface decides, with the largest weight that raises the root mean square by at
    most 0.2 %; `rank` says how many directions the points determine. With `tolerance` knots are added along u or v,
    whichever gains more for a control point, until no inlier is further away; notes say where noise stops it. The other
    arguments are those of `fit_curve`.

    Raises FitError where points are too few, not finite or on a line, or a choice is unknown. Source: as of
    `fit_curve`; the bending is the thin-plate energy (Duchon 1977) in the surface's parameters.
    """
    given = checked_points(points, "a surface", (3,))
    if boundary not in ("free", "corners", "fixed"):
        raise FitError(f"boundary {boundary!r} is unknown: `free`, `corners`, or `fixed` at that of `start`")
    if boundary == "fixed" and start is None:
        raise FitError("a fixed boundary was asked for without `start`: give the surface whose boundary is to stay")
    centre, extent = np.mean(given, axis=0), float(np.ptp(given, axis=0).max())
    scaled = (given - centre) / extent
    options = checked_options(
        weights=weights, power=power, robust=robust, tolerance=tolerance, extent=extent, progress=progress
    )
    options = replace(options, always_stiff=True)
    plane = _principal(scaled)
    if start is None:
        corners = _corners(plane)
        net = _through(scaled, _bilinear(plane, plane[corners]), _empty(degrees, control_points, knots, weights))
        if boundary == "corners":
            own = net.points.reshape(*net.counts, 3)
            own[[0, -1, -1, 0], [0, 0, -1, -1]] = scaled[corners]
            net = replace(net, points=own.reshape(-1, 3))
    else:
        net = _of_surface(replace(start, control_points=(start.control_points - centre) / extent))
    domain = net.surface.domain_u, net.surface.domain_v
    if boundary == "free":
        net = _of_surface(_widened(net.surface))
    net = replace(net, held=HELD_BY_BOUNDARY[boundary])
    _check_numbers(net, scaled, weights_free=options.weights_free)
    found, notes = staged_match_within(
        net, NetTarget(points=scaled, weights=np.ones(len(scaled))), options, _further_knots, warm=start is not None
    )
    shape, near = found.match.net.surface, found.match.footpoints.parameters
    if boundary == "free":
        shape, near = _cut(shape, near, domain)
    last = projected(shape, scaled[found.inliers], near)
    footpoints = nearer_projections(projected(shape, scaled), last, found.inliers)
    signed = np.sum((footpoints.points - scaled) * shape.normal(*footpoints.parameters.T), axis=-1)
    inliers = found.inliers
    if found.rank < len(found.singular_values):
        notes += (
            (
                f"the points determine {found.rank} of {len(found.singular_values)} directions of the unknowns: "
                "the others bend the surface as little as they can"
            ),
        )
    return SurfaceFit(
        surface=replace(shape, control_points=shape.control_points * extent + centre),
        u=footpoints.parameters[:, 0],
        v=footpoints.parameters[:, 1],
        distances=footpoints.distances * extent,
        inliers=inliers,
        iterations=found.evaluations,
        converged=found.match.converged,
        singular_values=found.singular_values,
        rank=found.rank,
        noise=_noise(footpoints.parameters[inliers], signed[inliers]) * extent,
        tolerance=tolerance,
        notes=notes,
    )


def _of_surface(surface: Surface) -> Net:
    return Net(
        knots=(surface.knots_u, surface.knots_v),
        degrees=(surface.degree_u, surface.degree_v),
        points=surface.control_points.reshape(-1, 3).copy(),
        log_weights=None if surface.weights is None else np.log(surface.weights).ravel(),
    )


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


def _cut(surface: Surface, parameters: Reals, domain: tuple[tuple[float, float], ...]) -> tuple[Surface, Reals]:
    """The surface over the range of its places, whose parameters keep their domain, and the places there."""
    mapped = parameters.copy()
    for k, direction in enumerate(DIRECTIONS):
        low, high = domain[k]
        size = high - low
        start, end = float(parameters[:, k].min()), float(parameters[:, k].max())
        start = low if (start - low) ** 2 <= (SAME_END * size) ** 2 else start
        end = high if (end - high) ** 2 <= (SAME_END * size) ** 2 else end
        if (start, end) != (surface.domain_u, surface.domain_v)[k]:
            surface = reparametrised(extended(surface, start, end, direction), low, high, direction)
        mapped[:, k] = np.clip(low + (parameters[:, k] - start) / (end - start) * size, low, high)
    return surface, mapped


def _principal(points: Reals) -> Reals:
    """Coordinates (n, 2) in the principal plane of points (n, 3)."""
    _, size, axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    if size[1] <= ON_A_LINE * size[0]:
        raise FitError(f"the {len(points)} points lie on a line: a surface needs points beside it")
    return np.asarray(points @ axes[:2].T)


def _corners(plane: Reals) -> list[int]:
    """Indices of four points of (n, 2) that span the largest quadrilateral, around it, the longer sides first."""
    try:
        hull = ConvexHull(plane).vertices
    except QhullError as error:  # pragma: no cover - points on a line are refused before
        raise FitError("the points do not span a surface in their principal plane; give `start`") from error
    if len(hull) > 200:
        hull = hull[np.linspace(0, len(hull), 200, endpoint=False).astype(int)]
    if len(hull) < 4:
        raise FitError(f"the outline of the {len(plane)} points has {len(hull)} corners, not four; give `start`")
    at = plane[hull]
    # the largest triangles on both sides of a diagonal make the largest quadrilateral with it
    best, chosen = -1.0, (0, 1, 2, 3)
    for i in range(len(at) - 2):
        for k in range(i + 2, len(at)):
            area = cross2(at[k] - at[i], at - at[i])
            j, m = int(np.argmin(area)), int(np.argmax(area))
            if area[m] - area[j] > best and area[m] > 0.0 > area[j]:
                best, chosen = float(area[m] - area[j]), (i, j, k, m)
    corners = list(hull[list(chosen)])
    sides = [float(np.sum((plane[a] - plane[b]) ** 2)) for a, b in zip(corners, np.roll(corners, -1), strict=True)]
    return corners if sides[0] + sides[2] >= sides[1] + sides[3] else [*corners[1:], corners[0]]


def _bilinear(plane: Reals, corners: Reals) -> Reals:
    """Parameters (n, 2) in [0, 1] of points of a plane in the quadrilateral of corners (4, 2), by Newton's method."""
    found = np.full((len(plane), 2), 0.5)
    a, b, d, c = corners
    twist = a - b - c + d
    for _ in range(20):
        u, v = found[:, :1], found[:, 1:]
        miss = a + u * (b - a) + v * (c - a) + u * v * twist - plane
        by_u, by_v = (b - a) + v * twist, (c - a) + u * twist
        determinant = cross2(by_u, by_v)
        determinant = np.where(determinant**2 > 1e-20, determinant, 1e-10)
        step = np.stack([cross2(miss, by_v), cross2(by_u, miss)], axis=-1) / determinant[:, None]
        found = np.clip(found - step, -0.2, 1.2)
    low, high = np.minimum(found.min(axis=0), 0.0), np.maximum(found.max(axis=0), 1.0)
    return np.asarray((found - low) / (high - low))


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
    log_weights = checked_logs(weights, (counts[0], counts[1]))
    return Net(knots=own, degrees=degrees, points=np.zeros((counts[0] * counts[1], 3)), log_weights=log_weights)


def _through(points: Reals, parameters: Reals, net: Net) -> Net:
    low = np.array([knots[0] for knots in net.knots])
    high = np.array([knots[-1] for knots in net.knots])
    return net.through(points, low + (high - low) * parameters, FIRST_STIFFNESS)


def _check_numbers(net: Net, points: Reals, *, weights_free: bool) -> None:
    unknowns = int(net.free.sum()) + (len(net.points) - 1 if weights_free else 0)
    if unknowns > len(np.unique(points, axis=0)):
        raise FitError(
            f"{len(points)} points were to determine a surface with {net.counts[0]} x {net.counts[1]} control points"
            f"{' and free weights' if weights_free else ''}: {unknowns} different ones are needed at least; "
            "take fewer control points, fixed weights, or more points"
        )


def _noise(parameters: Reals, signed: Reals) -> float:
    """Standard deviation by which signed distances (n,) differ from the mean of those of their neighbours."""
    count = min(NEIGHBOURS, len(signed) - 1)
    if count < 2:
        return 0.0
    _, near = cKDTree(parameters).query(parameters, k=count + 1)
    difference = signed - signed[near[:, 1:]].mean(axis=1)
    return float(np.sqrt(np.mean(difference**2) / (1.0 + 1.0 / count)))


def _further_knots(match: StagedMatch, target: NetTarget, options: FitOptions, limit: float) -> tuple[Net | None, str]:
    """Further knots in strips too far off for other reasons than noise, along the direction that gains more."""
    net, footpoints = match.match.net, match.match.footpoints
    points = target.points[match.inliers]
    shape = net.surface
    signed = np.sum((footpoints.points - points) * shape.normal(*footpoints.parameters.T), axis=-1)
    noise = _noise(footpoints.parameters, signed)
    best: tuple[float, Net | None] = (0.0, None)
    sparse = False
    for direction in range(2):
        knots = []
        at = footpoints.parameters[:, direction]
        for low, high in pairwise(breaks(net.knots[direction])):
            inside = (at >= low) & (at <= high)
            worst = footpoints.distances[inside].max(initial=0.0)
            if worst <= limit or (
                worst <= 4.0 * noise and np.sqrt(np.mean(footpoints.distances[inside] ** 2)) <= NOISE_RATIO * noise
            ):
                continue
            order = np.argsort(at[inside])
            square = np.cumsum(footpoints.distances[inside][order] ** 2)
            middle = at[inside][order][np.searchsorted(square, 0.5 * square[-1])]
            knots.append(float(np.clip(middle, low + 0.25 * (high - low), high - 0.25 * (high - low))))
        if not knots:
            continue
        more = net.refined(knots, direction)
        if len(more.points) > len(points) // 2:
            sparse = True
            continue
        chosen = NetTarget(points=points, weights=target.weights[match.inliers])
        quadratic = quadratic_of(more, chosen, footpoints, Penalty())
        damping = 1e-9 * np.trace(quadratic.curvature) / len(quadratic.gradient) * np.eye(len(quadratic.gradient))
        gain = float(quadratic.gradient @ np.linalg.solve(quadratic.curvature + damping, quadratic.gradient))
        rate = gain / (len(more.points) - len(net.points))
        if rate > best[0]:
            best = (rate, more)
    if best[1] is not None:
        return best[1], ""
    largest = footpoints.distances.max() * options.extent
    far = f"the largest distance is {largest:.3g} where {limit * options.extent:.3g} was asked for"
    if sparse:
        return None, f"{far}: the points are too few for further knots"
    return None, f"{far}: noise of a standard deviation of about {noise * options.extent:.3g} stops further knots"
