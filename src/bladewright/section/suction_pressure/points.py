"""The characteristic points of an edge: where it lies, where the two sides leave it, and in which direction.

The edge is modelled on two quarters of ellipses about a common nose, with the semi-axis b = `radius` across the edge's
direction and a (1 + skew), a (1 - skew) along it, a / b = `stretch`; each side leaves its quarter where the ellipse has
the side's direction, half the wedge angle off the edge's. Voss et al. 2025, section 3 and Fig. 3.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bladewright.numerics.elementary import Array
from bladewright.section.camber import turned_left

Continuity = Literal["C1", "C2"]

OPENING = {"C1": 1.2, "C2": 0.95}
"""largest a / b tan(wedge / 2): beyond it no edge of the nose's radius of curvature reaches the sides"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Corner:
    """Where a side leaves an edge."""

    point: Array
    """(..., 2)"""
    offset: Array
    """(..., 2) of the point from the nose"""
    direction: Array
    """(..., 2) unit vector from the edge along the side, into the blade"""
    speed: Array
    """(...) of the edge there, by a parameter that is 0 at the nose and 1 at the corner"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Points:
    """The three characteristic points of an edge: its nose and the corners of both sides."""

    nose: Array
    """(2,)"""
    inward: Array
    """(..., 2) unit vector of the edge's direction, from the nose into the blade"""
    upper: Corner
    lower: Corner


def opening(stretch: Array, wedge: Array) -> Array:
    """a / b tan(wedge / 2) (...): cotangent of the ellipse's parameter at which a side leaves it."""
    return stretch * np.tan(0.5 * wedge)


def characteristic_points(
    nose: Array,
    camber_angle: Array,
    *,
    inward: float,
    radius: Array,
    stretch: Array,
    skew: Array,
    wedge: Array,
    continuity: Continuity,
) -> Points:
    """The characteristic points of an edge at `nose` (2,), its camber line's angle from the chord line (...) [rad].

    `inward` is 1 where the camber line leaves the edge (leading), -1 where it arrives (trailing); radius (...) in
    chords, stretch, skew (positive: longer on the upper side) (...), wedge (...) [rad].
    """
    forward = np.stack([np.cos(camber_angle), np.sin(camber_angle)], axis=-1)
    along, across = inward * forward, turned_left(forward)
    corners = [
        _corner(nose, along, sign * across, radius, stretch * (1.0 + sign * skew), wedge, continuity)
        for sign in (1.0, -1.0)
    ]
    return Points(nose=nose, inward=along, upper=corners[0], lower=corners[1])


def _corner(
    nose: Array, along: Array, across: Array, radius: Array, stretch: Array, wedge: Array, continuity: Continuity
) -> Corner:
    ratio = opening(stretch, wedge)
    sine = 1.0 / np.sqrt(1.0 + ratio**2)
    advance, height = stretch * (1.0 - ratio * sine), sine
    c, s = np.cos(0.5 * wedge), np.sin(0.5 * wedge)
    offset = radius[..., None] * (advance[..., None] * along + height[..., None] * across)
    return Corner(
        point=nose + offset,
        offset=offset,
        direction=c[..., None] * along + s[..., None] * across,
        speed=radius * _speed(advance, height, c, s, stretch, continuity),
    )


def _speed(x: Array, y: Array, c: Array, s: Array, stretch: Array, continuity: Continuity) -> Array:
    """Speed m at the corner (x, y), direction (c, s), that gives the nose the ellipse's curvature, a / b^2 with b = 1.

    For mirrored straight sides the edge's polynomial has x'' / y'^2 at the nose, with x'' = 2 (p x - q m c) and
    y' = u y - v m s: a quadratic in m.
    """
    p, q, u, v = (2.0, 0.5, 1.5, 0.5) if continuity == "C1" else (3.0, 1.125, 1.875, 0.875)
    square = stretch * (v * s) ** 2
    linear = 2.0 * q * c - 2.0 * u * v * stretch * y * s
    constant = stretch * (u * y) ** 2 - 2.0 * p * x
    return -2.0 * constant / (linear + np.sqrt(linear**2 - 4.0 * square * constant))
