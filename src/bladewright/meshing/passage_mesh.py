"""A volume mesh of a passage: made by gmsh from a STEP file, reopened from disk and measured."""

import os
import re
import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import numpy as np

from bladewright.atomic_write import atomic_write
from bladewright.domain.passage import Passage
from bladewright.errors import MeshError
from bladewright.meshing.gmsh_process import CONTENT_FILE, Job, SizeSource, check_installed, run_gmsh
from bladewright.meshing.names import step_face_names
from bladewright.meshing.periodicity import Periodicity, periodicity
from bladewright.meshing.report import MeshReport
from bladewright.meshing.sizes import ELEMENTS_PER_TURN, Sizes, check_sizes, sizes
from bladewright.meshing.verification import MM, UNITS, mesh_report

FORMATS = {".msh": "Gmsh 4.1", ".su2": "SU2", ".cgns": "CGNS"}
"""Formats of mesh files by their endings."""


def format_of(path: str | os.PathLike[str]) -> str:
    """The format that the ending of a path names. Raises MeshError where it names none."""
    ending = Path(path).suffix.lower()
    if ending not in FORMATS:
        raise MeshError(
            f"'{path}' ends in {ending!r}, which is no mesh file that can be written: choose {', '.join(FORMATS)}"
        )
    return FORMATS[ending]


def check(
    path: str | os.PathLike[str],
    *,
    size: float | None = None,
    smallest: float | None = None,
    curvature: float = ELEMENTS_PER_TURN,
    unit: str = "m",
) -> None:
    """Raise MeshError for what `mesh` refuses of any passage: an unknown ending, size or unit, or a missing gmsh."""
    format_of(path)
    check_sizes(size=size, smallest=smallest, curvature=curvature)
    if unit not in UNITS:
        raise MeshError(f"unit is {unit!r}: a mesh is written in {' or '.join(UNITS)}")
    check_installed()


def mesh(
    step: str | os.PathLike[str],
    path: str | os.PathLike[str],
    *,
    passage: Passage,
    size: float | None = None,
    smallest: float | None = None,
    curvature: float = ELEMENTS_PER_TURN,
    unit: Literal["m", "mm"] = "m",
    progress: Callable[[str], object] | None = None,
    log: Callable[[str], object] | None = None,
) -> MeshReport:
    """Mesh the passage in a STEP file with tetrahedra, write the mesh to `path` and measure what was written.

    The file is read as it is, without repair. `size` is the size of elements in the open passage, `smallest` the
    smallest one at the edges, both in chords; `curvature` is the number of elements on a full circle of an edge's
    radius. Where no size is given, about 150,000 tetrahedra are made. Physical groups (markers, families) have the
    names of the faces; that of the volume is `fluid`. The nodes of `periodic_upper` are those of `periodic_lower`,
    turned or shifted by one pitch. `progress` is called with each step, `log` with each line that gmsh prints.

    Raises MeshError for sizes or endings that are refused, or where gmsh is not installed or gives up. A mesh that
    fails a check is written, and the report says why.
    """
    check(path, size=size, smallest=smallest, curvature=curvature, unit=unit)
    start = time.monotonic()
    step, path = Path(step), Path(path)
    faces = step_face_names(step)
    _check_faces(step, faces, passage)
    element_sizes = sizes(passage, size=size, smallest=smallest, curvature=curvature)
    motion = periodicity(passage.surfaces)
    with atomic_write(path) as unfinished, tempfile.TemporaryDirectory(prefix="bladewright-mesh-") as folder:
        made = Path(folder) / f"passage{path.suffix.lower()}"
        job = _job(step, made, faces, element_sizes, motion, MM / UNITS[unit])
        answer = run_gmsh(job, Path(folder), step=progress or _ignore, log=log or _ignore)
        with np.load(Path(folder) / CONTENT_FILE) as arrays:
            content = dict(arrays)
        if progress:
            progress("measuring")
        seconds = time.monotonic() - start
        report = mesh_report(content, passage, motion, element_sizes, answer, path, format_of(path), unit, seconds)
        shutil.copyfile(made, unfinished)
    return report


def _check_faces(step: Path, faces: tuple[str, ...], passage: Passage) -> None:
    known = passage.surfaces
    # of a face in pieces, each has its number behind the face's name
    if {name if name in known else re.sub(r"_\d+$", "", name) for name in faces} != set(known):
        raise MeshError(
            f"'{step}' holds the faces {', '.join(sorted(faces)) or 'none'}, but the passage has "
            f"{', '.join(sorted(passage.surfaces))}: name the STEP file of this passage"
        )


def _ignore(_: str) -> None:
    pass


def _job(
    step: Path, mesh_file: Path, faces: tuple[str, ...], element_sizes: Sizes, motion: Periodicity, scale: float
) -> Job:
    """The job for gmsh, in the millimetres of the STEP file."""
    size_sources = []
    for source in element_sizes.sources:
        x, y, z = (coordinate / MM for coordinate in source.place)
        size_sources.append(SizeSource(face=source.face, place=(x, y, z), size=source.size / MM))
    return Job(
        step=str(step.resolve()),
        faces=faces,
        motion=tuple(motion.matrix(MM).ravel().tolist()),
        largest=element_sizes.largest / MM,
        smallest=element_sizes.smallest / MM,
        growth=element_sizes.growth,
        sources=tuple(size_sources),
        mesh=str(mesh_file),
        scale=scale,
    )
