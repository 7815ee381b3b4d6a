"""Surface points for the flow solver SU2, and the sensitivities to them that it returns as CSV or VTU."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bladewright.atomic_write import atomic_write
from bladewright.derivatives.surface_points import SurfacePoints
from bladewright.designs import unknown
from bladewright.errors import FileError
from bladewright.nurbs.basis import Reals

Rows = list[list[str]]


def read_csv(path: Path) -> tuple[list[str], Rows]:
    """The names of the columns, and the rows below; raises FileError where there is none, or rows differ in length."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as stream:
            lines = csv.reader(stream, skipinitialspace=True)
            rows = [row for row in lines if row and not (len(row) == 1 and not row[0].strip())]
    except FileNotFoundError:
        raise FileError(f"there is no file '{path}'") from None
    except UnicodeDecodeError:
        raise FileError(f"'{path}' is no text: a table with commas between its numbers is needed") from None
    except (OSError, ValueError, csv.Error) as error:
        raise FileError(f"'{path}' cannot be read: {getattr(error, 'strerror', None) or error}") from error
    if len(rows) < 2:
        raise FileError(f"'{path}' holds no rows: names of columns, and a row for each point below, are needed")
    header = [name.strip().strip('"') for name in rows[0]]
    for place, row in enumerate(rows[1:], 2):
        if len(row) != len(header):
            raise FileError(
                f"'{path}' has {len(row)} entries in row {place}, and {len(header)} columns: is it cut off?"
            )
    return header, rows[1:]


def column_indices(path: Path, header: Sequence[str], wanted: Sequence[str]) -> list[int]:
    """Places of wanted columns, whatever their case; raises FileError with the nearest name where one is not there."""
    known = {name.lower(): place for place, name in enumerate(header)}
    for name in wanted:
        if name.lower() not in known:
            raise FileError(unknown(f"'{path}': the column '{name}'", name, list(header)))
    return [known[name.lower()] for name in wanted]


def column_values(path: Path, rows: Rows, column: int) -> Reals:
    """A column (n,) as numbers; raises FileError with the row where one is none."""
    try:
        return np.array([float(row[column]) for row in rows])
    except ValueError:
        place = next(i for i, row in enumerate(rows) if not _is_number(row[column]))
        raise FileError(f"'{path}' has '{rows[place][column]}' in row {place + 2}: a number is needed") from None


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


NAME = "Sensitivity"


def read_vtu(path: Path, dimension: int) -> tuple[Reals, Reals]:
    """Points and sensitivities (n, dimension) of an unstructured grid.

    The sensitivity is the vector `Sensitivity`, or the numbers `Sensitivity_x`, `Sensitivity_y`... at the points.
    Raises FileError where VTK cannot read the file or there is no such field.
    """
    try:
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkCommonCore import vtkObject
        from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
    except ImportError:
        raise FileError(f"'{path}' needs VTK to be read: install the package vtk, or give the CSV file") from None
    if not path.is_file():
        raise FileError(f"there is no file '{path}'")
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    shown = vtkObject.GetGlobalWarningDisplay()
    vtkObject.GlobalWarningDisplayOff()
    try:
        reader.Update()
    finally:
        vtkObject.SetGlobalWarningDisplay(shown)
    grid: Any = reader.GetOutput()
    if reader.GetErrorCode() or grid.GetNumberOfPoints() == 0:
        raise FileError(f"'{path}' is no VTU file with points in it: has the solver finished writing?")
    data = grid.GetPointData()
    fields = {data.GetArrayName(i): data.GetArray(i) for i in range(data.GetNumberOfArrays())}
    parts = [f"{NAME}_{axis}" for axis in "xyz"[:dimension]]
    if NAME in fields and fields[NAME].GetNumberOfComponents() >= dimension:
        rates = np.asarray(vtk_to_numpy(fields[NAME]), dtype=np.float64)[:, :dimension]
    elif all(part in fields for part in parts):
        rates = np.stack([np.asarray(vtk_to_numpy(fields[part]), dtype=np.float64) for part in parts], axis=-1)
    else:
        known = ", ".join(sorted(fields)) or "none"
        raise FileError(f"'{path}' has no field {NAME} at its points: its fields are {known}")
    points = np.asarray(vtk_to_numpy(grid.GetPoints().GetData()), dtype=np.float64)
    return points[:, :dimension], rates


NUMBER = ("PointID", "Point", "GlobalIndex", "Global_Index")
"""what versions of SU2 call the column of the points' numbers"""
AXES = "xyz"
BESIDE = ".places.csv"
"""what is added to the name of the points' file for the file that says where they lie"""
MOVED = 1e-6
"""largest distance of a point from where it was written, of the points' extent; VTU files hold single precision"""
SEVERAL = 5
"""numbers that a message names"""


def write_surface_points(points: SurfacePoints, path: str | Path) -> Path:
    """Write points for SU2_DEF's SURFACE_FILE, and beside them `PATH.places.csv`, which says where each lies.

    Gives the path of the latter; `read_surface_points` reads it back. Raises FileError where one cannot be written, and
    leaves nothing behind.
    """
    path = Path(path)
    beside = places_beside(path)
    rows = [[repr(float(each)) for each in row] for row in points.points]
    moved = ["\t".join([str(number), *row]) for number, row in zip(points.ids, rows, strict=True)]
    places = [",".join(("PointID", "surface", "u", "v", *AXES[: points.points.shape[1]]))]
    for number, name, u, v, row in zip(points.ids, points.names, points.u, points.v, rows, strict=True):
        places.append(",".join([str(number), name, repr(float(u)), repr(float(v)), *row]))
    fresh = not beside.exists()
    try:
        with ExitStack() as stack:
            for file, lines in ((path, moved), (beside, places)):
                unfinished = stack.enter_context(atomic_write(file))
                Path(unfinished).write_text("\n".join([*lines, ""]), encoding="utf-8")
    except FileError:
        if fresh:
            beside.unlink(missing_ok=True)
        raise
    return beside


def places_beside(path: Path) -> Path:
    """The file that says where the points of a file lie."""
    return path.with_name(path.name + BESIDE)


def read_surface_points(path: str | Path) -> SurfacePoints:
    """The points that `write_surface_points` wrote at `path`, with the places that stand beside it.

    Raises FileError where the file beside is not there, or is not what was written.
    """
    beside = places_beside(Path(path))
    header, rows = read_csv(beside)
    axes = AXES[: len(header) - 4]
    number, name, u, v, *places = column_indices(beside, header, ("PointID", "surface", "u", "v", *axes))
    ids = _whole(beside, column_values(beside, rows, number))
    _check_once(beside, ids)
    return SurfacePoints(
        ids=ids,
        names=tuple(row[name].strip() for row in rows),
        u=column_values(beside, rows, u),
        v=column_values(beside, rows, v),
        points=np.stack([column_values(beside, rows, place) for place in places], axis=-1),
    )


def read_surface_sensitivity(path: str | Path, points: SurfacePoints) -> Reals:
    """Derivatives (n, d) of SU2's objective by the points, in their order, from a CSV or VTU file [1/m].

    A table's rows are matched by their number; a VTU file has none, so its points are matched by where they are. Raises
    FileError where a point is missing, foreign, there twice or has moved, where columns are missing or hold what is no
    finite number.
    """
    path = Path(path)
    if path.suffix.lower() == ".vtu":
        found, rates = read_vtu(path, points.points.shape[1])
        order = _matched_by_place(path, found, points)
    else:
        ids, found, rates = _from_table(path, points.points.shape[1])
        order = _matched_by_number(path, ids, points)
    if not np.isfinite(rates).all():
        bad = points.ids[np.flatnonzero(~np.isfinite(rates[order]).all(axis=1))]
        raise FileError(
            f"'{path}' holds sensitivities that are not finite, at {_listed(bad)}: has the adjoint converged?"
        )
    _check_moved(path, found[order], points)
    return rates[order]


def check_of(path: str | Path, points: SurfacePoints, now: SurfacePoints) -> None:
    """Refuse points of a file that lie elsewhere on the design than when they were written: then it is another design.

    `now` are the same places on the design as it is. Raises FileError.
    """
    _check_moved(Path(path), now.points, points, "the points must be those of this design: write them anew")


def _from_table(path: Path, dimension: int) -> tuple[NDArray[np.int64], Reals, Reals]:
    """Numbers (n,), points and sensitivities (n, d) of a table."""
    header, rows = read_csv(path)
    known = {name.lower(): place for place, name in enumerate(header)}
    number = next((known[name.lower()] for name in NUMBER if name.lower() in known), None)
    if number is None:
        raise FileError(f"'{path}' has no column {NUMBER[0]}: its columns are {', '.join(header)}")
    if "surface_sensitivity" in known and "sensitivity_x" not in known:
        raise FileError(
            f"'{path}' holds Surface_Sensitivity alone, along the normals: the vectors Sensitivity_x, ... of the "
            "discrete adjoint are needed; run SU2_DOT_AD, and let SURFACE_CSV be among OUTPUT_FILES"
        )
    axes = AXES[:dimension]
    places = column_indices(path, header, tuple(axes))
    rates = column_indices(path, header, tuple(f"Sensitivity_{axis}" for axis in axes))
    found = [np.stack([column_values(path, rows, each) for each in which], axis=-1) for which in (places, rates)]
    return _whole(path, column_values(path, rows, number)), found[0], found[1]


def _matched_by_number(path: Path, ids: NDArray[np.int64], points: SurfacePoints) -> NDArray[np.intp]:
    _check_once(path, ids)
    missing, foreign = np.setdiff1d(points.ids, ids), np.setdiff1d(ids, points.ids)
    if len(missing):
        raise FileError(
            f"'{path}' has no row for {_listed(missing)}: every point that was written needs its sensitivity"
        )
    if len(foreign):
        raise FileError(
            f"'{path}' has rows for {_listed(foreign)}, which were not written: name the design's surfaces alone in "
            "DV_MARKER, or give the points' file that belongs to it"
        )
    order = np.argsort(ids)
    return order[np.searchsorted(ids[order], points.ids)]


def _matched_by_place(path: Path, found: Reals, points: SurfacePoints) -> NDArray[np.intp]:
    from scipy.spatial import cKDTree

    if len(found) != len(points.ids):
        raise FileError(
            f"'{path}' holds {len(found)} points, and {len(points.ids)} were written: it must be of the same"
        )
    order = np.asarray(cKDTree(found).query(points.points)[1], dtype=np.intp)
    if len(np.unique(order)) < len(order):
        _check_moved(path, found[order], points)
        raise FileError(
            f"'{path}' holds points so close to each other that they cannot be told apart: give the CSV file"
        )
    return order


def _check_moved(
    path: Path,
    found: Reals,
    points: SurfacePoints,
    cure: str = "the sensitivity must be that of the written points",
) -> None:
    away = np.sqrt(np.sum((found - points.points) ** 2, axis=-1))
    limit = MOVED * float(np.ptp(points.points, axis=0).max())
    moved = np.flatnonzero(~(away <= limit))
    if len(moved):
        worst = int(moved[np.argmax(away[moved])])
        raise FileError(
            f"'{path}' has {_listed(points.ids[moved])} elsewhere than they were written, {points.ids[worst]} by "
            f"{away[worst]:.3g} m, at most {limit:.2g} m is allowed: {cure}"
        )


def _check_once(path: Path, ids: NDArray[np.int64]) -> None:
    values, counts = np.unique(ids, return_counts=True)
    if np.any(counts > 1):
        raise FileError(f"'{path}' has {_listed(values[counts > 1])} more than once: a number belongs to one point")


def _whole(path: Path, values: Reals) -> NDArray[np.int64]:
    ids = np.asarray(np.rint(values), dtype=np.int64)
    if np.any(ids != values):
        raise FileError(f"'{path}' numbers a point {values[ids != values][0]:g}: a whole number is needed")
    return ids


def _listed(ids: NDArray[np.int64]) -> str:
    shown = ", ".join(str(each) for each in ids[:SEVERAL])
    more = f" and {len(ids) - SEVERAL} more" if len(ids) > SEVERAL else ""
    return f"point{'s' if len(ids) > 1 else ''} {shown}{more}"
