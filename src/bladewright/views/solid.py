"""The blade in space: shaded among its neighbours, on its hub."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes

from bladewright.nurbs.basis import Reals
from bladewright.views.raster import Camera, Mesh, Trace, axes_towards, framed, rendered
from bladewright.views.sections import ALONE, along_curve
from bladewright.views.style import INK, MILLIMETRES

if TYPE_CHECKING:
    from bladewright.blade.blade import Blade

BLADE = (0.16, 0.47, 0.68)
NEIGHBOUR = (0.74, 0.78, 0.83)
HUB = (0.70, 0.68, 0.64)
EDGE = (0.05, 0.16, 0.26)
FAINT = (0.55, 0.60, 0.65)
BORE = 0.8
"""radius of the bore of a hub, of the hub's smallest radius"""
FLAT = 0.2
"""run of a hub along the axis, of its rise, below which it is a disc"""
GRID, COARSE = (121, 41), (57, 17)
"""points along and across a side, of the blade and of its neighbours"""


def draw_solid(axes: Axes, blade: "Blade", *, neighbours: int | None, width: int) -> None:
    """Draws the blade [mm] with `neighbours` on either side (None: the whole row) on the hub, `width` pixels wide."""
    turns = _places(blade, neighbours)
    meshes, traces = [], []
    others = blade_meshes(blade, COARSE, NEIGHBOUR)
    for turn in turns:
        own = turn == 0.0
        parts, lines = blade_meshes(blade, GRID, BLADE) if own else others
        meshes += [_placed(blade, mesh, turn) for mesh in parts]
        traces += [
            Trace(points=_moved(blade, line, turn), colour=EDGE if own else FAINT, width=2 if own else 1)
            for line in lines
        ]
    shown = np.concatenate([mesh.points.reshape(-1, 3) for mesh in meshes])
    meshes += _hub(blade, turns)
    camera = framed(viewpoint(blade), np.concatenate([shown, meshes[-1].points.reshape(-1, 3)]))
    show(axes, camera, rendered(meshes, traces, camera, width))


def show(axes: Axes, camera: Camera, rendering: Reals) -> None:
    """Puts what a camera rendered on axes, with the directions of x, y and z and a scale under it."""
    left, low = camera.corner
    wide, high = camera.extent
    axes.imshow(rendering, extent=(left, left + wide, low, low + high), interpolation="antialiased")
    axes.set_axis_off()
    _scale(axes, camera)


def _places(blade: "Blade", neighbours: int | None) -> list[float]:
    """Turns [rad], or shifts [mm] of a cascade, of the blades to draw; the blade itself is at 0."""
    from bladewright.section.checks import UNITS

    design = blade.design
    if design.blade_count is not None:
        count = design.blade_count
        number = count if neighbours is None else min(2 * neighbours + 1, count)
        return [2.0 * np.pi / count * (index - number // 2) for index in range(number)]
    pitch = (design.pitch or 0.0) * UNITS[design.length_unit]
    beside = 0 if pitch > ALONE * blade.chord else 2 if neighbours is None else neighbours
    return [MILLIMETRES * pitch * index for index in range(-beside, beside + 1)]


def _moved(blade: "Blade", points: Reals, turn: float) -> Reals:
    """Points (..., 3) on the blade that stands at `turn`."""
    if not blade.exact.mapping.revolved:
        return points + np.array([0.0, turn, 0.0])
    return _turned(points, turn)


def _turned(points: Reals, turn: float) -> Reals:
    cosine, sine = np.cos(turn), np.sin(turn)
    x, y, z = np.moveaxis(points, -1, 0)
    return np.stack([x, y * cosine + z * sine, z * cosine - y * sine], axis=-1)


def _placed(blade: "Blade", mesh: Mesh, turn: float) -> Mesh:
    normals = _turned(mesh.normals, turn) if blade.exact.mapping.revolved else mesh.normals
    return Mesh(points=_moved(blade, mesh.points, turn), normals=normals, colour=mesh.colour)


def blade_meshes(
    blade: "Blade", size: tuple[int, int], colour: tuple[float, float, float]
) -> tuple[list[Mesh], list[Reals]]:
    """Sides and ends [mm] with their normals, and the lines between them."""
    u, v = along_curve(size[0]), np.linspace(0.0, 1.0, size[1])
    meshes, rims = [], []
    for name in ("upper", "lower"):
        side: Any = blade.surfaces[name]
        points = MILLIMETRES * np.real(side.grid(u, v))
        normals = np.cross(np.real(side.grid(u, v, 1, 0)), np.real(side.grid(u, v, 0, 1)))
        size_of_normals = np.sqrt(np.sum(normals**2, axis=-1, keepdims=True))
        meshes.append(Mesh(points=points, normals=normals / np.maximum(size_of_normals, 1e-300), colour=colour))
        rims.append(points)
    blunt = [blade.surfaces[name] for name in ("leading_edge", "trailing_edge") if name in blade.surfaces]
    meshes += [_face(face, v, colour) for face in blunt]
    lines = []
    for row in (-1,) if blade.exact.mapping.revolved and blade.design.ends[0] == "hub" else (0, -1):
        ends = np.stack([rim[:, row] for rim in rims], axis=1)
        across = rims[0][:, row] - rims[0][:, 1 if row == 0 else -2]
        normals = np.broadcast_to(across[:, None], ends.shape)
        meshes.append(Mesh(points=ends, normals=normals, colour=colour))
        lines += [ends[:, 0], ends[:, 1]]
    return meshes, lines


def _face(face: Any, v: Reals, colour: tuple[float, float, float]) -> Mesh:
    """The face of a blunt edge [mm]."""
    w = np.linspace(0.0, 1.0, 5)
    normals = np.cross(np.real(face.grid(w, v, 1, 0)), np.real(face.grid(w, v, 0, 1)))
    size = np.sqrt(np.sum(normals**2, axis=-1, keepdims=True))
    return Mesh(
        points=MILLIMETRES * np.real(face.grid(w, v)), normals=normals / np.maximum(size, 1e-300), colour=colour
    )


def _hub(blade: "Blade", turns: list[float]) -> list[Mesh]:
    """The wall that the blades drawn stand on [mm], a little longer than they are; of a whole row with its bore."""
    exact, low, high = blade.exact, *_reach(blade)
    wall = MILLIMETRES * exact.wall_line("hub", np.linspace(low, high, 61))
    feet = MILLIMETRES * np.concatenate(
        [np.real(blade.surfaces[name](along_curve(41), 0.0)) for name in ("upper", "lower")]
    )
    if not exact.mapping.revolved:
        room = 0.15 * float(np.ptp(feet[:, 1]))
        reach = np.linspace(turns[0] + feet[:, 1].min() - room, turns[-1] + feet[:, 1].max() + room, 41)
        return [_hub_mesh(np.stack(np.broadcast_arrays(wall[:, :1], reach, wall[:, 1:]), axis=-1))]
    wall = wall[wall[:, 1] > 0.0]
    whole = len(turns) == blade.design.blade_count
    if whole:
        theta = np.linspace(0.0, 2.0 * np.pi, 361)
        bore = BORE * wall[:, 1].min()
        rim = [np.array([[x, radius], [x, bore]]) for x, radius in wall[[0, -1]]]
        profiles = [np.array([rim[0][1], rim[1][1]]), *rim, wall]
    else:
        around, room = np.arctan2(feet[:, 1], feet[:, 2]), 0.5 * np.pi / (blade.design.blade_count or 1)
        theta = np.linspace(turns[0] + around.min() - room, turns[-1] + around.max() + room, 181)
        profiles = [wall]
    meshes = []
    for profile in profiles:
        x, radius = profile[:, :1], profile[:, 1:]
        grid = np.stack(np.broadcast_arrays(x, radius * np.sin(theta), radius * np.cos(theta)), axis=-1)
        meshes.append(_hub_mesh(grid))
    return meshes


def _reach(blade: "Blade") -> tuple[float, float]:
    """From which to which u the hub is drawn: past the noses."""
    stations = blade.exact.stations(np.zeros(1))
    u = np.real(stations.on_lines(np.concatenate(stations.plane.points(along_curve(41)), axis=-2))[0])
    return min(float(u.min()), 0.0) - 0.06, max(float(u.max()), 1.0) + 0.06


def _hub_mesh(grid: Reals) -> Mesh:
    return Mesh(points=grid, normals=np.cross(np.gradient(grid, axis=0), np.gradient(grid, axis=1)), colour=HUB)


def viewpoint(blade: "Blade") -> Reals:
    """Right, up and towards of a viewer who looks at the smaller end of the hub, or from upstream on an even one.

    A hub that is a disc is looked at from the shroud's side.
    """
    if not blade.exact.mapping.revolved:
        return axes_towards((-0.55, -0.75, 0.50), (0.0, 0.0, 1.0))
    first, last = blade.exact.wall_line("hub", np.array([0.0, 1.0]))
    run, rise = last - first
    if FLAT * abs(rise) > abs(run):
        aside = blade.exact.wall_line("shroud", np.array([0.0, 1.0]))[:, 0] - np.array([first[0], last[0]])
        return axes_towards((0.74 if float(np.mean(aside)) > 0.0 else -0.74, 0.42, 0.52), (0.0, 0.0, 1.0))
    narrows = first[1] - last[1] > 0.15 * first[1]
    smaller, larger = (last, first) if narrows else (first, last)
    return axes_towards((0.74 if smaller[0] > larger[0] else -0.74, 0.42, 0.52), (0.0, 0.0, 1.0))


def _scale(axes: Axes, camera: Camera) -> None:
    """The directions of the axes and a scale, in a strip under the picture."""
    left, bottom = camera.corner
    size = float(np.max(camera.extent))
    step = size / 6.0
    tens = 10.0 ** np.floor(np.log10(step))
    bar = float(tens * max(each for each in (1.0, 2.0, 5.0) if each * tens <= step))
    start, height = left + 0.22 * size, bottom - 0.09 * size
    axes.plot([start, start + bar], [height, height], color=INK, linewidth=2.0, solid_capstyle="butt")
    near: dict[str, Any] = {"textcoords": "offset points", "ha": "center"}
    axes.annotate(f"{bar:g} mm", (start + bar / 2.0, height), xytext=(0.0, -4.0), va="top", **near)
    origin = np.array([left + 0.09 * size, bottom - 0.08 * size])
    arrow = {"arrowstyle": "-|>", "color": INK, "linewidth": 1.0, "shrinkA": 0.0, "shrinkB": 0.0}
    for index, name in enumerate("xyz"):
        tip = 0.07 * size * camera.axes[:2, index]
        away = 8.0 * tip / max(float(np.sqrt(tip @ tip)), 1e-12)
        axes.annotate("", tuple(origin + tip), xytext=tuple(origin), arrowprops=arrow)
        axes.annotate(name, tuple(origin + tip), xytext=tuple(away), va="center", **near)
    axes.set_ylim(bottom - 0.16 * size, bottom + camera.extent[1])
    axes.set_xlim(left, left + camera.extent[0])
