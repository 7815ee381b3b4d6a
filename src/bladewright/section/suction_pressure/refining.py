"""The same section by other control points: more of them, or a pressure side of its own."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from bladewright.errors import DesignError
from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.refine import inserted
from bladewright.section.laws import Span
from bladewright.section.suction_pressure.assembly import characteristic, sides, skeleton_of
from bladewright.section.suction_pressure.side import DEGREE, Side, spread

if TYPE_CHECKING:
    from bladewright.section.suction_pressure.part import SuctionPressure


def refined(part: "SuctionPressure", knots: int | Sequence[float], side: str) -> dict[str, Any]:
    """The fields that change when a side, or `both`, gets further knots and keeps its shape."""
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


def freed(part: "SuctionPressure") -> dict[str, Any]:
    """The fields that change when the pressure side gets heights of its own and keeps its shape."""
    if part.pressure_heights:
        return {}
    return {"pressure_thickness": (), **_fields(part, "pressure", _curve(_sides(part)[1]))}


def _sides(part: "SuctionPressure") -> tuple[Side, Side]:
    for path, value in part.parameters().items():
        name = path.partition("[")[0]
        if np.size(value) > 1 or (isinstance(getattr(part, name), tuple) and path.count("[") != _depth(name)):
            raise DesignError(
                f"{path} belongs to a law along the span or to a batch: between the places of a law the refined "
                "control points follow no law of the same kind; refine the sections one by one, with plain numbers"
            )
        if np.iscomplexobj(value):
            raise DesignError(f"{path} is {value}: only a real section is refined")
    span = Span(np.zeros(1))
    return sides(part, span, *characteristic(part, span))


def _depth(name: str) -> int:
    return 1 if name.endswith(("heights", "places", "thickness")) else 0


def _curve(side: Side) -> Curve:
    return Curve(control_points=side.controls[0], knots=side.knots, degree=DEGREE)


def _new(knots: Reals, asked: int | Sequence[float]) -> list[float]:
    """The knots asked for, or so many, each in the middle of the then longest knot span."""
    if not isinstance(asked, int):
        return [float(each) for each in asked]
    if asked < 1:
        raise DesignError(f"{asked} further knots were asked for: at least 1 is needed")
    found: list[float] = []
    for _ in range(asked):
        ends = np.unique([*knots, *found])
        widest = int(np.argmax(np.diff(ends) > np.max(np.diff(ends)) * (1.0 - 1e-9)))
        found.append(float(0.5 * (ends[widest] + ends[widest + 1])))
    return found


def _fields(part: "SuctionPressure", name: str, curve: Curve) -> dict[str, Any]:
    controls = curve.control_points
    inner = curve.knots[DEGREE + 1 : -DEGREE - 1]
    places, heights = skeleton_of(part, Span(np.zeros(1))).at(0).places(controls[2:-2], spread(curve.knots))
    ends = length(controls[1] - controls[0]), length(controls[-2] - controls[-1])
    return {
        f"{name}_heights": tuple(float(each) for each in heights),
        f"{name}_places": tuple(float(each) for each in places),
        f"{name}_knots": tuple(float(each) for each in inner),
        f"{name}_tangent_in": float(ends[0]),
        f"{name}_tangent_out": float(ends[1]),
    }
