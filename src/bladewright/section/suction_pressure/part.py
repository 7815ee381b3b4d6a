"""The parameters of a section by its suction and its pressure side (Voss et al. 2025, sections 3 and 3.1)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from bladewright.designs import ChordwiseLaw, Law, Part, parameter
from bladewright.numerics.elementary import Array, radians
from bladewright.section.laws import Span
from bladewright.section.planar import PlanarSection
from bladewright.section.suction_pressure.assembly import assembled
from bladewright.section.suction_pressure.limits import checked
from bladewright.section.suction_pressure.outline import SuctionPressureOutline
from bladewright.section.suction_pressure.refining import freed, refined


@dataclass(frozen=True, kw_only=True)
class SuctionPressure(Part):
    """A section whose suction and pressure side are cubic B-splines between two rounded edges.

    Lengths are fractions of the chord. Each side runs from corner to corner: its first and its last free control point
    lie on the tangents there, which the edges' angles and wedges give, the others at places along the chord line or the
    pseudo skeleton line and heights off it. Reference: Voss et al. 2025, sections 3 and 3.1, Figs. 2 to 5.
    """

    stagger_angle: Law = parameter("deg")
    """angle of the chord line from the axis [deg]"""
    metal_angle_in: Law = parameter("deg")
    """angle of the leading edge's direction from the axis [deg]"""
    metal_angle_out: Law = parameter("deg")
    """angle of the trailing edge's direction from the axis [deg]"""
    leading_edge_radius: Law = parameter("-")
    """semi-axis b of the leading edge's ellipse across its direction, its radius where a = b, of the chord [-]"""
    leading_edge_stretch: Law = parameter("-", default=1.0)
    """ratio a / b of the leading edge's semi-axes, along over across its direction [-]"""
    leading_edge_skew: Law = parameter("-", default=0.0)
    """part by which the semi-axis along is longer on the suction side and shorter on the pressure side [-]"""
    leading_edge_wedge: Law = parameter("deg")
    """angle between the two sides where they leave the leading edge [deg]"""
    trailing_edge_radius: Law = parameter("-")
    """semi-axis b of the trailing edge's ellipse across its direction, its radius where a = b, of the chord [-]"""
    trailing_edge_stretch: Law = parameter("-", default=1.0)
    """ratio a / b of the trailing edge's semi-axes, along over across its direction [-]"""
    trailing_edge_skew: Law = parameter("-", default=0.0)
    """part by which the semi-axis along is longer on the suction side and shorter on the pressure side [-]"""
    trailing_edge_wedge: Law = parameter("deg")
    """angle between the two sides where they reach the trailing edge [deg]"""
    suction_tangent_in: Law = parameter("-")
    """distance of the suction side's first free control point from its corner, along the tangent, of the chord [-]"""
    suction_tangent_out: Law = parameter("-")
    """distance of the suction side's last free control point from its corner, along the tangent, of the chord [-]"""
    suction_heights: ChordwiseLaw = parameter("-")
    """heights of the suction side's free control points between the tangents, one at least, of the chord [-]"""
    suction_places: ChordwiseLaw = parameter("-", default=())
    """their places along the skeleton, 0 to 1; none: spread by the knots [-]"""
    pressure_tangent_in: Law | None = parameter("-", default=None)
    """as suction_tangent_in; none: the pressure side leaves its corner as fast as the suction side does [-]"""
    pressure_tangent_out: Law | None = parameter("-", default=None)
    """as suction_tangent_out; none: the pressure side reaches its corner as fast as the suction side does [-]"""
    pressure_heights: ChordwiseLaw = parameter("-", default=())
    """heights of the pressure side's free control points between the tangents: a pressure side of its own [-]"""
    pressure_thickness: ChordwiseLaw = parameter("-", default=())
    """in place of heights: distances of the pressure side from the suction side, normal to it, of the chord [-]"""
    pressure_places: ChordwiseLaw = parameter("-", default=())
    """places along the skeleton of the heights, or along the suction side of the thicknesses; none: spread [-]"""
    suction_side: Literal["upper", "lower"] = "upper"
    """the side that is the suction side, upper towards larger theta"""
    edges: Literal["C1", "C2"] = "C2"
    """continuity where edges and sides join: of the tangent (C1) or of the curvature as well (C2)"""
    skeleton: Literal["chord", "pseudo"] = "chord"
    """the line of places and heights: the chord line, or one with the edges' angles for strongly turning sections"""
    suction_knots: tuple[float, ...] = ()
    """inner knots of the suction side, as many as suction_heights; none: uniform [-]"""
    pressure_knots: tuple[float, ...] = ()
    """inner knots of the pressure side, as many as its heights or thicknesses; none: uniform [-]"""

    def __post_init__(self) -> None:
        for name, value in checked(self).items():
            object.__setattr__(self, name, value)

    def outline(self, span: Span) -> SuctionPressureOutline:
        """The exact sections (..., m), in chords; raises DesignError where edges or sides do not fit."""
        return assembled(self, span)

    def stagger(self, span: Span) -> Array:
        """Angles (..., m) of the chord line [rad]."""
        return radians(span.values(self.stagger_angle))

    def refined(
        self, knots: int | Sequence[float], *, side: Literal["suction", "pressure", "both"] = "both"
    ) -> "SuctionPressure":
        """The same section with further control points: so many new knots a side, or knots at given places in (0, 1).

        Raises DesignError for laws along the span, and for a pressure side by a thickness: refine the suction side
        alone, or take `independent()` first.
        """
        return self.changed(refined(self, knots, side))

    def independent(self) -> "SuctionPressure":
        """The same section, its pressure side by heights of its own; raises DesignError for laws along the span."""
        return self.changed(freed(self))


@dataclass(frozen=True, kw_only=True)
class SuctionPressureSection(PlanarSection):
    """A section by its suction and its pressure side in the plane (x, y)."""

    section: SuctionPressure
    """the section's parameters"""
