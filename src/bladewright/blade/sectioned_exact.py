"""The exact blade of sections: for every v the family's section, laid on its stream surface where it is to stand."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.blade.bladed_lines import Bladed, between
from bladewright.blade.developable import developed_stations
from bladewright.blade.edge_joints import curve_joints
from bladewright.blade.exact import SURVEY
from bladewright.blade.knots import DEGREE
from bladewright.blade.mapping import Mapping
from bladewright.blade.meant import EndWall, Meant
from bladewright.blade.meridian_line import real_first
from bladewright.blade.outline_stations import OutlineStations
from bladewright.blade.path_course import PathCourse, path_course
from bladewright.blade.path_stations import PathStations
from bladewright.blade.plan import Plan, flow_path_plan
from bladewright.blade.planes import Counted, plane_of
from bladewright.blade.ruled import RuledStations, check_ruled, ruled_stations
from bladewright.blade.sectioned import SectionedBlade
from bladewright.blade.sectioned_stations import Place, placed_sections
from bladewright.blade.stacking_place import StackingPlace
from bladewright.blade.stacking_reference import reference_points
from bladewright.blade.stream_surfaces import StreamSurfaces, stream_surfaces
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.crossing import check_outline
from bladewright.section.laws import DEGREE as LAW_DEGREE
from bladewright.section.laws import Span, inner_knots, laws_of

ENDS = np.array([0.0, 1.0])
"""hub and shroud"""
SPANS = 8
"""knot spans along a side to begin with"""


@dataclass(frozen=True, kw_only=True)
class SectionedExact(Meant):
    """The blade of sections that is meant, in metres and radians."""

    design: SectionedBlade
    surfaces: StreamSurfaces
    place: Place
    """what puts the sections on their stream lines: edge curves, or reference points"""

    @cached_property
    def survey(self) -> PathStations:
        """Stations from end to end on which the shape is judged."""
        return self.stations(SURVEY)

    def stations(self, v: Reals) -> PathStations:
        """What the blade is at v (m,), as its skinning has it."""
        if self.design.skinning == "ruled":
            return ruled_stations(self.rails, self.sections(v))
        if self.design.skinning == "developable":
            return developed_stations(self.surfaces, self.sections(ENDS[:1]), self.references, v)
        return self.sections(v)

    def sections(self, v: Reals) -> OutlineStations:
        """The design's sections at v (m,); raises DesignError where there are none, or they leave the flow path."""
        return placed_sections(self.design, self.place, self.mapping, v)

    @cached_property
    def rails(self) -> OutlineStations:
        """The design's sections at hub and shroud."""
        return self.sections(ENDS)

    @property
    def references(self) -> Array:
        """The reference points (..., 2, 3) of hub and shroud in space [m]."""
        plane = self.rails.plane
        points = reference_points(self.design.stacking, plane.outline, Span(ENDS))
        return self.rails.in_space(plane.placed(points[..., None, :]))[..., 0, :]

    @property
    def given_spans(self) -> Reals:
        if self.design.skinning == "ruled":
            return ENDS
        return np.unique([*self.design.flow_path.spans, *self.design.section_spans])

    @property
    def section_spans(self) -> tuple[float, ...]:
        if self.design.skinning == "developable":
            return (0.0,)
        spans = np.union1d(self.given_spans, [] if self.design.skinning == "ruled" else [0.5])
        return tuple(float(v) for v in spans)

    def moved_to(self, design: SectionedBlade) -> "SectionedExact":
        return sectioned_exact(design, checked=False)

    def breaks_along_u(self) -> Reals:
        joints = self.rails.plane.outline.joints
        ends = np.array([0.0, *(joint.s for joint in joints), 1.0])
        counts = np.maximum(1 if len(ends) > 2 else 2, np.rint(SPANS * np.diff(ends)).astype(int))
        parts = [np.linspace(a, b, n + 1)[1:-1] for a, b, n in zip(ends[:-1], ends[1:], counts, strict=True)]
        parts += [np.full(min(max(DEGREE - joint.derivatives, 1), DEGREE), joint.s) for joint in joints]
        return np.sort(np.concatenate(parts))

    def breaks_along_v(self) -> Reals:
        if self.design.skinning == "ruled":
            return np.empty(0)
        times: dict[float, int] = {}

        def needed(place: float, smooth: int) -> None:
            key = round(place, 12)
            if 0.0 < key < 1.0:
                times[key] = max(times.get(key, 0), DEGREE - smooth)

        design = self.design
        laws = [design.leading_edge_theta, design.leading_edge_y, design.sweep, design.lean, design.conformal_sweep]
        if design.stacking is not None:
            laws += [getattr(design.stacking, name) for name in ("chord_fraction", "chord", "theta", "y")]
        for law in (*laws, *laws_of(design.section)):
            for knot in inner_knots(len(law)) if isinstance(law, tuple) else ():
                needed(float(knot), LAW_DEGREE - 1)
        for place in self.surfaces.span_joints():
            needed(float(place), 2)
        for place, smooth in self._joints_across():
            needed(place, smooth)
        return np.array([knot for knot in sorted(times) for _ in range(times[knot])])

    def _joints_across(self) -> list[tuple[float, int]]:
        """v at which the lines that sections stand on lose derivatives, and how many they keep there."""
        design, place, v = self.design, self.place, np.linspace(0.0, 1.0, 17)
        if isinstance(place, Bladed):
            edges = (design.leading_edge, place.leading_edge), (design.trailing_edge, place.trailing_edge)
            return [
                joint
                for (edge, line), meeting in zip(edges, place.meetings(v), strict=True)
                if edge is not None
                for joint in curve_joints(self.surfaces, edge, line, v, meeting)
            ]
        if place.stacking.onwards == "least-distance":
            # stream lines keep one derivative at least, and the line across them one more
            return [(float(joint), 2) for joint in place.path.joints]
        meridian = place.stacking.line
        return [] if meridian is None else curve_joints(self.surfaces, meridian, place.line, v, place.meeting(v))

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
        lines = self.survey.lines.rows([0 if name == "hub" else -1])
        start, end = (float(real_first(t, 1)[0]) for t in (lines.leading, lines.trailing))
        t = np.unique(np.clip(start + (end - start) * u, self.surfaces.low, self.surfaces.high))
        return np.asarray(np.real(self.surfaces.real().position(v, t[None])[0]))


def sectioned_exact(design: SectionedBlade, *, checked: bool = True) -> SectionedExact:
    """The exact blade of a design of sections.

    Raises DesignError where its flow path folds, or edges and flow path do not meet, and where it is to be `checked`,
    for sections that cross themselves.
    """
    metre, revolved = UNITS[design.length_unit], design.arrangement == "annular"
    mapping: Mapping = plane_of(design.plane, design.arrangement)
    edges = None
    if design.leading_edge is not None and design.trailing_edge is not None:
        edges = design.leading_edge, design.trailing_edge
    try:
        surfaces = stream_surfaces(design.flow_path, metre, edges, revolved=revolved)
    except DesignError as error:
        raise DesignError(f"flow_path: {error}") from error
    exact = SectionedExact(design=design, mapping=mapping, surfaces=surfaces, place=_place(design, surfaces, mapping))
    if checked:
        v = {"sections": SURVEY, "ruled": ENDS, "developable": ENDS[:1]}[design.skinning]
        check_outline(exact.sections(v).plane.outline, [f" at v = {each:.3f}" for each in v])
        if isinstance(exact.survey, RuledStations):
            check_ruled(exact.survey)
    return exact


def _place(design: SectionedBlade, surfaces: StreamSurfaces, mapping: Mapping) -> Place:
    metre, stacking = UNITS[design.length_unit], design.stacking
    if design.leading_edge is not None and design.trailing_edge is not None:
        leading, trailing = (edge.line(metre) for edge in (design.leading_edge, design.trailing_edge))
        return between(surfaces, leading, trailing, counted=isinstance(mapping, Counted))
    if stacking is None:
        raise DesignError("leading_edge, trailing_edge and stacking are missing: nothing says where the sections stand")
    return StackingPlace(surfaces=surfaces, stacking=stacking, metre=metre)
