"""Nodes on curves, triangles on faces, tetrahedra between: gmsh's algorithms, tried in a fixed order."""

from collections.abc import Callable, Iterable

import numpy as np

from bladewright.errors import MeshError
from bladewright.meshing.gmsh_process import STEP_PREFIX
from bladewright.meshing.lazy_gmsh import gmsh

SURFACE = {"Frontal-Delaunay": 6, "Delaunay": 5, "MeshAdapt": 1}
"""gmsh's numbers of the algorithms for faces, in the order in which they are tried. MeshAdapt is slow, but copes with
faces whose derivatives jump at a knot."""
VOLUME = {"HXT": 10, "Delaunay": 1, "Frontal": 4}
"""gmsh's numbers of the algorithms for the volume, in the order in which they are tried. The first fills every built-in
example (design/meshes.md)."""
WORST_TRIANGLE = 0.2
"""Shape measure gamma of the worst triangle of a face (1 equilateral, 0 flat) below which the next algorithm is tried
on that face. A higher limit costs further attempts, a lower one leaves slender triangles for the volume to start
from. Most built-in examples need a second algorithm on some face (design/meshes.md)."""
WORST_TETRAHEDRON = 0.1
"""minSICN of the worst tetrahedron (1 regular, 0 flat) below which the mesh is improved, and then the next algorithm
tried. A higher limit costs further attempts, a lower one leaves elements on which flow solvers converge badly.
Every built-in example reaches 0.17 without improvement (design/meshes.md)."""


def report_step(step: str) -> None:
    """Tell the parent process what is being done."""
    print(STEP_PREFIX + step, flush=True)  # noqa: T201  the parent reads standard output


def mesh_curves() -> None:
    """Put nodes on the curves."""
    report_step("edges")
    gmsh.model.mesh.generate(1)


def mesh_faces(images: dict[int, int]) -> tuple[str, ...]:
    """Mesh the faces, and return the names of the algorithms that did.

    `images` are the periodic faces, each with the one whose mesh it copies. Each face keeps the algorithm whose worst
    triangle is the best. Raises MeshError where no algorithm meshes a face.
    """
    report_step("faces")
    gmsh.option.setNumber("Mesh.MeshOnlyEmpty", 1)
    # Copied nodes need parameters on their own face. OpenCASCADE's projection takes milliseconds a node for them. That
    # of gmsh is less exact, which does not matter, as the nodes are moved to their exact places afterwards.
    gmsh.option.setNumber("Geometry.OCCUseGenericClosestPoint", 1)
    free = [tag for _, tag in gmsh.model.getEntities(2) if tag not in images]
    best: dict[int, tuple[float, str]] = {}
    remaining = free
    for name in SURFACE:
        _generate_faces(remaining, images, dict.fromkeys(remaining, name))
        for tag in remaining:
            best[tag] = max(best.get(tag, (-1.0, name)), (worst_triangle(tag), name))
        remaining = [tag for tag in free if best[tag][0] < WORST_TRIANGLE]
        if not remaining:
            break
    else:
        _generate_faces(remaining, images, {tag: best[tag][1] for tag in remaining})
    if min(worst for worst, _ in best.values()) < 0.0:
        raise MeshError("gmsh leaves a face without triangles: choose another size")
    return tuple(name for name in SURFACE if name in {used for _, used in best.values()})


def _generate_faces(tags: Iterable[int], images: dict[int, int], algorithms: dict[int, str]) -> None:
    cleared = [*tags, *(image for image, master in images.items() if master in set(tags))]
    gmsh.model.mesh.clear([(2, tag) for tag in cleared])
    for tag, name in algorithms.items():
        gmsh.model.mesh.setAlgorithm(2, tag, SURFACE[name])
    _attempt(lambda: gmsh.model.mesh.generate(2))


def worst_triangle(face: int) -> float:
    """The least gamma of a face's triangles; -1 where the face has none."""
    _, tags, _ = gmsh.model.mesh.getElements(2, face)
    return float(np.min(gmsh.model.mesh.getElementQualities(tags[0], "gamma"))) if len(tags) else -1.0


def mesh_volume() -> tuple[str, ...]:
    """Fill the volume with tetrahedra, and return the names of what made and improved them.

    Raises MeshError where no algorithm fills it.
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
    """The least minSICN of the tetrahedra; -2 where there are none."""
    _, tags, _ = gmsh.model.mesh.getElements(3)
    return float(np.min(gmsh.model.mesh.getElementQualities(tags[0], "minSICN"))) if len(tags) else -2.0


def _attempt(work: Callable[[], None]) -> None:
    """Do the work. Where gmsh gives up, its message goes to the output, and the caller finds elements missing."""
    try:
        work()
    except Exception as error:  # noqa: BLE001  gmsh has no types of errors
        print(error, flush=True)  # noqa: T201


def place_periodic_nodes(faces: Iterable[int], motion: tuple[float, ...]) -> None:
    """Move the nodes of periodic faces to the images of their masters under the motion.

    Vertices and edges of a STEP file lie only within 1e-7 mm of the surfaces, and so do gmsh's nodes on them. Raises
    MeshError where a node has no master.
    """
    matrix = np.reshape(motion, (4, 4))
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    points = np.zeros((int(tags.max()) + 1, 3))
    points[tags.astype(np.intp)] = coordinates.reshape(-1, 3)
    for face in faces:
        _, nodes, masters, _ = gmsh.model.mesh.getPeriodicNodes(2, face)
        own = gmsh.model.mesh.getNodes(2, face, includeBoundary=True)[0]
        if set(own.tolist()) != set(nodes.tolist()):
            raise MeshError(f"gmsh knows masters of {len(nodes)} of {len(own)} nodes of a periodic boundary only")
        images = points[masters.astype(np.intp)] @ matrix[:3, :3].T + matrix[:3, 3]
        for node, image in zip(nodes.tolist(), images.tolist(), strict=True):
            gmsh.model.mesh.setNode(node, image, [])
