"""The meridian of a wall, by the parameter of a curve in space that runs along it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, dot, length
from bladewright.numerics.quadrature import gauss
from bladewright.nurbs.basis import Reals, breaks
from bladewright.nurbs.curve import Curve

SEARCHED = 1001
"""Points of the wall among which the one nearest to an end of the outline is looked for, before Newton's method."""
STEPS = 30
"""Newton steps at most: from a point so near, some five are taken."""
SETTLED = 1e-9
"""Newton step, of the parameter, at which the iteration ends: the error left is its square."""
POINTS = 16
"""Gauss points on a knot span, or a part of one."""


@dataclass(frozen=True, kw_only=True, eq=False)
class WallLine(FrozenRecord):
    """The meridian of a wall by the parameter of a curve in space that runs along it."""

    curve: Curve
    """in space [m]"""
    blade: tuple[Array, Array]
    """() its parameters where the blade begins and ends"""
    meridian: Curve
    """the exact wall (x, r) [m], by shares of its length, and longer than the curve"""
    joints: Reals
    """the meridian's inner knots where it loses derivatives"""

    def at(self, t: Array, order: int = 0) -> Array:
        """(x, r) (..., 2), or its first derivative by t, at t (...)."""
        point, slope = self.curve(t), self.curve.derivative(t) if order else None
        radius = length(point[..., 1:])
        if slope is None:
            return np.stack([point[..., 0], radius], axis=-1)
        return np.stack([slope[..., 0], dot(point[..., 1:], slope[..., 1:]) / radius], axis=-1)

    def reached(self, t: Array) -> Array:
        """The meridional lengths (k,) from the curve's start to t (k,)."""
        return self._integrated(t, lambda at: length(self.at(at, 1)))

    @cached_property
    def blade_length(self) -> Array:
        """The meridional length () of the blade on this wall [m]."""
        first, last = self.reached(np.array(self.blade))
        return np.asarray(last - first)

    def swept(self, t: Array) -> Array:
        """The integrals (k,) of pi r^2 dx up to t (k,) [m^3]."""
        return self._integrated(t, lambda at: np.pi * self.at(at)[..., 1] ** 2 * self.at(at, 1)[..., 0])

    def parameter(self, distance: Array) -> Array:
        """t (k,) at meridional lengths (k,) from the curve's start, also past its ends."""
        known = breaks(self.curve.knots)
        t = np.interp(np.real(distance), np.real(self.reached(known)), known)
        for _ in range(STEPS):
            step = np.real(self.reached(t) - distance) / np.real(length(self.at(t, 1)))
            t = t - step
            if np.max(step**2) < SETTLED**2:
                break
        return np.asarray(t - (self.reached(t) - distance) / length(self.at(t, 1)))

    def beside(self, point: Array) -> Array:
        """The parameter () of a point (3,) on the wall."""
        place = np.stack([point[0], length(point[1:])])
        known = np.linspace(*self.curve.domain, SEARCHED)
        t = known[np.argmin(np.sum(np.real(self.at(known) - place) ** 2, axis=-1))]
        for _ in range(STEPS):
            slope = self.at(t, 1)
            found = t - dot(self.at(t) - place, slope) / dot(slope, slope)
            step, t = np.real(found) - t, np.real(found)
            if step**2 < SETTLED**2:
                break
        return np.asarray(found)

    def foot(self, t: Array) -> Array:
        """The meridian's parameter () at a parameter of the curve."""
        point = self.at(t)
        places = np.linspace(*self.meridian.domain, SEARCHED)
        s = places[np.argmin(np.sum(np.real(self.meridian(places) - point) ** 2, axis=-1))]
        for _ in range(STEPS):
            slope = self.meridian.derivative(s)
            found = s - dot(self.meridian(s) - point, slope) / dot(slope, slope)
            step, s = np.real(found) - s, np.real(found)
            if step**2 < SETTLED**2:
                break
        return np.asarray(found)

    def _integrated(self, t: Array, density: Callable[[Array], Array]) -> Array:
        """Integrals (k,) of a density by t from the curve's start to t (k,)."""
        ends, (nodes, weights) = breaks(self.curve.knots), gauss(POINTS)
        steps = np.diff(ends)[:, None]
        whole = np.sum(steps * weights * density(ends[:-1, None] + steps * nodes), axis=-1)
        before = np.concatenate([np.zeros(1), np.cumsum(whole)])
        span = np.clip(np.searchsorted(ends, np.real(t), side="right") - 1, 0, len(ends) - 2)
        rest = (t - ends[span])[:, None]
        return np.asarray(before[span] + np.sum(rest * weights * density(ends[span][:, None] + rest * nodes), axis=-1))
