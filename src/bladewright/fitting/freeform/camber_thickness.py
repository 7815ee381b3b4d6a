"""A profile as a camber line and a half thickness along its normals."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bladewright.numerics.elementary import length, turned_left
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve

THIRD_ABSCISSA = 0.0625
"""abscissa of the third control point of the thickness, of the chord (the source's section 4.2)"""
CAMBER_SAMPLES = 400
"""places of the camber between which an abscissa is sought"""


def abscissae_of(count: int, low: float, high: float, *, round_end: bool) -> Reals:
    """Abscissae (count,) of the thickness's control points."""
    last = count - 2 if round_end else count - 1
    inner = np.linspace(THIRD_ABSCISSA, 1.0, last - 1)
    share = np.concatenate([[0.0, 0.0], inner, [1.0] if round_end else []])
    return np.asarray(low + share * (high - low))


@dataclass(frozen=True, kw_only=True, eq=False)
class CamberThickness:
    """The profile of a camber (x, y) and a thickness (x, h), both over [0, 1]; its sides are exact, but no NURBS."""

    camber: Curve
    thickness: Curve
    round_end: bool = False
    """whether the trailing edge is round as the leading edge is"""

    @property
    def weights(self) -> Reals:
        """(n,) of the thickness."""
        weights = self.thickness.weights
        return np.ones(len(self.thickness.control_points)) if weights is None else weights

    def between(self, ends: Reals) -> "CamberThickness":
        """The profile with its camber's ends moved, and the abscissae of the thickness with them."""
        net = self.camber.control_points.copy()
        net[[0, -1]] = ends
        abscissae = abscissae_of(len(self.thickness.control_points), ends[0, 0], ends[1, 0], round_end=self.round_end)
        heights = self.thickness.control_points[:, 1]
        return replace(
            self,
            camber=replace(self.camber, control_points=net),
            thickness=replace(self.thickness, control_points=np.stack([abscissae, heights], axis=-1)),
        )

    def sites(self, abscissae: Reals) -> Reals:
        """Camber parameters (n,) at abscissae (n,), by a table and Newton's method."""
        s = np.linspace(0.0, 1.0, CAMBER_SAMPLES)
        x = np.maximum.accumulate(self.camber(s)[:, 0])
        found = np.interp(abscissae, x, s)
        for _ in range(8):
            place, slope = self.camber.derivatives(found, 1)
            rate = slope[:, 0]
            step = (place[:, 0] - abscissae) / np.where(rate > 1e-9, rate, 1e-9)
            found = np.clip(found - np.clip(step, -0.1, 0.1), 0.0, 1.0)
        return np.asarray(found)

    def derivatives(self, t: Reals, *, upper: bool | NDArray[np.bool_]) -> list[Reals]:
        """The point of a side and its first two derivatives (n, 2) by t (n,)."""
        sign = np.where(upper, 1.0, -1.0)[..., None]
        of = self.thickness.derivatives(t, 2)
        (x1, h1), (x2, h2) = of[1].T, of[2].T
        s = self.sites(of[0][:, 0])
        c0, c1, c2, c3 = self.camber.derivatives(s, 3)
        s1 = x1 / c1[:, 0]
        s2 = (x2 - c2[:, 0] * s1**2) / c1[:, 0]
        size = length(c1)
        normal = turned_left(c1) / size[:, None]
        tangent = c1 / size[:, None]
        # the normal turns against the tangent as the camber's curvature times its length
        turn = (c1[:, 0] * c2[:, 1] - c1[:, 1] * c2[:, 0]) / size**2
        turn1 = (c1[:, 0] * c3[:, 1] - c1[:, 1] * c3[:, 0]) / size**2 - 2.0 * turn * np.sum(c1 * c2, axis=-1) / size**2
        n1 = -turn[:, None] * tangent
        n2 = -turn1[:, None] * tangent - (turn**2)[:, None] * normal
        h = of[0][:, 1]
        by_s1, by_s2 = s1[:, None], s2[:, None]
        first = c1 * by_s1 + sign * (h1[:, None] * normal + h[:, None] * n1 * by_s1)
        second = c2 * by_s1**2 + c1 * by_s2
        second = second + sign * (
            h2[:, None] * normal + 2.0 * (h1 * s1)[:, None] * n1 + h[:, None] * (n2 * by_s1**2 + n1 * by_s2)
        )
        return [c0 + sign * h[:, None] * normal, first, second]
