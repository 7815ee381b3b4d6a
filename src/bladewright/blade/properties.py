"""Volume, area, centroid and inertia of a blade between its walls, from its sides and the outlines of its ends.

A vector field along theta has no flux through a surface of revolution about the axis, nor one along y through the walls
of a cascade. So the divergence theorem with G(x, r, theta) such that dG/dtheta = f needs the sides alone:

    integral f dV = sum over the sides of integral G (r e_theta . n) dA.

The area of an end is the integral of theta r |C'| du around its outline, C the wall's meridian.
"""

from collections.abc import Mapping
from typing import cast

import numpy as np

from bladewright.numerics.elementary import Array, angle, length
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import breaks
from bladewright.nurbs.flux import MassProperties
from bladewright.nurbs.measure import area
from bladewright.nurbs.revolution import Revolution
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

POINTS = 10
"""Gauss points in a knot span of a side: exact to degree 19"""
ALONG = 12
"""Gauss points in a knot span of an outline"""


def blade_properties(
    surfaces: Mapping[str, Surface | TrimmedSurface], outward: Mapping[str, int], *, revolved: bool
) -> MassProperties:
    """Properties of a blade of two sides and two trimmed ends, inertia about the centroid.

    Control points may be complex.
    """
    ends = [name for name in outward if name not in {"upper", "lower"}]
    middle = _middle(cast(TrimmedSurface, surfaces[ends[0]]))
    total: Array = np.zeros(10)
    areas: list[Array] = []
    vectors: list[Array] = []
    for name in ("upper", "lower"):
        moments, size, vector = _side(cast(Surface, surfaces[name]), middle, revolved=revolved)
        total = total + outward[name] * moments
        areas.append(size)
        vectors.append(outward[name] * vector)
    for name in ends:
        end = cast(TrimmedSurface, surfaces[name])
        size, vector = _end(end)
        areas.append(size)
        vectors.append(outward[name] * vector)
    volume, centroid = total[0], total[1:4] / total[0]
    xx, yy, zz, xy, yz, zx = total[4:]
    spread = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]) - volume * np.outer(centroid, centroid)
    return MassProperties(
        volume=volume,
        area=np.asarray(np.sum(areas)),
        areas=np.array(areas),
        centroid=centroid,
        inertia=np.trace(spread) * np.eye(3) - spread,
        openness=length(np.real(np.sum(vectors, axis=0))) / np.real(np.sum(areas)),
    )


def _side(side: Surface, middle: float, *, revolved: bool) -> tuple[Array, Array, Array]:
    """Ten moments of the flux through a side, its area and its area vector (3,)."""
    (u, weight_u), (v, weight_v) = (panels(breaks(knots), POINTS) for knots in (side.knots_u, side.knots_v))
    point = side.grid(u, v)
    normal = np.cross(side.grid(u, v, 1, 0), side.grid(u, v, 0, 1))
    weight = weight_u[:, None] * weight_v
    moments = _around_axis(point, normal, middle) if revolved else _along_y(point, normal, middle)
    return np.einsum("uv,uvk->k", weight, moments), area(side), np.einsum("uv,uvk->k", weight, normal)


def _around_axis(point: Array, normal: Array, middle: float) -> Array:
    """Densities (..., 10) of the moments 1, x, y, z, xx, yy, zz, xy, yz, zx for a field along theta.

    The field vanishes at theta = `middle`, so that what passes through the gap between sides and walls stays small.
    """
    x, y, z = np.moveaxis(point, -1, 0)
    radius = length(point[..., 1:])
    start_y, start_z = radius * np.sin(middle), radius * np.cos(middle)
    theta = angle(y * np.cos(middle) - z * np.sin(middle), z * np.cos(middle) + y * np.sin(middle))
    turns = np.unwrap(np.unwrap(np.real(theta), axis=0), axis=1)
    turns = turns - 2.0 * np.pi * np.round(np.mean(turns) / (2.0 * np.pi))
    theta = theta + (turns - np.real(theta))
    square, product = radius * radius * theta, y * z - start_y * start_z
    flux = z * normal[..., 1] - y * normal[..., 2]
    primitives = [theta, x * theta, start_z - z, y - start_y, x * x * theta]
    primitives += [(square - product) / 2.0, (square + product) / 2.0]
    primitives += [x * (start_z - z), (y * y - start_y * start_y) / 2.0, x * (y - start_y)]
    return np.stack(primitives, axis=-1) * flux[..., None]


def _along_y(point: Array, normal: Array, middle: float) -> Array:
    """The same for a field along y, which vanishes at y = `middle`."""
    x, y, z = np.moveaxis(point, -1, 0)
    first, second, third = y - middle, (y * y - middle**2) / 2.0, (y**3 - middle**3) / 3.0
    primitives = [first, x * first, second, z * first, x * x * first, third, z * z * first]
    primitives += [x * second, z * second, z * x * first]
    return np.stack(primitives, axis=-1) * normal[..., 1, None]


def _middle(wall: TrimmedSurface) -> float:
    """theta, or y in a cascade, of the middle of a wall."""
    if wall.revolution is not None:
        return (wall.revolution.start + wall.revolution.end) / 2.0
    return float(np.mean(np.real(wall.surface.control_points[..., 1])))


def _end(end: TrimmedSurface) -> tuple[Array, Array]:
    """Area and area vector (3,) of a trimmed end, along its own normal."""
    size: Array = np.zeros(())
    vector: Array = np.zeros(3)
    for curve in end.boundary:
        s, weight = panels(breaks(curve.knots), ALONG)
        uv, slope = curve(s), curve.derivative(s)
        point = end.surface(uv[:, 0], uv[:, 1])
        along, across = (
            end.surface.derivative(uv[:, 0], uv[:, 1], 1, 0),
            end.surface.derivative(uv[:, 0], uv[:, 1], 0, 1),
        )
        tangent = along * slope[:, :1] + across * slope[:, 1:]
        vector = vector + np.sum(weight[:, None] * np.cross(point, tangent), axis=0) / 2.0
        size = size - np.sum(weight * _width(end.revolution, point) * length(along) * slope[:, 0])
    return size, vector


def _width(revolution: Revolution | None, point: Array) -> Array:
    """r theta, or y in a cascade: the distance along the wall from theta = middle, or y = 0."""
    if revolution is None:
        return point[:, 1]
    middle = (revolution.start + revolution.end) / 2.0
    y, z = point[:, 1], point[:, 2]
    away = angle(y * np.cos(middle) - z * np.sin(middle), z * np.cos(middle) + y * np.sin(middle))
    return length(point[:, 1:]) * away
