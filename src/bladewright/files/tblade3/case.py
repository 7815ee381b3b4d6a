"""A T-Blade3 case: what its input files state.

Lengths are without dimension, in units of the scale (`TBlade3Case.unit_length`); angles are in degrees.
"""

from dataclasses import dataclass
from typing import Literal

Row = tuple[float, ...]
Table = tuple[Row, ...]
Point = tuple[float, float]
Angles = Literal["axial", "radial", "axial-radial", "radial-axial", "wing"]
Thickness = Literal["wennerstrom", "quartic", "quartic-sharp", "naca"]


@dataclass(frozen=True, kw_only=True)
class SpanLaw:
    """Control points of a quantity's spline along the span."""

    span: Row
    """increasing from 0 to 1"""
    values: Row

    @property
    def has_effect(self) -> bool:
        """Whether any value differs from 0."""
        return any(self.values)


@dataclass(frozen=True, kw_only=True)
class SectionRow:
    """The rows of a section in the two tables of sections."""

    label: int
    in_beta: float
    """inlet angle [deg]"""
    out_beta: float
    """exit angle [deg]"""
    mach: float
    """relative inlet Mach number"""
    chord: float
    thickness: float
    """largest thickness, as a fraction of the chord"""
    incidence: float
    """[deg]"""
    deviation: float
    """[deg]"""
    secondary_flow_angle: float
    """[deg]"""
    type: str
    """`sect1` for a meanline with a thickness, or another type of section"""
    stack_u: float
    """stacking point along the chord [% of the chord]; 200 for the centroid"""
    stack_v: float
    """stacking point from the meanline towards a side [% of the half thickness]"""
    thickest: float
    """position of the largest thickness (umxthk), as a fraction of the chord"""
    leading_thickness: float
    """thickness at the leading edge (lethk), as a fraction of the chord"""
    trailing_thickness: float
    """thickness at the trailing edge (tethk), as a fraction of the chord"""


@dataclass(frozen=True, kw_only=True)
class CaseStacking:
    """The point of a section that lies on the stacking axis."""

    centroid: bool
    """whether it is the centroid of the section, whatever the other fields are"""
    along: float
    """fraction of the chord, from the leading edge (0) to the trailing edge (1)"""
    above: float
    """fraction of the way from the meanline to the upper (1) or lower (-1) side; at 0 it lies on the chord line"""


@dataclass(frozen=True, kw_only=True)
class Meanlines:
    """Control points of the meanline's second derivative, as splines along the span or section by section."""

    span: Row | None
    """span of each row (n,); None where there is one row for each section"""
    u: Table
    """chord fractions (n, k) from 0 to 1; k may differ between sections"""
    curvature: Table
    """values (n, k), of which only the ratios matter"""


@dataclass(frozen=True, kw_only=True)
class Multipliers:
    """Control points m of the thickness multiplier 1 + m, as splines along the span or section by section."""

    span: Row | None
    u: Table
    values: Table


@dataclass(frozen=True, kw_only=True)
class NacaThickness:
    """Control points along the span of the modified NACA four-digit thickness."""

    span: Row
    leading_index: Row
    """index I of the leading edge's radius"""
    thickest: Row
    """u_max, position of the largest thickness, as a fraction of the chord"""
    thickness: Row
    """t_max, largest thickness, as a fraction of the chord"""
    trailing_thickness: Row
    """t_TE, thickness at the trailing edge, as a fraction of the chord"""
    trailing_slope: Row | None
    """slope of the half thickness at the trailing edge, or its factor K; None where it follows from u_max"""
    slope_normalised: bool
    """whether the slope is given as the factor K: slope = -t_max K"""
    spline_switch: int
    """read but not used by T-Blade3, whose splines are always B-splines"""


@dataclass(frozen=True, kw_only=True)
class LeadingEdges:
    """Parameters of leading edges that are splines, as splines along the span or section by section."""

    degree: int
    segments: int
    span: Row | None
    values: Table
    """rows in the order of `LEADING_EDGE`"""


LEADING_EDGE = (
    *("leading_thickness", "trailing_thickness", "droop", "elongation"),
    *("x_top", "x_bottom", "y_top", "y_bottom", "vertex_angle", "vertex_distance"),
    *("sting_length", "sting_height_top", "sting_height_bottom"),
)
"""the 13 numbers of a leading edge; the vertex angle in degrees, the rest without dimension"""


@dataclass(frozen=True, kw_only=True)
class TBlade3Case:
    """Everything that T-Blade3's files state of a blade."""

    file: str
    companion: str | None
    """the file with control points of meanline and thickness, where the case needs one"""
    title: str
    name: str
    row: int
    suffix: str
    """part of the file's name between its last two dots"""
    blade_count: int
    unit: Literal["mm", "cm", "m"]
    scale: float
    """[unit] length that 1 in the file stands for"""
    theta_offset: float
    """rotation of the whole blade about the axis [deg]"""
    angles: Angles
    """plane in which in_beta and out_beta are measured"""
    angle_spline: Literal["", "inletspline", "outletspline", "inoutspline", "inci_dev_spline"]
    """what the tables in_beta* and out_beta* give"""
    curvature_camber: bool
    """whether the meanline is given by its curvature, instead of straight ends with a cubic between them"""
    spanwise: bool
    """whether control points are splines along the span, instead of section by section"""
    thickness: Thickness
    thickness_multiplier: bool
    leading_edge: Literal["elliptic", "spline"]
    chord: Literal["meridional", "given", "multiplied"]
    true_sweep: bool
    """whether sweep runs along the chord"""
    true_lean: bool
    """whether lean runs across the chord"""
    clustering: Literal["uniform", "sine", "exponential", "hyperbolic", "elliptic"]
    clustering_parameter: float | None
    sections: tuple[SectionRow, ...]
    """hub to tip, one on each streamline"""
    leading_curve: tuple[Point, ...]
    """leading edge in (x, r)"""
    trailing_curve: tuple[Point, ...]
    """trailing edge in (x, r)"""
    radial_stacking: bool
    """whether each section has a stacking point of its own"""
    stacking_code: int
    blending: Table
    """rows of span, bf1, bf2"""
    sweep: SpanLaw
    """shift along the streamline, in m'"""
    lean: SpanLaw
    """shift in theta [rad]"""
    in_beta: SpanLaw
    """in_beta*: inlet angle, incidence or stagger [deg]"""
    out_beta: SpanLaw
    """out_beta*: exit angle or deviation [deg]"""
    chord_multiplier: SpanLaw
    """m of a chord multiplied by 1 + m"""
    thickness_multipliers: SpanLaw | None
    """tm/c: m of a thickness multiplied by 1 + m"""
    thickest: SpanLaw | None
    """u_max: place of the largest thickness, where not 0"""
    hub_offset: float
    """of the first streamline along its normal"""
    hub_inflation: float | None
    tip_offset: float
    """of the last streamline along its normal"""
    tip_inflation: float | None
    streamlines: tuple[tuple[Point, ...], ...]
    """points (x, r) of each, upstream to downstream, hub to tip"""
    meanlines: Meanlines | None
    naca: NacaThickness | None
    multipliers: Multipliers | None
    leading_edges: LeadingEdges | None
    unused: tuple[str, ...] = ()
    """what in the files has no effect on the blade, each a sentence"""
    unsupported: tuple[str, ...] = ()
    """what T-Blade3 would make of the files that is no blade of such sections, each a sentence"""
    notes: tuple[str, ...] = ()
    """where T-Blade3 itself fails, or does something other than its files say, each a sentence"""

    @property
    def unit_length(self) -> float:
        """Length [m] that 1 in the file stands for."""
        return self.scale * {"mm": 1e-3, "cm": 1e-2, "m": 1.0}[self.unit]

    @property
    def staggers_given(self) -> bool:
        """Whether the table in_beta* gives staggers, which an inlet angle of 999 switches on."""
        return self.sections[0].in_beta == STAGGER_GIVEN

    @property
    def stackings(self) -> tuple[CaseStacking, ...]:
        """The stacking point of each section."""
        if not self.radial_stacking:
            return (stacking_of(self.stacking_code),) * len(self.sections)
        return tuple(
            CaseStacking(centroid=row.stack_u == CENTROID, along=row.stack_u / 100.0, above=row.stack_v / 100.0)
            for row in self.sections
        )


STAGGER_GIVEN = 999.0
"""Inlet angle of the first section by which a file states that it gives staggers (T-Blade3's own code)."""
CENTROID = 200
"""Stacking point along the chord that stands for the centroid (T-Blade3's own code)."""


def stacking_of(code: int) -> CaseStacking:
    """The stacking point of a code uuuvvv, whose sign is that of vvv; uuu = 200 stands for the centroid."""
    along, above = divmod(abs(code), 1000)
    return CaseStacking(centroid=along == CENTROID, along=along / 100.0, above=(above if code >= 0 else -above) / 100.0)
