"""A ball that rolls along a blade and a wall: where it touches, and how the blade's lines leave the fillet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, cast

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.closed_section import FACES, LEADING, TRAILING, ClosedSection, Sites
from bladewright.blade.native.contacts import Contacts, Wall, changes, contacts
from bladewright.blade.native.cross_section import ConicSections, CrossSections
from bladewright.blade.native.fillet_sizes import Sizes, ball_sizes
from bladewright.blade.native.strip import Course, Leaving, Strip, leaving, resolved
from bladewright.frozen import FrozenMapping, FrozenRecord
from bladewright.numerics.elementary import Array, dot, length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign

WALLS = {"hub": 0.0, "shroud": 1.0}
"""Walls, and v at the end of a blade that stands on one."""
POLE = 3e-9
"""Distance of the contacts on both faces of a corner, of the section's extent, below which they are one: an edge
between would be as short as the tolerance of CAD programs."""
STEP = 1e-30
"""Complex step of u: its square vanishes beside 1, so that the derivative is exact to rounding."""
APART = 1e-3
"""Step of u for differences of fourth order: both their error and rounding are then about 1e-12."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Ball(FrozenRecord):
    """A ball that rolls along the blade and one wall."""

    wall: Wall
    sizes: Sizes
    """distances of its centre from blade and wall at sites [m]"""
    end: float
    """v at which the blade ends on the wall"""

    curved: bool = False
    """whether the cross-sections take the curvatures of blade and wall at their ends"""

    def growth(self, sites: Sites) -> tuple[Array, Array]:
        """Derivatives of the sizes by u: of real ones exactly, of others by differences, as far as rounding goes."""
        u = np.real(sites.u)
        if not np.iscomplexobj(self.sizes(sites)[0]):
            on_blade, on_wall = self.sizes(sites.moved(u + 1j * STEP))
            return np.imag(on_blade) / STEP, np.imag(on_wall) / STEP
        shares = zip((-2.0, -1.0, 1.0, 2.0), (1.0, -8.0, 8.0, -1.0), strict=True)
        near = [(weight, self.sizes(sites.moved(u + k * APART))) for k, weight in shares]
        parts = [np.sum([weight * sizes[i] for weight, sizes in near], axis=0) for i in (0, 1)]
        return parts[0] / (12.0 * APART), parts[1] / (12.0 * APART)


@dataclass(frozen=True, kw_only=True, eq=False)
class Touch(FrozenRecord):
    """A ball at sites around the blade."""

    ball: Ball
    section: ClosedSection
    found: Contacts
    corners: Contacts
    """at both faces of each corner of the section in turn"""

    @cached_property
    def sections(self) -> CrossSections:
        """The fillet's cross-sections there."""
        found, wall = self.found, self.ball.wall
        point, normal = self.section.derivative(found.sites, found.v), self.section.normal(found.sites, found.v)
        conics = ConicSections(
            blade=point,
            wall=wall.point(found.t, found.across),
            normals=(normal, wall.normal(found.t, found.across)),
            centre=point + found.on_blade[:, None] * normal,
            sizes=(found.on_blade, found.on_wall),
        )
        return conics.curved(self._bend_of_blade, self._bend_of_wall) if self.ball.curved else conics

    def _bend_of_blade(self, slope: Array) -> Array:
        """Normal curvature (k,) of the blade along tangents (k, 3), times their squared length, towards the fluid."""
        sites, v = self.found.sites, self.found.v
        along, _, by_u = self.section.running(sites, v)
        _, across, _, by_v = self.section.rising(sites, v)
        first, second = resolved(along, across, slope)
        return -dot(slope, first[:, None] * by_u + second[:, None] * by_v)

    def _bend_of_wall(self, slope: Array) -> Array:
        """The same of the wall."""
        return bend_of_wall(self.ball.wall, self.found.t, self.found.across, slope)

    def net(self) -> Array:
        """Control points (n, k, 3) of the fillet's cross-sections."""
        return self.sections.net()

    @cached_property
    def slope(self) -> Array:
        """dF/ds (k, 3) on the blade."""
        return np.asarray(self.sections.points(np.zeros(1), 1)[0])

    @cached_property
    def lines(self) -> Leaving:
        """How lines of the blade leave the fillet."""
        return leaving(self.section, self.found, self.slope, self._rise)

    @cached_property
    def lines_at_corners(self) -> Leaving:
        """The same at the corners of the section."""
        return replace(self, found=self.corners).lines

    @property
    def _rise(self) -> Array:
        """dv/du (k,) of the contacts, where the section has corners."""
        sites = self.found.sites
        if not self.section.corners:
            return np.zeros(len(sites))
        return changes(self.section, self.ball.wall, self.found, self.ball.growth(sites))[:, 0]

    def course(self, strip: Strip) -> Course:
        """How the lines of a strip run."""
        if not self.section.corners:
            return strip.course(self.found.sites, self.lines)
        return strip.course(self.found.sites, self.lines, self.lines_at_corners, self.corners.sites)

    def above(self, strip: Strip, w: Reals) -> Array:
        """Points (len(w), k, 3) of the strip above the fillet, w from 0 at the fillet to 1 at the side."""
        return strip.points(self.section, self.found.sites, self.course(strip), w)

    def start(self, strip: Strip) -> list[Array]:
        """The points (k, 3) where the strip starts, its first derivatives by w and, where they are kept, its second."""
        sites, course = self.found.sites, self.course(strip)
        found = [self.sections.blade, -course.share[:, None] * self.slope / strip.speed]
        if self.section.corners:
            along, rise = self.section.derivatives(sites, self.found.v, (1, 0), (0, 1))
            found[1] = found[1] + course.along[:, None] * (along + self.lines.rise[:, None] * rise)
        return [*found, strip.bend(self.section, sites, course)] if strip.curved else found

    def end(self, strip: Strip) -> list[Array]:
        """The points (k, 3) where the strip ends, and its first two derivatives by w."""
        found = self.section.derivatives(self.found.sites, np.asarray(strip.level), (0, 0), (0, 1), (0, 2))
        slope = self.course(strip).slope[:, None]
        return [slope**order * each for order, each in enumerate(found)]


@dataclass(frozen=True, kw_only=True, eq=False)
class Rolled(FrozenRecord):
    """The balls of all fillets of a blade at the same sites."""

    section: ClosedSection
    sites: Sites
    touches: Mapping[str, Touch]
    """by the wall"""

    @classmethod
    def at(
        cls,
        section: ClosedSection,
        balls: Mapping[str, Ball],
        sites: Sites,
        near: Mapping[str, Contacts] | None = None,
    ) -> Rolled:
        """Where they touch at sites; `near` are known contacts by the wall, between which the search begins."""
        touches, all_sites = {}, sites.and_those(section.corner_sites)
        here, corners = np.split(np.arange(len(all_sites)), [len(sites)])
        for wall, ball in balls.items():
            known = None if near is None else near[wall]
            found = with_poles(section, contacts(section, ball.wall, all_sites, ball.sizes(all_sites), ball.end, known))
            touches[wall] = Touch(ball=ball, section=section, found=found.picked(here), corners=found.picked(corners))
        return cls(section=section, sites=sites, touches=touches)

    @property
    def balls(self) -> dict[str, Ball]:
        """The balls by the wall."""
        return {wall: touch.ball for wall, touch in self.touches.items()}

    @property
    def found(self) -> dict[str, Contacts]:
        """The contacts by the wall."""
        return {wall: touch.found for wall, touch in self.touches.items()}


def with_poles(section: ClosedSection, found: Contacts, count: int = 1) -> Contacts:
    """The contacts, equal on both faces of a corner where they are but for POLE.

    Those of `count` blades with one real part come one after another.
    """
    one = len(found.sites) // count
    sites, v = found.sites.picked(np.arange(one)), np.reshape(found.v, (count, one)).copy()
    for corner in section.corners:
        both = [(sites.side == face) & (sites.u == u) for face, u in (corner.first, corner.second)]
        c, d = (v[:, np.argmax(each)] for each in both)
        first = Sites(side=np.array([corner.first[0]]), u=np.array([corner.first[1]]))
        if length(np.real(section.derivative(first, c[:1], 0, 1)[0] * (c[0] - d[0]))) < POLE * extent(section):
            v[:, both[0] | both[1]] = 0.5 * (c + d)[:, None]
    return replace(found, v=v.ravel())


def extent(section: ClosedSection) -> float:
    """Largest extent of the upper side [m]."""
    return float(np.ptp(np.real(section.upper.control_points), axis=(0, 1)).max())


def bend_of_wall(wall: Wall, t: Array, across: Array, slope: Array) -> Array:
    """Normal curvature (k,) of a wall along tangents (k, 3), times their squared length, towards the fluid."""
    first, second = resolved(*wall.slopes(t, across), slope)
    by_t, by_theta = wall.normal_slopes(t, across)
    return -dot(slope, first[:, None] * by_t + second[:, None] * by_theta)


def closed_section(blade: Blade) -> ClosedSection:
    """The sides of a blade and the faces of its blunt edges as one closed section."""
    leading, trailing = blade.edge_kinds
    upper, lower = blade.sides
    blunt = {
        face: cast(Surface, blade.surfaces[FACES[face]])
        for face in (LEADING, TRAILING)
        if FACES[face] in blade.surfaces
    }
    smooth = leading == "round", trailing == "round"
    return ClosedSection(upper=upper, lower=lower, smooth=smooth, blunt=FrozenMapping(blunt))


def section_like(real: ClosedSection, blade: Blade) -> ClosedSection:
    """That of a blade that carries a step, whose real one is known."""
    upper, lower = blade.sides
    blunt = {face: cast(Surface, blade.surfaces[FACES[face]]) for face in real.blunt}
    return replace(real, upper=upper, lower=lower, blunt=FrozenMapping(blunt))


def balls_of(
    blade: Blade, section: ClosedSection, design: RowDesign, real: Mapping[str, Ball] | None = None
) -> dict[str, Ball]:
    """The balls of the fillets that a design asks for, by the wall; `real` are those of the real blade, where known."""
    asked = {"hub": design.hub_fillet, "shroud": design.shroud_fillet}
    balls = {}
    for name, fillet in asked.items():
        if fillet is None:
            continue
        sizes = ball_sizes(fillet, design.metre, lambda: blade.suction_side)
        curved = fillet.kind == "curvature"
        if real is None:
            wall = _wall(blade, section, name)
        else:
            wall = replace(real[name].wall, meridian=blade.end_wall(name)[0])
        balls[name] = Ball(wall=wall, sizes=sizes, end=WALLS[name], curved=curved)
    return balls


def _wall(blade: Blade, section: ClosedSection, name: str) -> Wall:
    """The wall, with the side of it on which the blade stands."""
    end, sites = np.array([WALLS[name]]), Sites(side=np.zeros(1, dtype=np.intp), u=np.array([0.5]))
    wall = Wall(meridian=blade.end_wall(name)[0], revolved=blade.exact.mapping.revolved, inward=1.0)
    real, solid = wall.real(), section.real()
    normal = real.normal(*real.places_near(solid.derivative(sites, end)))
    grows = solid.derivative(sites, end, 0, 1) * (1.0 - 2.0 * end)
    return replace(wall, inward=1.0 if dot(normal, grows)[0] > 0.0 else -1.0)
