"""The parametrisation of the sides that makes their meeting at an edge twice differentiable.

Both sides have the edge's radius of curvature but reach the edge at different speeds. Inside the knot span next to the
edge the side's own parameter a becomes a polynomial of the section's parameter s,

    a(s) = s + (alpha - 1) h p(s / h) + beta h^2 q(s / h),    p(x) = x (1 - x)^4 (1 + 4 x),    q(x) = x^2 (1 - x)^4 / 2,

with a' = alpha and a'' = beta at the edge, and no change of value and three derivatives at the span's other end h.
alpha and beta are chosen so that the two sides have opposite first and equal second derivatives at the edge.
"""

from dataclasses import dataclass

import numpy as np

from bladewright.numerics.elementary import Array, dot
from bladewright.nurbs.basis import Reals

BRAKE = 20.0
"""square of the rise (second derivative over first, in knot spans) from which the sides are slowed at an edge

With alpha = (1 + rise^2 / BRAKE)^(-1/3) and beta h = -rise alpha^2 the parametrisation is monotone for every rise: its
slope stays above 0.56 alpha, also where the sides' speeds differ by a quarter and their rises by half
(design/edge_parametrisation.py).
"""


@dataclass(frozen=True, kw_only=True)
class Edge:
    """One edge of a section, seen from the edge into the blade."""

    normal_speed: Array
    """(...) common speed d|C|/ds of both sides"""
    tangential: Array
    """(...) second derivative along the camber's normal, common to both sides"""
    upper: tuple[Array, Array]
    """alpha, beta (...) of the upper side"""
    lower: tuple[Array, Array]
    """alpha, beta (...) of the lower side"""


def edge(upper: Array, lower: Array, normal: Array, span: float) -> Edge:
    """The common parametrisation of both sides at an edge.

    `upper` and `lower` (..., k, 2) are the sides' Taylor coefficients at the edge by their own parameter (value,
    first derivative, half the second...), `normal` (..., 2) the camber's normal towards the upper side, `span` the
    length h of the knot span next to the edge.
    """
    speed_upper = dot(upper[..., 1, :], normal)
    speed_lower = -dot(lower[..., 1, :], normal)
    second_upper = 2.0 * dot(upper[..., 2, :], normal)
    second_lower = 2.0 * dot(lower[..., 2, :], normal)
    rise = span * (second_upper / speed_upper - second_lower / speed_lower) / 2.0
    brake = (1.0 + rise**2 / BRAKE) ** (-1.0 / 3.0)
    speed = np.sqrt(speed_upper * speed_lower) * brake
    alpha_upper = speed / speed_upper
    alpha_lower = speed / speed_lower
    along_upper = alpha_upper**2 * second_upper
    along_lower = alpha_lower**2 * second_lower
    common = (along_upper + along_lower) / 2.0
    return Edge(
        normal_speed=speed,
        tangential=common,
        upper=(alpha_upper, (common - along_upper) / speed_upper),
        lower=(alpha_lower, (along_lower - common) / speed_lower),
    )


def reparametrised(s: Reals, alpha: Array, beta: Array, span: float) -> Array:
    """The side's own parameter a (..., len(s)) at distances s in [0, span] from the edge."""
    x = s / span
    return (
        s
        + (alpha - 1.0)[..., None] * (span * x * (1 - x) ** 4 * (1 + 4 * x))
        + beta[..., None] * (span**2 * x**2 * (1 - x) ** 4 / 2)
    )
