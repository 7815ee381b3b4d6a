"""Volume meshes of passages: the only room that loads gmsh, and that in a process of its own."""

from bladewright.meshing.passage_mesh import check as check
from bladewright.meshing.passage_mesh import mesh as mesh
from bladewright.meshing.report import MeshReport as MeshReport
