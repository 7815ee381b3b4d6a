"""The nodes of the upper periodic boundary, exactly where the motion takes those of the lower one."""

from collections.abc import Iterable

import numpy as np

from bladewright.errors import MeshError
from bladewright.meshing.library import gmsh


def placed(faces: Iterable[int], motion: tuple[float, ...]) -> None:
    """Move the nodes of periodic faces onto the images of their masters.

    Vertices and edges of a STEP file lie within 1e-7 mm of the surfaces only, and so do gmsh's nodes there. Raises
    MeshError where a node has no master.
    """
    matrix = np.reshape(motion, (4, 4))
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    place = np.zeros((int(tags.max()) + 1, 3))
    place[tags.astype(np.intp)] = coordinates.reshape(-1, 3)
    for face in faces:
        _, nodes, masters, _ = gmsh.model.mesh.getPeriodicNodes(2, face)
        own = gmsh.model.mesh.getNodes(2, face, includeBoundary=True)[0]
        if set(own.tolist()) != set(nodes.tolist()):
            raise MeshError(f"gmsh knows masters of {len(nodes)} of {len(own)} nodes of a periodic boundary only")
        images = place[masters.astype(np.intp)] @ matrix[:3, :3].T + matrix[:3, 3]
        for node, image in zip(nodes.tolist(), images.tolist(), strict=True):
            gmsh.model.mesh.setNode(node, image, [])
