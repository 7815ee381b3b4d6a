"""Control nets of a passage's faces: neighbours share their boundary control points exactly."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from bladewright.blade.native.knots import DEGREE
from bladewright.domain.camber_lines import CamberLines
from bladewright.domain.knots import PIECES, PassageKnots
from bladewright.domain.walls import STRIPS, WallHalf, WallStrip, width_share
from bladewright.numerics.elementary import Array, concatenated
from bladewright.nurbs.basis import Reals, basis, greville

_HALVES = (("upper", 1.0), ("lower", -1.0))
"""The halves of walls, and to which side of the camber surface they lie."""


class BladeNets(NamedTuple):
    """The blade's control nets (..., n_u, n_v, 3)."""

    upper: Array
    lower: Array
    edges: Sequence[Array | None]
    """those of the faces of leading and trailing edge where these are blunt, u from the upper to the lower side"""


def native_nets(
    camber: CamberLines,
    walls: Mapping[str, WallHalf],
    strips: Mapping[str, WallStrip],
    blade: BladeNets,
    knots: PassageKnots,
    half_pitch: Array,
) -> dict[str, Array]:
    """Control nets (..., n_u, n_v, 3) of the walls' halves and strips, the periodic boundaries, inlet and outlet.

    Patches are interpolated, and then given the boundary control points of the neighbours that they join: the walls
    that the blade stands on those of the blade's ends.
    """
    middle = middle_net(camber, knots)
    periodic = {f"periodic_{half}": shifted(camber, middle, sign * half_pitch) for half, sign in _HALVES}
    nets = dict(periodic)
    for name, wall in walls.items():
        half = name.removeprefix("hub_").removeprefix("shroud_")
        line = _beside(wall, blade, knots) if wall.beside_blade else middle[..., wall.row, :]
        nets[name] = _with_ends(_wall(wall, knots), line, periodic[f"periodic_{half}"][..., wall.row, :], -2)
    for name, strip in strips.items():
        wall_name = name.partition("_")[0]
        lines = [nets[f"{wall_name}_{half}"][..., 0, :] for half in ("lower", "upper")]
        nets[name] = _strip(strip, blade, lines, knots)
    for name, end in (("inlet", 0), ("outlet", -1)):
        nets[name] = _open_end(camber, walls, nets, knots, end)
    return nets


def _along(points: Mapping[str, Array], knots: PassageKnots, axis: int) -> Array:
    """Control points of the spline through points of the three pieces, which share those at the edges."""
    parts = [through(points[piece], getattr(knots, piece), axis) for piece in PIECES]
    taken = [np.take(part, np.arange(1, part.shape[axis]), axis=axis) for part in parts[1:]]
    return np.concatenate([parts[0], *taken], axis=axis)


def through(points: Array, knots: Reals, axis: int) -> Array:
    """Control points of the spline of degree DEGREE through points at its Greville abscissae, along an axis."""
    matrix = basis(knots, DEGREE, greville(knots, DEGREE))
    moved = np.moveaxis(points, axis, 0)
    solved = np.linalg.solve(matrix, moved.reshape(len(matrix), -1))
    return np.moveaxis(solved.reshape(moved.shape), 0, axis)


def middle_net(camber: CamberLines, knots: PassageKnots) -> Array:
    """Net of the continued camber surface, u along the flow and v along the span."""
    points = {}
    for piece in PIECES:
        plane = camber.points(piece, knots.sites(piece))
        position = camber.lines.position(camber.lines.u_at(plane[..., 0]))
        points[piece] = camber.lines.mapping.in_space(position[..., 0], position[..., 1], plane[..., 1])
    return np.swapaxes(through(_along(points, knots, -2), knots.span, -3), -3, -2)


def _wall(wall: WallHalf, knots: PassageKnots) -> Array:
    """Net of a wall's half, u along the flow and v from the blade to the periodic boundary."""
    v = knots.sites("across")
    points = {piece: wall.in_space(piece, knots.sites(piece), v)[0] for piece in PIECES}
    return through(_along(points, knots, -3), knots.across, -2)


def _beside(wall: WallHalf, blade: BladeNets, knots: PassageKnots) -> Array:
    """Control points along the blade's side at a wall, continued along the camber to inlet and outlet."""
    camber = wall.camber
    ahead, behind = (
        through(_line_in_space(camber, wall, piece, knots.sites(piece)), getattr(knots, piece), -2)
        for piece in ("inlet", "outlet")
    )
    side = (blade.upper if wall.sign > 0 else blade.lower)[..., : _poles(knots.blade), wall.row, :]
    return concatenated([ahead[..., :-1, :], side, behind[..., 1:, :]], -2)


def _line_in_space(camber: CamberLines, wall: WallHalf, piece: str, t: Reals) -> Array:
    """Points (..., k, 3) of the line that continues a half's side."""
    plane = camber.points(piece, t, wall.sign)[..., wall.row, :, :][..., None, :, :]
    position = wall.line.position(wall.line.u_at(plane[..., 0]))
    return wall.line.mapping.in_space(position[..., 0], position[..., 1], plane[..., 1])[..., 0, :, :]


def _poles(knots: Reals) -> int:
    return len(knots) - DEGREE - 1


def _strip(strip: WallStrip, blade: BladeNets, lines: Sequence[Array], knots: PassageKnots) -> Array:
    """Net of a strip between the lower and the upper half, which run along `lines` (..., n, 3) from inlet to outlet."""
    sites = knots.sites(strip.piece)
    across = knots.strip(strip.edge)
    net = through(strip.in_space(strip.piece, sites, greville(across, DEGREE))[0], getattr(knots, strip.piece), -3)
    net = through(net, across, -2)
    part = slice(-len(sites), None) if strip.edge else slice(len(sites))
    face = blade.edges[strip.edge]
    if face is None:
        lower, upper = (side[..., _poles(knots.blade) - 1 :, strip.row, :] for side in (blade.lower, blade.upper))
        own = concatenated([lower, upper[..., -2::-1, :]], -2)
    else:
        own = face[..., ::-1, strip.row, :]
    far = net[..., -1 if strip.edge else 0, :, :]
    net = _with_ends(net, *((own, far) if strip.edge else (far, own)), -3)
    return _with_ends(net, lines[0][..., part, :], lines[1][..., part, :], -2)


def _open_end(
    camber: CamberLines, walls: Mapping[str, WallHalf], nets: Mapping[str, Array], knots: PassageKnots, end: int
) -> Array:
    """Net of inlet (0) or outlet (-1): u from the lower to the upper periodic boundary, v along the span."""
    piece, t = (PIECES[0], 0.0) if end == 0 else (PIECES[-1], 1.0)
    plane = camber.points(piece, np.array([t]))
    position = camber.lines.position(camber.lines.u_at(plane[..., 0]))
    v, across = knots.sites("span")[:, None], knots.sites("across")
    share = (1.0 - v) * width_share(knots.departures[0], across) + v * width_share(knots.departures[1], across)
    half = walls["hub_upper"].half_pitch[..., None, None]
    edges = {sign: camber.points(piece, np.array([t]), sign)[..., 1] for sign in (-1, 1)}

    def part(tangential: Array, along: Reals) -> Array:
        x, radius = (np.broadcast_to(position[..., i], tangential.shape) for i in (0, 1))
        points = camber.lines.mapping.in_space(x, radius, tangential)
        return through(through(points, along, -2), knots.span, -3)

    lower, upper = (
        part(edges[sign] + (plane[..., 1] + sign * half - edges[sign]) * share, knots.across) for sign in (-1, 1)
    )
    parts, named = [lower[..., ::-1, :], upper[..., 1:, :]], []
    if knots.blunt[end]:
        width = knots.strip(end % 2)
        strip = part(edges[-1] + (edges[1] - edges[-1]) * greville(width, DEGREE), width)
        parts[1:1] = [strip[..., 1:, :]]
        named = [STRIPS[end]]
    net = concatenated(parts, -2)
    hub, shroud = (
        concatenated(
            [
                nets[f"{name}_lower"][..., end, ::-1, :],
                *(nets[f"{name}_{strip}"][..., end, 1:, :] for strip in named),
                nets[f"{name}_upper"][..., end, 1:, :],
            ],
            -2,
        )
        for name in ("hub", "shroud")
    )
    lower, upper = (nets[f"periodic_{half}"][..., end, :, :] for half in ("lower", "upper"))
    return np.swapaxes(_with_ends(_with_ends(net, hub, shroud, -3), lower, upper, -2), -3, -2)


def _with_ends(net: Array, first: Array, last: Array, axis: int) -> Array:
    """The net with other control points at both ends of an axis."""
    inner = np.take(net, np.arange(1, net.shape[axis] - 1), axis=axis)
    return concatenated([np.expand_dims(first, axis), inner, np.expand_dims(last, axis)], axis)


def shifted(camber: CamberLines, net: Array, by: Array) -> Array:
    """A net rotated about the machine axis by theta, or translated along y in a cascade."""
    x, y, z = np.moveaxis(net, -1, 0)
    by = by[..., None, None]
    if not camber.lines.mapping.revolved:
        return np.stack(np.broadcast_arrays(x, y + by, z), axis=-1)
    return np.stack([x, y * np.cos(by) + z * np.sin(by), z * np.cos(by) - y * np.sin(by)], axis=-1)
