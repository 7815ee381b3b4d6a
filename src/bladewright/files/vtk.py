"""VTK files opened with VTK's own readers, for clouds of points and for the sensitivities of flow solvers."""

from pathlib import Path
from typing import Any

import numpy as np

from bladewright.errors import FileError
from bladewright.nurbs.basis import Reals

XML_READERS = {
    "PolyData": "vtkXMLPolyDataReader",
    "UnstructuredGrid": "vtkXMLUnstructuredGridReader",
    "StructuredGrid": "vtkXMLStructuredGridReader",
}
"""Reader class of VTK for each type of XML file whose points are written out (VTP, VTU, VTS)."""


def read_vtk(path: Path, kind: str | None) -> Any:
    """The data set of an XML file of a type in `XML_READERS`, or of a legacy file (`kind` None).

    None where VTK finds no data set with points in it. VTK's own messages on standard error are switched off, because
    the caller refuses the file in a sentence of its own. Raises FileError where VTK is not installed.
    """
    try:
        from vtkmodules import vtkIOLegacy, vtkIOXML
        from vtkmodules.vtkCommonCore import vtkObject
    except ImportError:
        raise FileError(f"'{path}' needs VTK to be read: install the package vtk, or save the points as CSV") from None
    reader: Any = vtkIOLegacy.vtkGenericDataObjectReader() if kind is None else getattr(vtkIOXML, XML_READERS[kind])()
    reader.SetFileName(str(path))
    warnings_shown = vtkObject.GetGlobalWarningDisplay()
    vtkObject.GlobalWarningDisplayOff()
    try:
        reader.Update()
    finally:
        vtkObject.SetGlobalWarningDisplay(warnings_shown)
    data = reader.GetOutput()
    points = data.GetPoints() if data is not None and hasattr(data, "GetPoints") else None
    return None if reader.GetErrorCode() or points is None or points.GetNumberOfPoints() == 0 else data


def vtk_array(array: Any) -> Reals:
    """An array of VTK (n, k) as a copy of doubles."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return np.array(vtk_to_numpy(array), dtype=np.float64)
