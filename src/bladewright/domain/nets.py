"""Control nets of a passage's faces: neighbours share their boundary control points exactly."""

from collections.abc import Mapping

import numpy as np

from bladewright.blade.knots import DEGREE
from bladewright.domain.camber import CamberLines
from bladewright.domain.knots import PIECES, PassageKnots
from bladewright.domain.wall import WallHalf, widening
from bladewright.numerics.elementary import Array, joined
from bladewright.nurbs.basis import Reals, basis, greville


def native_nets(
    camber: CamberLines,
    walls: Mapping[str, WallHalf],
    sides: tuple[Array, Array],
    knots: PassageKnots,
    half_pitch: Array,
) -> dict[str, Array]:
    """Control nets (..., n_u, n_v, 3) of the walls' halves, the periodic boundaries, inlet and outlet.

    `sides` are the nets of the blade's upper and lower side, whose ends the walls that the blade stands on take over.
    """
    middle = _middle(camber, knots)
    shifted = {f"periodic_{half}": _shifted(camber, middle, sign * half_pitch) for half, sign in _HALVES}
    nets = dict(shifted)
    for name, wall in walls.items():
        half = name.removeprefix("hub_").removeprefix("shroud_")
        net = _wall(wall, knots)
        line = middle[..., wall.row, :]
        if wall.touched:
            line = _with_blade(line, sides[0 if wall.sign > 0 else 1][..., wall.row, :], knots)
        nets[name] = _edged(net, line, shifted[f"periodic_{half}"][..., wall.row, :], -2)
    for name, end in (("inlet", 0), ("outlet", -1)):
        nets[name] = _opening(camber, walls, nets, knots, end)
    return nets


_HALVES = (("upper", 1.0), ("lower", -1.0))


def _along(points: Mapping[str, Array], knots: PassageKnots, axis: int) -> Array:
    """Control points through points of the three pieces, which share those at the edges."""
    parts = [through(points[piece], getattr(knots, piece), axis) for piece in PIECES]
    taken = [np.take(part, np.arange(1, part.shape[axis]), axis=axis) for part in parts[1:]]
    return np.concatenate([parts[0], *taken], axis=axis)


def through(points: Array, knots: Reals, axis: int) -> Array:
    """Control points of the spline of degree DEGREE through points at its Greville abscissae, along an axis."""
    matrix = basis(knots, DEGREE, greville(knots, DEGREE))
    moved = np.moveaxis(points, axis, 0)
    solved = np.linalg.solve(matrix, moved.reshape(len(matrix), -1))
    return np.moveaxis(solved.reshape(moved.shape), 0, axis)


def _middle(camber: CamberLines, knots: PassageKnots) -> Array:
    """Net of the continued camber surface: u along the flow, v along the span."""
    points = {}
    for piece in PIECES:
        plane = camber.points(piece, knots.sites(piece))
        position = camber.lines.position(camber.lines.u_at(plane[..., 0]))
        points[piece] = camber.lines.mapping.in_space(position[..., 0], position[..., 1], plane[..., 1])
    return np.swapaxes(through(_along(points, knots, -2), knots.span, -3), -3, -2)


def _wall(wall: WallHalf, knots: PassageKnots) -> Array:
    v = knots.sites("across")
    points = {piece: wall.in_space(piece, knots.sites(piece), v)[0] for piece in PIECES}
    return through(_along(points, knots, -3), knots.across, -2)


def _with_blade(line: Array, side: Array, knots: PassageKnots) -> Array:
    """The continued camber line's control points with those of a side's end between its edges."""
    first, last = (len(getattr(knots, piece)) - DEGREE - 1 for piece in ("inlet", "outlet"))
    return joined([line[..., : first - 1, :], side, line[..., line.shape[-2] - last + 1 :, :]], -2)


def _opening(
    camber: CamberLines, walls: Mapping[str, WallHalf], nets: Mapping[str, Array], knots: PassageKnots, end: int
) -> Array:
    """Net of inlet (0) or outlet (-1): u from the lower to the upper periodic boundary, v along the span."""
    piece, t = (PIECES[0], 0.0) if end == 0 else (PIECES[-1], 1.0)
    plane = camber.points(piece, np.array([t]))
    position = camber.lines.position(camber.lines.u_at(plane[..., 0]))
    v, across = knots.sites("span")[:, None], knots.sites("across")
    share = (1.0 - v) * widening(knots.opening[0], across) + v * widening(knots.opening[1], across)
    halves = []
    for wall in (walls["hub_upper"], walls["hub_lower"]):
        tangential = plane[..., 1] + wall.sign * wall.half_pitch[..., None, None] * share
        x, radius = (np.broadcast_to(position[..., i], tangential.shape) for i in (0, 1))
        points = camber.lines.mapping.in_space(x, radius, tangential)
        halves.append(through(through(points, knots.across, -2), knots.span, -3))
    net = np.concatenate([halves[1][..., ::-1, :], halves[0][..., 1:, :]], axis=-2)
    hub, shroud = (
        joined([nets[f"{name}_lower"][..., end, ::-1, :], nets[f"{name}_upper"][..., end, 1:, :]], -2)
        for name in ("hub", "shroud")
    )
    lower, upper = (nets[f"periodic_{half}"][..., end, :, :] for half in ("lower", "upper"))
    return np.swapaxes(_edged(_edged(net, hub, shroud, -3), lower, upper, -2), -3, -2)


def _edged(net: Array, first: Array, last: Array, axis: int) -> Array:
    """The net with other control points at both ends of an axis."""
    inner = np.take(net, np.arange(1, net.shape[axis] - 1), axis=axis)
    return joined([np.expand_dims(first, axis), inner, np.expand_dims(last, axis)], axis)


def _shifted(camber: CamberLines, net: Array, by: Array) -> Array:
    """A net turned about the machine axis by theta, or moved along y in a cascade."""
    x, y, z = np.moveaxis(net, -1, 0)
    by = by[..., None, None]
    if not camber.lines.mapping.revolved:
        return np.stack(np.broadcast_arrays(x, y + by, z), axis=-1)
    return np.stack([x, y * np.cos(by) + z * np.sin(by), z * np.cos(by) - y * np.sin(by)], axis=-1)
