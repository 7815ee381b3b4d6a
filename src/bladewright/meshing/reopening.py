"""What a mesh file holds, read back from disk: nodes, tetrahedra, and triangles by group."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from bladewright.errors import MeshError
from bladewright.meshing.library import gmsh
from bladewright.meshing.quality import Indices

Content = dict[str, Any]
"""`nodes` (n, 3) in the file's unit, `tetrahedra` (k, 4), and for each group of faces `group NAME` (m, 3)"""
GROUP = "group "
TRIANGLE, TETRAHEDRON = 5, 10
"""as VTK and SU2 number them"""


def content(path: Path) -> Content:
    """What the mesh file at a path holds; gmsh reads all but SU2, which it only writes."""
    return _su2(path) if path.suffix == ".su2" else _of_gmsh(path)


def _of_gmsh(path: Path) -> Content:
    gmsh.clear()
    gmsh.open(str(path))
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    place = np.zeros(int(tags.max(initial=0)) + 1, dtype=np.intp)
    place[tags.astype(np.intp)] = np.arange(len(tags))
    found: Content = {"nodes": coordinates.reshape(-1, 3)}
    for dimension, group in gmsh.model.getPhysicalGroups():
        name = gmsh.model.getPhysicalName(dimension, group)
        corners = [
            nodes.astype(np.intp)
            for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, group)
            for nodes in gmsh.model.mesh.getElements(dimension, entity)[2]
        ]
        key = "tetrahedra" if dimension == 3 else GROUP + name
        found[key] = place[np.concatenate([*corners, np.zeros(0, dtype=np.intp)])].reshape(-1, dimension + 1)
    return found


def _su2(path: Path) -> Content:
    found: Content = {}
    with path.open(encoding="utf-8") as lines:
        for line in lines:
            key, _, value = (part.strip() for part in line.partition("="))
            if key == "NELEM":
                found["tetrahedra"] = _elements(lines, int(value), TETRAHEDRON)
            elif key == "NPOIN":
                rows = (next(lines).split() for _ in range(int(value.split()[0])))
                table = np.array([[float(word) for word in row[:4]] for row in rows])
                found["nodes"] = table[np.argsort(table[:, 3]), :3]
            elif key == "MARKER_TAG":
                count = int(next(lines).partition("=")[2])
                found[GROUP + value] = _elements(lines, count, TRIANGLE)
    return found


def _elements(lines: Iterator[str], count: int, kind: int) -> Indices:
    corners = 4 if kind == TETRAHEDRON else 3
    rows = [next(lines).split() for _ in range(count)]
    if any(int(row[0]) != kind for row in rows):
        raise MeshError(f"the SU2 file holds an element that is not of type {kind}, though only such were written")
    return np.array([[int(word) for word in row[1 : corners + 1]] for row in rows], dtype=np.intp).reshape(-1, corners)
