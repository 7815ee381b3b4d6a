"""What the columns of a point cloud's file are, the unit of its lengths, and the points they make."""

import re
from collections.abc import Sequence

import numpy as np

from bladewright.errors import FileError
from bladewright.files.clouds.cloud import Columns
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

ROLES = ("x", "y", "z", "r", "theta", "skip")
"""What a column can be."""
COORDINATES = ({"x", "y"}, {"x", "y", "z"}, {"x", "r", "theta"})
"""Sets of columns that make points."""
_PREFIXES = ("", "coord", "coords", "coordinate", "points", "point")
_SUFFIXES = ("", "coord", "coordinate", "pos", "position")
_ROLE_OF_NAME = {
    **{f"{before}{axis}{after}": axis for axis in "xyz" for before in _PREFIXES for after in _SUFFIXES},
    **{f"points{i}": axis for i, axis in enumerate("xyz")},
    "r": "r",
    "radius": "r",
    "theta": "theta",
    "θ": "theta",
}
"""What a column is, by its name without signs and unit; ParaView numbers the components of its points."""
ID_EXTENT_RATIO = 20.0
"""Whole numbers in the first column are point ids where they extend over this many times the largest extent of the
other columns. A blade is hardly 20 times as long in x as in y and z, and its x is hardly in whole numbers."""
REPEATED_COORDINATES = 0.9
"""Whole numbers in the first column may be ids where more than this fraction of them are distinct: a coordinate on a
grid repeats, an id hardly ever."""

LARGEST_EXTENT = 20.0
"""[m] Extent above which the unit is doubted: no compressor, fan or turbine blade comes near it."""
SMALLEST_EXTENT = 5e-3
"""[m] Extent below which the unit is doubted, such as that of a blade of 4 inches read as millimetres (4 mm)."""
USUAL_EXTENT = 0.1
"""[m] The likeliest unit is the one in which the extent comes nearest to this."""
UNIT_NAMES = {"m": "metres", "cm": "centimetres", "mm": "millimetres", "um": "micrometres", "in": "inches"}
_UNIT = re.compile(r"[\[(]\s*(m|cm|mm|um|µm|in|ft)\s*[\])]|_(cm|mm|um|in|ft)$", re.IGNORECASE)


def roles_of(where: str, table: Columns, columns: Sequence[str] | None) -> tuple[str, ...]:
    """What each column is, one of ROLES; raises FileError where that is not clear or they make no points."""
    count = table.values.shape[1]
    if columns is not None:
        return _given(where, table, tuple(word.strip().lower() for word in columns))
    if table.columns:
        return table.columns
    named = tuple(role_named(name) for name in table.names)
    if len(named) == count and set(named) != {"skip"}:
        if _makes_points(named):
            return named
        raise FileError(
            f"{where} names its columns {', '.join(table.names)}, of which {_listed(named)} are understood: x y, "
            f"x y z or x r theta are needed; {_cure(table)}"
        )
    if count == 2:
        return ("x", "y")
    ids = table.whole and _are_ids(table.values)
    if count == 3 and (ids or not _could_be_ids(table)):
        return ("skip", "x", "y") if ids else ("x", "y", "z")
    if count == 4 and table.whole:
        return ("skip", "x", "y", "z")
    if count == 3:
        raise FileError(f"{where} has whole numbers in column 1, which may be ids or coordinates: {_cure(table)}")
    what = "one number in a row" if count == 1 else f"{count} columns, and nothing says which are coordinates"
    raise FileError(f"{where} has {what}: {_cure(table)}")


def points_of_columns(table: Columns, roles: Sequence[str], metre: float) -> Reals:
    """Points (n, 2) or (n, 3) [m] of columns in a unit of `metre` metres."""
    column = {role: table.values[:, place] for place, role in enumerate(roles) if role != "skip"}
    if "theta" not in column:
        return metre * np.stack([column[axis] for axis in "xyz" if axis in column], axis=-1)
    name = table.names[list(roles).index("theta")] if len(table.names) == len(roles) else ""
    angle = column["theta"] if "rad" in name.lower().replace("radius", "") else np.radians(column["theta"])
    r = column["r"]
    return metre * np.stack([column["x"], r * np.sin(angle), r * np.cos(angle)], axis=-1)


def role_named(name: str) -> str:
    """What the name of a column says that it is, or `skip`."""
    bare = re.sub(r"[\[(].*?[\])]|_(cm|mm|um|in|ft|m|deg|rad)$", "", name.strip().strip("\"'").lower())
    return _ROLE_OF_NAME.get(re.sub(r"[\s_.:\-]", "", bare), "skip")


def _given(where: str, table: Columns, words: tuple[str, ...]) -> tuple[str, ...]:
    count = table.values.shape[1]
    for word in words:
        if word not in ROLES:
            raise FileError(f"the column '{word}' is not known: columns are {', '.join(ROLES)}, in the file's order")
    if not _makes_points(words):
        raise FileError(
            f"the columns {', '.join(words)} make no points: x y, x y z or x r theta are needed, each once, and skip "
            "for every other column"
        )
    if len(words) != count:
        few = "they are too few for those coordinates" if count < len(words) else "name every column, skip where unused"
        raise FileError(f"{where} has {count} columns, and {len(words)} are named: {few}; {_first_row(table)}")
    return words


def _makes_points(roles: Sequence[str]) -> bool:
    used = [role for role in roles if role != "skip"]
    return set(used) in COORDINATES and len(used) == len(set(used))


def _could_be_ids(table: Columns) -> bool:
    first = table.values[:, 0]
    return table.whole and len(first) > 3 and len(np.unique(first)) > REPEATED_COORDINATES * len(first)


def _are_ids(values: Reals) -> bool:
    """Whether whole numbers in the first column cannot be coordinates beside the others."""
    others = float(np.max(np.ptp(values[:, 1:], axis=0)))
    first = values[:, 0]
    return bool(np.min(first) >= 0.0 and len(values) > 3 and np.ptp(first) > ID_EXTENT_RATIO * others)


def _cure(table: Columns) -> str:
    example = {2: "x,y", 3: "skip,x,y", 4: "skip,x,y,z"}.get(table.values.shape[1], "x,y,z,skip,skip")
    return f"{_first_row(table)}; say what its columns are, such as --columns {example}"


def _first_row(table: Columns) -> str:
    row = [f"{value:.6g}" for value in table.values[0][:8]]
    at = f" (line {int(table.lines[0])})" if table.lines is not None else ""
    return f"its first row{at} is {' '.join(row)}{' ...' if table.values.shape[1] > 8 else ''}"


def _listed(roles: Sequence[str]) -> str:
    return ", ".join(role for role in roles if role != "skip") or "none"


def unit_in(where: str, names: Sequence[str], roles: Sequence[str]) -> str | None:
    """The unit that the names of the length columns state, such as `x [mm]`; None where they state none."""
    found = set()
    for name, role in zip(names, roles, strict=False):
        match = _UNIT.search(name.strip())
        if role in {"x", "y", "z", "r"} and match:
            found.add((match[1] or match[2]).lower().replace("µ", "u"))
    if len(found) > 1:
        raise FileError(f"{where} has columns in {' and '.join(sorted(found))}: bring them to one unit")
    return found.pop() if found else None


def unit_warning(points: Reals, unit: str, *, given: bool) -> list[str]:
    """A sentence where points [m], read in a unit, extend further or less far than a blade can."""
    extent = float(np.max(np.ptp(points, axis=0)))
    if SMALLEST_EXTENT <= extent <= LARGEST_EXTENT or extent == 0.0:
        return []
    number = extent / UNITS[unit]
    likely = min(UNIT_NAMES, key=lambda name: abs(np.log(number * UNITS[name] / USUAL_EXTENT)))
    taken = f"given as {unit}" if given else f"taken to be in {unit}"
    sure = SMALLEST_EXTENT <= number * UNITS[likely] <= LARGEST_EXTENT and likely != unit
    cure = f": is it in {UNIT_NAMES[likely]}? Then give the unit {likely}" if sure else ": is the unit right?"
    return [f"the cloud, {taken}, is {extent:.4g} m long, which is unusual for a blade{cure}"]
