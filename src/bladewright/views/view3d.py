"""The view in space of notebooks and reports: a picture that a script in the page lets turn, without network."""

import json
from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from importlib.resources import files
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.image import imsave

from bladewright.nurbs.basis import Reals
from bladewright.views.fit_data import DEVIATION_COLOURS, FitResult, colour_scale, deviations_mm, points_to_draw
from bladewright.views.raster import Polyline, ShadedGrid, framing_camera, rendered
from bladewright.views.solid import (
    BLADE,
    EDGE,
    FAINT,
    GLASS,
    NEIGHBOUR,
    OPENING,
    WALL_COLOURS,
    blade_surfaces,
    hub_surfaces,
    moved,
    outer_edges,
    outer_grids,
    placed,
    positions,
    viewpoint,
)
from bladewright.views.style import per_metre, unit_name

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade
    from bladewright.domain.passage import Passage

OWN, OTHER, WALL, PIECE = (57, 21), (37, 11), (31, 46), 13
"""Points along and across a side of the blade, of a neighbour, most of a piece of the hub, and of a piece of a
passage's face: a blade in its row is then some 100 kB of text, and is drawn about thirty times a second."""
WIDTH = 480
"""Width of the picture that is there until the script runs, and where none may run [pixels]."""
POINTS, SHADES = 3000, 9
"""Most points of a cloud that are drawn, and colours that their deviations are told apart by."""
RATIOS = (1.3, 1.9)
"""Least and largest width of the view, in heights."""
MARGIN = 1.12
"""Width of the view over what it shows at first, so that something is left of it when it is turned."""
HINT = "Drag to turn, shift-drag to move, click and wheel to zoom, double-click to reset."
"""What the view can do."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Group:
    """Surfaces and lines [unit of the picture] that are drawn together, once or at several places."""

    surfaces: Sequence[ShadedGrid]
    lines: Sequence[Polyline] = ()
    turns: Sequence[float] = (0.0,)
    """rotations [rad], or in a cascade shifts, of its copies"""
    glass: bool = False
    """whether the surfaces hide nothing"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """What is seen in space, and from where."""

    blade: "Blade"
    groups: Sequence[Group]
    dots: Sequence[tuple[Reals, tuple[float, ...]]] = ()
    """points (n, 3) and their colours"""


def blade_scene(blade: "Blade") -> Scene:
    """The blade between two neighbours on either side, on the hub."""
    turns = positions(blade, 2)
    own, rims = blade_surfaces(blade, OWN, BLADE)
    others, faint = blade_surfaces(blade, OTHER, NEIGHBOUR)
    groups = [
        Group(surfaces=own, lines=[Polyline(points=line, colour=EDGE, width=2) for line in rims]),
        Group(
            surfaces=others,
            lines=[Polyline(points=line, colour=FAINT) for line in faint],
            turns=[turn for turn in turns if turn != 0.0],
        ),
        Group(surfaces=[_thinned(wall) for wall in hub_surfaces(blade, turns)]),
    ]
    return Scene(blade=blade, groups=groups)


def passage_scene(passage: "Passage") -> Scene:
    """The passage, see-through from outside, with its blade."""
    u = np.linspace(0.0, 1.0, PIECE)
    own, rims = blade_surfaces(passage.blade, OWN, BLADE)
    solid, glass = [], []
    for name, points, normals in outer_grids(passage, u):
        colour = WALL_COLOURS.get(name.partition("_")[0], OPENING)
        solid.append(ShadedGrid(points=points, normals=normals, colour=colour, side=-1))
        glass.append(ShadedGrid(points=points, normals=normals, colour=GLASS, side=1))
    lines = [Polyline(points=line[::8], colour=EDGE) for line in outer_edges(passage)]
    lines += [Polyline(points=line, colour=EDGE, width=2) for line in rims]
    groups = [Group(surfaces=[*solid, *own], lines=lines), Group(surfaces=glass, glass=True)]
    return Scene(blade=passage.blade, groups=groups)


def fit_scene(fit: FitResult) -> Scene:
    """The blade that was found among the points, which have the colours of their deviations."""
    surfaces, rims = blade_surfaces(fit.built, OWN, NEIGHBOUR)
    index = points_to_draw(fit, np.ones(len(fit.cloud), dtype=np.bool_), POINTS)
    shade = np.clip(np.asarray(colour_scale(fit)(deviations_mm(fit, index))) * SHADES, 0, SHADES - 1).astype(int)
    colours = DEVIATION_COLOURS(np.linspace(0.0, 1.0, SHADES))[:, :3]
    dots = [(per_metre() * fit.cloud[index[shade == k]], tuple(colours[k])) for k in np.unique(shade)]
    lines = [Polyline(points=line, colour=FAINT) for line in rims]
    return Scene(blade=fit.built, groups=[Group(surfaces=surfaces, lines=lines)], dots=dots)


def view3d(scene: Scene, title: str) -> str:
    """The HTML of a view that turns: a picture, the scene as text, and the script that draws it.

    Nothing is loaded. Where scripts may not run, and until they do, the picture is seen.
    """
    return (
        f'<div data-scene="{escape(json.dumps(_packed(scene), separators=(",", ":")))}" '
        f'style="background:white;max-width:900px" title="{escape(HINT)}">'
        f'<img alt="{escape(title)}" style="max-width:100%" src="{_still(scene)}"></div>'
        f"<script>{files('bladewright.views').joinpath('view3d.js').read_text(encoding='utf-8')}</script>"
    )


def _thinned(grid: ShadedGrid) -> ShadedGrid:
    rows, columns = (
        np.linspace(0, size - 1, min(size, most)).round().astype(int)
        for size, most in zip(grid.points.shape[:2], WALL, strict=True)
    )
    points, normals = (values[rows][:, columns] for values in (grid.points, grid.normals))
    return ShadedGrid(points=points, normals=normals, colour=grid.colour)


def _still(scene: Scene) -> str:
    """The picture of the scene as it is first seen."""
    blade, (surfaces, lines) = scene.blade, with_copies(scene)
    glass = [surface for group in scene.groups if group.glass for surface in group.surfaces]
    camera = framing_camera(viewpoint(blade), all_points(scene))
    picture, width = BytesIO(), int(min(WIDTH, WIDTH * camera.extent[0] / camera.extent[1]))
    pixels = rendered(surfaces, lines, camera, width, glass=glass)
    imsave(picture, np.asarray(np.round(255.0 * pixels), dtype=np.uint8), format="png")
    return f"data:image/png;base64,{b64encode(picture.getvalue()).decode()}"


def with_copies(scene: Scene) -> tuple[list[ShadedGrid], list[Polyline]]:
    """The surfaces that hide something, and the lines, each at all of its places."""
    blade, surfaces, lines = scene.blade, list[ShadedGrid](), list[Polyline]()
    for group in scene.groups:
        for turn in () if group.glass else group.turns:
            surfaces += [placed(blade, surface, turn) for surface in group.surfaces]
            lines += [
                Polyline(points=moved(blade, line.points, turn), colour=line.colour, width=line.width)
                for line in group.lines
            ]
    return surfaces, lines


def all_points(scene: Scene) -> Reals:
    """All points (n, 3) of the surfaces and their copies."""
    return np.concatenate(
        [
            moved(scene.blade, surface.points, turn).reshape(-1, 3)
            for group in scene.groups
            for turn in group.turns
            for surface in group.surfaces
        ]
    )


def _packed(scene: Scene) -> Mapping[str, Any]:
    """The scene as JSON: points as 16-bit and normals as 8-bit integers in base 64."""
    points, axes = all_points(scene), viewpoint(scene.blade)
    camera = framing_camera(axes, points)
    ratio = float(np.clip(camera.extent[0] / camera.extent[1], *RATIOS))
    depth = points @ axes[2]
    middle = np.array([*(camera.corner + 0.5 * camera.extent), 0.5 * (depth.min() + depth.max())])
    drawn = np.concatenate([points, *(dots for dots, _ in scene.dots)])
    step = float(np.max(np.abs(drawn))) / 32767.0
    key = "turn" if scene.blade.exact.mapping.revolved else "shift"

    def copies(group: Group) -> list[dict[str, float]]:
        return [{key: turn} if turn else {} for turn in group.turns]

    return {
        "unit": unit_name(),
        "axes": axes.tolist(),
        "centre": (middle @ axes).tolist(),
        "reach": float(np.max(np.sqrt(np.sum((points - middle @ axes) ** 2, axis=-1)))),
        "size": MARGIN * float(max(camera.extent[0], camera.extent[1] * ratio)),
        "ratio": ratio,
        "step": step,
        "grids": [
            {
                "rows": surface.points.shape[0],
                "columns": surface.points.shape[1],
                "points": _integers(surface.points / step, "<i2"),
                "normals": _integers(127.0 * _units(surface.normals), "i1"),
                "colour": surface.colour,
                "side": surface.side,
                "glass": group.glass,
                "copies": copies(group),
            }
            for group in scene.groups
            for surface in group.surfaces
        ],
        "lines": [
            {
                "points": _integers(line.points / step, "<i2"),
                "colour": line.colour,
                "width": line.width,
                "copies": copies(group),
            }
            for group in scene.groups
            for line in group.lines
        ],
        "dots": [{"points": _integers(dots / step, "<i2"), "colour": colour} for dots, colour in scene.dots],
    }


def _integers(values: Reals, kind: str) -> str:
    return b64encode(np.round(values).astype(kind).tobytes()).decode()


def _units(normals: Reals) -> Reals:
    return normals / np.maximum(np.sqrt(np.sum(normals**2, axis=-1, keepdims=True)), 1e-300)
