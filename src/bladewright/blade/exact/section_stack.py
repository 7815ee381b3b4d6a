"""Sections on their stream surfaces: from points of their planes to points, normals and edges in space."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Literal, Protocol, Self

import numpy as np

from bladewright.blade.flow_path.stream_surface_map import Conformal, StreamSurfaceMap, Taylor
from bladewright.numerics.elementary import Array, concatenated, unit
from bladewright.nurbs.basis import Reals
from bladewright.section.outline import EdgeDerivatives


class SectionStreamLines(Protocol):
    """Stream lines (..., m) by u, 0 at the leading and 1 at the trailing edge."""

    @property
    def mapping(self) -> StreamSurfaceMap:
        """The sections' plane."""

    @property
    def lengths(self) -> Array:
        """(..., m) meridional length between the edges [m]."""

    def position(self, u: Array, order: int = 0) -> Array:
        """(x, r) or derivatives by u (..., m, k, 2) at u (..., m, k) or (k,)."""

    def u_at(self, abscissa: Array) -> Array:
        """u (..., m, k) at an abscissa (..., m, k)."""

    def densities(self, u: Array) -> tuple[Array, Array]:
        """First and second derivatives (..., m, k) of the abscissa by u."""

    def extents(self) -> Array:
        """(..., m) the abscissa at the trailing edge."""

    def rows(self, which: list[int]) -> Self:
        """Some of the stream lines, by their number along the span."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SectionStack(ABC):
    """Sections at places along the span, in their planes and on their stream surfaces."""

    v: Reals
    """(m,) places along the span"""
    lines: SectionStreamLines
    """their stream lines"""

    @abstractmethod
    def plane_points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., m, len(s), 2) of the upper and the lower side in their planes."""

    @abstractmethod
    def outlines(self) -> Reals:
        """Closed polygons (m, n, 2) in their planes, of the real design, by which crossings are found."""

    @abstractmethod
    def leading_edge(self) -> EdgeDerivatives:
        """The upper side at the leading edge in space."""

    @abstractmethod
    def trailing_edge(self) -> EdgeDerivatives:
        """The upper side at the trailing edge in space."""

    @property
    @abstractmethod
    def edge_kinds(self) -> tuple[str, str]:
        """How the sides meet at the leading and at the trailing edge: "round", "sharp" or "blunt"."""

    @property
    def back(self) -> float | None:
        """The s from which both sides are one straight back face, where they are."""
        return None

    @property
    @abstractmethod
    def clustered(self) -> bool:
        """Whether s is denser at the edges: whether sides leave them slower than camber lines do."""

    @abstractmethod
    def camber(self, share: Reals) -> Array:
        """Points (..., m, k, 2) of smooth camber lines at shares (k,) from the leading to the trailing edge."""

    @abstractmethod
    def camber_ends(self) -> tuple[Array, Array]:
        """Vectors (..., m, 2) along the camber lines at both edges, downstream; their lengths mean nothing."""

    def camber_tangents(self) -> tuple[Array, Array] | None:
        """Vectors (..., m, 2) along the family's own camber lines at both edges, downstream, of any length.

        None where the blade has none between its ends, as it is ruled or developable.
        """
        return None

    @abstractmethod
    def channel_parameter(self, u: Array) -> Array:
        """The parameter of the exact blade's channel or flow path at u (..., m, k) or (k,)."""

    def lower_edges(self) -> tuple[EdgeDerivatives | None, EdgeDerivatives | None]:
        """The lower side at both edges in space; None where the edge is round: the upper side's `mirrored`."""
        return None, None

    def faces(self, w: Reals) -> dict[str, Array]:
        """Points (..., m, len(w), 3) of the faces of blunt edges by name, w from the upper to the lower side."""
        del w
        return {}

    def metal_angle(self, end: int) -> Array | None:
        """The metal angle (..., m) [rad] that the design gives the leading (0) or the trailing edge (1); None: none."""
        del end
        return None

    def edge_radius(self, end: int) -> Array | None:
        """The radius (..., m) [m] in the stream surface that the design gives an edge; None: none."""
        del end
        return None

    @property
    def skinning(self) -> Literal["sections", "ruled", "developable"]:
        """What the curves of constant v are: sections on stream surfaces, or cut out of ruled or developable sides.

        Those of ruled sides lie on no stream surface.
        """
        return "sections"

    @property
    def mapping(self) -> StreamSurfaceMap:
        """The sections' plane and its way to space."""
        return self.lines.mapping

    def chord_line(self, u: Array, order: int = 0) -> Array:
        """(x, r), or its derivative by u, (..., m, k, 2) from the leading edge, u = 0, to the trailing edge, u = 1.

        It is where the chord lines lie in the meridional plane: on the stream lines.
        """
        return self.lines.position(u, order)

    def scale(self, abscissa: Array) -> Array:
        """Metres in a unit of the plane at abscissae (k,) of the first section."""
        u = self.lines.u_at(np.atleast_1d(abscissa)[None])
        speed = np.sqrt(np.sum(self.lines.position(u, 1) ** 2, axis=-1))
        return (speed / self.lines.densities(u)[0])[0]

    def on_lines(self, plane: Array) -> tuple[Array, Array, Array]:
        """u, (x, r) and theta or y (..., m, k) of plane points (..., m, k, 2)."""
        lines = self.lines
        u = lines.u_at(plane[..., 0])
        position = lines.position(u)
        return u, position, self.mapping.tangential(plane[..., 1], position[..., 1], lines.lengths[..., None])

    def in_space(self, plane: Array) -> Array:
        """Points (..., m, k, 3) in metres of plane points (..., m, k, 2)."""
        _, position, tangential = self.on_lines(plane)
        return self.mapping.in_space(position[..., 0], position[..., 1], tangential)

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., m, len(s), 3) in metres of the upper and the lower side."""
        both = self.in_space(concatenated(self.plane_points(s), axis=-2))
        return both[..., : len(s), :], both[..., len(s) :, :]

    def points_and_normals(self, s: Reals) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """The same, with the unit normals of the stream surfaces there, towards the shroud."""
        u, position, tangential = self.on_lines(concatenated(self.plane_points(s), axis=-2))
        both = self.mapping.in_space(position[..., 0], position[..., 1], tangential)
        slope = unit(self.lines.position(u, 1))
        if not self.mapping.revolved:
            tangential = np.zeros_like(tangential)
        normals = Conformal().in_space(-slope[..., 1], slope[..., 0], tangential)
        points, directions = ((array[..., : len(s), :], array[..., len(s) :, :]) for array in (both, normals))
        return points, directions

    def row(self, u: Array, start: Array, first: Array, second: Array) -> EdgeDerivatives:
        """A side's edge in space from its ordinate's point and its derivatives in the plane (..., m, 2).

        `u` (1,) or (..., m, 1) is where it stands.
        """
        lines, mapping = self.lines, self.mapping
        position, slope, bend = (lines.position(u, order)[..., 0, :] for order in range(3))
        density, growth = (each[..., 0] for each in lines.densities(u))
        u_first = first[..., 0] / density
        u_second = (second[..., 0] - growth * u_first**2) / density
        x, radius = (
            Taylor(position[..., i], slope[..., i] * u_first, bend[..., i] * u_first**2 + slope[..., i] * u_second)
            for i in (0, 1)
        )
        ordinate = Taylor(start[..., 1], first[..., 1], second[..., 1])
        tangential = mapping.tangential_series(ordinate, radius, lines.lengths)
        return EdgeDerivatives(*mapping.series_in_space(x, radius, tangential))
