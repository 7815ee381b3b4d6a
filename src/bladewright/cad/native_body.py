"""What the CAD modules need to know of a body: its closing native surfaces, and which of their sides is outside."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from bladewright.numerics.elementary import Array
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

MM = 1000.0
"""Millimetres in a metre: everything built is in metres, every CAD file in millimetres."""


class MassProperties(Protocol):
    """Properties of the body by quadrature on its native surfaces.

    Where there are `areas` (k,) [m^2] of the faces, in the order of `Built.orientations`, they are not computed again.
    """

    @property
    def volume(self) -> float:
        """Volume [m^3]."""

    @property
    def area(self) -> float:
        """Surface area [m^2]."""

    @property
    def centroid(self) -> Array:
        """Centroid of the volume (3,) [m]."""


class NamedBody(Protocol):
    """A body with a name."""

    @property
    def name(self) -> str:
        """Name of the product in a CAD file."""


class CadProduct(NamedBody, Protocol):
    """What a CAD file says of a body; `description`, `author` and `organisation` as well, where it has them."""

    @property
    def properties(self) -> MassProperties:
        """Volume, area and centroid."""


class ClosedBody(NamedBody, Protocol):
    """A body bounded by native surfaces."""

    @property
    def surfaces(self) -> Mapping[str, Surface | TrimmedSurface]:
        """Faces of the body [m] by name."""

    @property
    def orientations(self) -> Mapping[str, int]:
        """+1 for a face whose dS/du x dS/dv points out of the body, -1 for the others."""


class NativeBody(ClosedBody, CadProduct, Protocol):
    """A body of native surfaces that a file is measured against: a blade, a passage."""


def extent(built: ClosedBody) -> float:
    """The largest side [m] of the box around all control points of untrimmed faces, or of all where there is none."""
    faces = built.surfaces.values()
    nets = [face.control_points for face in faces if isinstance(face, Surface)]
    nets = nets or [face.surface.control_points for face in faces if isinstance(face, TrimmedSurface)]
    points = np.concatenate([np.real(net).reshape(-1, 3) for net in nets])
    return float(np.ptp(points, axis=0).max())
