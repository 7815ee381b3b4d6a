"""Hub and shroud of a passage unwrapped: the grid of their patches, and where it is nearest to folding."""

from itertools import pairwise
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from scipy.spatial import cKDTree

from bladewright.blade.flow_path.streamlines import StreamLines
from bladewright.domain.knots import BLADE_AT, PIECES
from bladewright.numerics.elementary import angle, dot, length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface
from bladewright.views.sections import ISOLATED_PITCH, coordinates, cosine_spacing
from bladewright.views.style import (
    BLUE,
    INK,
    LOWER,
    ORANGE,
    RED,
    SOFT,
    UPPER,
    label_axes,
    legend_below,
    per_metre,
    span_colour,
)

if TYPE_CHECKING:
    from bladewright.domain.passage import Passage


HALVES = ("upper", "lower")
"""The halves of a wall, above and below the blade."""
ROWS = {"hub": 0, "shroud": -1}
"""Which of the camber lines is that on a wall."""
COLOURS = {"hub": BLUE, "shroud": ORANGE}
"""Colours of the grid lines on each wall."""
ALONG, ACROSS = (9, 17, 9), 9
"""Lines of constant u before, beside and behind the blade, and lines of constant v: twice as many beside the blade,
where the patch is twice as long in u."""
LINE_POINTS = 65
"""Points along a line."""
MAX_ASPECT = 6.0
"""Height over width of a wall in its plane above which the two axes have different scales: the panel would otherwise
show a thin strip."""
CLOSE_UP = 0.03
"""Half width of the close-up of the least Jacobian, in chords."""
CLOSE_UP_U = 0.2
"""Half width in u of the part of a patch that the close-up may show; it must be more than the close-up needs."""
CLOSE_UP_LINES = 25
"""Lines of constant u, and of constant v, on each side of that place."""
MARK: dict[str, Any] = {"markersize": 6.0, "color": RED, "fillstyle": "none", "linestyle": "none"}
"""Style of the marks at the least Jacobian."""


def unwrapped_face(passage: "Passage", name: str, u: Reals, v: Reals) -> Reals:
    """Points (k, l, 2) at u (k,) and v (l,) of a wall's native half in its plane [mm]."""
    face, half = cast(Surface, passage.whole[name]), passage.walls[name]
    offset = half.sign * float(np.real(half.half_pitch)) * np.broadcast_to(v, (len(u), len(v)))
    return unwrapped(passage, name.partition("_")[0], np.real(face.grid(u, v)), offset)


def blade_end_outline(passage: "Passage", wall: str) -> Reals:
    """Closed outline (n, 2) in the wall's plane [mm] of the blade's end at this wall."""
    end = np.array([0.0 if wall == "hub" else 1.0])
    if passage.skin is not None and wall in passage.blade.design.ends:
        curves = passage.blade.end_outline(wall)
        points = [curve(low + (high - low) * cosine_spacing()) for curve in curves for low, high in [curve.domain]]
        return unwrapped(passage, wall, np.real(np.concatenate(points)))
    sides = [cast(Surface, passage.whole[f"blade_{half}"]).grid(cosine_spacing(), end)[:, 0] for half in HALVES]
    return unwrapped(passage, wall, np.real(np.concatenate([sides[0], sides[1][::-1]])))


def wall_pitch(passage: "Passage", wall: str) -> float:
    """Distance between neighbours in the wall's plane [mm]."""
    return 2.0 * float(np.real(passage.half_pitch)) * wall_scale(passage, wall)


def wall_scale(passage: "Passage", wall: str) -> float:
    """Millimetres in one unit of the wall's plane: the wall's mean radius beside the blade, or a metre in a cascade."""
    if not passage.duct.revolved:
        return per_metre()
    line = wall_line(passage, wall)
    return float(np.mean(np.real(line.position(np.linspace(0.0, 1.0, 65))[..., 1]))) * per_metre()


def wall_line(passage: "Passage", wall: str) -> StreamLines:
    """The duct's stream line along a wall."""
    return passage.camber.lines.rows([ROWS[wall]])


def wall_coordinates(passage: "Passage") -> tuple[str, str]:
    """Names of the axes of the plane."""
    return coordinates("m'-theta" if passage.duct.revolved else "m-y")


def unwrapped(passage: "Passage", wall: str, points: Reals, offset: Reals | float = 0.0) -> Reals:
    """Points (..., 3) [m] on or near a wall, in its plane (..., 2) [mm], by the closest point of its meridian.

    `offset` (...) is the expected theta relative to the continued camber line [rad], which decides between full turns.
    """
    x, y, z = np.moveaxis(points, -1, 0)
    revolved, line = passage.duct.revolved, wall_line(passage, wall)
    meridional = np.stack([x, np.sqrt(y * y + z * z) if revolved else z], axis=-1).reshape(-1, 2)
    places = np.linspace(passage.duct.low, passage.duct.high, 2001)
    u = places[cKDTree(np.real(line.position(places))[0]).query(meridional)[1]]
    for _ in range(3):
        slope = np.real(line.position(u, 1))[0]
        u = u + dot(meridional - np.real(line.position(u))[0], slope) / dot(slope, slope)
    abscissa = np.real(line.abscissa(u))[0].reshape(points.shape[:-1])
    ordinate = y
    if revolved:
        expected = _camber_theta(passage, wall, abscissa) + offset
        ordinate = expected + np.mod(angle(y, z) - expected + np.pi, 2.0 * np.pi) - np.pi
    return np.asarray(np.stack([abscissa, ordinate], axis=-1) * wall_scale(passage, wall))


def _camber_theta(passage: "Passage", wall: str, abscissa: Reals) -> Reals:
    """theta (...) of the wall's continued camber line at abscissae (...)."""
    row, t = ROWS[wall], np.linspace(0.0, 1.0, 101)
    line = np.concatenate([np.real(passage.camber.points(piece, t))[row] for piece in PIECES])
    return np.asarray(np.interp(abscissa, line[:, 0], line[:, 1]))


def draw_wall(axes: Axes, passage: "Passage", wall: str) -> None:
    """Draw the hub or the shroud in its plane [mm]: patches, blade, neighbours and periodic boundaries."""
    if passage.skin is None:
        _draw_patches(axes, passage, wall)
    else:
        _draw_trimmed(axes, passage, wall)
    shape, pitch = blade_end_outline(passage, wall), wall_pitch(passage, wall)
    _draw_blade_end(axes, passage, wall, shape)
    for turn in (-1.0, 1.0) if pitch < ISOLATED_PITCH * _chord(shape) else ():
        axes.plot(*(shape + np.array([0.0, turn * pitch])).T, color=SOFT, linewidth=0.8, alpha=0.8)
    for half, marker in zip(HALVES, ("o", "s"), strict=True) if passage.skin is None else ():
        share, u, v = passage.folds[f"{wall}_{half}"]
        place = unwrapped_face(passage, f"{wall}_{half}", np.array([u]), np.array([v]))[0, 0]
        axes.plot(*place, marker=marker, label=f"{half}: least Jacobian {_jacobian_text(share, u, v)}", **MARK)
    slender = axes.dataLim.height > MAX_ASPECT * axes.dataLim.width
    kind = "unwrapped" if passage.skin is None else "unwrapped, one trimmed face"
    title = f"{wall.capitalize()} {kind}{', compressed upright' if slender else ''}"
    label_axes(axes, title, *wall_coordinates(passage))
    axes.set_aspect("auto" if slender else "equal", adjustable="datalim")
    legend_below(axes, 1)


def _draw_trimmed(axes: Axes, passage: "Passage", wall: str) -> None:
    """The outline of a trimmed wall."""
    end = np.array([0.0 if wall == "hub" else 1.0])
    for half, sign, style in (("upper", 1.0, UPPER), ("lower", -1.0, LOWER)):
        points = cast(Surface, passage.whole[f"periodic_{half}"]).grid(_stations_along(), end)[:, 0]
        edge = unwrapped(passage, wall, np.real(points), sign * float(np.real(passage.half_pitch)))
        label = "periodic boundaries, the lower dashed" if sign > 0.0 else None
        axes.plot(*edge.T, color=INK, linewidth=1.6, linestyle=style, label=label)
    for name in ("inlet", "outlet"):
        u = np.linspace(0.0, 1.0, LINE_POINTS)
        points = np.real(cast(Surface, passage.whole[name]).grid(u, end)[:, 0])
        offset = float(np.real(passage.half_pitch)) * (2.0 * u - 1.0)
        axes.plot(*unwrapped(passage, wall, points, offset).T, color=INK, linewidth=0.9)


def _draw_patches(axes: Axes, passage: "Passage", wall: str) -> None:
    """The halves of a wall, with lines of constant u and v."""
    for half, style in zip(HALVES, (UPPER, LOWER), strict=True):
        name = f"{wall}_{half}"
        lines = LineCollection(patch_lines(passage, name), colors=COLOURS[wall], linewidths=0.5, alpha=0.55)
        axes.add_collection(lines, autolim=False)
        edge = unwrapped_face(passage, name, _stations_along(), np.array([1.0]))[:, 0]
        label = "periodic boundaries, the lower dashed" if half == "upper" else None
        axes.plot(*edge.T, color=INK, linewidth=1.6, linestyle=style, label=label)
        for end in unwrapped_face(passage, name, np.array([0.0, 1.0]), np.linspace(0.0, 1.0, LINE_POINTS)):
            axes.plot(*end.T, color=INK, linewidth=0.9)


def draw_least_jacobian(axes: Axes, passage: "Passage") -> None:
    """Draw a close-up of the place where the Jacobian of the walls is least."""
    name, (share, u, v) = min(passage.folds.items(), key=lambda fold: fold[1][0])
    wall = name.partition("_")[0]
    place = unwrapped_face(passage, name, np.array([u]), np.array([v]))[0, 0]
    shape = blade_end_outline(passage, wall)
    half_width = CLOSE_UP * _chord(shape)
    for half in HALVES:
        lines = patch_lines_near(passage, f"{wall}_{half}", place, u, half_width)
        axes.add_collection(LineCollection(lines, colors=COLOURS[wall], linewidths=0.5, alpha=0.7), autolim=False)
    _draw_blade_end(axes, passage, wall, shape)
    axes.plot(*place, marker="o", label=f"{name.replace('_', ' ')}: {_jacobian_text(share, u, v)}", **MARK)
    axes.set_xlim(place[0] - half_width, place[0] + half_width)
    axes.set_ylim(place[1] - half_width, place[1] + half_width)
    axes.set_aspect("equal", adjustable="box", anchor="N")
    label_axes(axes, "Where the Jacobian is least", *wall_coordinates(passage))
    legend_below(axes, 1)


def patch_lines(passage: "Passage", name: str) -> list[Reals]:
    """Lines of constant u, then of constant v, on a native half of a wall: each (n, 2) in its plane [mm]."""
    pieces = [np.linspace(*ends, count) for ends, count in zip(_pieces(), ALONG, strict=True)]
    across = unwrapped_face(passage, name, np.unique(np.concatenate(pieces)), np.linspace(0.0, 1.0, LINE_POINTS))
    along = unwrapped_face(passage, name, _stations_along(), np.linspace(0.0, 1.0, ACROSS))
    return [*across, *np.swapaxes(along, 0, 1)]


def patch_lines_near(passage: "Passage", name: str, place: Reals, u: float, half_width: float) -> list[Reals]:
    """Lines as `patch_lines`, but within about `half_width` of a place (2,) in the plane, which is near u.

    They are chosen such that they pass the place at equal steps of the distance.
    """
    along = np.linspace(max(0.0, u - CLOSE_UP_U), min(1.0, u + CLOSE_UP_U), 4 * LINE_POINTS)
    across = np.linspace(0.0, 1.0, 2 * LINE_POINTS) ** 2
    distances = length(unwrapped_face(passage, name, along, across) - place)
    along, across = (
        _at_equal_distances(each, distances.min(axis=axis), half_width) for each, axis in ((along, 1), (across, 0))
    )
    edges = [edge for edge in BLADE_AT if along[0] < edge < along[-1]]
    fine = np.union1d(np.linspace(along[0], along[-1], 4 * LINE_POINTS), edges)
    lines = [*unwrapped_face(passage, name, along, np.linspace(across[0], across[-1], 2 * LINE_POINTS))]
    return [*lines, *np.swapaxes(unwrapped_face(passage, name, fine, across), 0, 1)]


def _at_equal_distances(parameter: Reals, distance: Reals, half_width: float) -> Reals:
    """Parameters on both sides of the nearest one, at equal steps of the distance."""
    nearest, steps = int(np.argmin(distance)), 1.6 * half_width * np.linspace(0.0, 1.0, CLOSE_UP_LINES)
    sides = (slice(nearest, None, -1), slice(nearest, None))
    return np.unique([np.interp(steps, np.maximum.accumulate(distance[side]), parameter[side]) for side in sides])


def _draw_blade_end(axes: Axes, passage: "Passage", wall: str, shape: Reals) -> None:
    """Draw the end of the blade on the wall; where it stands off the wall, the outline of its tip."""
    colour = span_colour(0.0 if wall == "hub" else 1.0)
    if wall in passage.blade.design.ends:
        axes.fill(*shape.T, color=colour, alpha=0.25, linewidth=0.0)
        axes.plot(*shape.T, color=colour)
    else:
        axes.plot(*shape.T, color=colour, linestyle=":", label="tip, off the wall")


def _pieces() -> tuple[tuple[float, float], ...]:
    """Ranges of u before, beside and behind the blade."""
    return tuple(pairwise((0.0, *BLADE_AT, 1.0)))


def _stations_along() -> Reals:
    """Parameters u along the flow, dense towards the blade's edges."""
    return np.unique(np.concatenate([low + (high - low) * cosine_spacing(2 * LINE_POINTS) for low, high in _pieces()]))


def _chord(shape: Reals) -> float:
    """Distance of the point of a closed outline farthest from its first point, the leading edge."""
    return float(np.max(length(shape - shape[0])))


def _jacobian_text(share: float, u: float, v: float) -> str:
    return f"{share:.2g} of its median, at u = {round(u, 3):g}, v = {round(v, 3):g}"
