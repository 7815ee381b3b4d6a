"""The exact blade: for every v the plane section of the laws' values there, laid on its stream surface."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bladewright.blade.mapping import Conformal, Mapping, Taylor, mapping_of
from bladewright.blade.meridional import Meridional, meridional
from bladewright.blade.streamlines import StreamLines, stream_lines
from bladewright.blade.unified import UnifiedBlade
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, radians, unit
from bladewright.nurbs.basis import Reals
from bladewright.section.camber import camber_line, camber_points
from bladewright.section.checks import UNITS
from bladewright.section.holding import check_edges
from bladewright.section.laws import Span
from bladewright.section.plane import PlaneSections, matched, plane_sections
from bladewright.section.sampling import sample_places
from bladewright.section.sides import side

SURVEY = np.array([0.0, 0.12, 0.25, 0.38, 0.5, 0.62, 0.75, 0.88, 1.0])
"""places along the span of the survey"""
REACH = 0.6
"""how far, in u, the channel may be continued for a nose"""


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
        _, position, tangential = self.on_lines(np.concatenate(self.plane.points(s), axis=-2))
        both = self.mapping.in_space(position[..., 0], position[..., 1], tangential)
        return both[..., : len(s), :], both[..., len(s) :, :]

    def points_and_normals(self, s: Reals) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """The same, with the unit normals of the stream surfaces there, towards the shroud."""
        u, position, tangential = self.on_lines(np.concatenate(self.plane.points(s), axis=-2))
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


@dataclass(frozen=True, kw_only=True)
class ExactBlade:
    """The blade that is meant, in metres and radians: what the native surfaces interpolate and are measured against."""

    design: UnifiedBlade
    channel: Meridional
    mapping: Mapping
    places: Reals
    """camber parameters of a side's control points"""
    before: float
    """how far, in u, stream lines are continued past the leading edge"""
    after: float
    """how far, in u, stream lines are continued past the trailing edge"""

    @cached_property
    def survey(self) -> Stations:
        """Stations from hub to shroud on which the shape is judged."""
        return self.stations(SURVEY)

    def stations(self, v: Reals) -> Stations:
        """Sections at v (m,); refuses an edge radius that the thickness cannot hold."""
        design, span = self.design, Span(v)
        lines = stream_lines(self.channel, self.mapping, v, self.before, self.after)
        angle_in, angle_out = (radians(span.values(law)) for law in (design.metal_angle_in, design.metal_angle_out))
        extent = lines.extents()
        edges = lines.position(np.array([0.0, 1.0]))
        if self.mapping.revolved:
            start = radians(span.values(0.0 if design.leading_edge_theta is None else design.leading_edge_theta))
        else:
            start = UNITS[design.length_unit] * span.values(
                0.0 if design.leading_edge_y is None else design.leading_edge_y
            )
        start = self.mapping.start(start, edges[..., 0, 1], lines.lengths)
        start, extent = np.broadcast_arrays(start, extent)
        camber = camber_line(
            start,
            extent,
            radians(span.values(design.stagger)),
            angle_in,
            angle_out,
            span.values(design.tangent_in),
            span.values(design.tangent_out),
        )
        inner = self.places[2:-2]
        radius = lines.position(lines.u_at(camber_points(camber, inner)[..., 0]))[..., 1]
        scale = self.mapping.scale(radius, lines.lengths[..., None])
        slopes = lines.position(np.array([0.0, 1.0]), 1)
        climbs = slopes[..., 1] / np.sqrt(np.sum(slopes * slopes, axis=-1))
        curvatures = [
            self.mapping.edge_curvature(
                span.values(law), lines.lengths, edges[..., i, 1], climbs[..., i] * np.cos(turn), bool(i)
            )
            for i, (law, turn) in enumerate(
                ((design.leading_edge_radius, angle_in), (design.trailing_edge_radius, angle_out))
            )
        ]
        sides = []
        for name, upper in (("upper", True), ("lower", False)):
            thickness = span.chordwise(getattr(design, f"thickness_{name}"), inner) * scale
            laws = getattr(design, f"weights_{name}")
            weights = span.chordwise(laws, self.places) if laws else None
            check_edges(design, name, camber, self.places, thickness, curvatures, weights, span)
            sides.append(side(camber, self.places, thickness, *curvatures, upper=upper, weights=weights))
        return Stations(
            v=v,
            lines=lines,
            plane=plane_sections(camber, *matched(*sides)),
            angle_in=angle_in,
            angle_out=angle_out,
            curvature_in=curvatures[0],
            curvature_out=curvatures[1],
        )


def exact_blade(design: UnifiedBlade) -> ExactBlade:
    """The exact blade of a design, its channel continued as far as the noses need."""
    mapping = mapping_of(design.mapping, design.arrangement)
    channel = meridional(design.channel, UNITS[design.length_unit])
    places = sample_places(design.samples, design.clustering)
    within = ExactBlade(design=design, channel=channel, mapping=mapping, places=places, before=0.0, after=0.0)
    before, after = _reaches(within.survey)
    exact = replace(within, before=before, after=after)
    # the sections do not change with how far the stream lines are continued
    longer = replace(within.survey, lines=stream_lines(channel, mapping, SURVEY, before, after))
    exact.__dict__["survey"] = longer
    return exact


def _reaches(stations: Stations) -> list[float]:
    """How far in u the noses stand outside the channel, bounded by the sides' control points, with a margin."""
    hull = np.concatenate([stations.plane.upper, stations.plane.lower], axis=-2)
    abscissae = np.real(hull[..., 0] / hull[..., 2] if hull.shape[-1] == 3 else hull[..., 0])
    lines, at = stations.lines, np.array([0.0, 1.0])
    densities = np.real(lines.mapping.density(lines.position(at), lines.position(at, 1)))
    before = -np.min(abscissae, axis=-1) / densities[..., 0]
    after = (np.max(abscissae, axis=-1) - np.real(lines.extents())) / densities[..., 1]
    reaches = [1.3 * float(np.max(past, initial=0.0)) + 0.01 for past in (before, after)]
    for value, edge in zip(reaches, ("leading", "trailing"), strict=True):
        if value > REACH:
            raise DesignError(
                f"thickness_upper or thickness_lower: the nose at the {edge} edge stands {value:.2f} of the meridional "
                f"length outside the channel, more than {REACH}: lower the thickness next to the edge, its radius or "
                "the metal angle there"
            )
    return reaches
