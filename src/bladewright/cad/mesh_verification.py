"""Writing STL and 3MF files, and measuring them against the native surfaces when they are read again."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from bladewright.atomic_write import atomic_write
from bladewright.cad.deviation import NativeFace, native_face
from bladewright.cad.kernel import quiet
from bladewright.cad.mesh import ClosestTriangle, TriangleMesh, mesh_of_triangles, triangulated
from bladewright.cad.mesh_files import read_3mf, read_stl, write_3mf, write_stl
from bladewright.cad.native_body import MM, NativeBody, extent
from bladewright.cad.reading import format_of
from bladewright.cad.round_trip import Comparison, EdgeReport, FaceReport, RoundTrip, conformance_figures
from bladewright.cad.solids import cached_occ_solid
from bladewright.cad.units import Unit
from bladewright.errors import CadError
from bladewright.numerics.elementary import Array

DEFAULT_DEVIATION = 1e-4
"""Chordal deviation, as a fraction of the body's extent, where none is asked for: 0.01 mm on a blade of 100 mm, fine
enough to view and to print, and still a small file."""
DEFLECTIONS = (0.8, 0.4, 0.2, 0.1, 0.05)
"""Fractions of the chordal deviation that OpenCASCADE is asked for in turn, until the triangles, as measured, keep it:
OpenCASCADE only aims at what it is asked for."""
MOST_SAMPLES = 300_000
"""Most points of all native faces, and as many beside the centres of triangles, at which a mesh is measured: of thirty
faces each has the 10,000 that it would have in any other file, of a wheel's few hundred each about a thousand. A mesh
is the same everywhere, and its limit far above what a single control point could hide."""
BARYCENTRIC_POINTS = np.array(
    [[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4], [1, 1, 0], [0, 1, 1], [1, 0, 1]], dtype=float
)
"""Points of a triangle at which it is measured, in barycentric coordinates not yet divided by their sum: its centre,
three points towards the corners, and the middles of the sides."""


def write_mesh(
    built: NativeBody, path: Path, *, chordal_deviation: float | None, samples: int, unit: Unit = "mm"
) -> RoundTrip:
    """Write an STL or 3MF file with triangles within `chordal_deviation` [m] of the surfaces, and measure it."""
    allowed = DEFAULT_DEVIATION * extent(built) if chordal_deviation is None else chordal_deviation
    if not (np.isfinite(allowed) and allowed > 0.0):
        raise CadError(f"a chordal deviation of {allowed} m was asked for: it must be positive, such as 1e-5")
    with quiet():
        made = cached_occ_solid(built)
        native = {name: native_face(face) for name, face in built.surfaces.items()}
        for share in DEFLECTIONS:
            mesh = triangulated(made, share * allowed * MM, getattr(built, "turned_faces", None))
            # STL files hold single precision
            kept = mesh_of_triangles(mesh.corners.astype(np.float32).astype(np.float64))
            measured = min(samples, MOST_SAMPLES // len(native))
            assigned = _AssignedPoints(kept, native, allowed * MM, measured)
            if assigned.largest <= allowed * MM:
                break
    with atomic_write(path) as unfinished:
        if format_of(path) == "STL":
            write_stl(mesh, unfinished, name=built.name, unit=unit)
        else:
            write_3mf(mesh, unfinished, built=built, unit=unit)
    return verify_mesh(path, built, samples=samples, chordal_deviation=allowed, known=assigned)


def verify_mesh(
    path: Path,
    built: NativeBody,
    *,
    samples: int,
    chordal_deviation: float | None = None,
    known: "_AssignedPoints | None" = None,
) -> RoundTrip:
    """The round trip of an STL or 3MF file against a body, with the chordal deviation [m] as its limit.

    What is `known` of a mesh is taken where the file holds that mesh to the bit.
    """
    kind = format_of(path)
    mesh, unit = read_stl(path) if kind == "STL" else read_3mf(path)
    if not len(mesh.triangles):
        raise CadError(f"{path} holds no triangle: write it again")
    limit = MM * (DEFAULT_DEVIATION * extent(built) if chordal_deviation is None else chordal_deviation)
    properties = built.properties
    # moving the whole surface by the limit changes the volume by this fraction, and areas by at most twice as much
    share = limit * float(properties.area) * MM**2 / (float(properties.volume) * MM**3)
    samples = min(samples, MOST_SAMPLES // len(built.surfaces))
    limits = {"side_mm": limit, "end_mm": limit, "edge_mm": limit, "face_area": 2.0 * share, "volume": share}
    if known is not None and known.of(mesh):
        assigned, native = known, known.native
    else:
        native = {name: native_face(face) for name, face in built.surfaces.items()}
        assigned = _AssignedPoints(mesh, native, limit, samples)
    areas = dict(zip(built.orientations, getattr(properties, "areas", ()), strict=False))
    nearest = ClosestTriangle(mesh)
    failures: list[str] = []
    faces = tuple(_face(name, assigned, nearest, samples, limits, areas, failures) for name in native)
    open_edges, shells = mesh.open_edges, mesh.shells
    if open_edges:
        failures.append(f"{open_edges} edges of triangles are not run once each way: the mesh is not watertight")
    if shells != 1:
        failures.append(f"the file holds {shells} separate shells: one closed body is one shell")
    volume = Comparison(cad=mesh.volume, native=float(properties.volume) * MM**3)
    total = Comparison(cad=float(np.sum(np.linalg.norm(mesh.vectors, axis=-1))), native=float(properties.area) * MM**2)
    for what, compared, allowed in (("volume", volume, share), ("area", total, 2.0 * share)):
        if not compared.relative_error <= allowed:
            failures.append(f"the {what} is off by {compared.relative_error:.3g}: at most {allowed:.3g} is allowed")
    centroid = mesh.centroid, np.asarray(properties.centroid) * MM
    distance = float(np.sqrt(np.sum((centroid[0] - centroid[1]) ** 2)))
    if not distance <= limit:
        failures.append(f"the centroid is {distance:.3g} mm off: at most {limit:.3g} mm is allowed")
    sides = np.linalg.norm(mesh.vertices[mesh.edges[:, 0]] - mesh.vertices[mesh.edges[:, 1]], axis=-1)
    return RoundTrip(
        file=path.name,
        format=kind,
        schema="",
        unit=unit,
        failures=tuple(failures),
        limits=limits,
        solids=int(open_edges == 0),
        shells=shells,
        free_edges=open_edges,
        valid=open_edges == 0,
        faces=faces,
        edges=EdgeReport(count=len(sides) // 2, shortest=float(sides.min()), max_gap=0.0, max_tolerance=0.0),
        volume=volume,
        default_volume=None,
        kernel_faults=None,
        area=total,
        centroid=centroid,
        promises=conformance_figures(built),
    )


def _face(
    name: str,
    assigned: "_AssignedPoints",
    nearest: ClosestTriangle,
    samples: int,
    limits: dict[str, float],
    areas: Mapping[str, float],
    failures: list[str],
) -> FaceReport:
    native, limit = assigned.native[name], limits["side_mm"]
    uv = native.region.samples(samples)
    away = nearest.distance(native.region.points(uv), limit)
    worst = int(np.argmax(away))
    largest, place = float(away[worst]), uv[worst]
    mine = assigned.face_of_point == name
    back = assigned.distance[mine]
    if len(back) and float(back.max()) > largest:
        worst = int(np.argmax(back))
        largest, place = float(back[worst]), assigned.footpoints[mine][worst]
    vectors = assigned.mesh.vectors[assigned.face_of_triangle == name]
    own = float(areas[name]) if name in areas else native.area
    compared = Comparison(cad=float(np.sum(np.linalg.norm(vectors, axis=-1))), native=own * MM**2)
    if not len(back):
        failures.append(f"no triangle of the file lies on {name}")
    if not largest <= limit:
        failures.append(
            f"face {name} is {largest:.3g} mm off at u = {place[0]:.4g}, v = {place[1]:.4g}: at most {limit:.3g} mm is "
            "allowed"
        )
    if not compared.relative_error <= limits["face_area"]:
        failures.append(
            f"face {name} has an area that is off by {compared.relative_error:.3g}: at most {limits['face_area']:.3g} "
            "is allowed"
        )
    return FaceReport(
        name=name,
        samples=samples,
        pieces=1,
        max_deviation=largest,
        mean_deviation=float(np.mean(np.concatenate([away, back]))),
        worst=(float(place[0]), float(place[1])),
        area=compared,
    )


class _AssignedPoints:
    """The centres of all triangles and more points on the largest, each projected to the nearest native face."""

    def __init__(self, mesh: TriangleMesh, native: dict[str, NativeFace], limit: float, samples: int) -> None:
        self.mesh, self.native = mesh, native
        corners = mesh.corners
        longest = np.max(np.sum((np.roll(corners, -1, axis=1) - corners) ** 2, axis=-1), axis=1)
        largest = np.argsort(-longest)[: max(1, samples * len(native) // (len(BARYCENTRIC_POINTS) - 1))]
        weights = BARYCENTRIC_POINTS / BARYCENTRIC_POINTS.sum(axis=1, keepdims=True)
        more = np.einsum("pk,mkd->mpd", weights[1:], corners[largest]).reshape(-1, 3)
        points = np.concatenate([corners.mean(axis=1), more])
        names = np.array(list(native))
        # the nearest seed says which face is near; points that prove far from it are tried on the other faces
        owners = np.concatenate([np.full(len(m.projection.uv), k) for k, m in enumerate(native.values())])
        seeds = np.concatenate([m.region.points(m.projection.uv) for m in native.values()])
        guess = owners[cKDTree(seeds).query(points)[1]]
        self.distance = np.full(len(points), np.inf)
        self.footpoints = np.zeros((len(points), 2))
        label = guess.copy()
        for k, face in enumerate(native.values()):
            mine = np.flatnonzero(guess == k)
            self._project(face, k, points, mine, limit, label)
        doubtful = np.flatnonzero(self.distance > 0.5 * limit)
        for k, face in enumerate(native.values()):
            others = doubtful[guess[doubtful] != k]
            # most faces of a wheel are too far away to be nearer
            others = others[face.projection.least_distance(points[others]) < self.distance[others]]
            self._project(face, k, points, others, np.inf, label)
        self.face_of_point: Any = names[label]
        # a triangle belongs to the face that its centre is nearest to
        self.face_of_triangle: Any = self.face_of_point[: len(corners)]

    def _project(self, face: NativeFace, k: int, points: Array, mine: Array, limit: float, label: Array) -> None:
        if len(mine) == 0:
            return
        footpoints, away = face.projection.closest(points[mine], limit)
        better = away < self.distance[mine]
        self.distance[mine[better]], self.footpoints[mine[better]] = away[better], footpoints[better]
        label[mine[better]] = k

    def of(self, mesh: TriangleMesh) -> bool:
        """Whether these points are those of a mesh, to the bit."""
        mine = self.mesh
        return np.array_equal(mine.vertices, mesh.vertices) and np.array_equal(mine.triangles, mesh.triangles)

    @property
    def largest(self) -> float:
        """[mm] largest distance of the triangles from the native faces."""
        return float(self.distance.max())
