"""Triangle meshes of solids: their volume and area, whether they are closed, and distances from them."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.TopAbs import TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Compound, TopoDS_Face
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from bladewright.cad.solids import OccSolid
from bladewright.errors import CadError
from bladewright.numerics.elementary import Array

ANGULAR_DEFLECTION = 0.35
"""[rad] Largest angle between the normals of neighbouring triangles that OpenCASCADE aims at: 20 deg, so that an edge
of the blade is round to the eye even where the chordal deviation would allow a few triangles."""
NEIGHBOURS = 12
"""Triangles with the nearest centres that are tried for the nearest one to a point. Those that end up beyond the limit
are searched again more widely, so that the number only trades time."""
MERGED = 1e-6
"""[mm] Grid to which nodes are rounded before equal ones are merged: on a shared edge both faces have the same nodes,
up to rounding errors of the curve."""
Turned = tuple[str, Array]
"""The face of which another is a copy, and the rotation (3, 3) from it to that."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TriangleMesh:
    """Triangles in millimetres that share their vertices."""

    vertices: Array
    """(n, 3) [mm]"""
    triangles: NDArray[np.int64]
    """(m, 3) indices of vertices, counter-clockwise seen from outside"""

    @cached_property
    def corners(self) -> Array:
        """(m, 3, 3) [mm] corners of the triangles."""
        return self.vertices[self.triangles]

    @cached_property
    def vectors(self) -> Array:
        """(m, 3) [mm^2] area vectors of the triangles."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        return 0.5 * np.cross(b - a, c - a)

    @property
    def volume(self) -> float:
        """Enclosed volume [mm^3]."""
        return float(np.sum(self.corners.mean(axis=1) * self.vectors) / 3.0)

    @property
    def centroid(self) -> Array:
        """(3,) [mm] of the volume."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        parts = np.sum(a * np.cross(b, c), axis=-1) / 6.0
        return np.sum(parts[:, None] * (a + b + c) / 4.0, axis=0) / np.sum(parts)

    @property
    def edges(self) -> NDArray[np.int64]:
        """(3 m, 2) directed edges."""
        return np.concatenate([self.triangles[:, [k, (k + 1) % 3]] for k in range(3)])

    @property
    def open_edges(self) -> int:
        """Number of edges that are not shared by two triangles that run opposite ways along them."""
        size = len(self.vertices)
        run = self.edges[:, 0] * size + self.edges[:, 1]
        back = self.edges[:, 1] * size + self.edges[:, 0]
        _, counts = np.unique(run, return_counts=True)
        return int(np.sum(~np.isin(run, back)) + np.sum(counts > 1))

    @property
    def shells(self) -> int:
        """Number of connected pieces."""
        size = len(self.vertices)
        graph = coo_array((np.ones(len(self.edges)), self.edges.T), shape=(size, size))
        _, labels = connected_components(graph, directed=False)
        return len(np.unique(labels[self.triangles[:, 0]]))


def mesh_of_triangles(corners: Array, tolerance: float = 0.0) -> TriangleMesh:
    """The mesh of separate triangles (m, 3, 3): equal vertices are merged, and degenerate triangles left out."""
    points = corners.reshape(-1, 3)
    if tolerance:
        points = np.round(points / tolerance) * tolerance
    vertices, index = np.unique(points, axis=0, return_inverse=True)
    triangles = index.reshape(-1, 3)
    a, b, c = triangles.T
    return TriangleMesh(vertices=vertices, triangles=triangles[(a != b) & (b != c) & (c != a)])


def triangulated(body: OccSolid, deflection: float, turned: Mapping[str, Turned] | None = None) -> TriangleMesh:
    """OpenCASCADE's triangulation of a solid, with a chordal deviation [mm] that it only aims at.

    Faces that are another one `turned` take its triangles. On edges between these and other faces nodes fall together,
    as edges that are copies are parted alike; should they not, all faces are triangulated.
    """
    if turned:
        mesh = _triangles(body, deflection, turned)
        if mesh.open_edges == 0:
            return mesh
    return _triangles(body, deflection, {})


def _triangles(body: OccSolid, deflection: float, turned: Mapping[str, Turned]) -> TriangleMesh:
    BRepTools.Clean_s(body.solid)
    own, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(own)
    for name, face in body.faces.items():
        if name not in turned:
            builder.Add(own, face)
    BRepMesh_IncrementalMesh(own, deflection, False, ANGULAR_DEFLECTION, False)
    found = {name: _corners(face, name, deflection) for name, face in body.faces.items() if name not in turned}
    found |= {name: found[first] @ turn.T for name, (first, turn) in turned.items()}
    BRepTools.Clean_s(body.solid)
    return mesh_of_triangles(np.concatenate([found[name] for name in body.faces]), tolerance=MERGED)


def _corners(face: TopoDS_Face, name: str, deflection: float) -> Array:
    """(m, 3, 3) [mm] corners of the triangles of a face."""
    triangulation = BRep_Tool.Triangulation_s(face, TopLoc_Location())
    if triangulation is None:
        raise CadError(f"OpenCASCADE could not triangulate face {name!r} within {deflection:.3g} mm")
    nodes = (triangulation.Node(i) for i in range(1, triangulation.NbNodes() + 1))
    points = np.array([(p.X(), p.Y(), p.Z()) for p in nodes])
    triangles = np.array([triangulation.Triangle(i).Get() for i in range(1, triangulation.NbTriangles() + 1)]) - 1
    return np.asarray(points[triangles[:, ::-1] if face.Orientation() == TopAbs_REVERSED else triangles])


class ClosestTriangle:
    """Distances of points from the nearest triangle of a mesh."""

    def __init__(self, mesh: TriangleMesh) -> None:
        self.mesh = mesh
        size = float(np.ptp(mesh.vertices, axis=0).max()) / 100.0
        self.pieces, self.owner = _split(mesh.corners, size)
        self.tree = cKDTree(self.pieces.mean(axis=1))

    @cached_property
    def _by_size(self) -> list[tuple[cKDTree, NDArray[np.int64]]]:
        """Search trees of the centres of pieces of about the same size, each with the triangles of its pieces."""
        longest = np.max(np.linalg.norm(np.roll(self.pieces, -1, axis=1) - self.pieces, axis=-1), axis=1)
        level = np.floor(np.log2(longest.max() / np.maximum(longest, 1e-300))).astype(np.int64)
        groups = [np.flatnonzero(level == each) for each in np.unique(level)]
        return [(cKDTree(self.pieces[group].mean(axis=1)), self.owner[group]) for group in groups]

    def distance(self, points: Array, limit: float) -> Array:
        """Distances (n,) [mm] of points (n, 3).

        Those above `limit` [mm] are searched again among the nearest triangles of every size: where large and small
        triangles meet, the nearest centres are all of small ones.
        """
        away = self._among(points, self.tree, self.owner, NEIGHBOURS)
        doubtful = np.flatnonzero(away > limit)
        for tree, owner in self._by_size if len(doubtful) else ():
            found = self._among(points[doubtful], tree, owner, 4 * NEIGHBOURS)
            away[doubtful] = np.minimum(away[doubtful], found)
        return away

    def _among(self, points: Array, tree: cKDTree, owner: NDArray[np.int64], count: int) -> Array:
        _, near = tree.query(points, k=min(count, len(owner)))
        corners = self.mesh.corners[owner[near.reshape(len(points), -1)]]
        return np.min(_to_triangle(points[:, None, :], corners), axis=1)


def _split(corners: Array, size: float) -> tuple[Array, NDArray[np.int64]]:
    """The triangles split until no side is longer than `size`: pieces (k, 3, 3), and the triangle each belongs to."""
    owner = np.arange(len(corners))
    done, owners = [], []
    while len(corners):
        sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=-1)
        small = sides.max(axis=1) <= size
        done.append(corners[small])
        owners.append(owner[small])
        corners, owner, longest = corners[~small], owner[~small], np.argmax(sides[~small], axis=1)
        row = np.arange(len(corners))
        start, end, other = (corners[row, (longest + k) % 3] for k in range(3))
        middle = 0.5 * (start + end)
        corners = np.concatenate([np.stack([start, middle, other], axis=1), np.stack([middle, end, other], axis=1)])
        owner = np.concatenate([owner, owner])
    return np.concatenate(done), np.concatenate(owners)


def _to_triangle(points: Array, corners: Array) -> Array:
    """Distances of points (..., 3) from triangles (..., 3, 3)."""
    a, b, c = np.moveaxis(corners, -2, 0)
    normal = np.cross(b - a, c - a)
    square = np.maximum(np.sum(normal * normal, axis=-1), 1e-300)
    height = np.sum((points - a) * normal, axis=-1)
    inside = np.ones(height.shape, dtype=bool)
    nearest = np.full(height.shape, np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        side, arm = end - start, points - start
        inside &= np.sum(np.cross(side, arm) * normal, axis=-1) >= 0.0
        share = np.clip(np.sum(arm * side, axis=-1) / np.maximum(np.sum(side * side, axis=-1), 1e-300), 0.0, 1.0)
        nearest = np.minimum(nearest, np.sum((arm - share[..., None] * side) ** 2, axis=-1))
    return np.sqrt(np.where(inside, np.minimum(nearest, height * height / square), nearest))
