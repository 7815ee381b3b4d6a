"""The unit of a cloud's lengths: what its file says, and whether it can be true of a blade."""

import re
from collections.abc import Sequence

import numpy as np

from bladewright.errors import FileError
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

LARGE = 20.0
"""extent of a blade [m] above which its unit is suspected"""
SMALL = 0.5e-3
"""extent of a blade [m] below which its unit is suspected"""
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
    """A sentence where no blade has the extent of points [m] that were taken to be in a unit."""
    extent = float(np.max(np.ptp(points, axis=0)))
    if SMALL <= extent <= LARGE or extent == 0.0:
        return []
    own = extent / UNITS[unit]
    likely = [name for name in ("mm", "m", "in", "cm", "um") if SMALL <= own * UNITS[name] <= LARGE and name != unit]
    taken = f"given as {unit}" if given else f"taken to be in {unit}"
    cure = f": is it in {likely[0]}? Then give the unit {likely[0]}" if likely else ": is the unit right?"
    return [f"the cloud, {taken}, is {extent:.4g} m long, which no blade is{cure}"]
