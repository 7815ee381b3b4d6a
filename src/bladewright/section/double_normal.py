"""Double normals: two points whose connection is normal to the curve of either: a thickness, or a throat.

Distances are those of an unrolled surface: d^2 = dx^2 + dh^2 + rho_1 rho_2 dt^2 between points at (x, h, t), exact in
a plane and on a cylinder. On a surface of revolution h and rho are the radius and t is theta; in a plane t is y, and
rho is 1.
"""

from typing import NamedTuple

import numpy as np

from bladewright.numerics.elementary import Array


class Motion(NamedTuple):
    """Points (m,) on a curve: each coordinate (3, m) with its first and second derivative by the curve's parameter."""

    x: Array
    height: Array
    """r, or z in a cascade [m]"""
    across: Array
    """theta [rad], or y [m]"""
    radius: Array
    """r [m], or 1 where `across` is a length"""
    period: float = 0.0
    """2 pi where `across` is an angle, which is the same a turn farther on; 0 of a length"""


def wrapped(across: Array, period: float) -> Array:
    """Differences of `across` brought to within half a period of 0."""
    return across - period * np.round(np.real(across) / period) if period else across


def _apart(first: Motion, second: Motion) -> tuple[Array, Array, Array]:
    along, up, turn = (b[0] - a[0] for a, b in zip(first[:3], second[:3], strict=True))
    return along, up, wrapped(turn, first.period)


def distance(first: Motion, second: Motion) -> Array:
    """(m,) distances of two points [m]."""
    along, up, turn = _apart(first, second)
    return np.sqrt(along**2 + up**2 + first.radius[0] * second.radius[0] * turn**2)


def newton_step(first: Motion, second: Motion) -> tuple[Array, Array]:
    """Newton steps (m,), to be subtracted from the parameters of both points, towards a double normal.

    There the derivatives of d^2 / 2 by both parameters vanish: it is a saddle inside a section, a minimum between two.
    """
    along, up, turn = _apart(first, second)
    (x, h, t, rho), (xx, hh, tt, rr) = ([each[order] for each in first[:4]] for order in (1, 2))
    (X, H, T, Rho), (XX, HH, TT, RR) = ([each[order] for each in second[:4]] for order in (1, 2))
    own, other = first.radius[0], second.radius[0]
    both, half = own * other, turn**2 / 2.0
    slope = (
        -along * x - up * h - both * turn * t + rho * other * half,
        along * X + up * H + both * turn * T + own * Rho * half,
    )
    bend = (
        x**2 + h**2 + both * t**2 - along * xx - up * hh - both * turn * tt - 2.0 * rho * other * turn * t,
        X**2 + H**2 + both * T**2 + along * XX + up * HH + both * turn * TT + 2.0 * own * Rho * turn * T,
    )
    bend = bend[0] + rr * other * half, bend[1] + own * RR * half
    mixed = -x * X - h * H - both * t * T - own * Rho * turn * t + rho * other * turn * T + rho * Rho * half
    with np.errstate(divide="ignore", invalid="ignore"):
        whole = bend[0] * bend[1] - mixed**2
        return (bend[1] * slope[0] - mixed * slope[1]) / whole, (bend[0] * slope[1] - mixed * slope[0]) / whole
