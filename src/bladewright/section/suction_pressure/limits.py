"""What a section by suction and pressure side refuses: parameters out of range, edges and sides that do not fit."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bladewright.designs import Limits, Part
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross2, length, radians
from bladewright.nurbs.basis import Reals
from bladewright.section import checks
from bladewright.section.laws import Span
from bladewright.section.suction_pressure.edges import MAX_OPENING, Continuity, Corners, opening
from bladewright.section.suction_pressure.side import DEGREE, Side

ANGLE = Limits(-90.0, 90.0, "an angle must lie between -90 and 90 deg")
RADIUS = Limits(0.0, 0.5, "an edge radius must lie above 0 and below half the chord")
STRETCH = Limits(0.0, 20.0, "the ratio of an edge's semi-axes must lie above 0 and below 20")
SKEW = Limits(-1.0, 1.0, "a skewness must lie between -1 and 1, or an edge loses one of its halves")
WEDGE = Limits(0.0, 90.0, "a wedge angle must lie from 0 to 90 deg", closed=True)
TANGENT = Limits(0.0, 10.0, "it must lie above 0 and below 10 chords, along the tangent from the corner")
PLACE = Limits(-0.5, 1.5, "a place along the skeleton must lie between -0.5 and 1.5")
"""the skeleton continues beyond the edges, and refined control points may lie there"""
THICKNESS = Limits(0.0, 1.0, "a thickness must be positive, and below the chord")
CHECKED_AT = np.linspace(0.0, 1.0, 65)
"""fractions of the sides, and of the knot spans beside the edges, at which sides are compared and parametrisations
checked"""


def check(part: Part) -> None:
    """Bring the fields of a part to laws and tuples of numbers; raises DesignError where they do not fit."""
    checks.parameters(part)
    found = vars(part)
    checks.choice("suction_side", found["suction_side"], ("upper", "lower"))
    checks.choice("edges", found["edges"], ("C1", "C2"))
    checks.choice("skeleton", found["skeleton"], ("chord", "pseudo"))
    _check_counts(found)
    for side, count in (("suction", "suction_heights"), ("pressure", _pressure(found))):
        name = f"{side}_knots"
        object.__setattr__(part, name, _knots(name, found[name], len(found[count]), count))


def _pressure(found: Mapping[str, Any]) -> str:
    return "pressure_thickness" if found["pressure_thickness"] else "pressure_heights"


def _check_counts(found: Mapping[str, Any]) -> None:
    if bool(found["pressure_heights"]) == bool(found["pressure_thickness"]):
        given = "both are given" if found["pressure_heights"] else "none is given"
        raise DesignError(
            f"pressure_heights and pressure_thickness: {given}; give heights for a pressure side of its own, or "
            "thicknesses along the suction side, and leave the other out"
        )
    for places, count in (("suction_places", "suction_heights"), ("pressure_places", _pressure(found))):
        if found[places] and len(found[places]) != len(found[count]):
            raise DesignError(
                f"{places} has {len(found[places])} entries and {count} has {len(found[count])}: give one place for "
                f"each, or leave {places} out"
            )
        if count == "pressure_thickness":
            checks.between(places, found[places], 0.0, 1.0, "a place on the suction side must lie between 0 and 1")


def _knots(name: str, value: Any, count: int, of: str) -> tuple[float, ...]:
    if not checks.is_sequence(value):
        raise DesignError(f"{name} is {value!r}: a list of numbers between 0 and 1 is needed, or none")
    knots = tuple(checks.number(f"{name}[{i}]", each) for i, each in enumerate(value))
    if not knots:
        return ()
    if any(np.iscomplexobj(each) or isinstance(each, np.ndarray) for each in knots):
        raise DesignError(f"{name} is {value!r}: knots are plain real numbers, held while differentiating")
    if len(knots) != count:
        raise DesignError(f"{name} has {len(knots)} entries: {of} has {count}, and one inner knot is needed for each")
    if not (np.diff([0.0, *knots, 1.0]) > 1e-9).all():
        raise DesignError(f"{name} is {list(knots)}: inner knots must increase, above 0 and below 1; sort them")
    return knots


def check_opening(edge: str, continuity: Continuity, stretch: Array, skew: Array, wedge: Array, span: Span) -> None:
    """Refuse a wedge that is too wide for the edge's ellipse."""
    longest = np.real(stretch) * (1.0 + np.sqrt(np.real(skew) ** 2))
    ratio = np.broadcast_to(opening(longest, radians(np.real(wedge))), _shape(stretch, skew, wedge))
    if np.any(ratio > MAX_OPENING[continuity]):
        at = _worst(ratio)
        limit = np.degrees(2.0 * np.arctan(MAX_OPENING[continuity] / np.broadcast_to(longest, ratio.shape)[at]))
        value = np.broadcast_to(np.real(wedge), ratio.shape)[at]
        raise DesignError(
            f"{edge}_wedge is {value:g} deg{_where(at, span)}: with {edge}_stretch and {edge}_skew as they are, sides "
            f"at more than {limit:.3g} deg leave a {continuity} edge no room to turn; lower {edge}_wedge or "
            f"{edge}_stretch"
        )


def check_chord_left(leading: Corners, trailing: Corners, span: Span) -> None:
    """Refuse edges that leave nothing of the chord to a side."""
    for name in ("upper", "lower"):
        ahead = np.real(trailing[name].point - leading[name].point)[..., 0]
        if np.any(ahead <= 0.0):
            at = _worst(-ahead)
            raise DesignError(
                f"leading_edge_radius and trailing_edge_radius leave no room for the {name} side{_where(at, span)}: it "
                f"would run {-ahead[at]:.3g} of the chord backwards; lower a radius or a stretch"
            )


def check_reparametrisation(name: str, side: Side, where: Sequence[str]) -> None:
    """Refuse a control point on a tangent so near to its corner that the side cannot continue the edge's speed.

    With a the distance from the corner to that control point, c = a slope, which does not depend on a, and d the
    distance to the next control point, the rise is about -c^2 d / a^3, and the parameter is monotone up to a rise of
    about sqrt(72 slope) and a slope of about 2.5.
    """
    for end, edge, which in ((0, "leading_edge", "in"), (1, "trailing_edge", "out")):
        slope = np.min(np.real(side.own_parameter(end, CHECKED_AT, 1)), axis=-1)
        if np.any(slope <= 0.0):
            at = _worst(-slope)
            distance, slope_there, next_step = (
                float(np.broadcast_to(np.real(each), slope.shape)[at])
                for each in (
                    length(side.taylor[end][..., 1, :]) / DEGREE,
                    side.slopes[end],
                    _next_step(side.taylor[end]),
                )
            )
            least = 1.2 * max(distance * slope_there / 2.5, ((distance * slope_there) ** 1.5 * next_step / 8.5) ** 0.4)
            raise DesignError(
                f"{name}_tangent_{which} is {distance:.3g}{where[at[-1]]}: too short for the {edge}_radius, the "
                f"{name} side would turn back where it joins the edge; make it about {least:.2g} or more, or lower "
                f"{edge}_radius"
            )


def gaps(upper: Side, lower: Side) -> Array:
    """How far the upper side stands on the left of the lower one (..., 64), in chords, between places along them."""
    one, other = (side.points(CHECKED_AT) for side in (upper, lower))
    across, along = one - other, np.diff(0.5 * (one + other), axis=-2)
    return np.asarray(cross2(along, 0.5 * (across[..., 1:, :] + across[..., :-1, :])) / length(along))


def check_crossing(upper: Side, lower: Side, where: Sequence[str], *, suction_side: str, by_thickness: bool) -> None:
    """Refuse sides of which the upper is not on the left of the lower; the keywords are for the message."""
    parted = np.real(gaps(upper, lower))
    if np.any(parted <= 0.0):
        at = _worst(np.max(-parted, axis=-1))
        place = float(CHECKED_AT[int(np.argmin(parted[at]))])
        pressure = "pressure_thickness" if by_thickness else "pressure_heights"
        cure = "raise pressure_thickness" if by_thickness else f"part suction_heights and {pressure}"
        raise DesignError(
            f"suction_heights and {pressure}: the two sides cross{where[at[-1]]} near {place:.2f} of the way from "
            f"leading to trailing edge (suction_side is the {suction_side} one); {cure} there, or lower an edge "
            "radius or a tangent that reaches too far"
        )


def _next_step(taylor: Array) -> Array:
    """Distance (...) from a side's second control point to its third."""
    first, second = taylor[..., 1, :], taylor[..., 2, :]
    return length(2.0 * second + 2.0 * first) / DEGREE


def _shape(*values: Array) -> tuple[int, ...]:
    return np.broadcast_shapes(*[np.shape(value) for value in values])


def _worst(values: Reals) -> tuple[int, ...]:
    return tuple(int(i) for i in np.unravel_index(int(np.argmax(values)), values.shape))


def _where(at: tuple[int, ...], span: Span) -> str:
    return f" at span v = {span.v[at[-1]]:.3g}" if len(span.v) > 1 else ""
