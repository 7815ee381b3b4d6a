"""Named quantities that the command line differentiates."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bladewright.blade.native.throat import throat
from bladewright.designs import unknown
from bladewright.errors import DerivativeError
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array, length
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import breaks


@dataclass(frozen=True, kw_only=True)
class NamedQuantity:
    """A quantity of what a design builds."""

    name: str
    of: Callable[[Any], Array]
    """the quantity, of any shape, of a build that may be complex"""
    power: int
    """its unit is this power of a metre, where it has no other"""
    angle: bool = False
    """whether it is an angle [rad]"""
    unit: str = ""
    """its own unit, where that is none of these"""
    points: bool = False
    """whether it is a set of control points (k, d), whose derivative is reported as a root mean square"""


def _net(blade: Any) -> Array:
    return np.concatenate([side.control_points.reshape(-1, 3) for side in blade.sides])


def _curves(section: Any) -> Array:
    return np.concatenate([curve.control_points for curve in section.curves.values()])


def _chord(blade: Any) -> Array:
    v, weight = panels(breaks(blade.plain.knots.v), 3)
    side = blade.plain.sides[0]
    return np.asarray(np.sum(weight * length(side(1.0, v) - side(0.0, v))))


def _moment_of_inertia(body: Any) -> Array:
    return np.asarray(body.mass_report().inertia_about_axis[0, 0])


BLADE: Mapping[str, NamedQuantity] = FrozenMapping(
    {
        each.name: each
        for each in (
            NamedQuantity(name="surface", of=_net, power=1, points=True),
            NamedQuantity(name="volume", of=lambda blade: blade.properties.volume, power=3),
            NamedQuantity(name="area", of=lambda blade: blade.properties.area, power=2),
            NamedQuantity(name="centroid", of=lambda blade: blade.properties.centroid, power=1),
            NamedQuantity(name="inertia", of=lambda blade: blade.properties.inertia, power=5),
            NamedQuantity(name="chord", of=_chord, power=1),
            NamedQuantity(name="throat", of=lambda blade: throat(blade.plain).area, power=2),
            NamedQuantity(name="mass", of=lambda body: body.mass, power=0, unit="kg"),
            NamedQuantity(name="moment-of-inertia", of=_moment_of_inertia, power=0, unit="kg m2"),
        )
    }
)
"""Quantities of a blade: its sides' control points; volume, area, centroid and inertia; the mean straight distance from
leading to trailing edge and the area of the throat, both before cuts and fillets; mass, and moment of inertia about the
machine axis."""
SECTION: Mapping[str, NamedQuantity] = FrozenMapping(
    {
        each.name: each
        for each in (
            NamedQuantity(name="surface", of=_curves, power=1, points=True),
            NamedQuantity(name="area", of=lambda section: section.area, power=2),
            NamedQuantity(name="centroid", of=lambda section: section.centroid, power=1),
            NamedQuantity(name="chord", of=lambda section: section.chord, power=1),
            NamedQuantity(name="perimeter", of=lambda section: section.perimeter, power=1),
            NamedQuantity(name="camber-length", of=lambda section: section.camber_length, power=1),
        )
    }
)
"""Quantities of a section: its curves' control points; area, centroid, chord, length of both sides, and of the camber
line."""


AREAS = ("inlet_area", "throat_area", "outlet_area")
"""Areas of a passage that the station table of a blade has besides its columns."""
OTHER_NAMES = {"sweep": "leading_edge_sweep", "throat_width": "throat"}
"""Names by which a column is asked for, besides its own."""


def station_quantities(base: Any, stations: Sequence[float]) -> dict[str, NamedQuantity]:
    """The columns of the station table of what a design builds, at stations, and the areas of a blade's passage."""
    in_space = base.dimension == 3
    table = base.report(stations) if in_space else base.report()

    def at_stations(name: str) -> Callable[[Any], Array]:
        return lambda built: getattr(built.report(stations) if in_space else built.report(), name)

    found = {name: at_stations(column) for name, column in OTHER_NAMES.items() if column in table.names}
    found |= {name: at_stations(name) for name in table.names if name != "span"}
    kinds = {name: table.heading(OTHER_NAMES.get(name, name))[1] for name in found}
    quantities = {
        name: NamedQuantity(
            name=name, of=of, power=1 if kinds[name] == table.length_unit else 0, angle=kinds[name] == "deg"
        )
        for name, of in found.items()
    }
    areas = AREAS if in_space else ()
    return quantities | {name: NamedQuantity(name=name, of=at_stations(name), power=2) for name in areas}


def named_quantity(
    base: Any, name: str, more: Mapping[str, NamedQuantity] | None = None, stations: Sequence[float] = (0.5,)
) -> NamedQuantity:
    """The quantity of that name for what a design builds; `more` are known besides the usual ones.

    Columns of the station table are those at `stations`; a name may be written with hyphens. Raises DerivativeError
    with the most similar name where there is none.
    """
    known = {**(BLADE if base.dimension == 3 else SECTION), **(more or {})}
    if name not in known:
        known = {**station_quantities(base, stations), **known}
        name = name.replace("-", "_") if name not in known else name
    if name not in known:
        raise DerivativeError(unknown(f"the quantity '{name}'", name, list(known)))
    return known[name]
