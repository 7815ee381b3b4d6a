"""A wall moved along its normals into the flow path: the clearance surface of a blade from sections."""

from dataclasses import dataclass

import numpy as np

from bladewright.blade.exact.clearance import Clearance
from bladewright.blade.flow_path.meridional_curve import PiecewisePolynomial, real_first
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross2, dot, length
from bladewright.nurbs.basis import Reals

SAMPLES = 1001
"""Points of the wall at which its curvature is looked at."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OffsetWall:
    """A wall by t, and the distance that a blade keeps from it."""

    wall: PiecewisePolynomial
    clearance: Clearance
    leading: Array
    """(...) t of the uncut blade's leading edge on the wall"""
    trailing: Array
    """(...) t of its trailing edge"""

    def real(self) -> "OffsetWall":
        """The same without imaginary parts and batch."""
        wall = PiecewisePolynomial(breaks=self.wall.breaks, powers=real_first(self.wall.powers, 3))
        leading, trailing = (np.asarray(real_first(each, 0)) for each in (self.leading, self.trailing))
        return OffsetWall(wall=wall, clearance=self.clearance.real(), leading=leading, trailing=trailing)

    def u(self, t: Reals) -> Array:
        """u (..., k) at t (k,)."""
        return (t - self.leading[..., None]) / (self.trailing - self.leading)[..., None]

    def distance(self, t: Reals) -> Array:
        """Stated distance (..., k) [m] at t (k,)."""
        return self.clearance.distance(self.u(t))

    def points(self, t: Reals) -> Array:
        """Points (..., k, 2) of the clearance surface at t (k,)."""
        slope = self.wall.values(t, 1)
        normal = self.clearance.inward * np.stack([-slope[..., 1], slope[..., 0]], axis=-1) / length(slope)[..., None]
        return self.wall.values(t) + self.distance(t)[..., None] * normal

    def nearest(self, points: Reals, t: Reals) -> Reals:
        """t (k,) of the wall's points nearest to `points` (k, 2), by Newton's method from t (k,)."""
        for _ in range(12):
            foot, slope, bend = (self.wall.values(t, order) for order in range(3))
            gap = points - foot
            t = t + dot(gap, slope) / np.maximum(dot(slope, slope) - dot(gap, bend), 0.1 * dot(slope, slope))
        return t

    def bend(self, t: Reals) -> Reals:
        """Curvature (k,) of the wall towards the flow path [1/m]."""
        slope, bend = self.wall.values(t, 1), self.wall.values(t, 2)
        return self.clearance.inward * cross2(slope, bend) / length(slope) ** 3


def check_folds(offset: OffsetWall, stretch: tuple[float, float]) -> None:
    """Refuse a wall that bends towards the blade more sharply than the clearance allows."""
    t = np.linspace(*stretch, SAMPLES)
    bend = offset.bend(t)
    if np.max(bend * offset.distance(t)) >= 1.0:
        raise DesignError(offset.clearance.folding(offset.u(t), bend, "flow_path"))
