"""Strips of a wall past a blunt edge: as wide as its face, from there to the outlet, or from the inlet to there."""

from dataclasses import dataclass

from bladewright.domain.camber import CamberLines
from bladewright.domain.patch import WallPatch
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals

STRIPS = ("stagnation", "wake")
"""what a strip upstream of the leading, and downstream of the trailing edge is called"""
EDGE_FACES = ("leading_edge", "trailing_edge")
"""the faces of blunt edges"""


@dataclass(frozen=True, kw_only=True)
class WallStrip(WallPatch):
    """A strip of a wall, straight across in its plane."""

    past: int
    """whether it is upstream of the leading (0) or downstream of the trailing edge (1)"""

    @property
    def piece(self) -> str:
        """The piece along the flow that it is on."""
        return "outlet" if self.past else "inlet"

    def plane(self, piece: str, t: Reals, v: Reals) -> Array:
        lower, upper = (self.camber.points(piece, t, sign)[..., self.row, :, None, :] for sign in (-1, 1))
        return lower + (upper - lower) * v[:, None]


def strips(camber: CamberLines, touched: dict[str, bool]) -> dict[str, WallStrip]:
    """The strips of the walls that the blade stands on, by the names of their faces."""
    return {
        f"{wall}_{STRIPS[past]}": WallStrip(camber=camber, line=camber.lines.rows([row]), row=row, past=past)
        for wall, row in (("hub", 0), ("shroud", -1))
        for past, parted in enumerate(camber.parted)
        if parted and touched[wall]
    }
