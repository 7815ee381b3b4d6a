"""Volume, centroid and inertia of what a closed set of faces encloses, by the divergence theorem."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bladewright.errors import GeometryError
from bladewright.numerics.elementary import Array, length
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import breaks
from bladewright.nurbs.measure import area, surface_integral
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

Face = tuple[Surface | TrimmedSurface, int]
"""a face and its orientation: +1 where its normal points out of the solid, -1 where it points into it"""


@dataclass(frozen=True, kw_only=True)
class MassProperties:
    """What a closed set of faces encloses, for unit density."""

    volume: Array
    """() [length^3]"""
    area: Array
    """() of all faces together [length^2]"""
    areas: Array
    """(k,) of each face [length^2]"""
    centroid: Array
    """(3,) [length]"""
    inertia: Array
    """(3, 3) about the centroid, integral of (x.x) I - x x^T [length^5]"""
    openness: Array
    """() the faces' summed area vectors over their area [-]: zero for a closed set, up to rounding"""


def mass_properties(faces: Sequence[Face]) -> MassProperties:
    """Properties of the solid that oriented faces in space enclose.

    With n the outward normal and x measured from the middle of the faces: volume is the flux of x / 3, first moments of
    x_i^2 e_i / 2, second moments of x_i^2 x_j e_i / 2 and x_i^3 e_i / 3. Control points may be complex. Raises
    GeometryError where there is no face, an orientation is not +1 or -1, or the volume is not positive, as with
    normals that point inwards.
    """
    if not faces or any(sign not in (1, -1) for _, sign in faces):
        raise GeometryError(f"orientations {[sign for _, sign in faces]} were given: at least one, each +1 or -1")
    nets = np.concatenate([_surface(face).control_points.reshape(-1, 3) for face, _ in faces])
    middle = 0.5 * (nets.real.min(axis=0) + nets.real.max(axis=0))
    sums = [face_moments(face, middle) for face, _ in faces]
    total = np.sum([sign * moments[1:] for (_, sign), moments in zip(faces, sums, strict=True)], axis=0)
    areas = np.array([moments[0] for moments in sums])
    volume, first, second = total[3], total[4:7], total[7:]
    if not volume.real > 0.0:
        raise GeometryError(
            f"the faces enclose a volume of {volume.real:g}: orientations must be +1 where the normal points outwards; "
            "turn them round"
        )
    xx, yy, zz, xy, yz, zx = second
    offset = first / volume
    moments = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]) - volume * np.outer(offset, offset)
    return MassProperties(
        volume=volume,
        area=areas.sum(),
        areas=areas,
        centroid=middle + offset,
        inertia=np.trace(moments) * np.eye(3) - moments,
        openness=length(total[:3].real) / areas.real.sum(),
    )


def face_moments(face: Surface | TrimmedSurface, origin: Array) -> Array:
    """Integrals (14,) over one face in space, along its own normal, with x measured from `origin` (3,).

    The area; the area vector (3); the fluxes of x / 3; of x^2 / 2, y^2 / 2, z^2 / 2 along their axes; of x^3 / 3,
    y^3 / 3, z^3 / 3 along theirs; and of x^2 y / 2, y^2 z / 2, z^2 x / 2 along x, y, z.
    """

    def density(points: Array, along_u: Array, along_v: Array) -> Array:
        normal = np.cross(along_u, along_v)
        x = points - origin
        flux = x * normal
        return np.concatenate(
            [
                normal,
                flux.sum(axis=-1, keepdims=True) / 3.0,
                x * flux / 2.0,
                x**2 * flux / 3.0,
                x * flux * np.roll(x, -1, axis=-1) / 2.0,
            ],
            axis=-1,
        )

    if isinstance(face, Surface):
        moments = _of_polynomials(face, origin) if face.weights is None else surface_integral(face, density)
        return np.append(area(face), moments)
    surface = face.surface

    def trimmed(u: Array, v: Array) -> Array:
        along_u, along_v = surface.derivative(u, v, 1, 0), surface.derivative(u, v, 0, 1)
        sizes = length(np.cross(along_u, along_v))[..., None]
        return np.concatenate([sizes, density(surface(u, v), along_u, along_v)], axis=-1)

    return face.integral(trimmed)


def _of_polynomials(surface: Surface, origin: Array) -> Array:
    """The same (13,) without the area, exact: on a knot span the densities have the degree 5 p - 1 at most."""
    (u, along), (v, across) = (
        panels(breaks(knots), (5 * degree + 1) // 2)
        for knots, degree in ((surface.knots_u, surface.degree_u), (surface.knots_v, surface.degree_v))
    )
    x = surface.grid(u, v) - origin
    normal = np.cross(surface.grid(u, v, 1, 0), surface.grid(u, v, 0, 1)) * (along[:, None] * across)[..., None]
    flux = x * normal
    second = x * flux
    products = [np.einsum("uv,uv->", second[..., k], x[..., (k + 1) % 3]) for k in range(3)]
    return np.concatenate(
        [
            normal.sum(axis=(0, 1)),
            flux.sum(keepdims=True).reshape(1) / 3.0,
            second.sum(axis=(0, 1)) / 2.0,
            np.einsum("uvk,uvk->k", second, x) / 3.0,
            np.array(products) / 2.0,
        ]
    )


def _surface(face: Surface | TrimmedSurface) -> Surface:
    return face if isinstance(face, Surface) else face.surface
