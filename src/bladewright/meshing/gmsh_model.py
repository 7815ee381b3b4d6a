"""A STEP file in gmsh, unrepaired: its faces by name, periodic boundaries, and element sizes."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from bladewright.errors import MeshError
from bladewright.meshing.gmsh_process import Job, SizeSource
from bladewright.meshing.library import gmsh
from bladewright.meshing.names import FLUID, group_of

NO_REPAIR = {
    "Geometry.OCCFixDegenerated": 0,
    "Geometry.OCCFixSmallEdges": 0,
    "Geometry.OCCFixSmallFaces": 0,
    "Geometry.OCCSewFaces": 0,
    "Geometry.OCCMakeSolids": 0,
    "Geometry.OCCAutoFix": 0,
    "Geometry.OCCImportLabels": 1,
}
"""The geometry is read without repair."""
QUIET = {"General.Terminal": 1, "General.AbortOnError": 0, "General.NumThreads": 1}
"""One thread, so that the same input gives the same mesh; the output is the parent's."""
SAMPLES_OF_CURVE, SAMPLES_OF_FACE = 400, 60
"""points of a curve, and each way on a face, from which distances are taken"""

Faces = dict[str, int]
"""tags of faces by name"""


def set_options(values: Mapping[str, float]) -> None:
    """Set options of gmsh."""
    for name, value in values.items():
        gmsh.option.setNumber(name, value)


def open_step(job: Job) -> Faces:
    """The faces of the job's STEP file, which becomes the current model. Raises MeshError where it is not one solid."""
    set_options(NO_REPAIR)
    gmsh.model.add("passage")
    gmsh.model.occ.importShapes(job.step)
    gmsh.model.occ.synchronize()
    tags = [tag for _, tag in gmsh.model.getEntities(2)]
    solids = len(gmsh.model.getEntities(3))
    if solids != 1 or len(tags) != len(job.faces):
        raise MeshError(
            f"gmsh finds {solids} solids and {len(tags)} faces in the STEP file, which names {len(job.faces)} faces: "
            "one solid is needed whose faces are all read"
        )
    return dict(zip(job.faces, tags, strict=True))


def set_periodic(job: Job, faces: Faces) -> dict[int, int]:
    """The tags of the upper periodic faces with those of the lower ones, of whose meshes theirs become images."""
    pairs = {
        tag: faces[name.replace("periodic_upper", "periodic_lower")]
        for name, tag in faces.items()
        if group_of(name) == "periodic_upper"
    }
    gmsh.model.mesh.setPeriodic(2, list(pairs), list(pairs.values()), list(job.motion))
    return pairs


def name_groups(faces: Faces) -> None:
    """Make physical groups of the faces and of the volume."""
    groups: dict[str, list[int]] = {}
    for name, tag in faces.items():
        groups.setdefault(group_of(name), []).append(tag)
    for group, tags in groups.items():
        gmsh.model.addPhysicalGroup(2, tags, name=group)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name=FLUID)


def set_sizes(job: Job, faces: Faces) -> None:
    """Set the size at every point: it grows with the distance from the job's curves and faces."""
    field = gmsh.model.mesh.field
    grown = []
    for near in job.near:
        distance = field.add("Distance")
        kind, tag = ("SurfacesList", faces[near.face]) if near.face else ("CurvesList", _curve_at(near, faces))
        field.setNumbers(distance, kind, [tag])
        field.setNumber(distance, "Sampling", SAMPLES_OF_FACE if near.face else SAMPLES_OF_CURVE)
        size = field.add("Threshold")
        values = {
            "InField": distance,
            "SizeMin": near.size,
            "SizeMax": job.largest,
            "DistMin": 0.0,
            "DistMax": (job.largest - near.size) / job.growth,
        }
        for name, value in values.items():
            field.setNumber(size, name, value)
        grown.append(size)
    if grown:
        smallest = field.add("Min")
        field.setNumbers(smallest, "FieldsList", grown)
        field.setAsBackgroundMesh(smallest)
    set_options(
        {
            "Mesh.MeshSizeMax": job.largest,
            "Mesh.MeshSizeMin": 0.5 * job.smallest,
            "Mesh.MeshSizeExtendFromBoundary": 0,
            "Mesh.MeshSizeFromPoints": 0,
        }
    )


def _curve_at(near: SizeSource, faces: Faces) -> int:
    """The curve between the blade's faces whose middle is the nearest to a place."""
    count: dict[int, int] = {}
    for name, tag in faces.items():
        if name.startswith("blade"):
            for _, curve in gmsh.model.getBoundary([(2, tag)], oriented=False):
                count[abs(curve)] = count.get(abs(curve), 0) + 1
    shared = [curve for curve, times in count.items() if times > 1]
    if not shared:
        raise MeshError("the blade's faces share no curve in the STEP file: export the passage as one closed solid")
    return min(shared, key=lambda curve: _distance(curve, near.place))


def _distance(curve: int, place: Any) -> float:
    low, high = gmsh.model.getParametrizationBounds(1, curve)
    middle = np.array(gmsh.model.getValue(1, curve, [0.5 * (low[0] + high[0])]))
    return float(np.sum((middle - np.array(place)) ** 2))
