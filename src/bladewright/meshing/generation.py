"""Nodes on curves, triangles on faces, tetrahedra between: gmsh's algorithms, tried in a fixed order."""

from collections.abc import Callable, Iterable

import numpy as np

from bladewright.errors import MeshError
from bladewright.meshing.gmsh_process import STEP_PREFIX
from bladewright.meshing.library import gmsh

SURFACE = {"Frontal-Delaunay": 6, "Delaunay": 5, "MeshAdapt": 1}
"""In the order in which they are tried. MeshAdapt is slow, and copes with faces whose derivatives jump at a knot."""
VOLUME = {"HXT": 10, "Delaunay": 1, "Frontal": 4}
"""In the order in which they are tried."""
WORST_TRIANGLE = 0.2
"""gamma of the worst triangle of a face below which the next algorithm is tried on that face"""
WORST_TETRAHEDRON = 0.1
"""minSICN of the worst tetrahedron below which the mesh is improved, and then the next algorithm tried"""


def report_step(step: str) -> None:
    """Tell the parent what is being done."""
    print(STEP_PREFIX + step, flush=True)  # noqa: T201  the process's only way to speak


def mesh_curves() -> None:
    """Put nodes on the curves."""
    report_step("edges")
    gmsh.model.mesh.generate(1)


def mesh_faces(images: dict[int, int]) -> tuple[str, ...]:
    """Mesh the faces, and say what did; `images` are the periodic faces with those that they follow.

    Each face keeps the algorithm that gave it the best worst triangle. Raises MeshError where none meshes a face.
    """
    report_step("faces")
    gmsh.option.setNumber("Mesh.MeshOnlyEmpty", 1)
    # images are copied with parameters on their own face, which the kernel's projection takes milliseconds a node for;
    # what gmsh's own finds is near enough, as the nodes themselves are placed exactly in the end
    gmsh.option.setNumber("Geometry.OCCUseGenericClosestPoint", 1)
    free = [tag for _, tag in gmsh.model.getEntities(2) if tag not in images]
    best: dict[int, tuple[float, str]] = {}
    waiting = free
    for name in SURFACE:
        _generate_faces(waiting, images, dict.fromkeys(waiting, name))
        for tag in waiting:
            best[tag] = max(best.get(tag, (-1.0, name)), (worst_triangle(tag), name))
        waiting = [tag for tag in free if best[tag][0] < WORST_TRIANGLE]
        if not waiting:
            break
    else:
        _generate_faces(waiting, images, {tag: best[tag][1] for tag in waiting})
    if min(worst for worst, _ in best.values()) < 0.0:
        raise MeshError("gmsh leaves a face without triangles: choose another size")
    return tuple(name for name in SURFACE if name in {used for _, used in best.values()})


def _generate_faces(tags: Iterable[int], images: dict[int, int], algorithms: dict[int, str]) -> None:
    again = [*tags, *(image for image, master in images.items() if master in set(tags))]
    gmsh.model.mesh.clear([(2, tag) for tag in again])
    for tag, name in algorithms.items():
        gmsh.model.mesh.setAlgorithm(2, tag, SURFACE[name])
    _attempt(lambda: gmsh.model.mesh.generate(2))


def worst_triangle(face: int) -> float:
    """The least gamma of a face's triangles; -1 where there are none."""
    _, tags, _ = gmsh.model.mesh.getElements(2, face)
    return float(np.min(gmsh.model.mesh.getElementQualities(tags[0], "gamma"))) if len(tags) else -1.0


def mesh_volume() -> tuple[str, ...]:
    """Fill the volume with tetrahedra, and say what did and what improved them.

    Raises MeshError where no algorithm does.
    """
    used: list[str] = []
    for name, number in VOLUME.items():
        report_step(f"volume ({name})")
        gmsh.model.mesh.clear(gmsh.model.getEntities(3))
        gmsh.option.setNumber("Mesh.Algorithm3D", number)
        _attempt(lambda: gmsh.model.mesh.generate(3))
        if worst_tetrahedron() < -1.0:
            continue
        used = [name]
        for improvement in ("Relocate3D", "Netgen"):
            if worst_tetrahedron() >= WORST_TETRAHEDRON:
                return tuple(used)
            report_step(f"improving ({improvement})")
            _attempt(lambda improvement=improvement: gmsh.model.mesh.optimize(improvement))  # type: ignore[misc]
            used.append(improvement)
        if worst_tetrahedron() >= WORST_TETRAHEDRON:
            return tuple(used)
    if worst_tetrahedron() < -1.0:
        raise MeshError("gmsh cannot fill the passage with tetrahedra: choose another size")
    return tuple(used)


def worst_tetrahedron() -> float:
    """The least minSICN of all tetrahedra; -2 where there are none."""
    _, tags, _ = gmsh.model.mesh.getElements(3)
    return float(np.min(gmsh.model.mesh.getElementQualities(tags[0], "minSICN"))) if len(tags) else -2.0


def _attempt(work: Callable[[], None]) -> None:
    """Do it; where gmsh gives up, what is missing afterwards says so, and its words are in the output."""
    try:
        work()
    except Exception as error:  # noqa: BLE001  gmsh has no types of errors
        print(error, flush=True)  # noqa: T201


def place_periodic_nodes(faces: Iterable[int], motion: tuple[float, ...]) -> None:
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
