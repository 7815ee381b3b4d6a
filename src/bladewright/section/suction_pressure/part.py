"""Sections by their suction and their pressure side (Voss et al. 2025, sections 3 and 3.1): parameters and assembly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from bladewright.designs import ChordwiseLaw, Law, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, length, radians, turned_left
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.refine import inserted
from bladewright.section.family import SectionFamily
from bladewright.section.laws import Span, is_list, law_points, named_laws
from bladewright.section.planar import PlanarSection
from bladewright.section.suction_pressure.edges import Corner, Corners, characteristic_points
from bladewright.section.suction_pressure.limits import (
    ANGLE,
    PLACE,
    RADIUS,
    SKEW,
    STRETCH,
    TANGENT,
    THICKNESS,
    WEDGE,
    check,
    check_chord_left,
    check_opening,
)
from bladewright.section.suction_pressure.outline import SHARE, SuctionPressureOutline
from bladewright.section.suction_pressure.side import (
    DEGREE,
    Side,
    chord_line,
    continuing_edges,
    control_points,
    default_places,
    interpolated_free,
    places_off_line,
    points_off_line,
    pseudo_line,
    side_knots,
    spline_points,
)


@dataclass(frozen=True, kw_only=True)
class SuctionPressure(SectionFamily):
    """A section whose suction and pressure side are cubic B-splines between two rounded edges.

    Lengths are fractions of the chord. Each side runs from the corner where it leaves the leading edge to the corner
    where it meets the trailing edge. Its second and its last but one control point lie on the tangents there, which
    follow from the edges' angles and wedges. The others stand at places along a skeleton line, the chord line or a
    pseudo skeleton line, and at heights off it. Reference: Voss et al. 2025, sections 3 and 3.1, Figs. 2 to 5.
    """

    stagger_angle: Law = parameter("deg", limits=ANGLE)
    """angle of the chord line from the axis [deg]"""
    metal_angle_in: Law = parameter("deg", limits=ANGLE)
    """angle of the leading edge's direction from the axis [deg]"""
    metal_angle_out: Law = parameter("deg", limits=ANGLE)
    """angle of the trailing edge's direction from the axis [deg]"""
    leading_edge_radius: Law = parameter("-", limits=RADIUS)
    """semi-axis b of the leading edge's ellipse across its direction, its radius where a = b, of the chord [-]"""
    leading_edge_stretch: Law = parameter("-", limits=STRETCH, default=1.0)
    """ratio a / b of the leading edge's semi-axes, along over across its direction [-]"""
    leading_edge_skew: Law = parameter("-", limits=SKEW, default=0.0)
    """part by which the semi-axis along is longer on the suction side and shorter on the pressure side [-]"""
    leading_edge_wedge: Law = parameter("deg", limits=WEDGE)
    """angle between the two sides where they leave the leading edge [deg]"""
    trailing_edge_radius: Law = parameter("-", limits=RADIUS)
    """semi-axis b of the trailing edge's ellipse across its direction, its radius where a = b, of the chord [-]"""
    trailing_edge_stretch: Law = parameter("-", limits=STRETCH, default=1.0)
    """ratio a / b of the trailing edge's semi-axes, along over across its direction [-]"""
    trailing_edge_skew: Law = parameter("-", limits=SKEW, default=0.0)
    """part by which the semi-axis along is longer on the suction side and shorter on the pressure side [-]"""
    trailing_edge_wedge: Law = parameter("deg", limits=WEDGE)
    """angle between the two sides where they reach the trailing edge [deg]"""
    suction_tangent_in: Law = parameter("-", limits=TANGENT)
    """distance of the suction side's first free control point from its corner, along the tangent, of the chord [-]"""
    suction_tangent_out: Law = parameter("-", limits=TANGENT)
    """distance of the suction side's last free control point from its corner, along the tangent, of the chord [-]"""
    suction_heights: ChordwiseLaw = parameter("-")
    """heights of the suction side's free control points between the tangents, one at least, of the chord [-]"""
    suction_places: ChordwiseLaw = parameter("-", limits=PLACE, default=())
    """their places along the skeleton, 0 to 1; none: at the Greville abscissae of the knots [-]"""
    pressure_tangent_in: Law | None = parameter("-", limits=TANGENT, default=None)
    """as suction_tangent_in; none: such that both sides have the same speed by their parameters there [-]"""
    pressure_tangent_out: Law | None = parameter("-", limits=TANGENT, default=None)
    """as suction_tangent_out; none: such that both sides have the same speed by their parameters there [-]"""
    pressure_heights: ChordwiseLaw = parameter("-", default=())
    """heights of the pressure side's free control points between the tangents, of the chord [-]"""
    pressure_thickness: ChordwiseLaw = parameter("-", limits=THICKNESS, default=())
    """in place of heights: distances of the pressure side from the suction side, normal to it, of the chord [-]"""
    pressure_places: ChordwiseLaw = parameter("-", limits=PLACE, default=())
    """places along the skeleton of the heights, or along the suction side of the thicknesses; none: as above [-]"""
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
        check(self)

    def control_places(self, row: str) -> Sequence[float] | None:
        """Heights and thicknesses stand at places along the skeleton, or along the suction side."""
        side, _, quantity = row.partition("_")
        if quantity not in ("heights", "thickness"):
            return None
        count, middle = len(getattr(self, row)), Span(np.array([0.5]))
        knots = side_knots(count, getattr(self, f"{side}_knots"))
        return np.real(_numbers(middle, getattr(self, f"{side}_places"), getattr(self, row), knots)[0])[0].tolist()

    def outline(self, span: Span) -> SuctionPressureOutline:
        """The exact sections (..., m), in chords; raises DesignError where edges or sides do not fit."""
        return assembled(self, span)

    def stagger(self, span: Span) -> Array:
        """Angles (..., m) of the chord line [rad]."""
        return radians(span.values(self.stagger_angle))

    def refined(
        self, knots: int | Sequence[float], *, side: Literal["suction", "pressure", "both"] = "both"
    ) -> SuctionPressure:
        """The same section with more control points: so many new knots on each side, or knots at places in (0, 1).

        Raises DesignError for laws along the span, and for a pressure side that is given by a thickness: refine the
        suction side alone, or take `independent()` first.
        """
        return self.changed(refined(self, knots, side))

    def independent(self) -> SuctionPressure:
        """The same section with its pressure side given by heights; raises DesignError for laws along the span."""
        return self.changed(_independent_fields(self))


@dataclass(frozen=True, kw_only=True)
class SuctionPressureSection(PlanarSection):
    """A section by its suction and its pressure side in the plane (x, y)."""

    section: SuctionPressure
    """the section's parameters"""


def assembled(part: SuctionPressure, span: Span) -> SuctionPressureOutline:
    """The outline of sections (..., m): characteristic points, suction side, pressure side, edges.

    Raises DesignError where edges do not fit.
    """
    leading, trailing = edge_points(part, span)
    check_chord_left(leading, trailing, span)
    suction, pressure = sides(part, span, leading, trailing)
    upper, lower = (suction, pressure) if part.suction_side == "upper" else (pressure, suction)
    return SuctionPressureOutline(
        corners=(leading, trailing),
        upper=upper,
        lower=lower,
        continuity=part.edges,
        suction_side=part.suction_side,
        by_thickness=bool(part.pressure_thickness),
    )


def camber_angles(part: SuctionPressure, span: Span) -> tuple[Array, Array]:
    """Angles (..., m) of both edges' directions from the chord line [rad]."""
    turn = span.values(part.stagger_angle)
    return radians(span.values(part.metal_angle_in) - turn), radians(span.values(part.metal_angle_out) - turn)


def edge_points(part: SuctionPressure, span: Span) -> tuple[Corners, Corners]:
    """The corners of the leading and the trailing edge."""
    found = []
    suction = 1.0 if part.suction_side == "upper" else -1.0
    for edge, nose, inward, angle in zip(
        ("leading_edge", "trailing_edge"), ((0.0, 0.0), (1.0, 0.0)), (1.0, -1.0), camber_angles(part, span), strict=True
    ):
        radius, stretch, skew, wedge = (
            span.values(getattr(part, f"{edge}_{each}")) for each in ("radius", "stretch", "skew", "wedge")
        )
        check_opening(edge, part.edges, stretch, skew, wedge, span)
        found.append(
            characteristic_points(
                np.array(nose),
                angle,
                inward=inward,
                radius=radius,
                stretch=stretch,
                skew=suction * skew,
                wedge=radians(wedge),
                continuity=part.edges,
            )
        )
    return found[0], found[1]


def skeleton_of(part: SuctionPressure, span: Span) -> Array:
    """The skeleton lines of places and heights, as coefficients (..., m, 4, 2) of the powers of a fraction."""
    return pseudo_line(*camber_angles(part, span)) if part.skeleton == "pseudo" else chord_line((len(span.v),))


def sides(part: SuctionPressure, span: Span, leading: Corners, trailing: Corners) -> tuple[Side, Side]:
    """The suction and the pressure side."""
    skeleton = skeleton_of(part, span)
    suction_name, pressure_name = ("upper", "lower") if part.suction_side == "upper" else ("lower", "upper")
    ends: tuple[Corner, Corner] = leading[suction_name], trailing[suction_name]
    other: tuple[Corner, Corner] = leading[pressure_name], trailing[pressure_name]
    knots = side_knots(len(part.suction_heights), part.suction_knots)
    free = points_off_line(skeleton, *_numbers(span, part.suction_places, part.suction_heights, knots))
    tangents = span.values(part.suction_tangent_in), span.values(part.suction_tangent_out)
    controls = control_points(*ends, *tangents, free)
    suction = continuing_edges(controls, knots, *ends, SHARE)

    offsets = part.pressure_thickness or part.pressure_heights
    knots = side_knots(len(offsets), part.pressure_knots)
    places, numbers = _numbers(span, part.pressure_places, offsets, knots)
    given = part.pressure_tangent_in, part.pressure_tangent_out
    speeds = [length(each[..., 1, :]) / width for each, width in zip(suction.taylor, suction.widths, strict=True)]
    widths = knots[DEGREE + 1], 1.0 - knots[-DEGREE - 2]
    tangents_of = [
        speed * (width / DEGREE) if law is None else span.values(law)
        for law, speed, width in zip(given, speeds, widths, strict=True)
    ]
    tangents = tangents_of[0], tangents_of[1]
    if part.pressure_thickness:
        inside = -1.0 if suction_name == "upper" else 1.0
        through = _thickened(suction, places, inside * numbers)
        free = interpolated_free(*other, tangents, through, knots)
    else:
        free = points_off_line(skeleton, places, numbers)
    return suction, continuing_edges(control_points(*other, *tangents, free), knots, *other, SHARE)


def _numbers(span: Span, places: ChordwiseLaw, offsets: ChordwiseLaw, knots: Reals) -> tuple[Array, Array]:
    """Places and offsets (..., m, k)."""
    values = span.control_values(offsets)
    at = span.control_values(places) if places else np.broadcast_to(default_places(knots), (len(span.v), len(offsets)))
    return at, values


def _thickened(side: Side, places: Array, offsets: Array) -> Array:
    """Points (..., m, k, 2) at offsets from the side to its left, at its own parameters (..., m, k)."""
    tangent = spline_points(side.controls, side.knots, places, 1)
    return spline_points(side.controls, side.knots, places) + offsets[..., None] * turned_left(
        tangent / length(tangent)[..., None]
    )


def refined(part: SuctionPressure, knots: int | Sequence[float], side: str) -> dict[str, Any]:
    """The fields that change when a side, or `both`, gets more knots and keeps its shape."""
    if side not in ("suction", "pressure", "both"):
        raise DesignError(f"side is {side!r}: it must be one of suction, pressure, both")
    if part.pressure_thickness and side != "suction":
        raise DesignError(
            "pressure_thickness is given: a pressure side by a thickness keeps its shape under no refinement of its "
            "own; refine side = 'suction', or take `independent()` first"
        )
    suction, pressure = _sides(part)
    found: dict[str, Any] = {}
    for name, curve in (("suction", suction), ("pressure", pressure)):
        if side in (name, "both"):
            found |= _fields(part, name, inserted(_curve(curve), _new(curve.knots, knots)))
    return found


def _independent_fields(part: SuctionPressure) -> dict[str, Any]:
    """The fields that change when the pressure side is given by heights and keeps its shape."""
    if part.pressure_heights:
        return {}
    return {"pressure_thickness": (), **_fields(part, "pressure", _curve(_sides(part)[1]))}


def _sides(part: SuctionPressure) -> tuple[Side, Side]:
    for path, law in named_laws(part):
        value = law_points(law)
        if is_list(law) or np.size(value) > 1:
            raise DesignError(
                f"{path} belongs to a law along the span or to a batch: between the places of a law the refined "
                "control points follow no law of the same kind; refine the sections one by one, with plain numbers"
            )
        if np.iscomplexobj(value):
            raise DesignError(f"{path} is {law}: only a real section is refined")
    span = Span(np.zeros(1))
    return sides(part, span, *edge_points(part, span))


def _curve(side: Side) -> Curve:
    return Curve(control_points=side.controls[0], knots=side.knots, degree=DEGREE)


def _new(knots: Reals, wanted: int | Sequence[float]) -> list[float]:
    """The knots asked for, or so many, each in the middle of what is then the longest knot span."""
    if not isinstance(wanted, int):
        return [float(each) for each in wanted]
    if wanted < 1:
        raise DesignError(f"{wanted} further knots were asked for: at least 1 is needed")
    found: list[float] = []
    for _ in range(wanted):
        ends = np.unique([*knots, *found])
        widest = int(np.argmax(np.diff(ends) > np.max(np.diff(ends)) * (1.0 - 1e-9)))
        found.append(float(0.5 * (ends[widest] + ends[widest + 1])))
    return found


def _fields(part: SuctionPressure, name: str, curve: Curve) -> dict[str, Any]:
    controls = curve.control_points
    inner = curve.knots[DEGREE + 1 : -DEGREE - 1]
    line = np.real(skeleton_of(part, Span(np.zeros(1)))[0])
    places, heights = places_off_line(line, controls[2:-2], default_places(curve.knots))
    ends = length(controls[1] - controls[0]), length(controls[-2] - controls[-1])
    return {
        f"{name}_heights": tuple(float(each) for each in heights),
        f"{name}_places": tuple(float(each) for each in places),
        f"{name}_knots": tuple(float(each) for each in inner),
        f"{name}_tangent_in": float(ends[0]),
        f"{name}_tangent_out": float(ends[1]),
    }
