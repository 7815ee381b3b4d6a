"""A mesh file measured against the native passage: nodes on their surfaces, a closed boundary, quality."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bladewright.blade.native.blade import Faces
from bladewright.domain.passage import Passage
from bladewright.errors import MeshError
from bladewright.meshing.gmsh_process import Answer
from bladewright.meshing.names import GROUP_PREFIX, GROUPS, group_of
from bladewright.meshing.periodicity import Periodicity, match_periodic
from bladewright.meshing.quality import FACETS, Indices, condition_numbers, radius_ratios, volumes
from bladewright.meshing.report import FLAT, FaceMesh, MeshReport, Quality
from bladewright.meshing.sizes import Sizes
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.closest import closest_on_surface
from bladewright.nurbs.trimmed import TrimmedSurface

DEVIATION_LIMIT = 1e-8, 1e-7
"""Largest distance of a node from its native surface, in metres and in chords, whichever is more: what the round trip
allows a trimmed end of the STEP file that the mesh is made from. The examples of design/meshes.md reach 6e-9 m."""
REFINED_SEARCHES = 200
"""Largest number of nodes of a face, the farthest ones first, whose closest point is searched for a second time,
globally, where the first search ends further away than allowed. A global search is slow, and one bad node is enough to
fail."""
UNITS = {"m": 1.0, "mm": 1e-3}
"""Metres in the units that a mesh file may have."""
MM = 1e-3
"""Metres in a millimetre, the unit of deviations and of STEP files."""


def deviation_limit(chord: float) -> float:
    """How far a node may lie off its native surface [m]."""
    return max(DEVIATION_LIMIT[0], DEVIATION_LIMIT[1] * chord)


def deviations(faces: Faces, group: str, points: Reals, allowed: float) -> Reals:
    """Distances (n,) of points (n, 3) from the native surfaces of a group [m], infinite where there are none.

    The closest point is found by descent from the nearest sample; for the worst distances above `allowed` it is
    searched for again, globally.
    """
    best = np.full(len(points), np.inf)
    for name, face in faces.items():
        if group_of(name) != group:
            continue
        surface = face.surface if isinstance(face, TrimmedSurface) else face
        distances = closest_on_surface(surface, points, tolerance=1.0).distances.real
        worst = np.argsort(distances)[::-1][:REFINED_SEARCHES]
        worst = worst[distances[worst] > allowed]
        if len(worst):
            distances = np.array(distances)
            distances[worst] = closest_on_surface(surface, points[worst], tolerance=1e-7).distances.real
        best = np.minimum(best, distances)
    return best


def unmatched_facets(tetrahedra: Indices, groups: Mapping[str, Indices]) -> int:
    """Number of facets that occur other than twice among the tetrahedra and the triangles of the groups.

    0 says that the groups together cover the whole boundary, each piece of it once.
    """
    facets = np.sort(tetrahedra[:, FACETS].reshape(-1, 3), axis=1)
    triangles = np.sort(np.concatenate([*groups.values(), np.zeros((0, 3), dtype=np.intp)]), axis=1)
    _, uses = np.unique(np.concatenate([facets, triangles]), axis=0, return_counts=True)
    return int(np.count_nonzero(uses != 2))


def mesh_report(
    content: Mapping[str, Any],
    passage: Passage,
    motion: Periodicity,
    element_sizes: Sizes,
    answer: Answer,
    path: Path,
    kind: str,
    unit: str,
    seconds: float,
) -> MeshReport:
    """The report on the content of a mesh file: `kind` is its format, `unit` that of its lengths.

    Raises MeshError where its groups are not the faces of the passage, or where nodes or tetrahedra are missing.
    """
    nodes: Reals = content["nodes"] * UNITS[unit]
    tetrahedra: Indices = content["tetrahedra"]
    groups: dict[str, Indices] = {
        name.removeprefix(GROUP_PREFIX): rows for name, rows in content.items() if name.startswith(GROUP_PREFIX)
    }
    check_complete(groups, passage, len(nodes), len(tetrahedra), answer)
    native = float(np.real(passage.properties.volume))
    condition = condition_numbers(nodes, tetrahedra)
    pairs = match_periodic(motion, nodes, groups["periodic_lower"], groups["periodic_upper"])
    x, y, z = (motion.translation / UNITS[unit]).tolist()
    return MeshReport(
        file=str(path),
        format=kind,
        unit=unit,
        tetrahedra=len(tetrahedra),
        nodes=len(nodes),
        inverted=int(np.count_nonzero(~(condition > FLAT))),
        min_sicn=_quality(condition),
        gamma=_quality(radius_ratios(nodes, tetrahedra)),
        faces=tuple(_face(name, groups[name], nodes, passage) for name in GROUPS if name in groups),
        deviation_limit_mm=deviation_limit(element_sizes.chord) / MM,
        loose=unmatched_facets(tetrahedra, groups),
        periodic_nodes=pairs.nodes,
        periodic_mismatch=pairs.mismatch,
        periodic_triangles=pairs.triangles,
        rotation_deg=float(np.degrees(motion.angle)),
        translation=(x, y, z),
        volume_error=float(volumes(nodes, tetrahedra).sum()) / native - 1.0,
        size=element_sizes.largest / element_sizes.chord,
        smallest=element_sizes.smallest / element_sizes.chord,
        expected=element_sizes.expected,
        gmsh=answer.gmsh,
        algorithms=(*answer.surface, *answer.volume),
        seconds=seconds,
    )


def check_complete(
    groups: Mapping[str, Indices], passage: Passage, nodes: int, tetrahedra: int, answer: Answer
) -> None:
    """Raise MeshError where the groups are not the faces of the passage, or where nodes or tetrahedra are missing."""
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
    distances = deviations(passage.surfaces, name, points, deviation_limit(float(np.real(passage.blade.chord))))
    return FaceMesh(
        name=name,
        triangles=len(triangles),
        nodes=len(points),
        max_deviation_mm=float(distances.max()) / MM,
        mean_deviation_mm=float(distances.mean()) / MM,
    )
