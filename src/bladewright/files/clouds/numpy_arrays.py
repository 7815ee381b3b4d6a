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
        content: Any = np.load(io.BytesIO(data), allow_pickle=False)
        if not isinstance(content, np.ndarray):
            content = {name: content[name] for name in content.files}
    except (ValueError, OSError, EOFError, zipfile.BadZipFile, KeyError) as error:
        what = (
            "a ZIP archive that is no NPZ file of numbers"
            if data.startswith(b"PK")
            else "an NPY file that is not whole"
        )
        raise FileError(f"'{path}' is {what}: {str(error).splitlines()[0]}") from error
    names: tuple[str, ...] = ()
    if isinstance(content, dict):
        names, content = _points_array(path, content)
    if content.dtype.names:
        names = content.dtype.names
        content = np.stack([content[name] for name in names], axis=-1)
    if content.dtype.kind not in "fiu" or content.ndim != 2 or 0 in content.shape:
        raise FileError(
            f"'{path}' holds an array of shape {content.shape} and type {content.dtype}: one of numbers, with "
            "a row for each point, is needed"
        )
    values = np.asarray(content, dtype=np.float64)
    notes: tuple[str, ...] = ()
    if len(values) in (2, 3) and values.shape[1] > TRANSPOSED:
        values, notes = values.T, (f"the array of shape {values.shape} is taken as a column for each point",)
    whole = bool(np.all(values[:, 0] == np.round(values[:, 0])))
    return Columns(values=values, format="a NumPy file", names=names, whole=whole, notes=notes)


def _points_array(path: Path, content: dict[str, Any]) -> tuple[tuple[str, ...], Any]:
    """Column names and the array of points of an NPZ file: one of its arrays, or its coordinate arrays side by side."""
    for name in _POINT_ARRAYS:
        if name in content:
            return (), content[name]
    if len(content) == 1:
        return (), next(iter(content.values()))
    for names in (("x", "y", "z"), ("x", "r", "theta"), ("x", "y")):
        if set(names) <= content.keys() and len({np.shape(content[name]) for name in names}) == 1:
            return names, np.stack([np.ravel(content[name]) for name in names], axis=-1)
    raise FileError(f"'{path}' holds the arrays {', '.join(content)}: name the one of the points 'points'")
