"""Quintic splines through points of many sections at once, closed or open, at parameters that may be complex."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.numerics.elementary import Array, length
from bladewright.nurbs.basis import Reals
from bladewright.section.power_series import Series, polynomial, variable

DEGREE = 5
"""degree of the spline: four continuous derivatives, so that curvature and its slope are smooth through the points"""


@dataclass(frozen=True, kw_only=True, eq=False)
class QuinticSpline:
    """Curves with four continuous derivatives through points (..., n, 2), at centripetal parameters (Lee 1989).

    A closed one has a knot at each site, an open one at each but the second and the third from its ends. Sites and
    knots move with the points, so that the curve is a differentiable function of them.
    """

    points: Array
    closed: bool

    @cached_property
    def sites(self) -> Array:
        """Sums (..., n) of the roots of the distances; at the end of a closed one the sum of all."""
        points = self.points
        if self.closed:
            points = np.concatenate([points, points[..., :1, :]], axis=-2)
        steps = np.sqrt(length(points[..., 1:, :] - points[..., :-1, :]))
        return np.concatenate([np.zeros_like(steps[..., :1]), np.cumsum(steps, axis=-1)], axis=-1)

    @cached_property
    def knots(self) -> Array:
        """Knots (..., k); a closed one's are continued by five at each end."""
        sites = self.sites
        if self.closed:
            whole = sites[..., -1:]
            return np.concatenate([sites[..., -DEGREE - 1 : -1] - whole, sites, sites[..., 1 : DEGREE + 1] + whole], -1)
        ends = [np.repeat(sites[..., i : i + 1 or None], DEGREE + 1, axis=-1) for i in (0, -1)]
        return np.concatenate([ends[0], sites[..., 3:-3], ends[1]], axis=-1)

    @cached_property
    def breaks(self) -> Reals:
        """Places (..., j) within one turn where the fifth derivative jumps."""
        found: Reals = np.real(self.sites[..., :-1] if self.closed else self.knots[..., DEGREE + 1 : -DEGREE - 1])
        return found

    def at(self, t: Series) -> tuple[Series, Series]:
        """Coordinates at parameters t (..., k), of a closed one at any number of turns."""
        if self.closed:
            whole = self.sites[..., -1:]
            t = t - np.floor(np.real(t.value) / np.real(whole)) * whole
        starts = self._starts
        shape = np.broadcast_shapes(t.value.shape[:-1], starts.shape[:-1])
        place = np.broadcast_to(np.real(t.value), (*shape, t.value.shape[-1]))
        piece = np.sum(place[..., None] >= np.real(starts)[..., None, 1:], axis=-1)
        step = t - np.take_along_axis(np.broadcast_to(starts, (*shape, starts.shape[-1])), piece, axis=-1)

        def along(axis: int) -> Series:
            rows = [np.broadcast_to(each[axis], (*shape, each[axis].shape[-1])) for each in self._powers]
            return polynomial([np.take_along_axis(row, piece, axis=-1) for row in rows], step)

        return along(0), along(1)

    @cached_property
    def _starts(self) -> Array:
        """Parameters (..., p) at which the pieces begin."""
        return self.sites[..., :-1] if self.closed else self.knots[..., DEGREE : -DEGREE - 1]

    @cached_property
    def _powers(self) -> list[tuple[Array, Array]]:
        """Coefficients of both coordinates (..., p) for the powers of the distance from each piece's start."""
        span, values = self._basis(variable(self._starts, DEGREE))
        count = self.points.shape[-2]
        column = self._column(span)
        shape = np.broadcast_shapes(column.shape[:-2], self._controls.shape[:-2])
        index = np.broadcast_to(column, (*shape, *column.shape[-2:])).reshape(*shape, -1)
        found = []
        for axis in (0, 1):
            controls = np.broadcast_to(self._controls[..., axis], (*shape, count))
            taken = np.take_along_axis(controls, index, axis=-1).reshape(*shape, *column.shape[-2:])
            total = values[0] * taken[..., 0]
            for q in range(1, DEGREE + 1):
                total = total + values[q] * taken[..., q]
            found.append(total.coefficients)
        return list(zip(*found, strict=True))

    @cached_property
    def _controls(self) -> Array:
        """Control points (..., n, 2)."""
        count = self.points.shape[-2]
        span, values = self._basis(Series([self.sites[..., :count]]))
        rows = np.stack([each.value for each in values], axis=-1)
        own = self._column(span)[..., None] == np.arange(count)
        return np.linalg.solve(np.sum(rows[..., None] * own, axis=-2), self.points)

    def _column(self, span: Array) -> Array:
        """Indices (..., k, 6) of the control points that count on knot spans (..., k)."""
        column: Array = span[..., None] - DEGREE + np.arange(DEGREE + 1)
        return column % self.points.shape[-2] if self.closed else column

    def _basis(self, t: Series) -> tuple[Array, list[Series]]:
        """Knot spans (..., k) of parameters (..., k), and the six basis functions that do not vanish there.

        Piegl and Tiller 1997, algorithm A2.2, with knots that may be complex.
        """
        knots = self.knots
        shape = np.broadcast_shapes(t.value.shape[:-1], knots.shape[:-1])
        at = np.broadcast_to(np.real(t.value), (*shape, t.value.shape[-1]))
        wide = np.broadcast_to(knots, (*shape, knots.shape[-1]))
        inner = np.real(wide)[..., None, DEGREE + 1 : -DEGREE - 1]
        span = DEGREE + np.sum(at[..., None] >= inner, axis=-1)
        ahead = [t * -1.0 + np.take_along_axis(wide, span + 1 + j, axis=-1) for j in range(DEGREE)]
        behind = [t - np.take_along_axis(wide, span - j, axis=-1) for j in range(DEGREE)]
        values = [t * 0.0 + 1.0]
        for j in range(1, DEGREE + 1):
            saved, following = t * 0.0, []
            for r in range(j):
                part = values[r] / (ahead[r] + behind[j - r - 1]).value
                following.append(saved + ahead[r] * part)
                saved = behind[j - r - 1] * part
            values = [*following, saved]
        return span, values
