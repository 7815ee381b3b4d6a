"""Volume, area, centroid and inertia of a blade, from its sides and the outlines of its ends.

A vector field along theta has no flux through a surface of revolution about the axis, nor one along y through the walls
of a cascade. So the divergence theorem with G(x, r, theta) such that dG/dtheta = f needs the sides alone:

    integral f dV = sum over the sides of integral G (r e_theta . n) dA.

The area of an end is the integral of theta r |C'| du around its outline, C the wall's meridian.
"""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from bladewright.numerics.elementary import Array, angle, cross, length
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import Reals, basis, breaks
from bladewright.nurbs.mass_properties import MassProperties
from bladewright.nurbs.measure import area
from bladewright.nurbs.revolution import Revolution
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

SIDE_POINTS = 10
"""Gauss points in a knot span of a side: exact for polynomials to degree 19."""
STEP = 1e-30
"""Complex step of a point [m] (Squire and Trapp 1998): its square vanishes beside 1, so that the derivative is exact
to rounding."""
MOMENTS = 10
"""Number of moments: of 1, x, y, z, xx, yy, zz, xy, yz, zx."""
Density = Callable[[Array, Array], Array]


OUTLINE_POINTS = 12
"""Gauss points in a knot span of the outline of an end."""


def side_moments(
    side: Surface, middle: float, *, revolved: bool, count: int = MOMENTS, near: float | None = None
) -> Array:
    """Integrals (count,) of 1, x, y, z, xx, yy, zz, xy, yz, zx that a side gives a volume, along its own normal.

    `middle` is the theta, or y in a cascade, at which the field vanishes: in the middle of the blade, so that
    what passes through the gap between sides and walls stays small. The side's mean theta lies within half a turn of
    `near`, by default of the middle. Control points may be complex.
    """
    u, v, weight = _places(side)
    point, normal = side.grid(u, v), cross(side.grid(u, v, 1, 0), side.grid(u, v, 0, 1))
    away = 0.0 if near is None else near - middle
    return np.einsum("uv,uvk->k", weight, _density(middle, count, revolved=revolved, away=away)(point, normal))


def area_vector(side: Surface) -> Array:
    """Integral (3,) of the normal over a side."""
    u, v, weight = _places(side)
    return np.einsum("uv,uvk->k", weight, cross(side.grid(u, v, 1, 0), side.grid(u, v, 0, 1)))


def moment_gradient(side: Surface, middle: float, *, revolved: bool, count: int = MOMENTS) -> Reals:
    """Derivatives (count, n_u, n_v, 3) of the first of a side's moments by its real control points.

    The density f(S, n) is linear in n = S_u x S_v, so that its change is
    f_S . dS + (S_v x f_n) . dS_u + (f_n x S_u) . dS_v.
    """
    u, v, weight = _places(side)
    point, along, across = (side.grid(u, v, *orders) for orders in ((0, 0), (1, 0), (0, 1)))
    density, axes, normal = _density(middle, count, revolved=revolved), np.eye(3), cross(along, across)
    by_normal = np.stack([density(point, np.broadcast_to(axis, point.shape)) for axis in axes], axis=-1)
    by_point = np.stack([np.imag(density(point + STEP * 1j * axis, normal)) / STEP for axis in axes], axis=-1)
    parts = (
        (by_point, 0, 0),
        (cross(across[..., None, :], by_normal), 1, 0),
        (cross(by_normal, along[..., None, :]), 0, 1),
    )
    total: Reals = np.zeros((count, *side.control_points.shape))
    for part, in_u, in_v in parts:
        rows = basis(side.knots_u, side.degree_u, u, in_u)
        columns = basis(side.knots_v, side.degree_v, v, in_v)
        # in this order of memory the products are those of full matrices
        weighted = np.ascontiguousarray(np.moveaxis(weight[..., None, None] * part, (0, 1), (-2, -1)))
        total += np.moveaxis(rows.T @ (weighted @ columns), 1, -1)
    return total


def _places(side: Surface) -> tuple[Reals, Reals, Reals]:
    (u, along), (v, across) = (panels(breaks(knots), SIDE_POINTS) for knots in (side.knots_u, side.knots_v))
    return u, v, along[:, None] * across


def _density(middle: float, count: int, *, revolved: bool, away: float = 0.0) -> Density:
    if revolved:
        return lambda point, normal: _around_axis(point, normal, middle, count, away)
    return lambda point, normal: _along_y(point, normal, middle, count)


def _around_axis(point: Array, normal: Array, middle: float, count: int, away: float) -> Array:
    """Densities (..., count) of the moments for a field along theta, which vanishes at theta = `middle`.

    The mean theta is within half a turn of `away` from that.
    """
    x, y, z = np.moveaxis(point, -1, 0)
    radius = length(point[..., 1:])
    start_y, start_z = radius * np.sin(middle), radius * np.cos(middle)
    theta = angle(y * np.cos(middle) - z * np.sin(middle), z * np.cos(middle) + y * np.sin(middle))
    turns = np.unwrap(np.unwrap(np.real(theta), axis=0), axis=1)
    turns = turns - 2.0 * np.pi * np.round((np.mean(turns) - away) / (2.0 * np.pi))
    theta = theta + (turns - np.real(theta))
    flux = z * normal[..., 1] - y * normal[..., 2]
    if count == 1:
        return np.asarray((theta * flux)[..., None])
    square, product = radius * radius * theta, y * z - start_y * start_z
    primitives = [theta, x * theta, start_z - z, y - start_y, x * x * theta]
    primitives += [(square - product) / 2.0, (square + product) / 2.0]
    primitives += [x * (start_z - z), (y * y - start_y * start_y) / 2.0, x * (y - start_y)]
    return np.stack(primitives[:count], axis=-1) * flux[..., None]


def _along_y(point: Array, normal: Array, middle: float, count: int) -> Array:
    """The same for a field along y, which vanishes at y = `middle`."""
    x, y, z = np.moveaxis(point, -1, 0)
    first, second, third = y - middle, (y * y - middle**2) / 2.0, (y**3 - middle**3) / 3.0
    primitives = [first, x * first, second, z * first, x * x * first, third, z * z * first]
    primitives += [x * second, z * second, z * x * first]
    return np.stack(primitives[:count], axis=-1) * normal[..., 1, None]


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
    return MassProperties(
        volume=volume,
        centroid=centroid,
        inertia=np.trace(spread) * np.eye(3) - spread,
        measured=partial(_areas, surfaces, outward),
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
    """theta, or y in a cascade, in the middle of the first of the ends."""
    return _middle(next(face for face in surfaces.values() if isinstance(face, TrimmedSurface)))


def _areas(surfaces: Faces, outward: Mapping[str, int]) -> tuple[Array, Array]:
    """Areas (k,) of the faces and their summed outward area vector (3,)."""
    sizes = [_measured(surfaces[name]) for name in outward]
    vectors = [sign * vector for sign, (_, vector) in zip(outward.values(), sizes, strict=True)]
    return np.array([size for size, _ in sizes]), np.sum(vectors, axis=0)


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
    for curve in end.curves:
        s, weight = panels(breaks(curve.knots), OUTLINE_POINTS)
        uv, slope = curve(s), curve.derivative(s)
        point = end.surface(uv[:, 0], uv[:, 1])
        along, across = (
            end.surface.derivative(uv[:, 0], uv[:, 1], 1, 0),
            end.surface.derivative(uv[:, 0], uv[:, 1], 0, 1),
        )
        tangent = along * slope[:, :1] + across * slope[:, 1:]
        vector = vector + np.sum(weight[:, None] * cross(point, tangent), axis=0) / 2.0
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
