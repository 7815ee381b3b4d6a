"""The exact blade of the unified family: for every v the section of the laws' values there, on its stream surface."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.blade.exact.clearance import Clearance, clearance_of, cleared
from bladewright.blade.exact.exact_blade import ExactBlade, WallMeridian
from bladewright.blade.exact.meridional_extent import ChannelExtent
from bladewright.blade.exact.meridional_view import MeridionalView, channel_view
from bladewright.blade.exact.section_stack import SectionStack
from bladewright.blade.flow_path.channel import TransfiniteChannel, transfinite_channel
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.flow_path.stream_surface_map import StreamSurfaceMap, mapping_of
from bladewright.blade.flow_path.streamlines import StreamLines, stream_lines
from bladewright.blade.native.knots import breaks_along_u, breaks_along_v
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, concatenated, radians, unit
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.domain import extended
from bladewright.section.camber import camber_line, camber_points
from bladewright.section.checks import UNITS
from bladewright.section.laws import Span
from bladewright.section.outline import EdgeDerivatives
from bladewright.section.unified_limits import check_edges
from bladewright.section.unified_sides import PlaneSections, matched, plane_sections, sample_places, side

_ENDS = np.array([0.0, 1.0])


@dataclass(frozen=True, kw_only=True, eq=False)
class UnifiedSections(SectionStack):
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

    def channel_parameter(self, u: Array) -> Array:
        return u

    def leading_edge(self) -> EdgeDerivatives:
        """The leading edge in space."""
        edge, turn = self.plane.leading_edge, self.angle_in
        normal = np.stack([-np.sin(turn), np.cos(turn)], axis=-1)
        bend = (self.curvature_in * edge.normal_speed**2)[..., None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
        first = edge.normal_speed[..., None] * normal
        return self.row(_ENDS[:1], self.plane.camber[..., 0, :], first, bend + edge.tangential[..., None] * normal)

    def trailing_edge(self) -> EdgeDerivatives:
        """The trailing edge in space."""
        edge, turn = self.plane.trailing_edge, self.angle_out
        normal = np.stack([-np.sin(turn), np.cos(turn)], axis=-1)
        bend = (self.curvature_out * edge.normal_speed**2)[..., None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
        first = -edge.normal_speed[..., None] * normal
        return self.row(_ENDS[1:], self.plane.camber[..., 3, :], first, edge.tangential[..., None] * normal - bend)


def unified_sections(
    design: UnifiedBlade, places: Reals, lines: StreamLines, v: Reals, *, tentative: bool = False
) -> UnifiedSections:
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
    return UnifiedSections(
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


SURVEY = np.array([0.0, 0.12, 0.25, 0.38, 0.5, 0.62, 0.75, 0.88, 1.0])
"""places along the span of the survey"""
REACH = 0.6
"""how far, in u, the channel may be continued for a nose"""


@dataclass(frozen=True, kw_only=True)
class ExactUnifiedBlade(ExactBlade):
    """The blade that is meant, in metres and radians: what the native surfaces interpolate and are measured against."""

    design: UnifiedBlade
    channel: TransfiniteChannel
    """the blade's own, between its ends"""
    full_channel: TransfiniteChannel
    """from wall to wall: the same where there is no clearance"""
    clearance: Clearance | None
    mapping: StreamSurfaceMap
    places: Reals
    """camber parameters of a side's control points"""
    before: float
    """how far, in u, stream lines are continued past the leading edge"""
    after: float
    """how far, in u, stream lines are continued past the trailing edge"""
    surveyed: UnifiedSections | None = None
    """the survey, where it is at hand"""
    tentative: bool = False
    """whether edge radii that the thickness cannot hold are let through, as on the way of a search"""

    def moved_to(self, design: UnifiedBlade) -> "ExactUnifiedBlade":
        return moved_exact_blade(self, design)

    def breaks_along_u(self) -> Reals:
        return breaks_along_u(self)

    def breaks_along_v(self) -> Reals:
        return breaks_along_v(self)

    def end_wall(self, row: int) -> WallMeridian:
        wall = ("hub", "shroud")[row]
        inner = self.channel.line(wall).joints()
        if self.design.ends[row] == "tip":
            # at a single knot the fitted meridian is smooth up to what it misses
            inner = inner[np.sum(inner[:, None] == inner, axis=0) > 1]
        return WallMeridian(extended(self.channel.curve(wall), -self.before, 1.0 + self.after), inner)

    def wall_places(self, u: Reals) -> Reals:
        return u

    @cached_property
    def plan(self) -> MeridionalView:
        """Walls, edges and stream lines in the meridional plane."""
        return channel_view(self)

    def wall_line(self, name: str, u: Reals) -> Reals:
        return np.real(self.full_channel.curve(name)(u))

    @property
    def meridians(self) -> TransfiniteChannel:
        return self.channel

    @property
    def meridional_extent(self) -> ChannelExtent:
        ends = -self.before, 1.0 + self.after
        length = float(np.mean(real_first(self.survey.lines.lengths, 1)))
        return ChannelExtent(
            channel=self.channel, start=ends[0], end=ends[1], noses=ends, edges=(0.0, 1.0), length=length, unit=1.0
        )

    def whole(self) -> "ExactUnifiedBlade":
        gaps = [name for name in ("tip_clearance", "hub_clearance") if getattr(self.design, name) is not None]
        return exact_unified_blade(self.design.changed(dict.fromkeys(gaps))) if gaps else self

    @property
    def tip_knots(self) -> Reals | None:
        """Knots of the meridian of the clearance surface, where there is one."""
        return None if self.clearance is None else self.channel.knots(self.clearance.wall)

    @cached_property
    def survey(self) -> UnifiedSections:
        """Stations from end to end on which the shape is judged."""
        return self.stations(SURVEY) if self.surveyed is None else self.surveyed

    def stations(self, v: Reals) -> UnifiedSections:
        """Sections at v (m,); refuses an edge radius that the thickness cannot hold, unless it is tentative."""
        lines = stream_lines(self.channel, self.mapping, v, self.before, self.after)
        return unified_sections(self.design, self.places, lines, v, tentative=self.tentative)


def exact_unified_blade(
    design: UnifiedBlade, tip_knots: Reals | None = None, *, tentative: bool = False
) -> ExactUnifiedBlade:
    """The exact blade of a design, its channel continued as far as the noses need.

    `tip_knots` hold the knots of the meridian of a clearance surface; `tentative` lets through edge radii that the
    thickness cannot hold. Raises DesignError where there is no such blade.
    """
    mapping = mapping_of(design.mapping, design.arrangement)
    full, channel, clearance = _channels_of(design, tip_knots)
    places = sample_places(design.samples, design.clustering)
    lines = stream_lines(channel, mapping, SURVEY, 0.0, 0.0)
    within = unified_sections(design, places, lines, SURVEY, tentative=tentative)
    before, after = _reaches(within)
    # the sections do not depend on how far the stream lines are continued
    survey = replace(within, lines=stream_lines(channel, mapping, SURVEY, before, after))
    return ExactUnifiedBlade(
        design=design,
        channel=channel,
        full_channel=full,
        clearance=clearance,
        mapping=mapping,
        places=places,
        before=before,
        after=after,
        surveyed=survey,
        tentative=tentative,
    )


def moved_exact_blade(exact: ExactUnifiedBlade, design: UnifiedBlade) -> ExactUnifiedBlade:
    """The exact blade of a design that is a small step away, its channel continued as far as that of `exact`."""
    full, channel, clearance = _channels_of(design, exact.tip_knots)
    return replace(exact, design=design, channel=channel, full_channel=full, clearance=clearance, surveyed=None)


def _channels_of(
    design: UnifiedBlade, tip_knots: Reals | None
) -> tuple[TransfiniteChannel, TransfiniteChannel, Clearance | None]:
    full = transfinite_channel(design.channel, UNITS[design.length_unit])
    clearance = clearance_of(design)
    return full, full if clearance is None else cleared(full, clearance, tip_knots), clearance


def _reaches(stations: UnifiedSections) -> list[float]:
    """How far in u the noses stand outside the channel, bounded by the sides' control points, with a margin."""
    hull = concatenated([stations.plane.upper, stations.plane.lower], axis=-2)
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
