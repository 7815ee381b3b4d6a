"""What the CAD modules need of a body: named native surfaces that close it, and which of their sides is outside."""

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np

from bladewright.numerics.elementary import Array
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface
from bladewright.origin import Origin, parameters_hash

MM = 1000.0
"""[mm/m] Everything that is built is in metres, everything in OpenCASCADE and in CAD files in millimetres."""


class BodyProperties(Protocol):
    """Volume, area and centroid of a body, integrated over its native surfaces.

    They may have `areas` (k,) [m^2] of the faces, in the order of `ClosedBody.orientations`; without them, the areas
    are integrated when they are needed.
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
    """A body with the data that the header of a CAD file states, and texts that `header_text` finds."""

    @property
    def properties(self) -> BodyProperties:
        """Volume, area and centroid."""


class ClosedBody(NamedBody, Protocol):
    """A body bounded by native surfaces.

    A face of revolution may be a whole turn: an untrimmed `Surface` of which two opposite sides are the same curve, its
    seam. A body may have `edges` (`declared_edges`).
    """

    @property
    def surfaces(self) -> Mapping[str, Surface | TrimmedSurface]:
        """Faces of the body [m] by name."""

    @property
    def orientations(self) -> Mapping[str, int]:
        """+1 for a face whose dS/du x dS/dv points out of the body, -1 for the others."""


class NativeBody(ClosedBody, CadProduct, Protocol):
    """A body of native surfaces that is written to a file and that the file is measured against: a blade, a passage."""


def header_text(body: NamedBody, field: str) -> str:
    """A body's `description`, `author` or `organisation` for the header of a file; empty where it has none."""
    return str(getattr(body, field, "") or "")


def declared_edges(body: NamedBody) -> tuple[Curve, ...]:
    """A body's `edges`: curves in space [m], rational or not, along which trimmed faces meet each other.

    Where one ends on an edge of an untrimmed face, such as the rim circle of a wheel, that edge is cut there. Edges of
    untrimmed faces need not be declared.
    """
    return tuple(getattr(body, "edges", ()))


def extent(built: ClosedBody) -> float:
    """The longest side [m] of the box around the control points of all untrimmed faces (of all faces without any)."""
    faces = built.surfaces.values()
    nets = [face.control_points for face in faces if isinstance(face, Surface)]
    nets = nets or [face.surface.control_points for face in faces if isinstance(face, TrimmedSurface)]
    points = np.concatenate([np.real(net).reshape(-1, 3) for net in nets])
    return float(np.ptp(points, axis=0).max())


def origin_of(body: NamedBody) -> Origin | None:
    """Name and hash of the design that a body was built from; None where it knows none."""
    design: Any = getattr(getattr(body, "blade", body), "design", None)
    return None if design is None else Origin(name=design.name, parameters_hash=parameters_hash(design))
