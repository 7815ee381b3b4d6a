"""A passage's faces cut where they have a crease, for kernels that dislike faces without a tangent plane."""

import numpy as np

from bladewright.domain.knots import BLADE_AT, PIECES, PassageKnots
from bladewright.domain.strip import STRIPS
from bladewright.nurbs.domain import reparametrised, split
from bladewright.nurbs.surface import Surface


def pieces_of(name: str, face: Surface, knots: PassageKnots) -> dict[str, Surface]:
    """The smooth pieces of a face, each over [0, 1], by names that begin with the face's."""
    if name.startswith("blade") or name.endswith(STRIPS):
        return {name: face}
    cuts: tuple[float, ...] = BLADE_AT
    ends: tuple[str, ...] = PIECES
    if name in {"inlet", "outlet"}:
        past = int(name == "outlet")
        cuts = knots.cuts(past)
        ends = ("lower", STRIPS[past], "upper") if knots.parted[past] else ("lower", "upper")
    parts = split(face, np.array(cuts), "u")
    return {f"{name}_{end}": reparametrised(part) for end, part in zip(ends, parts, strict=True)}
