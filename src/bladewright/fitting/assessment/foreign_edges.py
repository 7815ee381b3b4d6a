"""Blunt and sharp edges of a cloud whose design has round ones."""

import numpy as np
from scipy.optimize import least_squares
from scipy.special import fdtri

from bladewright.fitting.assessment.coverage import EDGE_PARAMETERS
from bladewright.fitting.matching.footpoints import Side, footpoints_at
from bladewright.fitting.matching.search import Match
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve

REACH = 8.0
"""how far from the end of an edge points are compared, in its radii: a face as wide as the edge and as much of both
sides, which are straight so far [-]"""
INSIDE = 0.05
"""distance from an edge, in u, at which the sides show the direction across it [-]"""
UNKNOWNS, ROUND_UNKNOWNS = 6, 5
"""place, half width and turn of a face, and the slopes of both sides; place and radius of an arc, and these slopes"""
CONFIDENCE = 0.999
"""with which points are nearer to a face than to a round edge: by the ratio of their variances (Fisher 1925) [-]"""


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
        if len(rows) <= 2 * UNKNOWNS:
            continue
        width, left = _face(along[rows], height[rows])
        own, arc = float(np.sum(feet.distances[rows] ** 2)), _arc(along[rows], height[rows])
        free = len(rows) - UNKNOWNS
        others = (own, len(rows)), (arc, len(rows) - ROUND_UNKNOWNS)
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
    wide = 0.5 * float(np.ptp(height))

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

    scale, most = np.array([wide, wide, wide, 1.0, 1.0, 1.0]), np.array([np.inf, np.inf, np.inf, 0.8, 1.0, 1.0])
    low = np.where(np.arange(UNKNOWNS) == 2, 0.0, -most)
    starts = [(float(np.max(along)), float(np.mean(height)), share * wide, 0.0, 0.1, 0.1) for share in (0.9, 0.5, 0.1)]
    fits = [least_squares(distances, start, bounds=(low, most), x_scale=scale) for start in starts]
    best = min(fits, key=lambda each: float(each.cost))
    return 2.0 * float(best.x[2]), 2.0 * float(best.cost)


def _arc(along: Reals, height: Reals) -> float:
    """The sum of squared distances of points (n,) from the arc with two tangents that is nearest to them."""
    wide = 0.5 * float(np.ptp(height))

    def distances(unknowns: Reals) -> Reals:
        end, middle, radius, *angles = unknowns
        ahead, off = along - end + radius, height - middle
        angle = np.where(off > 0.0, *angles)
        behind = np.abs(off) * np.sin(angle) - ahead * np.cos(angle)
        above = ahead * np.sin(angle) + np.abs(off) * np.cos(angle)
        return np.asarray(np.where(behind < 0.0, np.hypot(ahead, off), above) - radius)

    scale, most = np.array([wide, wide, wide, 1.0, 1.0]), np.array([np.inf, np.inf, np.inf, 1.0, 1.0])
    low = np.where(np.arange(ROUND_UNKNOWNS) == 2, 0.0, -most)
    starts = [(float(np.max(along)), float(np.mean(height)), share * wide, 0.1, 0.1) for share in (0.9, 0.5, 0.1)]
    return 2.0 * min(float(least_squares(distances, each, bounds=(low, most), x_scale=scale).cost) for each in starts)
