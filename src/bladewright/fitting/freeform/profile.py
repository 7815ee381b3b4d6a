"""Profiles fitted by a camber line and a half thickness around it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array
from scipy.spatial import ConvexHull, QhullError, cKDTree

from bladewright.errors import FitError
from bladewright.fitting.freeform.camber_thickness import CamberThickness, abscissae_of
from bladewright.fitting.freeform.curves import noise_along
from bladewright.fitting.freeform.least_squares import (
    Penalty,
    Quadratic,
    minimised,
    quadratic_of_distances,
    rank_of,
    singular_values,
)
from bladewright.fitting.freeform.net import WEIGHT_REGULARISATION, Net
from bladewright.fitting.freeform.options import FreeformFit, checked_options, checked_points
from bladewright.fitting.freeform.projection import Projections, newton_descent, with_frames
from bladewright.fitting.freeform.stages import FitOptions
from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.nurbs.curve import Curve
from bladewright.section.camber import turned_left

DEGREE = 3
SIDE_SAMPLES = 400
"""places of a side at which a search for the nearest one starts"""
STIFFNESSES = (1e-3, 1e-5, 1e-7, 1e-9)
"""weights of the bending of camber and thickness, in extents of the points squared, in turn"""
SIDE_TURNS = 6
"""times that points are assigned to the sides"""
CHORD_BINS = 40
"""parts of the chord by whose outermost points a first profile is drawn"""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class ProfileFit(FreeformFit):
    """A profile fitted to n points: a camber line, and a half thickness along its normals over the abscissa."""

    camber: Curve
    """B-spline in the plane of the points, leading to trailing edge"""
    thickness: Curve
    """NURBS of the abscissa and the half thickness there"""
    upper: NDArray[np.bool_]
    """(n,) whether a point belongs to the side towards larger ordinates"""
    t: Reals
    """(n,) parameters of the thickness at the nearest places"""

    def side(self, t: ArrayLike, *, upper: bool) -> Reals:
        """Points (m, 2) of a side at parameters t (m,) of the thickness, leading edge at 0."""
        found = CamberThickness(camber=self.camber, thickness=self.thickness)
        return found.derivatives(np.atleast_1d(np.asarray(t, dtype=np.float64)), upper=upper)[0]


def fit_profile(
    points: ArrayLike,
    *,
    camber: int = 6,
    thickness: int = 6,
    ends: Literal["fixed", "free"] | tuple[ArrayLike, ArrayLike] = "free",
    trailing_edge: Literal["blunt", "round"] = "blunt",
    power: float = 2.0,
    tolerance: float | None = None,
    progress: Callable[[str], None] | None = None,
) -> ProfileFit:
    """The profile of cubic camber and half thickness from whose sides the mean `power` of true distances is least.

    Points (n, 2), such as (m', theta), in any order, of both sides; the first coordinate is the abscissa, along which
    the camber runs. The sum of the means over both sides is least, which the fit tells apart itself. The camber is a
    B-spline of `camber` control points, the half thickness a NURBS of `thickness` control points with free weights:
    its first point lies on the camber's end and the second at the same abscissa, which makes the leading edge round;
    the third stands at 6.25 % of the abscissa, the others at equal steps after that, the last at the trailing edge. A
    `round` trailing edge is made like the leading edge, a `blunt` one is open. `ends` of the camber are `free`, or
    `fixed` where the points begin and end, or two points. `power` 4 is the source's objective. With a `tolerance`
    control points of either are added until no point lies further away.

    Raises FitError where points are too few, not finite or on a line, or a choice is unknown.
    Source: the freeform NURBS blading paper, sections 3.1 and 4.2 (its objective with power 4); the thickness is laid
    off along the camber's normals.
    """
    given = checked_points(points, "a profile", (2,))

    def fitted(camber: int, thickness: int) -> ProfileFit:
        _check(given, camber, thickness, ends, trailing_edge)
        extent = float(np.ptp(given, axis=0).max())
        options = checked_options(
            weights="free", power=power, robust=False, tolerance=tolerance, extent=extent, progress=progress
        )
        return _fitted(given, camber, thickness, ends, options, round_end=trailing_edge == "round", tolerance=tolerance)

    return fitted(camber, thickness) if tolerance is None else _within_tolerance(fitted, camber, thickness, tolerance)


def _fitted(
    given: Reals,
    camber: int,
    thickness: int,
    ends: str | tuple[ArrayLike, ArrayLike],
    options: FitOptions,
    *,
    round_end: bool,
    tolerance: float | None,
) -> ProfileFit:
    """The fit with so many control points."""
    centre, extent, power = np.mean(given, axis=0), options.extent, options.power
    scaled = (given - centre) / extent
    start, upper = _start(scaled, camber, thickness, round_end=round_end)
    if not isinstance(ends, str):
        pair = (np.array(ends, dtype=np.float64) - centre) / extent
        start = start.between(pair)
    fixed = not (isinstance(ends, str) and ends == "free")
    profile, evaluations, converged = start, 0, False
    search = ProfileObjective(points=scaled, upper=upper, fixed=fixed, penalty=Penalty(), stiffness=0.0, profile=start)
    for stiffness in (*STIFFNESSES, STIFFNESSES[-1]):
        options.report(f"stiffness {stiffness:g}")
        search = replace(search, stiffness=stiffness, profile=profile, upper=_upper(profile, scaled))
        found = minimised(search.objective, search.unknowns, evaluations=60, tolerance=1e-6)
        profile, converged = search.changed(found.x), found.converged
        evaluations += found.evaluations
    for _ in range(SIDE_TURNS):
        upper = _upper(profile, scaled)
        scale = float(search.footpoints(profile).distances.max())
        penalty = Penalty(power=power, scale=scale) if power != 2.0 else Penalty()
        search = replace(search, stiffness=1e-12, profile=profile, upper=upper, penalty=penalty)
        found = minimised(search.objective, search.unknowns, evaluations=100, tolerance=1e-8)
        profile, converged = search.changed(found.x), found.converged
        evaluations += found.evaluations
        if np.array_equal(_upper(profile, scaled), upper):
            break
    search = replace(search, profile=profile)
    footpoints = search.footpoints(profile)
    values = singular_values(search.of_distances(profile, footpoints).curvature)
    stretch = np.array([extent, extent])
    return ProfileFit(
        camber=replace(profile.camber, control_points=profile.camber.control_points * extent + centre),
        thickness=replace(
            profile.thickness, control_points=profile.thickness.control_points * stretch + np.array([centre[0], 0.0])
        ),
        upper=search.upper,
        t=footpoints.parameters[:, 0],
        distances=footpoints.distances * extent,
        inliers=np.ones(len(given), dtype=bool),
        iterations=evaluations,
        converged=converged,
        singular_values=values,
        rank=rank_of(values),
        noise=_noise(footpoints, scaled, search.upper) * extent,
        tolerance=tolerance,
        notes=(),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class ProfileObjective:
    """The objective of a profile, of its camber's control points, its heights and logarithms of weights."""

    points: Reals
    upper: NDArray[np.bool_]
    fixed: bool
    penalty: Penalty
    stiffness: float
    profile: CamberThickness

    @property
    def moving(self) -> NDArray[np.intp]:
        """Control points of the camber that move."""
        count = len(self.profile.camber.control_points)
        return np.arange(1, count - 1) if self.fixed else np.arange(count)

    @property
    def heights(self) -> NDArray[np.intp]:
        """Control points of the thickness whose height is free."""
        count = len(self.profile.thickness.control_points)
        return np.arange(1, count - 1) if self.profile.round_end else np.arange(1, count)

    @property
    def net(self) -> Net:
        """The thickness with unknown weights, for its gauge."""
        of = self.profile.thickness
        points = np.array(of.control_points)
        return Net(
            knots=(of.knots,), degrees=(DEGREE,), points=points, log_weights=np.log(self.profile.weights), weighted=True
        )

    @property
    def unknowns(self) -> Reals:
        camber = self.profile.camber.control_points[self.moving].ravel()
        return np.concatenate(
            [camber, self.profile.thickness.control_points[self.heights, 1], np.zeros(self.net.gauge.shape[1])]
        )

    def changed(self, unknowns: Reals) -> CamberThickness:
        """The profile with other values of its unknowns."""
        moved, free = 2 * len(self.moving), len(self.heights)
        camber = self.profile.camber.control_points.copy()
        camber[self.moving] = unknowns[:moved].reshape(-1, 2)
        net = self.profile.thickness.control_points.copy()
        net[self.heights, 1] = unknowns[moved : moved + free]
        log_weights = np.log(self.profile.weights) + self.net.gauge @ unknowns[moved + free :]
        weights = np.exp(np.clip(log_weights, -10.0, 10.0))
        found = replace(
            self.profile,
            camber=replace(self.profile.camber, control_points=camber),
            thickness=replace(self.profile.thickness, control_points=net, weights=weights),
        )
        return found if self.fixed else found.between(camber[[0, -1]])

    def footpoints(self, profile: CamberThickness) -> Projections:
        """The nearest places of the points on their sides."""
        t = np.zeros(len(self.points))
        grid = np.linspace(0.0, 1.0, SIDE_SAMPLES) ** 1.5
        for side in (True, False):
            rows = np.flatnonzero(self.upper == side)
            if len(rows):
                samples = profile.derivatives(grid, upper=side)[0]
                first = grid[cKDTree(samples).query(self.points[rows])[1]]
                t[rows] = newton_descent(partial(profile.derivatives, upper=side), self.points[rows], first, (0.0, 1.0))
        place, tangent, _ = profile.derivatives(t, upper=self.upper)
        # a side goes on as the other one past the leading edge
        free = (t > 0.0) & (t < 1.0)
        return with_frames(t[:, None], place, self.points, [tangent], free[:, None])

    def objective(self, unknowns: Reals) -> Quadratic:
        profile = self.changed(unknowns)
        return self.of_distances(profile, self.footpoints(profile)) + self._of_shape(profile, unknowns)

    def of_distances(self, profile: CamberThickness, footpoints: Projections) -> Quadratic:
        counts = np.where(self.upper, self.upper.sum(), (~self.upper).sum())
        t, of = footpoints.parameters[:, 0], footpoints.across_of
        return quadratic_of_distances(
            self.rows(profile, t, self.upper, footpoints.along),
            footpoints.distances,
            self.rows(profile, t[of], self.upper[of], footpoints.across),
            of,
            self.penalty,
            1.0 / counts,
        )

    def rows(self, profile: CamberThickness, t: Reals, upper: NDArray[np.bool_], directions: Reals) -> csr_array:
        """(m, n) derivatives by the unknowns of sides at t (m,), along directions (m, 2)."""
        thickness, camber, net = profile.thickness, profile.camber, replace(self, profile=profile).net
        ratio = net.basis(t[:, None]).toarray()
        x, h = thickness(t).T
        s = profile.sites(x)
        first, second = camber.derivatives(s, 2)[1:]
        size = length(first)[:, None]
        tangent, sign = first / size, np.where(upper, 1.0, -1.0)[:, None]
        normal = turned_left(tangent)
        # along the side's direction: the camber's point, the turn of its normal (-t . n') and the height itself
        lift = np.sum(directions * normal, axis=-1, keepdims=True) * sign
        turn = -np.sum(directions * tangent, axis=-1, keepdims=True) * sign * h[:, None] / size
        at, slope = basis(camber.knots, DEGREE, s), basis(camber.knots, DEGREE, s, 1)
        by_camber = at[:, :, None] * directions[:, None] + (slope * turn)[:, :, None] * normal[:, None]
        by_site = np.sum(first * directions, axis=-1, keepdims=True) + turn * np.sum(second * normal, axis=-1)[:, None]
        # the camber's parameter follows its own abscissa and that of the thickness
        by_abscissa = by_site / first[:, :1]
        by_camber[:, :, 0] -= at * by_abscissa
        by_control = ratio * by_abscissa
        log_weights = ratio * (thickness.control_points[:, 0] - x[:, None]) * by_abscissa
        log_weights += ratio * (thickness.control_points[:, 1] - h[:, None]) * lift
        if not self.fixed:
            low, high = camber.control_points[[0, -1], 0]
            share = (thickness.control_points[:, 0] - low) / (high - low)
            by_camber[:, 0, 0] += by_control @ (1.0 - share)
            by_camber[:, -1, 0] += by_control @ share
        columns = [
            by_camber[:, self.moving].reshape(len(t), 2 * len(self.moving)),
            (ratio * lift)[:, self.heights],
            log_weights @ net.gauge,
        ]
        return csr_array(np.concatenate(columns, axis=1))

    def _of_shape(self, profile: CamberThickness, unknowns: Reals) -> Quadratic:
        count, moved, free = len(unknowns), 2 * len(self.moving), len(self.heights)
        camber, thickness = profile.camber, profile.thickness
        value, gradient, curvature = 0.0, np.zeros(count), np.zeros((count, count))
        bending = Net(knots=(camber.knots,), degrees=(DEGREE,), points=np.array(camber.control_points)).bending
        pull = self.stiffness * bending @ camber.control_points
        value += float(np.sum(pull * camber.control_points))
        gradient[:moved] = pull[self.moving].ravel()
        curvature[:moved, :moved] = np.kron(self.stiffness * bending[np.ix_(self.moving, self.moving)], np.eye(2))
        net, rows = self.net, slice(moved, moved + free)
        pull = self.stiffness * net.bending @ thickness.control_points[:, 1]
        value += float(pull @ thickness.control_points[:, 1])
        gradient[rows] = pull[self.heights]
        curvature[rows, rows] = self.stiffness * net.bending[np.ix_(self.heights, self.heights)]
        own, cost = net.gauge.T @ np.log(profile.weights), WEIGHT_REGULARISATION**2 + 1e-2 * self.stiffness
        value += cost * float(own @ own)
        gradient[moved + free :] = cost * own
        curvature[moved + free :, moved + free :] = cost * np.eye(len(own))
        return Quadratic(value=value, gradient=gradient, curvature=curvature)


def _start(points: Reals, camber: int, thickness: int, *, round_end: bool) -> tuple[CamberThickness, NDArray[np.bool_]]:
    """A first profile: the middle between the outermost points across the longest chord, and a mean thickness."""
    try:
        hull = points[ConvexHull(points).vertices]
    except QhullError as error:
        raise FitError(f"the {len(points)} points lie on a line: a profile has two sides") from error
    apart = np.sum((hull[:, None] - hull) ** 2, axis=-1)
    a, b = hull[list(np.unravel_index(np.argmax(apart), apart.shape))]
    low, high = (a, b) if a[0] < b[0] else (b, a)
    chord = high - low
    size = float(length(chord))
    along, across = chord / size, turned_left(chord / size)
    xi, eta = (points - low) @ along / size, (points - low) @ across / size
    bins = np.clip((xi * CHORD_BINS).astype(int), 0, CHORD_BINS - 1)
    rows = [np.flatnonzero(bins == k) for k in range(CHORD_BINS)]
    known = [(np.mean(xi[r]), eta[r].min(), eta[r].max()) for r in rows if len(r) >= 2]
    at, bottom, top = np.array(known).T
    # the bins at the ends hold only the edges
    middle = np.polynomial.Polynomial.fit(at, 0.5 * (bottom + top), 4, domain=[0.0, 1.0], window=[0.0, 1.0])
    half = max(0.5 * float(np.median(top - bottom)), 1e-3) * size
    s = np.linspace(0.0, 1.0, 101)
    line = low + s[:, None] * chord + (middle(s) * size)[:, None] * across
    empty = Net(knots=(uniform_knots(camber, DEGREE),), degrees=(DEGREE,), points=np.zeros((camber, 2)))
    net = empty.through(line, s[:, None], 1e-8).points
    # an abscissa that turns back has no thickness over it
    net[:, 0] = (
        np.linspace(line[:, 0].min(), line[:, 0].max(), camber) if (np.diff(net[:, 0]) <= 0.0).any() else net[:, 0]
    )
    abscissae = abscissae_of(thickness, net[0, 0], net[-1, 0], round_end=round_end)
    heights = np.full(thickness, half)
    heights[0], heights[1] = 0.0, 0.6 * half
    heights[-1] = 0.0 if round_end else 0.3 * half
    profile = CamberThickness(
        camber=Curve(control_points=net, knots=uniform_knots(camber, DEGREE), degree=DEGREE),
        thickness=Curve(
            control_points=np.stack([abscissae, heights], axis=-1),
            knots=uniform_knots(thickness, DEGREE),
            degree=DEGREE,
            weights=np.ones(thickness),
        ),
        round_end=round_end,
    )
    return profile, eta > middle(np.clip(xi, 0.0, 1.0))


def _upper(profile: CamberThickness, points: Reals) -> NDArray[np.bool_]:
    """Which points lie above the camber, which is continued straight past its ends."""
    curve = profile.camber

    def derivatives(s: Reals) -> list[Reals]:
        return list(curve.derivatives(s, 2))

    grid = np.linspace(0.0, 1.0, SIDE_SAMPLES)
    first = grid[cKDTree(curve(grid)).query(points)[1]]
    s = newton_descent(derivatives, points, first, (0.0, 1.0))
    place, tangent = curve.derivatives(s, 1)
    return np.asarray(np.sum((points - place) * turned_left(tangent), axis=-1) > 0.0)


def _noise(footpoints: Projections, points: Reals, upper: NDArray[np.bool_]) -> float:
    squares = []
    for side in (True, False):
        rows = upper == side
        squares.append(
            rows.sum() * noise_along(footpoints.parameters[rows, 0], (footpoints.points - points)[rows]) ** 2
        )
    return float(np.sqrt(sum(squares) / len(points)))


def _check(points: Reals, camber: int, thickness: int, ends: object, trailing_edge: str) -> None:
    if trailing_edge not in ("blunt", "round"):
        raise FitError(f"trailing edge {trailing_edge!r} is unknown: `blunt` or `round`")
    if isinstance(ends, str) and ends not in ("fixed", "free"):
        raise FitError(f"ends {ends!r} are unknown: `fixed`, `free`, or the first and the last point of the camber")
    least = 6 if trailing_edge == "round" else 5
    if camber < DEGREE + 1 or thickness < least:
        raise FitError(
            f"{camber} control points of the camber and {thickness} of the thickness were asked for: at least "
            f"{DEGREE + 1} and {least} are needed"
        )
    unknowns = 2 * camber + 2 * thickness
    if len(points) < unknowns:
        raise FitError(
            f"{len(points)} points were to determine about {unknowns} unknowns of a profile: give more points"
        )


ADDED_COUNTS = ((1, 0), (0, 1), (1, 1))
"""control points of camber and thickness that are added at a time"""
MOST_GROWTHS = 8
"""times that control points are added at most; it bounds the time."""
NOISE_MAXIMUM = 3.0
"""standard deviations of the points' noise that the largest of many distances has by chance"""
WORTHWHILE_RATIO = 0.97
"""ratio of largest distances below which further control points are worthwhile."""


def _within_tolerance(
    fitted: Callable[[int, int], ProfileFit], camber: int, thickness: int, tolerance: float
) -> ProfileFit:
    """The fit that keeps a tolerance with few control points, or the nearest one, which says why it does not."""
    found = fitted(camber, thickness)
    evaluations = found.iterations
    reason = f"the tolerance is not reached after {MOST_GROWTHS} rounds of control points"
    for _ in range(MOST_GROWTHS):
        if found.maximum <= tolerance:
            break
        if found.maximum <= NOISE_MAXIMUM * found.noise:
            reason = "what is left is the noise of the points: more control points would follow it"
            break
        tried = []
        for more in ADDED_COUNTS:
            try:
                tried.append((more, fitted(camber + more[0], thickness + more[1])))
            except FitError as refusal:
                reason = str(refusal)
        evaluations += sum(each.iterations for _, each in tried)
        more, nearest = min(tried, key=lambda each: each[1].maximum, default=((0, 0), found))
        if nearest.maximum > WORTHWHILE_RATIO * found.maximum:
            reason = reason if not tried else "further control points bring the profile no nearer"
            break
        camber, thickness, found = camber + more[0], thickness + more[1], nearest
    notes = found.notes if found.maximum <= tolerance else (*found.notes, reason)
    return replace(found, iterations=evaluations, notes=notes)
