"""Volume, centroid and inertia of what a closed set of faces encloses, by the divergence theorem."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from bladewright.errors import GeometryError
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, cross, length
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import breaks
from bladewright.nurbs.measure import area, surface_integral
from bladewright.nurbs.revolved_faces import revolved_area, revolved_moments
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

Face = tuple[Surface | TrimmedSurface, int]
"""A face and its orientation: +1 where its normal points out of the solid, -1 where it points into it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MassProperties(FrozenRecord):
    """Mass properties of the solid that a closed set of faces encloses, for unit density."""

    volume: Array
    """() [length^3]"""
    centroid: Array
    """(3,) [length]"""
    inertia: Array
    """(3, 3) about the centroid, integral of (x.x) I - x x^T [length^5]"""
    measured: Callable[[], tuple[Array, Array]]
    """returns the areas (k,) of the faces and their summed outward area vector (3,), which take longer than the rest"""

    @cached_property
    def _measured(self) -> tuple[Array, Array]:
        return self.measured()

    @property
    def areas(self) -> Array:
        """(k,) of each face [length^2]."""
        return self._measured[0]

    @property
    def area(self) -> Array:
        """() of all faces together [length^2]."""
        return np.asarray(self.areas.sum())

    @property
    def openness(self) -> Array:
        """() the faces' summed area vectors over their area [-]: zero for a closed set, up to rounding."""
        return np.asarray(length(np.real(self._measured[1])) / np.real(self.area))

    def to_dict(self) -> dict[str, Any]:
        """All figures, for JSON."""
        names = ("volume", "area", "areas", "centroid", "inertia", "openness")
        return {name: np.real(getattr(self, name)).tolist() for name in names}


def mass_properties(faces: Sequence[Face]) -> MassProperties:
    """Mass properties of the solid that oriented faces in space enclose.

    With n the outward normal and x measured from the middle of the faces: volume is the flux of x / 3, first moments of
    x_i^2 e_i / 2, second moments of x_i^2 x_j e_i / 2 and x_i^3 e_i / 3. Control points may be complex. Raises
    GeometryError where there is no face, an orientation is not +1 or -1, or the volume is not positive, as with
    normals that point inwards.
    """
    if not faces or any(sign not in (1, -1) for _, sign in faces):
        raise GeometryError(f"orientations {[sign for _, sign in faces]} were given: at least one, each +1 or -1")
    nets = np.concatenate([_surface(face).control_points.reshape(-1, 3) for face, _ in faces])
    middle = 0.5 * (nets.real.min(axis=0) + nets.real.max(axis=0))
    total = np.sum([sign * face_moments(face, middle) for face, sign in faces], axis=0)
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
        centroid=middle + offset,
        inertia=np.trace(moments) * np.eye(3) - moments,
        measured=partial(_areas, tuple(face for face, _ in faces), total[:3]),
    )


def placed(one: MassProperties, turns: Array, shifts: Array) -> MassProperties:
    """Mass properties of n copies of a solid together: x goes to `turns[k]` x + `shifts[k]`.

    `turns` (n, 3, 3) are rotations, `shifts` (n, 3) [length]; both may be complex. The inertia is that about the common
    centroid, by the parallel axis theorem (Huygens and Steiner).
    """
    centres = turns @ one.centroid + shifts
    centroid = centres.mean(axis=0)
    away = centres - centroid
    turned = np.sum(turns @ one.inertia @ np.swapaxes(turns, -1, -2), axis=0)
    spread = away.T @ away
    return MassProperties(
        volume=len(turns) * one.volume,
        centroid=centroid,
        inertia=turned + one.volume * (np.trace(spread) * np.eye(3) - spread),
        measured=partial(_placed_areas, one, turns),
    )


def _placed_areas(one: MassProperties, turns: Array) -> tuple[Array, Array]:
    areas, vector = one.measured()
    return np.tile(areas, len(turns)), np.sum(turns @ vector, axis=0)


def face_moments(face: Surface | TrimmedSurface, origin: Array) -> Array:
    """Integrals (13,) over one face in space, along its own normal, with x measured from `origin` (3,).

    The area vector (3); the fluxes of x / 3; of x^2 / 2, y^2 / 2, z^2 / 2 along their axes; of x^3 / 3,
    y^3 / 3, z^3 / 3 along theirs; and of x^2 y / 2, y^2 z / 2, z^2 x / 2 along x, y, z.
    """

    def density(points: Array, along_u: Array, along_v: Array) -> Array:
        normal = cross(along_u, along_v)
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
        return _of_polynomials(face, origin) if face.weights is None else surface_integral(face, density)
    surface = face.surface
    return face.integral(
        lambda u, v: density(surface(u, v), surface.derivative(u, v, 1, 0), surface.derivative(u, v, 0, 1))
    )


def _of_polynomials(surface: Surface, origin: Array) -> Array:
    """The same, exactly: on a knot span the densities are polynomials of degree 5 p - 1 at most."""
    (u, weight_u), (v, weight_v) = (
        panels(breaks(knots), (5 * degree + 1) // 2)
        for knots, degree in ((surface.knots_u, surface.degree_u), (surface.knots_v, surface.degree_v))
    )
    x = surface.grid(u, v) - origin
    normal = cross(surface.grid(u, v, 1, 0), surface.grid(u, v, 0, 1)) * (weight_u[:, None] * weight_v)[..., None]
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


def _areas(faces: Sequence[Surface | TrimmedSurface], vector: Array) -> tuple[Array, Array]:
    return np.array([_area(face) for face in faces]), vector


def _area(face: Surface | TrimmedSurface) -> Array:
    return area(face) if isinstance(face, Surface) else face.area()


def _surface(face: Surface | TrimmedSurface) -> Surface:
    return face if isinstance(face, Surface) else face.surface


def repeated_properties(repeated: Sequence[Face], turns: Array, others: Sequence[Face], apex: Array) -> MassProperties:
    """Mass properties of what turned copies of faces enclose together with other faces.

    `turns` (n, 3, 3) are rotations that keep a point `apex` (3,). The given faces alone need not enclose anything: over
    each the moments of the cone from that point are integrated, which turn with it. Areas are those of the copies, one
    after another, then of the others. Raises GeometryError as `mass_properties` does.
    """
    once, rest = (
        np.sum([sign * _cone_moments(face, apex) for face, sign in faces], axis=0) if faces else np.zeros(16)
        for faces in (repeated, others)
    )
    parts = [*((once, turn) for turn in turns), (rest, np.eye(3))]
    vector = np.sum([turn @ part[:3] for part, turn in parts], axis=0)
    volume = np.sum([part[3] for part, _ in parts])
    first = np.sum([turn @ part[4:7] for part, turn in parts], axis=0)
    second = np.sum([turn @ part[7:].reshape(3, 3) @ turn.T for part, turn in parts], axis=0)
    if not volume.real > 0.0:
        raise GeometryError(f"the faces enclose a volume of {volume.real:g}: turn their orientations round")
    offset = first / volume
    moments = second - volume * np.outer(offset, offset)
    return MassProperties(
        volume=np.asarray(volume),
        centroid=apex + offset,
        inertia=np.trace(moments) * np.eye(3) - moments,
        measured=partial(
            _repeated_areas, tuple(f for f, _ in repeated), len(turns), tuple(f for f, _ in others), vector
        ),
    )


def _cone_moments(face: Surface | TrimmedSurface, apex: Array) -> Array:
    """Area vector (3) of a face along its own normal, and volume, first (3) and second moments (9) of its cone.

    About the apex, from which x is measured: the fluxes of x / 3, x_i x / 4 and x_i x_j x / 5.
    """

    def density(points: Array, along_u: Array, along_v: Array) -> Array:
        normal, x = cross(along_u, along_v), points - apex
        flux = np.sum(x * normal, axis=-1, keepdims=True)
        second = (x[..., :, None] * x[..., None, :]).reshape(*x.shape[:-1], 9)
        return np.concatenate([normal, flux / 3.0, x * flux / 4.0, second * flux / 5.0], axis=-1)

    if isinstance(face, Surface):
        exact = (5 * max(face.degree_u, face.degree_v) + 1) // 2
        return surface_integral(face, density, exact if face.weights is None else None)
    if face.revolution is not None and not np.any(apex[1:]):
        return revolved_moments(face, face.revolution, apex[0])
    surface = face.surface
    return face.integral(
        lambda u, v: density(surface(u, v), surface.derivative(u, v, 1, 0), surface.derivative(u, v, 0, 1))
    )


def _repeated_areas(
    repeated: Sequence[Surface | TrimmedSurface], count: int, others: Sequence[Surface | TrimmedSurface], vector: Array
) -> tuple[Array, Array]:
    once, rest = (
        [
            revolved_area(face, face.revolution)
            if isinstance(face, TrimmedSurface) and face.revolution is not None
            else _area(face)
            for face in faces
        ]
        for faces in (repeated, others)
    )
    return np.concatenate([np.tile(once, count), rest]), vector
