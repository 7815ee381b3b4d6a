"""A passage's faces cut where they have a crease, for kernels that dislike faces without a tangent plane."""

import numpy as np

from bladewright.domain.knots import BLADE_AT, PIECES
from bladewright.nurbs.domain import reparametrised, split
from bladewright.nurbs.surface import Surface

HALVES = ("lower", "upper")
"""pieces of inlet and outlet"""


def pieces_of(name: str, face: Surface) -> dict[str, Surface]:
    """The smooth pieces of a face, each over [0, 1], by names that begin with the face's."""
    if name.startswith("blade"):
        return {name: face}
    across = name in {"inlet", "outlet"}
    cuts, ends = ((0.5,), HALVES) if across else (BLADE_AT, PIECES)
    parts = split(face, np.array(cuts), "u")
    return {f"{name}_{end}": reparametrised(part) for end, part in zip(ends, parts, strict=True)}
