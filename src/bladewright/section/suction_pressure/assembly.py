"""Sections put together: characteristic points, suction side, pressure side, edges."""

from typing import TYPE_CHECKING

import numpy as np

from bladewright.numerics.elementary import Array, length, radians
from bladewright.section.camber import turned_left
from bladewright.section.laws import Span
from bladewright.section.suction_pressure.edge import edge_curve
from bladewright.section.suction_pressure.fitting import check_crossing, check_opening, check_pace, check_room
from bladewright.section.suction_pressure.outline import SHARE, SuctionPressureOutline
from bladewright.section.suction_pressure.points import Corner, Points, characteristic_points
from bladewright.section.suction_pressure.side import (
    DEGREE,
    Side,
    controls_of,
    interpolated_free,
    parametrised,
    side_knots,
    spread,
    values_at,
)
from bladewright.section.suction_pressure.skeleton import Skeleton, chord_line, pseudo_line

if TYPE_CHECKING:
    from bladewright.designs import ChordwiseLaw
    from bladewright.nurbs.basis import Reals
    from bladewright.section.suction_pressure.part import SuctionPressure


def assembled(part: "SuctionPressure", span: Span) -> SuctionPressureOutline:
    """The outline of sections (..., m); raises DesignError where edges or sides do not fit."""
    leading, trailing = characteristic(part, span)
    check_room(leading, trailing, span)
    suction, pressure = sides(part, span, leading, trailing)
    upper, lower = (suction, pressure) if part.suction_side == "upper" else (pressure, suction)
    names = ("suction", "pressure") if part.suction_side == "upper" else ("pressure", "suction")
    for name, side in zip(names, (upper, lower), strict=True):
        check_pace(name, side, span)
    curves = [
        edge_curve(points, one.bend, other.bend, part.edges)
        for points, one, other in ((leading, upper.start, lower.start), (trailing, upper.end, lower.end))
    ]
    check_crossing(part, upper, lower, span)
    return SuctionPressureOutline(edges=(curves[0], curves[1]), upper=upper, lower=lower, continuity=part.edges)


def camber_angles(part: "SuctionPressure", span: Span) -> tuple[Array, Array]:
    """Angles (..., m) of both edges' directions from the chord line [rad]."""
    turn = span.values(part.stagger_angle)
    return radians(span.values(part.metal_angle_in) - turn), radians(span.values(part.metal_angle_out) - turn)


def characteristic(part: "SuctionPressure", span: Span) -> tuple[Points, Points]:
    """The characteristic points of the leading and the trailing edge."""
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


def skeleton_of(part: "SuctionPressure", span: Span) -> Skeleton:
    """The line of places and heights."""
    return pseudo_line(*camber_angles(part, span)) if part.skeleton == "pseudo" else chord_line((len(span.v),))


def sides(part: "SuctionPressure", span: Span, leading: Points, trailing: Points) -> tuple[Side, Side]:
    """The suction and the pressure side."""
    skeleton = skeleton_of(part, span)
    on, off = ("upper", "lower") if part.suction_side == "upper" else ("lower", "upper")
    ends: tuple[Corner, Corner] = getattr(leading, on), getattr(trailing, on)
    other: tuple[Corner, Corner] = getattr(leading, off), getattr(trailing, off)
    knots = side_knots(len(part.suction_heights), part.suction_knots)
    free = skeleton.placed(*_numbers(span, part.suction_places, part.suction_heights, knots))
    tangents = span.values(part.suction_tangent_in), span.values(part.suction_tangent_out)
    controls = controls_of(*ends, *tangents, free)
    suction = parametrised(controls, knots, *ends, SHARE)

    offsets = part.pressure_thickness or part.pressure_heights
    knots = side_knots(len(offsets), part.pressure_knots)
    places, numbers = _numbers(span, part.pressure_places, offsets, knots)
    given = part.pressure_tangent_in, part.pressure_tangent_out
    speeds = (
        length(suction.start.taylor[..., 1, :]) / suction.start.span,
        length(suction.end.taylor[..., 1, :]) / suction.end.span,
    )
    widths = knots[DEGREE + 1], 1.0 - knots[-DEGREE - 2]
    tangents_of = [
        speed * (width / DEGREE) if law is None else span.values(law)
        for law, speed, width in zip(given, speeds, widths, strict=True)
    ]
    tangents = tangents_of[0], tangents_of[1]
    if part.pressure_thickness:
        inside = -1.0 if on == "upper" else 1.0
        through = _thickened(suction, places, inside * numbers)
        free = interpolated_free(*other, tangents, through, knots)
    else:
        free = skeleton.placed(places, numbers)
    return suction, parametrised(controls_of(*other, *tangents, free), knots, *other, SHARE)


def _numbers(span: Span, places: "ChordwiseLaw", offsets: "ChordwiseLaw", knots: "Reals") -> tuple[Array, Array]:
    """Places and offsets (..., m, k)."""
    values = _stacked(span, offsets)
    at = _stacked(span, places) if places else np.broadcast_to(spread(knots), (len(span.v), len(offsets)))
    return at, values


def _stacked(span: Span, laws: "ChordwiseLaw") -> Array:
    return np.stack(np.broadcast_arrays(*[span.values(law) for law in laws]), axis=-1)


def _thickened(side: Side, places: Array, offsets: Array) -> Array:
    """Points (..., m, k, 2) at offsets from the side to its left, at its own parameters (..., m, k)."""
    tangent = values_at(side.controls, side.knots, places, 1)
    return values_at(side.controls, side.knots, places) + offsets[..., None] * turned_left(
        tangent / length(tangent)[..., None]
    )
