"""What a cloud shows of a blade: its sides between the points, ends without a row, bare and cut edges."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.special import fdtri, ndtri

from bladewright.blade.native.cut_lines import in_meridian
from bladewright.fitting.assessment.measurement import shape_covariance
from bladewright.fitting.free_parameters import parameters_of_curve
from bladewright.fitting.matching.blade_ends import END_PARAMETERS, FACE_BAND, WallPoints
from bladewright.fitting.matching.footpoints import BETWEEN_EDGES, EDGE_PARAMETERS, Footpoints, footpoints_at, part_of
from bladewright.fitting.matching.noise import EXACT, SIGNIFICANCE
from bladewright.fitting.matching.search import Match
from bladewright.numerics.elementary import cumulative_length
from bladewright.numerics.robust import DEVIATION_OVER_MEDIAN
from bladewright.nurbs.basis import Reals

ROW_SPREAD_OF_NOISE = 2.0
"""spread of points at an end, of the cloud's noise, from which they stand in no row (design/matching_constants.md)"""
WIDTH_OVER_SPREAD = 4.0 / DEVIATION_OVER_MEDIAN
"""width of evenly scattered values over the deviation that the median of their distances from the middle tells"""
SIDES = ("upper", "lower")
"""names of the sides, by their number in footpoints"""
PARTS = 5
"""parts of the span, and of the chord, in each of which both sides are looked at (design/matching_constants.md)"""
COVERED_SHARE = 0.5
"""share of these parts that must have a point on the edge's arc, or it is uncovered (design/matching_constants.md)"""
BARE_SHARE, BARE_GAPS = 0.1, 5.0
"""gap between points, of the chord, and in usual gaps, from which a section is not shown there (design/matching.md)"""
FREE_GAP = 0.1
"""share of such a gap beside its middle without points: rows may run across the blade's lines (design/matching.md)"""
AT_EDGE = 0.01
"""share of such a gap within which an edge is at its end (design/matching_constants.md)"""
WAY_SAMPLES = 401
"""places along a side between which it is taken as straight, and where it is thickest (design/matching_constants.md)"""
REACH = 2.0
"""how far from the end of an edge points are compared, in widths of the blade at `INSIDE`: sides are straight so far;
with twice a blunt edge is not seen (tests/fitting/test_foreign_edges.py)"""
INSIDE = 0.05
"""distance from an edge, in u, at which the sides show width and direction across it (design/matching_constants.md)"""
SHARES = (0.9, 0.5, 0.1)
"""first widths of fitted faces and arcs, of the half height of their points (design/matching_constants.md)"""
PLACES = {2: (41, 1), 3: (21, 21)}
"""places along each side and the span, by dimension, where it is asked how well the shape is known: they bound time,
and but for the ends and the middle lie between even rows of points"""
CONFIDENCE = 0.95
"""probability with which bands and ends are as near as is said (Neyman 1937)"""
NORMAL_95 = float(ndtri((1.0 + CONFIDENCE) / 2.0))
"""standard deviations to either side within which 95 % of normal errors are"""


def loose_ends(match: Match, feet: Footpoints) -> dict[str, float]:
    """The ends of a blade that no row of points shows, and how well they are known [m] (95 %).

    Empty for sections, and where the walls are held. Sides of a blade that goes on are the same, so that its outermost
    points alone tell its end, which may lie as far past them as the largest gap between them is wide, or as the wall
    found does: to each free or undetermined parameter of a wall belongs its share of them. `feet` (n,) are the
    footpoints of all inliers, of which a match takes some.
    """
    exact = match.state.shape.exact
    if exact is None:
        return {}
    chord, walls = match.model.chord, match.ends.walls
    loose = {}
    for name, end in END_PARAMETERS.items():
        wall = walls.get(name)
        free = parameters_of_curve(match.design, name) & {*match.problem.paths, *match.held}
        if not free:
            continue
        # a curve with as many parameters as points meets any
        if wall is None or len(wall.places) <= len(free):
            loose[name] = chord
        elif wall.spread > max(EXACT * chord, ROW_SPREAD_OF_NOISE * match.noise_estimate.noise):
            count = len(wall.places) * len(feet.u) / np.count_nonzero(match.rows)
            gap = WIDTH_OVER_SPREAD * wall.spread * largest_gap(count, len(free))
            beside = feet.part(np.abs(feet.v - end) < FACE_BAND)
            places = in_meridian(beside.points + beside.miss, exact.mapping.revolved)
            t, _, above = WallPoints(name=name, places=places).located(exact)
            outermost = np.full(len(free), -np.inf)
            np.maximum.at(outermost, part_of(np.clip(t, 0.0, 1.0), len(free)), above if end else -above)
            short = -outermost[np.isfinite(outermost)]
            loose[name] = max(gap, float(np.max(short, initial=0.0)))
    return loose


def largest_gap(count: float, parts: int) -> float:
    """The largest gap past the outermost of evenly scattered values, of their width [-], that 95 % of clouds keep.

    Each of so many parts of a border has its share of the count of values; of m of them none lies in a gap g with the
    probability (1 - g)^m. Reference: David and Nagaraja 2003, section 2.1 (distribution of the outermost value).
    """
    return float(1.0 - (1.0 - CONFIDENCE ** (1.0 / parts)) ** (parts / count))


def uncovered_edges(match: Match) -> dict[str, tuple[float, float]]:
    """Rounded edges without a point on their arc: the blade's width where the points end [m], and of its thickest."""
    if not match.model.rounded:
        return {}
    footpoints, shape = match.state.footpoints, match.state.shape
    part = part_of(footpoints.v, PARTS, footpoints.side)
    uncovered = {}
    for name, end in EDGE_PARAMETERS.items():
        away = np.where(match.rows, np.abs(footpoints.u - end), np.inf)
        order = np.argsort(away, kind="stable")
        nearest = order[np.unique(part[order], return_index=True)[1]]
        nearest = nearest[np.isfinite(away[nearest])]
        if len(nearest) == 0 or not match.problem.cloud_residuals.overhang.looks_at(end):
            continue
        side, u, v = footpoints.side[nearest], footpoints.u[nearest], footpoints.v[nearest]
        near_end, tip, across = (shape.places(*at) for at in ((side, u, v), (side, end, v), (1 - side, u, v)))
        width = np.sqrt(np.sum((near_end - across) ** 2, axis=-1))
        # a point on the arc is nearer to its middle than the other side is, which no point before it is
        if np.mean(np.sqrt(np.sum((near_end - tip) ** 2, axis=-1)) <= width) < COVERED_SHARE:
            wide = float(np.median(width))
            u = np.linspace(0.0, 1.0, WAY_SAMPLES)
            uncovered[name] = wide, wide / shape.thickness(u, float(np.median(v)))
    return uncovered


def bare_stretches(match: Match) -> list[tuple[float, str]]:
    """The largest gap between points around the sections [m], and where, in each part of the span with a long one.

    It is compared with the chord, with the usual gap, as half of a section's length lies in smaller ones, so that
    neither few points nor rows seem to leave some out, and with points of other parts of the span that rows lead to.
    """
    feet, shape = match.state.footpoints.part(match.rows), match.state.shape
    part, found = part_of(feet.v, PARTS), list[tuple[float, str]]()
    u = np.linspace(0.0, 1.0, WAY_SAMPLES)
    # from the leading edge along the upper side, and back along the lower one from 1 to 2
    around = np.concatenate([u, 1.0 + u[1:]])
    for number in np.unique(part):
        own = feet.part(part == number)
        v = float(np.mean(own.v))
        upper, lower = (cumulative_length(shape.places(side, u, v)) for side in (0, 1))
        tip, whole = upper[-1], upper[-1] + lower[-1]
        way = np.concatenate([upper, whole - lower[-2::-1]])
        ways = np.sort(np.interp(np.where(own.side == 0, own.u, 2.0 - own.u), around, way))
        gaps = np.diff(ways, append=ways[0] + whole)
        ordered, longest = np.sort(gaps), int(np.argmax(gaps))
        usual, gap = ordered[np.searchsorted(np.cumsum(ordered), 0.5 * whole)], float(gaps[longest])
        if gap <= max(BARE_SHARE * match.model.chord, BARE_GAPS * usual):
            continue
        ends = ways[longest] + gap * np.array([0.0, 0.5, 1.0])
        edges = (("leading edge", whole), ("trailing edge", tip))
        edge = next((name for name, at in edges if min(at - ends[0], ends[2] - at) > AT_EDGE * gap), None)
        places = np.interp(ends - whole * (ends[1] >= whole), way, around)
        side = int(places[1] > 1.0)
        first, middle, last = np.sort(np.clip(2.0 - places if side else places, 0.0, 1.0))
        beside = feet.points if edge else feet.points[feet.side == side]
        aside = beside - shape.places(side, middle, v)
        if np.min(np.sum(aside**2, axis=-1), initial=np.inf) < (FREE_GAP * gap) ** 2:
            continue
        if edge is None or match.problem.cloud_residuals.overhang.looks_at(EDGE_PARAMETERS[edge]):
            where = "" if feet.points.shape[1] == 2 else f", v = {v:.2g}"
            place = edge or f"{SIDES[side]} side from u = {first:.2f} to {last:.2f}"
            found.append((gap, f"{place}{where}"))
    return found


def shape_bands(match: Match) -> tuple[Footpoints, Reals]:
    """Places (n,) all over a design, and half the 95 % intervals along their normals [m], by parameters' covariance.

    Reference: Bates and Watts 1988, section 2.3.2 (inference bands for the expected response).
    """
    along, across = PLACES[match.problem.cloud_residuals.points.shape[1]]
    places = ((1.0 - np.cos(np.linspace(0.0, np.pi, count))) / 2.0 for count in (along, across))
    side, u, v = (each.ravel() for each in np.meshgrid([0, 1], *places, indexing="ij"))
    at = footpoints_at(None, match.state.shape.sides, side, u, v)
    paths, covariance = shape_covariance(match)
    slopes = match.model.along(match.state.shape, at, at.normals, paths)
    variances = np.einsum("nk,nk->n", slopes @ covariance, slopes)
    return at, NORMAL_95 * np.sqrt(np.maximum(variances, 0.0))


def bare_places(match: Match, places: Footpoints, known: NDArray[np.bool_]) -> dict[str, NDArray[np.bool_]]:
    """Which places (n,) at each edge and end are past all points of their side and part, where others are known."""
    feet, at_edge, found = match.state.footpoints, places.from_edges < BETWEEN_EDGES, {}
    borders = {name: (end, at_edge, places.u, places.v, feet.u, feet.v) for name, end in EDGE_PARAMETERS.items()}
    if match.state.shape.exact is not None:
        borders |= {name: (end, known, places.v, places.u, feet.v, feet.u) for name, end in END_PARAMETERS.items()}
    for name, (end, near, at, across, own, own_across) in borders.items():
        nearest, away = np.full(2 * PARTS, np.inf), np.abs(at - end)
        np.minimum.at(nearest, part_of(own_across, PARTS, feet.side), np.abs(own - end))
        past = away < np.minimum(nearest[part_of(across, PARTS, places.side)], 0.5)
        found[name] = past & near & np.any(known[away == 0.0])
    return found


def least_thickness(match: Match) -> float:
    """The least over the span of the sections' largest thickness [m]; infinite for families with other edges."""
    if not match.model.rounded:
        return np.inf
    u = np.linspace(0.0, 1.0, WAY_SAMPLES)
    return min(match.state.shape.thickness(u, v) for v in (0.1, 0.3, 0.5, 0.7, 0.9))


def foreign_edges(match: Match) -> dict[str, float]:
    """Edges of designs with round ones where points lie on a straight face, or on two straight sides: its width [m].

    A face and both sides beside it are fitted to the points about the edge. It is the cloud's where it leaves clearly
    less of the distances than the design, and than an arc and its tangents that are fitted in the same way.
    """
    if not match.model.rounded:
        return {}
    points, feet = match.problem.cloud_residuals.points[match.rows], match.state.footpoints.part(match.rows)
    shape, found = match.state.shape, {}
    for name, end in EDGE_PARAMETERS.items():
        edge = footpoints_at(points, shape.sides, 0, end, feet.v)
        inside = abs(end - INSIDE)
        across = shape.places(0, inside, feet.v) - shape.places(1, inside, feet.v)
        across -= np.sum(across * edge.normals, axis=-1)[:, None] * edge.normals
        wide = np.sqrt(np.sum(across**2, axis=-1))
        along, height = (np.sum(edge.miss * each, axis=-1) for each in (edge.normals, across / wide[:, None]))
        rows = np.flatnonzero((along > -REACH * wide) & (np.abs(feet.u - end) < 0.5))
        # place, half width and turn of a face, and the slopes of both sides; place and radius of an arc, and these
        unknowns, round_unknowns = 6, 5
        if len(rows) <= 2 * unknowns:
            continue
        width, left = _face(along[rows], height[rows])
        own, arc = float(np.sum(feet.distances[rows] ** 2)), _arc(along[rows], height[rows])
        free = len(rows) - unknowns
        others = (own, len(rows)), (arc, len(rows) - round_unknowns)
        if all(other / count * free > fdtri(count, free, 1.0 - SIGNIFICANCE) * left for other, count in others):
            found[name] = width
    return found


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

    found = _nearest(distances, along, height, (0.0, 0.1, 0.1), (0.8, 1.0, 1.0))
    return 2.0 * float(found.x[2]), 2.0 * float(found.cost)


def _arc(along: Reals, height: Reals) -> float:
    """The sum of squared distances of points (n,) from the arc with two tangents that is nearest to them."""

    def distances(unknowns: Reals) -> Reals:
        end, middle, radius, *angles = unknowns
        ahead, off = along - end + radius, height - middle
        angle = np.where(off > 0.0, *angles)
        behind = np.abs(off) * np.sin(angle) - ahead * np.cos(angle)
        above = ahead * np.sin(angle) + np.abs(off) * np.cos(angle)
        return np.asarray(np.where(behind < 0.0, np.hypot(ahead, off), above) - radius)

    return 2.0 * float(_nearest(distances, along, height, (0.1, 0.1), (1.0, 1.0)).cost)


def _nearest(
    distances: Callable[[Reals], Reals], along: Reals, height: Reals, first: Sequence[float], most: Sequence[float]
) -> Any:
    """The end, middle, width and more of a shape nearest to points (n,), from several first widths."""
    wide, high = 0.5 * float(np.ptp(height)), np.array([np.inf] * 3 + list(most))
    scale, low = np.array([wide] * 3 + [1.0] * len(most)), np.where(np.arange(len(high)) == 2, 0.0, -high)
    place = float(np.max(along)), float(np.mean(height))
    starts = ([*place, share * wide, *first] for share in SHARES)
    return min(
        (least_squares(distances, start, bounds=(low, high), x_scale=scale) for start in starts),
        key=lambda each: float(each.cost),
    )
