"""Nodes on curves, triangles on faces, tetrahedra between: gmsh's algorithms, tried in a stated order."""

from collections.abc import Callable, Iterable

import numpy as np

from bladewright.errors import MeshError
from bladewright.meshing.job import STEP
from bladewright.meshing.library import gmsh

SURFACE = {"Frontal-Delaunay": 6, "Delaunay": 5, "MeshAdapt": 1}
"""In the order in which they are tried. MeshAdapt is slow, and copes with faces whose derivatives jump at a knot."""
VOLUME = {"HXT": 10, "Delaunay": 1, "Frontal": 4}
"""In the order in which they are tried."""
WORST_TRIANGLE = 0.2
"""gamma of the worst triangle of a face below which the next algorithm is tried on that face"""
WORST_TETRAHEDRON = 0.1
"""minSICN of the worst tetrahedron below which the mesh is improved, and then the next algorithm tried"""


def say(step: str) -> None:
    """Tell the parent what is being done."""
    print(STEP + step, flush=True)  # noqa: T201  the process's only way to speak


def curves_meshed() -> None:
    """Put nodes on the curves."""
    say("edges")
    gmsh.model.mesh.generate(1)


def faces_meshed(images: dict[int, int]) -> tuple[str, ...]:
    """Mesh the faces, and say what did; `images` are the periodic faces with those that they follow.

    Each face keeps the algorithm that gave it the best worst triangle. Raises MeshError where none meshes a face.
    """
    say("faces")
    gmsh.option.setNumber("Mesh.MeshOnlyEmpty", 1)
    # images are copied with parameters on their own face, which the kernel's projection takes milliseconds a node for;
    # what gmsh's own finds is near enough, as the nodes themselves are placed exactly in the end
    gmsh.option.setNumber("Geometry.OCCUseGenericClosestPoint", 1)
    free = [tag for _, tag in gmsh.model.getEntities(2) if tag not in images]
    best: dict[int, tuple[float, str]] = {}
    waiting = free
    for name in SURFACE:
        _mesh_faces(waiting, images, dict.fromkeys(waiting, name))
        for tag in waiting:
            best[tag] = max(best.get(tag, (-1.0, name)), (worst_triangle(tag), name))
        waiting = [tag for tag in free if best[tag][0] < WORST_TRIANGLE]
        if not waiting:
            break
    else:
        _mesh_faces(waiting, images, {tag: best[tag][1] for tag in waiting})
    if min(worst for worst, _ in best.values()) < 0.0:
        raise MeshError("gmsh leaves a face without triangles: choose another size")
    return tuple(name for name in SURFACE if name in {used for _, used in best.values()})


def _mesh_faces(tags: Iterable[int], images: dict[int, int], algorithms: dict[int, str]) -> None:
    again = [*tags, *(image for image, master in images.items() if master in set(tags))]
    gmsh.model.mesh.clear([(2, tag) for tag in again])
    for tag, name in algorithms.items():
        gmsh.model.mesh.setAlgorithm(2, tag, SURFACE[name])
    _tried(lambda: gmsh.model.mesh.generate(2))


def worst_triangle(face: int) -> float:
    """The least gamma of a face's triangles; -1 where there are none."""
    _, tags, _ = gmsh.model.mesh.getElements(2, face)
    return float(np.min(gmsh.model.mesh.getElementQualities(tags[0], "gamma"))) if len(tags) else -1.0


def volume_meshed() -> tuple[str, ...]:
    """Fill the volume with tetrahedra, and say what did and what improved them.

    Raises MeshError where no algorithm does.
    """
    used: list[str] = []
    for name, number in VOLUME.items():
        say(f"volume ({name})")
        gmsh.model.mesh.clear(gmsh.model.getEntities(3))
        gmsh.option.setNumber("Mesh.Algorithm3D", number)
        _tried(lambda: gmsh.model.mesh.generate(3))
        if worst_tetrahedron() < -1.0:
            continue
        used = [name]
        for improvement in ("Relocate3D", "Netgen"):
            if worst_tetrahedron() >= WORST_TETRAHEDRON:
                return tuple(used)
            say(f"improving ({improvement})")
            _tried(lambda improvement=improvement: gmsh.model.mesh.optimize(improvement))  # type: ignore[misc]
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


def _tried(work: Callable[[], None]) -> None:
    """Do it; where gmsh gives up, what is missing afterwards says so, and its words are in the output."""
    try:
        work()
    except Exception as error:  # noqa: BLE001  gmsh has no types of errors
        print(error, flush=True)  # noqa: T201
