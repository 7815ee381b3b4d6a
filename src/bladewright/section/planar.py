"""2D designs of the families from sections: one section in the plane (x, y), x axial and y tangential."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from bladewright.designs import Design, naming, parameter
from bladewright.errors import DesignError
from bladewright.nurbs.basis import Reals
from bladewright.section import checks
from bladewright.section.crossing import check_outline, closed_outlines, touching
from bladewright.section.family import SectionFamily
from bladewright.section.laws import Span, check_plain, named_laws
from bladewright.section.native import SectionKnots, knots_for, native_section
from bladewright.section.outline import Outline
from bladewright.section.section import Section
from bladewright.section.unified_limits import POSITIVE, check_labels


@dataclass(frozen=True, kw_only=True)
class PlanarSection(Design):
    """Base of the 2D designs, one final class a family: the family's parameters, and where the section lies."""

    dimension: ClassVar[int] = 2

    name: str
    """the part's name, used in files"""
    length_unit: Literal["m", "cm", "mm", "um", "in", "ft"]
    """unit of every length in the design"""
    chord: float = parameter("length", limits=POSITIVE)
    """distance from the leading to the trailing edge [length]"""
    pitch: float | None = parameter("length", limits=POSITIVE, default=None)
    """tangential distance of neighbours; none: a single section [length]"""
    leading_edge_x: float = parameter("length", default=0.0)
    """axial position of the leading edge [length]"""
    leading_edge_y: float = parameter("length", default=0.0)
    """tangential position of the leading edge [length]"""
    section: SectionFamily
    """the family's parameters, each a number"""
    span: float | None = parameter("length", limits=POSITIVE, default=None)
    """height of the prismatic blade that the section becomes as a solid; none: a section only [length]"""
    tolerance: float = 1e-10
    """distance of the native curves from the exact section, of the chord [-]"""
    description: str = ""
    """one line for the header of CAD files"""
    author: str = ""
    """for the header of CAD files"""
    organisation: str = ""
    """for the header of CAD files"""

    def __post_init__(self) -> None:
        check_labels(self)
        checks.parameters(self)
        checks.between("tolerance", self.tolerance, 1e-13, 1e-2, "it must lie above 1e-13 and below 0.01")
        if not isinstance(self.section, SectionFamily):
            raise DesignError(f"section is {self.section!r}: the family's parameters are needed")
        check_plain((f"section.{path}", law) for path, law in named_laws(self.section))

    def exact(self) -> Outline:
        """The exact section in chords, checked as for `build`; raises DesignError where the shape is impossible."""
        span = Span(np.zeros(1))
        with naming("section", self.section):
            outline = self.section.outline(span)
            turn = self.section.stagger(span)[..., 0]
        check_outline(outline, [""])
        if self.pitch is not None:
            rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
            self._check_pitch(closed_outlines(outline) @ np.real(rotation).T, self.pitch)
        return outline

    def build(self, knots: SectionKnots | None = None) -> Section:
        """The section in metres and radians; raises DesignError where the shape is impossible.

        `knots` are those to hold, a section's own `knots`.
        """
        outline = self.exact()
        span, metre = Span(np.zeros(1)), checks.UNITS[self.length_unit]
        turn = self.section.stagger(span)[..., 0]
        return native_section(
            outline,
            knots_for(outline, self.tolerance) if knots is None else knots,
            turn=turn,
            chord=np.asarray(self.chord * metre),
            shift=np.array([self.leading_edge_x * metre, self.leading_edge_y * metre]),
            span=0.0,
            plane="x-y",
            scale=np.ones_like,
            meanline=self.section.meanline(span),
            name=self.name,
            length_unit=self.length_unit,
            reference_chord=np.asarray(self.chord * metre),
            pitch=None if self.pitch is None else np.asarray(self.pitch * metre),
        )

    def _check_pitch(self, outlines: Reals, pitch: float) -> None:
        """Refuse a pitch at which neighbours (m, n, 2) in chords meet."""
        if touching(outlines, float(np.real(pitch)) / float(np.real(self.chord))) is not None:
            raise DesignError(f"pitch is {pitch:g}: neighbouring sections intersect; take a larger pitch")
