"""What a change of a parameter that matters is, and how far a parameter may go."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bladewright.derivatives.patterns import matching
from bladewright.designs import Design
from bladewright.errors import FitError
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

ANGLE = 89.0
"""largest angle [deg]"""
LEAST = 2e-5
"""smallest thickness and edge radius, of the meridional length"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scales:
    """Of k parameters, in the units of their fields."""

    size: Reals
    """(k,) a change that matters: the unit of a search, and how far a prior guess may be off"""
    low: Reals
    """(k,)"""
    high: Reals
    """(k,)"""


def scales_of(
    design: Design, paths: Sequence[str], chord: float, bounds: Mapping[str, tuple[float, float]] | None = None
) -> Scales:
    """Scales of a design's parameters, `chord` in metres, `bounds` by pattern within those of the family."""
    values = design.parameters()
    unit = UNITS[getattr(design, "length_unit")]  # noqa: B009 - a field of every family, not of the base
    largest: dict[str, float] = {}
    for path, value in values.items():
        field = path.partition("[")[0]
        largest[field] = max(largest.get(field, 0.0), float(value))
    size, low, high = np.empty(len(paths)), np.full(len(paths), -np.inf), np.full(len(paths), np.inf)
    for i, path in enumerate(paths):
        field = path.partition("[")[0]
        if field.startswith(("stagger", "metal_angle")):
            size[i], low[i], high[i] = (5.0 if field == "stagger" else 10.0), -ANGLE, ANGLE
        elif field.startswith("tangent"):
            size[i], low[i], high[i] = 0.2, 0.02, 1.0
        elif field.endswith("radius"):
            size[i], low[i], high[i] = max(0.5 * largest[field], 1e-3), LEAST, 1.0
        elif field.startswith("thickness"):
            size[i], low[i], high[i] = max(0.5 * largest[field], 0.02), LEAST, 5.0
        elif field.startswith("weights"):
            size[i], low[i], high[i] = 0.5 * float(values[path]), 1e-2 * float(values[path]), 1e2 * float(values[path])
        elif field == "leading_edge_theta":
            size[i] = np.degrees(0.05)
        elif field == "axial_chord":
            size[i], low[i] = 0.05 * chord / unit, 1e-3 * chord / unit
        else:
            size[i] = (0.005 if field.startswith("channel") else 0.05) * chord / unit
    for pattern, (least, most) in (bounds or {}).items():
        if not least < most:
            raise FitError(f"the bounds of {pattern} are {least:g} to {most:g}: the first must be below the second")
        for path in matching(pattern, paths):
            i = list(paths).index(path)
            low[i], high[i] = max(low[i], least), min(high[i], most)
    return Scales(size=size, low=low, high=high)
