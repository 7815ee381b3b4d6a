"""Point clouds sampled from CAD files."""

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.random import Generator, default_rng
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.GCPnts import GCPnts_AbscissaPoint, GCPnts_QuasiUniformAbscissa
from OCP.TopAbs import TopAbs_EDGE
from OCP.TopoDS import TopoDS

from bladewright.cad.file_face import file_face
from bladewright.cad.kernel import quiet
from bladewright.cad.mesh import TriangleMesh
from bladewright.cad.mesh_files import read_3mf, read_stl
from bladewright.cad.native_body import MM
from bladewright.cad.reading import format_of, read_cad_file, subshapes
from bladewright.cad.region import Region
from bladewright.errors import CadError
from bladewright.numerics.elementary import Array

EDGE_SHARE = 0.1
"""share of the points that lie on edges: rows at hub and shroud, where a thin blade's end faces have few points; they
are most of the points within `ROW_BAND` of an end, as these must be to be told (design/matching.md)"""
EVEN_PLACES = 400
"""places that are evenly spaced along an edge, between which its parameter is taken for linear in the length"""


def sample(path: str | os.PathLike[str], count: int = 10_000, *, seed: int = 0) -> Array:
    """Random points (count, 3) [m] of a CAD file, the same for the same seed.

    They are uniform by area over all faces, the last tenth uniform by length over all edges, where faces meet; STL and
    3MF files have no edges. Raises CadError where the file is not of the format that its name states.
    """
    path = Path(path)
    if count < 1:
        raise CadError(f"{count} points were asked for: at least 1 is needed")
    random = default_rng(seed)
    kind = format_of(path)
    if kind in {"STL", "3MF"}:
        mesh, _ = read_stl(path) if kind == "STL" else read_3mf(path)
        return _of_mesh(mesh, count, random) / MM
    with quiet():
        file = read_cad_file(path)
        faces = [file_face(face) for face in file.faces]
        edges = [TopoDS.Edge_s(edge) for edge in subshapes(file.shape, TopAbs_EDGE)]
    curves = [BRepAdaptor_Curve(edge) for edge in edges if not BRep_Tool.Degenerated_s(edge)]
    on_edges = round(EDGE_SHARE * count) if curves else 0
    face_counts = _counts([face.area for face in faces], count - on_edges)
    edge_counts = _counts([GCPnts_AbscissaPoint.Length_s(curve) for curve in curves], on_edges)
    drawn = [_of_region(face.region, int(each), random) for face, each in zip(faces, face_counts, strict=True)]
    drawn += [_of_curve(curve, int(each), random) for curve, each in zip(curves, edge_counts, strict=True)]
    return np.concatenate(drawn) / MM


def _counts(sizes: Sequence[float], count: int) -> NDArray[np.intp]:
    """Numbers of points (n,) in proportion to sizes (n,), `count` together."""
    shares = np.cumsum(sizes) / np.sum(sizes)
    return np.diff(np.round(shares * count).astype(np.intp), prepend=0)


def _of_curve(curve: BRepAdaptor_Curve, count: int, random: Generator) -> Array:
    """Points (count, 3) [mm] of an edge, uniform by length."""
    even = GCPnts_QuasiUniformAbscissa(curve, EVEN_PLACES)
    known = [even.Parameter(i + 1) for i in range(EVEN_PLACES)]
    at = np.interp(random.uniform(0.0, EVEN_PLACES - 1.0, count), np.arange(EVEN_PLACES), known)
    points = (curve.Value(float(t)) for t in at)
    return np.array([(p.X(), p.Y(), p.Z()) for p in points]).reshape(-1, 3)


def _of_region(region: Region, count: int, random: Generator) -> Array:
    """Points (count, 3) [mm], uniform by area: of uniform parameters, kept in proportion to their area elements."""
    low, high = region.low, region.high
    if region.loops:
        low, high = region.boundary.uv.min(axis=0), region.boundary.uv.max(axis=0)
    found, total, densest = [np.zeros((0, 3))], 0, 0.0
    while total < count:
        uv = low + random.random((max(4 * count, 4000), 2)) * (high - low)
        uv = uv[region.contains(uv)]
        points, along, across = region.evaluator.frame(uv)
        element = np.sqrt(np.sum(np.cross(along, across) ** 2, axis=-1))
        # the largest area element so far stands for the largest of the face
        densest = max(densest, float(element.max(initial=0.0)))
        kept = points[random.random(len(points)) * densest < element]
        found.append(kept)
        total += len(kept)
    return np.concatenate(found)[:count]


def _of_mesh(mesh: TriangleMesh, count: int, random: Generator) -> Array:
    vectors = mesh.vectors
    areas = np.sqrt(np.sum(vectors * vectors, axis=-1))
    corners = mesh.corners[random.choice(len(areas), size=count, p=areas / areas.sum())]
    a, b = np.sort(random.random((2, count)), axis=0)[:, :, None]
    return a * corners[:, 0] + (b - a) * corners[:, 1] + (1.0 - b) * corners[:, 2]
