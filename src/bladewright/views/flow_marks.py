"""Marks in a view in space: where the flow comes from, which way the row turns, and which side is the suction side."""

from typing import TYPE_CHECKING, Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from bladewright.numerics.elementary import length, unit
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface
from bladewright.views.raster import Camera
from bladewright.views.style import BLUE, INK, RED, per_metre

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade

REACH = 0.6
"""Length of the arrow of the flow, of the mean chord: as long as a blade is seen from its edge."""
MOST_OF_PICTURE = 0.22
"""Greatest length of that arrow, of the picture's longer side: beside long blades it would make them small."""
NAME_ROOM = 0.06
"""Room kept around the arrows for their names, of the picture's longer side: two lines of text."""
TURN = 0.35
"""Angle of the arrow of the rotation [rad], or its part of the chord in a cascade: seen as a bow, not as a circle."""
MARKED_AT = ((0.4, 0.5), (0.6, 0.6), (0.25, 0.4), (0.7, 0.35), (0.15, 0.75))
"""Places (u, v) of a side that are tried for its mark, from its middle on."""
POINT = 1.0 / 300.0
"""About how much of a picture's longer side a typographic point is: one in space is some 300 points wide."""
NAMED_AT, MARK_AT = 9.0, 38.0
"""Distances of an arrow's name from its start, and of the name of a side from its place, in points."""
DIRECTIONS = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
"""Directions in which the name of a side is tried [rad]."""
SHARES = np.linspace(0.0, 1.0, 5)
"""Places between a mark and its name that are to be clear of other names."""
FACING = 0.2
"""Cosine of the angle between a side and the view from which on its place is seen well enough for a mark."""
WIDER = 2.0
"""How much wider than high names are: so much further apart they must be beside each other than above."""
HALO = [withStroke(linewidth=3.0, foreground="white", alpha=0.8)]


def draw_marks(axes: Axes, blade: "Blade", camera: Camera) -> None:
    """Draw the arrows of the flow and of the rotation, and name the suction side where it faces the viewer."""
    stations = blade.exact.sections(np.array([0.5, 1.0]))
    ends = np.real(stations.lines.position(np.array([0.0, 1.0])))
    tip, _ = _edge(blade, 1.0, ends[1])
    start, upstream = _edge(blade, 0.5, ends[0])
    size = min(REACH * blade.chord, MOST_OF_PICTURE * _extent(camera) / per_metre())
    arrows = [("flow", BLUE, np.stack([start + 1.4 * size * upstream, start + 0.4 * size * upstream]))]
    turns = blade.design.turns
    if turns:
        arrows.append(("rotation", RED, bow(blade, tip, turns)))
    flat = [camera.seen(points * per_metre())[:, :2] for _, _, points in arrows]
    _make_room(axes, camera, np.concatenate(flat))
    for (name, colour, _), points in zip(arrows, flat, strict=True):
        _arrow(axes, points, colour, name)
    side = blade.suction_side
    if side is not None:
        names = [points[0] + POINT * NAMED_AT * _extent(camera) * unit(points[0] - points[-1]) for points in flat]
        _mark_side(axes, blade, camera, side, taken=np.concatenate([*flat, names]))


def _extent(camera: Camera) -> float:
    """The picture's longer side."""
    return float(np.max(camera.extent))


def _make_room(axes: Axes, camera: Camera, points: Reals) -> None:
    """Widen the picture until it holds points (n, 2) and a name beside them."""
    margin = NAME_ROOM * _extent(camera)
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    first, last = points.min(axis=0) - margin, points.max(axis=0) + margin
    axes.set_xlim(min(left, float(first[0])), max(right, float(last[0])))
    axes.set_ylim(min(low, float(first[1])), max(high, float(last[1])))


def _edge(blade: "Blade", v: float, meridian: Reals) -> tuple[Reals, Reals]:
    """The leading edge at v (3,) [m], and the direction upstream of it."""
    point = np.real(cast(Surface, blade.surfaces["upper"])(np.array([0.0]), np.array([v])))[0]
    x, r = unit(meridian[0] - meridian[1])
    if not blade.exact.mapping.revolved:
        return point, np.array([x, 0.0, r])
    theta = np.arctan2(point[1], point[2])
    return point, np.array([x, r * np.sin(theta), r * np.cos(theta)])


def bow(blade: "Blade", point: Reals, turns: int) -> Reals:
    """Points (n, 3) from a place on, the way that the row turns."""
    share = np.linspace(0.0, 1.0, 25)[:, None]
    if not blade.exact.mapping.revolved:
        return point + turns * TURN * blade.chord * share * np.array([0.0, 1.0, 0.0])
    radius, theta = 1.04 * length(point[1:]), np.arctan2(point[1], point[2]) + turns * TURN * share
    return np.concatenate([np.full_like(theta, point[0]), radius * np.sin(theta), radius * np.cos(theta)], axis=-1)


def _arrow(axes: Axes, flat: Reals, colour: str, name: str) -> None:
    """Draw an arrow along points (n, 2) of the picture, with its name at its start."""
    axes.plot(*flat.T, color=colour, linewidth=1.8, path_effects=HALO, clip_on=False)
    head: dict[str, Any] = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.8, "mutation_scale": 14.0}
    axes.annotate("", tuple(flat[-1]), xytext=tuple(flat[-2]), arrowprops={**head, "shrinkA": 0.0, "shrinkB": 0.0})
    away = NAMED_AT * unit(flat[0] - flat[-1])
    place: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "va": "center", "path_effects": HALO}
    axes.annotate(name, tuple(flat[0]), xytext=tuple(away), color=colour, **place)


def _mark_side(axes: Axes, blade: "Blade", camera: Camera, side: str, *, taken: Reals) -> None:
    """Name a side from a place on it, as far as can be from places (n, 2) of the picture that are taken."""
    face, tried = cast(Surface, blade.surfaces[side]), []
    for u, v in MARKED_AT:
        at = np.array([u]), np.array([v])
        outwards = blade.orientations[side] * np.real(face.normal(*at))[0]
        if float(outwards @ camera.axes[2]) > FACING:
            flat = camera.seen(np.real(face(*at))[0] * per_metre())[:2]
            tried.append((*_clearest(axes, flat, POINT * MARK_AT * _extent(camera), taken), flat))
    if not tried:
        return
    # the first has the best place on the side: others may lie behind a neighbour
    enough = NAME_ROOM * _extent(camera)
    _, way, flat = next((each for each in tried if each[0] > enough), max(tried, key=lambda each: each[0]))
    style: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "va": "center", "path_effects": HALO}
    line = {"arrowstyle": "-", "color": INK, "linewidth": 0.9, "shrinkA": 0.0, "shrinkB": 0.0}
    away = MARK_AT * way
    axes.annotate("suction\nside", (flat[0], flat[1]), xytext=(away[0], away[1]), arrowprops=line, **style)
    axes.plot(*flat, marker="o", markersize=3.0, color=INK)


def _clearest(axes: Axes, start: Reals, reach: float, taken: Reals) -> tuple[float, Reals]:
    """How far a name at a distance from a place keeps from what is taken at best, and in which direction (2,).

    Names past the edge of the picture come last.
    """
    ways = np.stack([np.cos(DIRECTIONS), np.sin(DIRECTIONS)], axis=-1)
    lines = start + reach * ways[:, None] * SHARES[:, None]
    gaps = np.min(length((lines[:, :, None] - taken) / np.array([WIDER, 1.0])), axis=(1, 2))
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    inside = (lines[:, -1] > [left, low]) & (lines[:, -1] < [right, high])
    gaps = np.where(inside.all(axis=1), gaps, gaps - (right - left + high - low))
    best = int(np.argmax(gaps))
    return float(gaps[best]), ways[best]
