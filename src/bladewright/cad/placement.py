"""Placements of one solid beside each other, as OpenCASCADE has them, and the files that can hold them."""

from pathlib import Path
from typing import Any

import numpy as np
from OCP.BRep import BRep_Builder
from OCP.BRepTools import BRepTools
from OCP.gp import gp_Trsf
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Compound

from bladewright.cad.native_body import MM, NativeBody
from bladewright.cad.solids import OccSolid
from bladewright.domain.row import Placement, Row
from bladewright.errors import CadError
from bladewright.numerics.elementary import Array

ROW_FORMATS = ("STEP", "BREP")
"""Formats that keep one part and its placements."""


def row_and_part(built: Any) -> tuple[Row | None, NativeBody]:
    """A row and its one part; None and the body itself where it is no row."""
    row: Row | None = built if isinstance(built, Row) else None
    part: Any = built if row is None else row.blade
    return row, part


def check_row_format(path: Path, kind: str) -> None:
    """Raise CadError unless files of a format can hold a row."""
    if kind not in ROW_FORMATS:
        raise CadError(
            f"{path} was asked to hold a row, one blade and its placements, which {kind} files do not keep: write a "
            ".step or a .brep file, or one blade into this one"
        )


def transformation(matrix: Array, shift: Array) -> gp_Trsf:
    """The motion x -> `matrix` x + `shift` [mm], a rotation (3, 3) and a shift (3,)."""
    made = gp_Trsf()
    made.SetValues(*np.hstack([matrix, shift[:, None]]).ravel().tolist())
    return made


def matrix_of(motion: gp_Trsf) -> tuple[Array, Array]:
    """Matrix (3, 3) and shift (3,) [mm] of a motion."""
    values = np.array([[motion.Value(i, j) for j in range(1, 5)] for i in range(1, 4)])
    return values[:, :3], values[:, 3]


def location(placement: Placement) -> TopLoc_Location:
    """Where a placement puts the part; none for the part itself."""
    matrix, shift = np.real(placement.turn), np.real(placement.shift) * MM
    if np.array_equal(matrix, np.eye(3)) and not shift.any():
        return TopLoc_Location()
    return TopLoc_Location(transformation(matrix, shift))


def write_brep_row(row: Row, part: OccSolid, path: str) -> None:
    """Write the placements of a part to a BREP file, which shares its geometry. Raises CadError where that fails."""
    builder, whole = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(whole)
    for placement in row.placements:
        builder.Add(whole, part.solid.Moved(location(placement)))
    if not BRepTools.Write_s(whole, path):
        raise CadError("OpenCASCADE could not write the BREP file: is there space left in that directory?")
