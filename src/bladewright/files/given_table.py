"""Tables of stations along the span: CSV with named columns, and the unit of each in its header."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from bladewright.designs import unknown
from bladewright.errors import FileError
from bladewright.files.text import read_text
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.station_table import COLUMNS as REPORTED

Kind = Literal["length", "angle", "share"]
_UNITS: dict[Kind, dict[str, float]] = {
    "length": UNITS,
    "angle": {"deg": 1.0, "°": 1.0, "rad": 180.0 / np.pi},
    "share": {"-": 1.0, "1": 1.0, "%": 1e-2},
}
"""Units by what they measure, each with its factor to metres, degrees or 1."""
COLUMNS: dict[str, tuple[Kind, ...]] = {
    "span": ("share",),
    **dict.fromkeys(("r", "r_le", "r_te", "x_le", "x_te"), ("length",)),
    **dict.fromkeys(("metal_angle_in", "metal_angle_out", "stagger", "theta"), ("angle",)),
    **dict.fromkeys(("chord", "axial_chord", "lean", "sweep"), ("length",)),
    **dict.fromkeys(("maximum_thickness", "leading_edge_radius", "trailing_edge_radius"), ("length", "share")),
    **dict.fromkeys(("maximum_thickness_at", "solidity"), ("share",)),
}
"""The columns that are understood, and what their unit may measure; a share of these is of the span or the chord."""
RESULTS = frozenset(REPORTED) - frozenset(COLUMNS)
"""Columns of the station table of what is built that follow from others: they may be there, and do not count."""
_ALIASES = {
    "leading_edge_x": "x_le",
    "leading_edge_r": "r_le",
    "trailing_edge_x": "x_te",
    "trailing_edge_r": "r_te",
    "radius": "r",
    "v": "span",
    "span_fraction": "span",
    "inlet_metal_angle": "metal_angle_in",
    "outlet_metal_angle": "metal_angle_out",
    "stagger_angle": "stagger",
    "max_thickness": "maximum_thickness",
    "le_radius": "leading_edge_radius",
    "te_radius": "trailing_edge_radius",
}
_HEADER = re.compile(r"\s*([^\[(]+?)\s*(?:[\[(]\s*([^\])]*?)\s*[\])])?\s*")


@dataclass(frozen=True, kw_only=True)
class GivenTable:
    """Numbers at stations from hub to shroud, as a designer has them."""

    where: str
    """the file, for messages"""
    columns: Mapping[str, Reals]
    """(n,) by the names of COLUMNS: lengths in `length_unit`, angles in degrees, shares as fractions"""
    of_chord: frozenset[str]
    """the columns that are fractions, of those that may be lengths as well"""
    length_unit: str
    """that of the table's first column of lengths"""
    results: tuple[str, ...]
    """columns that follow from others, which are left out"""


def read_given_table(path: Path) -> GivenTable:
    """The table in a CSV file; raises FileError with line and cure where it is none.

    Entries are parted by commas, semicolons or tabs. Lines that begin with # and empty ones do not count.
    """
    return given_table(read_text(path), str(path))


def given_table(text: str, where: str) -> GivenTable:
    """The table in a CSV text; `where` names it in a FileError."""
    lines = [(i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip() and not line.startswith("#")]
    if not lines:
        raise FileError(f"'{where}' is empty: its first line names the columns, such as span,metal_angle_in [deg]")
    sign = max(",;\t", key=lines[0][1].count)
    rows = [next(csv.reader(io.StringIO(line), delimiter=sign)) for _, line in lines]
    results = [_is_result(cell) for cell in rows[0]]
    left_out = tuple(_name(cell) for cell, result in zip(rows[0], results, strict=True) if result)
    rows = [
        [cell for cell, result in zip(row, results, strict=True) if not result] if len(row) == len(results) else row
        for row in rows
    ]
    names, kinds, factors, unit = _header(rows[0], where)
    if len(rows) < 3:
        raise FileError(f"'{where}' has {len(rows) - 1} rows of numbers: two stations at least are needed, hub and tip")
    numbers = np.array(
        [_row(row, names, f"'{where}', line {line[0]}") for line, row in zip(lines[1:], rows[1:], strict=True)]
    )
    columns = {
        name: values if factor == 1.0 else np.array([float(f"{value * factor:.14g}") for value in values])
        for name, values, factor in zip(names, numbers.T, factors, strict=True)
    }
    of_chord = frozenset(
        name for name, kind in zip(names, kinds, strict=True) if kind == "share" and "length" in COLUMNS[name]
    )
    return GivenTable(where=where, columns=columns, of_chord=of_chord, length_unit=unit, results=left_out)


def _header(cells: Sequence[str], where: str) -> tuple[list[str], list[Kind], list[float], str]:
    """Names, kinds and factors of the columns, and the unit of the lengths."""
    found = [_column(cell, where) for cell in cells]
    names = [name for name, _, _ in found]
    for name in names:
        if names.count(name) > 1:
            raise FileError(f"'{where}' has two columns {name}: leave one out")
    units = [unit for _, kind, unit in found if kind == "length"]
    unit = units[0] if units else "mm"
    factors = [
        _UNITS[kind][own] / (UNITS[unit] if kind == "length" else 1.0) if own != unit else 1.0 for _, kind, own in found
    ]
    return names, [kind for _, kind, _ in found], factors, unit


def _name(cell: str) -> str:
    """The name in a header such as `Chord [mm]`."""
    match = _HEADER.fullmatch(cell)
    return re.sub(r"[\s-]+", "_", match[1].strip().lower()) if match else ""


def _is_result(cell: str) -> bool:
    """Whether a column follows from others; a lean in degrees does, and one in a length is a shift."""
    match = _HEADER.fullmatch(cell)
    shift = match is not None and match[2] in UNITS
    return (_name(cell) in RESULTS and _name(cell) not in _ALIASES) or (_name(cell) == "lean" and not shift)


def _column(cell: str, where: str) -> tuple[str, Kind, str]:
    """Name, kind and unit of a column from its header, such as `chord [mm]`."""
    match = _HEADER.fullmatch(cell)
    if match is None:
        raise FileError(f"'{where}': the header '{cell.strip()}' names no column: write it like chord [mm]")
    given = _name(cell)
    name, unit = _ALIASES.get(given, given), match[2]
    if name not in COLUMNS:
        raise FileError(f"'{where}': {unknown(f'the column {given}', given, list(COLUMNS))}")
    kinds = COLUMNS[name]
    usual = " or ".join(f"[{each}]" for kind in kinds for each in {"length": ["mm", "in", "m"]}.get(kind, _UNITS[kind]))
    if unit is None and kinds != ("share",):
        raise FileError(f"'{where}': the column {name} has no unit: write it in the header, {name} {usual.split()[0]}")
    unit = unit or "-"
    for kind in kinds:
        if unit in _UNITS[kind]:
            return name, kind, unit
    raise FileError(f"'{where}': the column {name} is in [{unit}], which is not understood: give it in {usual}")


def _row(cells: Sequence[str], names: Sequence[str], where: str) -> list[float]:
    if len(cells) != len(names):
        raise FileError(f"{where} has {len(cells)} entries, and the header {len(names)}: give every column a number")
    found = []
    for name, cell in zip(names, cells, strict=True):
        try:
            value = float(cell)
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            what = "is empty" if not cell.strip() else f"is '{cell.strip()}'"
            raise FileError(f"{where}: {name} {what}: a number with a decimal point is needed")
        found.append(value)
    return found
