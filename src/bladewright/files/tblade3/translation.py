"""From a T-Blade3 case to the curvature-meanline blade that has its sections."""

import re
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bladewright.blade.design.families import CurvatureMeanlineBlade
from bladewright.blade.design.flow_path import FlowPath
from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.designs import Point
from bladewright.errors import DesignError, FileError
from bladewright.files.tblade3.case import TBlade3Case
from bladewright.files.tblade3.section_parts import SectionParameters, law_through, section_parameters, section_places
from bladewright.files.tblade3.section_values import SectionValues, metal_angles, section_values
from bladewright.files.tblade3.stacking import chord_stations, stacking_point
from bladewright.files.tblade3.stream_lines import CaseStreamLines, case_stream_lines
from bladewright.nurbs.basis import Reals
from bladewright.section.edge_spline import SplinedOutline
from bladewright.section.laws import Span

FEW_SECTIONS = 4
"""Number of sections up to which an edge that is not shifted keeps the curve that the case gives, since a
curve through so few points says little of its shape between them."""
BEYOND = 1e-9
"""Largest fraction of a stream line by which a section may extend beyond its end: rounding."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CaseSections:
    """The m sections of a case, as T-Blade3 places them."""

    case: TBlade3Case
    flow: CaseStreamLines
    values: SectionValues
    numbers: SectionParameters
    true_stagger: bool = False
    """whether true sweep and lean use the stagger of the section, instead of what T-Blade3 uses"""

    @cached_property
    def places(self) -> Reals:
        """(m,) span fractions of the sections in the design, decreasing where they are `reversed`."""
        places = section_places(self.flow.spans, *self.flow.distances)
        return 1.0 - places if self.reversed else places

    @cached_property
    def reversed(self) -> bool:
        """Whether the last section is the design's hub: it lies to the right of the first, seen along the flow."""
        edge = self.flow.at(self.flow.leading)
        across, along = edge[-1] - edge[0], np.sum(self.flow.at(self.flow.leading, 1), axis=0)
        return bool(along[0] * across[1] - along[1] * across[0] < 0.0)

    @property
    def order(self) -> list[int]:
        """Indices of the sections from hub to shroud of the design."""
        return [int(i) for i in np.argsort(self.places)]

    @cached_property
    def _staggers(self) -> Reals:
        """(m, 2) stagger [rad] of the sections without and with their leading edge spline."""
        one = Span(np.zeros(1))
        parts = [self.numbers.of(i) for i in range(len(self.places))]
        both = [(replace(part, leading_edge_spline=None), part) for part in parts]
        return np.array([[float(np.real(part.stagger(one)[0])) for part in pair] for pair in both])

    @cached_property
    def tips(self) -> Reals:
        """(m, 2) positions of the leading edges, in T-Blade3's chords: (0, 0) unless they are splines."""
        if self.numbers.edges is None:
            return np.zeros((len(self.places), 2))
        outlines = [self.numbers.of(i).outline(Span(np.zeros(1))) for i in range(len(self.places))]
        return np.array([np.real(each.tip)[0] for each in outlines if isinstance(each, SplinedOutline)])

    @property
    def stagger(self) -> Reals:
        """(m,) stagger [rad] of the chord lines from the leading edge's tip to the trailing edge."""
        return self._staggers[:, 1]

    @cached_property
    def own_chords(self) -> Reals:
        """(m,) T-Blade3's chords in the plane (m', theta): without what a spline has moved."""
        if self.values.chord is not None:
            return self.values.chord
        extents = (self.flow.trailing - self.flow.leading) * self.values.chord_multiplier
        return extents / np.cos(self._staggers[:, 0])

    @cached_property
    def chords(self) -> Reals:
        """(m,) lengths of the chord lines in the plane (m', theta)."""
        lines = np.array([1.0, 0.0]) - self.tips
        return self.own_chords * np.sqrt(np.sum(lines**2, axis=-1))

    @property
    def extents(self) -> Reals:
        """(m,) of the chord lines in m'."""
        return self.chords * np.cos(self.stagger)

    @cached_property
    def shifts(self) -> tuple[Reals, Reals]:
        """(m,) sweep in m' and (m,) lean [rad] of the sections.

        True ones are multiplied by the cosine of the stagger; where one of both is true, it takes the other's place
        times the sine. T-Blade3's stagger is the inlet angle's degrees taken for radians, or 0 where the chord is
        that between the edges.
        """
        case, sweep, lean = self.case, self.values.sweep, self.values.lean
        if self.true_stagger:
            stagger = self._staggers[:, 0]
        else:
            stagger = 0.0 * sweep if case.chord == "meridional" else self.values.angle_in
        along, across = np.abs(np.cos(stagger)), np.abs(np.sin(stagger))
        if not case.true_sweep and not case.true_lean:
            return sweep, lean
        swept = sweep * along if case.true_sweep else lean * across
        return swept, lean * along if case.true_lean else swept * across

    @cached_property
    def leading(self) -> Reals:
        """(m,) m' of the sections' leading edges on their stream lines."""
        return self.flow.leading + self.shifts[0]

    @cached_property
    def trailing(self) -> Reals:
        """(m,) m' of their trailing edges."""
        return self.leading + self.extents

    @cached_property
    def theta(self) -> Reals:
        """(m,) of the leading edges [rad]: of what stacking, lean and the turn of the blade make."""
        found = []
        stations = chord_stations(self.case)
        for i, (turn, stacking) in enumerate(zip(self._staggers[:, 0], self.case.stackings, strict=True)):
            along, across = self.tips[i] - stacking_point(self.numbers.of(i), stacking, stations)
            found.append(self.own_chords[i] * (along * np.sin(turn) + across * np.cos(turn)))
        return np.array(found) + self.shifts[1] + self.values.theta_offset


def case_sections(case: TBlade3Case, *, true_stagger: bool = False) -> CaseSections:
    """The sections of a case. Raises FileError where the family has no such, or they leave their stream lines."""
    refused = [text for text in case.unsupported if "inflation" not in text]
    if refused:
        raise FileError(f"'{case.file}': {refused[0]}")
    flow = case_stream_lines(case)
    values = section_values(case, flow.spans)
    sections = CaseSections(
        case=case,
        flow=flow,
        values=values,
        numbers=section_parameters(case, values, metal_angles(case, values, *flow.slopes)),
        true_stagger=true_stagger,
    )
    _check_directions(sections)
    _check_within(sections)
    return sections


def blade_of(sections: CaseSections) -> CurvatureMeanlineBlade:
    """The design with the sections of a case; raises FileError where the family has no such blade."""
    case, flow, places = sections.case, sections.flow, sections.places
    hub, *between, shroud = (flow.meridians[i] for i in sections.order)
    try:
        return CurvatureMeanlineBlade(
            name=name_of(case),
            length_unit=case.unit,
            arrangement="annular",
            blade_count=case.blade_count,
            plane="counted-m'-theta",
            flow_path=FlowPath(
                hub=hub,
                shroud=shroud,
                stream_surfaces=tuple(between),
                stream_spans=tuple(float(v) for v in np.sort(places)[1:-1]),
                matched="edges",
            ),
            leading_edge=_edge(sections, flow.edges[0], flow.leading, sections.leading),
            trailing_edge=_edge(sections, flow.edges[1], flow.trailing, sections.trailing),
            leading_edge_theta=law_through(np.degrees(sections.theta), places),
            section=sections.numbers.along(places),
            description=f"T-Blade3 case {case.name}" if case.name.isprintable() else "T-Blade3 case",
        )
    except DesignError as error:
        raise FileError(f"'{case.file}': the curvature-meanline family has no such blade: {error}") from error


def name_of(case: TBlade3Case) -> str:
    """A file name for the design: the name of the case and its row."""
    word = re.sub(r"[^\w.+-]+", "-", case.name).strip("-.") or "blade"
    return f"{word}-{case.suffix}" if case.suffix and not word.endswith(f"-{case.suffix}") else word


def _edge(sections: CaseSections, given: ThroughPoints, before: Reals, after: Reals) -> ThroughPoints:
    """An edge curve: as given, or through the points at which the ends of the sections lie on their stream lines."""
    case = sections.case
    if len(before) <= FEW_SECTIONS and np.array_equal(before, after):
        return given
    metre = case.unit_length / case.scale
    points = sections.flow.at(after)[sections.order] / metre
    return ThroughPoints(points=tuple(Point(float(x), float(r)) for x, r in points))


def _check_directions(sections: CaseSections) -> None:
    """Raise FileError where angles beta_r would change sign because the stream lines slope to different sides."""
    case = sections.case
    for which, end, phi in zip(("in", "out"), (0, -1), sections.flow.slopes, strict=True):
        turned = np.flatnonzero(np.sign(phi) != np.sign(phi[0]))
        if len(turned) and case.angles.split("-")[end] == "radial":
            raise FileError(
                f"'{case.file}': {which}_beta is beta_r, which T-Blade3 multiplies by sin(atan(dr/dx)) of the "
                f"streamline: that is {np.sin(phi[0]):.4g} at section 1 and {np.sin(phi[turned[0]]):.4g} at section "
                f"{turned[0] + 1}, whose streamlines lean to different sides, so that the angle changes its sign "
                "between them; let all streamlines lean to one side there, or give axial angles"
            )


def _check_within(sections: CaseSections) -> None:
    for which, places in (("leading", sections.leading), ("trailing", sections.trailing)):
        past = np.flatnonzero((places < -BEYOND) | (places > sections.flow.totals * (1.0 + BEYOND)))
        if len(past):
            i = int(past[0])
            raise FileError(
                f"'{sections.case.file}': the {which} edge of section {i + 1} lies at m' = {places[i]:.5g}, outside of "
                f"its streamline, which reaches from 0 to {sections.flow.totals[i]:.5g}: T-Blade3 continues its spline "
                "there; give the streamline more points"
            )
