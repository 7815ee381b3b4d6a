"""Selection of what a passage holds: extents, the way of cross-lines, and knots with which its walls are accurate.

All of it is real and is held while a design is differentiated. Knots come one direction at a time: an interpolant of
the exact walls along that direction alone is refined until it lies on their surfaces of revolution within a tolerance.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.native.knots import DEGREE, clamped, refined
from bladewright.domain.camber_lines import CamberLines, camber_lines
from bladewright.domain.checks import (
    AMPLE_JACOBIAN,
    SIDES,
    LeastJacobian,
    check_duct,
    check_folds,
    check_pitch,
    least_jacobian,
)
from bladewright.domain.extents import CLEARANCE, departures, end_camber_lines, extents, shortest_duct, skew_reaches
from bladewright.domain.kinks import fade_joints, kink_shares, kinks
from bladewright.domain.knots import PIECES, PassageKnots
from bladewright.domain.middle_shift import SHARES, MiddleShift, fitted_shift
from bladewright.domain.passage_spec import PassageSpec
from bladewright.domain.walls import CROSS_LINES, CROSS_LINES_GATHERED, NO_SKEW, CrossLines, WallHalf
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, dot, length
from bladewright.nurbs.basis import Reals, basis, greville

WALL_TOLERANCE = 1e-7
"""Largest distance of hub and shroud from their surfaces of revolution, in chords: 1e-5 mm on a blade of 100 mm, which
is below what meshing and CAD resolve. design/passages.md has what every example reaches; with 1e-8 two of eight
machines are refused, with 1e-6 the annulus is off by 3e-8 instead of 1e-9 (design/passage_constants.md)."""
TRIMMED_SHARE = 0.2
"""Share of that tolerance that the edges of trimmed walls may use: those walls themselves are exact."""
SHORTENING, SHORTENINGS = 0.75, 12
"""Factor by which automatic extents past the blade are shortened where trimmed walls would wind more than a turn, and
how often at most: to 3 % of what they were."""
FULL_TURN = np.radians(355.0)
"""Winding of a trimmed wall [rad] that is allowed: a face of revolution must be less than a turn, with a margin."""
STRAIGHTENINGS = 12
"""How often the way over which periodic lines straighten is halved at most: to 0.05 % of it."""
FOOT_MARGIN = 0.002
"""How far past the foot of a fillet walls are the channel's own, in mean meridional lengths, before they straighten."""
MAX_POLES = 80
"""Control points of a piece in one direction above which refinement stops, and a passage is refused. With 40 passages
have 0.8 % more control points elsewhere, with 160 the same (design/passage_constants.md)."""
JOINT_SPACING = 1e-4
"""Least distance of knots at joints from each other and from the ends of their piece, as a share of it: nearer ones
would be one joint but for rounding, and make the interpolation ill-conditioned. A hundred times as much or as little is
hardly noticed (design/passage_constants.md)."""
ALONG = np.array([0.0, 0.03, 0.1, 0.25, 0.5, 0.75, 0.9, 0.97, 1.0])
"""Shares of a piece at which the walls' error across is measured: closer at the blade's edges, where walls bend
most."""
ACROSS = np.array([0.0, 0.2, 0.45, 0.7, 1.0])
"""Shares of the width at which the walls' error along the flow is measured."""
SPAN_KNOTS = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Span fractions between which inlet and outlet have knots to begin with, besides those of the blade's laws."""
SPAN_SPACING = 0.1
"""Distance from a knot of the blade's laws below which such a knot is left out: half as much adds 0.4 % of control
points (design/passage_constants.md)."""


def unfolded_walls(
    spec: PassageSpec, upstream: float | None, downstream: float | None
) -> tuple[PassageKnots, Mapping[str, WallHalf]]:
    """The first way of cross-lines that keeps all walls far from folding, or else the best, and the walls with it.

    `upstream` and `downstream` are extents, where stated. The knots returned have extents, but no knots yet.
    """
    exact = spec.exact
    tried: list[tuple[LeastJacobian, PassageKnots, Mapping[str, WallHalf]]] = []
    for cross_lines in CROSS_LINES_GATHERED if exact.survey.clustered else CROSS_LINES:
        try:
            start = _without_knots(
                spec, cross_lines, extents(exact, spec.half_pitch, cross_lines, upstream, downstream)
            )
            check_duct(spec.duct(start), exact.meridional_extent)
            camber = spec.camber(start, np.array([0.0, 1.0]))
            start = replace(start, reaches=skew_reaches(camber, spec.half_pitch, cross_lines))
        except DesignError:
            if not tried:
                raise
            break
        walls = spec.plane(start, np.array([0.0, 1.0]))[1]
        tried.append((least_jacobian(walls), start, walls))
        if tried[-1][0].share > AMPLE_JACOBIAN:
            break
    least, start, walls = max(tried, key=lambda each: each[0].share)
    check_folds({least.name: (least.share, least.u, least.v)})
    return start, walls


def skin_knots(
    spec: PassageSpec, upstream: float | None, downstream: float | None, *, filled: bool = True
) -> PassageKnots:
    """The knots of a skin whose walls are trimmed faces: the middle surface keeps WALL_TOLERANCE on both walls.

    Extents and errors are those of `skin_extents`.
    """
    start = skin_extents(spec, upstream, downstream, filled=filled)
    tolerance = TRIMMED_SHARE * WALL_TOLERANCE * spec.blade.chord
    lines = spec.middle_lines(start)
    known = replace(
        start,
        blade=knots_beside(lines, start.blade, tolerance),
        inlet=knots_along(lines, "inlet", 1.0, tolerance),
        outlet=knots_along(lines, "outlet", 1.0, tolerance),
    )
    return with_span_knots(spec, known, tolerance)


def skin_extents(
    spec: PassageSpec, upstream: float | None, downstream: float | None, *, filled: bool = True
) -> PassageKnots:
    """All that such a skin holds but knots of its own: cross-lines do not matter, and the duct may be as short.

    `upstream` and `downstream` are extents, where stated; others are shortened where the walls would wind more than a
    turn. Where nothing is to fill the duct between the walls, they may cross, and periodic lines straighten where those
    of stated extents would wind more than a turn. Raises DesignError where they do all the same, or the channel cannot
    be continued so far.
    """
    exact = spec.exact
    start = replace(
        _without_knots(spec, NO_SKEW, extents(exact, np.zeros(()), NO_SKEW, upstream, downstream)),
        walls="trimmed",
        blunt=(False, False),
        shift=_middle_shift(spec),
    )
    start = _past_feet(spec, start, (upstream is None, downstream is None))
    if filled:
        check_duct(spec.duct(start), exact.meridional_extent)
    for _ in range(SHORTENINGS):
        if not exact.mapping.revolved or max(spec.winding(start).values()) < FULL_TURN:
            break
        start = _shortened(spec, start, (upstream is None, downstream is None))
    return start if filled else _straightened(spec, start)


def _past_feet(spec: PassageSpec, start: PassageKnots, which: tuple[bool, bool]) -> PassageKnots:
    """The same, the walls those of the channel as far as fillets reach past the blade, and automatic extents past them.

    Raises DesignError where a stated extent ends before.
    """
    extent = spec.exact.meridional_extent
    feet = spec.feet(start)
    if feet is None:
        return start
    found, reaches = [start.start, start.end], [start.upstream, start.downstream]
    for edge, (foot, sign) in enumerate(zip(feet, (-1.0, 1.0), strict=True)):
        beyond = sign * (foot - found[edge]) > 0.0
        if beyond and extent.path_end(edge) is None:
            found[edge] = foot + sign * FOOT_MARGIN * extent.unit
        needed = extent.extent(edge, foot + sign * CLEARANCE * extent.unit)
        if reaches[edge] < needed:
            if not which[edge]:
                name = ("upstream", "downstream")[edge]
                raise DesignError(
                    f"{name} is {reaches[edge]:g} meridional lengths of the blade: the foot of the fillet, or the cut "
                    f"blade, asks for at least {needed:.4g}"
                )
            reaches[edge] = needed
    places = [extent.place(edge, reach) for edge, reach in enumerate(reaches)]
    return replace(
        start,
        start=found[0],
        end=found[1],
        upstream=reaches[0],
        downstream=reaches[1],
        low=places[0],
        high=places[1],
    )


def _shortened(spec: PassageSpec, start: PassageKnots, which: tuple[bool, bool]) -> PassageKnots:
    """The same with shorter extents past the blade's foremost and rearmost points, up- or downstream or both."""
    extent = spec.exact.meridional_extent
    found = []
    for edge, known in enumerate((start.upstream, start.downstream)):
        nose = extent.extent(edge, extent.blade_range[edge])
        found.append(nose + SHORTENING * (known - nose) if which[edge] else known)
    places = (extent.place(edge, known) for edge, known in enumerate(found))
    low, high = places
    return replace(start, upstream=found[0], downstream=found[1], low=low, high=high)


def _straightened(spec: PassageSpec, start: PassageKnots) -> PassageKnots:
    """The same with periodic lines that straighten past the blade, if they must, as late as a turn allows."""
    for halvings in range(STRAIGHTENINGS):
        wall, winding = max(spec.winding(start).items(), key=lambda each: each[1])
        if winding < FULL_TURN:
            return start
        start = replace(start, straightening=0.5**halvings)
    raise DesignError(
        f"the blade and a pitch wind {np.degrees(winding):.0f} deg around the axis at the {wall}, and a wall is one "
        f"face of at most {np.degrees(FULL_TURN):.0f} deg for each blade: let the blade wrap less, or take more blades"
    )


def _middle_shift(spec: PassageSpec) -> MiddleShift | None:
    """How far the middle surface must stand beside the camber surface for the blade to lie within its pitch."""
    exact, half = spec.exact, spec.real_half_pitch
    camber = camber_lines(exact.survey, shortest_duct(exact))
    try:
        check_pitch(camber, spec.blade, half)
    except DesignError:
        upper, lower = (real_first(camber.in_plane(side), 3) for side in camber.stations.plane_points(SIDES))
        around = np.concatenate([upper, lower[:, ::-1]], axis=1)
        lines = real_first(camber.points("blade", SHARES), 3)
        shift = fitted_shift(camber.stations.v, lines, around)
        check_pitch(replace(camber, shift=shift), spec.blade, half)
        return shift
    return None


def with_span_knots(spec: PassageSpec, start: PassageKnots, tolerance: float) -> PassageKnots:
    """The same with knots along the span with which inlet and outlet are accurate to a tolerance [m]."""
    span = knots_span(lambda v: spec.camber(start, v), spec.exact.breaks_along_v(), tolerance)
    return replace(start, span=span)


def with_wall_knots(start: PassageKnots, walls: Mapping[str, WallHalf], tolerance: float) -> PassageKnots:
    """The same with knots along and across the walls with which each direction is accurate to a tolerance [m]."""
    return replace(
        start,
        blade=knots_beside(walls, start.blade, tolerance),
        inlet=knots_along(walls, "inlet", start.reaches[0], tolerance),
        outlet=knots_along(walls, "outlet", start.reaches[1], tolerance),
        across=knots_across(walls, tolerance),
    )


def _without_knots(spec: PassageSpec, cross_lines: CrossLines, reaches: tuple[float, float]) -> PassageKnots:
    """All that is held, without knots of its own: each piece is one polynomial."""
    plain = np.concatenate([np.zeros(DEGREE + 1), np.ones(DEGREE + 1)])
    extent, ends = spec.exact.meridional_extent, end_camber_lines(spec.exact)
    back = ends.stations.back
    whole, own = 1.0 if back is None else back, spec.blade.knots.u[DEGREE + 1 : -DEGREE - 1]
    return PassageKnots(
        length=extent.length,
        unit=extent.unit,
        edges=extent.edges,
        upstream=reaches[0],
        downstream=reaches[1],
        low=extent.place(0, reaches[0]),
        high=extent.place(1, reaches[1]),
        start=extent.start,
        end=extent.end,
        noses=extent.blade_range,
        bend=ends.duct.bend,
        departures=departures(ends, spec.real_half_pitch),
        cross_lines=cross_lines,
        reaches=(1.0, 1.0),
        correspondence=ends.fitted_correspondence(cross_lines.edge_slope),
        blunt=ends.blunt,
        back=back,
        blade=clamped(own[own < whole] / whole),
        tail=clamped(own[own > whole]),
        inlet=plain,
        outlet=plain,
        across=plain,
        span=plain,
    )


def knots_across(walls: Mapping[str, WallHalf], tolerance: float) -> Reals:
    """Knots from the blade to a periodic boundary."""

    def error(knots: Reals, places: Reals) -> Reals:
        v = np.concatenate([greville(knots, DEGREE), places])
        worst, matrix = np.zeros(len(places)), _interpolation_matrix(knots, places)
        for wall in walls.values():
            for piece in PIECES:
                points, normals = (np.real(part) for part in wall.in_space(piece, ALONG, v))
                distances = _distances(matrix, np.swapaxes(points, 0, 1), np.swapaxes(normals, 0, 1))
                worst = np.maximum(worst, np.max(distances, axis=1) / tolerance)
        return worst

    return refined(clamped(np.linspace(0.0, 1.0, 4)[1:-1]), error, MAX_POLES)


def knots_along(walls: Mapping[str, WallHalf], piece: str, reach: float, tolerance: float) -> Reals:
    """Knots of the piece up- or downstream of the blade, in which the skew of cross-lines fades over `reach` of it.

    At kinks one derivative is kept, at corners none, and two where the skew begins.
    """
    camber = next(iter(walls.values())).camber
    duct, past = camber.duct, int(piece == "outlet")
    edge, end = (duct.edges[1], duct.high) if past else (duct.edges[0], duct.low)
    kinked = [kinks(duct, row) for row in (0, 1)]
    smooth = np.setdiff1d(duct.joints_within(), np.concatenate(kinked))
    full, corners = (_spaced(kink_shares(camber, past, corners=only)) for only in (False, True))
    fading = _apart_from(full, fade_joints(reach))
    single = _apart_from(np.concatenate([full, fading]), _spaced(np.append((smooth - edge) / (end - edge), 0.5)))
    inner = np.concatenate([np.repeat(full, DEGREE - 1), corners, np.repeat(fading, DEGREE - 2), single])
    inner = np.sort(inner if past else 1.0 - inner)
    return refined(clamped(inner), _error_along(walls, piece, tolerance), MAX_POLES + len(full) * DEGREE)


def knots_beside(walls: Mapping[str, WallHalf], own: Reals, tolerance: float) -> Reals:
    """The blade's own knots along u, and those that the walls beside it need as well."""
    return refined(own, _error_along(walls, "blade", tolerance), MAX_POLES + len(own))


def knots_span(camber_at: Callable[[Reals], CamberLines], inner: Reals, tolerance: float) -> Reals:
    """Knots of inlet, outlet and periodic boundaries along the span; `inner` are those of the blade's laws.

    With them the edges of inlet and outlet lie on the surfaces of revolution of the duct's ends.
    """

    def error(knots: Reals, places: Reals) -> Reals:
        camber = camber_at(np.concatenate([greville(knots, DEGREE), places]))
        mapping, count = camber.lines.mapping, len(knots) - DEGREE - 1
        worst, matrix = np.zeros(len(places)), _interpolation_matrix(knots, places)
        for piece, t in (("inlet", 0.0), ("outlet", 1.0)):
            plane = np.real(camber.points(piece, np.array([t])))
            position = np.real(camber.lines.position(camber.lines.u_at(plane[..., 0])))
            x, radius, tangential = position[:, 0, 0], position[:, 0, 1], plane[:, 0, 1]
            points = mapping.in_space(x, radius, tangential)
            differences = matrix @ points[:count] - points[count:]
            if mapping.revolved:
                outwards = mapping.in_space(0.0 * x, 1.0 + 0.0 * x, tangential)[count:]
                differences = np.stack([differences[:, 0], dot(differences, outwards)], axis=-1)
            worst = np.maximum(worst, length(differences) / tolerance)
        return worst

    spans = np.unique(np.concatenate([SPAN_KNOTS, inner]))
    extra = [place for place in spans[1:-1] if not np.any(np.abs(inner - place) < SPAN_SPACING)]  # real: knots
    return refined(clamped(np.concatenate([inner, extra])), error, MAX_POLES)


def _error_along(walls: Mapping[str, WallHalf], piece: str, tolerance: float) -> Callable[[Reals, Reals], Reals]:
    """The largest error of all walls, in tolerances, of interpolation along a piece, as a function of knots and t."""

    def error(knots: Reals, places: Reals) -> Reals:
        t = np.concatenate([greville(knots, DEGREE), places])
        order = np.argsort(t)
        back = np.argsort(order)
        worst, matrix = np.zeros(len(places)), _interpolation_matrix(knots, places)
        for wall in walls.values():
            points, normals = (np.real(part)[back] for part in wall.in_space(piece, t[order], ACROSS))
            worst = np.maximum(worst, np.max(_distances(matrix, points, normals), axis=1) / tolerance)
        return worst

    return error


def _interpolation_matrix(knots: Reals, places: Reals) -> Reals:
    """The matrix (k, n) from points at the Greville abscissae to the interpolant's at places (k,)."""
    return np.asarray(basis(knots, DEGREE, places) @ np.linalg.inv(basis(knots, DEGREE, greville(knots, DEGREE))))


def _distances(matrix: Reals, points: Array, normals: Array) -> Reals:
    """Distances (k, l) along the normals of the interpolant of points (n + k, l, 3) from the last k of them."""
    count = matrix.shape[1]
    native = np.tensordot(matrix, points[:count], axes=1)
    return np.abs(dot(native - points[count:], normals[count:]))  # real: knots come from the real design


def _apart_from(others: Reals, places: Reals) -> Reals:
    """Those places (k,) that are no others (m,)."""
    near = np.square(places[:, None] - others) < JOINT_SPACING**2
    return places[~np.any(near, axis=1)]


def _spaced(places: Reals) -> Reals:
    """Those inside (0, 1), and of two that nearly coincide the first."""
    inside = np.sort(places[(places > JOINT_SPACING) & (places < 1.0 - JOINT_SPACING)])
    return inside[np.diff(inside, prepend=0.0) > JOINT_SPACING]
