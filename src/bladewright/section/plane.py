"""Sections in their plane, many at once: both sides as functions of one parameter s from leading to trailing edge."""

from dataclasses import dataclass
from functools import lru_cache
from math import factorial

import numpy as np

from bladewright.numerics.elementary import Array, joined
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.section.camber import camber_tangents, turned_left
from bladewright.section.edges import Edge, edge, reparametrised
from bladewright.section.sides import DEGREE


@dataclass(frozen=True, kw_only=True)
class PlaneSections:
    """Sections (...) whose sides are B-splines, rational where the control points are homogeneous."""

    camber: Array
    """(..., 4, 2) control points of the camber lines"""
    upper: Array
    """(..., n, 2) or homogeneous (..., n, 3)"""
    lower: Array
    """(..., n, 2) or homogeneous (..., n, 3)"""
    leading_edge: Edge
    trailing_edge: Edge

    @property
    def span(self) -> float:
        """Length of a knot span of the sides."""
        return 1.0 / (self.upper.shape[-2] - DEGREE)

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., len(s), 2) of the upper and the lower side at s in [0, 1], increasing."""
        upper = _side_points(self.upper, s, self.span, self.leading_edge.upper, self.trailing_edge.upper)
        return upper, _side_points(self.lower, s, self.span, self.leading_edge.lower, self.trailing_edge.lower)


def plane_sections(camber: Array, upper: Array, lower: Array) -> PlaneSections:
    """Sections from camber lines and the control points of their sides."""
    span = 1.0 / (upper.shape[-2] - DEGREE)
    normals = turned_left(camber_tangents(camber, np.array([0.0, 1.0])))
    ends = [
        edge(taylor(upper, flip), taylor(lower, flip), normals[..., i, :], span) for i, flip in enumerate((False, True))
    ]
    return PlaneSections(camber=camber, upper=upper, lower=lower, leading_edge=ends[0], trailing_edge=ends[1])


def matched(upper: Array, lower: Array) -> tuple[Array, Array]:
    """Both sides' control points homogeneous where one of them is."""
    if upper.shape[-1] == lower.shape[-1]:
        return upper, lower
    sides = [np.concatenate([c, np.ones_like(c[..., :1])], axis=-1) if c.shape[-1] == 2 else c for c in (upper, lower)]
    return sides[0], sides[1]


def taylor(controls: Array, from_end: bool) -> Array:
    """Taylor coefficients (..., 5, 2) of a side at its start, or at its end by the distance from it.

    A rational side's series is that of the quotient, cut after the fourth power: only its first three serve.
    """
    series = _taylor_matrix(controls.shape[-2], from_end=from_end) @ controls
    return series if controls.shape[-1] == 2 else _quotient(series)


def _quotient(series: Array) -> Array:
    weight = series[..., 2]
    terms: list[Array] = []
    for k in range(series.shape[-2]):
        value = series[..., k, :2]
        for i in range(k):
            value = value - weight[..., k - i, None] * terms[i]
        terms.append(value / weight[..., 0, None])
    return np.stack(terms, axis=-2)


@lru_cache(maxsize=64)
def _taylor_matrix(count: int, from_end: bool) -> Reals:
    knots = uniform_knots(count, DEGREE)
    at = np.array([1.0 if from_end else 0.0])
    sign = -1.0 if from_end else 1.0
    rows = [basis(knots, DEGREE, at, order)[0] * sign**order / factorial(order) for order in range(DEGREE + 1)]
    return np.stack(rows)


def _side_points(controls: Array, s: Reals, span: float, start: tuple[Array, Array], end: tuple[Array, Array]) -> Array:
    first = int(np.searchsorted(s, span, side="left"))
    last = max(first, int(np.searchsorted(s, 1.0 - span, side="right")))
    knots = uniform_knots(controls.shape[-2], DEGREE)
    middle = basis(knots, DEGREE, s[first:last]) @ controls
    at_start = _polynomial(
        _taylor_matrix(controls.shape[-2], from_end=False) @ controls, reparametrised(s[:first], *start, span)
    )
    distance = reparametrised(1.0 - s[last:], *end, span)
    at_end = _polynomial(_taylor_matrix(controls.shape[-2], from_end=True) @ controls, distance)
    points = joined([at_start, middle, at_end], axis=-2)
    return points if points.shape[-1] == 2 else points[..., :2] / points[..., 2:]


def _polynomial(series: Array, a: Array) -> Array:
    value = np.broadcast_to(series[..., -1:, :], (*a.shape, series.shape[-1]))
    for k in range(series.shape[-2] - 2, -1, -1):
        value = value * a[..., None] + series[..., k : k + 1, :]
    return value
