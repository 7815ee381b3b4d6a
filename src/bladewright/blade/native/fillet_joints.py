"""Where contacts lose derivatives: at joints of the sides, and where they cross those along v or of the walls."""

from __future__ import annotations

import numpy as np

from bladewright.blade.native.closed_section import FACES, LOWER, UPPER, Sites
from bladewright.blade.native.contacts import changes, rates
from bladewright.blade.native.cross_section import QuinticSections
from bladewright.blade.native.knots import DEGREE
from bladewright.blade.native.rolling_ball import Rolled, Touch
from bladewright.errors import DesignError
from bladewright.numerics.elementary import length, unit
from bladewright.nurbs.basis import Reals

KINK = 1e-4
"""Turn of a contact's way in one point that asks for a knot without derivatives [rad]: a few knots round smaller ones
within any tolerance, larger ones ask for a hundred."""
BESIDE = 1e-9
"""Distance in u from a joint at which that turn is looked at."""
APART = 1e-4
"""Least distance in u of such knots from each other and from edges: spans between are no narrower."""
STEPS = 5
"""Newton's steps to where a contact crosses a joint: from a linear guess four reach rounding."""
STEP_ALLOWED = 1e-6
"""Largest step of a fillet, of its ball's radius, where a curvature jumps that it takes on: what its distance from the
ball may be elsewhere."""
OF_MIDDLE = 1.0 / 64.0
"""How far the middle of a quintic cross-section moves with the second derivative at one of its ends."""


def kinks(rolled: Rolled) -> list[float]:
    """u at which contacts turn by more than KINK, where the curvature of a side or a wall jumps."""
    places = _places(rolled)
    if not len(places):
        return []
    turns = []
    for before, after in _beside(rolled, places).values():
        ways = [
            rates(each.section, each.ball.wall, each.found, each.ball.growth(each.found.sites))[:2]
            for each in (before, after)
        ]
        turns += [length(unit(second) - unit(first)) for first, second in zip(*ways, strict=True)]
    found: list[float] = []
    for u in places.u[np.max(turns, axis=0) > KINK]:
        if np.all(np.square(np.array([0.0, 1.0, *found]) - u) > APART**2):
            found.append(float(u))
    return found


def check_curvatures(rolled: Rolled) -> None:
    """Raise DesignError where a curvature jumps that a fillet takes on: it would have a step there."""
    if not any(touch.ball.curved for touch in rolled.touches.values()):
        return
    places = _places(rolled)
    if not len(places):
        return
    for wall, (before, after) in _beside(rolled, places).items():
        first, second = before.sections, after.sections
        if not isinstance(first, QuinticSections) or not isinstance(second, QuinticSections):
            continue
        for end, bends in enumerate(zip(first.bends, second.bends, strict=True)):
            steps = OF_MIDDLE * np.sqrt(np.square(bends[1] - bends[0])) / first.sizes[end]
            worst = int(np.argmax(steps))
            if steps[worst] > STEP_ALLOWED:
                side = FACES[places.side[worst]]
                curved = wall if end else f"{side} side"
                raise DesignError(
                    f"{wall}_fillet.kind is 'curvature': at u = {places.u[worst]:.3f} of the {side} side the curvature "
                    f"of the {curved} jumps, and the fillet that takes it on would have a step of {steps[worst]:.2g} "
                    f'of its radius, at most {STEP_ALLOWED:g} is allowed: take kind = "radius", or smooth the {curved}'
                )


def _places(rolled: Rolled) -> Sites:
    """Joints of both sides, and places where contacts cross joints."""
    joints = _joints(rolled.section.upper.knots_u, DEGREE)
    found = Sites(side=np.repeat([UPPER, LOWER], len(joints)), u=np.tile(joints, 2))
    for touch in rolled.touches.values():
        found = found.and_those(_crossings(touch))
    return found


def _joints(knots: Reals, degree: int) -> Reals:
    """Inner knots at which a spline has one continuous derivative at most."""
    places, counts = np.unique(knots, return_counts=True)
    return np.asarray(places[1:-1][counts[1:-1] >= max(1, degree - 1)])


def _crossings(touch: Touch) -> Sites:
    """Where on the sides a contact's v crosses joints of them, and its t those of the wall."""
    known, meridian = touch.found, touch.ball.wall.meridian
    levels = _joints(touch.section.upper.knots_v, DEGREE), _joints(meridian.knots, meridian.degree)
    brackets = []
    for face in (UPPER, LOWER):
        own = np.flatnonzero(known.sites.side == face)
        own = own[np.argsort(known.sites.u[own])]
        u = known.sites.u[own]
        for number, places in enumerate((known.v[own], known.t[own])):
            for level in levels[number]:
                past = places - level
                last = np.flatnonzero(past[:-1] * past[1:] < 0.0)
                first = u[last] - past[last] * (u[last + 1] - u[last]) / (past[last + 1] - past[last])
                brackets += [(face, number, level, *row) for row in zip(u[last], first, u[last + 1], strict=True)]
    if not brackets:
        return Sites(side=np.empty(0, dtype=np.intp), u=np.empty(0))
    side, number, level, low, u, high = np.array(brackets).T
    sites = Sites(side=side.astype(np.intp), u=u)
    for _ in range(STEPS):
        now = _at(touch, sites)
        rates_of_places = changes(now.section, now.ball.wall, now.found, now.ball.growth(sites))
        place, slope = (np.where(number == 0.0, *pair) for pair in ((now.found.v, now.found.t), rates_of_places.T[:2]))
        sites = sites.moved(np.clip(sites.u - (place - level) / slope, low, high))
    return sites


def _beside(rolled: Rolled, places: Sites) -> dict[str, tuple[Touch, Touch]]:
    """The balls before and after places, by the wall."""
    return {
        wall: (_at(touch, places.moved(places.u - BESIDE)), _at(touch, places.moved(places.u + BESIDE)))
        for wall, touch in rolled.touches.items()
    }


def _at(touch: Touch, sites: Sites) -> Touch:
    """The ball at other sites."""
    wall = "hub"
    return Rolled.at(touch.section, {wall: touch.ball}, sites, {wall: touch.found}).touches[wall]
