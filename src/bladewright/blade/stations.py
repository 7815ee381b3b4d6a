"""Sections of the exact blade at places along the span: in their planes, and laid on their stream surfaces."""

from dataclasses import dataclass

import numpy as np

from bladewright.blade.laid import EdgeRow, Laid
from bladewright.blade.streamlines import StreamLines
from bladewright.blade.unified import UnifiedBlade
from bladewright.numerics.elementary import Array, radians, unit
from bladewright.nurbs.basis import Reals
from bladewright.section.camber import camber_line, camber_points
from bladewright.section.checks import UNITS
from bladewright.section.holding import check_edges
from bladewright.section.laws import Span
from bladewright.section.plane import PlaneSections, matched, plane_sections
from bladewright.section.sides import side

_ENDS = np.array([0.0, 1.0])


@dataclass(frozen=True, kw_only=True, eq=False)
class Stations(Laid):
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
    def kinds(self) -> tuple[str, str]:
        return "round", "round"

    @property
    def gathered(self) -> bool:
        return False

    def camber(self, share: Reals) -> Array:
        return camber_points(self.plane.camber, share)

    def camber_ends(self) -> tuple[Array, Array]:
        line = self.plane.camber
        return line[..., 1, :] - line[..., 0, :], line[..., 3, :] - line[..., 2, :]

    def on_course(self, u: Array) -> Array:
        return u

    def leading_edge(self) -> EdgeRow:
        """The leading edge in space."""
        edge, turn = self.plane.leading_edge, self.angle_in
        normal = np.stack([-np.sin(turn), np.cos(turn)], axis=-1)
        bend = (self.curvature_in * edge.normal_speed**2)[..., None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
        first = edge.normal_speed[..., None] * normal
        return self.row(_ENDS[:1], self.plane.camber[..., 0, :], first, bend + edge.tangential[..., None] * normal)

    def trailing_edge(self) -> EdgeRow:
        """The trailing edge in space."""
        edge, turn = self.plane.trailing_edge, self.angle_out
        normal = np.stack([-np.sin(turn), np.cos(turn)], axis=-1)
        bend = (self.curvature_out * edge.normal_speed**2)[..., None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
        first = -edge.normal_speed[..., None] * normal
        return self.row(_ENDS[1:], self.plane.camber[..., 3, :], first, edge.tangential[..., None] * normal - bend)


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
