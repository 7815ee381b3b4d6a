"""The units of length that CAD files are written in."""

from typing import Literal

from bladewright.errors import CadError

Unit = Literal["mm", "m", "in"]
"""units of length that a CAD file can be written in"""

MILLIMETRES: dict[Unit, float] = {"mm": 1.0, "m": 1000.0, "in": 25.4}
"""Millimetres in each unit."""


def check_unit(unit: str, kind: str) -> None:
    """Raise CadError unless a file of a format can be written in a unit."""
    if unit not in MILLIMETRES:
        raise CadError(f"the unit {unit!r} is none that CAD files are written in: choose mm, m or in")
    if kind == "BREP" and unit != "mm":
        raise CadError(
            f"{unit!r} was asked of a BREP file, which states no unit and is read in millimetres: leave the unit out, "
            "or choose another format"
        )
