"""From what a table says of a section to parameters: the meanline of a stagger, the rear of an edge radius."""

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import brentq

from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import Reals

UPRIGHT = 90.0 - 1e-6
"""Largest angle of a meanline's end from its chord, whose tangent is still finite [deg]"""


def _integrals(points: tuple[float, float, float]) -> tuple[float, float]:
    """I and J of the second derivative with three control points, as the family has it: extended by one at each end."""
    first, middle, last = points
    row = [2.0 * first - middle, first, middle, last, 2.0 * last - middle]
    u, weight = panels([0.0, 0.5, 1.0], 4)
    values = BSpline(0.5 * np.arange(-3.0, 6.0), row, 3)(u)
    return float(weight @ values), float(weight @ ((1.0 - u) * values))


def share_of(points: tuple[float, float, float]) -> float:
    """The share of the slopes at both ends of the meanline at the leading edge."""
    whole, ahead = _integrals(points)
    return ahead / whole


def other_point(share: float) -> float:
    """The middle and the last control point beside a first of 1, for a share of one half or more."""
    (own, own_ahead), (both, both_ahead) = _integrals((1.0, 0.0, 0.0)), _integrals((0.0, 1.0, 1.0))
    return (own_ahead - share * own) / (share * both - both_ahead)


def stagger_of(inlet: float, outlet: float, share: float) -> float:
    """The stagger [deg] with such a share of the slopes at both ends of the meanline at the leading edge."""

    def missed(stagger: float) -> float:
        first, last = np.tan(np.radians([inlet - stagger, outlet - stagger]))
        return float((1.0 - share) * first + share * last)

    low, high = sorted((inlet, outlet))
    # the meanline is a graph over its chord: both ends are less than 90 deg off it
    low, high = max(low, high - UPRIGHT), min(high, low + UPRIGHT)
    return float(brentq(missed, low, high)) if inlet != outlet else inlet


def parabolic_rear(most: Reals, place: Reals, radius: Reals) -> tuple[Reals, Reals]:
    """Slopes of the half thickness at the trailing edge, and thicknesses where its circle begins, in chords.

    A parabola falls over its length by half its last slope times that length. The circle of the radius R that is
    tangent to a side of the slope m begins at the half thickness R / sqrt(1 + m^2), R / sqrt(1 + m^2) / (sqrt(1 + m^2)
    - m) before the edge.
    """
    slope = np.zeros_like(most)
    for _ in range(50):
        steep = np.sqrt(1.0 + slope**2)
        half = radius / steep
        slope = -2.0 * (0.5 * most - half) / (1.0 - place - half / (steep - slope))
    return slope, 2.0 * radius / np.sqrt(1.0 + slope**2)
