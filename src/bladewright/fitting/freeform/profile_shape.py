"""A profile as a camber line and a half thickness along its normals."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.fitting.freeform.net import WEIGHT_REGULARISATION, Net
from bladewright.fitting.freeform.search import Shape
from bladewright.numerics.elementary import Array, length, turned_left
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.descent import descended

DEGREE = 3
"""degree of camber and thickness"""
THIRD_ABSCISSA = 0.0625
"""abscissa of the third control point of the thickness, of the chord (the source's section 4.2)"""
SAMPLES = 400
"""places of the camber between which an abscissa is sought, and of a side at which a search for the nearest starts"""
WEIGHT_STIFFNESS = 1e-2
"""cost of a unit of a weight's logarithm, of the bending's weight: it holds weights while the shape is found."""
STEP = 1e-30
"""imaginary step of a derivative, which is exact to rounding"""


def abscissae_of(count: int, low: float, high: float, *, round_end: bool) -> Array:
    """Abscissae (count,) of the thickness's control points."""
    last = count - 2 if round_end else count - 1
    inner = np.linspace(THIRD_ABSCISSA, 1.0, last - 1)
    share = np.concatenate([[0.0, 0.0], inner, [1.0] if round_end else []])
    return np.asarray(low + share * (high - low))


@dataclass(frozen=True, kw_only=True, eq=False)
class CamberThickness(Shape):
    """The profile of a camber (x, y) and a thickness (x, h), both over [0, 1]; its sides are exact, but no NURBS.

    Its unknowns are the camber's control points, the heights of the thickness, and the logarithms of its weights. A
    place's parameter is that of the thickness, negative on the lower side, so that the leading edge is at 0.
    """

    camber: Curve
    thickness: Curve
    round_end: bool = False
    """whether the trailing edge is round as the leading edge is"""
    fixed: bool = False
    """whether the camber's ends stay"""

    @property
    def moving(self) -> NDArray[np.intp]:
        """Control points of the camber that move."""
        count = len(self.camber.control_points)
        return np.arange(1, count - 1) if self.fixed else np.arange(count)

    @property
    def heights(self) -> NDArray[np.intp]:
        """Control points of the thickness whose height is free."""
        count = len(self.thickness.control_points)
        return np.arange(1, count - 1) if self.round_end else np.arange(1, count)

    @property
    def logs(self) -> Reals:
        """(n,) logarithms of the thickness's weights."""
        count = len(self.thickness.control_points)
        return np.zeros(count) if self.thickness.weights is None else np.log(self.thickness.weights)

    @property
    def nets(self) -> tuple[Net, Net]:
        """Camber and thickness, whose weights are unknown."""
        camber, thickness = (
            Net(
                knots=(of.knots,),
                degrees=(of.degree,),
                points=np.array(of.control_points),
                weighted=of.weights is not None,
            )
            for of in (self.camber, self.thickness)
        )
        return camber, thickness

    @property
    def unknowns(self) -> Reals:
        """Values of the unknowns."""
        camber, heights = self.camber.control_points[self.moving], self.thickness.control_points[self.heights, 1]
        return np.concatenate([camber.ravel(), heights, self.nets[1].gauge.T @ self.logs])

    def changed(self, unknowns: Array) -> CamberThickness:
        """The profile with other values of its unknowns, which may be complex."""
        moved, free = 2 * len(self.moving), len(self.heights)
        camber, net = (of.control_points.astype(unknowns.dtype) for of in (self.camber, self.thickness))
        camber[self.moving] = unknowns[:moved].reshape(-1, 2)
        net[self.heights, 1] = unknowns[moved : moved + free]
        net[:, 0] = abscissae_of(len(net), camber[0, 0], camber[-1, 0], round_end=self.round_end)
        weights = np.exp(self.nets[1].gauge @ unknowns[moved + free :])
        return replace(
            self,
            camber=replace(self.camber, control_points=camber),
            thickness=replace(self.thickness, control_points=net, weights=weights),
        )

    def nearest(self, points: Reals, near: Reals | None = None) -> Reals:
        """Parameters (m, 1) of the nearest places of points (m, 2): of all, or where descents from `near` end."""
        starts = [] if near is None else [near[:, 0]]
        if near is None:
            grid = np.linspace(0.0, 1.0, SAMPLES) ** 1.5
            starts = [side * grid[cKDTree(self.along(side * grid)[0]).query(points)[1]] for side in (1.0, -1.0)]
        found = [descended(self.along, points, start, (-1.0, 1.0)) for start in starts]
        best = np.argmin([square for _, square in found], axis=0)
        return np.stack([u for u, _ in found])[best, np.arange(len(points))][:, None]

    def tangents(self, parameters: Reals) -> tuple[Reals, Reals, NDArray[np.bool_]]:
        """Places (m, 2), tangents (m, 1, 2), and whether (m, 1) a place is free to move."""
        place, tangent, _ = self.along(parameters[:, 0])
        return place, tangent[:, None], parameters**2 < 1.0

    def slopes(self, parameters: Reals, directions: Reals) -> Reals:
        """Derivatives (r, n) by the unknowns of places at held parameters (r, 1), along directions (r, 2)."""
        u, at = parameters[:, 0], self.unknowns
        near = self.sites(self.thickness(np.abs(u))[:, 0])
        columns = [self.changed(at + 1j * STEP * each).places(u, near).imag / STEP for each in np.eye(len(at))]
        return np.stack([np.sum(column * directions, axis=-1) for column in columns], axis=-1)

    def bending(self, stiffness: float) -> tuple[Reals, Reals]:
        """Residuals (b,) whose squares are the bending, times its weight, and their derivatives (b, n)."""
        (camber, thickness), count = self.nets, len(self.unknowns)
        moved, free = 2 * len(self.moving), len(self.heights)
        roots = [np.sqrt(stiffness) * net.bending_root for net in (camber, thickness)]
        by_camber, by_heights, by_logs = (
            np.zeros((2 * len(roots[0]), count)),
            np.zeros((len(roots[1]), count)),
            np.eye(count),
        )
        by_camber[:, :moved] = np.kron(roots[0][:, self.moving], np.eye(2))
        by_heights[:, moved : moved + free] = roots[1][:, self.heights]
        cost = np.sqrt(WEIGHT_REGULARISATION**2 + WEIGHT_STIFFNESS * stiffness)
        residuals = [
            (roots[0] @ camber.points).ravel(),
            roots[1] @ thickness.points[:, 1],
            cost * self.unknowns[moved + free :],
        ]
        return np.concatenate(residuals), np.concatenate([by_camber, by_heights, cost * by_logs[moved + free :]])

    def sites(self, abscissae: Reals) -> Reals:
        """Camber parameters (n,) at abscissae (n,), by a table and Newton's method."""
        s = np.linspace(0.0, 1.0, SAMPLES)
        x = np.maximum.accumulate(self.camber(s)[:, 0])
        found = np.interp(abscissae, x, s)
        for _ in range(8):
            place, slope = self.camber.derivatives(found, 1)
            rate = slope[:, 0]
            step = (place[:, 0] - abscissae) / np.where(rate > 1e-9, rate, 1e-9)
            found = np.clip(found - np.clip(step, -0.1, 0.1), 0.0, 1.0)
        return np.asarray(found)

    def places(self, u: Reals, near: Reals) -> Array:
        """Points (n, 2) at parameters u (n,), whose camber parameters are `near` (n,) to first order."""
        x, h = self.thickness(np.abs(u)).T
        first, slope = self.camber.derivatives(near, 1)
        place, tangent = self.camber.derivatives(near + (x - first[:, 0]) / slope[:, 0], 1)
        return np.asarray(place + (np.where(u < 0.0, -1.0, 1.0) * h / length(tangent))[:, None] * turned_left(tangent))

    def along(self, u: Reals) -> list[Reals]:
        """The point of a side and its first two derivatives (n, 2) by the parameter u (n,), negative on the lower."""
        sign = np.where(u < 0.0, -1.0, 1.0)[:, None]
        of = self.thickness.derivatives(np.abs(u), 2)
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
        return [c0 + sign * h[:, None] * normal, sign * first, second]
