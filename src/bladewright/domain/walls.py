"""Patches of hub and shroud in the plane (m', theta): the halves beside the blade, and the strips past blunt edges."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bladewright.blade.flow_path.streamlines import StreamLines
from bladewright.domain.camber_lines import CamberLines
from bladewright.numerics.elementary import Array, unit
from bladewright.nurbs.basis import Reals


class CrossLines(NamedTuple):
    """How cross-lines turn back from the lean with which they leave an edge."""

    ease: int
    """the power e: the smaller, the later they turn back, and the further the extension must reach"""
    lean: float
    """tangent of their least angle to the normal of the extension, times the camber's cosine"""
    fade: int = 16
    """power of 1 - t with which the lean fades from an edge along the blade"""
    quick: float = 0.5
    """how much faster than on average periodic boundaries pass the edges: the faster, the less they need to lean"""

    @property
    def bulge(self) -> float:
        """The greatest value of v (1 - v)^e."""
        share = self.ease / (self.ease + 1.0)
        return float((1.0 - share) * share**self.ease)


CROSS_LINES = (CrossLines(3, 1.0), CrossLines(1, 1.0), CrossLines(1, 2.0))
"""the ways that are tried in turn: most blades need the first, blunt ones beside narrow passages the others"""
CROSS_LINES_GATHERED = (
    *(CrossLines(each.ease, each.lean, fade=5, quick=-0.65) for each in CROSS_LINES),
    CrossLines(1, 3.0, fade=8, quick=1.0),
    CrossLines(1, 5.0, fade=16, quick=1.5),
)
"""the same for sides whose parameter is gathered at their edges, the last two for corners beside a back face"""


@dataclass(frozen=True, kw_only=True)
class WallPatch(ABC):
    """A part of hub or shroud, of one or more of the three pieces along the flow."""

    camber: CamberLines
    line: StreamLines
    """the duct's stream line along the wall"""
    row: int
    """which of the camber's stations"""

    @abstractmethod
    def plane(self, piece: str, t: Reals, v: Reals) -> Array:
        """Points (..., k, l, 2) in the plane at t (k,) along a piece and v (l,) across."""

    def in_space(self, piece: str, t: Reals, v: Reals) -> tuple[Array, Array]:
        """Points (..., k, l, 3) in metres, and the wall's unit normals there, towards the shroud."""
        plane = self.plane(piece, t, v)
        flat = plane.reshape(*plane.shape[:-3], 1, -1, 2)
        lines = self.line
        u = lines.u_at(flat[..., 0])
        position, slope = lines.position(u), unit(lines.position(u, 1))
        mapping, tangential = lines.mapping, flat[..., 1]
        points = mapping.in_space(position[..., 0], position[..., 1], tangential)
        upright = mapping.in_space(-slope[..., 1], slope[..., 0], tangential if mapping.revolved else 0.0 * tangential)
        shape = (*plane.shape[:-1], 3)
        return points.reshape(shape), upright.reshape(shape)


WIDE_PITCH = 4.0
"""half pitch, in meridional extents of the blade, beyond which cross-lines leave the blade more slowly"""


def departure(half_pitch: float, extent: float) -> float:
    """The share o of the width at which cross-lines leave the blade: about 1, less where the pitch is large."""
    return 1.0 / (1.0 + half_pitch / (WIDE_PITCH * extent))


def width_share(opened: float, v: Reals) -> Reals:
    """The share w of the width that cross-lines have reached at v."""
    return opened * v + (1.0 - opened) * v * v


def edge_skew(sine: Array, half_pitch: Array | float, sign: int, past: int, least: float) -> Array:
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
    crossing: CrossLines

    def plane(self, piece: str, t: Reals, v: Reals) -> Array:
        middle = self.camber.points(piece, t)[..., self.row, :, :]
        width = self.sign * self.half_pitch[..., None, None] * np.array([0.0, 1.0])
        w = width_share(self.opening, v)
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
        reach = (-1.0 if past == 0 else 1.0) * edge_skew(
            direction[..., 1], self.half_pitch, self.sign, past, self.crossing.lean
        )
        return reach[..., None, None] * direction[..., None, :]


def wall_halves(
    camber: CamberLines, touched: dict[str, bool], half_pitch: Array, opened: tuple[float, float], crossing: CrossLines
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


def wall_strips(camber: CamberLines, touched: dict[str, bool]) -> dict[str, WallStrip]:
    """The strips of the walls that the blade stands on, by the names of their faces."""
    return {
        f"{wall}_{STRIPS[past]}": WallStrip(camber=camber, line=camber.lines.rows([row]), row=row, past=past)
        for wall, row in (("hub", 0), ("shroud", -1))
        for past, parted in enumerate(camber.parted)
        if parted and touched[wall]
    }
