"""The mesh file: written by gmsh in the unit asked for, and read back from disk."""

from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from bladewright.errors import MeshError
from bladewright.meshing.lazy_gmsh import gmsh
from bladewright.meshing.names import GROUP_PREFIX
from bladewright.meshing.quality import Indices

Lines = Iterator[str]
"""Lines of a file of gmsh's own format, version 4.1."""
Content = dict[str, Any]
"""`nodes` (n, 3) in the file's unit, `tetrahedra` (k, 4), and for each group of faces `group NAME` (m, 3)."""
TRIANGLE, TETRAHEDRON = 5, 10
"""Numbers of the element types in SU2 files, which are those of VTK."""


def write_mesh(path: Path, scale: float) -> None:
    """Write gmsh's current mesh in the format that the path's ending names, with lengths multiplied by `scale`.

    gmsh's own format is written first, as all lengths in it can be scaled; the other formats are made from it.
    """
    native = path.with_suffix(".msh")
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.option.setNumber("Mesh.Binary", 0)
    gmsh.option.setNumber("Mesh.ScalingFactor", scale)
    gmsh.write(str(native))
    gmsh.option.setNumber("Mesh.ScalingFactor", 1.0)
    if scale != 1.0:
        rewrite(native, lambda lines: rescaled(lines, scale))
    if native != path:
        # CGNS holds periodic motions in single precision, and gmsh moves nodes by them when it reads such a file.
        rewrite(native, motionless)
        gmsh.clear()
        gmsh.open(str(native))
        _name_entities()
        gmsh.write(str(path))


def _name_entities() -> None:
    """Give faces and volume the names of their groups, which CGNS takes as names of its boundary conditions."""
    for dimension, group in gmsh.model.getPhysicalGroups():
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, group):
            gmsh.model.setEntityName(dimension, entity, gmsh.model.getPhysicalName(dimension, group))


def rescaled(lines: Lines, scale: float) -> Lines:
    """The lines with the bounding boxes of entities and the periodic motions scaled.

    gmsh itself scales the nodes only, and leaves these in the unit of the geometry.
    """
    for line in lines:
        yield line
        if line.startswith("$Entities"):
            yield from _entities(lines, scale)
        elif line.startswith("$Periodic"):
            yield from _motions(lines, scale)


def motionless(lines: Lines) -> Lines:
    """The lines without the periodic motions."""
    for line in lines:
        if line.startswith("$Periodic"):
            for each in lines:
                if each.startswith("$EndPeriodic"):
                    break
        else:
            yield line


def rewrite(path: Path, change: Callable[[Lines], Lines]) -> None:
    """Replace the lines of a file by what `change` makes of them."""
    other = path.with_suffix(".rewritten")
    with path.open(encoding="utf-8") as source, other.open("w", encoding="utf-8") as target:
        target.writelines(change(source))
    other.replace(path)


def _entities(lines: Lines, scale: float) -> Lines:
    """The lines of the entities: a point has three coordinates, every other entity a box of six."""
    head = next(lines)
    yield head
    points, *others = map(int, head.split())
    yield from (_scaled(line, 1, 4, scale) for line in islice(lines, points))
    yield from (_scaled(line, 1, 7, scale) for line in islice(lines, sum(others)))


def _motions(lines: Lines, scale: float) -> Lines:
    head = next(lines)
    yield head
    for _ in range(int(head)):
        yield next(lines)
        words = next(lines).split()
        # These are the fourth column of a 4 x 4 matrix written row by row, after the count of its numbers.
        for place in (4, 8, 12) if len(words) > 1 else ():
            words[place] = repr(float(words[place]) * scale)
        yield " ".join(words) + "\n"
        pairs = next(lines)
        yield pairs
        yield from islice(lines, int(pairs))


def _scaled(line: str, first: int, last: int, scale: float) -> str:
    words = line.split()
    words[first:last] = [repr(float(word) * scale) for word in words[first:last]]
    return " ".join(words) + "\n"


def read_mesh(path: Path) -> Content:
    """Read a mesh file back; gmsh reads every format but SU2, which it only writes."""
    return _read_su2(path) if path.suffix == ".su2" else _read_gmsh(path)


def _read_gmsh(path: Path) -> Content:
    gmsh.clear()
    gmsh.open(str(path))
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    place = np.zeros(int(tags.max(initial=0)) + 1, dtype=np.intp)
    place[tags.astype(np.intp)] = np.arange(len(tags))
    content: Content = {"nodes": coordinates.reshape(-1, 3)}
    for dimension, group in gmsh.model.getPhysicalGroups():
        name = gmsh.model.getPhysicalName(dimension, group)
        corners = [
            nodes.astype(np.intp)
            for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, group)
            for nodes in gmsh.model.mesh.getElements(dimension, entity)[2]
        ]
        key = "tetrahedra" if dimension == 3 else GROUP_PREFIX + name
        content[key] = place[np.concatenate([*corners, np.zeros(0, dtype=np.intp)])].reshape(-1, dimension + 1)
    return content


def _read_su2(path: Path) -> Content:
    content: Content = {}
    with path.open(encoding="utf-8") as lines:
        for line in lines:
            key, _, value = (part.strip() for part in line.partition("="))
            if key == "NELEM":
                content["tetrahedra"] = _read_elements(lines, int(value), TETRAHEDRON)
            elif key == "NPOIN":
                rows = (next(lines).split() for _ in range(int(value.split()[0])))
                table = np.array([[float(word) for word in row[:4]] for row in rows])
                content["nodes"] = table[np.argsort(table[:, 3]), :3]
            elif key == "MARKER_TAG":
                count = int(next(lines).partition("=")[2])
                content[GROUP_PREFIX + value] = _read_elements(lines, count, TRIANGLE)
    return content


def _read_elements(lines: Iterator[str], count: int, kind: int) -> Indices:
    """Read the nodes of so many elements of one type."""
    corners = 4 if kind == TETRAHEDRON else 3
    rows = [next(lines).split() for _ in range(count)]
    if any(int(row[0]) != kind for row in rows):
        raise MeshError(f"the SU2 file holds an element that is not of type {kind}, though only such were written")
    return np.array([[int(word) for word in row[1 : corners + 1]] for row in rows], dtype=np.intp).reshape(-1, corners)
