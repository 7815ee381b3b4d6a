"""A ball that rolls along a blade and a wall: where it touches, and how the blade's lines leave the fillet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.closed_section import ClosedSection, Sites
from bladewright.blade.native.contacts import Contacts, Wall, contacts
from bladewright.blade.native.cross_section import ConicSections, CrossSections, QuinticSections
from bladewright.blade.native.fillet_sizes import Sizes, ball_sizes
from bladewright.blade.native.strip import Leaving, Strip, leaving, resolved
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, dot
from bladewright.nurbs.basis import Reals

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign

WALLS = {"hub": 0.0, "shroud": 1.0}
"""Walls, and v at the end of a blade that stands on one."""
STEP = 1e-30
"""Complex step of u: its square vanishes beside 1, so that the derivative is exact to rounding."""


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

    def growth(self, sites: Sites) -> tuple[Reals, Reals]:
        """Derivatives of the sizes by u."""
        on_blade, on_wall = self.sizes(sites.moved(np.real(sites.u) + 1j * STEP))
        return np.imag(on_blade) / STEP, np.imag(on_wall) / STEP


@dataclass(frozen=True, kw_only=True, eq=False)
class Touch(FrozenRecord):
    """A ball at sites around the blade."""

    ball: Ball
    section: ClosedSection
    found: Contacts

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
        if not self.ball.curved:
            return conics
        start, end = conics.points(np.array([0.0, 1.0]), 1)
        return QuinticSections(
            blade=conics.blade,
            wall=conics.wall,
            normals=conics.normals,
            centre=conics.centre,
            sizes=conics.sizes,
            slopes=(start, end),
            bends=(self._bend_of_blade(start), self._bend_of_wall(end)),
        )

    def _bend_of_blade(self, slope: Array) -> Array:
        """Normal curvature (k,) of the blade along tangents (k, 3), times their squared length, towards the fluid."""
        sites, v = self.found.sites, self.found.v
        along, _, by_u = self.section.running(sites, v)
        _, across, _, by_v = self.section.rising(sites, v)
        first, second = resolved(along, across, slope)
        return -dot(slope, first[:, None] * by_u + second[:, None] * by_v)

    def _bend_of_wall(self, slope: Array) -> Array:
        """The same of the wall."""
        t, across = self.found.t, self.found.across
        first, second = resolved(*self.ball.wall.slopes(t, across), slope)
        by_t, by_theta = self.ball.wall.normal_slopes(t, across)
        return -dot(slope, first[:, None] * by_t + second[:, None] * by_theta)

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
        return leaving(self.section, self.found, self.slope)

    def above(self, strip: Strip, w: Reals) -> Array:
        """Points (len(w), k, 3) of the strip above the fillet, w from 0 at the fillet to 1 at the side."""
        return strip.points(self.section, self.found.sites, self.lines, w)

    def start(self, strip: Strip) -> list[Array]:
        """The points (k, 3) where the strip starts, its first derivatives by w and, where they are kept, its second."""
        found = [self.sections.blade, -self.slope / strip.speed]
        return [*found, strip.bend(self.section, self.found.sites, self.lines)] if strip.curved else found

    def end(self, strip: Strip) -> list[Array]:
        """The points (k, 3) where the strip ends, and its first two derivatives by w."""
        found = self.section.derivatives(self.found.sites, np.asarray(strip.level), (0, 0), (0, 1), (0, 2))
        return [strip.slope**order * each for order, each in enumerate(found)]


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
        touches = {}
        for wall, ball in balls.items():
            known = None if near is None else near[wall]
            found = contacts(section, ball.wall, sites, ball.sizes(sites), ball.end, known)
            touches[wall] = Touch(ball=ball, section=section, found=found)
        return cls(section=section, sites=sites, touches=touches)

    @property
    def found(self) -> dict[str, Contacts]:
        """The contacts by the wall."""
        return {wall: touch.found for wall, touch in self.touches.items()}


def closed_section(blade: Blade) -> ClosedSection:
    """The sides of a blade as one closed section."""
    leading, trailing = blade.edge_kinds
    upper, lower = blade.sides
    return ClosedSection(upper=upper, lower=lower, smooth=(leading == "round", trailing == "round"))


def balls_of(blade: Blade, section: ClosedSection, design: RowDesign) -> dict[str, Ball]:
    """The balls of the fillets that a design asks for, by the wall."""
    asked = {"hub": design.hub_fillet, "shroud": design.shroud_fillet}
    balls = {}
    for name, fillet in asked.items():
        if fillet is None:
            continue
        sizes = ball_sizes(fillet, design.metre, lambda: blade.suction_side)
        curved = fillet.kind == "curvature"
        balls[name] = Ball(wall=_wall(blade, section, name), sizes=sizes, end=WALLS[name], curved=curved)
    return balls


def _wall(blade: Blade, section: ClosedSection, name: str) -> Wall:
    """The wall, with the side of it on which the blade stands."""
    end, sites = np.array([WALLS[name]]), Sites(side=np.zeros(1, dtype=np.intp), u=np.array([0.5]))
    wall = Wall(meridian=blade.end_wall(name)[0], revolved=blade.exact.mapping.revolved, inward=1.0)
    real, solid = wall.real(), section.real()
    normal = real.normal(*real.places_near(solid.derivative(sites, end)))
    grows = solid.derivative(sites, end, 0, 1) * (1.0 - 2.0 * end)
    return replace(wall, inward=1.0 if dot(normal, grows)[0] > 0.0 else -1.0)
