"""The exact blade of sections: for every v the family's section, laid between the edge curves on its stream surface."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.blade.bladed_lines import Bladed, BladedLines, between
from bladewright.blade.exact import SURVEY
from bladewright.blade.knots import DEGREE
from bladewright.blade.mapping import Mapping
from bladewright.blade.meant import EndWall, Meant
from bladewright.blade.meridian import Meridian, ThroughPoints
from bladewright.blade.meridian_line import MeridianLine, real_first
from bladewright.blade.outline_stations import OutlineStations, StaggeredSections
from bladewright.blade.path_course import PathCourse, path_course
from bladewright.blade.plan import Plan, flow_path_plan
from bladewright.blade.planes import Counted, plane_of
from bladewright.blade.sectioned import SectionedBlade
from bladewright.blade.stream_surfaces import StreamSurfaces, stream_surfaces
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross2, radians
from bladewright.nurbs.basis import Reals
from bladewright.section.camber_angle import CamberAngle
from bladewright.section.checks import UNITS
from bladewright.section.crossing import check_outline
from bladewright.section.laws import DEGREE as LAW_DEGREE
from bladewright.section.laws import Span, inner_knots, laws_of
from bladewright.section.outline import Outline

SPANS = 8
"""knot spans along a side to begin with"""
NEWTON = 6
"""Newton's steps from an interpolated place to the span fraction of an edge curve's joint"""
STEEP = np.radians(89.0)
"""largest angle of a chord line: beyond it the extent between the edges says nothing of the chord"""


@dataclass(frozen=True, kw_only=True)
class SectionedExact(Meant):
    """The blade of sections that is meant, in metres and radians."""

    design: SectionedBlade
    surfaces: StreamSurfaces
    bladed: Bladed
    """the flow path with the edge curves in it"""

    @cached_property
    def survey(self) -> OutlineStations:
        """Stations from end to end on which the shape is judged."""
        return self.stations(SURVEY)

    def stations(self, v: Reals) -> OutlineStations:
        """Sections at v (m,); raises DesignError where there are none, or an edge curve misses a stream line."""
        design, span = self.design, Span(v)
        lines = self.bladed.lines(v, self.mapping)
        outline, stagger = family_sections(design, span, lines)
        _check_stagger(stagger, v)
        if self.mapping.revolved:
            place = radians(span.values(0.0 if design.leading_edge_theta is None else design.leading_edge_theta))
        else:
            law = 0.0 if design.leading_edge_y is None else design.leading_edge_y
            place = UNITS[design.length_unit] * span.values(law)
        radius = lines.position(np.zeros(1))[..., 0, 1]
        start = self.mapping.start(place, radius, lines.lengths)
        plane = StaggeredSections(
            outline=outline, stagger=stagger, chord=lines.extents() / np.cos(stagger), start=start
        )
        return OutlineStations(v=v, lines=lines, plane=plane)

    def moved_to(self, design: SectionedBlade) -> "SectionedExact":
        return sectioned_exact(design, checked=False)

    def breaks_along_u(self) -> Reals:
        joints = self.survey.plane.outline.joints
        ends = np.array([0.0, *(joint.s for joint in joints), 1.0])
        counts = np.maximum(1 if len(ends) > 2 else 2, np.rint(SPANS * np.diff(ends)).astype(int))
        parts = [np.linspace(a, b, n + 1)[1:-1] for a, b, n in zip(ends[:-1], ends[1:], counts, strict=True)]
        parts += [np.full(min(max(DEGREE - joint.derivatives, 1), DEGREE), joint.s) for joint in joints]
        return np.sort(np.concatenate(parts))

    def breaks_along_v(self) -> Reals:
        times: dict[float, int] = {}

        def needed(place: float, smooth: int) -> None:
            key = round(place, 12)
            if 0.0 < key < 1.0:
                times[key] = max(times.get(key, 0), DEGREE - smooth)

        design = self.design
        placing = [law for law in (design.leading_edge_theta, design.leading_edge_y) if law is not None]
        for law in (*placing, *laws_of(design.section)):
            for knot in inner_knots(len(law)) if isinstance(law, tuple) else ():
                needed(float(knot), LAW_DEGREE - 1)
        for place in self.surfaces.span_joints():
            needed(float(place), 2)
        for which, (edge, line) in enumerate(
            ((design.leading_edge, self.bladed.leading_edge), (design.trailing_edge, self.bladed.trailing_edge))
        ):
            for place, smooth in self._edge_joints(which, edge, line):
                needed(place, smooth)
        return np.array([knot for knot in sorted(times) for _ in range(times[knot])])

    def _edge_joints(self, which: int, edge: Meridian, line: MeridianLine) -> list[tuple[float, int]]:
        """v at which an edge curve loses derivatives, and how many it keeps there."""
        levels, counts = np.unique(line.knots[line.degree + 1 : -line.degree - 1], return_counts=True)
        if len(levels) == 0:
            return []
        # a spline through points keeps two derivatives, though its knots would let it lose one
        smooth = [2 if isinstance(edge, ThroughPoints) else line.degree - int(count) for count in counts]
        v = np.linspace(0.0, 1.0, 17)
        meeting = self.bladed.meetings(v)[which]
        t, q = real_first(meeting.t, 1), real_first(meeting.q, 1)
        if q[0] > q[-1]:
            t, q, v = t[::-1], q[::-1], v[::-1]
        met = (levels > q[0]) & (levels < q[-1])
        at = np.interp(levels[met], q, v)
        own = np.interp(levels[met], q, t)
        target = real_first(line.values(levels[met]), 2)
        for _ in range(NEWTON):
            point, along, across = (real_first(each, 2) for each in self.surfaces.at(own, at))
            turn, miss = cross2(along, across), target - point
            own = np.clip(own + cross2(miss, across) / turn, self.surfaces.low, self.surfaces.high)
            at = np.clip(at + cross2(along, miss) / turn, 0.0, 1.0)
        return list(zip(at.tolist(), np.array(smooth)[met].tolist(), strict=True))

    @property
    def meridians(self) -> StreamSurfaces:
        return self.surfaces

    @cached_property
    def course(self) -> PathCourse:
        return path_course(self.surfaces, self.survey)

    def whole(self) -> "SectionedExact":
        return self

    def end_wall(self, row: int) -> EndWall:
        curve = self.surfaces.walls[("hub", "shroud")[row]].curve()
        inner = curve.knots[(curve.knots > curve.knots[0]) & (curve.knots < curve.knots[-1])]
        return EndWall(curve, inner)

    def wall_places(self, u: Reals) -> Reals:
        t = real_first(self.survey.lines.rows([0, -1]).t(u), 2)
        return np.stack([self.surfaces.wall_parameter(name, t[i]) for i, name in enumerate(("hub", "shroud"))])

    @cached_property
    def plan(self) -> Plan:
        """Walls, edges, stream lines and stream surfaces in the meridional plane."""
        return flow_path_plan(self)

    def wall_line(self, name: str, u: Reals) -> Reals:
        v = np.array([("hub", "shroud").index(name)], dtype=np.float64)
        start, end = (float(real_first(t, 1)[0]) for t in self.bladed.edges(v))
        t = np.unique(np.clip(start + (end - start) * u, self.surfaces.low, self.surfaces.high))
        return np.asarray(np.real(self.surfaces.real().position(v, t[None])[0]))


def sectioned_exact(design: SectionedBlade, *, checked: bool = True) -> SectionedExact:
    """The exact blade of a design of sections.

    Raises DesignError where its flow path folds, or edges and flow path do not meet, and where it is to be `checked`,
    for sections that cross themselves.
    """
    metre, revolved = UNITS[design.length_unit], design.arrangement == "annular"
    mapping: Mapping = plane_of(design.plane, design.arrangement)
    try:
        surfaces = stream_surfaces(
            design.flow_path, metre, (design.leading_edge, design.trailing_edge), revolved=revolved
        )
    except DesignError as error:
        raise DesignError(f"flow_path: {error}") from error
    edges = [edge.line(metre) for edge in (design.leading_edge, design.trailing_edge)]
    bladed = between(surfaces, *edges, counted=isinstance(mapping, Counted))
    exact = SectionedExact(design=design, mapping=mapping, surfaces=surfaces, bladed=bladed)
    if checked:
        outline = exact.survey.plane.outline
        check_outline(outline, [f" at v = {v:.3f}" for v in SURVEY])
    return exact


def family_sections(design: SectionedBlade, span: Span, lines: BladedLines) -> tuple[Outline, Array]:
    """The family's sections in chords and their stagger (..., m) [rad] on stream lines."""
    part = design.section
    if not (isinstance(part, CamberAngle) and lines.mapping.plane == "m'-theta"):
        return part.outline(span), part.stagger(span)

    def meridional(fractions: Reals) -> Array:
        u = lines.u_at(lines.extents()[..., None] * fractions)
        return lines.meridional(u) / lines.lengths[..., None]

    return part.outline(span, meridional), part.stagger(span, meridional)


def _check_stagger(stagger: Array, v: Reals) -> None:
    real = np.real(stagger).reshape(-1, len(v))
    steep = np.argwhere(real**2 >= STEEP**2)
    if len(steep):
        row, at = steep[0]
        raise DesignError(
            f"section: its chord line stands at {np.degrees(real[row, at]):.4g} deg at v = {v[at]:.3f}: it must keep "
            "below 89 deg to both sides, for the edge curves give the chord by its extent along the flow; lower the "
            "stagger angle there"
        )
