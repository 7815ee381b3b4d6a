"""How far native sides are from the exact blade, and the knots that bring them within the tolerance."""

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from bladewright.blade.exact.exact_blade import ExactBlade
from bladewright.blade.native.interpolation import SideStack, lower_edges
from bladewright.blade.native.knots import DEGREE, MOST_POLES, Knots, clamped, refined, sites_through
from bladewright.numerics.elementary import Array, dot, length
from bladewright.nurbs.basis import Reals, basis, greville
from bladewright.nurbs.surface import Surface
from bladewright.section.native import interpolated_along_u
from bladewright.section.outline import EdgeDerivatives

SECTIONS = 1e-9
"""Largest distance of the sides' curves of constant v from the sections that a design gives [chords]. A
thousandth of the default tolerance, so that given sections count as exact; looser would save poles along u."""
SECTIONS_SHARE = 1e-3
"""The same limit as a share of the tolerance, where that is coarser: a rough blade need not pay for exact sections."""
WALL_TOLERANCE = 1e-7
"""Largest distance of the blade's ends from hub and shroud [chords], as `docs/nomenclature.md` promises: the sides are
to meet the end faces within what CAD takes for closed; tighter costs poles."""
FINE_WALLS = 1e-10
"""The same of fine blades [m]: OpenCASCADE's smallest tolerance, above which other programs call the edges of a file
inexact. It takes up to 1.7 times the poles along the chord (design/other_programs.md)."""
SAME_SPAN = 1e-9
"""Span fractions nearer than this are one: far above rounding, far below the distance of any two sections."""
RESERVE = 0.4
"""Share of a tolerance that the error along u, or along v, may use while knots are chosen: the two add up, and some is
left for places between those that are looked at."""
SECTIONS_RESERVE = 0.8
"""The same of the limit of given sections: along v they are interpolated, so nearly all of it is left for u."""
FIRST_ALLOWED, SECOND_ALLOWED = 5e-5, 2e-4
"""Largest relative errors along v of the edges' first and second derivatives by s. A first derivative off by so much
turns by 0.003 deg at most, where 0.01 deg are promised; a second one moves the radius by a fifth of its limit."""
FLAT = 1e-4
"""Second derivative of an edge, of its first, below which it is flat and has no radius to keep: as the ends of straight
faces are."""
MOST_LINES = 24
"""About how many lines of constant u are looked at for the knots along v: more cost time, fewer may pass over a place
that needs a knot; the error of the built sides is measured on other lines."""
BETWEEN_KNOTS = (0.31, 0.74)
"""Places in a knot span at which the error of the built sides is measured: other ones than knots are chosen by."""


class RefinedStack(SideStack, Protocol):
    """Curves of constant v that tell how far sides are off the walls of their ends."""

    def points_and_normals(self, s: Reals) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Points of both sides, and unit normals of the walls at the first and the last curve, (m, len(s), 3) each."""


class Interpolated(Protocol):
    """A shape that native sides interpolate: the exact blade, or one that is cut from native sides."""

    @property
    def survey(self) -> RefinedStack:
        """Curves from end to end on which knots along u are chosen."""

    def sections(self, v: Reals) -> RefinedStack:
        """Curves of constant v (m,)."""

    @property
    def given_spans(self) -> Reals:
        """Places (n,) along the span at which the sides are to be these curves."""

    def breaks_along_u(self) -> Reals:
        """Inner knots that the sides need by s, each as often as derivatives are lost."""

    def breaks_along_v(self) -> Reals:
        """Inner knots that the sides need along the span, each as often as derivatives are lost."""


def mean_chord(exact: ExactBlade) -> float:
    """Mean straight distance from leading to trailing edge along the span [m]."""
    sections = exact.survey
    return float(np.mean(np.real(length(sections.trailing_edge().point - sections.leading_edge().point))))


def wall_tolerance(chord: float, *, fine: bool = False) -> float:
    """Largest distance [m] of the ends of a blade, or of a fine one, from hub and shroud."""
    return min(WALL_TOLERANCE * chord, FINE_WALLS) if fine else WALL_TOLERANCE * chord


def refined_knots(exact: ExactBlade, chord: float, *, slack: float = 1.0, fine: bool = False) -> Knots:
    """Knots with which the native sides meet the design's tolerance, and their ends lie on the walls.

    The limits beside the tolerance, of walls and of the edges' angles and radii, may be missed by
    `slack` times as much.
    """
    along_u, along_v, spans = refined_knots_of(
        exact, exact.design.tolerance * chord, chord, walls=slack * wall_tolerance(chord, fine=fine), slack=slack
    )
    return Knots(
        u=along_u, v=along_v, tip=exact.tip_knots, sections=spans if len(spans) else None, bent_from=exact.bent_from
    )


def refined_knots_of(
    exact: Interpolated,
    tolerance: float,
    chord: float,
    *,
    walls: float,
    edges: float | None = None,
    shaped: tuple[bool, bool] = (True, True),
    slack: float = 1.0,
) -> tuple[Reals, Reals, Reals]:
    """Knots along u and v with which native sides hold a shape, and the places along v that they interpolate besides.

    Within the tolerance, their ends within `walls` of theirs, and their edges within `edges` where that is given [m].
    Edges that are `shaped` keep their angles and radii; those that are cut have none.
    """
    spans = exact.given_spans
    start_u, start_v = clamped(exact.breaks_along_u()), exact.breaks_along_v()
    along_u = refined(start_u, _error_along_u(exact, tolerance, chord, spans, walls), MOST_POLES[0])
    if len(spans) and len(along_u) - DEGREE - 1 > MOST_POLES[0]:
        spans = spans[:0]
        along_u = refined(start_u, _error_along_u(exact, tolerance, chord, spans, walls), MOST_POLES[0])
    # a knot at each given section makes sure of an interpolation site nearby
    own = [v for v in spans if 0.0 < v < 1.0 and np.min(np.square(start_v - v), initial=1.0) > SAME_SPAN**2]
    along_v = refined(
        clamped(np.concatenate([start_v, own])),
        _error_along_v(exact, (tolerance, tolerance if edges is None else edges), along_u, spans, slack, shaped),
        MOST_POLES[1],
    )
    return along_u, along_v, spans


def sections_limit(tolerance: float) -> float:
    """Largest distance [chords] of curves of constant v from the sections that are given, by the tolerance [chords]."""
    return max(SECTIONS, SECTIONS_SHARE * tolerance)


def _error_along_u(
    exact: Interpolated, tolerance: float, chord: float, spans: Reals, walls: float
) -> Callable[[Reals, Reals], Reals]:
    """The error over what is allowed at places along u, by the knots, where sections are interpolated in u alone."""
    v = np.union1d(exact.survey.v, spans)
    sections = exact.survey if len(v) == len(exact.survey.v) else exact.sections(v)
    # along v there is no error at given sections, so that most of their limit is left for u
    limit = min(SECTIONS_RESERVE * sections_limit(tolerance / chord) * chord, RESERVE * tolerance)
    allowed = np.where(np.isin(v, spans), limit, RESERVE * tolerance)[:, None]
    wall_allowed = RESERVE * min(walls, tolerance)
    upper = sections.leading_edge(), sections.trailing_edge()
    edges_of_sides = upper, lower_edges(upper, sections.lower_edges())

    def error(knots: Reals, places: Reals) -> Reals:
        sites = greville(knots, DEGREE)[3:-3]
        both = np.concatenate([sites, places])
        order = np.argsort(both)
        back = np.argsort(order)
        worst = np.zeros(len(places))
        sides = zip(*sections.points_and_normals(both[order]), strict=True)
        for side, edges in zip(sides, edges_of_sides, strict=True):
            points, normals = side[0][:, back], side[1][:, back]
            lines = np.swapaxes(points[:, : len(sites)], 0, 1)
            net = interpolated_along_u(lines, *edges, knots)
            native = np.tensordot(basis(knots, DEGREE, places), net, axes=1).swapaxes(0, 1)
            off = native - points[:, len(sites) :]
            worst = np.maximum(worst, np.max(length(off) / allowed, axis=0))
            off_wall = dot(off, normals[:, len(sites) :])[[0, -1]]
            gap = np.max(np.abs(off_wall), axis=0)  # real: knots come from the real design
            worst = np.maximum(worst, gap / wall_allowed)
        return worst

    return error


def _error_along_v(
    exact: Interpolated,
    tolerances: tuple[float, float],
    knots_u: Reals,
    through: Reals,
    slack: float,
    shaped: tuple[bool, bool],
) -> Callable[[Reals, Reals], Reals]:
    """The error over what is allowed at places along v, by the knots, where lines of constant u are interpolated.

    The tolerances are those of the sides and of their edges.
    """
    spans = np.unique(knots_u)
    step = max(1, (len(spans) - 1) // MOST_LINES)
    s = np.concatenate([[0.0], (spans[:-1:step] + spans[1::step]) / 2.0, [1.0]])
    allowed = RESERVE * np.where((s > 0.0) & (s < 1.0), tolerances[0], min(tolerances))

    def error(knots: Reals, places: Reals) -> Reals:
        sites = sites_through(knots, through)
        both = np.concatenate([sites, places])
        sections = exact.sections(both)
        matrix = basis(knots, DEGREE, sites)
        errors = [np.zeros(len(places))]
        for points in sections.points(s):
            flat = points.reshape(len(both), -1)
            native = basis(knots, DEGREE, places) @ np.linalg.solve(matrix, flat[: len(sites)])
            miss = (native - flat[len(sites) :]).reshape(len(places), -1, 3)
            errors.append(np.max(length(miss) / allowed, axis=1))
        edges = sections.leading_edge(), sections.trailing_edge(), *sections.lower_edges()
        kept = [edge for keeps, edge in zip(2 * shaped, edges, strict=True) if keeps and edge is not None]
        errors += [_edge_error(edge, matrix, knots, places) / slack for edge in kept]
        return np.max(errors, axis=0)

    return error


def _edge_error(edge: EdgeDerivatives, matrix: Reals, knots: Reals, places: Reals) -> Reals:
    """Relative error of an edge's derivatives, which carry its angle and radius, over what is allowed."""
    count = len(matrix)
    at = basis(knots, DEGREE, places)
    result = np.zeros(len(places))
    for part, allowed in ((edge.first, FIRST_ALLOWED), (edge.second, SECOND_ALLOWED)):
        error = length(at @ np.linalg.solve(matrix, part[:count]) - part[count:])
        size = np.maximum(length(part[count:]), FLAT * length(edge.first[count:]))
        result = np.maximum(result, error / size / allowed)
    return result


class ApproximationError(NamedTuple):
    """How far native sides are from the exact blade between their interpolation sites, at equal parameters."""

    distance: float
    """largest distance [m]"""
    off_walls: float
    """largest distance of the ends from hub and shroud [m]"""
    u: float
    """where the largest distance is"""
    v: float


def approximation_error(exact: Interpolated, upper: Surface, lower: Surface) -> ApproximationError:
    """The distance of the sides from the exact blade: at equal parameters, so it bounds the true distance."""
    u, v = (_between(knots) for knots in (upper.knots_u, upper.knots_v))
    v = np.concatenate([[0.0], v, [1.0]])
    worst = ApproximationError(0.0, 0.0, 0.0, 0.0)
    for surface, points, normals in zip((upper, lower), *exact.sections(v).points_and_normals(u), strict=True):
        miss = np.real(surface.grid(u, v).swapaxes(0, 1) - points)
        distance = length(miss)
        i, j = np.unravel_index(int(np.argmax(distance)), distance.shape)
        ends = dot(miss, np.real(normals))[[0, -1]]
        wall_distance = max(worst.off_walls, float(np.max(np.abs(ends))))  # real: a measured distance
        if distance[i, j] > worst.distance:
            worst = ApproximationError(float(distance[i, j]), wall_distance, float(u[j]), float(v[i]))
        worst = worst._replace(off_walls=wall_distance)
    return worst


def _between(knots: Reals) -> Reals:
    spans = np.unique(knots)
    return np.sort(np.concatenate([spans[:-1] + share * np.diff(spans) for share in BETWEEN_KNOTS]))
