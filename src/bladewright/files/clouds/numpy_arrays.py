"""Points in NumPy's NPY and NPZ files."""

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from bladewright.errors import FileError
from bladewright.files.clouds.cloud import Columns

TRANSPOSED = 12
"""An array of two or three rows and more columns than this is read as one point a column, not one a row: a cloud of two
or three points is of no use, and no program known to us writes more than 12 numbers a point."""
_POINT_ARRAYS = ("points", "cloud", "xyz", "vertices", "coordinates")


def read_arrays(path: Path, data: bytes) -> Columns:
    """The array of an NPY file, or the points of an NPZ file; raises FileError where it has none."""
    try:
        held: Any = np.load(io.BytesIO(data), allow_pickle=False)
        if not isinstance(held, np.ndarray):
            held = {name: held[name] for name in held.files}
    except (ValueError, OSError, EOFError, zipfile.BadZipFile, KeyError) as error:
        what = (
            "a ZIP archive that is no NPZ file of numbers"
            if data.startswith(b"PK")
            else "an NPY file that is not whole"
        )
        raise FileError(f"'{path}' is {what}: {str(error).splitlines()[0]}") from error
    names: tuple[str, ...] = ()
    if isinstance(held, dict):
        names, held = _points_array(path, held)
    if held.dtype.names:
        names = held.dtype.names
        held = np.stack([held[name] for name in names], axis=-1)
    if held.dtype.kind not in "fiu" or held.ndim != 2 or 0 in held.shape:
        raise FileError(
            f"'{path}' holds an array of shape {held.shape} and type {held.dtype}: one of numbers, with "
            "a row for each point, is needed"
        )
    values = np.asarray(held, dtype=np.float64)
    notes: tuple[str, ...] = ()
    if len(values) in (2, 3) and values.shape[1] > TRANSPOSED:
        values, notes = values.T, (f"the array of shape {values.shape} is taken as a column for each point",)
    whole = bool(np.all(values[:, 0] == np.round(values[:, 0])))
    return Columns(values=values, format="a NumPy file", names=names, whole=whole, notes=notes)


def _points_array(path: Path, held: dict[str, Any]) -> tuple[tuple[str, ...], Any]:
    """Column names and the array of points of an NPZ file: one of its arrays, or its coordinate arrays side by side."""
    for name in _POINT_ARRAYS:
        if name in held:
            return (), held[name]
    if len(held) == 1:
        return (), next(iter(held.values()))
    for names in (("x", "y", "z"), ("x", "r", "theta"), ("x", "y")):
        if set(names) <= held.keys() and len({np.shape(held[name]) for name in names}) == 1:
            return names, np.stack([np.ravel(held[name]) for name in names], axis=-1)
    raise FileError(f"'{path}' holds the arrays {', '.join(held)}: name the one of the points 'points'")
