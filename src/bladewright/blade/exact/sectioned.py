"""The exact blade of sections: for every v the family's section, on its stream surface, where the design places it."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.exact.developable import developable_sections
from bladewright.blade.exact.exact_blade import MIDDLE, ExactBlade
from bladewright.blade.exact.family_sections import FamilySections, FlowPathSections
from bladewright.blade.exact.meridional_extent import FlowPathExtent, flow_path_extent
from bladewright.blade.exact.meridional_view import MeridionalView, flow_path_view
from bladewright.blade.exact.placement import Placement, reference_points
from bladewright.blade.exact.prescribed_edges import PrescribedEdges
from bladewright.blade.exact.ruled import ruled_sections
from bladewright.blade.exact.stacking_axis import StackingAxis
from bladewright.blade.exact.sweep_lean import shifted_lines, shifts
from bladewright.blade.exact.unified import SURVEY
from bladewright.blade.flow_path.meridional_curve import MeridionalCurve, real_first
from bladewright.blade.flow_path.stream_surface_map import StreamSurfaceMap, plane_of
from bladewright.blade.flow_path.stream_surfaces import StreamSurfaces, stream_surfaces
from bladewright.blade.native.knots import DEGREE
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, radians
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.section.crossing import check_outline
from bladewright.section.laws import Span, joints_of, laws_of
from bladewright.section.native import knots_for, native_section
from bladewright.section.section import Section
from bladewright.section.smoothness import Smoothness, outline_smoothness

if TYPE_CHECKING:
    from bladewright.blade.design.sectioned import SectionedBlade


ENDS = np.array([0.0, 1.0])
"""Span fractions of hub and shroud."""
PLACING = ("flow_path", "leading_edge", "trailing_edge", "stacking", "length_unit", "arrangement", "plane")
"""Fields that stream surfaces and the placement follow from."""
SPANS = 8
"""Knot spans along a side to begin with; refinement adds where the tolerance needs more."""
SECTION_TOLERANCE = 1e-10
"""Distance of a family's native curves from the exact section, of the chord."""


def placed_sections(
    design: "SectionedBlade", placement: Placement, mapping: StreamSurfaceMap, v: Reals
) -> FamilySections:
    """Sections at v (m,) with sweep and lean; raises DesignError where they do not fit in the flow path."""
    span = Span(v)
    lines, outline, stagger, reference = placement.placed(design, mapping, span)
    chord = lines.extents() / np.cos(stagger)
    turned = np.cos(stagger), np.sin(stagger)
    along = chord * (reference[..., 0] * turned[0] - reference[..., 1] * turned[1])
    across = chord * (reference[..., 0] * turned[1] + reference[..., 1] * turned[0])
    meridional, conformal, tangential = shifts(design, span, stagger)
    lines = shifted_lines(placement.surfaces, lines, along, meridional, conformal)
    radius = lines.position(lines.u_at(along[..., None]))[..., 0, 1]
    around = tangential / radius if mapping.revolved else tangential
    start = mapping.start(_tangential(design, span) + around, radius, lines.lengths) - across
    return FamilySections(v=v, lines=lines, outline=outline, stagger=stagger, chord=chord, start=start)


def _tangential(design: "SectionedBlade", span: Span) -> Array:
    """theta [rad], or y [m] in a cascade, (..., m) of the reference points."""
    stacking, annular = design.stacking, design.arrangement == "annular"
    if stacking is None:
        law = design.leading_edge_theta if annular else design.leading_edge_y
    else:
        law = stacking.theta if annular else stacking.y
    values = span.values(0.0 if law is None else law)
    return radians(values) if annular else design.metre * values


@dataclass(frozen=True, kw_only=True)
class ExactSectionedBlade(ExactBlade):
    """The blade that a design of sections defines, in metres and radians."""

    design: "SectionedBlade"
    surfaces: StreamSurfaces
    placement: Placement
    """what puts the sections on their stream lines: edge curves, or reference points"""
    checked: bool = True
    """whether sections that their family forbids are refused"""

    @cached_property
    def survey(self) -> FlowPathSections:
        """Sections from end to end on which the shape is judged."""
        return self.sections(SURVEY)

    def sections(self, v: Reals) -> FlowPathSections:
        """The blade's sections at v (m,), as its skinning makes them."""
        if self.design.skinning == "ruled":
            return ruled_sections(self.rails, self.design_sections(v))
        if self.design.skinning == "developable":
            return developable_sections(self.surfaces, self.design_sections(ENDS[:1]), self.references, v)
        return self.design_sections(v)

    def design_sections(self, v: Reals) -> FamilySections:
        """The design's sections at v (m,); raises DesignError where there are none, or they leave the flow path."""
        found = placed_sections(self.design, self.placement, self.mapping, v)
        if self.checked:
            found.outline.check_limits(_where(v))
        return found

    @cached_property
    def rails(self) -> FamilySections:
        """The design's sections at hub and shroud."""
        return self.design_sections(ENDS)

    @property
    def references(self) -> Array:
        """The reference points (..., 2, 3) of hub and shroud in space [m]."""
        points = reference_points(self.design.stacking, self.rails.outline, Span(ENDS))
        return self.rails.in_space(self.rails.placed(points[..., None, :]))[..., 0, :]

    @property
    def given_spans(self) -> Reals:
        if self.design.skinning == "ruled":
            return ENDS
        return np.unique([*self.design.flow_path.spans, *self.design.section_spans])

    @property
    def section_spans(self) -> tuple[float, ...]:
        if self.design.skinning == "developable":
            return (0.0,)
        spans = np.union1d(self.given_spans, [] if self.design.skinning == "ruled" else [MIDDLE])
        return tuple(float(v) for v in spans)

    def moved_to(self, design: "SectionedBlade") -> "ExactSectionedBlade":
        if all(getattr(design, name) is getattr(self.design, name) for name in PLACING):
            # only sections move: where stream lines run and meet the edges is known
            return replace(self, design=design)
        return exact_sectioned_blade(design, checked=False)

    def breaks_along_u(self) -> Reals:
        joints = self.rails.outline.joints
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
            for place, smooth in () if law is None else joints_of(law):
                needed(place, smooth)
        for place in self.surfaces.span_joints():
            needed(float(place), 2)
        for place, smooth in self.placement.span_joints():
            needed(place, smooth)
        return np.array([knot for knot in sorted(times) for _ in range(times[knot])])

    def check(self) -> None:
        self.check_neighbours()

    def meridional_channel(self, noses: tuple[float, float], ends: tuple[float, float]) -> StreamSurfaces:
        del noses, ends
        return self.surfaces

    @cached_property
    def meridional_extent(self) -> FlowPathExtent:
        return flow_path_extent(self.surfaces, self.survey)

    @cached_property
    def meridional_view(self) -> MeridionalView:
        """Hub, shroud, edge curves, given stream surfaces and stream lines in the meridional plane."""
        return flow_path_view(self)

    def without_clearance(self) -> "ExactSectionedBlade":
        return self

    def wall(self, name: str) -> MeridionalCurve:
        return self.surfaces.wall(name)

    def end_wall(self, row: int) -> tuple[Curve, Reals]:
        curve = self.wall(("hub", "shroud")[row]).curve()
        return curve, curve.knots[(curve.knots > curve.knots[0]) & (curve.knots < curve.knots[-1])]

    def wall_parameters(self, u: Reals) -> Reals:
        t = real_first(self.survey.lines.rows([0, -1]).t(u), 2)
        return np.stack([self.surfaces.wall_parameter(name, t[i]) for i, name in enumerate(("hub", "shroud"))])

    def wall_points(self, name: str, u: Reals) -> Reals:
        v = np.array([("hub", "shroud").index(name)], dtype=np.float64)
        lines = self.survey.lines.rows([0 if name == "hub" else -1])
        start, end = (float(real_first(t, 1)[0]) for t in (lines.leading, lines.trailing))
        t = np.unique(np.clip(start + (end - start) * u, self.surfaces.low, self.surfaces.high))
        return np.asarray(np.real(self.surfaces.real().position(v, t[None])[0]))

    def _section(self, v: float) -> Section:
        scale = self.sections(np.array([v])).scale
        sections = self._own_section(v)
        turn, chord, start = (np.ravel(each)[0] for each in (sections.stagger, sections.chord, sections.start))
        return native_section(
            sections.outline,
            knots_for(sections.outline, SECTION_TOLERANCE),
            turn=turn,
            chord=chord,
            shift=np.array([0.0, start]),
            span=v,
            plane=self.mapping.plane,
            scale=scale,
            meanline=self.design.section.meanline(Span(np.array([v]))),
        )

    def smoothness(self, v: float) -> Smoothness:
        return outline_smoothness(self._own_section(v).outline)

    def _own_section(self, v: float) -> FamilySections:
        """The design's section at v; DesignError where the blade has none there."""
        if self.design.skinning != "sections" and v not in self.section_spans:
            where = "hub and shroud" if self.design.skinning == "ruled" else "the hub"
            raise DesignError(
                f"a section was asked at v = {v:g} of a blade whose skinning is '{self.design.skinning}': it has the "
                f"design's sections at {where} alone; ask there, or take skinning = 'sections'"
            )
        return self.design_sections(np.array([v]))


def exact_sectioned_blade(design: "SectionedBlade", *, checked: bool = True) -> ExactSectionedBlade:
    """The exact blade of a design of sections.

    Raises DesignError where its flow path folds, or edges and flow path do not meet, and where it is to be `checked`,
    for sections that cross themselves.
    """
    metre, revolved = design.metre, design.arrangement == "annular"
    mapping: StreamSurfaceMap = plane_of(design.plane, design.arrangement)
    edges = None
    if design.leading_edge is not None and design.trailing_edge is not None:
        edges = design.leading_edge, design.trailing_edge
    try:
        surfaces = stream_surfaces(design.flow_path, metre, edges, revolved=revolved)
    except DesignError as error:
        raise DesignError(f"flow_path: {error}") from error
    exact = ExactSectionedBlade(
        design=design, mapping=mapping, surfaces=surfaces, placement=_placement(design, surfaces), checked=checked
    )
    if checked:
        v = {"sections": SURVEY, "ruled": ENDS, "developable": ENDS[:1]}[design.skinning]
        check_outline(exact.design_sections(v).outline, _where(v))
        exact.survey.check()
    return exact


def _where(v: Reals) -> list[str]:
    return [f" at v = {each:.3f}" for each in v]


def _placement(design: "SectionedBlade", surfaces: StreamSurfaces) -> Placement:
    if design.leading_edge is not None and design.trailing_edge is not None:
        leading, trailing = (edge.line(design.metre) for edge in (design.leading_edge, design.trailing_edge))
        return PrescribedEdges(surfaces=surfaces, leading_edge=leading, trailing_edge=trailing)
    if design.stacking is None:
        raise DesignError("leading_edge, trailing_edge and stacking are missing: nothing says where the sections stand")
    return StackingAxis(surfaces=surfaces, stacking=design.stacking, metre=design.metre)
