"""The unit of a cloud's lengths: what its file says, and whether it can be true of a blade."""

import re
from collections.abc import Sequence

import numpy as np

from bladewright.errors import FileError
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

LARGE = 20.0
"""extent of a blade [m] above which its unit is suspected"""
SMALL = 5e-3
"""extent of a blade [m] below which its unit is suspected, as that of 4 inches read as millimetres"""
USUAL = 0.1
"""extent of a blade [m] to which that in the likeliest unit is nearest"""
NAMES = {"m": "metres", "cm": "centimetres", "mm": "millimetres", "um": "micrometres", "in": "inches"}
_UNIT = re.compile(r"[\[(]\s*(m|cm|mm|um|µm|in|ft)\s*[\])]|_(cm|mm|um|in|ft)$", re.IGNORECASE)


def unit_in(where: str, names: Sequence[str], roles: Sequence[str]) -> str | None:
    """The unit that the names of the columns of lengths state, such as `x [mm]`; None where they state none."""
    found = set()
    for name, role in zip(names, roles, strict=False):
        match = _UNIT.search(name.strip())
        if role in {"x", "y", "z", "r"} and match:
            found.add((match[1] or match[2]).lower().replace("µ", "u"))
    if len(found) > 1:
        raise FileError(f"{where} has columns in {' and '.join(sorted(found))}: bring them to one unit")
    return found.pop() if found else None


def suspicion(points: Reals, unit: str, *, given: bool) -> list[str]:
    """A sentence where hardly a blade has the extent of points [m] that were taken to be in a unit."""
    extent = float(np.max(np.ptp(points, axis=0)))
    if SMALL <= extent <= LARGE or extent == 0.0:
        return []
    own = extent / UNITS[unit]
    likely = min(NAMES, key=lambda name: abs(np.log(own * UNITS[name] / USUAL)))
    taken = f"given as {unit}" if given else f"taken to be in {unit}"
    sure = SMALL <= own * UNITS[likely] <= LARGE and likely != unit
    cure = f": is it in {NAMES[likely]}? Then give the unit {likely}" if sure else ": is the unit right?"
    return [f"the cloud, {taken}, is {extent:.4g} m long, which hardly a blade is{cure}"]
