"""Points and their sensitivities in a VTU file, as ParaView reads it; VTK comes with OpenCASCADE's wheels."""

from pathlib import Path
from typing import Any

import numpy as np

from bladewright.errors import FileError
from bladewright.nurbs.basis import Reals

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
