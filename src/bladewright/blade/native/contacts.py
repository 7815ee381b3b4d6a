"""Where a ball that rolls along a blade and a wall touches both.

With S(u, v) the blade, H(t, theta) the wall, n their unit normals into the fluid and a, b > 0 the ball's radius (or the
axes of an ellipse) at a given place u around the blade, the contacts are the roots (v, t, theta) of

    S(u, v) + a n_S(u, v) = H(t, theta) + b n_H(t, theta) = c,

c the ball's centre. At a = b = 0 the root is the end of the blade on its wall, from which the ball is grown by Newton's
steps. One more in complex arithmetic gives the derivatives.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bladewright.blade.native.closed_section import ClosedSection, Sites
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, angle, cross, dot, length, unit
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve

GROWN = 3
"""Steps in which a ball is grown from nothing: each begins with a tangent predictor, so that few are needed."""
GROWING = 2
"""Newton's steps of a ball while it grows."""
STEPS = 12
"""Newton's steps for a ball: from a tangent predictor three to five reach rounding."""
SETTLED = 1e-11
"""Residual, of the radius, at which a ball touches both: a thousand times rounding, a millionth of what is promised."""
ROUNDED = 1e-4
"""Size of a ball, of the blade's extent, below which rounding of its coordinates is more than SETTLED."""
SEARCHED = 400
"""Places of a meridian among which the nearest begins the search for a point's own."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Wall(FrozenRecord):
    """A wall by its meridian, turned about the axis or drawn along y."""

    meridian: Curve
    """(x, r), or (x, z) in a cascade"""
    revolved: bool
    inward: float
    """+1 where the fluid lies to the left of the meridian, at larger radius where x grows; -1 to the right"""

    def _frame(self, across: Array) -> tuple[Array, Array]:
        """Unit vectors (..., 3) along r and along theta, or z and y."""
        zero, one = np.zeros_like(across), np.ones_like(across)
        if not self.revolved:
            return np.stack([zero, zero, one], axis=-1), np.stack([zero, one, zero], axis=-1)
        sine, cosine = np.sin(across), np.cos(across)
        return np.stack([zero, sine, cosine], axis=-1), np.stack([zero, cosine, -sine], axis=-1)

    def point(self, t: Array, across: Array) -> Array:
        """Points (..., 3) at t of the meridian and theta, or y."""
        line, (radial, tangential) = self.line(t), self._frame(across)
        found = line[..., 1:] * radial
        if not self.revolved:
            found = found + across[..., None] * tangential
        found[..., 0] = found[..., 0] + line[..., 0]
        return found

    def slopes(self, t: Array, across: Array) -> tuple[Array, Array]:
        """Derivatives (..., 3) of points by t and by theta, or y."""
        line, slope, (radial, tangential) = self.line(t), self.line(t, 1), self._frame(across)
        along = slope[..., 1:] * radial
        along[..., 0] = along[..., 0] + slope[..., 0]
        return along, (line[..., 1:] if self.revolved else 1.0) * tangential

    def normal(self, t: Array, across: Array) -> Array:
        """Unit normals (..., 3) into the fluid."""
        side = self._meridian_normal(self.line(t, 1))
        found = side[..., 1:] * self._frame(across)[0]
        found[..., 0] = found[..., 0] + side[..., 0]
        return found

    def normal_slopes(self, t: Array, across: Array) -> tuple[Array, Array]:
        """Derivatives (..., 3) of the unit normals by t and by theta, or y."""
        slope, bend = self.line(t, 1), self.line(t, 2)
        side, size = self._meridian_normal(slope), length(slope)[..., None]
        turn = np.stack([-bend[..., 1], bend[..., 0]], axis=-1) * self.inward / size
        turn = turn - side * dot(side, turn)[..., None]
        radial, tangential = self._frame(across)
        along = turn[..., 1:] * radial
        along[..., 0] = along[..., 0] + turn[..., 0]
        return along, side[..., 1:] * tangential if self.revolved else np.zeros_like(tangential)

    def _meridian_normal(self, slope: Array) -> Array:
        return self.inward * unit(np.stack([-slope[..., 1], slope[..., 0]], axis=-1))

    def line(self, t: Array, order: int = 0) -> Array:
        """Points (..., 2) of the meridian at t, or derivatives."""
        return self.meridian.derivative(t, order)

    @property
    def stepped(self) -> bool:
        """Whether it carries a complex step."""
        return np.iscomplexobj(self.meridian.control_points)

    def real(self) -> Wall:
        """The same of real parts."""
        return replace(self, meridian=replace(self.meridian, control_points=np.real(self.meridian.control_points)))

    def places_near(self, points: Reals) -> tuple[Reals, Reals]:
        """t and theta, or y, (k,) of the wall's points near given ones (k, 3)."""
        low, high = self.meridian.domain
        t = np.linspace(low, high, SEARCHED)
        height = length(points[:, 1:]) if self.revolved else points[:, 2]
        target = np.stack([points[:, 0], height], axis=-1)
        found = t[np.argmin(length(np.real(self.meridian(t)) - target[:, None]), axis=-1)]
        across = np.unwrap(angle(points[:, 1], points[:, 2])) if self.revolved else points[:, 1]
        return found, across

    def places_below(self, points: Reals) -> tuple[Reals, Reals]:
        """t and theta, or y, (k,) of the real wall's points nearest to given ones (k, 3)."""
        t, across = self.places_near(points)
        for _ in range(STEPS):
            along = self.slopes(t, across)[0]
            t = t + dot(points - self.point(t, across), along) / dot(along, along)
        return t, across


@dataclass(frozen=True, kw_only=True, eq=False)
class Contacts(FrozenRecord):
    """Where a ball touches blade and wall, at sites (k,) around the blade."""

    sites: Sites
    on_blade: Array
    """a (k,) [m]: distance of the centre from the blade"""
    on_wall: Array
    """b (k,) [m]: distance of the centre from the wall"""
    v: Array
    """(k,) on the blade"""
    t: Array
    """(k,) on the wall's meridian"""
    across: Array
    """(k,) theta or y on the wall"""
    residual: Reals
    """(k,) distance of the two centres, over the radius"""

    def picked(self, which: NDArray[np.intp]) -> Contacts:
        """Some of them."""
        sizes = {"on_blade": self.on_blade[which], "on_wall": self.on_wall[which]}
        places = {"v": self.v[which], "t": self.t[which], "across": self.across[which]}
        return Contacts(sites=self.sites.picked(which), **sizes, **places, residual=self.residual[which])

    def and_those(self, others: Contacts) -> Contacts:
        """These and others."""
        names = ("on_blade", "on_wall", "v", "t", "across", "residual")
        both = {name: np.concatenate([getattr(self, name), getattr(others, name)]) for name in names}
        return Contacts(sites=self.sites.and_those(others.sites), **both)

    def between(self, sites: Sites) -> Reals:
        """v, t and theta (m, 3) near those at other sites, linear between these."""
        known = np.real(np.stack([self.v, self.t, self.across], axis=-1))
        found = np.empty((len(sites), 3))
        for side in np.unique(sites.side):
            own, wanted = self.sites.side == side, sites.side == side
            order = np.argsort(self.sites.u[own])
            for k in range(3):
                found[wanted, k] = np.interp(sites.u[wanted], self.sites.u[own][order], known[own, k][order])
        return found


def contacts(
    section: ClosedSection,
    wall: Wall,
    sites: Sites,
    sizes: tuple[Array, Array],
    end: float,
    near: Contacts | None = None,
) -> Contacts:
    """The contacts of a ball of sizes a and b (k,) at sites; `end` is the v at which the blade ends on the wall.

    `near` are those of the same ball at other sites, between which the search begins. Found on real parts; where the
    blade, the wall or the sizes carry a step, the contacts do. Where there are none the residual stays large.
    """
    real = section.real(), wall.real()
    own = np.real(sizes[0]), np.real(sizes[1])
    with np.errstate(all="ignore"):
        start = _grown(*real, sites, own, end) if near is None else near.between(sites)
        x, residual = _settled(*real, sites, own, start)
    found = _placed(sites, own, x, residual)
    if section.stepped or wall.stepped or any(map(np.iscomplexobj, sizes)):
        return stepped_contacts(section, wall, found, sizes, slopes(*real, found))
    return found


def slopes(section: ClosedSection, wall: Wall, found: Contacts) -> Array:
    """Derivatives (k, 3, 3) by v, t and theta of the distances between the two centres of real contacts."""
    x = np.stack([found.v, found.t, found.across], axis=-1)
    return _differences(section, wall, found.sites, (found.on_blade, found.on_wall), x)[1]


def stepped_contacts(
    section: ClosedSection, wall: Wall, real: Contacts, sizes: tuple[Array, Array], slopes: Array
) -> Contacts:
    """Contacts with a step, from the real ones and their `slopes`, by one more of Newton's steps."""
    sites, v, t, across = real.sites, real.v, real.t, real.across
    normals = section.normal(sites, v), wall.normal(t, across)
    centres = section.derivative(sites, v) + sizes[0][:, None] * normals[0]
    miss = centres - wall.point(t, across) - sizes[1][:, None] * normals[1]
    x = np.stack([v, t, across], axis=-1) - 1j * _solved(slopes, np.imag(miss))
    return _placed(sites, sizes, x, real.residual)


def _placed(sites: Sites, sizes: tuple[Array, Array], x: Array, residual: Reals) -> Contacts:
    return Contacts(
        sites=sites,
        on_blade=sizes[0],
        on_wall=sizes[1],
        v=x[:, 0],
        t=x[:, 1],
        across=x[:, 2],
        residual=residual,
    )


def _grown(section: ClosedSection, wall: Wall, sites: Sites, own: tuple[Reals, Reals], end: float) -> Reals:
    """v, t and theta (k, 3) near the contacts: a ball grown from nothing at the end of the blade."""
    v = np.full(len(sites), end)
    x = np.stack([v, *wall.places_near(section.derivative(sites, v))], axis=-1)
    for k in range(GROWN):
        small = own[0] * k / GROWN, own[1] * k / GROWN
        for _ in range(GROWING):
            miss, jacobian = _differences(section, wall, sites, small, x)
            x = x - _solved(jacobian, miss)
        # the root moves along the conormals: into the span on the blade, away from the blade on the wall
        normals = section.normal(sites, x[:, 0]), wall.normal(x[:, 1], x[:, 2])
        push = own[0][:, None] / GROWN * normals[0] - own[1][:, None] / GROWN * normals[1]
        x = x - _solved(_differences(section, wall, sites, small, x)[1], push)
    return x


def changes(section: ClosedSection, wall: Wall, found: Contacts, growth: tuple[Array, Array]) -> Array:
    """Derivatives (k, 3) of v, t and theta of contacts by u, where a and b change by `growth` (k,)."""
    sites = found.sites
    along, normal, turn = section.running(sites, found.v)
    of_centre = along + found.on_blade[:, None] * turn + growth[0][:, None] * normal
    push = of_centre - growth[1][:, None] * wall.normal(found.t, found.across)
    x = np.stack([found.v, found.t, found.across], axis=-1)
    return -_solved(_differences(section, wall, sites, (found.on_blade, found.on_wall), x)[1], push)


def rates(
    section: ClosedSection, wall: Wall, found: Contacts, growth: tuple[Array, Array]
) -> tuple[Array, Array, Array]:
    """Derivatives (k, 3) by u of real contacts on the blade, on the wall, and of the centre.

    a and b change by `growth` (k,).
    """
    sites, change = found.sites, changes(section, wall, found, growth)
    along, normal, turn = section.running(sites, found.v)
    _, rise, _, bend = section.rising(sites, found.v)
    slopes = wall.slopes(found.t, found.across)
    on_blade = along + change[:, :1] * rise
    on_wall = change[:, 1:2] * slopes[0] + change[:, 2:] * slopes[1]
    own, grown = found.on_blade[:, None], growth[0][:, None]
    return on_blade, on_wall, along + own * turn + grown * normal + change[:, :1] * (rise + own * bend)


def _differences(
    section: ClosedSection, wall: Wall, sites: Sites, sizes: tuple[Array, Array], x: Reals
) -> tuple[Array, Array]:
    """Distance (k, 3) of the two centres and its derivatives (k, 3, 3) by v, t and theta."""
    point, rise, normal, turn = section.rising(sites, x[:, 0])
    on_blade, on_wall = sizes[0][:, None], sizes[1][:, None]
    miss = point + on_blade * normal - wall.point(x[:, 1], x[:, 2]) - on_wall * wall.normal(x[:, 1], x[:, 2])
    pairs = zip(wall.slopes(x[:, 1], x[:, 2]), wall.normal_slopes(x[:, 1], x[:, 2]), strict=True)
    columns = [rise + on_blade * turn, *(-(slope + on_wall * own) for slope, own in pairs)]
    return miss, np.stack(columns, axis=-1)


def _settled(
    section: ClosedSection, wall: Wall, sites: Sites, sizes: tuple[Reals, Reals], x: Reals
) -> tuple[Reals, Reals]:
    """The contacts by Newton's steps from nearby, and their residuals, over the size of the ball."""
    far = float(np.ptp(section.upper.control_points, axis=(0, 1)).max())
    extent = np.maximum(np.maximum(*sizes), ROUNDED * far)
    for _ in range(STEPS):
        miss, jacobian = _differences(section, wall, sites, sizes, x)
        if np.all(length(miss) < SETTLED * extent):
            break
        x = x - _solved(jacobian, miss)
    residual = length(miss) / extent
    return x, np.where(np.isfinite(residual), residual, np.inf)


def _solved(jacobian: Array, right: Array) -> Array:
    """x (k, 3) with J x = right, by Cramer's rule: a singular one gives no number instead of an error."""
    first, second, third = (jacobian[..., i] for i in range(3))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        size = dot(first, cross(second, third))
        parts = [
            dot(right, cross(second, third)),
            dot(first, cross(right, third)),
            dot(first, cross(second, right)),
        ]
        return np.stack(parts, axis=-1) / size[..., None]
