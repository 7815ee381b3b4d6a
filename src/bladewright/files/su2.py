"""Surface points for the flow solver SU2, and the sensitivities to them that it returns as CSV or VTU.

SU2_DEF with `DV_KIND= SURFACE_FILE` moves a mesh to the points of the file `DV_FILENAME`, which has a line
`number x y z` for each point, in metres, and no header. SU2_DOT_AD writes `SURFACE_SENS_FILENAME`, either as a table
with names above its columns or as a VTU file for ParaView.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bladewright.atomic_write import atomic_write
from bladewright.derivatives.surface_points import SurfacePoints
from bladewright.designs import unknown
from bladewright.errors import FileError
from bladewright.files.vtk import read_vtk, vtk_array
from bladewright.nurbs.basis import Reals

Rows = list[list[str]]
"""rows of a CSV file, each a list of its entries"""

NUMBER = ("PointID", "Point", "GlobalIndex", "Global_Index")
"""Names under which versions of SU2 write the column of point numbers."""
SENSITIVITY = "Sensitivity"
"""Name of SU2's vector field of sensitivities; with an axis behind it, of one component."""
AXES = "xyz"
PLACES_SUFFIX = ".places.csv"
"""Ending added to the name of the point file, for the file that says where on the design each point lies."""
MOVED = 1e-6
"""Largest distance of a point from where it was written, as a fraction of the extent of all points. It is above the
rounding of the single precision in which VTU files hold coordinates (6e-8), and far below a change of the design."""
MOST_LISTED = 5
"""Most point numbers that an error message names."""


def write_surface_points(points: SurfacePoints, path: str | Path) -> Path:
    """Write points for SU2_DEF's SURFACE_FILE, and `PATH.places.csv`, which says where on the design each one lies.

    Returns the path of the latter; `read_surface_points` reads it back. Raises FileError where either cannot be
    written, and then leaves neither behind.
    """
    path = Path(path)
    places_file = places_path(path)
    rows = [[repr(float(each)) for each in row] for row in points.points]
    moved = ["\t".join([str(number), *row]) for number, row in zip(points.ids, rows, strict=True)]
    places = [",".join(("PointID", "surface", "u", "v", *AXES[: points.points.shape[1]]))]
    for number, name, u, v, row in zip(points.ids, points.names, points.u, points.v, rows, strict=True):
        places.append(",".join([str(number), name, repr(float(u)), repr(float(v)), *row]))
    fresh = not places_file.exists()
    try:
        with ExitStack() as stack:
            for file, lines in ((path, moved), (places_file, places)):
                unfinished = stack.enter_context(atomic_write(file))
                Path(unfinished).write_text("\n".join([*lines, ""]), encoding="utf-8")
    except FileError:
        if fresh:
            places_file.unlink(missing_ok=True)
        raise
    return places_file


def places_path(path: Path) -> Path:
    """Path of the file that says where on the design the points of a point file lie."""
    return path.with_name(path.name + PLACES_SUFFIX)


def read_surface_points(path: str | Path) -> SurfacePoints:
    """The points that `write_surface_points` wrote at `path`, with their places on the design.

    Raises FileError where `PATH.places.csv` is missing or is not what was written.
    """
    places_file = places_path(Path(path))
    header, rows = read_csv(places_file)
    axes = AXES[: len(header) - 4]
    number, name, u, v, *places = column_indices(places_file, header, ("PointID", "surface", "u", "v", *axes))
    ids = _whole_numbers(places_file, column_values(places_file, rows, number))
    _check_unique(places_file, ids)
    return SurfacePoints(
        ids=ids,
        names=tuple(row[name].strip() for row in rows),
        u=column_values(places_file, rows, u),
        v=column_values(places_file, rows, v),
        points=np.stack([column_values(places_file, rows, place) for place in places], axis=-1),
    )


def read_surface_sensitivity(path: str | Path, points: SurfacePoints) -> Reals:
    """Derivatives (n, d) of SU2's objective by the coordinates of the points, in their order [1/m].

    The rows of a CSV file are matched by point number; a VTU file has no numbers, so its points are matched by
    position. Raises FileError where a point is missing, unknown, repeated or moved, and where a column is missing or
    holds something other than finite numbers.
    """
    path = Path(path)
    if path.suffix.lower() == ".vtu":
        found, rates = read_vtu(path, points.points.shape[1])
        order = _matched_by_position(path, found, points)
    else:
        ids, found, rates = _read_sensitivity_csv(path, points.points.shape[1])
        order = _matched_by_number(path, ids, points)
    if not np.isfinite(rates).all():
        bad = points.ids[np.flatnonzero(~np.isfinite(rates[order]).all(axis=1))]
        raise FileError(
            f"'{path}' holds sensitivities that are not finite, at {_listed(bad)}: has the adjoint converged?"
        )
    _check_moved(path, found[order], points)
    return rates[order]


def check_same_design(path: str | Path, points: SurfacePoints, now: SurfacePoints) -> None:
    """Raise FileError where the points were written from another design than this one.

    `now` are the points at the same places on this design.
    """
    _check_moved(Path(path), now.points, points, "the points must be those of this design: write them anew")


def _read_sensitivity_csv(path: Path, dimension: int) -> tuple[NDArray[np.int64], Reals, Reals]:
    """Point numbers (n,), points and sensitivities (n, d) of a CSV file."""
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
    rates = column_indices(path, header, tuple(f"{SENSITIVITY}_{axis}" for axis in axes))
    found = [np.stack([column_values(path, rows, each) for each in which], axis=-1) for which in (places, rates)]
    return _whole_numbers(path, column_values(path, rows, number)), found[0], found[1]


def read_vtu(path: Path, dimension: int) -> tuple[Reals, Reals]:
    """Points and sensitivities (n, dimension) of an unstructured grid.

    The sensitivity is the point vector `Sensitivity`, or the point scalars `Sensitivity_x`, `Sensitivity_y`...
    Raises FileError where VTK cannot read the file or there is no such field.
    """
    if not path.is_file():
        raise FileError(f"there is no file '{path}'")
    grid = read_vtk(path, "UnstructuredGrid")
    if grid is None:
        raise FileError(f"'{path}' is no VTU file with points in it: has the solver finished writing?")
    data = grid.GetPointData()
    fields = {data.GetArrayName(i): data.GetArray(i) for i in range(data.GetNumberOfArrays())}
    components = [f"{SENSITIVITY}_{axis}" for axis in AXES[:dimension]]
    if SENSITIVITY in fields and fields[SENSITIVITY].GetNumberOfComponents() >= dimension:
        rates = vtk_array(fields[SENSITIVITY])[:, :dimension]
    elif all(name in fields for name in components):
        rates = np.stack([vtk_array(fields[name]) for name in components], axis=-1)
    else:
        known = ", ".join(sorted(fields)) or "none"
        raise FileError(f"'{path}' has no field {SENSITIVITY} at its points: its fields are {known}")
    return vtk_array(grid.GetPoints().GetData())[:, :dimension], rates


def _matched_by_number(path: Path, ids: NDArray[np.int64], points: SurfacePoints) -> NDArray[np.intp]:
    _check_unique(path, ids)
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


def _matched_by_position(path: Path, found: Reals, points: SurfacePoints) -> NDArray[np.intp]:
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


def _check_unique(path: Path, ids: NDArray[np.int64]) -> None:
    values, counts = np.unique(ids, return_counts=True)
    if np.any(counts > 1):
        raise FileError(f"'{path}' has {_listed(values[counts > 1])} more than once: a number belongs to one point")


def _whole_numbers(path: Path, values: Reals) -> NDArray[np.int64]:
    ids = np.asarray(np.rint(values), dtype=np.int64)
    if np.any(ids != values):
        raise FileError(f"'{path}' numbers a point {values[ids != values][0]:g}: a whole number is needed")
    return ids


def _listed(ids: NDArray[np.int64]) -> str:
    shown = ", ".join(str(each) for each in ids[:MOST_LISTED])
    more = f" and {len(ids) - MOST_LISTED} more" if len(ids) > MOST_LISTED else ""
    return f"point{'s' if len(ids) > 1 else ''} {shown}{more}"


def read_csv(path: Path) -> tuple[list[str], Rows]:
    """Names of the columns, and the rows; raises FileError where there are none, or where rows differ in length."""
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
    """Indices of wanted columns, whatever their case; raises FileError with the nearest name where one is missing."""
    known = {name.lower(): place for place, name in enumerate(header)}
    for name in wanted:
        if name.lower() not in known:
            raise FileError(unknown(f"'{path}': the column '{name}'", name, list(header)))
    return [known[name.lower()] for name in wanted]


def column_values(path: Path, rows: Rows, column: int) -> Reals:
    """A column as numbers (n,); raises FileError naming the row of an entry that is not a number."""
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
