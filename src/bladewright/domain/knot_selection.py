"""Choice of a passage's extents and knots, by which its walls lie on their surfaces of revolution."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from bladewright.blade.native.knots import DEGREE, clamped, refined
from bladewright.domain.camber_correspondence import camber_correspondence
from bladewright.domain.camber_lines import CamberLines
from bladewright.domain.checks import AMPLE_JACOBIAN, LeastJacobian, check_duct, check_folds, least_jacobian
from bladewright.domain.extents import end_cambers, extents, openings
from bladewright.domain.knots import PIECES, PassageKnots
from bladewright.domain.passage_spec import PassageSpec
from bladewright.domain.walls import CROSS_LINES, CROSS_LINES_GATHERED, CrossLines, WallHalf
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, dot, length
from bladewright.nurbs.basis import Reals, basis, greville


def knots_at_tolerance(start: PassageKnots, walls: Mapping[str, WallHalf], tolerance: float) -> PassageKnots:
    """Knots with which each direction of the walls misses by at most a tolerance [m]; `start` has all others."""
    return replace(
        start,
        blade=knots_beside(walls, start.blade, tolerance),
        inlet=knots_along(walls, "inlet", tolerance),
        outlet=knots_along(walls, "outlet", tolerance),
        across=knots_across(walls, tolerance),
    )


def with_span_knots(asked: PassageSpec, start: PassageKnots, tolerance: float) -> PassageKnots:
    """The same with knots along the span, with which inlet and outlet miss by at most a tolerance [m]."""
    span = knots_span(lambda v: asked.camber(start, v), asked.full.breaks_along_v(), tolerance)
    return replace(start, span=span)


def unfolded_walls(
    asked: PassageSpec, upstream: float | None, downstream: float | None
) -> tuple[PassageKnots, Mapping[str, WallHalf]]:
    """The first way for cross-lines in which no wall is near to folding, or else the best, and the walls.

    `upstream` and `downstream` are extents, where stated. What comes back has extents, but no knots yet.
    """
    full = asked.full
    tried: list[tuple[LeastJacobian, PassageKnots, Mapping[str, WallHalf]]] = []
    for crossing in CROSS_LINES_GATHERED if full.survey.gathered else CROSS_LINES:
        try:
            start = _rough(asked, crossing, extents(full, asked.half, crossing, upstream, downstream))
            check_duct(asked.duct(start), full.meridional_extent)
        except DesignError:
            if not tried:
                raise
            break
        walls = asked.plane(start, np.array([0.0, 1.0]))[1]
        tried.append((least_jacobian(walls), start, walls))
        if tried[-1][0].share > AMPLE_JACOBIAN:
            break
    least, start, walls = max(tried, key=lambda each: each[0].share)
    check_folds({least.name: (least.share, least.u, least.v)})
    return start, walls


def _rough(asked: PassageSpec, crossing: CrossLines, reaches: tuple[float, float]) -> PassageKnots:
    rough = np.concatenate([np.zeros(DEGREE + 1), np.ones(DEGREE + 1)])
    course, ends = asked.full.meridional_extent, end_cambers(asked.full)
    back = ends.stations.back
    whole, own = 1.0 if back is None else back, asked.blade.knots.u[DEGREE + 1 : -DEGREE - 1]
    return PassageKnots(
        length=course.length,
        unit=course.unit,
        edges=course.edges,
        upstream=reaches[0],
        downstream=reaches[1],
        low=course.place(0, reaches[0]),
        high=course.place(1, reaches[1]),
        start=course.start,
        end=course.end,
        opening=openings(ends, asked.real_half),
        crossing=crossing,
        correspondence=camber_correspondence(ends, crossing.quick),
        parted=ends.parted,
        back=back,
        blade=clamped(own[own < whole] / whole),
        tail=clamped(own[own > whole]),
        inlet=rough,
        outlet=rough,
        across=rough,
        span=rough,
    )


WALL_TOLERANCE = 1e-7
"""distance of hub and shroud from their surfaces of revolution, of the chord"""
MOST_POLES = 80
"""poles of a piece in one direction above which a passage is refused"""
NEAR = 1e-4
"""share of a piece by which knots at joints stand apart from each other and from its ends"""
_ALONG = np.array([0.0, 0.03, 0.1, 0.25, 0.5, 0.75, 0.9, 0.97, 1.0])
_ACROSS = np.array([0.0, 0.2, 0.45, 0.7, 1.0])


def knots_across(walls: Mapping[str, WallHalf], tolerance: float) -> Reals:
    """Knots from the blade to a periodic boundary."""

    def miss(knots: Reals, places: Reals) -> Reals:
        v = np.concatenate([greville(knots, DEGREE), places])
        worst, at = np.zeros(len(places)), _at(knots, places)
        for wall in walls.values():
            for piece in PIECES:
                points, normals = (np.real(part) for part in wall.in_space(piece, _ALONG, v))
                off = _off(at, np.swapaxes(points, 0, 1), np.swapaxes(normals, 0, 1))
                worst = np.maximum(worst, np.max(off, axis=1) / tolerance)
        return worst

    return refined(_plain(3), miss, MOST_POLES)


def knots_along(walls: Mapping[str, WallHalf], piece: str, tolerance: float) -> Reals:
    """Knots of the piece up- or downstream of the blade."""

    def miss(knots: Reals, places: Reals) -> Reals:
        t = np.concatenate([greville(knots, DEGREE), places])
        worst, at = np.zeros(len(places)), _at(knots, places)
        for wall in walls.values():
            points, normals = (np.real(part) for part in wall.in_space(piece, t, _ACROSS))
            worst = np.maximum(worst, np.max(_off(at, points, normals), axis=1) / tolerance)
        return worst

    duct = next(iter(walls.values())).camber.duct
    edge, end = (duct.edges[0], duct.low) if piece == "inlet" else (duct.edges[1], duct.high)
    joints = (duct.joints_within() - edge) / (end - edge)
    inner = 1.0 - joints if piece == "inlet" else joints
    return refined(clamped(_apart(np.append(inner, 0.5))), miss, MOST_POLES)


def knots_beside(walls: Mapping[str, WallHalf], own: Reals, tolerance: float) -> Reals:
    """The blade's own knots along u, with as many more as the walls beside it need."""

    def miss(knots: Reals, places: Reals) -> Reals:
        t = np.concatenate([greville(knots, DEGREE), places])
        order = np.argsort(t)
        back = np.argsort(order)
        worst, at = np.zeros(len(places)), _at(knots, places)
        for wall in walls.values():
            points, normals = (np.real(part)[back] for part in wall.in_space("blade", t[order], _ACROSS))
            worst = np.maximum(worst, np.max(_off(at, points, normals), axis=1) / tolerance)
        return worst

    return refined(own, miss, MOST_POLES + len(own))


def knots_span(camber_at: Callable[[Reals], CamberLines], inner: Reals, tolerance: float) -> Reals:
    """Knots of inlet, outlet and periodic boundaries along the span; `inner` are where the blade's laws have theirs.

    With them the edges of inlet and outlet lie on the surfaces of revolution of the duct's ends.
    """

    def miss(knots: Reals, places: Reals) -> Reals:
        camber = camber_at(np.concatenate([greville(knots, DEGREE), places]))
        mapping, count = camber.lines.mapping, len(knots) - DEGREE - 1
        worst, at = np.zeros(len(places)), _at(knots, places)
        for piece, t in (("inlet", 0.0), ("outlet", 1.0)):
            plane = np.real(camber.points(piece, np.array([t])))
            position = np.real(camber.lines.position(camber.lines.u_at(plane[..., 0])))
            x, radius, tangential = position[:, 0, 0], position[:, 0, 1], plane[:, 0, 1]
            points = mapping.in_space(x, radius, tangential)
            error = at @ points[:count] - points[count:]
            if mapping.revolved:
                outwards = mapping.in_space(0.0 * x, 1.0 + 0.0 * x, tangential)[count:]
                error = np.stack([error[:, 0], dot(error, outwards)], axis=-1)
            worst = np.maximum(worst, length(error) / tolerance)
        return worst

    spans = np.unique(np.concatenate([[0.0, 0.25, 0.5, 0.75, 1.0], inner]))
    extra = [place for place in spans[1:-1] if not np.any(np.abs(inner - place) < 0.1)]  # real: knots
    return refined(clamped(np.concatenate([inner, extra])), miss, MOST_POLES)


def _at(knots: Reals, places: Reals) -> Reals:
    """The matrix (k, n) from points at the Greville abscissae to the interpolant's at places (k,)."""
    return np.asarray(basis(knots, DEGREE, places) @ np.linalg.inv(basis(knots, DEGREE, greville(knots, DEGREE))))


def _off(at: Reals, points: Array, normals: Array) -> Reals:
    """Distance (k, l) along the normals of the interpolant of points (n + k, l, 3) from the last k of them."""
    count = at.shape[1]
    native = np.tensordot(at, points[:count], axes=1)
    return np.abs(dot(native - points[count:], normals[count:]))  # real: knots come from the real design


def _apart(places: Reals) -> Reals:
    """Those inside (0, 1), of two that are nearly the same the first."""
    inside = np.sort(places[(places > NEAR) & (places < 1.0 - NEAR)])
    return inside[np.diff(inside, prepend=0.0) > NEAR]


def _plain(spans: int) -> Reals:
    return clamped(np.linspace(0.0, 1.0, spans + 1)[1:-1])
