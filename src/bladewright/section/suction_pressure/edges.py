"""The edges of a section by suction and pressure side: characteristic points, and one polynomial through them.

An edge is modelled on two quarters of ellipses about a common nose, with the semi-axis b = `radius` across the edge's
direction and a (1 + skew), a (1 - skew) along it, a / b = `stretch`. Each side leaves its quarter where the ellipse has
the side's direction, half the wedge angle off the edge's. Reference: Voss et al. 2025, section 3 and Fig. 3.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bladewright.numerics.elementary import Array, concatenated, dot, turned_left
from bladewright.nurbs.basis import Reals
from bladewright.section.power_series import polynomial_points

Continuity = Literal["C1", "C2"]

MAX_OPENING = {"C1": 1.2, "C2": 0.95}
"""largest a / b tan(wedge / 2) of a C1 and of a C2 edge: beyond it no edge of the nose's radius of curvature reaches
the sides [-]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Corner:
    """Where a side leaves an edge."""

    nose: Array
    """(2,) of the edge"""
    inward: Array
    """(..., 2) unit vector of the edge's direction, from the nose into the blade"""
    offset: Array
    """(..., 2) of the corner from the nose"""
    direction: Array
    """(..., 2) unit vector from the edge along the side, into the blade"""
    speed: Array
    """(...) of the edge there, by a parameter that is 0 at the nose and 1 at the corner"""

    @property
    def point(self) -> Array:
        """The corner (..., 2)."""
        return self.nose + self.offset


Corners = Mapping[str, Corner]
"""The corners of an edge by their sides, upper and lower: with the nose its characteristic points."""


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
) -> Corners:
    """The corners of an edge at `nose` (2,), its camber line's angle from the chord line (...) [rad].

    `inward` is 1 where the camber line leaves the edge (leading), -1 where it arrives (trailing); radius (...) in
    chords, stretch, skew (positive: longer on the upper side) (...), wedge (...) [rad].
    """
    forward = np.stack([np.cos(camber_angle), np.sin(camber_angle)], axis=-1)
    along, across = inward * forward, turned_left(forward)
    return {
        name: _corner(nose, along, sign * across, radius, stretch * (1.0 + sign * skew), wedge, continuity)
        for name, sign in (("upper", 1.0), ("lower", -1.0))
    }


def _corner(
    nose: Array, along: Array, across: Array, radius: Array, stretch: Array, wedge: Array, continuity: Continuity
) -> Corner:
    ratio = opening(stretch, wedge)
    sine = 1.0 / np.sqrt(1.0 + ratio**2)
    advance, height = stretch * (1.0 - ratio * sine), sine
    c, s = np.cos(0.5 * wedge), np.sin(0.5 * wedge)
    offset = radius[..., None] * (advance[..., None] * along + height[..., None] * across)
    return Corner(
        nose=nose,
        inward=along,
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


Bends = tuple[Array, Array]
"""The curvature vectors (..., 2) of the upper and the lower side at their corners, times the edge's speed squared."""


def edge_polynomial(corners: Corners, bends: Bends, continuity: Continuity) -> Array:
    """The edge by t, -1 where it meets the lower side, 0 at the nose, 1 where it meets the upper side.

    Coefficients (..., 5 or 7, 2) of the powers of t: the polynomial of degree 4 (C1) or 6 (C2) through corner, nose and
    corner, with the sides' derivatives there; C1 leaves the bends alone. Being one polynomial, the edge is smooth to
    any order at the nose.
    """
    (even, even_1, even_2), (odd, odd_1, odd_2) = _halves(corners, bends)
    nose = np.broadcast_to(corners["upper"].nose, even.shape)
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
    return _stacked(powers)


def edge_camber(corners: Corners, bends: Bends, t: Reals) -> Array:
    """Points (..., k, 2) of the edge's camber line at t (k,) from 0 at the nose to 1 amid the corners.

    It leaves the nose in the edge's direction and continues the middle of the two sides to second order. Its height
    over that direction is a quartic of the way along it, so that it has no kink where the speed by t changes.
    """
    nose, inward = corners["upper"].nose, corners["upper"].inward
    (even, even_1, even_2), _ = _halves(corners, bends)
    along, along_1, along_2 = (dot(each, inward) for each in (even, even_1, even_2))
    across, across_1, across_2 = (dot(each, turned_left(inward)) for each in (even, even_1, even_2))
    slope = across_1 / along_1
    bend = (across_2 - slope * along_2) / along_1**2
    ways = _flat_start(np.zeros_like(along), along_1 / along - 1.0, along_2 / along)
    ways[..., 1] = 1.0
    heights = _flat_start(across, slope * along, bend * along**2)
    way = polynomial_points(ways[..., None], t)[..., 0]
    height = polynomial_points(heights[..., None], way)
    inward = inward[..., None, :]
    return nose + (along[..., None] * way)[..., None] * inward + height * turned_left(inward)


def _halves(corners: Corners, bends: Bends) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
    """Even and odd parts at t = 1 of the edge about its nose, with two derivatives."""
    upper, lower = corners["upper"], corners["lower"]
    at_upper = (upper.offset, upper.speed[..., None] * upper.direction, bends[0])
    at_lower = (lower.offset, -lower.speed[..., None] * lower.direction, bends[1])
    even = tuple(0.5 * (a + sign * b) for a, b, sign in zip(at_upper, at_lower, (1.0, -1.0, 1.0), strict=True))
    odd = tuple(0.5 * (a - sign * b) for a, b, sign in zip(at_upper, at_lower, (1.0, -1.0, 1.0), strict=True))
    return even, odd


def _flat_start(value: Array, slope: Array, bend: Array) -> Array:
    """Coefficients (..., 5) of a quartic by its value and two derivatives (...) at 1, both zero but the second at 0."""
    fourth = 0.5 * (bend - 4.0 * slope + 6.0 * value)
    third = slope - 2.0 * value - 2.0 * fourth
    none = np.zeros_like(fourth)
    return np.stack(np.broadcast_arrays(none, none, value - third - fourth, third, fourth), axis=-1)


def _stacked(rows: list[Array]) -> Array:
    return concatenated([row[..., None, :] for row in rows], axis=-2)
