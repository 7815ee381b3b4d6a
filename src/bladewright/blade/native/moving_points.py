"""Points that move along curves of a blade, in cylindrical coordinates, and the angles of their ways to the flow."""

import numpy as np

from bladewright.numerics.elementary import Array, angle, unit
from bladewright.section.double_normal import Motion, wrapped


def motion(point: Array, first: Array, second: Array, *, revolved: bool) -> Motion:
    """Points (..., 3) that run along curves, as (x, r, theta), or as (x, z, y) in a cascade."""
    x, y, z = (np.stack([each[..., i] for each in (point, first, second)]) for i in range(3))
    if not revolved:
        return Motion(x, z, y, np.stack([np.ones_like(x[0]), *np.zeros_like(x[1:])]))
    r = np.sqrt(y[0] ** 2 + z[0] ** 2)
    climb, turn = (y[0] * y[1] + z[0] * z[1]) / r, (z[0] * y[1] - y[0] * z[1]) / r**2
    bend = (y[1] ** 2 + z[1] ** 2 + y[0] * y[2] + z[0] * z[2] - climb**2) / r
    growth = (z[0] * y[2] - y[0] * z[2]) / r**2 - 2.0 * climb * turn / r
    height = np.stack([r, climb, bend])
    return Motion(x, height, np.stack([angle(y[0], z[0]), turn, growth]), height, 2.0 * np.pi)


def middle(upper: Motion, lower: Motion) -> Motion:
    """The middle of two points nearby; of their derivatives nothing."""
    x, height, radius = ((getattr(upper, name) + getattr(lower, name)) / 2.0 for name in ("x", "height", "radius"))
    apart = wrapped(lower.across[:1] - upper.across[:1], upper.period)
    return Motion(x[:1], height[:1], upper.across[:1] + apart / 2.0, radius[:1], upper.period)


def directions(point: Array, slope: Array, *, revolved: bool) -> tuple[Array, Array]:
    """Unit vectors (m, 3) downstream along the stream line and towards larger theta, or y, at points (m, 3)."""
    zero, one = np.zeros_like(point[..., 0]), np.ones_like(point[..., 0])
    if not revolved:
        return np.stack([slope[..., 0], zero, slope[..., 1]], axis=-1), np.stack([zero, one, zero], axis=-1)
    around = unit(point[..., 1:])
    meridional = np.stack([slope[..., 0], slope[..., 1] * around[..., 0], slope[..., 1] * around[..., 1]], axis=-1)
    return meridional, np.stack([zero, around[..., 1], -around[..., 0]], axis=-1)


def _normal_rate(rates: list[Array], slope: Array) -> Array:
    """How fast an edge rises normal to the stream lines, towards the shroud."""
    return slope[..., 0] * rates[1] - slope[..., 1] * rates[0]


def sweep_angle(rates: list[Array], slope: Array) -> Array:
    """Angle of an edge from the normal of the stream line, downstream towards the shroud [rad]."""
    return np.arctan((slope[..., 0] * rates[0] + slope[..., 1] * rates[1]) / _normal_rate(rates, slope))


def lean_angle(rates: list[Array], slope: Array, radius: Array) -> Array:
    """Angle of a line from the normal of the stream line, towards larger theta, or y [rad]."""
    return np.arctan(radius * rates[2] / _normal_rate(rates, slope))


def components(along: Motion, slope: Array) -> tuple[Array, Array]:
    """First derivatives (m,) of a motion downstream along the stream line and towards larger theta, or y."""
    return slope[:, 0] * along.x[1] + slope[:, 1] * along.height[1], along.radius[0] * along.across[1]
