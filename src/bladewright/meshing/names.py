"""Names: the faces of a STEP file as its text has them, and the groups of a mesh."""

import re
from pathlib import Path

from bladewright.errors import MeshError

CORNERS = tuple(
    f"{edge}{place}{run}"
    for edge in ("leading_edge", "trailing_edge")
    for place in ("_upper", "_lower", "")
    for run in ("_run", "")
    if place or run
)
"""Fillets about the corners of edges, whose names begin with those of the edges."""
GROUPS = (
    "hub_upper",
    "hub_lower",
    "shroud_upper",
    "shroud_lower",
    "periodic_upper",
    "periodic_lower",
    "inlet",
    "outlet",
    "blade_upper",
    "blade_lower",
    "blade_leading_edge",
    "blade_trailing_edge",
    "hub_stagnation",
    "hub_wake",
    "shroud_stagnation",
    "shroud_wake",
    "hub_gap",
    "shroud_gap",
    "tip",
    *(
        f"blade_{wall}_{part}_{face}"
        for wall in ("hub", "shroud")
        for part in ("strip", "fillet")
        for face in ("upper", "lower", *CORNERS, "leading_edge", "trailing_edge")
    ),
    "hub",
    "shroud",
)
"""Physical groups of the faces of a passage; where a face is split, its pieces are called GROUP_PIECE. Trimmed
walls come last, as their names begin those of others."""
FLUID = "fluid"
"""Physical group of the volume."""
GROUP_PREFIX = "group "
"""Beginning of the keys under which the content of a mesh file holds the triangles of a group."""


def face_names(text: str) -> tuple[str, ...]:
    """Names of the faces of the one closed shell in the text of a STEP file, in the order of the shell.

    gmsh numbers the faces in that order, but does not keep their names. Raises MeshError where there is not one shell.
    """
    joined = re.sub(r"\s+", "", text)
    shells = re.findall(r"=CLOSED_SHELL\('[^']*',\(([#\d,]+)\)\);", joined)
    if len(shells) != 1:
        raise MeshError(f"the STEP file holds {len(shells)} closed shells: a passage is one, export one passage")
    names = dict(re.findall(r"(#\d+)=ADVANCED_FACE\('([^']*)'", joined))
    return tuple(names.get(face, "") for face in shells[0].split(","))


def step_face_names(path: str | Path) -> tuple[str, ...]:
    """`face_names` of the STEP file at a path. Raises MeshError where it cannot be read."""
    try:
        return face_names(Path(path).read_text(encoding="latin-1"))
    except OSError as error:
        raise MeshError(f"'{path}' cannot be read: {error.strerror or error}; name a STEP file") from error


def group_of(face: str) -> str:
    """The physical group of a face: its own name, or the group of which the face is a piece."""
    return next((group for group in GROUPS if face == group or face.startswith(f"{group}_")), face)
