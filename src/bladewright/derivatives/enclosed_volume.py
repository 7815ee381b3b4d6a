"""Derivatives of the volume of a passage, from those of its untrimmed faces' control nets."""

from collections.abc import Mapping

import numpy as np

from bladewright.blade.native.properties import moment_gradient, side_moments
from bladewright.derivatives.net_jacobian import NetJacobian
from bladewright.errors import DerivativeError
from bladewright.nurbs.surface import Surface

AGREED = 1e-6
"""Relative difference from the known volume above which the fluxes do not describe the body: a passage that winds
around the axis is off by a part of its volume, any other by the accuracy of its walls."""


def enclosed_volume_rates(
    found: NetJacobian, orientations: Mapping[str, int], volume: float, middle: float, *, revolved: bool
) -> dict[str, float]:
    """Derivatives by path of the volume [m^3] that faces enclose, +1 where a face's dS/du x dS/dv points outwards.

    `found` is the Jacobian of those faces that are not surfaces of revolution (in a cascade, not extruded along y): a
    field along theta, or y, has no flux through the others, nor through a trimmed tip. `middle` is the theta, or y, in
    the middle of the faces.
    Raises DerivativeError where the fluxes do not add up to the known `volume`.
    """
    faces: dict[str, Surface] = {}
    for name, shape in found.shapes.items():
        if not isinstance(shape, Surface) or shape.weights is not None:
            raise DerivativeError(f"the face '{name}' is no polynomial surface: take bladewright.sensitivity instead")
        faces[name] = shape
    enclosed = sum(
        orientations[name] * float(side_moments(face, middle, revolved=revolved, count=1)[0])
        for name, face in faces.items()
    )
    if not (enclosed / volume - 1.0) ** 2 <= AGREED**2:
        raise DerivativeError(
            f"the faces enclose {enclosed:.6g} m^3 by their fluxes along theta, and {volume:.6g} m^3 are known: for a "
            "passage that winds around the axis take bladewright.sensitivity instead"
        )
    total = np.zeros(len(found.paths))
    for name, face in faces.items():
        gradient = moment_gradient(face, middle, revolved=revolved, count=1)[0]
        total = total + orientations[name] * np.tensordot(found.homogeneous[name], gradient, axes=3)
    return {path: float(value) for path, value in zip(found.paths, total, strict=True)}
