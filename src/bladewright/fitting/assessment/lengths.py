"""Lengths as people read them: in the unit of the design that they are said of."""

from bladewright.designs import Design, unit_at
from bladewright.section.checks import UNITS


def unit_of_lengths(design: Design) -> str:
    """The design's unit of length."""
    return str(getattr(design, "length_unit", "mm"))


def in_unit(design: Design, metres: float, digits: int = 3) -> str:
    """A length [m] as a number of the design's unit."""
    return f"{metres / UNITS[unit_of_lengths(design)]:.{digits}g}"


def with_unit(design: Design, metres: float, digits: int = 3) -> str:
    """The same with the unit."""
    return f"{in_unit(design, metres, digits)} {unit_of_lengths(design)}"


def unit_of_parameter(design: Design, path: str) -> str:
    """Unit of a parameter: that of its field, the design's unit of length where it is one."""
    unit = unit_at(design, path) or "-"
    return unit_of_lengths(design) if unit == "length" else unit
