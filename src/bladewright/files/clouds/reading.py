"""Reading a cloud of points from a file whose format its contents tell."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from bladewright.errors import FileError
from bladewright.files.clouds import numpy_arrays, ply, stl, tables, vtk
from bladewright.files.clouds.cloud import Cloud, Columns
from bladewright.files.clouds.columns import points_of_columns, roles_of, unit_in, unit_warning
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

LARGEST = 4_000_000_000
"""bytes beyond which a file is refused before it is read; five million points take 0.4 GB"""
_OTHERS = {
    b"ISO-10303-21": "a STEP file, whose faces cad.sample gives points of",
    b"DBRep_DrawableShape": "a BREP file, whose faces cad.sample gives points of",
    b"\x1f\x8b": "a gzip archive: unpack it",
    b"%PDF": "a PDF",
    b"\x89PNG": "a PNG picture",
    b"\xd0\xcf\x11\xe0": "an old Excel file: save it as CSV",
    b"\xff\xfe": "UTF-16 text: save it as UTF-8",
    b"\xfe\xff": "UTF-16 text: save it as UTF-8",
    b"NDIME": "an SU2 mesh with all of its nodes: give the points of its surface, such as SU2's surface_flow.csv",
    b"CDF": "a NetCDF file",
    b"\x89HDF": "an HDF5 or CGNS file",
}


def read_cloud(path: str | os.PathLike[str], *, columns: Sequence[str] | None = None, unit: str | None = None) -> Cloud:
    """The points of a file, in metres; its contents tell its format.

    Tables of numbers with or without names above them, with blanks, tabs, commas or semicolons between, comments and
    ids; Selig and Lednicer airfoils; SU2 surfaces; PLY, STL, VTK, VTP, VTU, NPY and NPZ.
    `columns` says what each column of the file is: `x`, `y`, `z`, `r`, `theta` [deg] or `skip`; needed are x y, x y z
    or x r theta, with y = r sin(theta) and z = r cos(theta). Where not given, names above the columns say it, or two
    numbers are x y and three x y z, after whole numbers that can only be ids. `unit` is m, cm, mm, um, in or ft; where
    not given it is what the names of the columns say, or the metre.

    Raises FileError where there is no such file, or it holds no such points.
    """
    path = Path(path)
    if unit is not None and unit not in UNITS:
        raise FileError(f"the unit '{unit}' is not known: it is one of {', '.join(UNITS)}")
    data = _contents(path)
    numbers = _reader(path, data)(path, data)
    where = f"'{path}'"
    roles = roles_of(where, numbers, columns)
    _check_finite(where, numbers, roles)
    said = unit_in(where, numbers.names, roles)
    taken = unit or said or "m"
    points = points_of_columns(numbers, roles, UNITS[taken])
    notes = [*numbers.notes, *unit_warning(points, taken, given=unit is not None)]
    return Cloud(points=points, format=numbers.format, unit=taken, columns=roles, notes=tuple(notes))


def _reader(path: Path, data: bytes) -> Callable[[Path, bytes], Columns]:
    head = data[:4096].removeprefix(b"\xef\xbb\xbf").lstrip()
    for start, what in _OTHERS.items():
        if data.startswith(start) or head.startswith(start):
            raise FileError(f"'{path}' is {what}")
    if head.startswith((b"ply\n", b"ply\r")):
        return ply.read_ply
    if data.startswith((b"\x93NUMPY", b"PK\x03\x04")):
        return numpy_arrays.read_arrays
    if head.lower().startswith(b"# vtk datafile") or b"<VTKFile" in head:
        return vtk.read_vtk
    if stl.is_stl(data):
        return stl.read_stl
    return tables.read_table


def _contents(path: Path) -> bytes:
    try:
        if path.is_dir():
            raise FileError(f"'{path}' is a directory: name a file with points in it")
        size = path.stat().st_size
        if size > LARGEST:
            raise FileError(f"'{path}' holds {size:,} bytes: at most {LARGEST:,} are read; give fewer points")
        data = path.read_bytes()
    except FileNotFoundError:
        raise FileError(f"there is no file '{path}'") from None
    except OSError as error:
        raise FileError(f"'{path}' cannot be read: {(error.strerror or str(error)).lower()}") from error
    if not data.strip():
        raise FileError(f"'{path}' is empty: a cloud of points is needed")
    return data


def _check_finite(where: str, numbers: Columns, roles: Sequence[str]) -> None:
    used = [place for place, role in enumerate(roles) if role != "skip"]
    values: Reals = numbers.values[:, used]
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        row, column = (int(each) for each in bad[0])
        at = f"line {int(numbers.lines[row])}" if numbers.lines is not None else f"point {row + 1}"
        rows = len(np.unique(bad[:, 0]))
        more = f", and {rows - 1} more like it" if rows > 1 else ""
        raise FileError(
            f"{where} has {values[row, column]} at {at}, column {used[column] + 1}{more}: every coordinate must be a "
            "finite number; correct or delete that row"
        )
