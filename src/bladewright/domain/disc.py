"""A disc under the hub, or a ring around the shroud, in the meridional plane: lines and arcs, or a thin rim.

Both ends of the outline lie on the wall that carries the blades, up- and downstream of them. Seen along the flow, a
disc lies to the right of its wall and a ring to the left.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.blade.design.disc import Disc, Outline
from bladewright.domain.wall_line import SEARCHED, SETTLED, STEPS, WallLine
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping, FrozenRecord
from bladewright.numerics.elementary import Array, cross2, dot, length, magnitude, turned_left, unit
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import Reals, breaks, greville
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.fit import interpolated
from bladewright.nurbs.revolution import arc, segment
from bladewright.section.crossing import self_crossings

OFF_THE_WALL = 0.01
"""Largest distance of an end of the outline from the wall, in meridional lengths of the blade there: so far the end's
line is cut off or carried on to the wall, whose places nobody knows to the last digit."""
LEAST_SINE = 0.1
"""Sine of the angle between the outline and the wall below which its end is refused, 6 deg: the edge would be one of a
sliver."""
REACH = 0.1
"""How far a thin rim reaches past the blade where nothing is stated, in meridional lengths of the blade at the wall."""
PLACES = 24
"""Points on a piece of the outline by which crossings are looked for; Gauss points on a knot span."""
SPREAD = (1.0 - np.cos(np.pi * np.arange(PLACES) / PLACES)) / 2.0
"""The places of these points, uneven: corners of a simple outline do not happen to fall on them."""
TURNED_BACK = 1e-6
"""1 + the cosine of a corner's turn below which the outline turns back on itself."""
SLACK = 1e-9
"""Share of a line by which the arcs at its ends may overlap: rounding."""
LEVEL = 1e-9
"""Difference of the radii of a line's ends, of its length, below which it is parallel to the axis: rounding."""
RIM_DEGREE = 5
"""Degree of a thin rim's offset curve."""
RIM_TOLERANCE = 1e-7
"""Largest error of that curve, of the thickness."""
RIM_SPANS = (4, 8, 16, 32, 64)
"""Numbers of its spans that are tried in turn."""
WALL_PLACES = 241
"""Points of the wall by which crossings are looked for."""


@dataclass(frozen=True, kw_only=True)
class Kind:
    """What lies on one of the walls."""

    field: str
    wall: str
    side: int
    """-1 to the right of the flow along its wall, +1 to the left"""
    first: str
    last: str
    level: str
    """name of the face parallel to the axis that lies furthest from the wall"""
    other: str
    """of all others, with their number"""
    cyclic: str
    """of a sector's cyclic faces, with `low` or `high`"""


KINDS = (
    Kind(
        field="disc",
        wall="hub",
        side=-1,
        first="rim_front",
        last="rim_back",
        level="bore",
        other="disc",
        cyclic="cyclic",
    ),
    Kind(
        field="shroud_ring",
        wall="shroud",
        side=1,
        first="ring_front",
        last="ring_back",
        level="ring_outside",
        other="ring",
        cyclic="ring_cyclic",
    ),
)
"""What may carry or join blades, and what its faces are called."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OutlinePiece(FrozenRecord):
    """A line, an arc or the offset of a wall in (x, r) [m], on the way from upstream to downstream."""

    curve: Curve
    """over [0, 1]"""
    turn: Array | None = None
    """() angle of an arc [rad], counter-clockwise in (x, r); none of others"""

    @cached_property
    def length(self) -> Array:
        """() [m]."""
        t, weights = panels(breaks(self.curve.knots), PLACES)
        return np.asarray(np.sum(weights * length(self.curve.derivative(t))))

    def at(self, share: Reals) -> Array:
        """Points (k, 2) at shares of an arc's length; of others at their own parameter."""
        if self.turn is None:
            return self.curve(share)
        first, last = self.curve(0.0), self.curve(1.0)
        centre = 0.5 * (first + last + turned_left(last - first) / np.tan(0.5 * self.turn))
        angle = (self.turn * share)[..., None]
        return centre + np.cos(angle) * (first - centre) + np.sin(angle) * turned_left(first - centre)


@dataclass(frozen=True, kw_only=True, eq=False)
class Carrier(FrozenRecord):
    """The meridional half of a disc or a shroud ring."""

    kind: Kind
    line: WallLine
    ends: tuple[Array, Array]
    """() the line's parameters at which the outline begins and ends"""
    pieces: Mapping[str, OutlinePiece]
    """by the names of the faces that they become"""

    @cached_property
    def volume(self) -> Array:
        """Volume () [m^3] between wall and outline all around: the integral of pi r^2 dx (Pappus and Green)."""
        outline = sum(self._swept(piece.curve) for piece in self.pieces.values())
        return np.asarray(self.kind.side * (outline - np.diff(self.line.swept(np.array(self.ends)))[0]))

    @staticmethod
    def _swept(curve: Curve) -> Array:
        t, weights = panels(breaks(curve.knots), PLACES)
        return np.asarray(np.pi * np.sum(weights * curve(t)[:, 1] ** 2 * curve.derivative(t)[:, 0]))


def carrier(kind: Kind, given: Disc, line: WallLine, metre: float) -> Carrier:
    """The disc or shroud ring of a design on its wall, whose line reaches past the outline's ends.

    Raises DesignError where the outline's ends do not lie on the wall, or it crosses itself, the wall or the axis.
    """
    ends, pieces = (
        _rim(kind, given, line, metre) if given.outline is None else _outlined(kind, given.outline, line, metre)
    )
    found = Carrier(kind=kind, line=line, ends=ends, pieces=_named(kind, pieces))
    _check_outline(found, metre, rim=given.outline is None)
    return found


def shortfalls(given: Disc, line: WallLine, metre: float) -> tuple[float, float]:
    """By how much [m] the wall's line ends before the outline does, upstream and downstream; 0 where it does not."""
    low, high = line.curve.domain
    if given.outline is None:
        before, after = (float(np.real(far)) for far in _reaches(given, line, metre))
        first, last, whole = np.real(line.reached(np.array([*line.blade, high])))
        return max(before - first, 0.0), max(after - (whole - last), 0.0)
    points = np.real(_points(given.outline, metre))
    found = []
    for point, end in ((points[0], low), (points[-1], high)):
        away = float(length(point - np.real(line.at(np.asarray(end)))))
        found.append(away if _nearest(line, point) == end else 0.0)
    return found[0], found[1]


def _points(outline: Outline, metre: float) -> Array:
    return metre * np.array([[point.x, point.r] for point in outline.points])


def _nearest(line: WallLine, point: Reals) -> float:
    """The parameter of the nearest of SEARCHED points of the line."""
    t = np.linspace(*line.curve.domain, SEARCHED)
    return float(t[np.argmin(np.sum((np.real(line.at(t)) - point) ** 2, axis=-1))])


def _outlined(
    kind: Kind, outline: Outline, line: WallLine, metre: float
) -> tuple[tuple[Array, Array], list[OutlinePiece]]:
    """Where the outline's first and last line meet the wall, and its pieces from there."""
    points = _points(outline, metre)
    ends = [
        _met(kind, line, points[end], points[after], f"points[{end % len(points)}]", metre)
        for end, after in ((0, 1), (-1, -2))
    ]
    if not np.real(ends[0]) < np.real(ends[1]):
        raise DesignError(
            f"{kind.field}.outline.points run against the flow along the {kind.wall}: begin with the point upstream of "
            "the blades"
        )
    corners = np.concatenate([line.at(ends[0])[None], points[1:-1], line.at(ends[1])[None]])
    radii = metre * np.array(outline.radii or [0.0] * (len(points) - 2))
    return (ends[0], ends[1]), lines_and_arcs(corners, radii, f"{kind.field}.outline", metre)


def _met(kind: Kind, line: WallLine, point: Array, after: Array, name: str, metre: float) -> Array:
    """The line's parameter () where the wall meets the straight line from an end of the outline to the point after."""
    path, along = f"{kind.field}.outline.{name}", unit(after - point)
    t = _nearest(line, np.real(point))
    x, r = np.real(line.at(np.asarray(t)))
    away = float(length(np.real(line.at(np.asarray(t)) - point)))
    allowed = OFF_THE_WALL * float(np.real(line.blade_length))
    where = f"({np.real(point[0]) / metre:.6g}, {np.real(point[1]) / metre:.6g})"
    if away > allowed:
        raise DesignError(
            f"{path} is {where}, which lies {away / metre:.4g} off the {kind.wall}: an end of the outline must lie on "
            f"it, within {allowed / metre:.3g}; the nearest place is ({x / metre:.6g}, {r / metre:.6g})"
        )
    for _ in range(STEPS):
        step = cross2(np.real(line.at(np.asarray(t)) - point), np.real(along)) / cross2(
            np.real(line.at(np.asarray(t), 1)), np.real(along)
        )
        t = float(t - step)
        if step**2 < SETTLED**2:
            break
    slope = line.at(np.asarray(t), 1)
    sine = float(cross2(unit(np.real(slope)), np.real(along)))
    low, high = line.curve.domain
    if sine**2 < LEAST_SINE**2 or not low <= t <= high:
        found, least = np.degrees(np.arcsin([np.sqrt(sine**2), LEAST_SINE]))
        raise DesignError(
            f"{path} is {where}, where the outline meets the {kind.wall} at {found:.2g} deg: at least {least:.2g} deg "
            f"are needed; turn its line away from the {kind.wall}"
        )
    return np.asarray(t - cross2(line.at(np.asarray(t)) - point, along) / cross2(slope, along))


def lines_and_arcs(points: Array, radii: Array, path: str, metre: float) -> list[OutlinePiece]:
    """Exact lines between points (n, 2), the inner ones rounded by tangent arcs of radii (n - 2,), 0 for a corner.

    Raises DesignError where an arc does not fit, or the line turns back on itself.
    """
    along, sides = unit(np.diff(points, axis=0)), length(np.diff(points, axis=0))
    turn, onwards = cross2(along[:-1], along[1:]), 1.0 + dot(along[:-1], along[1:])
    for i, value in enumerate(np.real(onwards)):
        if value < TURNED_BACK:
            raise DesignError(f"{path}.points[{i + 1}]: the outline turns back on itself there; put a further point in")
    half = turn / onwards
    cut = np.concatenate([[0.0], radii * magnitude(half), [0.0]])
    for i, (taken, given) in enumerate(zip(np.real(cut[:-1] + cut[1:]), np.real(sides), strict=True)):
        if taken > given * (1.0 + SLACK):
            raise DesignError(
                f"{path}.radii: the arcs take {taken / metre:.6g} of the line from points[{i}] to points[{i + 1}], "
                f"which is {given / metre:.6g} long; take smaller radii, or move the points apart"
            )
    pieces = []
    for i, size in enumerate(sides):
        start, end = points[i] + cut[i] * along[i], points[i + 1] - cut[i + 1] * along[i]
        if np.real(size - cut[i] - cut[i + 1]) > SLACK * np.real(size):
            pieces.append(OutlinePiece(curve=segment(start, end)))
        if np.real(cut[i + 1]) > 0.0:
            sign = 1.0 if np.real(turn[i]) > 0.0 else -1.0
            inwards, sweep = sign * turned_left(along[i]), 2.0 * sign * np.arctan(half[i])
            bend = arc(end + radii[i] * inwards, radii[i], 0.0, sweep, axes=(-inwards, along[i]))
            pieces.append(OutlinePiece(curve=bend, turn=sign * sweep))
    return pieces


def _reaches(given: Disc, line: WallLine, metre: float) -> list[Array]:
    """How far (), twice, a thin rim reaches past the blade along the wall [m]."""
    usual = REACH * line.blade_length
    return [usual if far is None else np.asarray(metre * far) for far in (given.upstream, given.downstream)]


def _rim(kind: Kind, given: Disc, line: WallLine, metre: float) -> tuple[tuple[Array, Array], list[OutlinePiece]]:
    """A thin rim: the wall's offset, and straight across at both ends."""
    before, after = _reaches(given, line, metre)
    first, last = line.reached(np.array(line.blade))
    ends = line.parameter(np.array([first - before, last + after]))
    thickness = metre * np.asarray(given.thickness)
    start, end = (line.foot(at) for at in ends)
    offset = _offset(kind, line, thickness, start, end, metre)
    down = segment(line.at(ends[0]), offset.control_points[0])
    up = segment(offset.control_points[-1], line.at(ends[1]))
    return (ends[0], ends[1]), [OutlinePiece(curve=curve) for curve in (down, offset, up)]


def _offset(kind: Kind, line: WallLine, thickness: Array, start: Array, end: Array, metre: float) -> Curve:
    """The curve over [0, 1] at a constant distance from the wall between two parameters of its meridian."""
    wall = line.meridian

    def exact(share: Reals) -> tuple[Array, Array]:
        s = start + (end - start) * share
        slope = wall.derivative(s)
        return wall(s) + kind.side * thickness * turned_left(unit(slope)), slope

    low, high = float(np.real(start)), float(np.real(end))
    inner = np.unique(line.joints[(line.joints > low) & (line.joints < high)])
    joints = np.repeat((inner - low) / (high - low), RIM_DEGREE - 1)
    for spans in RIM_SPANS:
        even = np.linspace(0.0, 1.0, spans + 1)[1:-1]
        even = even[np.all((even[:, None] - joints) ** 2 > (0.1 / spans) ** 2, axis=1)]
        knots = np.sort(np.concatenate([np.zeros(RIM_DEGREE + 1), even, joints, np.ones(RIM_DEGREE + 1)]))
        sites = greville(knots, RIM_DEGREE)
        found = interpolated(exact(sites)[0], sites, degree=RIM_DEGREE, knots=knots)
        between = (sites[1:] + sites[:-1]) / 2.0
        points, slopes = (np.real(each) for each in exact(between))
        if np.max(length(np.real(found(between)) - points)) < RIM_TOLERANCE * float(np.real(thickness)):
            break
    onwards = dot(np.real(found.derivative(between)), slopes)
    if np.min(onwards) <= 0.0 or np.min(points[:, 1]) <= 0.0:
        worst = np.argmin(onwards) if np.min(onwards) <= 0.0 else np.argmin(points[:, 1])
        x, r = np.real(wall(low + (high - low) * between[worst])) / metre
        raise DesignError(
            f"{kind.field}.thickness is {float(np.real(thickness)) / metre:.4g}: the rim would fold over or reach the "
            f"axis under ({x:.6g}, {r:.6g}), where the {kind.wall} bends more tightly or lies lower; take less"
        )
    return found


def _named(kind: Kind, pieces: Sequence[OutlinePiece]) -> Mapping[str, OutlinePiece]:
    """The pieces by name: first and last, the level one furthest from the wall, and the others in order."""
    names, number = [kind.first], 0
    furthest = max(float(np.max(kind.side * np.real(piece.curve.control_points[:, 1]))) for piece in pieces)
    for piece in pieces[1:-1]:
        x, r = np.ptp(np.real(piece.curve.control_points), axis=0)
        level = r < LEVEL * x and kind.side * np.real(piece.curve.control_points[0, 1]) >= furthest - LEVEL * x
        if level or len(pieces) == 3:
            names.append(kind.level)
        else:
            number += 1
            names.append(f"{kind.other}_{number}")
    return FrozenMapping(dict(zip([*names, kind.last], pieces, strict=True)))


def _check_outline(found: Carrier, metre: float, *, rim: bool) -> None:
    """Refuse an outline that crosses the wall or itself, or lies on the wrong side of the wall."""
    low, high = (float(np.real(end)) for end in found.ends)
    wall = np.real(found.line.at(np.linspace(low, high, WALL_PLACES)))
    parts = [np.real(piece.curve(SPREAD)) for piece in found.pieces.values()]
    if rim:
        # the same places of both, or chords of a rim that is thin and long would cross
        share = np.linspace(0.0, 1.0, WALL_PLACES)
        start, end = (float(np.real(found.line.foot(at))) for at in found.ends)
        wall = np.real(found.line.meridian(start + (end - start) * share))
        parts[1] = np.real(list(found.pieces.values())[1].curve(share[:-1]))
    outline = np.concatenate(parts)[1:][::-1]
    loop = np.concatenate([wall, outline])
    kind = found.kind
    crossed = self_crossings(loop[None])
    if crossed is not None:
        x, r = loop[crossed[1]] / metre
        what = f"the {kind.wall}" if crossed[1] < WALL_PLACES else "itself"
        raise DesignError(
            f"{kind.field}: its outline cuts {what} near ({x:.6g}, {r:.6g}): between its ends it must keep clear of "
            f"the {kind.wall} and of itself; move its points {'under' if kind.side < 0 else 'outside'} the {kind.wall}"
        )
    following = np.roll(loop, -1, axis=0)
    if kind.side * np.sum(cross2(loop, following)) <= 0.0:
        raise DesignError(
            f"{kind.field}: its outline lies in the flow: seen along the flow a disc lies to the right of the hub, "
            "towards the axis on an axial machine, and a ring to the left of the shroud; move its points across"
        )
