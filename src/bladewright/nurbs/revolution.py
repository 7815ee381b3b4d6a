"""Surfaces of revolution about the x axis, with the angle theta turning z towards y."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface

WIDEST = np.pi / 2.0
"""widest angle of one rational arc [rad]"""


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

    @property
    def arcs(self) -> int:
        """Number of rational arcs, each of at most a right angle."""
        return max(1, int(np.ceil((self.end - self.start) / WIDEST)))

    def theta(self, v: ArrayLike) -> Reals:
        """Angle [rad] at real v (...)."""
        v = np.asarray(v, dtype=np.float64)
        step = (self.end - self.start) / self.arcs
        arc = np.clip(np.floor(v * self.arcs), 0, self.arcs - 1)
        t = v * self.arcs - arc
        return self.start + (arc + 0.5) * step + 2.0 * np.arctan(np.tan(step / 4.0) * (2.0 * t - 1.0))

    def v(self, theta: Array) -> Array:
        """v (...) at angles theta [rad], real or complex."""
        step = (self.end - self.start) / self.arcs
        arc = np.clip(np.floor((np.real(theta) - self.start) / step), 0, self.arcs - 1)
        away = theta - self.start - (arc + 0.5) * step
        return (arc + (1.0 + np.tan(away / 2.0) / np.tan(step / 4.0)) / 2.0) / self.arcs

    def surface(self) -> Surface:
        """The rational surface: u along the meridian, v around the axis."""
        count = self.arcs
        step = (self.end - self.start) / count
        angles = self.start + step / 2.0 * np.arange(2 * count + 1)
        corner = np.arange(2 * count + 1) % 2 == 1
        stretch = np.where(corner, 1.0 / np.cos(step / 2.0), 1.0)
        x, r = self.meridian.control_points[:, 0], self.meridian.control_points[:, 1]
        net = np.stack(
            np.broadcast_arrays(
                x[:, None], r[:, None] * (stretch * np.sin(angles)), r[:, None] * (stretch * np.cos(angles))
            ),
            axis=-1,
        )
        around = 1.0 / stretch
        own = np.ones(len(x)) if self.meridian.weights is None else self.meridian.weights
        joints = np.repeat(np.arange(1, count) / count, 2)
        return Surface(
            control_points=net,
            knots_u=self.meridian.knots,
            knots_v=np.concatenate([np.zeros(3), joints, np.ones(3)]),
            degree_u=self.meridian.degree,
            degree_v=2,
            weights=own[:, None] * around,
        )
