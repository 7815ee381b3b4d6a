"""The curve of an edge: one polynomial through the three characteristic points that continues both sides."""

from dataclasses import dataclass

import numpy as np

from bladewright.numerics.elementary import Array, dot, joined
from bladewright.section.suction_pressure.points import Continuity, Points


@dataclass(frozen=True, kw_only=True, eq=False)
class EdgeCurve:
    """An edge by t, -1 where it meets the lower side, 0 at the nose, 1 where it meets the upper side."""

    coefficients: Array
    """(..., 5 or 7, 2) of the powers of t"""
    camber: Array
    """(..., 5, 2) of the powers of t in [0, 1] of the camber line from the nose to the middle of the two corners"""


def edge_curve(points: Points, bend_upper: Array, bend_lower: Array, continuity: Continuity) -> EdgeCurve:
    """The polynomial of degree 4 (C1) or 6 (C2) through corner, nose and corner, with the sides' derivatives there.

    The bends (..., 2) are the sides' curvature vectors at the corners times the speed squared; C1 leaves them alone.
    Being one polynomial, the edge is smooth to any order at the nose.
    """
    (even, even_1, even_2), (odd, odd_1, odd_2) = _halves(points, bend_upper, bend_lower)
    nose = np.broadcast_to(points.nose, even.shape)
    if continuity == "C1":
        fourth = 0.5 * even_1 - even
        third = 0.5 * (odd_1 - odd)
        powers = [nose, odd - third, even - fourth, third, fourth]
    else:
        fifth = 0.125 * (odd_2 - 3.0 * odd_1 + 3.0 * odd)
        third = 0.5 * (odd_1 - odd) - 2.0 * fifth
        sixth = 0.125 * (even_2 - 5.0 * even_1 + 8.0 * even)
        fourth = 0.5 * (even_1 - 2.0 * even) - 2.0 * sixth
        powers = [nose, odd - third - fifth, even - fourth - sixth, third, fourth, fifth, sixth]
    return EdgeCurve(coefficients=_stacked(powers), camber=_camber(points, nose, even, even_1, even_2))


def powers_at(coefficients: Array, t: Array) -> Array:
    """Values (..., k, 2) of polynomials with coefficients (..., n, 2) at t (k,) or (..., k)."""
    found = coefficients[..., -1:, :] + 0.0 * t[..., None]
    for power in range(coefficients.shape[-2] - 2, -1, -1):
        found = found * t[..., None] + coefficients[..., power : power + 1, :]
    return found


def _halves(points: Points, bend_upper: Array, bend_lower: Array) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
    """Even and odd parts at t = 1 of the edge about its nose, with two derivatives."""
    upper, lower = points.upper, points.lower
    at_upper = (upper.point - points.nose, upper.speed[..., None] * upper.direction, bend_upper)
    at_lower = (lower.point - points.nose, -lower.speed[..., None] * lower.direction, bend_lower)
    even = tuple(0.5 * (a + sign * b) for a, b, sign in zip(at_upper, at_lower, (1.0, -1.0, 1.0), strict=True))
    odd = tuple(0.5 * (a - sign * b) for a, b, sign in zip(at_upper, at_lower, (1.0, -1.0, 1.0), strict=True))
    return even, odd


def _camber(points: Points, nose: Array, even: Array, even_1: Array, even_2: Array) -> Array:
    """Quartic from the nose in the edge's direction that continues the middle between the sides to second order."""
    first = dot(even, points.inward)[..., None] * points.inward
    value, slope = even - first, even_1 - first
    fourth = 0.5 * (even_2 - 4.0 * slope + 6.0 * value)
    third = slope - 2.0 * value - 2.0 * fourth
    return _stacked([nose, first, value - third - fourth, third, fourth])


def _stacked(rows: list[Array]) -> Array:
    return joined([row[..., None, :] for row in rows], axis=-2)
