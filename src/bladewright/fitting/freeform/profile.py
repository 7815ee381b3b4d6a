"""Profiles fitted by a camber line and a half thickness around it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import ConvexHull, QhullError

from bladewright.errors import FitError
from bladewright.fitting.freeform.fits import (
    FreeformFit,
    checked_ends,
    checked_options,
    checked_points,
    figures_of,
    unit_of,
)
from bladewright.fitting.freeform.net import Net
from bladewright.fitting.freeform.profile_shape import DEGREE, CamberThickness, abscissae_of
from bladewright.fitting.freeform.search import Target, matched_by_stages
from bladewright.numerics.elementary import length, turned_left
from bladewright.nurbs.basis import Reals, uniform_knots
from bladewright.nurbs.curve import Curve

CHORD_BINS = 40
"""parts of the chord by whose outermost points a first profile is drawn"""


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
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
        at = np.atleast_1d(np.asarray(t, dtype=np.float64))
        # the smallest number below zero is the leading edge of the lower side
        return CamberThickness(camber=self.camber, thickness=self.thickness).along(
            at if upper else -np.maximum(at, 1e-300)
        )[0]


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
    unit = unit_of(given)
    pair, scaled = checked_ends(ends, unit), unit.scaled(given)
    options = checked_options(
        weights="fixed", power=power, robust=False, tolerance=tolerance, extent=unit.extent, progress=progress
    )

    def fitted(camber: int, thickness: int) -> ProfileFit:
        _check(given, camber, thickness, trailing_edge)
        start, upper = _start(scaled, camber, thickness, round_end=trailing_edge == "round")
        if pair is not None:
            moved = start.unknowns
            moved[:2], moved[2 * camber - 2 : 2 * camber] = pair
            start = start.changed(moved)
        free = isinstance(ends, str) and ends == "free"
        # a blunt edge that stands out of its points costs nothing, so that its end is freed last
        blunt = trailing_edge == "blunt"
        start = replace(start, fixed=blunt or not free)
        counts = np.where(upper, np.sum(upper), np.sum(~upper))
        target = Target(points=scaled, weights=0.5 * len(scaled) / counts)
        match, inliers = matched_by_stages(start, target, options)
        if blunt and free:
            match, inliers = matched_by_stages(replace(match.shape, fixed=False), target, options, warm=True)
        parameters, figures = figures_of(match, inliers, scaled, unit.extent)
        of = match.shape
        heights = of.thickness.control_points * unit.extent + np.array([unit.centre[0], 0.0])
        return ProfileFit(
            camber=replace(of.camber, control_points=unit.restored(of.camber.control_points)),
            thickness=replace(of.thickness, control_points=heights),
            upper=parameters[:, 0] >= 0.0,
            t=np.abs(parameters[:, 0]),
            tolerance=tolerance,
            **figures,
        )

    return fitted(camber, thickness) if tolerance is None else _within_tolerance(fitted, camber, thickness, tolerance)


def _start(points: Reals, camber: int, thickness: int, *, round_end: bool) -> tuple[CamberThickness, NDArray[np.bool_]]:
    """A first profile: the middle between the outermost points across the longest chord, and a mean thickness."""
    try:
        hull = points[ConvexHull(points).vertices]
    except QhullError as error:
        raise FitError(f"the {len(points)} points lie on a line: a profile has two sides") from error
    squares = np.sum((hull[:, None] - hull) ** 2, axis=-1)
    a, b = hull[list(np.unravel_index(np.argmax(squares), squares.shape))]
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
    # a camber whose abscissa turns back has no thickness over it
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


def _check(points: Reals, camber: int, thickness: int, trailing_edge: str) -> None:
    if trailing_edge not in ("blunt", "round"):
        raise FitError(f"trailing edge {trailing_edge!r} is unknown: `blunt` or `round`")
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
