"""Volume, area, centroid and inertia of a blade between its walls, from its sides and the outlines of its ends.

The area of an end is the integral of theta r |C'| du around its outline, C the wall's meridian.
"""

from collections.abc import Callable, Mapping

import numpy as np

from bladewright.blade.moments import area_vector, side_moments
from bladewright.numerics.elementary import Array, angle, length
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import breaks
from bladewright.nurbs.flux import MassProperties
from bladewright.nurbs.measure import area
from bladewright.nurbs.revolution import Revolution
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

ALONG = 12
"""Gauss points in a knot span of an outline"""
Faces = Mapping[str, Surface | TrimmedSurface]


def blade_properties(
    surfaces: Faces, outward: Mapping[str, int], *, revolved: bool, moments: Callable[[], Array] | None = None
) -> MassProperties:
    """Properties of a blade of two sides and two ends, of which at least one is trimmed; inertia about the centroid.

    Control points may be complex. `moments` gives those of `blade_moments` where they are known without quadrature.
    """
    total = blade_moments(surfaces, outward, revolved=revolved) if moments is None else moments()
    volume, centroid = total[0], total[1:4] / total[0]
    xx, yy, zz, xy, yz, zx = total[4:]
    spread = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]) - volume * np.outer(centroid, centroid)

    def measured() -> tuple[Array, Array]:
        sizes = [_measured(surfaces[name]) for name in outward]
        vectors = [sign * vector for sign, (_, vector) in zip(outward.values(), sizes, strict=True)]
        return np.array([size for size, _ in sizes]), np.sum(vectors, axis=0)

    return MassProperties(
        volume=volume, centroid=centroid, inertia=np.trace(spread) * np.eye(3) - spread, measured=measured
    )


def blade_moments(surfaces: Faces, outward: Mapping[str, int], *, revolved: bool) -> Array:
    """Integrals (10,) of 1, x, y, z, xx, yy, zz, xy, yz, zx over the volume."""
    middle = middle_of(surfaces)
    return np.asarray(
        sum(
            outward[name] * side_moments(face, middle, revolved=revolved)
            for name, face in surfaces.items()
            if isinstance(face, Surface)
        )
    )


def middle_of(surfaces: Faces) -> float:
    """theta, or y in a cascade, amid the first of the ends."""
    return _middle(next(face for face in surfaces.values() if isinstance(face, TrimmedSurface)))


def _measured(face: Surface | TrimmedSurface) -> tuple[Array, Array]:
    """Area and area vector (3,) of a face, along its own normal."""
    if isinstance(face, TrimmedSurface):
        return _end(face)
    return area(face), area_vector(face)


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
