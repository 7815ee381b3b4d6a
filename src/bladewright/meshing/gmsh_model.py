"""A STEP file in gmsh, unrepaired: its faces by name, its periodic boundaries, and the element sizes."""

from collections.abc import Mapping

import numpy as np

from bladewright.errors import MeshError
from bladewright.meshing.gmsh_process import Job
from bladewright.meshing.lazy_gmsh import gmsh
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
"""Options under which the geometry is read as it is."""
QUIET = {"General.Terminal": 1, "General.AbortOnError": 0, "General.NumThreads": 1}
"""Options of the process: one thread, so that the same input gives the same mesh, and output for the parent to read."""
CURVE_SAMPLES, FACE_SAMPLES = 400, 60
"""Points on a curve, and points each way on a face, from which gmsh measures the distance to a source of sizes. They
must lie closer together than the smallest elements, or sizes vary between them; gmsh compares every node with each of
them."""

Faces = dict[str, int]
"""Tags of faces by name."""
Place = tuple[float, float, float]
"""Coordinates [mm]."""


def set_options(values: Mapping[str, float]) -> None:
    """Set numeric options of gmsh."""
    for name, value in values.items():
        gmsh.option.setNumber(name, value)


def open_step(job: Job) -> Faces:
    """Read the job's STEP file into a new model and return its faces. Raises MeshError where it is not one solid."""
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
    """Make the meshes of the upper periodic faces copies of the lower ones; return the tags, upper to lower."""
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
    """Set the element size at every point: it grows with the distance from the job's sources."""
    field = gmsh.model.mesh.field
    fields = []
    for source in job.sources:
        distance = field.add("Distance")
        if source.face:
            pieces = [tag for name, tag in faces.items() if group_of(name) == source.face]
            field.setNumbers(distance, "SurfacesList", pieces)
        else:
            field.setNumbers(distance, "CurvesList", [_curve_at(source.place, faces)])
        field.setNumber(distance, "Sampling", FACE_SAMPLES if source.face else CURVE_SAMPLES)
        size = field.add("Threshold")
        values = {
            "InField": distance,
            "SizeMin": source.size,
            "SizeMax": job.largest,
            "DistMin": 0.0,
            "DistMax": (job.largest - source.size) / job.growth,
        }
        for name, value in values.items():
            field.setNumber(size, name, value)
        fields.append(size)
    if fields:
        smallest = field.add("Min")
        field.setNumbers(smallest, "FieldsList", fields)
        field.setAsBackgroundMesh(smallest)
    set_options(
        {
            "Mesh.MeshSizeMax": job.largest,
            "Mesh.MeshSizeMin": 0.5 * job.smallest,
            "Mesh.MeshSizeExtendFromBoundary": 0,
            "Mesh.MeshSizeFromPoints": 0,
        }
    )


def _curve_at(place: Place, faces: Faces) -> int:
    """The curve between two faces of the blade whose middle is the nearest to a place [mm]."""
    count: dict[int, int] = {}
    for name, tag in faces.items():
        if name.startswith("blade"):
            for _, curve in gmsh.model.getBoundary([(2, tag)], oriented=False):
                count[abs(curve)] = count.get(abs(curve), 0) + 1
    shared = [curve for curve, times in count.items() if times > 1]
    if not shared:
        raise MeshError("the blade's faces share no curve in the STEP file: export the passage as one closed solid")
    return min(shared, key=lambda curve: _squared_distance(curve, place))


def _squared_distance(curve: int, place: Place) -> float:
    low, high = gmsh.model.getParametrizationBounds(1, curve)
    middle = np.array(gmsh.model.getValue(1, curve, [0.5 * (low[0] + high[0])]))
    return float(np.sum((middle - np.array(place)) ** 2))
