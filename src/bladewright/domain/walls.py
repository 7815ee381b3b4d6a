"""Patches of hub and shroud in their plane (m', theta): halves beside the blade, and strips past blunt edges.

A half lies between the blade, or the camber line where the blade has a clearance, and a periodic boundary. With S the
blade's side and the lines that extend it, N the continued camber line half a pitch away, and A a vector along the
extension that fades away from the edges:

    P(u, v) = S + (N - S) w(v) + A g(v),   w = o v + (1 - o) v^2,   g = o v (1 - v)^e.

A cross-line u = const starts in the direction o (N - S + A). At a round edge the side turns by a right angle from the
extension, and A skews the cross-line so that it starts inside that angle and the patch does not fold there. At a sharp
or blunt edge the extension goes on in the direction of the side, and A is zero.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bladewright.blade.flow_path.streamlines import StreamLines
from bladewright.domain.camber_lines import CamberLines
from bladewright.numerics.elementary import Array, unit
from bladewright.nurbs.basis import Reals

STRIPS = ("stagnation", "wake")
"""Names of the strips upstream of a blunt leading, and downstream of a blunt trailing edge."""
EDGE_FACES = ("leading_edge", "trailing_edge")
"""Names of the faces of blunt edges."""
EASE = 0.5
"""Share of the way over which the skew of cross-lines begins, far from an edge, to grow in proportion to the way: the
less, the less steeply it must grow then, and the more knots its beginning asks for."""
STEEPEST_FADE = 1.0 / (1.0 - EASE / 2.0)
"""Its greatest slope, where it does not fade over the whole way."""
WIDE_PITCH = 4.0
"""Half pitch, in meridional lengths of the blade, at which the departure of cross-lines is halved: a wide passage need
not skew them by a part of its whole width. With 2 walls come nearer to folding (0.010 of the median instead of 0.018),
with 8 passages have 1.4 % more control points (design/passage_constants.md)."""


class CrossLines(NamedTuple):
    """How cross-lines leave a round edge of the blade and turn back."""

    return_power: int
    """the power e of 1 - v: the smaller, the later they turn back, and the further the extension must reach"""
    skew: float
    """tangent of their least angle to the normal of the extension, times the camber's cosine"""
    fade_power: int = 16
    """power of 1 - t, or t, with which the skew fades along the blade away from an edge"""
    edge_slope: float = 1.5
    """slope of the camber correspondence at round edges: the faster a periodic boundary passes them, the less skew is
    needed"""

    @property
    def bulge(self) -> float:
        """The greatest value of v (1 - v)^e."""
        share = self.return_power / (self.return_power + 1.0)
        return float((1.0 - share) * share**self.return_power)


NO_SKEW = CrossLines(1, 0.0, edge_slope=1.0)
"""Where walls are trimmed faces, which have no cross-lines."""
CROSS_LINES = (CrossLines(3, 1.0), CrossLines(1, 1.0), CrossLines(1, 2.0))
"""What is tried in turn: built-in examples of the unified family need only the first; stout blades beside narrow
passages, such as the seeds 23, 52 and 80 of design/random_designs.py, need the others."""
CROSS_LINES_GATHERED = (
    *(CrossLines(each.return_power, each.skew, fade_power=5, edge_slope=0.35) for each in CROSS_LINES),
    CrossLines(1, 3.0, fade_power=8, edge_slope=2.0),
    CrossLines(1, 5.0, fade_power=16, edge_slope=2.5),
)
"""The same for sides whose parameter is gathered at their edges: a skew that fades later raised the least Jacobian of a
compressor from 0.10 to 0.26 of the median, of a vane from -0.05 to 0.06. The last two are for corners beside a back
face."""


def departure(half_pitch: float, extent: float) -> float:
    """The derivative o of the width share at the blade: about 1, less where the pitch is large beside the extent."""
    return 1.0 / (1.0 + half_pitch / (WIDE_PITCH * extent))


def width_share(departing: float, v: Reals) -> Reals:
    """The share w of the width that cross-lines have crossed at v."""
    return departing * v + (1.0 - departing) * v * v


def skew_share(share: Reals, reach: float) -> Reals:
    """The share of the skew left at a share of the way from inlet or outlet to an edge, over which it fades.

    In proportion to it where it fades over the whole way; else with two continuous derivatives over `reach` of it.
    """
    if reach == 1.0:
        return share
    within = np.maximum(1.0 - (1.0 - share) / reach, 0.0)
    eased = np.minimum(within / EASE, 1.0)
    return STEEPEST_FADE * (EASE * (eased**3 - eased**4 / 2.0) + np.maximum(within - EASE, 0.0))


def edge_skew(sine: Array, half_pitch: Array | float, sign: int, edge: int, least: float) -> Array:
    """Length |A| (...) at an edge where the camber line has the given sine; `least` is the skew of `CrossLines`."""
    outwards = 1.0 if edge else -1.0
    return half_pitch * (np.sqrt(sine * sine + least**2) - outwards * sign * sine)


@dataclass(frozen=True, kw_only=True)
class WallPatch(ABC):
    """A part of hub or shroud, along one or more of the pieces inlet, blade and outlet."""

    camber: CamberLines
    line: StreamLines
    """the duct's stream line along the wall"""
    row: int
    """which of the camber lines is that on the wall"""

    @abstractmethod
    def in_plane(self, piece: str, t: Reals, v: Reals) -> Array:
        """Points (..., k, l, 2) in (m', theta) at t (k,) along a piece and v (l,) across."""

    def in_space(self, piece: str, t: Reals, v: Reals) -> tuple[Array, Array]:
        """Points (..., k, l, 3) in metres, and the wall's unit normals there, towards the shroud."""
        plane = self.in_plane(piece, t, v)
        flat = plane.reshape(*plane.shape[:-3], 1, -1, 2)
        lines = self.line
        u = lines.u_at(flat[..., 0])
        position, slope = lines.position(u), unit(lines.position(u, 1))
        mapping, tangential = lines.mapping, flat[..., 1]
        points = mapping.in_space(position[..., 0], position[..., 1], tangential)
        normals = mapping.in_space(-slope[..., 1], slope[..., 0], tangential if mapping.revolved else 0.0 * tangential)
        shape = (*plane.shape[:-1], 3)
        return points.reshape(shape), normals.reshape(shape)


@dataclass(frozen=True, kw_only=True)
class WallHalf(WallPatch):
    """A half of a wall: above the blade, or below it."""

    sign: int
    """+1 above the blade, -1 below it"""
    beside_blade: bool
    """whether it lies beside the blade, or its continuation to the wall, and not along the camber line"""
    half_pitch: Array
    """() in theta, or y in a cascade"""
    departure: float
    """o in the formula"""
    cross_lines: CrossLines
    reaches: tuple[float, float]
    """shares of the way to inlet and outlet over which the skew fades"""

    def in_plane(self, piece: str, t: Reals, v: Reals) -> Array:
        middle = self.camber.points(piece, t)[..., self.row, :, :]
        width = self.sign * self.half_pitch[..., None, None] * np.array([0.0, 1.0])
        w = width_share(self.departure, v)
        if not self.beside_blade:
            return middle[..., None, :] + width[..., None, :] * w[:, None]
        own = self.camber.side(t, self.sign) if piece == "blade" else self.camber.points(piece, t, self.sign)
        south = own[..., self.row, :, :]
        north = middle + width
        g = self.departure * v * (1.0 - v) ** self.cross_lines.return_power
        across = (north - south)[..., None, :] * w[:, None]
        return south[..., None, :] + across + self._skew(piece, t)[..., None, :] * g[:, None]

    def _skew(self, piece: str, t: Reals) -> Array:
        """The vectors A (..., k, 2)."""
        if piece == "blade":
            power = self.cross_lines.fade_power
            return self._edge_skew(0) * ((1.0 - t) ** power)[:, None] + self._edge_skew(1) * (t**power)[:, None]
        if piece == "inlet":
            return self._edge_skew(0) * skew_share(t, self.reaches[0])[:, None]
        return self._edge_skew(1) * skew_share(1.0 - t, self.reaches[1])[:, None]

    def _edge_skew(self, edge: int) -> Array:
        direction = self.camber.direction(edge)[..., self.row, :]
        if self.camber.stations.edge_kinds[edge] != "round":
            return np.zeros_like(direction)[..., None, :]
        size = edge_skew(direction[..., 1], self.half_pitch, self.sign, edge, self.cross_lines.skew)
        magnitude = (1.0 if edge else -1.0) * size
        return magnitude[..., None, None] * direction[..., None, :]


def wall_halves(
    camber: CamberLines,
    beside_blade: Mapping[str, bool],
    half_pitch: Array,
    departures: tuple[float, float],
    cross_lines: CrossLines,
    reaches: tuple[float, float],
) -> dict[str, WallHalf]:
    """The four halves of hub (first station) and shroud (last), by the names of their faces."""
    lines = {row: camber.lines.rows([row]) for row in (0, -1)}
    return {
        f"{wall}_{half}": WallHalf(
            camber=camber,
            line=lines[row],
            row=row,
            sign=sign,
            beside_blade=beside_blade[wall],
            half_pitch=half_pitch,
            departure=departures[row],
            cross_lines=cross_lines,
            reaches=reaches,
        )
        for wall, row in (("hub", 0), ("shroud", -1))
        for half, sign in (("upper", 1), ("lower", -1))
    }


@dataclass(frozen=True, kw_only=True)
class WallStrip(WallPatch):
    """The strip of a wall past a blunt edge: as wide as its face, and straight across in the plane."""

    edge: int
    """0 upstream of the leading edge, 1 downstream of the trailing edge"""

    @property
    def piece(self) -> str:
        """The piece along the flow that it belongs to."""
        return "outlet" if self.edge else "inlet"

    def in_plane(self, piece: str, t: Reals, v: Reals) -> Array:
        lower, upper = (self.camber.points(piece, t, sign)[..., self.row, :, None, :] for sign in (-1, 1))
        return lower + (upper - lower) * v[:, None]


def wall_strips(camber: CamberLines, beside_blade: Mapping[str, bool]) -> dict[str, WallStrip]:
    """The strips of the walls whose halves lie beside the blade, by the names of their faces."""
    return {
        f"{wall}_{STRIPS[edge]}": WallStrip(camber=camber, line=camber.lines.rows([row]), row=row, edge=edge)
        for wall, row in (("hub", 0), ("shroud", -1))
        for edge, blunt in enumerate(camber.blunt)
        if blunt and beside_blade[wall]
    }
