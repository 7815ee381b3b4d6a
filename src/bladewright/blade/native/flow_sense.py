"""Which way a row turns, and which of its sides is the suction side, as far as its shape and its `rotation` tell.

Seen from upstream, clockwise is towards -theta. Two things hold for a rotor, whether it does work or takes it:

* The relative flow runs against the rotation where it is steepest: at the inlet of a compressor (-U beside the axial
  velocity), at the outlet of a turbine. So the steeper of both metal angles points against the rotation.
* The pressure side of a compressor faces the rotation, that of a turbine the other way. Where the radius changes,
  the work is that of the centrifugal field, U2^2 - U1^2: outwards a compressor or pump, inwards a turbine.

Without a change of radius the suction side is the one that the camber bulges towards: the flow leaves with less swirl
towards larger theta than it came with, so that the blade is pushed there. Both rules agree on a row without a fault.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from bladewright.blade.native.station_table import BladeStations, station_table

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade

RADIAL = 1.1
"""Ratio of the radii of both edges at mid-span from which on the centrifugal field decides between compressor and
turbine: the work of an axial stage is some 0.3 U^2, that of this ratio 0.2 U^2."""
UNCAMBERED = np.radians(0.05)
"""Turning [rad] below which a camber line counts as straight: rounding and the fit of straight vanes."""
AXIAL = np.radians(1.0)
"""Metal angle [rad] below which it points neither way."""
Side = Literal["upper", "lower"]
Kind = Literal["compressor or pump", "turbine"]


@dataclass(frozen=True, kw_only=True)
class FlowSense:
    """What shape and rotation tell, at mid-span."""

    rotation: str | None
    """that of the design"""
    turns: int
    """its sign in theta, or y"""
    linear: bool
    suction_side: Side | None
    """None where the camber does not turn and no rotation tells"""
    kind: Kind | None
    """what a rotor is taken for; None of a vane, where the rotation is not known, and where it contradicts angles"""
    metal_angle_in: float
    """[rad]"""
    turning: float
    """[rad]"""
    warning: str | None
    """what does not fit together"""

    @property
    def sentence(self) -> str:
        """All of it as an engineer would say it."""
        larger, smaller = ("+y", "-y") if self.linear else ("+theta", "-theta")
        parts = []
        if self.rotation in ("clockwise", "counterclockwise"):
            parts.append(f"seen from upstream the rotor turns {self.rotation}, towards {_towards(self)}")
        elif self.rotation == "none":
            parts.append("the row stands still")
        flow = "relative flow" if self.kind else "flow"
        came, turned = np.degrees(self.metal_angle_in), np.degrees(self.turning)
        way = f"at mid-span the {flow} without incidence comes along the meridional direction"
        if came * came > np.degrees(AXIAL) ** 2:
            side = larger if came > 0.0 else smaller
            way = f"at mid-span the {flow} without incidence comes {_size(came)} deg towards {side}"
        if turned * turned > np.degrees(UNCAMBERED) ** 2:
            way += f" and is turned by {_size(turned)} deg towards {smaller if turned > 0.0 else larger}"
        parts.append(way)
        if self.suction_side is None:
            parts.append("the camber line does not turn it: the suction side depends on the incidence")
        else:
            rest = f", as of a {self.kind}" if self.kind else ", by the camber"
            parts.append(f"the {self.suction_side} side is the suction side{rest}")
        return "; ".join(parts)


def _size(angle: float) -> str:
    return f"{angle if angle > 0.0 else -angle:.1f}"


def _towards(sense: FlowSense) -> str:
    return ("+" if sense.turns > 0 else "-") + ("y" if sense.linear else "theta")


def flow_sense(blade: Blade) -> FlowSense:
    """The sense of a blade by its own mid-span."""
    table, rotation = station_table(blade, [0.5]), blade.design.rotation
    first, last, turning = (
        float(np.real(each[0])) for each in (table.metal_angle_in, table.metal_angle_out, table.turning)
    )
    side: Side | None = None
    if turning * turning > UNCAMBERED**2:
        side = "upper" if turning > 0.0 else "lower"
    sign = blade.design.turns
    warning = _warning(first, last, rotation or "", sign) if sign else None
    kind = _kind(table, first, last) if sign and not warning else None
    if kind:
        side = "upper" if (sign > 0) == (kind == "turbine") else "lower"
    return FlowSense(
        rotation=rotation,
        turns=sign,
        linear=not table.annular,
        suction_side=side,
        kind=kind,
        metal_angle_in=first,
        turning=turning,
        warning=warning,
    )


def _kind(table: BladeStations, first: float, last: float) -> Kind:
    """What a rotor is by the change of its radius, or by which of its metal angles is the steeper."""
    if table.annular:
        ratio = float(np.real(table.trailing_edge_r[0] / table.leading_edge_r[0]))
        if ratio > RADIAL or ratio < 1.0 / RADIAL:
            return "compressor or pump" if ratio > 1.0 else "turbine"
    return "compressor or pump" if first * first > last * last else "turbine"


def _warning(first: float, last: float, rotation: str, sign: int) -> str | None:
    """What is wrong where the steeper metal angle points along the rotation."""
    steeper, name = max((first * first, "metal_angle_in"), (last * last, "metal_angle_out"))
    value = first if name == "metal_angle_in" else last
    if steeper < AXIAL**2 or (value > 0.0) != (sign > 0):
        return None
    other = "counterclockwise" if rotation == "clockwise" else "clockwise"
    return (
        f"rotation is {rotation}, but {name} is {np.degrees(value):.1f} deg at mid-span, along the rotation: in a "
        "rotor, compressor or turbine, the relative flow is steepest against it (taking the absolute flow for slower "
        f"than the blades there); give rotation = '{other}', or the metal angles and the stagger the other sign"
    )
