"""The exact blade of the unified family: for every v the section of the laws' values there, on its stream surface."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, cast

import numpy as np

from bladewright.blade.exact.clearance import Clearance, channels_of, check_clearance, off_distance
from bladewright.blade.exact.exact_blade import ExactBlade
from bladewright.blade.exact.meridional_extent import MeridionalExtent, channel_extent
from bladewright.blade.exact.meridional_view import MeridionalView, channel_view
from bladewright.blade.exact.section_stack import SectionStack
from bladewright.blade.flow_path.channel import ChannelLine, TransfiniteChannel
from bladewright.blade.flow_path.cut_channel import FlowPathWall
from bladewright.blade.flow_path.followed_channel import followed_channel
from bladewright.blade.flow_path.stream_surface_map import StreamSurfaceMap, mapping_of
from bladewright.blade.flow_path.streamlines import MeridionalChannel, StreamLines, stream_lines
from bladewright.blade.native.knots import DEGREE
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array, concatenated, radians, unit
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.section.camber import camber_line, camber_points
from bladewright.section.crossing import PLACES, check_outlines, outlines_of
from bladewright.section.laws import Span, joints_of
from bladewright.section.outline import EdgeDerivatives
from bladewright.section.section import Section
from bladewright.section.smoothness import Smoothness, smoothness
from bladewright.section.unified_limits import check_edges
from bladewright.section.unified_sides import DEGREE as SIDE_DEGREE
from bladewright.section.unified_sides import (
    PlaneSections,
    camber_curve,
    matched,
    plane_sections,
    sample_places,
    side,
    side_curve,
)

if TYPE_CHECKING:
    from bladewright.blade.design.unified import UnifiedBlade

CHANNEL_FIELDS = "channel", "flow_path", "tip_clearance", "hub_clearance", "length_unit"
"""fields of a design by which its channel is made"""
KEPT_LINES = 8
"""sets of stream lines that are kept: a search asks for three again and again; more would only take memory"""
SURVEY = np.array([0.0, 0.12, 0.25, 0.38, 0.5, 0.62, 0.75, 0.88, 1.0])
"""Span fractions of the sections on which the shape is judged: ends, middle, and uneven places between, so that
waves of laws show."""
LONGEST_NOSE = 0.6
"""Largest extent, in u, of a rounded edge past the channel's edge curve: the channel's polynomials bend away beyond."""
LONGER_REACH = 1.5
"""Factor of the continuation where stream lines slow down past an edge, so that noses reach past it after all [-]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class UnifiedSections(SectionStack):
    """The exact blade's sections at places v (m,) along the span."""

    lines: StreamLines
    plane: PlaneSections
    metal_angles: tuple[Array, Array]
    """(..., m) at the leading and at the trailing edge [rad]"""
    curvatures: tuple[Array, Array]
    """(..., m) of the leading and the trailing edge in the plane"""
    radii: tuple[Array, Array]
    """(..., m) of the edges as the design gives them, of the meridional length [-]"""

    @property
    def edge_kinds(self) -> tuple[str, str]:
        return "round", "round"

    @property
    def clustered(self) -> bool:
        return False

    def plane_points(self, s: Reals) -> tuple[Array, Array]:
        return self.plane.points(s)

    def outlines(self) -> Reals:
        outlines = outlines_of(*self.plane_points(PLACES))
        return np.real(outlines)[(0,) * (outlines.ndim - 3)]

    def metal_angle(self, end: int) -> Array | None:
        return self.metal_angles[end]

    def edge_radius(self, end: int) -> Array | None:
        return self.radii[end] * self.lines.lengths

    def camber(self, share: Reals) -> Array:
        return camber_points(self.plane.camber, share)

    def camber_ends(self) -> tuple[Array, Array]:
        line = self.plane.camber
        return line[..., 1, :] - line[..., 0, :], line[..., 3, :] - line[..., 2, :]

    def camber_tangents(self) -> tuple[Array, Array] | None:
        return self.camber_ends()

    def channel_parameter(self, u: Array) -> Array:
        return u

    def leading_edge(self) -> EdgeDerivatives:
        normal, speed, bend, along = self._edge(0)
        return self.row(np.zeros(1), self.plane.camber[..., 0, :], speed[..., None] * normal, bend + along * normal)

    def trailing_edge(self) -> EdgeDerivatives:
        normal, speed, bend, along = self._edge(1)
        return self.row(np.ones(1), self.plane.camber[..., 3, :], -speed[..., None] * normal, along * normal - bend)

    def _edge(self, end: int) -> tuple[Array, Array, Array, Array]:
        """Normal of the camber line, speed along it, curvature times its square along the camber, tangential bend."""
        edge, turn = (self.plane.leading_edge, self.plane.trailing_edge)[end], self.metal_angles[end]
        normal = np.stack([-np.sin(turn), np.cos(turn)], axis=-1)
        curved = (self.curvatures[end] * edge.normal_speed**2)[..., None]
        bend = curved * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
        return normal, edge.normal_speed, bend, edge.tangential[..., None]


def unified_sections(
    design: "UnifiedBlade", places: Reals, lines: StreamLines, v: Reals, *, tentative: bool = False
) -> UnifiedSections:
    """The sections of a design on stream lines at v (m,), `places` the camber parameters of a side's control points.

    Raises DesignError for an edge radius that the thickness cannot hold, unless the design is tentative.
    """
    span = Span(v)
    angle_in, angle_out = (radians(span.values(law)) for law in (design.metal_angle_in, design.metal_angle_out))
    camber = _camber(design, span, lines, angle_in, angle_out)
    radii = span.values(design.leading_edge_radius), span.values(design.trailing_edge_radius)
    curvatures = [_edge_curvature(radii[end], lines, turn, end) for end, turn in enumerate((angle_in, angle_out))]
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
        metal_angles=(angle_in, angle_out),
        curvatures=(curvatures[0], curvatures[1]),
        radii=radii,
    )


def _camber(design: "UnifiedBlade", span: Span, lines: StreamLines, angle_in: Array, angle_out: Array) -> Array:
    """Control points (..., m, 4, 2) of the camber lines in their planes."""
    if lines.mapping.revolved:
        place = radians(span.values(0.0 if design.leading_edge_theta is None else design.leading_edge_theta))
    else:
        law = 0.0 if design.leading_edge_y is None else design.leading_edge_y
        place = design.metre * span.values(law)
    radius = lines.ends[0][..., 0, 1]
    start, extent = np.broadcast_arrays(lines.mapping.start(place, radius, lines.lengths), lines.extents())
    stagger, tangent_in, tangent_out = (
        span.values(law) for law in (design.stagger, design.tangent_in, design.tangent_out)
    )
    return camber_line(start, extent, radians(stagger), angle_in, angle_out, tangent_in, tangent_out)


def _edge_curvature(fraction: Array, lines: StreamLines, turn: Array, end: int) -> Array:
    """Curvature (..., m) to set in the plane at an edge, from its radius as a fraction of the meridional length."""
    radius = lines.ends[0][..., end, 1]
    climb = unit(lines.ends[1])[..., end, 1] * np.cos(turn)
    return lines.mapping.edge_curvature(fraction, lines.lengths, radius, climb, trailing=end == 1)


@dataclass(frozen=True, kw_only=True)
class ExactUnifiedBlade(ExactBlade):
    """The blade that a unified design defines, in metres and radians."""

    design: "UnifiedBlade"
    channel: TransfiniteChannel
    """the blade's own, between its ends"""
    full_channel: TransfiniteChannel
    """from wall to wall: the same where there is no clearance"""
    clearance: Clearance | None
    mapping: StreamSurfaceMap
    places: Reals
    """camber parameters of a side's control points"""
    before: float
    """how far stream lines are continued upstream of the leading edge, in u"""
    after: float
    """how far stream lines are continued downstream of the trailing edge, in u"""
    known_survey: UnifiedSections | None = None
    """the survey, where it is known already"""
    known_lines: dict[bytes, StreamLines] = field(default_factory=dict, repr=False, compare=False)
    """the last stream lines of the channel, by their places along the span: blades of many designs have one channel"""
    tentative: bool = False
    """whether edge radii that the thickness cannot hold are allowed, as in the midst of a search"""

    def moved_to(self, design: "UnifiedBlade") -> "ExactUnifiedBlade":
        moved = replace(self, design=design, known_survey=None)
        if all(getattr(design, name) is getattr(self.design, name) for name in CHANNEL_FIELDS):
            return moved
        full, channel, clearance = channels_of(design, self.tip_knots)
        return replace(moved, channel=channel, full_channel=full, clearance=clearance, known_lines={})

    def check(self) -> None:
        self._check_channel()
        self.check_sections()
        if self.clearance is not None:
            check_clearance(self.clearance, self.survey, self.design.ends.index("tip") * (len(self.survey.v) - 1))

    def check_sections(self) -> None:
        """Raise DesignError where sides cross or touch, or neighbouring blades intersect."""
        check_outlines(self.survey.outlines(), [f"at v = {v:.3f}, " for v in self.survey.v])
        self.check_neighbours()

    def _check_channel(self) -> None:
        """Refuse a channel that folds over, from nose to nose; the blade's own, too."""
        self.full_channel.check_folds(self.before, self.after)
        if self.clearance is not None:
            try:
                self.channel.check_folds(self.before, self.after)
            except DesignError as error:
                name = self.clearance.name
                cure = f"or lower {name}, or bring its two values nearer to each other"
                raise DesignError(f"{name} bounds the blade's own {error}; {cure}") from error

    def breaks_along_u(self) -> Reals:
        """Inner knots of the sections' sides, twice each: the sides keep three derivatives there."""
        spans = len(self.places) - SIDE_DEGREE
        return np.repeat(np.linspace(0.0, 1.0, spans + 1)[1:-1], DEGREE - SIDE_DEGREE + 1)

    def breaks_along_v(self) -> Reals:
        """Joints of the laws of evolution and of the channel's edges, as often as they lose derivatives."""
        design = self.design
        laws = [design.leading_edge_theta, design.leading_edge_y, design.stagger, design.metal_angle_in]
        laws += [design.metal_angle_out, design.tangent_in, design.tangent_out]
        laws += [design.leading_edge_radius, design.trailing_edge_radius]
        laws += [*design.thickness_upper, *design.thickness_lower, *design.weights_upper, *design.weights_lower]
        times: dict[float, int] = {}
        for law in laws:
            for place, smooth in () if law is None else joints_of(law):
                key = round(place, 12)
                times[key] = max(times.get(key, 0), DEGREE - smooth)
        for edge in (self.channel.leading_edge, self.channel.trailing_edge):
            for knot in edge.joints():
                key = round(float(knot), 12)
                if 0.0 < key < 1.0:
                    times[key] = max(times.get(key, 0), DEGREE - edge.degree + 1)
        return np.array([knot for knot in sorted(times) for _ in range(times[knot])])

    def meridional_channel(self, noses: tuple[float, float], ends: tuple[float, float]) -> MeridionalChannel:
        walls = self.path_walls
        return self.channel if walls is None else followed_channel(self.channel, walls, noses, ends)

    @property
    def path_walls(self) -> tuple[FlowPathWall, FlowPathWall] | None:
        """Hub and shroud of the flow path, where the blade reaches from wall to wall of one."""
        if self.design.flow_path is None or self.clearance is not None:
            return None
        return cast("FlowPathWall", self.full_channel.hub), cast("FlowPathWall", self.full_channel.shroud)

    def wall(self, name: str) -> ChannelLine:
        return self.channel.line(name)

    def end_wall(self, row: int) -> tuple[Curve, Reals]:
        wall = ("hub", "shroud")[row]
        curve = self.wall(wall).curve_over(-self.before, 1.0 + self.after)
        inner = curve.knots[(curve.knots > curve.knots[0]) & (curve.knots < curve.knots[-1])]
        if self.design.ends[row] == "tip":
            # at a single knot the fitted meridian is smooth up to what it misses
            inner = inner[np.sum(inner[:, None] == inner, axis=0) > 1]
        return curve, inner

    def wall_parameters(self, u: Reals) -> Reals:
        return np.stack([self.wall(name).own_parameters(u[row]) for row, name in enumerate(("hub", "shroud"))])

    def wall_points(self, name: str, u: Reals) -> Reals:
        return np.real(self.full_channel.line(name).values(u))

    @cached_property
    def meridional_view(self) -> MeridionalView:
        """Walls, edges and stream lines in the meridional plane."""
        return channel_view(self)

    @cached_property
    def meridional_extent(self) -> MeridionalExtent:
        """Between its noses, and where it stands in a flow path, to the ends of that."""
        noses, survey = (-self.before, 1.0 + self.after), self.survey
        return channel_extent(self.channel, self.path_walls, noses, survey.v, survey.lines.lengths)

    def without_clearance(self) -> "ExactUnifiedBlade":
        gaps = [name for name in ("tip_clearance", "hub_clearance") if getattr(self.design, name) is not None]
        return exact_unified_blade(self.design.changed(dict.fromkeys(gaps))) if gaps else self

    def clearance_error(self, u: Reals, points: Reals) -> Reals | None:
        return None if self.clearance is None else off_distance(self.full_channel, self.clearance, u, points)

    @property
    def tip_knots(self) -> Reals | None:
        return None if self.clearance is None else self.channel.knots(self.clearance.wall)

    def _section(self, v: float) -> Section:
        sections = self.sections(np.array([v]))
        plane, ends = sections.plane, sections.plane.camber[0, [0, 3]]
        return Section(
            span=v,
            plane=self.mapping.plane,
            curves=FrozenMapping({"upper": side_curve(plane.upper[0]), "lower": side_curve(plane.lower[0])}),
            camber=camber_curve(plane.camber[0]),
            stagger=float(np.real(np.arctan((ends[1, 1] - ends[0, 1]) / (ends[1, 0] - ends[0, 0])))),
            metal_angle_in=float(np.real(sections.metal_angles[0][0])),
            metal_angle_out=float(np.real(sections.metal_angles[1][0])),
            scale=sections.scale,
        )

    def smoothness(self, v: float) -> Smoothness:
        return smoothness(self.section(v))

    @cached_property
    def survey(self) -> UnifiedSections:
        """Sections from end to end on which the shape is judged."""
        return self.sections(SURVEY) if self.known_survey is None else self.known_survey

    def sections(self, v: Reals) -> UnifiedSections:
        """Sections at v (m,); refuses an edge radius that the thickness cannot hold, unless it is tentative."""
        if (key := v.tobytes()) not in self.known_lines:
            if len(self.known_lines) >= KEPT_LINES:
                self.known_lines.clear()
            self.known_lines[key] = stream_lines(self.channel, self.mapping, v, self.before, self.after)
        return unified_sections(self.design, self.places, self.known_lines[key], v, tentative=self.tentative)


def exact_unified_blade(
    design: "UnifiedBlade", tip_knots: Reals | None = None, *, tentative: bool = False
) -> ExactUnifiedBlade:
    """The exact blade of a design, its channel continued as far as its rounded edges need.

    `tip_knots` hold the knots of the meridian of a clearance surface; `tentative` allows edge radii that the
    thickness cannot hold. Raises DesignError where there is no such blade.
    """
    mapping = mapping_of(design.mapping, design.arrangement)
    full, channel, clearance = channels_of(design, tip_knots)
    places = sample_places(design.samples, design.clustering)
    lines = stream_lines(channel, mapping, SURVEY, 0.0, 0.0)
    within = unified_sections(design, places, lines, SURVEY, tentative=tentative)
    before, after = _reaches(within)
    # the sections do not depend on how far the stream lines are continued
    survey = replace(within, lines=stream_lines(channel, mapping, SURVEY, before, after))
    if not _covered(survey):
        before, after = LONGER_REACH * before, LONGER_REACH * after
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
        known_survey=survey,
        tentative=tentative,
    )


def _abscissae(stations: UnifiedSections) -> Reals:
    hull = concatenated([stations.plane.upper, stations.plane.lower], axis=-2)
    return np.asarray(np.real(hull[..., 0] / hull[..., 2] if hull.shape[-1] == 3 else hull[..., 0]))


def _covered(stations: UnifiedSections) -> bool:
    abscissae, ends = _abscissae(stations), np.real(stations.lines.starts)
    return bool(np.all(abscissae >= ends[..., :1]) and np.all(abscissae <= ends[..., -1:]))


def _reaches(stations: UnifiedSections) -> list[float]:
    """How far, in u, the rounded edges reach past the channel's edge curves: by the control points, with a margin."""
    abscissae, lines = _abscissae(stations), stations.lines
    densities = np.real(lines.mapping.density(*lines.ends))
    before = -np.min(abscissae, axis=-1) / densities[..., 0]
    after = (np.max(abscissae, axis=-1) - np.real(lines.extents())) / densities[..., 1]
    reaches = [1.3 * float(np.max(past, initial=0.0)) + 0.01 for past in (before, after)]
    for value, edge in zip(reaches, ("leading", "trailing"), strict=True):
        if value > LONGEST_NOSE:
            raise DesignError(
                f"thickness_upper or thickness_lower: the nose at the {edge} edge stands {value:.2f} of the meridional "
                f"length outside the channel, more than {LONGEST_NOSE}: lower the thickness next to the edge, its "
                "radius or the metal angle there"
            )
    return reaches
