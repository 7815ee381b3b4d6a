"""Unit normals of a surface, also where one of its edges is drawn together into a point."""

from typing import TYPE_CHECKING

import numpy as np

from bladewright.numerics.elementary import Array, length, unit

if TYPE_CHECKING:
    from bladewright.nurbs.surface import Surface

COLLAPSED = 1e-10
"""a derivative or a sine between two shorter than this fraction counts as none: the limit is taken instead"""


def unit_normals(surface: "Surface", u: Array, v: Array) -> Array:
    """Unit normals (..., 3) at real u, v of one shape: the direction of dS/du x dS/dv.

    Where that product vanishes at an end of the surface (the pole of a sphere, the tip of a cone) it is the limit from
    inside along the other parameter: with dS/du = 0 at v = v0, dS/du ~ (v - v0) d2S/dudv.
    """
    along_u, along_v = surface.derivative(u, v, 1, 0), surface.derivative(u, v, 0, 1)
    direction = np.cross(along_u, along_v)
    size_u, size_v = length(along_u.real), length(along_v.real)
    extent = np.ptp(surface.control_points.real, axis=(0, 1)).max()
    bound = np.maximum(size_u, COLLAPSED * extent) * np.maximum(size_v, COLLAPSED * extent)
    flat = length(direction.real) <= COLLAPSED * bound
    flat |= (size_u <= COLLAPSED * extent) | (size_v <= COLLAPSED * extent)
    if flat.any():
        twist = surface.derivative(u[flat], v[flat], 1, 1)
        inward_u = np.where(u[flat] < np.mean(surface.domain_u), 1.0, -1.0)[..., None]
        inward_v = np.where(v[flat] < np.mean(surface.domain_v), 1.0, -1.0)[..., None]
        no_u = (size_u[flat] <= size_v[flat])[..., None]
        limit = np.where(no_u, np.cross(inward_v * twist, along_v[flat]), np.cross(along_u[flat], inward_u * twist))
        direction = np.array(direction, dtype=np.result_type(direction, limit))
        direction[flat] = limit
    return unit(direction)
