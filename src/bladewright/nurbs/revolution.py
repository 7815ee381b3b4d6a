"""Surfaces of revolution about the x axis, with the angle theta turning z towards y."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.revolve import FULL_TURN, arc_count, revolved
from bladewright.nurbs.surface import Surface

LEFT_HANDED = (-1.0, 0.0, 0.0)
"""the axis about which theta, from z towards y, turns right-handed"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Revolution:
    """A meridian curve turned about the x axis from `start` to `end`, as rational quadratic arcs along v in [0, 1].

    On an arc of half angle h about its middle, with the arc's own parameter t in [0, 1], the angle from the middle is
    2 atan(tan(h / 2) (2 t - 1)).
    """

    meridian: Curve
    """(x, r) in metres"""
    start: float
    """theta at v = 0 [rad]"""
    end: float
    """theta at v = 1 [rad]"""

    @cached_property
    def arcs(self) -> int:
        """Number of rational arcs, each of at most a right angle."""
        return arc_count((self.end - self.start) / FULL_TURN)

    def theta(self, v: ArrayLike) -> Reals:
        """Angle [rad] at real v (...)."""
        v = np.asarray(v, dtype=np.float64)
        step = (self.end - self.start) / self.arcs
        arc = np.clip(np.floor(v * self.arcs), 0, self.arcs - 1)
        t = v * self.arcs - arc
        return self.start + (arc + 0.5) * step + 2.0 * np.arctan(np.tan(step / 4.0) * (2.0 * t - 1.0))

    def slope(self, v: ArrayLike) -> Reals:
        """d theta / dv [rad] at real v (...)."""
        v = np.asarray(v, dtype=np.float64)
        step = (self.end - self.start) / self.arcs
        t = v * self.arcs - np.clip(np.floor(v * self.arcs), 0, self.arcs - 1)
        height = np.tan(step / 4.0)
        return 4.0 * self.arcs * height / (1.0 + (height * (2.0 * t - 1.0)) ** 2)

    def v(self, theta: Array) -> Array:
        """v (...) at angles theta [rad], real or complex."""
        step = (self.end - self.start) / self.arcs
        arc = np.clip(np.floor((np.real(theta) - self.start) / step), 0, self.arcs - 1)
        away = theta - self.start - (arc + 0.5) * step
        return (arc + (1.0 + np.tan(away / 2.0) / np.tan(step / 4.0)) / 2.0) / self.arcs

    def surface(self) -> Surface:
        """The rational surface: u along the meridian, v around the axis."""
        x, r = self.meridian.control_points[:, 0], self.meridian.control_points[:, 1]
        in_space = Curve(
            control_points=np.stack([x, np.zeros_like(r), r], axis=-1),
            knots=self.meridian.knots,
            degree=self.meridian.degree,
            weights=self.meridian.weights,
        )
        return revolved(in_space, self.start, self.end, axis=LEFT_HANDED)
