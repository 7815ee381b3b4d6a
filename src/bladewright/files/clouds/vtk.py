"""Points of VTK files, legacy and XML."""

from pathlib import Path

from bladewright.errors import FileError
from bladewright.files.clouds.cloud import Columns
from bladewright.files.vtk import XML_READERS, read_vtk, vtk_array


def read_vtk_points(path: Path, data: bytes) -> Columns:
    """The points; raises FileError where VTK cannot read them."""
    kind = None
    if b"<VTKFile" in data[:4096]:
        kind = next((name for name in XML_READERS if f'type="{name}"'.encode() in data[:4096]), None)
        if kind is None:
            known = ", ".join(XML_READERS)
            raise FileError(f"'{path}' is a VTK file of a type without points of its own: {known} are read")
    grid = read_vtk(path, kind)
    if grid is None:
        raise FileError(f"'{path}' is a VTK file without points, or not whole: has its writer finished?")
    return Columns(values=vtk_array(grid.GetPoints().GetData()), format="a VTK file", columns=("x", "y", "z"))
