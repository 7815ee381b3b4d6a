"""How far native sides are from the exact blade, and the knots that bring them within the tolerance."""

from typing import NamedTuple

import numpy as np

from bladewright.blade.exact.exact_blade import ExactBlade
from bladewright.blade.native.interpolation import lower_edges
from bladewright.blade.native.knots import DEGREE, MOST_POLES, Knots, clamped, refined, sites_through
from bladewright.numerics.elementary import dot, length
from bladewright.nurbs.basis import Reals, basis, greville
from bladewright.nurbs.surface import Surface
from bladewright.section.native import interpolated_along_u
from bladewright.section.outline import EdgeDerivatives

SECTIONS = 1e-9
"""distance of the sides' curves of constant v from the sections that are given, of the chord"""
SECTIONS_SHARE = 1e-3
"""the same as a share of the tolerance, where that is coarser"""
WALL_TOLERANCE = 1e-7
"""distance of the blade's ends from hub and shroud, of the chord"""
SAME = 1e-9
"""span fractions nearer than this are one"""
RESERVE = 0.4
"""share of a tolerance that one direction may use while knots are sought"""
SECTIONS_RESERVE = 0.8
"""the same of the limit of sections that are given"""


def mean_chord(exact: ExactBlade) -> float:
    """Mean straight distance from leading to trailing edge along the span [m]."""
    stations = exact.survey
    return float(np.mean(np.real(length(stations.trailing_edge().point - stations.leading_edge().point))))


def refined_knots(exact: ExactBlade, chord: float, *, slack: float = 1.0) -> Knots:
    """Knots with which the native sides meet the design's tolerance, and their ends lie on the walls.

    What is promised besides, of walls and of the edges' angles and radii, may be missed by `slack` times as much.
    """
    tolerance, spans = exact.design.tolerance * chord, exact.given_spans
    starts = clamped(exact.breaks_along_u()), exact.breaks_along_v()
    along_u = refined(starts[0], _LinesAlongU(exact, tolerance, chord, spans, slack), MOST_POLES[0])
    if len(spans) and len(along_u) - DEGREE - 1 > MOST_POLES[0]:
        spans = spans[:0]
        along_u = refined(starts[0], _LinesAlongU(exact, tolerance, chord, spans, slack), MOST_POLES[0])
    # a knot at each makes sure of a site nearby
    own = [v for v in spans if 0.0 < v < 1.0 and np.min(np.square(starts[1] - v), initial=1.0) > SAME**2]
    lines = _LinesAlongV(exact, tolerance, along_u, spans, slack)
    along_v = refined(clamped(np.concatenate([starts[1], own])), lines, MOST_POLES[1])
    return Knots(u=along_u, v=along_v, tip=exact.tip_knots, sections=spans if len(spans) else None)


def sections_limit(tolerance: float) -> float:
    """Largest distance of curves of constant v from the sections that are given, of the chord, by the tolerance."""
    return max(SECTIONS, SECTIONS_SHARE * tolerance)


class _LinesAlongU:
    """Error over tolerance along sections of the exact blade that are interpolated in u alone."""

    def __init__(self, exact: ExactBlade, tolerance: float, chord: float, spans: Reals, slack: float) -> None:
        v = np.union1d(exact.survey.v, spans)
        self.stations = exact.survey if len(v) == len(exact.survey.v) else exact.sections(v)
        # along v there is no error at these, so that most of their limit is left for u
        limit = min(SECTIONS_RESERVE * sections_limit(tolerance / chord) * chord, RESERVE * tolerance)
        self.tolerance = np.where(np.isin(v, spans), limit, RESERVE * tolerance)[:, None]
        self.wall_tolerance = RESERVE * min(slack * WALL_TOLERANCE * chord, tolerance)
        upper = self.stations.leading_edge(), self.stations.trailing_edge()
        self.edges = upper, lower_edges(upper, self.stations.lower_edges())

    def __call__(self, knots: Reals, places: Reals) -> Reals:
        sites = greville(knots, DEGREE)[3:-3]
        both = np.concatenate([sites, places])
        order = np.argsort(both)
        back = np.argsort(order)
        worst = np.zeros(len(places))
        sides = zip(*self.stations.points_and_normals(both[order]), strict=True)
        for side, edges in zip(sides, self.edges, strict=True):
            points, normals = side[0][:, back], side[1][:, back]
            lines = np.swapaxes(points[:, : len(sites)], 0, 1)
            net = interpolated_along_u(lines, *edges, knots)
            native = np.tensordot(basis(knots, DEGREE, places), net, axes=1).swapaxes(0, 1)
            error = native - points[:, len(sites) :]
            worst = np.maximum(worst, np.max(length(error) / self.tolerance, axis=0))
            off = dot(error, normals[:, len(sites) :])[[0, -1]]
            gap = np.max(np.abs(off), axis=0)  # real: knots come from the real design
            worst = np.maximum(worst, gap / self.wall_tolerance)
        return worst


class _LinesAlongV:
    """Error over tolerance along lines of constant u that are interpolated in v alone."""

    def __init__(self, exact: ExactBlade, tolerance: float, knots_u: Reals, through: Reals, slack: float) -> None:
        self.exact, self.through, self.slack = exact, through, slack
        self.tolerance = RESERVE * tolerance
        spans = np.unique(knots_u)
        step = max(1, (len(spans) - 1) // 24)
        self.s = np.concatenate([[0.0], (spans[:-1:step] + spans[1::step]) / 2.0, [1.0]])

    def __call__(self, knots: Reals, places: Reals) -> Reals:
        sites = sites_through(knots, self.through)
        both = np.concatenate([sites, places])
        stations = self.exact.sections(both)
        matrix = basis(knots, DEGREE, sites)
        errors = [np.zeros(len(places))]
        for points in stations.points(self.s):
            flat = points.reshape(len(both), -1)
            native = basis(knots, DEGREE, places) @ np.linalg.solve(matrix, flat[: len(sites)])
            miss = (native - flat[len(sites) :]).reshape(len(places), -1, 3)
            errors.append(np.max(length(miss), axis=1) / self.tolerance)
        rows = [stations.leading_edge(), stations.trailing_edge(), *stations.lower_edges()]
        errors += [self._edge_miss(row, matrix, knots, places) / self.slack for row in rows if row is not None]
        return np.max(errors, axis=0)

    @staticmethod
    def _edge_miss(row: EdgeDerivatives, matrix: Reals, knots: Reals, places: Reals) -> Reals:
        """Relative error of the edges' derivatives, which carry angle and radius, over what the promises allow."""
        count = len(matrix)
        at = basis(knots, DEGREE, places)
        result = np.zeros(len(places))
        for part, allowed in ((row.first, 5e-5), (row.second, 2e-4)):
            error = length(at @ np.linalg.solve(matrix, part[:count]) - part[count:])
            result = np.maximum(result, error / length(part[count:]) / allowed)
        return result


class ApproximationError(NamedTuple):
    """How far native sides are from the exact blade between their sites, at equal parameters."""

    distance: float
    """largest distance [m]"""
    off_walls: float
    """largest distance of the ends from hub and shroud [m]"""
    u: float
    """where the largest distance is"""
    v: float


def approximation_error(exact: ExactBlade, upper: Surface, lower: Surface) -> ApproximationError:
    """The distance of the sides from the exact blade: at equal parameters, so it bounds the true distance."""
    u, v = (_between(knots) for knots in (upper.knots_u, upper.knots_v))
    v = np.concatenate([[0.0], v, [1.0]])
    worst = ApproximationError(0.0, 0.0, 0.0, 0.0)
    for surface, points, normals in zip((upper, lower), *exact.sections(v).points_and_normals(u), strict=True):
        miss = np.real(surface.grid(u, v).swapaxes(0, 1) - points)
        distance = length(miss)
        i, j = np.unravel_index(int(np.argmax(distance)), distance.shape)
        ends = dot(miss, np.real(normals))[[0, -1]]
        off = max(worst.off_walls, float(np.max(np.abs(ends))))  # real: a measured distance
        if distance[i, j] > worst.distance:
            worst = ApproximationError(float(distance[i, j]), off, float(u[j]), float(v[i]))
        worst = worst._replace(off_walls=off)
    return worst


def _between(knots: Reals) -> Reals:
    spans = np.unique(knots)
    return np.sort(np.concatenate([spans[:-1] + share * np.diff(spans) for share in (0.31, 0.74)]))
