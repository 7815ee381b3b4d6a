"""Point clouds sampled from CAD files."""

import os
from pathlib import Path

import numpy as np
from numpy.random import Generator, default_rng

from bladewright.cad.file_face import file_face
from bladewright.cad.kernel import quiet
from bladewright.cad.mesh import TriangleMesh
from bladewright.cad.mesh_files import read_3mf, read_stl
from bladewright.cad.native_body import MM
from bladewright.cad.reading import format_of, read_cad_file
from bladewright.cad.region import Region
from bladewright.errors import CadError
from bladewright.numerics.elementary import Array


def sample(path: str | os.PathLike[str], count: int = 10_000, *, seed: int = 0) -> Array:
    """Random points (count, 3) [m], uniform by area over all faces of a CAD file; the same for the same seed.

    Raises CadError where the file is not of the format that its name states.
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
        faces = [file_face(face) for face in read_cad_file(path).faces]
    shares = np.cumsum([face.area for face in faces]) / sum(face.area for face in faces)
    counts = np.diff(np.concatenate([[0], np.round(shares * count).astype(int)]))
    drawn = [_of_region(face.region, int(number), random) for face, number in zip(faces, counts, strict=True)]
    return np.concatenate(drawn) / MM


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
