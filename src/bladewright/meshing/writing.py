"""The current mesh of gmsh as a file."""

from pathlib import Path

from bladewright.meshing.library import gmsh
from bladewright.meshing.rescaling import rescaled_file


def written(path: Path, scale: float) -> None:
    """Write the current mesh to a path, by its ending, with lengths times `scale`.

    Other formats are written from gmsh's own file in the new unit, as gmsh scales nothing but the nodes.
    """
    native = path.with_suffix(".msh")
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.option.setNumber("Mesh.Binary", 0)
    gmsh.option.setNumber("Mesh.ScalingFactor", scale)
    gmsh.write(str(native))
    if scale != 1.0:
        rescaled_file(native, scale)
    if native != path:
        gmsh.option.setNumber("Mesh.ScalingFactor", 1.0)
        gmsh.clear()
        gmsh.open(str(native))
        gmsh.write(str(path))
