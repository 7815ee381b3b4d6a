"""The fillet at a corner of a blade: there the ball turns about the corner from one face to the other.

With C(v) the corner's line, n the unit vector from it to the ball's centre K, and H the wall, the ball touches both
where

    K = C(v) + a n = H(t, theta) + b n_H,   n . C' = 0,

n turning from the normal of one face to that of the other. Its contact v goes from that on the one face, c, to that on
the other, d. Where v rises or falls all the way, the ball *runs* along the line, and the fillet's parameter is v. Where
it goes past d and returns, or comes back past c, the line leans to the ball or away from it: the fillet would fold, or
end in a cusp. So the ball runs until it touches C(d), and from there *turns* about that point, n even in angle,

    |K - C(d)| = a,   (K - C(d)) . (C' x m) = 0,   m between where it came from and the other face's normal,

or first turns about C(c) and then runs. At either end of such a turn n . C' = 0, so that all its neighbours have its
tangent planes. Where the line stands nearly upright on the wall the ball only turns, v going evenly from c to d.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from bladewright.blade.native.closed_section import FACES, LEADING, Corner, Sites
from bladewright.blade.native.contacts import Wall
from bladewright.blade.native.cross_section import ConicSections, CrossSections, QuinticSections
from bladewright.blade.native.rolling_ball import STEP, Touch, bend_of_wall
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, cross, dot, length, unit
from bladewright.nurbs.basis import Reals

STEPS = 30
"""Newton's steps for the ball's place: four to six reach rounding."""
SETTLED = 1e-12
"""Residual, of the radius, at which it is found."""
UPRIGHT = 0.08
"""Largest cosine of the angle between corner and radius at which the ball only turns, c and d apart or not: the corner
is then no deeper in the ball than 0.3 % of the radius, on lines that lean by up to some 6 deg."""
REMEMBERED = 8
"""Touches and corners whose ways are remembered: they are asked for again at once, by limits, knots and faces."""
ACROSS = np.array([0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0])
"""Places on cross-sections, from the corner to the wall, at which planes are compared."""
LOOKED_AT = np.linspace(0.0, 1.0, 65)
"""Shares of the turn at which it is seen how the contact moves."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Turned(FrozenRecord):
    """A ball at places (k,) of its way about a corner."""

    v: Array
    """where it touches the corner's line"""
    t: Array
    """of the wall's meridian, below it"""
    across: Array
    """theta or y there"""
    sections: CrossSections
    residual: Reals


@dataclass(frozen=True, kw_only=True, eq=False)
class Pivot(FrozenRecord):
    """A part of a ball's way about a corner of the section: it runs along the corner's line, or turns about a point."""

    touch: Touch
    corner: Corner
    runs: bool
    first: bool
    """whether it begins at the first face of the corner"""
    last: bool
    """whether it ends at the second"""

    @property
    def name(self) -> str:
        """That of the corner, with `_run` where the ball runs and also turns."""
        return self.corner.name if not self.runs or (self.first and self.last) else f"{self.corner.name}_run"

    @property
    def pole(self) -> bool:
        """Whether the ball turns about a point."""
        return not self.runs and bool(self.line[0] == self.line[1])

    @property
    def circular(self) -> bool:
        """Whether cross-sections are arcs of the ball: others promise no distance from it, nor planes inside."""
        corners = self.touch.corners
        return not self.touch.ball.curved and bool(np.array_equal(corners.on_blade, corners.on_wall))

    @cached_property
    def contacts(self) -> tuple[Array, Array]:
        """c and d."""
        first = _ends(self.touch, self.corner)
        return self.touch.corners.v[first], self.touch.corners.v[first + 1]

    @cached_property
    def line(self) -> tuple[Array, Array]:
        """v at both ends of this part."""
        c, d = self.contacts
        if self.runs or (self.first and self.last):
            return c, d
        return (c, c) if self.first else (d, d)

    @cached_property
    def _normals(self) -> tuple[Array, Array]:
        """n (1, 3) at both ends of a turn."""
        section, (c, d) = self.touch.section, self.line
        start, end = (
            section.normal(_along(pair, 1), np.array([v]))
            for pair, v in ((self.corner.first, c), (self.corner.second, d))
        )
        if self.first and self.last:
            return start, end
        run = replace(self, runs=True, first=not self.first, last=not self.last)
        met = run.at(np.array([1.0 if self.last else 0.0])).sections.normals[0]
        return (met, end) if self.last else (start, met)

    def at(self, p: Array, real: Turned | None = None) -> Turned:
        """The ball at p (k,) from 0 at the beginning of this part to 1 at its end; `real` is the real one, where known.

        Without it, one is sought.
        """
        section, wall = self.touch.section, self.touch.ball.wall
        first = _ends(self.touch, self.corner)
        v = _between(*self.line, p)
        point, line = section.derivatives(_along(self.corner.first, len(p)), v, (0, 0), (0, 1))
        corners = self.touch.corners
        on_blade, on_wall = (_between(size[first], size[first + 1], p) for size in (corners.on_blade, corners.on_wall))
        if self.runs:
            aside = unit(line)
        else:
            towards = turned(*self._normals, p) if self.pole else self._even(v, p)
            aside = unit(cross(line, towards))
        if real is not None:
            start = real.t, real.across
        else:
            near = self._near(np.real(v)) if self.runs else np.real(point + on_blade[:, None] * towards)
            start = wall.real().places_below(near)
        found, residual = settled(wall, (point, aside, on_blade, on_wall), start)
        t, across = found[:, 0], found[:, 1]
        about = np.real(corners.across[first] - across[0])
        across = across + 2.0 * np.pi * np.round(about / (2.0 * np.pi)) if wall.revolved else across
        centre = wall.point(t, across) + on_wall[:, None] * wall.normal(t, across)
        conics = ConicSections(
            blade=point,
            wall=wall.point(t, across),
            normals=(unit(centre - point), wall.normal(t, across)),
            centre=centre,
            sizes=(on_blade, on_wall),
        )
        sections = self._curved(conics, t, across, p) if self.touch.ball.curved else conics
        return Turned(v=v, t=t, across=across, sections=sections, residual=residual)

    def upright(self) -> bool:
        """Whether a real ball that turns evenly all the way keeps across the corner's line but for UPRIGHT."""
        ball = self.at(LOOKED_AT[1:-1])
        line = unit(np.real(self.touch.section.derivative(_along(self.corner.first, len(ball.v)), ball.v, 0, 1)))
        return bool(np.max(np.square(dot(np.real(ball.sections.normals[0]), line))) < UPRIGHT**2)

    def planes(self, p: float) -> Reals:
        """Unit normals (len(ACROSS), 3) of the real fillet along its cross-section at p."""
        sections = self.at(np.array([p]) + 1j * STEP).sections
        points, slopes = (sections.points(ACROSS, order)[:, 0] for order in (0, 1))
        return unit(cross(np.imag(points) / STEP, np.real(slopes)))

    def _even(self, v: Array, p: Array) -> Array:
        """m (k, 3) between the normals of both faces along the corner."""
        section = self.touch.section
        start, end = (section.normal(_along(pair, len(p)), v) for pair in (self.corner.first, self.corner.second))
        return turned(start, end, p)

    def _near(self, v: Reals) -> Reals:
        """Centres (k, 3) near those of a ball that runs, at v."""
        known, centres = way(self.touch, self.corner)
        within = _branch(known, self.last)
        order = within[np.argsort(known[within])]
        return np.stack([np.interp(v, known[order], centres[order, k]) for k in range(3)], axis=-1)

    def _curved(self, conics: ConicSections, t: Array, across: Array, p: Array) -> CrossSections:
        """With the curvatures of the wall at one end, and at the other what both faces have at the corner between."""
        at_corners = cast(QuinticSections, replace(self.touch, found=self.touch.corners).sections)
        faces, first = at_corners.bends[0], _ends(self.touch, self.corner)
        low, high = 0.0 if self.first else 0.5, 1.0 if self.last else 0.5
        between = _between(faces[first], faces[first + 1], low + (high - low) * p)
        return conics.curved(lambda _: between, lambda slope: bend_of_wall(self.touch.ball.wall, t, across, slope))


@lru_cache(maxsize=REMEMBERED)
def pivots_of(touch: Touch) -> tuple[Pivot, ...]:
    """The parts of a real ball's ways about all corners of its section, in order."""
    found: list[Pivot] = []
    for corner in touch.section.corners:
        even = Pivot(touch=touch, corner=corner, runs=False, first=True, last=True)
        found += (even,) if even.upright() else _running(touch, corner)
    return tuple(found)


def _running(touch: Touch, corner: Corner) -> tuple[Pivot, ...]:
    """The parts of the way of a ball that runs, and turns where its contact goes back."""
    v, _ = way(touch, corner)
    rises = np.diff(v) * (v[-1] - v[0]) > 0.0
    if rises.all():
        kinds = [(True, True, True)]
    elif rises[0]:
        kinds = [(True, True, False), (False, False, True)]
    else:
        kinds = [(False, True, False), (True, False, True)]
    return tuple(Pivot(touch=touch, corner=corner, runs=runs, first=one, last=two) for runs, one, two in kinds)


class Turning(NamedTuple):
    """A ball at places p (k,) of a pivot."""

    pivot: Pivot
    p: Reals
    ball: Turned


class Foot(NamedTuple):
    """A part of the foot of a fillet on its wall."""

    name: str
    """of the face, or of the pivot"""
    near: tuple[Reals, Reals, Reals]
    """increasing parameters (k,) of that, and t and theta, or y, (k,) there"""
    against: bool
    """whether the chain of all parts runs against it"""


def feet(touch: Touch, pivots: Sequence[Turning]) -> list[Foot]:
    """The closed chain of a real foot, lower side first, in the order of an end face's boundary."""
    found, near = touch.found, {}
    for face in touch.section.faces:
        which = np.flatnonzero(found.sites.side == face)
        which = which[np.argsort(found.sites.u[which])]
        near[FACES[face]] = [(FACES[face], found.sites.u[which], found.t[which], found.across[which])]
    for name in FACES[LEADING:]:
        near.setdefault(name, [])
    for edge, part in ((edge, part) for edge in FACES[LEADING:] for part in ("_upper", "", "_lower")):
        own = [each for each in pivots if each.pivot.corner.name == edge + part]
        turned = [(pivot.name, p, ball.t, ball.across) for pivot, p, ball in own]
        near[edge] = turned + near[edge] if part == "_upper" else near[edge] + turned
    chain = [(each, False) for each in near["lower"]] + [(each, True) for each in near["trailing_edge"][::-1]]
    chain += [(each, True) for each in near["upper"]] + [(each, False) for each in near["leading_edge"]]
    return [
        Foot(name=name, near=(places, np.real(t), np.real(across)), against=against)
        for (name, places, t, across), against in chain
    ]


@lru_cache(maxsize=REMEMBERED)
def way(touch: Touch, corner: Corner) -> tuple[Reals, Reals]:
    """v (m,) of the contact and centres (m, 3) of a real ball that touches a corner's line, at shares of its turn."""
    section, wall, corners = touch.section.real(), touch.ball.wall.real(), touch.corners
    p, first = LOOKED_AT, _ends(touch, corner)
    ends = corners.picked(np.array([first, first + 1]))
    on_blade, on_wall = (
        _between(np.real(size[0]), np.real(size[1]), p)[:, None] for size in (ends.on_blade, ends.on_wall)
    )
    c, d = np.real(ends.v)
    v = _between(c, d, p)
    one, other = _along(corner.first, len(p)), _along(corner.second, len(p))

    def centres(v: Reals) -> Reals:
        normal = turned(section.normal(one, v), section.normal(other, v), p)
        return section.derivative(one, v) + on_blade * normal

    # by secants: the centre's height above the wall is nearly linear in v
    before, height = v, _height(wall, centres(v)) - on_wall[:, 0]
    with np.errstate(all="ignore"):
        v = v + 1e-3 * (1.0 - 2.0 * touch.ball.end)
        for _ in range(STEPS):
            now = _height(wall, centres(v)) - on_wall[:, 0]
            step = np.where(now == height, 0.0, now * (v - before) / (now - height))
            before, height, v = v, now, v - np.where(np.isfinite(step), step, 0.0)
            if np.all(np.square(step) < 1e-24):
                break
    v[0], v[-1] = c, d
    return v, centres(v)


def _height(wall: Wall, points: Reals) -> Reals:
    """Distances (k,) of points from the real wall, into the fluid."""
    t, across = wall.places_below(points)
    return dot(points - wall.point(t, across), wall.normal(t, across))


def _branch(v: Reals, last: bool) -> NDArray[np.intp]:
    """Indices of the stretch in which the contact goes from one end to the other without turning back."""
    rises = np.diff(v) * (v[-1] - v[0]) > 0.0
    if rises.all():
        return np.arange(len(v))
    wrong = np.flatnonzero(~rises)
    return np.arange(wrong[-1] + 1, len(v)) if last else np.arange(wrong[0] + 1)


def _ends(touch: Touch, corner: Corner) -> int:
    """Where the contact on the first face of a corner is among those at corners, before that on the second."""
    return 2 * [each.name for each in touch.section.corners].index(corner.name)


def _along(pair: tuple[int, float], count: int) -> Sites:
    return Sites(side=np.full(count, pair[0]), u=np.full(count, pair[1]))


def _between(start: Array, end: Array, p: Array) -> Array:
    return start + (end - start) * p


def turned(start: Array, end: Array, p: Array) -> Array:
    """Unit vectors (k, 3) at shares of the angle between unit vectors."""
    angle = np.arccos(dot(start, end))
    weights = np.sin((1.0 - p) * angle) / np.sin(angle), np.sin(p * angle) / np.sin(angle)
    return weights[0][:, None] * start + weights[1][:, None] * end


Given = tuple[Array, Array, Array, Array]
"""Points of the line (k, 3), unit vectors (k, 3) that the ball's centre lies across from them, a and b (k,)."""


def settled(wall: Wall, given: Given, start: tuple[Array, Array]) -> tuple[Array, Reals]:
    """t and theta (k, 2) of balls near given ones (k,), and what they miss, over the radius."""
    real_wall, (point, aside, on_blade, on_wall) = wall.real(), given
    real = np.real(point), np.real(aside), np.real(on_blade), np.real(on_wall)
    x = np.real(np.stack(start, axis=-1))
    with np.errstate(all="ignore"):
        for _ in range(STEPS):
            miss, slopes = _misses(real_wall, real, x)
            if np.all(length(miss) < SETTLED * real[2]):
                break
            x = x - _solved(slopes, miss)
        miss, slopes = _misses(real_wall, real, x)
        residual = length(miss) / real[2]
    residual = np.where(np.isfinite(residual), residual, np.inf)
    if not any(np.iscomplexobj(each) for each in (*given, wall.meridian.control_points)):
        return x, residual
    return x - 1j * _solved(slopes, np.imag(_misses(wall, given, x)[0])), residual


def _misses(wall: Wall, given: Given, x: Array) -> tuple[Array, Array]:
    """What is to vanish (k, 2) at t and theta (k, 2), and its derivatives (k, 2, 2)."""
    point, aside, on_blade, on_wall = given
    t, across = x[:, 0], x[:, 1]
    away = wall.point(t, across) + on_wall[:, None] * wall.normal(t, across) - point
    pairs = zip(wall.slopes(t, across), wall.normal_slopes(t, across), strict=True)
    moves = [slope + on_wall[:, None] * turn for slope, turn in pairs]
    miss = np.stack([0.5 * (dot(away, away) / on_blade - on_blade), dot(away, aside)], axis=-1)
    columns = [np.stack([dot(away, move) / on_blade, dot(move, aside)], axis=-1) for move in moves]
    return miss, np.stack(columns, axis=-1)


def _solved(slopes: Reals, right: Reals) -> Reals:
    """x (k, 2) with J x = right; a singular one gives no number instead of an error."""
    (a, b), (c, d) = np.moveaxis(slopes, 0, -1)
    size = a * d - b * c
    return np.stack([d * right[:, 0] - b * right[:, 1], a * right[:, 1] - c * right[:, 0]], axis=-1) / size[:, None]
