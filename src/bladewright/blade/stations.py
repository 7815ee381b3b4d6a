"""Sections of the exact blade at places along the span: in their planes, and laid on their stream surfaces."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bladewright.blade.mapping import Conformal, Mapping, Taylor
from bladewright.blade.streamlines import StreamLines
from bladewright.blade.unified import UnifiedBlade
from bladewright.numerics.elementary import Array, joined, radians, unit
from bladewright.nurbs.basis import Reals
from bladewright.section.camber import camber_line, camber_points
from bladewright.section.checks import UNITS
from bladewright.section.holding import check_edges
from bladewright.section.laws import Span
from bladewright.section.plane import PlaneSections, matched, plane_sections
from bladewright.section.sides import side

_ENDS = np.array([0.0, 1.0])


class EdgeRow(NamedTuple):
    """An edge in space: its points and, by s along the upper side, the sides' derivatives there (..., m, 3).

    The lower side has the opposite first and the same second derivative.
    """

    point: Array
    first: Array
    second: Array


@dataclass(frozen=True, kw_only=True)
class Stations:
    """The exact blade's sections at places v (m,) along the span."""

    v: Reals
    lines: StreamLines
    plane: PlaneSections
    angle_in: Array
    """(..., m) metal angle at the leading edge [rad]"""
    angle_out: Array
    """(..., m) metal angle at the trailing edge [rad]"""
    curvature_in: Array
    """(..., m) curvature of the leading edge in the plane"""
    curvature_out: Array
    """(..., m) curvature of the trailing edge in the plane"""

    @property
    def mapping(self) -> Mapping:
        """The sections' plane and its way to space."""
        return self.lines.mapping

    def on_lines(self, plane: Array) -> tuple[Array, Array, Array]:
        """u, (x, r) and theta or y (..., m, k) of plane points (..., m, k, 2)."""
        u = self.lines.u_at(plane[..., 0])
        position = self.lines.position(u)
        return u, position, self.mapping.tangential(plane[..., 1], position[..., 1], self.lines.lengths[..., None])

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., m, len(s), 3) in metres of the upper and the lower side."""
        _, position, tangential = self.on_lines(joined(self.plane.points(s), axis=-2))
        both = self.mapping.in_space(position[..., 0], position[..., 1], tangential)
        return both[..., : len(s), :], both[..., len(s) :, :]

    def points_and_normals(self, s: Reals) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """The same, with the unit normals of the stream surfaces there, towards the shroud."""
        u, position, tangential = self.on_lines(joined(self.plane.points(s), axis=-2))
        both = self.mapping.in_space(position[..., 0], position[..., 1], tangential)
        slope = unit(self.lines.position(u, 1))
        if not self.mapping.revolved:
            tangential = np.zeros_like(tangential)
        normals = Conformal().in_space(-slope[..., 1], slope[..., 0], tangential)
        points, directions = ((array[..., : len(s), :], array[..., len(s) :, :]) for array in (both, normals))
        return points, directions

    def leading_edge(self) -> EdgeRow:
        """The leading edge in space."""
        edge, turn = self.plane.leading_edge, self.angle_in
        normal = np.stack([-np.sin(turn), np.cos(turn)], axis=-1)
        bend = (self.curvature_in * edge.normal_speed**2)[..., None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
        first = edge.normal_speed[..., None] * normal
        return self._row(0.0, self.plane.camber[..., 0, :], first, bend + edge.tangential[..., None] * normal)

    def trailing_edge(self) -> EdgeRow:
        """The trailing edge in space."""
        edge, turn = self.plane.trailing_edge, self.angle_out
        normal = np.stack([-np.sin(turn), np.cos(turn)], axis=-1)
        bend = (self.curvature_out * edge.normal_speed**2)[..., None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
        first = -edge.normal_speed[..., None] * normal
        return self._row(1.0, self.plane.camber[..., 3, :], first, edge.tangential[..., None] * normal - bend)

    def _row(self, u: float, start: Array, first: Array, second: Array) -> EdgeRow:
        at = np.array([u])
        position, slope, bend = (self.lines.position(at, order)[..., 0, :] for order in range(3))
        density = self.mapping.density(position, slope)
        growth = self.mapping.density_slope(position, slope, bend)
        u_first = first[..., 0] / density
        u_second = (second[..., 0] - growth * u_first**2) / density
        x, radius = (
            Taylor(position[..., i], slope[..., i] * u_first, bend[..., i] * u_first**2 + slope[..., i] * u_second)
            for i in (0, 1)
        )
        ordinate = Taylor(start[..., 1], first[..., 1], second[..., 1])
        tangential = self.mapping.tangential_series(ordinate, radius, self.lines.lengths)
        return EdgeRow(*self.mapping.series_in_space(x, radius, tangential))


def stations_at(
    design: UnifiedBlade, places: Reals, lines: StreamLines, v: Reals, *, tentative: bool = False
) -> Stations:
    """The sections of a design on stream lines at v (m,), `places` the camber parameters of a side's control points.

    Raises DesignError for an edge radius that the thickness cannot hold, unless the design is tentative.
    """
    span = Span(v)
    angle_in, angle_out = (radians(span.values(law)) for law in (design.metal_angle_in, design.metal_angle_out))
    camber = _camber(design, span, lines, angle_in, angle_out)
    curvatures = [
        _edge_curvature(span.values(law), lines, turn, trailing=trailing)
        for law, turn, trailing in (
            (design.leading_edge_radius, angle_in, False),
            (design.trailing_edge_radius, angle_out, True),
        )
    ]
    inner = places[2:-2]
    radius = lines.position(lines.u_at(camber_points(camber, inner)[..., 0]))[..., 1]
    scale = lines.mapping.scale(radius, lines.lengths[..., None])
    sides = []
    for name in ("upper", "lower"):
        thickness = span.chordwise(getattr(design, f"thickness_{name}"), inner) * scale
        laws = getattr(design, f"weights_{name}")
        weights = span.chordwise(laws, places) if laws else None
        if not tentative:
            check_edges(design, name, camber, places, thickness, curvatures, weights, span)
        sides.append(side(camber, places, thickness, *curvatures, upper=name == "upper", weights=weights))
    return Stations(
        v=v,
        lines=lines,
        plane=plane_sections(camber, *matched(*sides)),
        angle_in=angle_in,
        angle_out=angle_out,
        curvature_in=curvatures[0],
        curvature_out=curvatures[1],
    )


def _camber(design: UnifiedBlade, span: Span, lines: StreamLines, angle_in: Array, angle_out: Array) -> Array:
    """Control points (..., m, 4, 2) of the camber lines in their planes."""
    if lines.mapping.revolved:
        place = radians(span.values(0.0 if design.leading_edge_theta is None else design.leading_edge_theta))
    else:
        law = 0.0 if design.leading_edge_y is None else design.leading_edge_y
        place = UNITS[design.length_unit] * span.values(law)
    radius = lines.position(_ENDS)[..., 0, 1]
    start, extent = np.broadcast_arrays(lines.mapping.start(place, radius, lines.lengths), lines.extents())
    stagger, tangent_in, tangent_out = (
        span.values(law) for law in (design.stagger, design.tangent_in, design.tangent_out)
    )
    return camber_line(start, extent, radians(stagger), angle_in, angle_out, tangent_in, tangent_out)


def _edge_curvature(fraction: Array, lines: StreamLines, turn: Array, *, trailing: bool) -> Array:
    """Curvature (..., m) to set in the plane at an edge, from its radius as a fraction of the meridional length."""
    end = 1 if trailing else 0
    radius = lines.position(_ENDS)[..., end, 1]
    climb = unit(lines.position(_ENDS, 1))[..., end, 1] * np.cos(turn)
    return lines.mapping.edge_curvature(fraction, lines.lengths, radius, climb, trailing)
