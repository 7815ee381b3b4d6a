"""Fillets of many blades that carry a complex step each, at once: what differs from blade to blade is side by side.

All of them have one real part. Where a ball touches one depends on its sides, its wall and its sizes near one site
only: so sites are those of one blade, as often as there are blades, and what is evaluated is the real blade at the
sites of one, and the steps of all as one surface of so many dimensions more.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache, partial
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.closed_section import ClosedSection, SectionSplines, Sites
from bladewright.blade.native.contacts import Contacts, Wall, slopes, stepped_contacts
from bladewright.blade.native.fillet import about_corners, around_wall, cut_sides, filleted
from bladewright.blade.native.fillet_knots import FilletKnots
from bladewright.blade.native.lazy_faces import LazyFaces
from bladewright.blade.native.native_edges import with_native_edges
from bladewright.blade.native.rolling_ball import (
    Ball,
    Rolled,
    Touch,
    balls_of,
    closed_section,
    section_like,
    with_poles,
)
from bladewright.blade.native.strip import Course, Leaving, Strip
from bladewright.frozen import FrozenMapping, FrozenRecord
from bladewright.numerics.elementary import Array
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign


def _one(values: Array, count: int) -> Array:
    """The real part (..., k) at the sites of one blade, of values (..., count k)."""
    return np.real(values[..., : values.shape[-1] // count])


def _all(values: Array, count: int) -> Array:
    """Values (..., count k, d) at the sites of all blades, from those (..., k, d) of one."""
    return np.concatenate([values] * count, axis=-2)


def _apart(values: Array, count: int) -> Array:
    """Values (..., count k, d) of blades, from those (..., k, count d) side by side."""
    return np.concatenate(np.split(values, count, axis=-1), axis=-2)


def _beside(values: Array, count: int) -> Array:
    """Values (..., k, count d) side by side, from those (..., count k, d) of blades."""
    return np.concatenate(np.split(values, count, axis=-2), axis=-1)


@dataclass(frozen=True, kw_only=True, eq=False)
class SteppedSection(ClosedSection):
    """The section of the real blade with the steps of `count` blades."""

    steps: ClosedSection | None
    """their imaginary parts, with surfaces of 3 `count` dimensions; None where they are left out"""
    count: int

    @property
    def stepped(self) -> bool:
        return self.steps is not None

    def real(self) -> SteppedSection:
        return replace(self, steps=None)

    def derivatives(self, sites: Sites, v: Array, *orders: tuple[int, int]) -> list[Array]:
        side, u, v = np.broadcast_arrays(sites.side, sites.u, v)
        at, height = Sites(side=_one(side, self.count), u=_one(u, self.count)), _one(v, self.count)
        moving = {(1, 0): u, (0, 1): v} if self.steps is not None else {}
        moving = {way: np.imag(place)[..., None] for way, place in moving.items() if np.iscomplexobj(place)}
        wanted = list(orders)
        wanted += [(du + way[0], dv + way[1]) for du, dv in orders for way in moving]
        wanted = list(dict.fromkeys(wanted))
        known = dict(zip(wanted, super().derivatives(at, height, *wanted), strict=True))
        if self.steps is None:
            return [_all(known[order], self.count) for order in orders]
        found = []
        for (du, dv), steps in zip(orders, self.steps.derivatives(at, height, *orders), strict=True):
            step = _apart(steps, self.count)
            for way, size in moving.items():
                step = step + size * _all(known[du + way[0], dv + way[1]], self.count)
            found.append(_all(known[du, dv], self.count) + 1j * step)
        return found


@dataclass(frozen=True, kw_only=True, eq=False)
class SteppedWall(Wall):
    """The same of a wall."""

    steps: Curve | None
    """of 2 `count` dimensions"""
    count: int

    @property
    def stepped(self) -> bool:
        return self.steps is not None

    def real(self) -> SteppedWall:
        return replace(self, steps=None)

    def line(self, t: Array, order: int = 0) -> Array:
        at = _one(t, self.count)
        found = _all(super().line(at, order), self.count)
        if self.steps is None:
            return found
        step = _apart(self.steps.derivative(at, order), self.count)
        if np.iscomplexobj(t):
            step = step + np.imag(t)[..., None] * _all(super().line(at, order + 1), self.count)
        return found + 1j * step


@dataclass(frozen=True, kw_only=True, eq=False)
class StepsTouch(Touch):
    """Balls of `count` blades, at sites and corners of all of them, one blade after another."""

    count: int

    def course(self, strip: Strip) -> Course:
        if not self.section.corners:
            return super().course(strip)
        lines, at_corners = self._by_blade(self.lines), self._by_blade(self.lines_at_corners)
        sites, corner_sites = (_of_one(found.sites, self.count) for found in (self.found, self.corners))
        course = strip.course(sites, lines, at_corners, corner_sites)
        return Course(**{each.name: np.ravel(getattr(course, each.name)) for each in fields(course)})

    def _by_blade(self, lines: Leaving) -> Leaving:
        """With a leading axis of blades."""
        return Leaving(**{each.name: np.reshape(getattr(lines, each.name), (self.count, -1)) for each in fields(lines)})


@dataclass(frozen=True, kw_only=True, eq=False)
class SteppedTouch(FrozenRecord):
    """The steps of what a touch gives, with those of all blades side by side in so many dimensions more."""

    touch: StepsTouch
    section: ClosedSection
    """the steps of the sides"""

    def net(self) -> Array:
        """Those of the cross-sections' control points (n, k, 3 count)."""
        return self._steps(self.touch.net())

    def above(self, strip: Strip, w: Array) -> Array:
        """Those of points of the strip (len(w), k, 3 count)."""
        return self._steps(self.touch.above(strip, w))

    def start(self, strip: Strip) -> list[Array]:
        """Those of where the strip starts, and of its derivatives (k, 3 count)."""
        return [self._steps(each) for each in self.touch.start(strip)]

    def end(self, strip: Strip) -> list[Array]:
        """Those of where the strip ends, and of its first two derivatives (k, 3 count)."""
        return [self._steps(each) for each in self.touch.end(strip)]

    def _steps(self, values: Array) -> Array:
        return _beside(np.imag(values), self.touch.count)


@dataclass(frozen=True, kw_only=True, eq=False)
class RealTouch(FrozenRecord):
    """A ball of the real blade at sites and corners, and what one of Newton's steps from there needs."""

    touch: Touch
    everywhere: Contacts
    """at the sites, and then at the corners"""
    slopes: Array
    """(k, 3, 3) there"""

    @classmethod
    def of(cls, touch: Touch) -> RealTouch:
        """Those of a touch."""
        both = touch.found.and_those(touch.corners)
        return cls(touch=touch, everywhere=both, slopes=slopes(touch.section, touch.ball.wall, both))

    def stepped(self, sections: ClosedSection, balls: Sequence[Ball]) -> SteppedTouch:
        """The balls of blades that carry a step, `sections` their steps side by side."""
        section, first, count = self.touch.section, self.touch.ball.wall, len(balls)
        lines = [np.imag(ball.wall.meridian.control_points) for ball in balls]
        wall = SteppedWall(
            meridian=first.meridian,
            revolved=first.revolved,
            inward=first.inward,
            steps=replace(first.meridian, control_points=np.concatenate(lines, axis=-1)),
            count=count,
        )
        own = SteppedSection(
            upper=section.upper,
            lower=section.lower,
            smooth=section.smooth,
            blunt=section.blunt,
            steps=sections,
            count=count,
        )
        one = len(self.everywhere.sites)
        all_of_them = self.everywhere.picked(np.tile(np.arange(one), count))
        ball = replace(self.touch.ball, wall=wall, sizes=partial(_sizes, balls))
        sizes, repeated = ball.sizes(all_of_them.sites), np.tile(self.slopes, (count, 1, 1))
        touched = with_poles(section, stepped_contacts(own, wall, all_of_them, sizes, repeated), count)
        here, corners = np.split(np.arange(count * one).reshape(count, one), [len(self.touch.found.sites)], axis=1)
        touch = StepsTouch(
            ball=ball,
            section=own,
            found=touched.picked(here.ravel()),
            corners=touched.picked(corners.ravel()),
            count=count,
        )
        return SteppedTouch(touch=touch, section=sections)


def _sizes(balls: Sequence[Ball], sites: Sites) -> tuple[Array, Array]:
    """Those of all balls at the sites of all blades."""
    one = _of_one(sites, len(balls))
    on_blade, on_wall = zip(*(ball.sizes(one) for ball in balls), strict=True)
    return np.concatenate(on_blade), np.concatenate(on_wall)


def _of_one(sites: Sites, count: int) -> Sites:
    """The sites of one blade."""
    return sites.picked(np.arange(len(sites) // count))


def _together(sections: Sequence[ClosedSection], like: ClosedSection) -> ClosedSection:
    """The steps of sections side by side."""

    def side_by_side(face: int) -> Surface:
        nets = [np.imag(each.faces[face].control_points) for each in sections]
        return replace(like.faces[face], control_points=np.concatenate(nets, axis=-1))

    faces = {face: side_by_side(face) for face in like.faces}
    upper, lower = faces.pop(0), faces.pop(1)
    return replace(like, upper=upper, lower=lower, blunt=FrozenMapping(faces))


class SteppedFillets:
    """Lays the fillets of a blade into others that carry a step, at its knots."""

    def __init__(self, base: Blade) -> None:
        self.base, self.knots = base, cast(FilletKnots, base.knots)
        whole = with_native_edges(cast(Blade, base.before))
        self.section = closed_section(whole)
        self.balls = balls_of(whole, self.section, base.design)
        sites = cast(SectionSplines, self.knots.splines).sites
        real = Rolled.at(self.section, self.balls, sites, self.knots.near)
        self.touches = {wall: RealTouch.of(touch) for wall, touch in real.touches.items()}
        self.turning = {wall: self.knots.turning(wall, touch) for wall, touch in real.touches.items()}

    def __call__(self, blades: Sequence[Blade], designs: Sequence[RowDesign]) -> list[Blade]:
        """The blades of designs, each from the blade before it. Ends are made when one is first used."""
        base, knots, count = self.base, self.knots, len(blades)
        wholes = [with_native_edges(blade) for blade in blades]
        sections = [section_like(self.section, blade) for blade in wholes]
        balls = [balls_of(*each, self.balls) for each in zip(wholes, sections, designs, strict=True)]
        together = _together(sections, self.section)
        touches = {wall: touch.stepped(together, [own[wall] for own in balls]) for wall, touch in self.touches.items()}
        steps = cut_sides(together, knots)
        for wall, touch in touches.items():
            steps |= around_wall(wall, touch, knots)
        nets = {name: np.split(face.control_points, count, axis=-1) for name, face in steps.items()}
        found = []
        for number, (blade, design) in enumerate(zip(blades, designs, strict=True)):
            faces = {name: _with_steps(base, name, each[number]) for name, each in nets.items()}
            for wall, pivots in self.turning.items():
                if not pivots:
                    continue
                corners = touches[wall].touch.corners
                at_corners = corners.picked(np.split(np.arange(len(corners.sites)), count)[number])
                mine = Touch(ball=balls[number][wall], section=sections[number], found=at_corners, corners=at_corners)
                about = about_corners(wall, knots, knots.turning(wall, mine, pivots), faces)
                faces |= {name: _with_steps(base, name, np.imag(face.control_points)) for name, face in about.items()}
            finished = cache(partial(filleted, blade, design, knots))
            found.append(
                replace(
                    base,
                    design=design,
                    surfaces=LazyFaces(faces, tuple(base.surfaces), partial(_of, finished, "surfaces")),
                    exact=blade.exact,
                    before=blade,
                    moments=None,
                    outlines=LazyFaces({}, tuple(base.outlines), partial(_of, finished, "outlines")),
                    walls=LazyFaces({}, tuple(base.walls), partial(_of, finished, "walls")),
                )
            )
        return found


def _with_steps(base: Blade, name: str, steps: Array) -> Surface:
    face = cast(Surface, base.surfaces[name])
    net = face.control_points.astype(np.complex128)
    net.imag = steps
    return replace(face, control_points=net)


def _of(whole: Callable[[], Blade], name: str) -> Mapping[str, Any]:
    return cast(Mapping[str, Any], getattr(whole(), name))
