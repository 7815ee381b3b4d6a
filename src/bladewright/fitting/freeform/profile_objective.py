"""The objective of a profile fit: true distances from its sides, and derivatives by camber, heights and weights."""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from bladewright.fitting.freeform.camber_thickness import CamberThickness
from bladewright.fitting.freeform.least_squares import (
    Penalty,
    Quadratic,
    quadratic_of_distances,
)
from bladewright.fitting.freeform.net import WEIGHT_REGULARISATION, Net
from bladewright.fitting.freeform.projection import Projections, with_frames
from bladewright.numerics.elementary import length, turned_left
from bladewright.nurbs.basis import Reals, basis
from bladewright.nurbs.descent import descended

DEGREE = 3
"""degree of camber and thickness"""
SIDE_SAMPLES = 400
"""places of a side at which a search for the nearest one starts"""


@dataclass(frozen=True, kw_only=True, eq=False)
class ProfileObjective:
    """The objective of a profile, of its camber's control points, its heights and logarithms of weights."""

    points: Reals
    upper: NDArray[np.bool_]
    fixed: bool
    penalty: Penalty
    stiffness: float
    profile: CamberThickness

    @property
    def moving(self) -> NDArray[np.intp]:
        """Control points of the camber that move."""
        count = len(self.profile.camber.control_points)
        return np.arange(1, count - 1) if self.fixed else np.arange(count)

    @property
    def heights(self) -> NDArray[np.intp]:
        """Control points of the thickness whose height is free."""
        count = len(self.profile.thickness.control_points)
        return np.arange(1, count - 1) if self.profile.round_end else np.arange(1, count)

    @property
    def net(self) -> Net:
        """The thickness with unknown weights, for its gauge."""
        of = self.profile.thickness
        points = np.array(of.control_points)
        return Net(
            knots=(of.knots,), degrees=(DEGREE,), points=points, log_weights=np.log(self.profile.weights), weighted=True
        )

    @property
    def unknowns(self) -> Reals:
        camber = self.profile.camber.control_points[self.moving].ravel()
        return np.concatenate(
            [camber, self.profile.thickness.control_points[self.heights, 1], np.zeros(self.net.gauge.shape[1])]
        )

    def changed(self, unknowns: Reals) -> CamberThickness:
        """The profile with other values of its unknowns."""
        moved, free = 2 * len(self.moving), len(self.heights)
        camber = self.profile.camber.control_points.copy()
        camber[self.moving] = unknowns[:moved].reshape(-1, 2)
        net = self.profile.thickness.control_points.copy()
        net[self.heights, 1] = unknowns[moved : moved + free]
        log_weights = np.log(self.profile.weights) + self.net.gauge @ unknowns[moved + free :]
        weights = np.exp(np.clip(log_weights, -10.0, 10.0))
        found = replace(
            self.profile,
            camber=replace(self.profile.camber, control_points=camber),
            thickness=replace(self.profile.thickness, control_points=net, weights=weights),
        )
        return found if self.fixed else found.between(camber[[0, -1]])

    def footpoints(self, profile: CamberThickness) -> Projections:
        """The nearest places of the points on their sides."""
        t = np.zeros(len(self.points))
        grid = np.linspace(0.0, 1.0, SIDE_SAMPLES) ** 1.5
        for side in (True, False):
            rows = np.flatnonzero(self.upper == side)
            if len(rows):
                samples = profile.derivatives(grid, upper=side)[0]
                first = grid[cKDTree(samples).query(self.points[rows])[1]]
                t[rows], _ = descended(partial(profile.derivatives, upper=side), self.points[rows], first, (0.0, 1.0))
        place, tangent, _ = profile.derivatives(t, upper=self.upper)
        # a side goes on as the other one past the leading edge
        free = (t > 0.0) & (t < 1.0)
        return with_frames(t[:, None], place, self.points, [tangent], free[:, None])

    def objective(self, unknowns: Reals) -> Quadratic:
        profile = self.changed(unknowns)
        return self.of_distances(profile, self.footpoints(profile)) + self._of_shape(profile, unknowns)

    def of_distances(self, profile: CamberThickness, footpoints: Projections) -> Quadratic:
        counts = np.where(self.upper, self.upper.sum(), (~self.upper).sum())
        t, of = footpoints.parameters[:, 0], footpoints.across_of
        return quadratic_of_distances(
            self.rows(profile, t, self.upper, footpoints.along),
            footpoints.distances,
            self.rows(profile, t[of], self.upper[of], footpoints.across),
            of,
            self.penalty,
            1.0 / counts,
        )

    def rows(self, profile: CamberThickness, t: Reals, upper: NDArray[np.bool_], directions: Reals) -> csr_array:
        """(m, n) derivatives by the unknowns of sides at t (m,), along directions (m, 2)."""
        thickness, camber, net = profile.thickness, profile.camber, replace(self, profile=profile).net
        ratio = net.basis(t[:, None]).toarray()
        x, h = thickness(t).T
        s = profile.sites(x)
        first, second = camber.derivatives(s, 2)[1:]
        size = length(first)[:, None]
        tangent, sign = first / size, np.where(upper, 1.0, -1.0)[:, None]
        normal = turned_left(tangent)
        # along the side's direction: the camber's point, the turn of its normal (-t . n') and the height itself
        lift = np.sum(directions * normal, axis=-1, keepdims=True) * sign
        turn = -np.sum(directions * tangent, axis=-1, keepdims=True) * sign * h[:, None] / size
        at, slope = basis(camber.knots, DEGREE, s), basis(camber.knots, DEGREE, s, 1)
        by_camber = at[:, :, None] * directions[:, None] + (slope * turn)[:, :, None] * normal[:, None]
        by_site = np.sum(first * directions, axis=-1, keepdims=True) + turn * np.sum(second * normal, axis=-1)[:, None]
        # the camber's parameter follows its own abscissa and that of the thickness
        by_abscissa = by_site / first[:, :1]
        by_camber[:, :, 0] -= at * by_abscissa
        by_control = ratio * by_abscissa
        log_weights = ratio * (thickness.control_points[:, 0] - x[:, None]) * by_abscissa
        log_weights += ratio * (thickness.control_points[:, 1] - h[:, None]) * lift
        if not self.fixed:
            low, high = camber.control_points[[0, -1], 0]
            share = (thickness.control_points[:, 0] - low) / (high - low)
            by_camber[:, 0, 0] += by_control @ (1.0 - share)
            by_camber[:, -1, 0] += by_control @ share
        columns = [
            by_camber[:, self.moving].reshape(len(t), 2 * len(self.moving)),
            (ratio * lift)[:, self.heights],
            log_weights @ net.gauge,
        ]
        return csr_array(np.concatenate(columns, axis=1))

    def _of_shape(self, profile: CamberThickness, unknowns: Reals) -> Quadratic:
        count, moved, free = len(unknowns), 2 * len(self.moving), len(self.heights)
        camber, thickness = profile.camber, profile.thickness
        value, gradient, curvature = 0.0, np.zeros(count), np.zeros((count, count))
        bending = Net(knots=(camber.knots,), degrees=(DEGREE,), points=np.array(camber.control_points)).bending
        pull = self.stiffness * bending @ camber.control_points
        value += float(np.sum(pull * camber.control_points))
        gradient[:moved] = pull[self.moving].ravel()
        curvature[:moved, :moved] = np.kron(self.stiffness * bending[np.ix_(self.moving, self.moving)], np.eye(2))
        net, rows = self.net, slice(moved, moved + free)
        pull = self.stiffness * net.bending @ thickness.control_points[:, 1]
        value += float(pull @ thickness.control_points[:, 1])
        gradient[rows] = pull[self.heights]
        curvature[rows, rows] = self.stiffness * net.bending[np.ix_(self.heights, self.heights)]
        own, cost = net.gauge.T @ np.log(profile.weights), WEIGHT_REGULARISATION**2 + 1e-2 * self.stiffness
        value += cost * float(own @ own)
        gradient[moved + free :] = cost * own
        curvature[moved + free :, moved + free :] = cost * np.eye(len(own))
        return Quadratic(value=value, gradient=gradient, curvature=curvature)
