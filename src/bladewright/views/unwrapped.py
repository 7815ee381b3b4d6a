"""A wall of a passage unwrapped: its plane (m', theta), or (m, y) of a cascade, with the lines of its two patches."""

from itertools import pairwise
from typing import TYPE_CHECKING, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from bladewright.domain.knots import BLADE_AT
from bladewright.numerics.elementary import angle, dot, length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface
from bladewright.views.sections import COORDINATES, along_curve
from bladewright.views.style import (
    BLUE,
    INK,
    LOWER,
    MILLIMETRES,
    ORANGE,
    RED,
    SOFT,
    UPPER,
    legend_below,
    span_colour,
    titled,
)

if TYPE_CHECKING:
    from bladewright.domain.passage import Passage

HALVES = ("upper", "lower")
COLOURS = {"hub": BLUE, "shroud": ORANGE}
USUALLY, CLOSELY = (9, 17, 9, 9), (101, 201, 101, 101)
"""lines of constant u on the three pieces of a patch, and of constant v"""
FINE = 65
"""places along a line"""
CLOSE = 0.03
"""half width of the surroundings of the least Jacobian, of the chord"""


def draw_unwrapped(axes: Axes, passage: "Passage", wall: str) -> None:
    """Draws the hub or the shroud in its plane [mm]: patches, blade, neighbours and periodic boundaries."""
    colour = COLOURS[wall]
    for half in HALVES:
        name = f"{wall}_{half}"
        lines = patch_lines(passage, name)
        axes.add_collection(LineCollection(lines, colors=colour, linewidths=0.5, alpha=0.55), autolim=False)
        edge = unwrapped_face(passage, name, _along_faces(), np.array([1.0]))[:, 0]
        label = None if half == "lower" else "periodic boundaries, the lower dashed"
        axes.plot(*edge.T, color=INK, linewidth=1.6, linestyle=UPPER if half == "upper" else LOWER, label=label)
        for u in (0.0, 1.0):
            end = unwrapped_face(passage, name, np.array([u]), np.linspace(0.0, 1.0, FINE))[0]
            axes.plot(*end.T, color=INK, linewidth=0.9)
    shape = blade_foot(passage, wall)
    _fill(axes, shape, passage, wall)
    for turn in (-1.0, 1.0):
        neighbour = shape + np.array([0.0, turn * pitch_on(passage, wall)])
        axes.plot(*neighbour.T, color=SOFT, linewidth=0.8, alpha=0.8)
    for half, marker in zip(HALVES, ("o", "s"), strict=True):
        share, u, v = passage.folds[f"{wall}_{half}"]
        place = unwrapped_face(passage, f"{wall}_{half}", np.array([u]), np.array([v]))[0, 0]
        label = f"{half}: {_said(share, u, v)}"
        axes.plot(*place, marker=marker, markersize=6.0, color=RED, fillstyle="none", linestyle="none", label=label)
    titled(axes, f"{wall.capitalize()} unwrapped", *_coordinates(passage))
    axes.set_aspect("equal", adjustable="datalim")
    legend_below(axes, 1)


def draw_tightest(axes: Axes, passage: "Passage") -> None:
    """Draws the surroundings of the place where a wall's Jacobian is least of all."""
    name, (share, u, v) = min(passage.folds.items(), key=lambda fold: fold[1][0])
    wall = name.partition("_")[0]
    place = unwrapped_face(passage, name, np.array([u]), np.array([v]))[0, 0]
    shape = blade_foot(passage, wall)
    reach = CLOSE * float(np.max(length(shape - shape[0])))
    for half in HALVES:
        lines = [
            line
            for line in patch_lines(passage, f"{wall}_{half}", CLOSELY)
            if np.any(np.all(np.abs(line - place) < 1.2 * reach, axis=-1))
        ]
        axes.add_collection(LineCollection(lines, colors=COLOURS[wall], linewidths=0.5, alpha=0.7), autolim=False)
    _fill(axes, shape, passage, wall)
    label = f"{name.replace('_', ' ')}: {_said(share, u, v)}"
    axes.plot(*place, marker="o", markersize=6.0, color=RED, fillstyle="none", linestyle="none", label=label)
    axes.set_xlim(place[0] - reach, place[0] + reach)
    axes.set_ylim(place[1] - reach, place[1] + reach)
    axes.set_aspect("equal", adjustable="box", anchor="N")
    titled(axes, "Where the Jacobian is least", *_coordinates(passage))
    legend_below(axes, 1)


def patch_lines(passage: "Passage", name: str, counts: tuple[int, int, int, int] = USUALLY) -> list[Reals]:
    """Lines of constant u, then of constant v, of a wall's native half: each (n, 2) in its plane [mm].

    `counts` are the lines of constant u on the pieces up to, beside and behind the blade, and those of constant v.
    """
    pieces = [np.linspace(*ends, count) for ends, count in zip(_pieces(), counts, strict=False)]
    across = unwrapped_face(passage, name, np.unique(np.concatenate(pieces)), along_curve(2 * FINE))
    along = unwrapped_face(passage, name, _along_faces(), np.linspace(0.0, 1.0, counts[3]))
    return [*across, *np.swapaxes(along, 0, 1)]


def unwrapped_face(passage: "Passage", name: str, u: Reals, v: Reals) -> Reals:
    """Points (k, l, 2) at u (k,) and v (l,) of a wall's native half in its plane [mm]."""
    face = cast(Surface, passage.whole[name])
    return unwrapped(passage, name.partition("_")[0], np.real(face.grid(u, v)))


def blade_foot(passage: "Passage", wall: str) -> Reals:
    """The closed outline (n, 2) in the wall's plane [mm] of the blade's end on or nearest to it."""
    end = np.array([0.0 if wall == "hub" else 1.0])
    sides = [cast(Surface, passage.whole[f"blade_{half}"]).grid(along_curve(), end)[:, 0] for half in HALVES]
    return unwrapped(passage, wall, np.real(np.concatenate([sides[0], sides[1][::-1]])))


def pitch_on(passage: "Passage", wall: str) -> float:
    """Distance of neighbours in the wall's plane [mm]."""
    return 2.0 * float(np.real(passage.walls[f"{wall}_upper"].half_pitch)) * size_on(passage, wall)


def size_on(passage: "Passage", wall: str) -> float:
    """Millimetres in a unit of the wall's plane: the mean radius beside the blade, or a metre's in a cascade."""
    if not passage.duct.revolved:
        return MILLIMETRES
    line = passage.walls[f"{wall}_upper"].line
    return float(np.mean(np.real(line.position(np.linspace(0.0, 1.0, 65))[..., 1]))) * MILLIMETRES


def unwrapped(passage: "Passage", wall: str, points: Reals) -> Reals:
    """Points (..., 3) [m] on or near a wall in its plane (..., 2) [mm], by the nearest place of its meridian."""
    x, y, z = np.moveaxis(points.reshape(-1, 3), -1, 0)
    radius, tangential = (np.sqrt(y * y + z * z), angle(y, z)) if passage.duct.revolved else (z, y)
    line = passage.walls[f"{wall}_upper"].line
    places = np.linspace(-passage.duct.upstream, 1.0 + passage.duct.downstream, 2001)
    meridian, target = np.real(line.position(places))[0], np.stack([x, radius], axis=-1)
    u = places[_nearest(meridian, target)]
    for _ in range(3):
        slope = np.real(line.position(u, 1))[0]
        u = u + dot(target - np.real(line.position(u))[0], slope) / dot(slope, slope)
    plane = np.stack([np.real(line.abscissa(u))[0], tangential], axis=-1) * size_on(passage, wall)
    return np.asarray(plane.reshape(*points.shape[:-1], 2))


def _nearest(meridian: Reals, points: Reals) -> Reals:
    from scipy.spatial import cKDTree

    return np.asarray(cKDTree(meridian).query(points)[1])


def _pieces() -> tuple[tuple[float, float], ...]:
    return tuple(pairwise((0.0, *BLADE_AT, 1.0)))


def _along_faces() -> Reals:
    """Places along the flow, dense towards the blade's edges."""
    return np.unique(np.concatenate([low + (high - low) * along_curve(2 * FINE) for low, high in _pieces()]))


def _said(share: float, u: float, v: float) -> str:
    return f"least Jacobian {share:.2g} of its median, at u = {u:.3g}, v = {v:.3g}"


def _coordinates(passage: "Passage") -> tuple[str, str]:
    return COORDINATES["m'-theta" if passage.duct.revolved else "m-y"]


def _fill(axes: Axes, shape: Reals, passage: "Passage", wall: str) -> None:
    """The blade's foot; where it stands off the wall, the outline of its tip."""
    touched = passage.walls[f"{wall}_upper"].touched
    colour = span_colour(0.0 if wall == "hub" else 1.0)
    if touched:
        axes.fill(*shape.T, color=colour, alpha=0.25, linewidth=0.0)
    axes.plot(*shape.T, color=colour, linestyle="-" if touched else ":", label=None if touched else "tip, off the wall")
