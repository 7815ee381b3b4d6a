"""The current mesh of gmsh as a file."""

from pathlib import Path

from bladewright.meshing.library import gmsh
from bladewright.meshing.native import motionless, rescaled, rewritten


def written(path: Path, scale: float) -> None:
    """Write the current mesh to a path, by its ending, with lengths times `scale`.

    Other formats than gmsh's own are written from that one, in which all lengths can be scaled.
    """
    native = path.with_suffix(".msh")
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.option.setNumber("Mesh.Binary", 0)
    gmsh.option.setNumber("Mesh.ScalingFactor", scale)
    gmsh.write(str(native))
    gmsh.option.setNumber("Mesh.ScalingFactor", 1.0)
    if scale != 1.0:
        rewritten(native, lambda lines: rescaled(lines, scale))
    if native != path:
        # CGNS holds periodic motions in single precision, and gmsh then moves the nodes by them when it reads the file
        rewritten(native, motionless)
        gmsh.clear()
        gmsh.open(str(native))
        _name_entities()
        gmsh.write(str(path))


def _name_entities() -> None:
    """Give faces and volume the names of their groups, by which CGNS calls its boundary conditions."""
    for dimension, group in gmsh.model.getPhysicalGroups():
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, group):
            gmsh.model.setEntityName(dimension, entity, gmsh.model.getPhysicalName(dimension, group))
