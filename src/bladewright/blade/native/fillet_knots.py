"""Knots with which fillets and the strips above them hold what is promised."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.closed_section import ClosedSection, SectionSplines, Sites
from bladewright.blade.native.contacts import Contacts
from bladewright.blade.native.end_faces import EndKnots
from bladewright.blade.native.fillet_limits import check_fillets
from bladewright.blade.native.knots import DEGREE, Knots, clamped, refined
from bladewright.blade.native.refinement import RESERVE, wall_tolerance
from bladewright.blade.native.rolling_ball import Ball, Rolled, Touch
from bladewright.blade.native.strip import Strip, strips_for
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array, cross, dot, length, unit
from bladewright.nurbs.basis import Reals, basis

ON_BALL = 1e-6
"""Largest distance of a fillet from its ball, of the ball's radius."""
ON_WALL = 1e-6
"""Largest angle between the tangent planes of fillet and wall at the foot [rad]."""
MOST_POLES = (300, 60)
"""Control points of fillets around the blade, on one side, and of strips along w at which knots are added no more: half
as many again as a plain blade may have, for what the foot asks for, and twice what a strip of any example has."""
LINES = 12
"""About how many lines of a strip are looked at on each side for its knots along them."""
PLACES = np.array([0.0, 0.2, 0.5])
"""w of the strips at which knots around the blade are looked at: at 1 they have those of the side."""


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


def chosen_knots(blade: Blade, section: ClosedSection, balls: Mapping[str, Ball], *, fine: bool = False) -> FilletKnots:
    """The knots; raises DesignError where a ball does not touch blade and wall."""
    first = SectionSplines(knots=blade.knots.u, smooth=section.smooth)
    # balls that are far too large find no numbers, and are refused for it
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        rolled = Rolled.at(section, balls, first.sites)
        check_fillets(blade, balls, rolled)
    tolerance = RESERVE * blade.tolerance * blade.chord
    side = blade.sides[0]
    strips = strips_for(
        rolled.sites,
        {wall: touch.lines for wall, touch in rolled.touches.items()},
        {wall: ball.end for wall, ball in balls.items()},
        {wall: ball.curved for wall, ball in balls.items()},
        side.knots_v,
    )
    step = max(1, len(rolled.sites) // (2 * LINES))
    few = Rolled.at(section, balls, rolled.sites.picked(np.arange(0, len(rolled.sites), step)), rolled.found)
    strips = {wall: _in_spans(strip, few.touches[wall], wall, tolerance) for wall, strip in strips.items()}
    off_wall = RESERVE * wall_tolerance(blade.chord, fine=fine)
    u = _around(side.knots_u, rolled, strips, tolerance, off_wall)
    splines = SectionSplines(knots=u, smooth=section.smooth)
    near = FrozenMapping(rolled.found)
    low, high = levels(strips)
    inner = side.knots_v[(side.knots_v > low) & (side.knots_v < high)]
    v = clamped((inner - low) / (high - low))
    return FilletKnots(
        u=side.knots_u, v=v, before=blade.knots, strips=FrozenMapping(strips), near=near, splines=splines
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

    return replace(strip, knots=_reached(refined(strip.knots, miss, MOST_POLES[1]), miss, "span", [wall]))


def _around(plain: Reals, rolled: Rolled, strips: Mapping[str, Strip], tolerance: float, off_wall: float) -> Reals:
    """Knots around the blade."""
    section, balls = rolled.section, {wall: touch.ball for wall, touch in rolled.touches.items()}
    known = rolled

    def miss(knots: Reals, at: Reals) -> Reals:
        nonlocal known
        splines = SectionSplines(knots=knots, smooth=section.smooth)
        known = Rolled.at(section, balls, splines.sites, known.found)
        between = Sites(side=np.repeat([0, 1], len(at)), u=np.tile(at, 2))
        wanted = Rolled.at(section, balls, between, known.found)

        def carried(values: Array, order: int = 0) -> Array:
            rows = basis(knots, DEGREE, at, order)
            return np.concatenate([np.tensordot(rows, net, axes=1) for net in splines.split(values)])

        error = np.zeros(len(between))
        for wall, touch in wanted.touches.items():
            made, exact = (
                np.swapaxes(each.touches[wall].above(strips[wall], PLACES), 0, 1) for each in (known, wanted)
            )
            mine, theirs = known.touches[wall].sections, touch.sections
            foot, normal = carried(mine.wall), theirs.normals[1]
            gap = np.abs(dot(foot - theirs.wall, normal))  # real: knots come from the real design
            plane = unit(cross(carried(mine.wall, 1), carried(mine.points(np.ones(1), 1)[0])))
            middle = carried(mine.points(np.array([0.5]))[0])
            off = np.max(length(carried(made) - exact), axis=1) / tolerance
            angle = length(cross(plane, normal)) / (RESERVE * ON_WALL)
            error = np.max([error, off, gap / off_wall, angle, _off_ball(touch, middle)], axis=0)
        return np.maximum(error[: len(at)], error[len(at) :])

    return _reached(refined(plain, miss, MOST_POLES[0]), miss, "chord", list(balls))


def _reached(knots: Reals, miss: Callable[[Reals, Reals], Reals], along: str, walls: Sequence[str]) -> Reals:
    """The knots; raises DesignError where the limits are not held on them."""
    spans = np.unique(knots)
    places = (spans[1:] + spans[:-1]) / 2.0
    error = RESERVE * miss(knots, places)
    worst = int(np.argmax(error))
    if error[worst] > 1.0:
        name, given = "u" if along == "chord" else "v", " or ".join(f"{wall}_fillet" for wall in walls)
        raise DesignError(
            f"{given}: near {name} = {places[worst]:.3f} native surfaces miss what is promised of "
            f"them {error[worst]:.2g} times with {len(knots) - DEGREE - 1} poles along the {along}, at most "
            f"{MOST_POLES[along == 'span']} are used: take a smaller fillet, raise the tolerance, or raise a very "
            "small edge radius there"
        )
    return knots


def _off_ball(touch: Touch, middle: Array) -> Reals:
    """Distance of points in the middle of cross-sections from the ball, over what is allowed."""
    away = length(middle - touch.sections.centre) / length(
        touch.sections.points(np.array([0.5]))[0] - touch.sections.centre
    )
    return np.abs(away - 1.0) / (RESERVE * ON_BALL)  # real: knots come from the real design
