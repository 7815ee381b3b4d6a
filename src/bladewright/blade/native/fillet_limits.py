"""How large a fillet may be: what its ball must not do, and the largest radius at which it does not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.closed_section import FACES, OUTWARD, Sites
from bladewright.blade.native.contacts import rates
from bladewright.blade.native.pivot import REMEMBERED, Turning, feet, pivots_of
from bladewright.blade.native.rolling_ball import STEP, Ball, Rolled, Touch
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross, dot, length, unit
from bladewright.nurbs.basis import Reals
from bladewright.section.crossing import self_crossings, touching

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign

TOUCHING = 1e-9
"""Residual of the contacts, of the radius, below which a ball touches both."""
LEAST_LEFT = 0.1
"""Share of the span that must be left between a contact and the blade's other end, or the other fillet's contact."""
LEAST_ANGLE, MOST_ANGLE = np.radians((8.0, 172.0))
"""Angles between the normals of blade and wall at which there is a fillet to speak of [rad]."""
LEAST_PROGRESS = 0.02
"""How far a cross-section must move along the blade, of what the blade's own points do: at 0 the fillet folds."""
FARTHEST = 0.5
"""How far a foot may lie past the wall's own stretch, of that, where the wall has no end: its polynomials curl up."""
LEAST_BACK = 0.005
"""How far cross-sections about a corner may move backwards, of how far they move at most: at the end of a turn about a
point, where the line leans by 5 deg over the ball, they do so by that."""
TURNS = np.linspace(0.0, 1.0, 19)[1:-1]
"""Places on a ball's way about a corner that are looked at, besides its ends."""
SEARCHED = 14
"""Bisections of the largest radius: to 1e-4 of the one asked for, or of the chord."""
LEAST_SIZE = 1e-4
"""Smallest size of a fillet [chords], 0.01 mm of 100 mm: a tenth of it fails the round trip of the core rotor."""
NAMED = 0.999
"""Share of the largest radius that is named, so that it holds as it is printed."""


class Obstacle(NamedTuple):
    """Why a fillet does not hold, and where."""

    wall: str
    reason: str


def check_fillets(blade: Blade, balls: Mapping[str, Ball], rolled: Rolled) -> None:
    """Raise DesignError where a fillet does not hold, with the largest radius that does."""
    design, chord = blade.design, float(np.real(blade.chord))
    sizes = {
        wall: [np.real(size) / design.metre for size in (touch.found.on_blade, touch.found.on_wall)]
        for wall, touch in rolled.touches.items()
    }
    for wall, own in sizes.items():
        least = LEAST_SIZE * chord / design.metre
        if min(map(np.min, own)) < least:
            raise DesignError(
                f"{_asked(design, wall, own)}: at least {LEAST_SIZE:g} of the chord, {least:.3g} {design.length_unit}, "
                "is needed, since CAD programs lose narrower faces; take more, or leave the fillet out"
            )
    found = obstacle(blade, rolled)
    if found is None:
        return
    wall = found.wall
    # a ball as large as the blade holds nowhere
    most = max(map(np.max, sizes[wall])) * design.metre
    low, high, at_high = 0.0, min(1.0, chord / most), found
    for _ in range(SEARCHED):
        share = 0.5 * (low + high)
        smaller = {name: scaled(ball, share) if name == wall else ball for name, ball in balls.items()}
        met = obstacle(blade, Rolled.at(rolled.section, smaller, rolled.sites), at=wall)
        low, high, at_high = (share, high, at_high) if met is None else (low, share, met)
    cure = named(design, sizes[wall], low) if low else "no smaller one holds either: leave it out"
    raise DesignError(f"{_asked(design, wall, sizes[wall])}: {at_high.reason}; {cure}")


def check_folds(blade: Blade, balls: Mapping[str, Ball], rolled: Rolled) -> None:
    """Raise DesignError, as above, where a fillet folds between the places that were looked at first."""
    if any(_folding(blade, wall, touch, 0.0) for wall, touch in rolled.touches.items()):
        check_fillets(blade, balls, rolled)


def named(design: RowDesign, sizes: list[Reals], share: float) -> str:
    """The largest radius that holds, as a share of that which is asked for."""
    if _constant(sizes):
        return f"the largest that holds is {NAMED * share * max(map(np.max, sizes)):.4g} {design.length_unit}"
    return f"the largest that holds is {NAMED * share:.4g} of that"


def _asked(design: RowDesign, wall: str, sizes: list[Reals]) -> str:
    """The sizes that are asked for, by their keys."""
    most, least = (float(pick([pick(size) for size in sizes])) for pick in (np.max, np.min))
    # the centre of an ellipse lies unlike far from blade and wall
    name, ball = f"{wall}_fillet", np.array_equal(sizes[0], sizes[1])
    keys = f"{name}.radius is" if ball else f"{name}.on_blade and {name}.on_wall are"
    amount = f"{most:.6g}" if _constant(sizes) else f"{least:.4g} to {most:.4g}"
    return f"{keys} {amount} {design.length_unit}"


def _constant(sizes: list[Reals]) -> bool:
    return bool(min(map(np.min, sizes)) > (1.0 - 1e-9) * max(map(np.max, sizes)))


def scaled(ball: Ball, share: float) -> Ball:
    """A ball of the same law, smaller."""

    def sizes(sites: Sites) -> tuple[Array, Array]:
        on_blade, on_wall = ball.sizes(sites)
        return share * on_blade, share * on_wall

    return replace(ball, sizes=sizes)


def obstacle(blade: Blade, rolled: Rolled, *, at: str | None = None) -> Obstacle | None:
    """The first reason why fillets do not hold, or the one `at` a wall."""
    touches = {wall: touch for wall, touch in rolled.touches.items() if at in (None, wall)}
    for wall, touch in touches.items():
        for check in (_no_contact, _at_angle, _folding, _about_corners, _off_path):
            reason = check(blade, wall, touch)
            if reason is not None:
                return Obstacle(wall, reason)
    for wall, touch in touches.items():
        reason = _too_high(blade, wall, rolled) or _meeting(blade, wall, touch)
        if reason is not None:
            return Obstacle(wall, reason)
    return None


@lru_cache(maxsize=REMEMBERED)
def _turning(touch: Touch) -> tuple[Turning, ...]:
    """A ball about corners at the places that are looked at."""
    return tuple(Turning(pivot, TURNS, pivot.at(TURNS)) for pivot in pivots_of(touch))


def _place(sites: Sites, at: int) -> str:
    return place_named(FACES[sites.side[at]], float(np.real(sites.u[at])))


def place_named(name: str, u: float) -> str:
    """A place on a side, or at an edge or one of its corners, from the name of the side or of a pivot."""
    if name in ("upper", "lower"):
        return f"at u = {u:.3f} of the {name} side"
    edge, _, corner = name.removesuffix("_run").partition("_edge")
    return f"at the {corner.removeprefix('_')} corner of the {edge} edge" if corner else f"at the {edge} edge"


def _no_contact(blade: Blade, wall: str, touch: Touch) -> str | None:
    found = touch.found
    missing = ~(found.residual < TOUCHING)
    away = (1.0 - 2.0 * touch.ball.end) * (np.real(found.v) - touch.ball.end)
    # an arc's contact lies within the blade, but for rounding
    short = (away < 0.0) & (np.real(found.on_blade) != np.real(found.on_wall))
    if missing.any():
        return f"{_place(found.sites, int(np.argmax(missing)))} no ball of that radius touches blade and {wall}"
    if short.any():
        worst = int(np.argmin(np.where(short, away, 0.0)))
        meet = f"blade and {wall} meet at {_between(touch)[worst]:.0f} deg, where an ellipse whose axes are so unlike"
        return f"{_place(found.sites, worst)} {meet} touches the blade past its {wall}"
    if np.any(away > 1.0):
        name = blade.design.ends[1 if wall == "hub" else 0]
        return f"{_place(found.sites, int(np.argmax(away)))} the ball touches the blade past its {name}"
    return None


def _off_path(blade: Blade, wall: str, touch: Touch) -> str | None:
    low, high = touch.ball.wall.meridian.domain
    extent = blade.plain.exact.meridional_extent
    for foot in feet(touch, _turning(touch)):
        t = foot.near[1]
        for past, ahead, name in ((0, low - t, "start"), (1, t - high, "end")):
            allowed = FARTHEST * (high - low) if extent.path_end(past) is None else 0.0
            worst = int(np.argmax(ahead))
            if ahead[worst] > allowed:
                return f"{place_named(foot.name, foot.near[0][worst])} its foot lies past the {name} of the {wall}"
    return None


def _at_angle(blade: Blade, wall: str, touch: Touch) -> str | None:
    del blade
    angle = np.real(touch.sections.angle)
    for worst, wrong in ((int(np.argmin(angle)), angle < LEAST_ANGLE), (int(np.argmax(angle)), angle > MOST_ANGLE)):
        if wrong[worst]:
            meet = f"blade and {wall} meet at {_between(touch)[worst]:.0f} deg, which it cannot fill"
            return f"{_place(touch.found.sites, worst)} {meet}"
    return None


def _between(touch: Touch) -> Reals:
    """Angles (k,) between blade and wall [deg]."""
    return 180.0 - np.degrees(np.real(touch.sections.angle))


def _folding(blade: Blade, wall: str, touch: Touch, least: float = LEAST_PROGRESS) -> str | None:
    """Whether neighbouring cross-sections cross: a ball that is larger than the hollow that it rolls in."""
    del blade
    found, sections = touch.found, touch.sections
    growth = touch.ball.growth(found.sites)
    on_blade, on_wall, centre = rates(touch.section, touch.ball.wall, found, growth)
    normals = sections.normals
    along = unit(cross(*normals))
    forward = np.where(dot(along, on_blade) < 0.0, -1.0, 1.0)[:, None] * along
    size = length(on_blade)
    middle = 0.5 / np.cos(0.5 * sections.angle)[:, None]
    half = middle * on_blade + middle * on_wall + (1.0 - 2.0 * middle) * centre
    # all cross-sections run one way around the blade
    senses = np.where(dot(along, on_blade) < 0.0, -1.0, 1.0) * OUTWARD[found.sites.side]
    progress = np.min([dot(forward, each) / size for each in (on_wall, half)], axis=0)
    progress = np.where(senses == np.median(senses), progress, -1.0)
    worst = int(np.argmin(progress))
    if progress[worst] < least:
        return f"{_place(found.sites, worst)} it folds: the ball is larger than the hollow between blade and {wall}"
    return None


def _about_corners(blade: Blade, wall: str, touch: Touch) -> str | None:
    """Whether a ball that pivots about a corner finds no place, or its cross-sections cross."""
    del blade
    section = touch.section
    for corner in section.corners:
        sites = Sites(
            side=np.array([corner.first[0], corner.second[0]]), u=np.array([corner.first[1], corner.second[1]])
        )
        which = [np.argmax((touch.corners.sites.side == f) & (touch.corners.sites.u == u)) for f, u in corner[1:]]
        found = touch.corners.picked(np.array(which))
        towards = section.derivative(sites, found.v, 1, 0)[0] * (1.0 if corner.first[1] else -1.0)
        if dot(towards, section.normal(sites, found.v)[1]) <= 0.0:
            return f"{place_named(corner.name, 0.0)} the blade is hollow, and no ball turns about it"
    for pivot, p, real in _turning(touch):
        ball = pivot.at(p + 1j * STEP, real)
        if not np.all(ball.residual < TOUCHING):
            return f"{place_named(pivot.name, 0.0)} no ball of that radius touches the corner and {wall}"
        normals, angle = [np.real(normal) for normal in ball.sections.normals], np.real(ball.sections.angle)
        along = unit(cross(*normals))
        middle = 0.5 / np.cos(0.5 * angle)[:, None]
        top, centre, foot = (np.imag(each) for each in (ball.sections.blade, ball.sections.centre, ball.sections.wall))
        half = middle * top + middle * foot + (1.0 - 2.0 * middle) * centre
        forward = np.array([dot(along, each) for each in (foot, half)])
        sense = 1.0 if np.sum(forward[0]) > 0.0 else -1.0
        forward = forward * sense / np.max(np.square(forward)) ** 0.5
        if not np.min(forward) > -LEAST_BACK:
            return f"{place_named(pivot.name, 0.0)} it folds: the corner leans over the ball"
    return None


def _too_high(blade: Blade, wall: str, rolled: Rolled) -> str | None:
    """Whether too little of the span is left between the highest contacts."""
    away = {
        name: np.real((1.0 - 2.0 * touch.ball.end) * (touch.found.v - touch.ball.end))
        for name, touch in rolled.touches.items()
        # of another fillet that touches nothing, that is told when its turn comes
        if name == wall or _no_contact(blade, name, touch) is None
    }
    left = 1.0 - sum(float(np.max(each)) for each in away.values())
    if left >= LEAST_LEFT:
        return None
    other = "the other fillet" if len(away) > 1 else f"the {blade.design.ends[1 if wall == 'hub' else 0]}"
    at_most = f"only {left:.3f} of the span is left to {other}, {LEAST_LEFT:g} are needed"
    return f"{_place(rolled.sites, int(np.argmax(away[wall])))} {at_most}"


def _meeting(blade: Blade, wall: str, touch: Touch) -> str | None:
    """Whether its foot crosses itself, or the one of the neighbouring blade."""
    found, design = touch.found, blade.design
    chain = [
        (foot.name, np.stack(foot.near, axis=-1)[:: -1 if foot.against else 1]) for foot in feet(touch, _turning(touch))
    ]
    names = [name for name, near in chain for _ in near]
    places = np.concatenate([near for _, near in chain])
    foot = places[:, 1:]
    if self_crossings(foot[None]) is not None:
        return f"its foot on the {wall} crosses itself"
    spacing = float(np.real(np.ravel(design.spacing))[0])
    if touching(foot[None], spacing) is not None:
        scale = np.array(
            [float(np.mean(length(np.real(each)))) for each in touch.ball.wall.slopes(found.t, found.across)]
        )
        apart = length((foot[:, None] - foot - np.array([0.0, spacing])) * scale)
        nearest = int(np.argmin(np.min(apart, axis=1)))
        place = place_named(names[nearest], places[nearest, 0])
        return f"{place} it meets the fillet of the neighbouring blade on the {wall}"
    return None
