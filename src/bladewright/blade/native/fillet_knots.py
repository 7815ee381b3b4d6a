"""Knots with which fillets and the blade above them hold what is promised."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from bladewright.blade.native.above_fillet import Joint, Joints, SpanSplines, first_knots, joints_for
from bladewright.blade.native.blade import Blade
from bladewright.blade.native.closed_section import ClosedSection, SectionSplines, Sites
from bladewright.blade.native.contacts import Contacts
from bladewright.blade.native.end_faces import EndKnots
from bladewright.blade.native.fillet_limits import check_fillets
from bladewright.blade.native.knots import DEGREE, Knots, refined
from bladewright.blade.native.refinement import RESERVE, wall_tolerance
from bladewright.blade.native.rolling_ball import Ball, Rolled, Touch, orders_of
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array, cross, dot, length, unit
from bladewright.nurbs.basis import Reals, basis

ON_BALL = 1e-6
"""Largest distance of a fillet from its ball, of the ball's radius."""
ON_WALL = 1e-6
"""Largest angle between the tangent planes of fillet and wall at the foot [rad]."""
MOST_POLES = (300, 150)
"""Control points of a side above its fillets along u and v at which knots are added no more: half as many again as a
plain blade may have, for what the foot asks for along u and two joints along v."""
LINES = 12
"""About how many lines along the span are looked at on each side for the knots there."""
LEVELS = (0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.7)
"""Shares of the part in which lines bend, at which knots around the blade are looked at."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FilletKnots(Knots):
    """Knots of the sides above fillets, and what else derivatives hold."""

    joints: Mapping[str, Joint] = field(default_factory=lambda: FrozenMapping({}))
    """how lines leave each fillet, by the wall"""
    ends: Mapping[str, EndKnots] = field(default_factory=lambda: FrozenMapping({}))
    """of the end faces inside the feet"""
    near: Mapping[str, Contacts] = field(default_factory=lambda: FrozenMapping({}))
    """contacts by the wall, near which others are sought"""
    splines: SectionSplines | None = None
    """around the blade, on `u`"""


def chosen_knots(blade: Blade, section: ClosedSection, balls: Mapping[str, Ball], *, fine: bool = False) -> FilletKnots:
    """The knots; raises DesignError where a ball does not touch blade and wall."""
    first = SectionSplines(knots=blade.knots.u, smooth=section.smooth)
    # balls that are far too large find no numbers, and are refused for it
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        rolled = Rolled.at(section, balls, first.sites)
        check_fillets(blade, balls, rolled)
    joints = joints_for(rolled.sites, {wall: touch.lines for wall, touch in rolled.touches.items()})
    tolerance = RESERVE * blade.tolerance * blade.chord
    v = _along_span(blade.knots.v, rolled, balls, joints, tolerance)
    off_wall = RESERVE * wall_tolerance(blade.chord, fine=fine)
    u = _around(blade.knots.u, rolled, balls, joints, tolerance, off_wall)
    splines = SectionSplines(knots=u, smooth=section.smooth)
    near = FrozenMapping(rolled.found)
    return FilletKnots(u=u, v=v, before=blade.knots, joints=FrozenMapping(joints), near=near, splines=splines)


def _along_span(plain: Reals, rolled: Rolled, balls: Mapping[str, Ball], joints: Joints, tolerance: float) -> Reals:
    step = max(1, len(rolled.sites) // (2 * LINES))
    few = Rolled.at(rolled.section, balls, rolled.sites.picked(np.arange(0, len(rolled.sites), step)), rolled.found)

    def miss(knots: Reals, at: Reals) -> Reals:
        splines = SpanSplines(knots=knots, orders=orders_of(balls))
        net = splines.net(few.above(joints, splines.sites), few.derivatives(joints))
        off = np.tensordot(basis(knots, DEGREE, at), net, axes=1) - few.above(joints, at)
        return np.max(length(off), axis=1) / tolerance

    return _reached(refined(first_knots(plain, joints), miss, MOST_POLES[1]), miss, "span", balls)


def _around(
    plain: Reals, rolled: Rolled, balls: Mapping[str, Ball], joints: Joints, tolerance: float, off_wall: float
) -> Reals:
    section, levels = rolled.section, _levels(joints)
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

        made, exact = (np.swapaxes(each.above(joints, levels), 0, 1) for each in (known, wanted))
        error = np.max(length(carried(made) - exact), axis=1) / tolerance
        for wall, touch in wanted.touches.items():
            mine, theirs = known.touches[wall].sections, touch.sections
            foot, normal = carried(mine.wall), theirs.normals[1]
            gap = np.abs(dot(foot - theirs.wall, normal))  # real: knots come from the real design
            plane = unit(cross(carried(mine.wall, 1), carried(mine.points(np.ones(1), 1)[0])))
            middle = carried(mine.points(np.array([0.5]))[0])
            errors = [gap / off_wall, length(cross(plane, normal)) / (RESERVE * ON_WALL), _off_ball(touch, middle)]
            error = np.max([error, *errors], axis=0)
        return np.maximum(error[: len(at)], error[len(at) :])

    return _reached(refined(plain, miss, MOST_POLES[0]), miss, "chord", balls)


def _reached(knots: Reals, miss: Callable[[Reals, Reals], Reals], along: str, balls: Mapping[str, Ball]) -> Reals:
    """The knots; raises DesignError where the limits are not held on them."""
    spans = np.unique(knots)
    places = (spans[1:] + spans[:-1]) / 2.0
    error = RESERVE * miss(knots, places)
    worst = int(np.argmax(error))
    if error[worst] > 1.0:
        name, given = "u" if along == "chord" else "v", " or ".join(f"{wall}_fillet" for wall in balls)
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


def _levels(joints: Joints) -> Reals:
    bent = {wall: joint.bent * np.array(LEVELS) for wall, joint in joints.items()}
    return np.unique(np.concatenate([x if wall == "hub" else 1.0 - x for wall, x in bent.items()]))
