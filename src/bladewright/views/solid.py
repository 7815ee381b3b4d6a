"""Shaded views in space: the blade among its neighbours on the hub, and the passage as a see-through body."""

from typing import TYPE_CHECKING, Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from bladewright.domain.passage import pieces_of
from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface
from bladewright.views.raster import Camera, Polyline, ShadedGrid, axes_towards, framing_camera, rendered
from bladewright.views.sections import ISOLATED_PITCH, cosine_spacing
from bladewright.views.style import INK, MILLIMETRES

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade
    from bladewright.domain.passage import Passage


BLADE = (0.16, 0.47, 0.68)
NEIGHBOUR = (0.74, 0.78, 0.83)
HUB = (0.70, 0.68, 0.64)
EDGE = (0.05, 0.16, 0.26)
FAINT = (0.55, 0.60, 0.65)
BORE_RADIUS = 0.8
"""radius of the bore of a hub, of the hub's smallest radius"""
DISC_SLOPE = 0.2
"""run of a hub along the axis, of its rise, below which it is a disc"""
GRID, COARSE = (121, 41), (57, 17)
"""points along and across a side, of the blade and of its neighbours"""


def draw_solid(axes: Axes, blade: "Blade", *, neighbours: int | None, width: int) -> None:
    """Draws the blade [mm] with `neighbours` on either side (None: the whole row) on the hub, `width` pixels wide."""
    turns = _positions(blade, neighbours)
    meshes, traces = [], []
    others = blade_meshes(blade, COARSE, NEIGHBOUR)
    for turn in turns:
        own = turn == 0.0
        parts, lines = blade_meshes(blade, GRID, BLADE) if own else others
        meshes += [_placed(blade, mesh, turn) for mesh in parts]
        traces += [
            Polyline(points=_moved(blade, line, turn), colour=EDGE if own else FAINT, width=2 if own else 1)
            for line in lines
        ]
    shown = np.concatenate([mesh.points.reshape(-1, 3) for mesh in meshes])
    meshes += _hub(blade, turns)
    camera = framing_camera(viewpoint(blade), np.concatenate([shown, meshes[-1].points.reshape(-1, 3)]))
    show_rendering(axes, camera, rendered(meshes, traces, camera, width))


def show_rendering(axes: Axes, camera: Camera, rendering: Reals) -> None:
    """Puts what a camera rendered on axes, with the directions of x, y and z and a scale under it."""
    left, low = camera.corner
    wide, high = camera.extent
    axes.imshow(rendering, extent=(left, left + wide, low, low + high), interpolation="antialiased")
    axes.set_axis_off()
    _scale(axes, camera)


def _positions(blade: "Blade", neighbours: int | None) -> list[float]:
    """Turns [rad], or shifts [mm] of a cascade, of the blades to draw; the blade itself is at 0."""
    from bladewright.section.checks import UNITS

    design = blade.design
    if design.blade_count is not None:
        count = design.blade_count
        number = count if neighbours is None else min(2 * neighbours + 1, count)
        return [2.0 * np.pi / count * (index - number // 2) for index in range(number)]
    pitch = (design.pitch or 0.0) * UNITS[design.length_unit]
    beside = 0 if pitch > ISOLATED_PITCH * blade.chord else 2 if neighbours is None else neighbours
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


def _placed(blade: "Blade", mesh: ShadedGrid, turn: float) -> ShadedGrid:
    normals = _turned(mesh.normals, turn) if blade.exact.mapping.revolved else mesh.normals
    return ShadedGrid(points=_moved(blade, mesh.points, turn), normals=normals, colour=mesh.colour)


def blade_meshes(
    blade: "Blade", size: tuple[int, int], colour: tuple[float, float, float]
) -> tuple[list[ShadedGrid], list[Reals]]:
    """Sides and ends [mm] with their normals, and the lines between them."""
    u, v = cosine_spacing(size[0]), np.linspace(0.0, 1.0, size[1])
    meshes, rims = [], []
    for name in ("upper", "lower"):
        side: Any = blade.surfaces[name]
        points = MILLIMETRES * np.real(side.grid(u, v))
        normals = np.cross(np.real(side.grid(u, v, 1, 0)), np.real(side.grid(u, v, 0, 1)))
        size_of_normals = np.sqrt(np.sum(normals**2, axis=-1, keepdims=True))
        meshes.append(ShadedGrid(points=points, normals=normals / np.maximum(size_of_normals, 1e-300), colour=colour))
        rims.append(points)
    blunt = [blade.surfaces[name] for name in ("leading_edge", "trailing_edge") if name in blade.surfaces]
    meshes += [_face(face, v, colour) for face in blunt]
    lines = []
    for row in (-1,) if blade.exact.mapping.revolved and blade.design.ends[0] == "hub" else (0, -1):
        ends = np.stack([rim[:, row] for rim in rims], axis=1)
        across = rims[0][:, row] - rims[0][:, 1 if row == 0 else -2]
        normals = np.broadcast_to(across[:, None], ends.shape)
        meshes.append(ShadedGrid(points=ends, normals=normals, colour=colour))
        lines += [ends[:, 0], ends[:, 1]]
    return meshes, lines


def _face(face: Any, v: Reals, colour: tuple[float, float, float]) -> ShadedGrid:
    """The face of a blunt edge [mm]."""
    w = np.linspace(0.0, 1.0, 5)
    normals = np.cross(np.real(face.grid(w, v, 1, 0)), np.real(face.grid(w, v, 0, 1)))
    size = np.sqrt(np.sum(normals**2, axis=-1, keepdims=True))
    return ShadedGrid(
        points=MILLIMETRES * np.real(face.grid(w, v)), normals=normals / np.maximum(size, 1e-300), colour=colour
    )


def _hub(blade: "Blade", turns: list[float]) -> list[ShadedGrid]:
    """The wall that the blades drawn stand on [mm], a little longer than they are; of a whole row with its bore."""
    exact, low, high = blade.exact, *_hub_extent(blade)
    wall = MILLIMETRES * exact.wall_points("hub", np.linspace(low, high, 61))
    feet = MILLIMETRES * np.concatenate(
        [np.real(blade.surfaces[name](cosine_spacing(41), 0.0)) for name in ("upper", "lower")]
    )
    if not exact.mapping.revolved:
        room = 0.15 * float(np.ptp(feet[:, 1]))
        reach = np.linspace(turns[0] + feet[:, 1].min() - room, turns[-1] + feet[:, 1].max() + room, 41)
        return [_hub_mesh(np.stack(np.broadcast_arrays(wall[:, :1], reach, wall[:, 1:]), axis=-1))]
    wall = wall[wall[:, 1] > 0.0]
    whole = len(turns) == blade.design.blade_count
    if whole:
        theta = np.linspace(0.0, 2.0 * np.pi, 361)
        bore = BORE_RADIUS * wall[:, 1].min()
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


def _hub_extent(blade: "Blade") -> tuple[float, float]:
    """From which to which u the hub is drawn: past the noses."""
    stations = blade.exact.sections(np.zeros(1))
    u = np.real(stations.on_lines(np.concatenate(stations.plane_points(cosine_spacing(41)), axis=-2))[0])
    return min(float(u.min()), 0.0) - 0.06, max(float(u.max()), 1.0) + 0.06


def _hub_mesh(grid: Reals) -> ShadedGrid:
    return ShadedGrid(points=grid, normals=np.cross(np.gradient(grid, axis=0), np.gradient(grid, axis=1)), colour=HUB)


def viewpoint(blade: "Blade") -> Reals:
    """Right, up and towards of a viewer who looks at the smaller end of the hub, or from upstream on an even one.

    A hub that is a disc is looked at from the shroud's side.
    """
    if not blade.exact.mapping.revolved:
        return axes_towards((-0.55, -0.75, 0.50), (0.0, 0.0, 1.0))
    first, last = blade.exact.wall_points("hub", np.array([0.0, 1.0]))
    run, rise = last - first
    if DISC_SLOPE * abs(rise) > abs(run):
        aside = blade.exact.wall_points("shroud", np.array([0.0, 1.0]))[:, 0] - np.array([first[0], last[0]])
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


WALL_COLOURS = {"hub": (0.88, 0.80, 0.66), "shroud": (0.88, 0.80, 0.66), "periodic": (0.80, 0.86, 0.92)}
OPENING = (0.78, 0.88, 0.80)
GLASS = (0.66, 0.80, 0.90)
PIECE_POINTS = 33
"""points along and across a smooth piece of a face"""
NAME_PLACES = np.linspace(0.2, 0.8, 7)
"""places along and across a face where its name may stand"""
WALL_LINES = 6
"""lines of constant u, and of constant v, on a smooth piece of a wall"""


def draw_passage_solid(axes: Axes, passage: "Passage", *, size: tuple[int, int]) -> None:
    """Draws the passage [mm], at most `size` pixels wide and high: solid where it is seen from within, else glass."""
    blade, rims = blade_meshes(passage.blade, GRID, BLADE)
    solid, glass, traces = [], [], []
    for name, sense in outer_faces(passage).items():
        colour = WALL_COLOURS.get(name.partition("_")[0], OPENING)
        for piece in pieces_of(name, cast(Surface, passage.whole[name]), passage.knots).values():
            points, normals = _grid(piece, sense)
            solid.append(ShadedGrid(points=points, normals=normals, colour=colour, side=-1))
            glass.append(ShadedGrid(points=points, normals=normals, colour=GLASS, side=1))
            if name.startswith("hub"):
                traces += [Polyline(points=line, colour=FAINT) for line in _lines(points)]
    traces += [Polyline(points=line, colour=EDGE) for line in _outer_edges(passage)]
    traces += [Polyline(points=line, colour=EDGE, width=2) for line in rims]
    camera = framing_camera(viewpoint(passage.blade), np.concatenate([mesh.points.reshape(-1, 3) for mesh in solid]))
    width = int(min(size[0], size[1] * camera.extent[0] / camera.extent[1]))
    show_rendering(axes, camera, rendered([*solid, *blade], traces, camera, width, glass=glass))
    shown = [np.concatenate([camera.seen(mesh.points).reshape(-1, 3)[:, :2] for mesh in blade])]
    for name in ("inlet", "outlet"):
        shown.append(_write_name(axes, camera, cast(Surface, passage.whole[name]), name, np.concatenate(shown)))


def outer_faces(passage: "Passage") -> dict[str, int]:
    """The faces but for the blade's, with +1 where dS/du x dS/dv points out of the passage, -1 elsewhere."""
    return {
        name: next(sense for face, sense in passage.orientations.items() if face.startswith(name))
        for name in passage.whole
        if name != "tip" and not name.startswith("blade")
    }


def _grid(face: Surface, sense: int) -> tuple[Reals, Reals]:
    """Points (m, n, 3) [mm] of a smooth face and its normals out of the passage."""
    u = v = np.linspace(0.0, 1.0, PIECE_POINTS)
    normals = sense * np.cross(np.real(face.grid(u, v, 1, 0)), np.real(face.grid(u, v, 0, 1)))
    size = np.sqrt(np.sum(normals**2, axis=-1, keepdims=True))
    return MILLIMETRES * np.real(face.grid(u, v)), normals / np.maximum(size, 1e-300)


def _lines(points: Reals) -> list[Reals]:
    """Lines along and across a grid."""
    at = np.linspace(0, PIECE_POINTS - 1, WALL_LINES).round().astype(int)
    return [*points[at], *np.swapaxes(points[:, at], 0, 1)]


def _outer_edges(passage: "Passage") -> list[Reals]:
    """Where outer faces meet [mm]: the edges of the periodic boundaries, of inlet and outlet."""
    u, ends = np.linspace(0.0, 1.0, 401), np.array([0.0, 1.0])
    lines: list[Reals] = []
    for name in ("periodic_upper", "periodic_lower", "inlet", "outlet"):
        face = cast(Surface, passage.whole[name])
        lines += [*np.swapaxes(np.real(face.grid(u, ends)), 0, 1)]
        if name.startswith("periodic"):
            lines += [*np.real(face.grid(ends, u))]
    return [MILLIMETRES * line for line in lines]


def _write_name(axes: Axes, camera: Camera, face: Surface, name: str, clear: Reals) -> Reals:
    """Writes a face's name on it, as far as can be from places (n, 2) in the picture; returns where (1, 2)."""
    points = MILLIMETRES * np.real(face.grid(NAME_PLACES, NAME_PLACES)).reshape(-1, 3)
    flat = camera.seen(points)[:, :2]
    apart = np.min(length(flat[:, None] - clear), axis=1)
    best = flat[int(np.argmax(apart))]
    halo = [withStroke(linewidth=3.0, foreground="white", alpha=0.7)]
    axes.text(float(best[0]), float(best[1]), name, ha="center", va="center", path_effects=halo)
    return best[None]
