"""Curvature of curves and surfaces."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bladewright.errors import GeometryError
from bladewright.numerics.elementary import Array, cross2, dot, length
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface


def curvature(curve: Curve, u: ArrayLike) -> Array:
    """Curvature (...) [1/length]: in the plane signed, positive where the curve turns left; in space its magnitude.

    In space it has no complex derivative where it vanishes. do Carmo 1976, section 1-5.
    """
    _, first, second = curve.derivatives(u, 2)
    if first.shape[-1] == 2:
        return np.asarray(cross2(first, second) / length(first) ** 3)
    return length(curvature_vector(curve, u))


def curvature_vector(curve: Curve, u: ArrayLike) -> Array:
    """Curvature vectors (..., d) [1/length]: the derivative of the unit tangent by arc length, in any dimension."""
    _, first, second = curve.derivatives(u, 2)
    square = dot(first, first)[..., None]
    return np.asarray((second - first * (dot(first, second)[..., None] / square)) / square)


@dataclass(frozen=True, kw_only=True)
class SurfaceCurvature:
    """Curvatures of a surface (...), positive where it bends towards its normal dS/du x dS/dv."""

    maximum: Array
    """the larger principal curvature [1/length]"""
    minimum: Array
    """the smaller principal curvature [1/length]"""
    mean: Array
    """the mean of both [1/length]"""
    gaussian: Array
    """the product of both [1/length^2]"""


def surface_curvature(surface: Surface, u: ArrayLike, v: ArrayLike) -> SurfaceCurvature:
    """Principal, mean and Gaussian curvatures at parameters that broadcast; the surface is in space.

    The second fundamental form is taken in an orthonormal tangent frame, so that the difference of the principal
    curvatures is a root of a sum of squares; where it vanishes (umbilics) they have no complex derivative.
    do Carmo 1976, section 3-3. Raises GeometryError for a surface that is not in space.
    """
    if surface.control_points.shape[-1] != 3:
        raise GeometryError(f"curvature was asked of a surface in {surface.control_points.shape[-1]} dimensions, not 3")
    of = surface.derivatives(u, v, 2)
    along_u, along_v = of[1, 0], of[0, 1]
    size = length(along_u)
    ratio = dot(along_u, along_v) / dot(along_u, along_u)
    across = along_v - ratio[..., None] * along_u
    width = length(across)
    normal = np.cross(along_u, across) / (size * width)[..., None]
    bend_uu, bend_uv, bend_vv = (dot(normal, of[order]) for order in ((2, 0), (1, 1), (0, 2)))
    first = bend_uu / size**2
    mixed = (bend_uv - ratio * bend_uu) / (size * width)
    second = (bend_vv - 2.0 * ratio * bend_uv + ratio**2 * bend_uu) / width**2
    mean, half = 0.5 * (first + second), 0.5 * (first - second)
    spread = np.sqrt(half**2 + mixed**2)
    spread = np.where(spread.real < 0.0, -spread, spread)
    return SurfaceCurvature(maximum=mean + spread, minimum=mean - spread, mean=mean, gaussian=first * second - mixed**2)
