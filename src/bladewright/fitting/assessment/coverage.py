"""What a cloud shows of a blade: its sides between the points, ends without a row, bare and cut edges."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.special import fdtri, ndtri

from bladewright.fitting.assessment.estimates import ParameterEstimates
from bladewright.fitting.free_parameters import parameters_of_curve
from bladewright.fitting.matching.blade_ends import END_PARAMETERS
from bladewright.fitting.matching.footpoints import Footpoints, Side, footpoints_at
from bladewright.fitting.matching.noise import EXACT
from bladewright.fitting.matching.search import Match
from bladewright.numerics.robust import DEVIATION_OVER_MEDIAN
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve

ROW_SPREAD_OF_NOISE = 2.0
"""spread of the points at an end, of the cloud's noise, from which they stand in no row: a noisy row is a row all the
same."""
WIDTH_OVER_SPREAD = 4.0 / DEVIATION_OVER_MEDIAN
"""width of evenly scattered values over the deviation that the median of their distances from the middle tells"""
EDGE_PARAMETERS = {"leading edge": 0.0, "trailing edge": 1.0}
"""u of the two edges"""
SPAN_PARTS = 5
"""parts of the span in each of which both sides are looked at"""
COVERED_SHARE = 0.5
"""share of these parts that must have a point on the edge's arc; below it the edge is uncovered."""
THICKNESS_SAMPLES = 25
"""places along a section among which it is thickest: half and twice change nothing (design/matching_constants.md)"""
REACH = 8.0
"""how far from the end of an edge points are compared, in its radii: a face as wide as the edge and as much of both
sides, which are straight so far [-]; half and twice change nothing measured (design/matching_constants.md)."""
INSIDE = 0.05
"""distance from an edge, in u, at which the sides show the direction across it [-]; half and twice change nothing
measured (design/matching_constants.md)."""
SHARES = (0.9, 0.5, 0.1)
"""widths from which a face and an arc are fitted, of the half height of their points: half and twice change nothing
measured (design/matching_constants.md)."""
PLACES = {2: (41, 1), 3: (21, 11)}
"""places along each side, closer at the edges, and along the span at which it is asked how well the shape is known, by
dimension; they bound the time"""
NORMAL_95 = float(ndtri(0.975))
"""standard deviations to either side within which 95 % of normal errors are [-]"""
CONFIDENCE = 0.999
"""with which points are nearer to a face than to a round edge: by the ratio of their variances (Fisher 1925) [-]"""


def loose_ends(match: Match) -> dict[str, float]:
    """The ends of a blade that no row of points shows, and how far past the outermost points they may be [m].

    Empty for sections, and where the walls are held. The sides of a blade that goes on a little further are the same,
    so that without a row only its outermost points tell where it ends. Of m values that are scattered evenly the
    outermost is 1 / m of their width from the end on average, and each of the k free parameters of a wall has 1 / k of
    the points beside it. Reference: David and Nagaraja 2003, section 2.5 (order statistics of even values).
    """
    if match.state.shape.exact is None:
        return {}
    chord, walls = match.model.chord, match.ends.walls
    loose = {}
    for name in END_PARAMETERS:
        wall = walls.get(name)
        free = parameters_of_curve(match.design, name) & {*match.problem.paths}
        if not free:
            continue
        # a curve with as many parameters as points meets any
        if wall is None or len(wall.places) <= len(free):
            loose[name] = chord
        elif wall.spread > max(EXACT * chord, ROW_SPREAD_OF_NOISE * match.noise_estimate.noise):
            loose[name] = WIDTH_OVER_SPREAD * wall.spread * len(free) / len(wall.places)
    return loose


def uncovered_edges(match: Match) -> dict[str, tuple[float, float]]:
    """Rounded edges without a point on their arc: the blade's width where the points end [m], and of its thickest.

    A point on the arc is nearer to its middle than the other side is, which no point before it is.
    """
    if not match.model.rounded:
        return {}
    footpoints, sides = match.state.footpoints, match.state.shape.sides
    uncovered = {}
    for name, end in EDGE_PARAMETERS.items():
        nearest = _nearest(footpoints, match.rows, end)
        if len(nearest) == 0 or not match.problem.cloud_residuals.overhang.looks_at(end):
            continue
        side, u, v = footpoints.side[nearest], footpoints.u[nearest], footpoints.v[nearest]
        near_end, tip, across = (
            _places(sides, *at) for at in ((side, u, v), (side, np.full(len(u), end), v), (1 - side, u, v))
        )
        width = np.sqrt(np.sum((near_end - across) ** 2, axis=-1))
        if np.mean(np.sqrt(np.sum((near_end - tip) ** 2, axis=-1)) <= width) < COVERED_SHARE:
            wide = float(np.median(width))
            uncovered[name] = wide, wide / _thickness(sides, float(np.median(v)))
    return uncovered


def shape_bands(match: Match, statistics: ParameterEstimates) -> tuple[NDArray[np.intp], Reals, Reals, Reals]:
    """Sides, u and v (n,) of places all over a design, and half the 95 % intervals along the normals there [m].

    By the derivatives of places by the free parameters, and these parameters' covariance. Reference: Bates and Watts
    1988, section 2.3.2 (inference bands for the expected response).
    """
    dimension = match.problem.cloud_residuals.points.shape[1]
    along, across = PLACES[dimension]
    places = [0, 1], (1.0 - np.cos(np.linspace(0.0, np.pi, along))) / 2.0, np.linspace(0.0, 1.0, across)
    side, u, v = (each.ravel() for each in np.meshgrid(*places, indexing="ij"))
    at = footpoints_at(np.zeros((len(u), dimension)), match.state.shape.sides, side, u, v)
    slopes = match.model.along(match.state.shape, at, at.normals, match.problem.paths)
    variances = np.einsum("nk,nk->n", slopes @ statistics.covariance, slopes)
    return side, u, v, NORMAL_95 * np.sqrt(np.maximum(variances, 0.0))


def bare_places(match: Match, side: NDArray[np.intp], u: Reals, v: Reals) -> NDArray[np.bool_]:
    """Whether places (n,) are further along a side than all points of their part of the span, outliers too."""
    feet = match.state.footpoints
    return _past_points(feet.side, feet.v, feet.u, side, v, u)


def bare_at_ends(match: Match, side: NDArray[np.intp], u: Reals, v: Reals) -> NDArray[np.bool_]:
    """Whether places (n,) are nearer to an end of the blade than all points of their part of the chord."""
    feet = match.state.footpoints
    return _past_points(feet.side, feet.u, feet.v, side, u, v)


def _past_points(
    own_side: NDArray[np.intp], own_part: Reals, own: Reals, side: NDArray[np.intp], part: Reals, at: Reals
) -> NDArray[np.bool_]:
    """Whether places (n,) lie past all points (m,) of the same side and of the same of `SPAN_PARTS` equal parts."""
    rows, places = (each * SPAN_PARTS + _part_of_span(along) for each, along in ((own_side, own_part), (side, part)))
    low, high = (np.full(2 * SPAN_PARTS, end) for end in (np.inf, -np.inf))
    np.minimum.at(low, rows, own)
    np.maximum.at(high, rows, own)
    return np.asarray((at < low[places]) | (at > high[places]))


def least_thickness(match: Match) -> float:
    """The least over the span of the sections' largest thickness [m]; infinite for families with other edges."""
    if not match.model.rounded:
        return np.inf
    return min(_thickness(match.state.shape.sides, v) for v in (0.1, 0.3, 0.5, 0.7, 0.9))


def _nearest(footpoints: Footpoints, rows: NDArray[np.bool_], end: float) -> NDArray[np.intp]:
    """For each side and part of the span the point that is nearest to an edge."""
    away = np.where(rows, np.abs(footpoints.u - end), np.inf)
    part = _part_of_span(footpoints.v) + SPAN_PARTS * footpoints.side
    found = [np.flatnonzero(part == each)[np.argmin(away[part == each])] for each in np.unique(part)]
    return np.array([each for each in found if np.isfinite(away[each])], dtype=np.intp)


def _part_of_span(v: Reals) -> NDArray[np.intp]:
    return np.minimum((SPAN_PARTS * v).astype(np.intp), SPAN_PARTS - 1)


def _thickness(sides: tuple[Side, ...], v: float) -> float:
    u = np.linspace(0.0, 1.0, THICKNESS_SAMPLES)
    upper, lower = (
        _places(sides, np.full(THICKNESS_SAMPLES, side), u, np.full(THICKNESS_SAMPLES, v)) for side in (0, 1)
    )
    return float(np.sqrt(np.max(np.sum((upper - lower) ** 2, axis=-1))))


def _places(sides: tuple[Side, ...], side: NDArray[np.intp], u: Reals, v: Reals) -> Reals:
    none = np.zeros((len(u), np.real(sides[0].control_points).shape[-1]))
    return footpoints_at(none, sides, side, u, v).points


def foreign_edges(match: Match) -> dict[str, float]:
    """Edges of designs with round ones where points lie on a straight face, or on two straight sides: its width [m].

    A face and both sides beside it are fitted to the points about the edge, across and along the camber line there. It
    is taken for the cloud's where it leaves clearly less of the distances than the design, and than an arc and its
    tangents that are fitted in the same way.
    """
    if not match.model.rounded:
        return {}
    points, feet = match.problem.cloud_residuals.points[match.rows], match.state.footpoints.part(match.rows)
    found = {}
    for name, end in EDGE_PARAMETERS.items():
        side, at_end = np.zeros(len(points), dtype=np.intp), np.full(len(points), end)
        edge = footpoints_at(points, match.state.shape.sides, side, at_end, feet.v)
        inside = np.abs(at_end - INSIDE)
        upper, lower = (footpoints_at(points, match.state.shape.sides, side + k, inside, feet.v) for k in (0, 1))
        across = upper.points - lower.points
        across -= np.sum(across * edge.normals, axis=-1)[:, None] * edge.normals
        across /= np.sqrt(np.sum(across**2, axis=-1))[:, None]
        along, height = (np.sum(edge.miss * each, axis=-1) for each in (edge.normals, across))
        radius = _radius(match.state.shape.sides[0], end, float(np.median(feet.v)))
        rows = np.flatnonzero((along > -REACH * radius) & (np.abs(feet.u - end) < 0.5))
        # place, half width and turn of a face, and the slopes of both sides; place and radius of an arc, and these
        unknowns, round_unknowns = 6, 5
        if len(rows) <= 2 * unknowns:
            continue
        width, left = _face(along[rows], height[rows])
        own, arc = float(np.sum(feet.distances[rows] ** 2)), _arc(along[rows], height[rows])
        free = len(rows) - unknowns
        others = (own, len(rows)), (arc, len(rows) - round_unknowns)
        if all(other / count * free > fdtri(count, free, CONFIDENCE) * left for other, count in others):
            found[name] = width
    return found


def _radius(side: Side, end: float, v: float) -> float:
    """The radius of curvature along a section at an edge [m]."""
    at = np.array([end])
    if isinstance(side, Curve):
        first, second = (np.asarray(side.derivative(at, order))[0] for order in (1, 2))
    else:
        first, second = (np.asarray(side.derivative(at, np.array([v]), order, 0))[0] for order in (1, 2))
    speed = float(first @ first)
    bend = speed * float(second @ second) - float(first @ second) ** 2
    return speed**1.5 / max(float(np.sqrt(max(bend, 0.0))), 1e-300)


def _face(along: Reals, height: Reals) -> tuple[float, float]:
    """Width of the face that with two straight sides is nearest to points (n,), and the sum of squared distances."""

    def distances(unknowns: Reals) -> Reals:
        end, middle, half, turn, *slopes = unknowns
        cosine, sine = np.cos(turn), np.sin(turn)
        behind, off = end - cosine * along - sine * height, cosine * height - sine * along - middle
        found = [np.hypot(behind, np.maximum(np.abs(off) - half, 0.0))]
        for sign, slope in zip((1.0, -1.0), slopes, strict=True):
            above = sign * off - half
            way = np.maximum((behind + slope * above) / (1.0 + slope**2), 0.0)
            found.append(np.hypot(behind - way, above - slope * way))
        return np.asarray(np.min(found, axis=0))

    fits = [_least(distances, along, height, (share, 0.0, 0.1, 0.1), (0.8, 1.0, 1.0)) for share in SHARES]
    best = min(fits, key=lambda each: float(each.cost))
    return 2.0 * float(best.x[2]), 2.0 * float(best.cost)


def _arc(along: Reals, height: Reals) -> float:
    """The sum of squared distances of points (n,) from the arc with two tangents that is nearest to them."""

    def distances(unknowns: Reals) -> Reals:
        end, middle, radius, *angles = unknowns
        ahead, off = along - end + radius, height - middle
        angle = np.where(off > 0.0, *angles)
        behind = np.abs(off) * np.sin(angle) - ahead * np.cos(angle)
        above = ahead * np.sin(angle) + np.abs(off) * np.cos(angle)
        return np.asarray(np.where(behind < 0.0, np.hypot(ahead, off), above) - radius)

    fits = [_least(distances, along, height, (share, 0.1, 0.1), (1.0, 1.0)) for share in SHARES]
    return 2.0 * min(float(each.cost) for each in fits)


def _least(
    distances: Callable[[Reals], Reals], along: Reals, height: Reals, first: Sequence[float], most: Sequence[float]
) -> Any:
    """The end, middle, width and more of a shape nearest to points (n,), from a first share of their height."""
    wide = 0.5 * float(np.ptp(height))
    scale, high = np.array([wide] * 3 + [1.0] * len(most)), np.array([np.inf] * 3 + list(most))
    low = np.where(np.arange(len(high)) == 2, 0.0, -high)
    start = [float(np.max(along)), float(np.mean(height)), first[0] * wide, *first[1:]]
    return least_squares(distances, start, bounds=(low, high), x_scale=scale)
