"""Hub and shroud of a passage unwrapped: the lines of their patches, and where these are nearest to folding."""

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from bladewright.domain.knots import BLADE_AT
from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals
from bladewright.views.sections import ALONE, along_curve
from bladewright.views.style import BLUE, INK, LOWER, ORANGE, RED, SOFT, UPPER, legend_below, span_colour, titled
from bladewright.views.unwrapped import HALVES, blade_foot, coordinates, pitch_on, unwrapped_face

if TYPE_CHECKING:
    from bladewright.domain.passage import Passage

COLOURS = {"hub": BLUE, "shroud": ORANGE}
ALONG, ACROSS = (9, 17, 9), 9
"""lines of constant u on the three pieces of a patch, and of constant v"""
FINE = 65
"""places along a line"""
SLENDER = 6.0
"""height of a wall in its plane, in widths, above which lengths are not equal on both axes"""
REACH = 0.03
"""half width of the surroundings of the least Jacobian, of the chord"""
BESIDE = 0.2
"""half width in u of what may be drawn there"""
CLOSELY = 25
"""lines of constant u, and of constant v, to each side of the place"""
MARK: dict[str, Any] = {"markersize": 6.0, "color": RED, "fillstyle": "none", "linestyle": "none"}


def draw_wall(axes: Axes, passage: "Passage", wall: str) -> None:
    """Draws the hub or the shroud in its plane [mm]: patches, blade, neighbours and periodic boundaries."""
    for half, style in zip(HALVES, (UPPER, LOWER), strict=True):
        name = f"{wall}_{half}"
        lines = LineCollection(patch_lines(passage, name), colors=COLOURS[wall], linewidths=0.5, alpha=0.55)
        axes.add_collection(lines, autolim=False)
        edge = unwrapped_face(passage, name, _along(), np.array([1.0]))[:, 0]
        label = "periodic boundaries, the lower dashed" if half == "upper" else None
        axes.plot(*edge.T, color=INK, linewidth=1.6, linestyle=style, label=label)
        for end in unwrapped_face(passage, name, np.array([0.0, 1.0]), np.linspace(0.0, 1.0, FINE)):
            axes.plot(*end.T, color=INK, linewidth=0.9)
    shape, pitch = blade_foot(passage, wall), pitch_on(passage, wall)
    _draw_foot(axes, passage, wall, shape)
    for turn in (-1.0, 1.0) if pitch < ALONE * _chord(shape) else ():
        axes.plot(*(shape + np.array([0.0, turn * pitch])).T, color=SOFT, linewidth=0.8, alpha=0.8)
    for half, marker in zip(HALVES, ("o", "s"), strict=True):
        share, u, v = passage.folds[f"{wall}_{half}"]
        place = unwrapped_face(passage, f"{wall}_{half}", np.array([u]), np.array([v]))[0, 0]
        axes.plot(*place, marker=marker, label=f"{half}: least Jacobian {_said(share, u, v)}", **MARK)
    slender = axes.dataLim.height > SLENDER * axes.dataLim.width
    title = f"{wall.capitalize()} unwrapped{', compressed upright' if slender else ''}"
    titled(axes, title, *coordinates(passage))
    axes.set_aspect("auto" if slender else "equal", adjustable="datalim")
    legend_below(axes, 1)


def draw_tightest(axes: Axes, passage: "Passage") -> None:
    """Draws the surroundings of the place where a wall's Jacobian is least of all."""
    name, (share, u, v) = min(passage.folds.items(), key=lambda fold: fold[1][0])
    wall = name.partition("_")[0]
    place = unwrapped_face(passage, name, np.array([u]), np.array([v]))[0, 0]
    shape = blade_foot(passage, wall)
    reach = REACH * _chord(shape)
    for half in HALVES:
        lines = close_lines(passage, f"{wall}_{half}", place, u, reach)
        axes.add_collection(LineCollection(lines, colors=COLOURS[wall], linewidths=0.5, alpha=0.7), autolim=False)
    _draw_foot(axes, passage, wall, shape)
    axes.plot(*place, marker="o", label=f"{name.replace('_', ' ')}: {_said(share, u, v)}", **MARK)
    axes.set_xlim(place[0] - reach, place[0] + reach)
    axes.set_ylim(place[1] - reach, place[1] + reach)
    axes.set_aspect("equal", adjustable="box", anchor="N")
    titled(axes, "Where the Jacobian is least", *coordinates(passage))
    legend_below(axes, 1)


def patch_lines(passage: "Passage", name: str) -> list[Reals]:
    """Lines of constant u, then of constant v, of a wall's native half: each (n, 2) in its plane [mm]."""
    pieces = [np.linspace(*ends, count) for ends, count in zip(_pieces(), ALONG, strict=True)]
    across = unwrapped_face(passage, name, np.unique(np.concatenate(pieces)), np.linspace(0.0, 1.0, FINE))
    along = unwrapped_face(passage, name, _along(), np.linspace(0.0, 1.0, ACROSS))
    return [*across, *np.swapaxes(along, 0, 1)]


def close_lines(passage: "Passage", name: str, place: Reals, u: float, reach: float) -> list[Reals]:
    """Lines as `patch_lines`, but within about `reach` of a place (2,) in the plane, which is near u.

    They are so chosen that they pass the place at equal distances.
    """
    along = np.linspace(max(0.0, u - BESIDE), min(1.0, u + BESIDE), 4 * FINE)
    across = np.linspace(0.0, 1.0, 2 * FINE) ** 2
    apart = length(unwrapped_face(passage, name, along, across) - place)
    along, across = (_at_distances(each, apart.min(axis=axis), reach) for each, axis in ((along, 1), (across, 0)))
    edges = [edge for edge in BLADE_AT if along[0] < edge < along[-1]]
    fine = np.union1d(np.linspace(along[0], along[-1], 4 * FINE), edges)
    lines = [*unwrapped_face(passage, name, along, np.linspace(across[0], across[-1], 2 * FINE))]
    return [*lines, *np.swapaxes(unwrapped_face(passage, name, fine, across), 0, 1)]


def _at_distances(parameter: Reals, distance: Reals, reach: float) -> Reals:
    """Parameters, to both sides of the nearest, at equal steps of the distance."""
    nearest, steps = int(np.argmin(distance)), 1.6 * reach * np.linspace(0.0, 1.0, CLOSELY)
    sides = (slice(nearest, None, -1), slice(nearest, None))
    return np.unique([np.interp(steps, np.maximum.accumulate(distance[side]), parameter[side]) for side in sides])


def _draw_foot(axes: Axes, passage: "Passage", wall: str, shape: Reals) -> None:
    """The blade's foot; where it stands off the wall, the outline of its tip."""
    colour = span_colour(0.0 if wall == "hub" else 1.0)
    if passage.walls[f"{wall}_upper"].touched:
        axes.fill(*shape.T, color=colour, alpha=0.25, linewidth=0.0)
        axes.plot(*shape.T, color=colour)
    else:
        axes.plot(*shape.T, color=colour, linestyle=":", label="tip, off the wall")


def _pieces() -> tuple[tuple[float, float], ...]:
    return tuple(pairwise((0.0, *BLADE_AT, 1.0)))


def _along() -> Reals:
    """Places along the flow, dense towards the blade's edges."""
    return np.unique(np.concatenate([low + (high - low) * along_curve(2 * FINE) for low, high in _pieces()]))


def _chord(shape: Reals) -> float:
    """Length of a closed outline from its first point, the leading edge, to the farthest."""
    return float(np.max(length(shape - shape[0])))


def _said(share: float, u: float, v: float) -> str:
    return f"{share:.2g} of its median, at u = {round(u, 3):g}, v = {round(v, 3):g}"
