"""A volume mesh of a passage: made by gmsh from a STEP file, reopened from disk and measured."""

import os
import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import numpy as np

from bladewright.appearing import appearing
from bladewright.domain.passage import Passage
from bladewright.errors import MeshError
from bladewright.meshing.job import ARRAYS, Answer, Job, Near
from bladewright.meshing.measures import deviations, limit, loose_facets
from bladewright.meshing.names import GROUPS, group_of, step_face_names
from bladewright.meshing.periodicity import Periodicity, match, periodicity
from bladewright.meshing.quality import Indices, condition_numbers, radius_ratios, volumes
from bladewright.meshing.reopening import GROUP
from bladewright.meshing.report import FLAT, FaceMesh, MeshReport, Quality
from bladewright.meshing.running import answered, check_installed
from bladewright.meshing.sizes import ELEMENTS_PER_TURN, Sizes, check_sizes, sizes
from bladewright.nurbs.basis import Reals

FORMATS = {".msh": "Gmsh 4.1", ".su2": "SU2", ".cgns": "CGNS"}
"""by the ending of the file"""
UNITS = {"m": 1.0, "mm": 1e-3}
MM = 1e-3
"""[m] the unit of STEP files"""


def format_of(path: str | os.PathLike[str]) -> str:
    """The format that the ending of a path says. Raises MeshError where it says none."""
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
) -> None:
    """Raise MeshError for what `mesh` would refuse whatever the passage: an ending, a size, gmsh not installed."""
    format_of(path)
    check_sizes(size=size, smallest=smallest, curvature=curvature)
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

    The file is read as it is, without healing. `size` is that of elements in the open passage, `smallest` the least at
    the edges, both of the chord; `curvature` is how many elements a full circle as tight as an edge would get. Where no
    size is given, about 150,000 tetrahedra are made. Physical groups (markers, families) have the names of the faces;
    that of the volume is `fluid`. The nodes of `periodic_upper` are those of `periodic_lower` moved. `progress` hears
    each step, `log` each line that gmsh prints.

    Raises MeshError for sizes or endings that are refused, or where gmsh is not installed or gives up. A mesh that
    fails a check is written, and the report says why.
    """
    check(path, size=size, smallest=smallest, curvature=curvature)
    start = time.monotonic()
    step, path = Path(step), Path(path)
    faces = step_face_names(step)
    plan = sizes(passage, size=size, smallest=smallest, curvature=curvature)
    motion = periodicity(passage.surfaces)
    with tempfile.TemporaryDirectory(prefix="bladewright-mesh-") as folder:
        made = Path(folder) / f"passage{path.suffix.lower()}"
        job = _job(step, made, faces, plan, motion, MM / UNITS[unit])
        answer = answered(job, Path(folder), step=progress or _deaf, log=log or _deaf)
        with np.load(Path(folder) / ARRAYS) as arrays:
            content = dict(arrays)
        if progress:
            progress("measuring")
        report = _measured(content, passage, motion, plan, answer, path, unit, start)
        with appearing(path) as unfinished:
            shutil.copyfile(made, unfinished)
    return report


def _deaf(_: str) -> None:
    pass


def _job(
    step: Path,
    made: Path,
    faces: tuple[str, ...],
    plan: Sizes,
    motion: Periodicity,
    scale: float,
) -> Job:
    near = []
    for each in plan.sources:
        x, y, z = (coordinate / MM for coordinate in each.place)
        near.append(Near(face=each.face, place=(x, y, z), size=each.size / MM))
    return Job(
        step=str(step.resolve()),
        faces=faces,
        motion=tuple(motion.matrix(MM).ravel().tolist()),
        largest=plan.largest / MM,
        smallest=plan.smallest / MM,
        growth=plan.growth,
        near=tuple(near),
        mesh=str(made),
        scale=scale,
    )


def _measured(
    content: dict[str, Any],
    passage: Passage,
    motion: Periodicity,
    plan: Sizes,
    answer: Answer,
    path: Path,
    unit: str,
    start: float,
) -> MeshReport:
    nodes: Reals = content["nodes"] * UNITS[unit]
    tetrahedra: Indices = content["tetrahedra"]
    groups = {name.removeprefix(GROUP): rows for name, rows in content.items() if name.startswith(GROUP)}
    _check_complete(groups, passage, len(nodes), len(tetrahedra), answer)
    native = float(np.real(passage.properties.volume))
    condition = condition_numbers(nodes, tetrahedra)
    pairs = match(motion, nodes, groups["periodic_lower"], groups["periodic_upper"])
    x, y, z = (motion.translation / UNITS[unit]).tolist()
    return MeshReport(
        file=str(path),
        format=format_of(path),
        unit=unit,
        tetrahedra=len(tetrahedra),
        nodes=len(nodes),
        inverted=int(np.count_nonzero(~(condition > FLAT))),
        min_sicn=_quality(condition),
        gamma=_quality(radius_ratios(nodes, tetrahedra)),
        faces=tuple(_face(name, groups[name], nodes, passage) for name in GROUPS if name in groups),
        deviation_limit_mm=limit(plan.chord) / MM,
        loose=loose_facets(tetrahedra, groups),
        periodic_nodes=pairs.nodes,
        periodic_mismatch=pairs.mismatch,
        periodic_triangles=pairs.triangles,
        rotation_deg=float(np.degrees(motion.angle)),
        translation=(x, y, z),
        volume_error=float(volumes(nodes, tetrahedra).sum()) / native - 1.0,
        size=plan.largest / plan.chord,
        smallest=plan.smallest / plan.chord,
        expected=plan.expected,
        gmsh=answer.gmsh,
        algorithms=(*answer.surface, *answer.volume),
        seconds=time.monotonic() - start,
    )


def _check_complete(groups: dict[str, Indices], passage: Passage, nodes: int, tetrahedra: int, answer: Answer) -> None:
    wanted = {group_of(name) for name in passage.surfaces}
    if set(groups) != wanted or not all(map(len, groups.values())):
        raise MeshError(
            f"the mesh file holds the groups {', '.join(sorted(groups))}, but the passage has the faces "
            f"{', '.join(sorted(wanted))}: mesh the STEP file of this passage"
        )
    if (nodes, tetrahedra) != (answer.nodes, answer.tetrahedra):
        raise MeshError(
            f"the mesh file holds {nodes} nodes and {tetrahedra} tetrahedra, but {answer.nodes} and "
            f"{answer.tetrahedra} were written: choose another format"
        )


def _quality(values: Reals) -> Quality:
    return Quality(worst=float(values.min()), percentile=float(np.percentile(values, 1.0)), mean=float(values.mean()))


def _face(name: str, triangles: Indices, nodes: Reals, passage: Passage) -> FaceMesh:
    points = nodes[np.unique(triangles)]
    off = deviations(passage.surfaces, name, points, limit(float(np.real(passage.blade.chord))))
    return FaceMesh(
        name=name,
        triangles=len(triangles),
        nodes=len(points),
        max_deviation_mm=float(off.max()) / MM,
        mean_deviation_mm=float(off.mean()) / MM,
    )
