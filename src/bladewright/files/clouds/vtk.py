"""Points of VTK files, legacy and XML; VTK comes with OpenCASCADE's wheels."""

from pathlib import Path
from typing import Any

import numpy as np

from bladewright.errors import FileError
from bladewright.files.clouds.cloud import Columns

_XML = {
    b"PolyData": "vtkXMLPolyDataReader",
    b"UnstructuredGrid": "vtkXMLUnstructuredGridReader",
    b"StructuredGrid": "vtkXMLStructuredGridReader",
}


def read_vtk(path: Path, data: bytes) -> Columns:
    """The points; raises FileError where VTK cannot read them."""
    try:
        from vtkmodules import vtkIOLegacy, vtkIOXML
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkCommonCore import vtkObject
    except ImportError:
        raise FileError(f"'{path}' needs VTK to be read: install the package vtk, or save the points as CSV") from None
    if b"<VTKFile" in data[:4096]:
        kind = next((name for name in _XML if b'type="' + name + b'"' in data[:4096]), None)
        if kind is None:
            known = ", ".join(name.decode() for name in _XML)
            raise FileError(f"'{path}' is a VTK file of a type without points of its own: {known} are read")
        reader: Any = getattr(vtkIOXML, _XML[kind])()
    else:
        reader = vtkIOLegacy.vtkGenericDataObjectReader()
    reader.SetFileName(str(path))
    shown = vtkObject.GetGlobalWarningDisplay()
    vtkObject.GlobalWarningDisplayOff()
    try:
        reader.Update()
    finally:
        vtkObject.SetGlobalWarningDisplay(shown)
    grid: Any = reader.GetOutput()
    points = grid.GetPoints() if grid is not None and hasattr(grid, "GetPoints") else None
    if reader.GetErrorCode() or points is None or points.GetNumberOfPoints() == 0:
        raise FileError(f"'{path}' is a VTK file without points, or not whole: has its writer finished?")
    values = np.array(vtk_to_numpy(points.GetData()), dtype=np.float64)
    return Columns(values=values, format="a VTK file", columns=("x", "y", "z"))
