"""The camber line: a cubic Bezier curve from metal angles, stagger and tangent proportions."""

import numpy as np

from bladewright.numerics.elementary import Array, unit
from bladewright.nurbs.basis import Reals


def camber_line(
    start: Array,
    extent: Array,
    stagger: Array,
    angle_in: Array,
    angle_out: Array,
    tangent_in: Array,
    tangent_out: Array,
) -> Array:
    """Control points (..., 4, 2) of the camber line.

    `start` (...) is the ordinate of the leading edge, whose abscissa is 0; `extent` (...) the abscissa of the trailing
    edge; angles (...) in radians from the abscissa; tangent proportions (...) are fractions of `extent`.
    Reference: Agromayor et al. 2021, eqs. 8 to 11, with the extent in place of the chord.
    """
    first = np.stack([np.zeros_like(start), start], axis=-1)
    last = first + np.stack(np.broadcast_arrays(extent, extent * np.tan(stagger)), axis=-1)
    along_in = np.stack([np.cos(angle_in), np.sin(angle_in)], axis=-1)
    along_out = np.stack([np.cos(angle_out), np.sin(angle_out)], axis=-1)
    second = first + (tangent_in * extent)[..., None] * along_in
    third = last - (tangent_out * extent)[..., None] * along_out
    return np.stack(np.broadcast_arrays(first, second, third, last), axis=-2)


def bernstein(u: Reals) -> Reals:
    """Cubic Bernstein polynomials (len(u), 4)."""
    w = 1.0 - u
    return np.stack([w**3, 3 * u * w**2, 3 * u**2 * w, u**3], axis=-1)


def camber_points(line: Array, u: Reals) -> Array:
    """Points (..., len(u), 2) of the camber line."""
    return bernstein(u) @ line


def camber_tangents(line: Array, u: Reals) -> Array:
    """Unit tangents (..., len(u), 2) of the camber line, from leading to trailing edge."""
    w = 1.0 - u
    quadratic = np.stack([w**2, 2 * u * w, u**2], axis=-1)
    return unit(quadratic @ (line[..., 1:, :] - line[..., :-1, :]))
