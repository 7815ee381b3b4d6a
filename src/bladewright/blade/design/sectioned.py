"""Blades from sections as designs: a family's section between edge curves in a flow path."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from bladewright.blade.design.flow_path import FlowPath, increasing_spans
from bladewright.blade.design.meridional_curve import Meridian, meridian_at
from bladewright.blade.design.row_design import FIELDS_OF, RowDesign
from bladewright.blade.design.spanwise_steps import SpanwiseStep, steps_of_laws
from bladewright.blade.design.stacking import Stacking
from bladewright.designs import Law, parameter
from bladewright.errors import DesignError
from bladewright.section import checks
from bladewright.section.family import SectionFamily
from bladewright.section.laws import law_points, named_laws, points_word

if TYPE_CHECKING:
    from bladewright.blade.exact.exact_blade import ExactBlade
    from bladewright.blade.native.knots import Knots


@dataclass(frozen=True, kw_only=True)
class SectionedBlade(RowDesign):
    """Base of the blades from sections; each has a final subclass that says of which family.

    At every v the family's section lies on the stream surface of that span fraction, its chord line at the section's
    stagger. Either the leading- and the trailing-edge curve say where it begins and ends, or `stacking` says how
    long it is and where its reference point lies. Every number of the section is a law: a constant, or the control
    points of a clamped uniform B-spline of degree min(n - 1, 3) along the span.

    `sweep` and `lean` then shift each section as it is, in its plane: its reference point, the leading edge where there
    is no `stacking`, moves along its stream line and around the axis. A clearance cuts the blade: its sections keep
    their span, which counts from hub to shroud, and what is left of it is as it was.
    """

    plane: Literal["m'-theta", "m-r*theta", "x-y", "counted-m'-theta"] = "m'-theta"
    """the plane of each stream surface in which sections are given; in a cascade the first two are (m, y). The last
    takes m' as the points of hub, shroud and stream surfaces count it, whose spacing is "conformal", as in T-Blade3"""
    flow_path: FlowPath
    """hub, shroud and stream surfaces"""
    leading_edge: Meridian | None = None
    """the leading edge in (x, r), from hub to shroud or past them"""
    trailing_edge: Meridian | None = None
    """the trailing edge in (x, r), from hub to shroud or past them"""
    stacking: Stacking | None = None
    """the sections' reference point and its position; without edge curves the chord as well"""
    sweep: Law | None = parameter("length", default=None)
    """shift of each section after stacking, downstream, in one of `shift_directions` [length]"""
    lean: Law | None = parameter("length", default=None)
    """shift of each section after stacking, towards larger theta, or y; an arc at the reference point's radius after
    the shift; a bow is a lean of three control points or more [length]"""
    conformal_sweep: Law | None = parameter("-", default=None)
    """further shift downstream as an increase of the plane's m', annular [-]"""
    shift_directions: Literal["meridional-tangential", "chordwise-normal"] = "meridional-tangential"
    """directions of sweep and lean: along the stream line and around the axis; or true sweep and true lean, along the
    chord line and normal to it"""
    skinning: Literal["sections", "ruled", "developable"] = "sections"
    """what lies between hub and shroud: the section at every v; straight lines between the points of equal s of the
    sections at hub and shroud; or the hub's section moved along parallel straight lines, as a flank cutter makes it"""
    section_spans: tuple[float, ...] = ()
    """further span fractions, increasing inside 0 and 1, at which the built surface's curve of constant v is the
    section to 1e-9 of the chord, as at hub, shroud and the flow path's stream surfaces it is [-]"""
    section: SectionFamily
    """the family's parameters, each a law along the span"""

    def spanwise_steps(self) -> Iterator[SpanwiseStep]:
        """None where sections are ruled, cut, or placed without edge curves: then other sections matter too."""
        if self.skinning != "sections" or self.leading_edge is None or self.ends != ("hub", "shroud"):
            return
        position = FIELDS_OF[self.arrangement][1]
        yield from steps_of_laws([(position, getattr(self, position))])
        yield from steps_of_laws((f"section.{path}", law) for path, law in named_laws(self.section))

    def __post_init__(self) -> None:
        super().__post_init__()
        own = ["counted-m'-theta"] if self.arrangement == "annular" else ["x-y"]
        checks.choice("plane", self.plane, ["m'-theta", "m-r*theta", *own])
        if not isinstance(self.flow_path, FlowPath):
            raise DesignError(f"flow_path is {self.flow_path!r}: a FlowPath with hub and shroud is needed")
        self._check_placing()
        if not isinstance(self.section, SectionFamily):
            raise DesignError(f"section is {self.section!r}: the family's parameters are needed")
        self._check_skinning()
        object.__setattr__(self, "section_spans", increasing_spans("section_spans", self.section_spans))

    def _check_skinning(self) -> None:
        """Refuse laws that have no effect on ruled or developable sides."""
        checks.choice("skinning", self.skinning, ["sections", "ruled", "developable"])
        if self.skinning == "sections":
            return
        of_sections = 2 if self.skinning == "ruled" else 1
        what = "at hub and shroud" if self.skinning == "ruled" else "at the hub"
        of_stacking = {"stacking.chord": "chord", "stacking.chord_fraction": "chord_fraction"}
        places = ["sweep", "lean", "conformal_sweep", "leading_edge_theta", "leading_edge_y"]
        laws = [(f"section.{path}", law, of_sections) for path, law in named_laws(self.section)]
        laws += [(name, getattr(self, name), 2) for name in places if getattr(self, name) is not None]
        if self.stacking is not None:
            found = [(path, getattr(self.stacking, name), of_sections) for path, name in of_stacking.items()]
            found += [(f"stacking.{name}", getattr(self.stacking, name), 2) for name in ("theta", "y")]
            laws += [each for each in found if each[1] is not None]
        for path, law, most in laws:
            count = len(law_points(law))
            if count > most:
                kept = what if most == of_sections else "at hub and shroud"
                raise DesignError(
                    f"{path} has {count} {points_word(law)}, but skinning is '{self.skinning}', for which it counts "
                    f"{kept} alone: give {most if most > 1 else 'one number'}"
                    f"{f' {points_word(law)} at most' if most > 1 else ''}, or take skinning = 'sections'"
                )

    def _check_placing(self) -> None:
        """Check what positions the sections: edge curves, stacking, and shifts."""
        edges = [name for name in ("leading_edge", "trailing_edge") if getattr(self, name) is not None]
        for name in edges:
            meridian_at(name, getattr(self, name))
        if len(edges) == 1:
            other = "trailing_edge" if edges[0] == "leading_edge" else "leading_edge"
            raise DesignError(f"{other} is missing beside {edges[0]}: edge curves are given both, or none and stacking")
        if self.stacking is None and not edges:
            raise DesignError(
                "neither edge curves nor stacking are given: give leading_edge and trailing_edge, curves in (x, r), or "
                "stacking with chord and a place of the reference points"
            )
        if self.stacking is not None:
            if not isinstance(self.stacking, Stacking):
                raise DesignError(f"stacking is {self.stacking!r}: a Stacking with reference and place is needed")
            self.stacking.check_beside(edges=bool(edges))
            if self.flow_path.matched == "edges" and not edges:
                raise DesignError(
                    "flow_path.matched is 'edges', but stacking stands in place of edge curves: take matched = 'ends'"
                )
        checks.choice("shift_directions", self.shift_directions, ["meridional-tangential", "chordwise-normal"])
        for name in ("sweep", "lean", "conformal_sweep"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, checks.law(name, getattr(self, name)))
        if self.conformal_sweep is not None and (self.arrangement == "linear" or not self.plane.endswith("m'-theta")):
            raise DesignError(
                "conformal_sweep is given, but sections are laid out by lengths: it counts in m', of the planes "
                "(m', theta) of an annular row; give sweep"
            )

    def _check_position(self, place: str, other: str) -> None:
        """Refuse two tangential positions: a stacking places the reference point, in place of the leading edge."""
        if self.stacking is None:
            super()._check_position(place, other)
            return
        of = {"leading_edge_theta": "theta", "leading_edge_y": "y"}
        if getattr(self, place) is not None:
            raise DesignError(
                f"{place} is given together with stacking, whose {of[place]} places the reference point: leave {place} "
                f"out and give stacking.{of[place]}"
            )
        if getattr(self.stacking, of[other], None) is not None:
            raise DesignError(
                f"stacking.{of[other]} is given, but arrangement is '{self.arrangement}': give stacking.{of[place]}"
            )

    @property
    def law_ends(self) -> tuple[str, str]:
        """Sections keep their span in the flow path, also where a clearance cuts the blade."""
        return "hub", "shroud"

    def exact_blade(self, knots: Knots | None = None) -> ExactBlade:
        from bladewright.blade.exact.cut_sectioned import exact_blade_of_sections

        return exact_blade_of_sections(self, knots)

    def needs_own_search(self, paths: Iterable[str]) -> bool:
        """Where stream lines meet the edge curves is found for one flow path at a time.

        Without edge curves, and on developable blades, the edges follow from the sections; so does where a clearance
        cuts the blade.
        """
        if self.ends != ("hub", "shroud") or self.leading_edge is None or self.skinning == "developable":
            return any(True for _ in paths)
        return not all(path.startswith(("section.", "leading_edge_theta", "leading_edge_y", "pitch")) for path in paths)
