"""From a channel and sections on its stream surfaces to a design that can be built."""

from typing import Any, Literal

import numpy as np

from bladewright.blade.channel import Channel
from bladewright.blade.unified import UnifiedBlade
from bladewright.designs import Point
from bladewright.errors import DesignError, FitError
from bladewright.fitting.first.arrangement import Arrangement
from bladewright.fitting.first.channel import SPAN, Rough
from bladewright.fitting.first.found import Found
from bladewright.fitting.first.laid import numbers_at
from bladewright.fitting.first.shape import (
    ANGLE_IN,
    ANGLE_OUT,
    FIRST_THICKNESS,
    PLACE,
    ROOT_IN,
    ROOT_OUT,
    STAGGER,
    TANGENT_IN,
    TANGENT_OUT,
)
from bladewright.fitting.first.taming import SHARPENINGS, sharpened, tamed
from bladewright.fitting.structures.structure import Structure
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.laws import law_basis
from bladewright.section.limits import ANGLES, RADII, TANGENTS, THICKNESSES

Unit = Literal["m", "cm", "mm", "um", "in", "ft"]
LIMITS = {
    **dict.fromkeys(ANGLES, (-89.0, 89.0)),
    **dict.fromkeys(TANGENTS, (0.01, 1.0)),
    **dict.fromkeys(RADII, (1e-5, 0.95)),
    **dict.fromkeys(THICKNESSES, (1e-5, 9.0)),
}
"""of a first blade's laws"""


AXES = "x must be the machine axis: say which column is which (--columns), or let the axis be found (--align)"
"""what may be wrong with a cloud that no blade is found near"""


def built_blade(
    found: Found,
    arrangement: Arrangement,
    structure: Structure,
    blade_count: int | None,
    pitch: float | None,
    wide: float,
    name: str,
    length_unit: Unit,
) -> tuple[UnifiedBlade, int]:
    """The blade of what was found, tamed until it can be built, and how often it had to be."""
    metre = UNITS[length_unit]
    span = structure.span
    numbers = numbers_at(found.match.laws, SPAN)
    shape, channel = found.shape, found.channel
    lengths = channel.extents()[1]
    linear = arrangement == "linear"

    def law(values: Reals, field: str) -> float | tuple[float, ...]:
        count = span.get(field, 4)
        fitted = np.linalg.lstsq(law_basis(count, SPAN), values, rcond=None)[0]
        low, high = LIMITS.get(field, (-np.inf, np.inf))
        fitted = np.clip(fitted, low, high)
        return tuple(float(x) for x in fitted) if count > 1 else float(fitted[0])

    place = numbers[:, PLACE]
    most = float(np.max(lengths * np.max(numbers[:, FIRST_THICKNESS:], axis=1)))
    if linear:
        around = {"pitch": (pitch if pitch is not None else 2.0 * (wide + most)) / metre}
    else:
        count = blade_count if blade_count is not None else max(1, int(np.pi / max(wide, 1e-3)))
        around = {"blade_count": min(count, 10_000)}
    error: DesignError | None = None
    for attempt in range(SHARPENINGS + 6):
        roots = {ROOT_IN: numbers[:, ROOT_IN] ** 2, ROOT_OUT: numbers[:, ROOT_OUT] ** 2}
        fields: dict[str, Any] = {
            **around,
            "leading_edge_y" if linear else "leading_edge_theta": law(
                place / metre if linear else np.degrees(place), "place"
            ),
        }
        design = UnifiedBlade(
            name=name,
            length_unit=length_unit,
            arrangement=arrangement,
            **fields,
            stagger=law(np.degrees(numbers[:, STAGGER]), "stagger"),
            metal_angle_in=law(np.degrees(numbers[:, ANGLE_IN]), "metal_angle_in"),
            metal_angle_out=law(np.degrees(numbers[:, ANGLE_OUT]), "metal_angle_out"),
            tangent_in=law(numbers[:, TANGENT_IN], "tangent_in"),
            tangent_out=law(numbers[:, TANGENT_OUT], "tangent_out"),
            leading_edge_radius=law(np.clip(roots[ROOT_IN], 1e-5, 0.9), "leading_edge_radius"),
            trailing_edge_radius=law(np.clip(roots[ROOT_OUT], 1e-5, 0.9), "trailing_edge_radius"),
            thickness_upper=tuple(law(t, "thickness_upper") for t in numbers[:, shape.upper].T),
            thickness_lower=tuple(law(t, "thickness_lower") for t in numbers[:, shape.lower].T),
            channel=_as_channel(channel, metre),
            samples=shape.samples,
            clustering=shape.clustering,
        )
        try:
            design.build()
        except DesignError as refused:
            error = refused
            numbers = (sharpened if attempt < SHARPENINGS else tamed)(numbers, shape)
        else:
            return design, max(0, attempt - SHARPENINGS)
    raise FitError(f"no blade that can be built was found near the points ({error}); {AXES}")


def _as_channel(channel: Rough, metre: float) -> Channel:
    def points(name: str, *, inner: bool = False) -> tuple[Point, ...]:
        rows = channel.curves[name] / metre
        return tuple(Point(float(x), float(r)) for x, r in (rows[1:-1] if inner else rows))

    return Channel(
        leading_edge=points("leading_edge"),
        trailing_edge=points("trailing_edge"),
        hub=points("hub", inner=True),
        shroud=points("shroud", inner=True),
    )
