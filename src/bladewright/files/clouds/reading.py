"""Reading a cloud of points from a file whose format its contents tell."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from bladewright.errors import FileError
from bladewright.files.clouds.cloud import Cloud, Columns
from bladewright.files.clouds.columns import points_of_columns, roles_of, unit_in, unit_warning
from bladewright.files.clouds.numpy_arrays import read_arrays
from bladewright.files.clouds.ply import read_ply
from bladewright.files.clouds.stl import is_stl, read_stl
from bladewright.files.clouds.tables import read_table
from bladewright.files.clouds.vtk import read_vtk_points
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

LARGEST = 4_000_000_000
"""[bytes] Size above which a file is refused before it is read. Five million points as text take 0.4 GB, so this is no
limit in practice; it keeps a wrong file, such as a disk image, from filling the memory."""
_OTHER_FORMATS = {
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
    """The points of a file, in metres; the format is recognised from the contents, not from the name.

    Read are tables of numbers, separated by blanks, tabs, commas or semicolons, with or without column names, comments
    and point ids; Selig and Lednicer airfoils; SU2 surfaces; PLY, STL, VTK, VTP, VTU, NPY and NPZ.
    `columns` says what each column of the file is: `x`, `y`, `z`, `r`, `theta` [deg] or `skip`. They must give x y,
    x y z or x r theta, with y = r sin(theta) and z = r cos(theta). Without `columns`, the names above the columns
    decide; without names, two numbers in a row are x y and three are x y z, after a column of whole numbers that can
    only be ids. `unit` is m, cm, mm, um, in or ft; without it, the unit that the column names state, or the metre.

    Raises FileError where there is no such file, or where it holds no such points.
    """
    path = Path(path)
    if unit is not None and unit not in UNITS:
        raise FileError(f"the unit '{unit}' is not known: it is one of {', '.join(UNITS)}")
    data = _contents(path)
    table = _reader(path, data)(path, data)
    where = f"'{path}'"
    roles = roles_of(where, table, columns)
    _check_finite(where, table, roles)
    used_unit = unit or unit_in(where, table.names, roles) or "m"
    points = points_of_columns(table, roles, UNITS[used_unit])
    notes = [*table.notes, *unit_warning(points, used_unit, given=unit is not None)]
    return Cloud(points=points, format=table.format, unit=used_unit, columns=roles, notes=tuple(notes))


def _reader(path: Path, data: bytes) -> Callable[[Path, bytes], Columns]:
    head = data[:4096].removeprefix(b"\xef\xbb\xbf").lstrip()
    for start, what in _OTHER_FORMATS.items():
        if data.startswith(start) or head.startswith(start):
            raise FileError(f"'{path}' is {what}")
    if head.startswith((b"ply\n", b"ply\r")):
        return read_ply
    if data.startswith((b"\x93NUMPY", b"PK\x03\x04")):
        return read_arrays
    if head.lower().startswith(b"# vtk datafile") or b"<VTKFile" in head:
        return read_vtk_points
    return read_stl if is_stl(data) else read_table


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


def _check_finite(where: str, table: Columns, roles: Sequence[str]) -> None:
    used = [place for place, role in enumerate(roles) if role != "skip"]
    values: Reals = table.values[:, used]
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        row, column = (int(each) for each in bad[0])
        at = f"line {int(table.lines[row])}" if table.lines is not None else f"point {row + 1}"
        rows = len(np.unique(bad[:, 0]))
        more = f", and {rows - 1} more like it" if rows > 1 else ""
        raise FileError(
            f"{where} has {values[row, column]} at {at}, column {used[column] + 1}{more}: every coordinate must be a "
            "finite number; correct or delete that row"
        )
