"""One half of a wall in its plane (m', theta): between the blade, or the camber line under a gap, and a periodic line.

With S the blade's side and its extensions, N the continued camber line half a pitch away, and A a vector along the
extension that fades from the edge:

    P(u, v) = S + (N - S) w(v) + A g(v),   w = o v + (1 - o) v^2,   g = o v (1 - v)^e.

At a round edge the cross-line leaves inside the right angle between side and extension, so that the patch does not
fold there though its sides turn by that angle; at sharp and blunt edges, where the extension goes on as the side ends,
A is nothing.
"""

from dataclasses import dataclass

import numpy as np

from bladewright.domain.camber import CamberLines
from bladewright.domain.crossing import Crossing
from bladewright.domain.patch import WallPatch
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals

ROOM = 4.0
"""half pitch, in meridional extents of the blade, beyond which cross-lines leave the blade more slowly"""


def opening(half_pitch: float, extent: float) -> float:
    """The share o of the width at which cross-lines leave the blade: about 1, less where the pitch is large."""
    return 1.0 / (1.0 + half_pitch / (ROOM * extent))


def widening(opened: float, v: Reals) -> Reals:
    """The share w of the width that cross-lines have reached at v."""
    return opened * v + (1.0 - opened) * v * v


def lean(sine: Array, half_pitch: Array | float, sign: int, past: int, least: float) -> Array:
    """Length |A| (...) of the lean at an edge where the camber has the given sine; `least` that of a Crossing."""
    outwards = -1.0 if past == 0 else 1.0
    return half_pitch * (np.sqrt(sine * sine + least**2) - outwards * sign * sine)


@dataclass(frozen=True, kw_only=True)
class WallHalf(WallPatch):
    """A half of a wall: `sign` +1 above the blade, -1 below it; `touched` where the blade stands on the wall."""

    sign: int
    touched: bool
    half_pitch: Array
    """() in theta, or y in a cascade"""
    opening: float
    crossing: Crossing

    def plane(self, piece: str, t: Reals, v: Reals) -> Array:
        middle = self.camber.points(piece, t)[..., self.row, :, :]
        width = self.sign * self.half_pitch[..., None, None] * np.array([0.0, 1.0])
        w = widening(self.opening, v)
        if not self.touched:
            return middle[..., None, :] + width[..., None, :] * w[:, None]
        own = self.camber.side(t, self.sign) if piece == "blade" else self.camber.points(piece, t, self.sign)
        south = own[..., self.row, :, :]
        north = middle + width
        g = self.opening * v * (1.0 - v) ** self.crossing.ease
        across = (north - south)[..., None, :] * w[:, None]
        return south[..., None, :] + across + self._lean(piece, t)[..., None, :] * g[:, None]

    def _lean(self, piece: str, t: Reals) -> Array:
        """A (..., k, 2): at an edge, what turns the cross-line into the right angle."""
        if piece == "blade":
            fade = self.crossing.fade
            return self._edge_lean(0) * ((1.0 - t) ** fade)[:, None] + self._edge_lean(1) * (t**fade)[:, None]
        return self._edge_lean(0) * t[:, None] if piece == "inlet" else self._edge_lean(1) * (1.0 - t)[:, None]

    def _edge_lean(self, past: int) -> Array:
        direction = self.camber.direction(past)[..., self.row, :]
        if self.camber.stations.kinds[past] != "round":
            return np.zeros_like(direction)[..., None, :]
        reach = (-1.0 if past == 0 else 1.0) * lean(
            direction[..., 1], self.half_pitch, self.sign, past, self.crossing.lean
        )
        return reach[..., None, None] * direction[..., None, :]


def halves(
    camber: CamberLines, touched: dict[str, bool], half_pitch: Array, opened: tuple[float, float], crossing: Crossing
) -> dict[str, WallHalf]:
    """The four halves of hub (first station) and shroud (last), by the names of their faces."""
    lines = {row: camber.lines.rows([row]) for row in (0, -1)}
    return {
        f"{wall}_{half}": WallHalf(
            camber=camber,
            line=lines[row],
            row=row,
            sign=sign,
            touched=touched[wall],
            half_pitch=half_pitch,
            opening=opened[row],
            crossing=crossing,
        )
        for wall, row in (("hub", 0), ("shroud", -1))
        for half, sign in (("upper", 1), ("lower", -1))
    }
