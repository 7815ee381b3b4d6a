"""Whether edges and sides fit each other; each refusal names parameter, value, limit and cure."""

from typing import TYPE_CHECKING

import numpy as np

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross2, length, radians
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span
from bladewright.section.suction_pressure.points import OPENING, Continuity, Points, opening
from bladewright.section.suction_pressure.side import DEGREE, End, Side, pace

if TYPE_CHECKING:
    from bladewright.section.suction_pressure.part import SuctionPressure

PLACES = np.linspace(0.0, 1.0, 65)
"""where sides are compared and paces are judged"""


def check_opening(edge: str, continuity: Continuity, stretch: Array, skew: Array, wedge: Array, span: Span) -> None:
    """Refuse a wedge that is too wide for the edge's ellipse."""
    longest = np.real(stretch) * (1.0 + np.sqrt(np.real(skew) ** 2))
    ratio = np.broadcast_to(opening(longest, radians(np.real(wedge))), _shape(stretch, skew, wedge))
    if np.any(ratio > OPENING[continuity]):
        at = _worst(ratio)
        limit = np.degrees(2.0 * np.arctan(OPENING[continuity] / np.broadcast_to(longest, ratio.shape)[at]))
        value = np.broadcast_to(np.real(wedge), ratio.shape)[at]
        raise DesignError(
            f"{edge}_wedge is {value:g} deg{_where(at, span)}: with {edge}_stretch and {edge}_skew as they are, sides "
            f"at more than {limit:.3g} deg leave a {continuity} edge no room to turn; lower {edge}_wedge or "
            f"{edge}_stretch"
        )


def check_room(leading: Points, trailing: Points, span: Span) -> None:
    """Refuse edges that take the whole chord."""
    for name in ("upper", "lower"):
        ahead = np.real(getattr(trailing, name).point - getattr(leading, name).point)[..., 0]
        if np.any(ahead <= 0.0):
            at = _worst(-ahead)
            raise DesignError(
                f"leading_edge_radius and trailing_edge_radius leave no room for the {name} side{_where(at, span)}: it "
                f"would run {-ahead[at]:.3g} of the chord backwards; lower a radius or a stretch"
            )


def check_pace(name: str, side: Side, span: Span) -> None:
    """Refuse a control point on a tangent so near to its corner that the side cannot take over the edge's speed.

    With c = reach slope, which the reach leaves alone, and the distance d to the next control point, the rise is about
    -c^2 d / reach^3, and the pace is monotone up to a rise of about sqrt(72 slope) and a slope of about 2.5.
    """
    for end, edge, which in ((side.start, "leading_edge", "in"), (side.end, "trailing_edge", "out")):
        slope = np.min(np.real(pace(end, PLACES, 1)), axis=-1)
        if np.any(slope <= 0.0):
            at = _worst(-slope)
            reach, slope_there, next_step = (
                float(np.broadcast_to(np.real(each), slope.shape)[at])
                for each in (length(end.taylor[..., 1, :]) / DEGREE, end.slope, _next_step(end))
            )
            least = 1.2 * max(reach * slope_there / 2.5, ((reach * slope_there) ** 1.5 * next_step / 8.5) ** 0.4)
            raise DesignError(
                f"{name}_tangent_{which} is {reach:.3g}{_where(at, span)}: too short for the {edge}_radius, the "
                f"{name} side would turn back where it joins the edge; make it about {least:.2g} or more, or lower "
                f"{edge}_radius"
            )


def check_crossing(part: "SuctionPressure", upper: Side, lower: Side, span: Span) -> None:
    """Refuse sides of which the upper is not on the left of the lower."""
    one, other = (np.real(side.points(PLACES)) for side in (upper, lower))
    across, middle = one - other, 0.5 * (one + other)
    parted = cross2(np.diff(middle, axis=-2), 0.5 * (across[..., 1:, :] + across[..., :-1, :]))
    if np.any(parted <= 0.0):
        at = _worst(np.max(-parted, axis=-1))
        place = float(PLACES[int(np.argmin(parted[at]))])
        pressure = "pressure_thickness" if part.pressure_thickness else "pressure_heights"
        gap = "raise pressure_thickness" if part.pressure_thickness else f"part suction_heights and {pressure}"
        raise DesignError(
            f"suction_heights and {pressure}: the two sides cross{_where(at, span)} near {place:.2f} of the way from "
            f"leading to trailing edge (suction_side is the {part.suction_side} one); {gap} there, or lower an edge "
            "radius or a tangent that reaches too far"
        )


def _next_step(end: End) -> Array:
    """Distance (...) from a side's second control point to its third."""
    first, second = end.taylor[..., 1, :], end.taylor[..., 2, :]
    return length(2.0 * second + 2.0 * first) / DEGREE


def _shape(*values: Array) -> tuple[int, ...]:
    return np.broadcast_shapes(*[np.shape(value) for value in values])


def _worst(values: Reals) -> tuple[int, ...]:
    return tuple(int(i) for i in np.unravel_index(int(np.argmax(values)), values.shape))


def _where(at: tuple[int, ...], span: Span) -> str:
    return f" at span v = {span.v[at[-1]]:.3g}" if len(span.v) > 1 else ""
