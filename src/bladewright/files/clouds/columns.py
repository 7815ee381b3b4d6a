"""What the columns of a point cloud's file are, the unit of its lengths, and the points they make."""

import re
from collections.abc import Sequence

import numpy as np

from bladewright.errors import FileError
from bladewright.files.clouds.cloud import Columns
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

ROLES = ("x", "y", "z", "r", "theta", "skip")
SETS = ({"x", "y"}, {"x", "y", "z"}, {"x", "r", "theta"})
_BEFORE = ("", "coord", "coords", "coordinate", "points", "point")
_AFTER = ("", "coord", "coordinate", "pos", "position")
_NAMES = {
    **{f"{before}{axis}{after}": axis for axis in "xyz" for before in _BEFORE for after in _AFTER},
    **{f"points{i}": axis for i, axis in enumerate("xyz")},
    "r": "r",
    "radius": "r",
    "theta": "theta",
    "θ": "theta",
}
"""roles by the names of columns, without signs and units; ParaView numbers its components"""
ID_EXTENT_RATIO = 20.0
"""extent of a column of whole numbers over that of the others from which they can only be ids"""


def roles_of(where: str, numbers: Columns, columns: Sequence[str] | None) -> tuple[str, ...]:
    """What each column is, one of ROLES; raises FileError where that is not clear, or not enough for points."""
    count = numbers.values.shape[1]
    if columns is not None:
        return _given(where, numbers, tuple(word.strip().lower() for word in columns))
    if numbers.columns:
        return numbers.columns
    named = tuple(role_named(name) for name in numbers.names)
    if len(named) == count and set(named) != {"skip"}:
        if _makes_points(named):
            return named
        raise FileError(
            f"{where} names its columns {', '.join(numbers.names)}, of which {_listed(named)} are understood: x y, "
            f"x y z or x r theta are needed; {_cure(numbers)}"
        )
    if count == 2:
        return ("x", "y")
    ids = numbers.whole and _are_ids(numbers.values)
    if count == 3 and (ids or not _could_be_ids(numbers)):
        return ("skip", "x", "y") if ids else ("x", "y", "z")
    if count == 4 and numbers.whole:
        return ("skip", "x", "y", "z")
    if count == 3:
        raise FileError(f"{where} has whole numbers in column 1, which may be ids or coordinates: {_cure(numbers)}")
    what = "one number in a row" if count == 1 else f"{count} columns, and nothing says which are coordinates"
    raise FileError(f"{where} has {what}: {_cure(numbers)}")


def points_of_columns(numbers: Columns, roles: Sequence[str], metre: float) -> Reals:
    """Points (n, 2) or (n, 3) [m] of columns in a unit of `metre` metres."""
    column = {role: numbers.values[:, place] for place, role in enumerate(roles) if role != "skip"}
    if "theta" not in column:
        return metre * np.stack([column[axis] for axis in "xyz" if axis in column], axis=-1)
    name = numbers.names[list(roles).index("theta")] if len(numbers.names) == len(roles) else ""
    angle = column["theta"] if "rad" in name.lower().replace("radius", "") else np.radians(column["theta"])
    r = column["r"]
    return metre * np.stack([column["x"], r * np.sin(angle), r * np.cos(angle)], axis=-1)


def role_named(name: str) -> str:
    """The role that the name of a column tells, or `skip`."""
    bare = re.sub(r"[\[(].*?[\])]|_(cm|mm|um|in|ft|m|deg|rad)$", "", name.strip().strip("\"'").lower())
    return _NAMES.get(re.sub(r"[\s_.:\-]", "", bare), "skip")


def _given(where: str, numbers: Columns, words: tuple[str, ...]) -> tuple[str, ...]:
    count = numbers.values.shape[1]
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
        raise FileError(f"{where} has {count} columns, and {len(words)} are named: {few}; {_first_row(numbers)}")
    return words


def _makes_points(roles: Sequence[str]) -> bool:
    used = [role for role in roles if role != "skip"]
    return set(used) in SETS and len(used) == len(set(used))


def _could_be_ids(numbers: Columns) -> bool:
    values = numbers.values
    first = values[:, 0]
    # a coordinate on a grid comes back, an id hardly does
    return numbers.whole and len(values) > 3 and len(np.unique(first)) > 0.9 * len(values)


def _are_ids(values: Reals) -> bool:
    """Whether whole numbers in the first column cannot be coordinates beside the others."""
    others = float(np.max(np.ptp(values[:, 1:], axis=0)))
    first = values[:, 0]
    return bool(np.min(first) >= 0.0 and len(values) > 3 and np.ptp(first) > ID_EXTENT_RATIO * others)


def _cure(numbers: Columns) -> str:
    example = {2: "x,y", 3: "skip,x,y", 4: "skip,x,y,z"}.get(numbers.values.shape[1], "x,y,z,skip,skip")
    return f"{_first_row(numbers)}; say what its columns are, such as --columns {example}"


def _first_row(numbers: Columns) -> str:
    row = [f"{value:.6g}" for value in numbers.values[0][:8]]
    at = f" (line {int(numbers.lines[0])})" if numbers.lines is not None else ""
    return f"its first row{at} is {' '.join(row)}{' ...' if numbers.values.shape[1] > 8 else ''}"


def _listed(roles: Sequence[str]) -> str:
    return ", ".join(role for role in roles if role != "skip") or "none"


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


def unit_warning(points: Reals, unit: str, *, given: bool) -> list[str]:
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
