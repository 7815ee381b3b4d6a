"""Profiles fitted by a camber line and a half thickness along its normals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import block_diag
from scipy.spatial import QhullError, cKDTree

from bladewright.derivatives.complex_step import STEP
from bladewright.errors import FitError
from bladewright.fitting.checks import check_whole
from bladewright.fitting.freeform.fits import FreeformFit, Request
from bladewright.fitting.freeform.net import LAST_STEP, Net, net_of
from bladewright.fitting.freeform.search import Shape, ShapeMatch, matched_by_stages, matched_within, placed
from bladewright.fitting.initial_guess.slices import PlanePoints, longest_chord, slices_of
from bladewright.numerics.elementary import Array, length, turned_left
from bladewright.numerics.single_thread import single_threaded
from bladewright.nurbs.basis import Reals, uniform_knots
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.descent import descended
from bladewright.nurbs.refine import inserted

DEGREE = 3
"""degree of camber and thickness (the source's section 3.1)"""
THIRD_ABSCISSA = 0.0625
"""abscissa of the third control point of the thickness, of the chord (the source's section 4.2)"""
SITES = np.linspace(0.0, 1.0, 201)
"""parameters of a side where searches for nearest places start, and of the camber between which abscissae are sought"""


@dataclass(frozen=True, kw_only=True, eq=False)
class CamberThickness(Shape):
    """The profile of a camber (x, y) and a thickness (x, h), both over [0, 1]; its sides are exact, but no NURBS.

    Its unknowns are the camber's control points, the heights of the thickness, and the logarithms of its weights. A
    place's parameter is that of the thickness, negative on the lower side, so that the leading edge is at 0.
    """

    camber: Net
    thickness: Net
    """whose weights are unknown"""
    round_end: bool = False
    """whether the trailing edge is round as the leading edge is"""

    @property
    def heights(self) -> slice:
        """Control points of the thickness whose height is free."""
        return slice(1, -1) if self.round_end else slice(1, None)

    @property
    def unknowns(self) -> Reals:
        of = self.thickness
        return np.concatenate([self.camber.unknowns, of.points[self.heights, 1], of.gauge.T @ of.log_weights])

    def changed(self, unknowns: Array) -> CamberThickness:
        """The profile with other values of its unknowns, which may be complex."""
        of, moved = self.thickness, len(self.camber.unknowns)
        last = len(unknowns) - of.gauge.shape[1]
        camber, points = self.camber.changed(unknowns[:moved]), of.points.astype(unknowns.dtype)
        points[self.heights, 1] = unknowns[moved:last]
        points[:, 0] = abscissae_of(len(points), *camber.points[[0, -1], 0], round_end=self.round_end)
        return replace(
            self, camber=camber, thickness=replace(of, points=points, log_weights=of.gauge @ unknowns[last:])
        )

    def nearest(self, points: Reals, near: Reals | None = None) -> Reals:
        starts = [] if near is None else [near[:, 0]]
        if near is None:
            starts = [sign * SITES[cKDTree(self(sign * SITES)).query(points)[1]] for sign in (1.0, -1.0)]
        found = [descended(self._derivatives, points, start, (-1.0, 1.0), converged=LAST_STEP) for start in starts]
        best = np.argmin([square for _, square in found], axis=0)
        return np.stack([u for u, _ in found])[best, np.arange(len(points))][:, None]

    def _derivatives(self, u: Reals) -> tuple[Reals, Reals, Reals]:
        """The point and its first derivative; near the sides the second adds nothing to a step."""
        place = self(u + 1j * STEP)
        return place.real, place.imag / STEP, np.zeros_like(place.real)

    def tangents(self, parameters: Reals) -> tuple[Reals, Reals, NDArray[np.bool_]]:
        place, tangent, _ = self._derivatives(parameters[:, 0])
        return place, tangent[:, None], parameters**2 < 1.0

    def slopes(self, parameters: Reals, directions: Reals) -> Reals:
        u, at = parameters[:, 0], self.unknowns
        columns = [self.changed(at + 1j * STEP * each)(u).imag / STEP for each in np.eye(len(at))]
        return np.einsum("nmd,mrd->mrn", columns, directions).reshape(-1, len(at))

    @property
    def bending(self) -> tuple[Reals, Reals]:
        """As of a shape; the logarithms of the weights count too."""
        of, (bent, slopes) = self.thickness, self.camber.bending
        heights, logs = of.bending_root @ of.points[:, 1], of.gauge.T @ of.log_weights
        return np.concatenate([bent, heights, logs]), block_diag(
            slopes, of.bending_root[:, self.heights], np.eye(len(logs))
        )

    def __call__(self, u: Array) -> Array:
        """Points (n, 2) at parameters u (n,), which may be complex."""
        sign = np.where(np.real(u) < 0.0, -1.0, 1.0)
        x, h = self.thickness.shape(sign * u).T
        near: Array = np.interp(np.real(x), np.maximum.accumulate(np.real(self.camber.shape(SITES)[:, 0])), SITES)
        # to where the camber's abscissa is the same, from 1e-5: squared twice
        for _ in range(2):
            place, tangent = self.camber.shape.derivatives(near, 1)
            near = near + (x - place[:, 0]) / tangent[:, 0]
        place, tangent = self.camber.shape.derivatives(near, 1)
        return np.asarray(place + (sign * h / length(tangent))[:, None] * turned_left(tangent))


def abscissae_of(count: int, low: float, high: float, *, round_end: bool) -> Array:
    """Abscissae (count,) of the thickness's control points."""
    last = count - 2 if round_end else count - 1
    inner = np.linspace(THIRD_ABSCISSA, 1.0, last - 1)
    share = np.concatenate([[0.0, 0.0], inner, [1.0] if round_end else []])
    return np.asarray(low + share * (high - low))


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
        of = CamberThickness(camber=net_of(self.camber), thickness=net_of(self.thickness))
        return of(at if upper else -np.maximum(at, 1e-300))


@single_threaded
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
    request = Request("a profile", points, power, tolerance, progress, dimension=2)
    check_whole(camber=camber, thickness=thickness)
    pair, scaled = request.ends(ends), request.points
    if trailing_edge not in ("blunt", "round"):
        raise FitError(f"trailing edge {trailing_edge!r} is unknown: `blunt` or `round`")

    def fitted(camber: int, thickness: int) -> ShapeMatch[CamberThickness]:
        start = _start(scaled, camber, thickness, round_end=trailing_edge == "round")
        if pair is not None:
            moved = start.unknowns
            moved[:2], moved[2 * camber - 2 : 2 * camber] = pair
            start = start.changed(moved)
        match = placed(replace(start, camber=replace(start.camber, boundary="corners")), scaled)
        upper = match.parameters[:, 0] >= 0.0
        counts = np.where(upper, np.sum(upper), np.sum(~upper))
        match = matched_by_stages(replace(match, weights=0.5 * len(scaled) / counts), request)
        if pair is None and ends == "free":
            # last, because a blunt edge that stands out of its points costs nothing (design/freeform.md)
            loose = replace(match.shape, camber=replace(match.shape.camber, boundary="free"))
            match = matched_by_stages(replace(match, shape=loose), request, warm=True)
        return match

    def richer(match: ShapeMatch[CamberThickness], _: float) -> ShapeMatch[CamberThickness] | str:
        counts = len(match.shape.camber.points) + 1, len(match.shape.thickness.points) + 1
        if match.is_noise(match.inliers):
            return "the rest is the noise of the points"
        if len(scaled) < 2 * sum(counts):
            return "the points are too few for further control points"
        found = fitted(*counts)
        if found.largest >= match.largest:
            return "further control points bring the profile no nearer"
        return replace(found, evaluations=match.evaluations + found.evaluations)

    match, notes = matched_within(fitted(camber, thickness), request, richer)
    of, u = match.shape, match.parameters[:, 0]
    heights = of.thickness.points * request.extent + np.array([request.centre[0], 0.0])
    return ProfileFit(
        camber=request.restored(of.camber.shape),
        thickness=replace(of.thickness.shape, control_points=heights),
        upper=u >= 0.0,
        t=np.abs(u),
        **match.figures(request, *notes),
    )


def _start(points: Reals, camber: int, thickness: int, *, round_end: bool) -> CamberThickness:
    """A first profile: camber and thickness of the points in the frame of their longest chord."""
    least = 6 if round_end else 5
    if camber < DEGREE + 1 or thickness < least:
        raise FitError(
            f"{camber} control points of the camber and {thickness} of the thickness were asked for: at least "
            f"{DEGREE + 1} and {least} are needed"
        )
    if len(points) < 2 * camber + 2 * thickness:
        raise FitError(
            f"{len(points)} points were to determine about {2 * camber + 2 * thickness} unknowns of a profile: give "
            "more points"
        )
    try:
        direction = longest_chord(points)
    except QhullError as error:
        raise FitError(f"the {len(points)} points lie on a line: a profile has two sides") from error
    plane = PlanePoints(points=points, v=np.zeros(len(points)))
    found = slices_of(plane, np.array([direction]), np.zeros(1), 1)
    knots = uniform_knots(camber, DEGREE)
    line = inserted(Curve(control_points=found.camber[0], knots=uniform_knots(4, DEGREE), degree=DEGREE), knots[4:-4])
    low, high = found.camber[0, [0, 3], 0]
    knots, abscissae = uniform_knots(thickness, DEGREE), abscissae_of(thickness, low, high, round_end=round_end)
    heights = np.full(thickness, np.mean(found.half))
    heights[[0, -1] if round_end else [0]] = 0.0
    half_thickness = net_of(Curve(control_points=np.stack([abscissae, heights], -1), knots=knots, degree=DEGREE))
    return CamberThickness(camber=net_of(line), thickness=half_thickness.freed, round_end=round_end)
