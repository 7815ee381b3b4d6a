"""Knots with which fillets and the strips above them hold what is promised."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.closed_section import ACROSS_EDGES, LOWER, UPPER, ClosedSection, SectionSplines, Sites
from bladewright.blade.native.contacts import Contacts
from bladewright.blade.native.cross_section import CrossSections
from bladewright.blade.native.end_faces import EndKnots
from bladewright.blade.native.fillet_joints import check_curvatures, kinks
from bladewright.blade.native.fillet_limits import check_fillets, named, scaled
from bladewright.blade.native.knots import DEGREE, Knots, clamped, refined
from bladewright.blade.native.pivot import ACROSS, Pivot, Turning, pivots_of
from bladewright.blade.native.refinement import RESERVE, wall_tolerance
from bladewright.blade.native.rolling_ball import Ball, Rolled, Touch
from bladewright.blade.native.strip import Strip, strips_for
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array, cross, dot, length, unit
from bladewright.nurbs.basis import Reals, basis, greville, knots_with_joints

ON_BALL = 1e-6
"""Largest distance of a fillet from its ball, of the ball's radius."""
ON_WALL = 1e-6
"""Largest angle between the tangent planes of fillet and wall at the foot, and of fillets beside a corner [rad]."""
AT_JOINTS = 1e-9
"""Largest angle between the tangent planes of strips beside corners and those of fillet and side [rad]."""
MOST_POLES = (300, 60)
"""Control points of fillets around the blade, on one side, and of strips along w at which knots are added no more: half
as many again as a plain blade may have, for what the foot asks for, and twice what a strip of any example has."""
QUARTERS = np.array([0.25, 0.5, 0.75])
"""Knots of a fillet about a corner to begin with: in one span, errors at its ends are larger than those looked at."""
LINES = 12
"""About how many lines of a strip are looked at on each side for its knots along them."""
PLACES = np.array([0.0, 0.2, 0.5])
"""w of the strips at which knots around the blade are looked at: at 1 they have those of the side."""
LOOKED_AT = np.linspace(0.0, 1.0, 1001)
"""u at which it is seen whether a ball that needs too many poles folds or loses contact between the first sites."""
NEAREST, LEAST_TRIED = 1.04, 0.1
"""Ratio of a radius that needs too many poles to one that does not, at which the search for the largest ends, and the
share of the one asked for below which none is tried: each takes a second."""


class _TooManyPolesError(DesignError):
    """More poles are needed than are used."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FilletKnots(Knots):
    """Knots of the sides, which are those of the blade before but for where they are cut, and what else is held."""

    strips: Mapping[str, Strip] = field(default_factory=lambda: FrozenMapping({}))
    """how lines run from each fillet to the side, by the wall"""
    ends: Mapping[str, EndKnots] = field(default_factory=lambda: FrozenMapping({}))
    """of the end faces inside the feet"""
    near: Mapping[str, Contacts] = field(default_factory=lambda: FrozenMapping({}))
    """contacts by the wall, near which others are sought"""
    splines: SectionSplines | None = None
    """around the blade, of fillets and strips"""
    pivots: Mapping[str, Sequence[tuple[Pivot, Reals]]] = field(default_factory=lambda: FrozenMapping({}))
    """about corners, by the wall, and the knots of each"""

    def turning(self, wall: str, touch: Touch, real: Sequence[Turning] | None = None) -> list[Turning]:
        """A touch's balls about corners at Greville's abscissae of those; `real` are the real ones, where known."""
        found = []
        for number, (pivot, knots) in enumerate(self.pivots[wall]):
            own, p = replace(pivot, touch=touch), greville(knots, DEGREE)
            found.append(Turning(own, p, own.at(p, None if real is None else real[number].ball)))
        return found


def chosen_knots(blade: Blade, section: ClosedSection, balls: Mapping[str, Ball], *, fine: bool = False) -> FilletKnots:
    """The knots; raises DesignError where a ball does not touch blade and wall, or too many poles are needed."""
    try:
        return _held(blade, section, balls, fine=fine)
    except _TooManyPolesError as found:
        sites = Sites(side=np.repeat([UPPER, LOWER], len(LOOKED_AT)), u=np.tile(LOOKED_AT, 2))
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            check_fillets(blade, balls, Rolled.at(section, balls, sites))
        # one that needs few enough, by halves, and then as near below as poles tell
        low, high = 0.0, 1.0
        while high > max(NEAREST * low, LEAST_TRIED):
            share = 0.5 * (low + high)
            try:
                _held(blade, section, {wall: scaled(ball, share) for wall, ball in balls.items()}, fine=fine)
                low = share
            except DesignError:
                high = share
        if low == 0.0:
            raise
        sites = section.corner_sites.and_those(Sites(side=np.array([UPPER, LOWER]), u=np.array([0.5, 0.5])))
        sizes = {
            wall: [np.real(size) / blade.design.metre for size in ball.sizes(sites)] for wall, ball in balls.items()
        }
        holds = " and ".join(f"of {wall}_fillet {named(blade.design, own, low)}" for wall, own in sizes.items())
        raise DesignError(f"{found}; {holds}") from None


def _held(blade: Blade, section: ClosedSection, balls: Mapping[str, Ball], *, fine: bool) -> FilletKnots:
    plain = {face: surface.knots_u for face, surface in section.blunt.items()}
    # a curvature loses one derivative more than normals do
    across = ACROSS_EDGES - any(ball.curved for ball in balls.values())
    first = SectionSplines(
        knots=blade.sides[0].knots_u, smooth=section.smooth, blunt=FrozenMapping(plain), across=across
    )
    # balls that are far too large find no numbers, and are refused for it
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        rolled = Rolled.at(section, balls, first.sites)
        check_curvatures(rolled)
        check_fillets(blade, balls, rolled)
    tolerance = RESERVE * blade.tolerance * blade.chord
    side = blade.sides[0]
    strips = strips_for(
        {wall: touch.lines for wall, touch in rolled.touches.items()},
        {wall: ball.end for wall, ball in balls.items()},
        {wall: ball.curved for wall, ball in balls.items()},
        side.knots_v,
    )
    for wall, touch in rolled.touches.items():
        own = strips[wall].beside(replace(touch, found=touch.corners).lines, touch.corners.sites)
        own = own.unfolded(rolled.sites, touch.course(own))
        strips[wall] = own.with_side_knots(side.knots_v, np.real(touch.corners.v))
    step = max(1, len(rolled.sites) // (2 * LINES))
    few = Rolled.at(section, balls, rolled.sites.picked(np.arange(0, len(rolled.sites), step)), rolled.found)
    strips = {wall: _in_spans(strip, few.touches[wall], wall, tolerance) for wall, strip in strips.items()}
    off_wall = RESERVE * wall_tolerance(blade.chord, fine=fine)
    edges = [(strip.width, 1.0 - strip.width)[int(u)] for strip in strips.values() for _, u in section.corner_sides]
    joints = [(at, DEGREE - 1) for at in edges] + [(at, 0) for at in kinks(rolled)]
    splines = first.with_knots(UPPER, knots_with_joints(first.knots, DEGREE, joints))
    for face in (UPPER, *section.blunt):
        splines = _around(splines, face, rolled, strips, (tolerance, off_wall))
    pivots = {
        wall: tuple((pivot, _about(pivot, wall, side.knots_v, off_wall)) for pivot in pivots_of(touch))
        for wall, touch in rolled.touches.items()
    }
    near = FrozenMapping(rolled.found)
    low, high = levels(strips)
    inner = side.knots_v[(side.knots_v > low) & (side.knots_v < high)]
    v = clamped((inner - low) / (high - low))
    return FilletKnots(
        u=side.knots_u,
        v=v,
        before=blade.knots,
        strips=FrozenMapping(strips),
        near=near,
        splines=splines,
        pivots=FrozenMapping(pivots),
    )


def levels(strips: Mapping[str, Strip]) -> tuple[float, float]:
    """v at which the sides are cut, or end."""
    return strips["hub"].level if "hub" in strips else 0.0, strips["shroud"].level if "shroud" in strips else 1.0


def _in_spans(strip: Strip, few: Touch, wall: str, tolerance: float) -> Strip:
    """The strip with knots along w that hold a tolerance on some of its lines."""

    def miss(knots: Reals, at: Reals) -> Reals:
        own = replace(strip, knots=knots)
        net = own.net(few.start(own), few.above(own, own.sites), few.end(own))
        off = np.tensordot(basis(knots, DEGREE, at), net, axes=1) - few.above(own, at)
        return np.max(length(off), axis=1) / tolerance

    return replace(strip, knots=_reached(strip.knots, miss, "span", [wall]))


def _around(
    first: SectionSplines, face: int, rolled: Rolled, strips: Mapping[str, Strip], tolerances: tuple[float, float]
) -> SectionSplines:
    """The splines with the knots that both sides need, or the face of a blunt edge."""
    section, balls = rolled.section, {wall: touch.ball for wall, touch in rolled.touches.items()}
    known, faces = rolled, [UPPER, LOWER] if face == UPPER else [face]
    tolerance, off_wall = tolerances
    ends = {wall: _ends_at_corners(touch, faces) for wall, touch in rolled.touches.items()}

    def miss(knots: Reals, at: Reals) -> Reals:
        nonlocal known
        splines = first.with_knots(face, knots)
        known = Rolled.at(section, balls, splines.sites, known.found)
        between = Sites(side=np.repeat(faces, len(at)), u=np.tile(at, len(faces)))
        wanted = Rolled.at(section, balls, between, known.found)
        nets = [splines.nets[list(splines.knots_of).index(each)] for each in faces]

        def carried(values: Array, order: int = 0) -> Array:
            rows = basis(knots, DEGREE, at, order)
            return np.concatenate([np.tensordot(rows @ net, values, axes=1) for net in nets])

        error = np.zeros(len(between))
        for wall, touch in wanted.touches.items():
            strip, mine = strips[wall], known.touches[wall]
            made, exact = (np.swapaxes(each.above(strip, PLACES), 0, 1) for each in (mine, touch))
            off = np.max(length(carried(made) - exact), axis=1) / tolerance
            error = np.max([error, off, _missed(mine.sections, touch.sections, carried, off_wall)], axis=0)
            for number, end, normals in ends[wall]:
                points = np.swapaxes(mine.sections.points(ACROSS), 0, 1)
                along = np.tensordot(basis(knots, DEGREE, [end], 1)[0] @ nets[number], points, axes=1)
                place = number * len(at) + (len(at) - 1 if end else 0)
                error[place] = max(error[place], _tilt(along, normals))
            if section.corners:
                error = np.max([error, *_unlike(mine, touch, strip, carried)], axis=0)
        return np.max(error.reshape(len(faces), -1), axis=0)

    return first.with_knots(face, _reached(first.knots_of[face], miss, "chord", list(balls)))


def _ends_at_corners(touch: Touch, faces: list[int]) -> list[tuple[int, float, Reals]]:
    """The number of each face that ends at a pivot, u there, and the normals of the pivot's fillet."""
    found = []
    for pivot in pivots_of(touch):
        for (face, end), there, p in ((pivot.corner.first, pivot.first, 0.0), (pivot.corner.second, pivot.last, 1.0)):
            if there and face in faces and pivot.circular:
                found.append((faces.index(face), end, pivot.planes(p)))
    return found


def _about(pivot: Pivot, wall: str, plain: Reals, off_wall: float) -> Reals:
    """Knots of a pivot's fillet along the turn; the side's own `plain` ones along v where its line has them."""
    start, end = (float(np.real(v)) for v in pivot.line)
    levels, counts = np.unique(plain, return_counts=True)
    joints = [
        ((float(level) - start) / (end - start), DEGREE - int(count))
        for level, count in zip(levels, counts, strict=True)
        if not pivot.pole and min(start, end) < level < max(start, end)
    ]

    def miss(knots: Reals, at: Reals) -> Reals:
        sites = greville(knots, DEGREE)
        net = np.linalg.inv(basis(knots, DEGREE, sites))

        def carried(values: Array, order: int = 0) -> Array:
            return np.tensordot(basis(knots, DEGREE, at, order) @ net, values, axes=1)

        mine = pivot.at(sites).sections
        error = _missed(mine, pivot.at(at).sections, carried, off_wall)
        for p, normals in planes.items():
            along = np.tensordot(basis(knots, DEGREE, [p], 1)[0] @ net, np.swapaxes(mine.points(ACROSS), 0, 1), axes=1)
            error[-int(p)] = max(error[-int(p)], _tilt(along, normals))
        return error

    planes = {p: pivot.planes(p) for p in (0.0, 1.0) if pivot.circular}
    first = knots_with_joints(clamped(QUARTERS), DEGREE, joints)
    return _reached(first, miss, "chord", [wall])


def _tilt(along: Reals, planes: Reals) -> float:
    """The largest angle of vectors with planes of these normals, over what is allowed."""
    angles = np.abs(dot(unit(along), planes))  # real: knots come from the real design
    return float(np.max(angles)) / (RESERVE * ON_WALL)


def _missed(mine: CrossSections, theirs: CrossSections, carried: Callable[..., Array], off_wall: float) -> Reals:
    """How far carried cross-sections are from exact ones: from the wall, its tangent plane and the ball."""
    foot, normal = carried(mine.wall), theirs.normals[1]
    gap = np.abs(dot(foot - theirs.wall, normal))  # real: knots come from the real design
    plane = unit(cross(carried(mine.wall, 1), carried(mine.points(np.ones(1), 1)[0])))
    angle = length(cross(plane, normal)) / (RESERVE * ON_WALL)
    return np.max([gap / off_wall, angle, _off_ball(theirs, carried(mine.points(np.array([0.5]))[0]))], axis=0)


def _unlike(mine: Touch, theirs: Touch, strip: Strip, carried: Callable[..., Array]) -> list[Reals]:
    """Angles between tangent planes of a strip beside corners and of fillet and side, over what is allowed."""
    joint, leaving = carried(mine.sections.blade, 1), carried(mine.start(strip)[1])
    planes = [unit(cross(joint, each)) for each in (leaving, carried(mine.slope))]
    level = np.asarray(strip.level)
    normal = theirs.section.normal(theirs.found.sites, level)
    last = unit(carried(mine.end(strip)[1]))
    off_side = np.abs(dot(last, normal))  # real: knots come from the real design
    return [length(cross(*planes)) / (RESERVE * AT_JOINTS), off_side / (RESERVE * AT_JOINTS)]


def _reached(first: Reals, miss: Callable[[Reals, Reals], Reals], along: str, walls: Sequence[str]) -> Reals:
    """Knots refined from the first ones; raises DesignError where the limits are not held on them."""
    held: list[Reals] = []

    def seen(knots: Reals, at: Reals) -> Reals:
        errors = miss(knots, at)
        held[:] = [knots] if np.all(errors < 1.0) else []
        return errors

    knots = refined(first, seen, MOST_POLES[along == "span"])
    if held:
        return held[0]
    spans = np.unique(knots)
    places = (spans[1:] + spans[:-1]) / 2.0
    error = RESERVE * miss(knots, places)
    worst = int(np.argmax(error))
    if error[worst] > 1.0:
        name, given = "u" if along == "chord" else "v", " or ".join(f"{wall}_fillet" for wall in walls)
        poles, most = len(knots) - DEGREE - 1, MOST_POLES[along == "span"]
        why = f"at most {most} are used" if poles > most else "and more of them there do not help"
        raise _TooManyPolesError(
            f"{given}: near {name} = {places[worst]:.3f} native surfaces miss what is promised of "
            f"them {error[worst]:.2g} times with {poles} poles along the {along}, {why}: take a smaller fillet, raise "
            "the tolerance, or raise a very small edge radius there"
        )
    return knots


def _off_ball(sections: CrossSections, middle: Array) -> Reals:
    """Distance of points in the middle of cross-sections from the ball, over what is allowed."""
    away = length(middle - sections.centre) / length(sections.points(np.array([0.5]))[0] - sections.centre)
    return np.abs(away - 1.0) / (RESERVE * ON_BALL)  # real: knots come from the real design
