"""A flow passage in space: a see-through body with the blade shaded in it."""

from typing import TYPE_CHECKING, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from bladewright.domain.pieces import pieces_of
from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface
from bladewright.views.raster import Camera, Mesh, Trace, framed, rendered
from bladewright.views.solid import BLADE, EDGE, FAINT, GRID, blade_meshes, show, viewpoint
from bladewright.views.style import MILLIMETRES

if TYPE_CHECKING:
    from bladewright.domain.passage import Passage

COLOURS = {"hub": (0.88, 0.80, 0.66), "shroud": (0.88, 0.80, 0.66), "periodic": (0.80, 0.86, 0.92)}
OPENING = (0.78, 0.88, 0.80)
GLASS = (0.66, 0.80, 0.90)
SIZE = 33
"""points along and across a smooth piece of a face"""
INNER = np.linspace(0.2, 0.8, 7)
"""places along and across a face where its name may stand"""
LINES = 6
"""lines of constant u, and of constant v, on a smooth piece of a wall"""


def draw_passage_solid(axes: Axes, passage: "Passage", *, size: tuple[int, int]) -> None:
    """Draws the passage [mm], at most `size` pixels wide and high: solid where it is seen from within, else glass."""
    blade, rims = blade_meshes(passage.blade, GRID, BLADE)
    solid, glass, traces = [], [], []
    for name, sense in outer_faces(passage).items():
        colour = COLOURS.get(name.partition("_")[0], OPENING)
        for piece in pieces_of(name, cast(Surface, passage.whole[name]), passage.knots).values():
            points, normals = _grid(piece, sense)
            solid.append(Mesh(points=points, normals=normals, colour=colour, side=-1))
            glass.append(Mesh(points=points, normals=normals, colour=GLASS, side=1))
            if name.startswith("hub"):
                traces += [Trace(points=line, colour=FAINT) for line in _lines(points)]
    traces += [Trace(points=line, colour=EDGE) for line in _outer_edges(passage)]
    traces += [Trace(points=line, colour=EDGE, width=2) for line in rims]
    camera = framed(viewpoint(passage.blade), np.concatenate([mesh.points.reshape(-1, 3) for mesh in solid]))
    width = int(min(size[0], size[1] * camera.extent[0] / camera.extent[1]))
    show(axes, camera, rendered([*solid, *blade], traces, camera, width, glass=glass))
    shown = [np.concatenate([camera.seen(mesh.points).reshape(-1, 3)[:, :2] for mesh in blade])]
    for name in ("inlet", "outlet"):
        shown.append(_named(axes, camera, cast(Surface, passage.whole[name]), name, np.concatenate(shown)))


def outer_faces(passage: "Passage") -> dict[str, int]:
    """The faces but for the blade's, with +1 where dS/du x dS/dv points out of the passage, -1 elsewhere."""
    return {
        name: next(sense for face, sense in passage.orientations.items() if face.startswith(name))
        for name in passage.whole
        if name != "tip" and not name.startswith("blade")
    }


def _grid(face: Surface, sense: int) -> tuple[Reals, Reals]:
    """Points (m, n, 3) [mm] of a smooth face and its normals out of the passage."""
    u = v = np.linspace(0.0, 1.0, SIZE)
    normals = sense * np.cross(np.real(face.grid(u, v, 1, 0)), np.real(face.grid(u, v, 0, 1)))
    size = np.sqrt(np.sum(normals**2, axis=-1, keepdims=True))
    return MILLIMETRES * np.real(face.grid(u, v)), normals / np.maximum(size, 1e-300)


def _lines(points: Reals) -> list[Reals]:
    """Lines along and across a grid."""
    at = np.linspace(0, SIZE - 1, LINES).round().astype(int)
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


def _named(axes: Axes, camera: Camera, face: Surface, name: str, clear: Reals) -> Reals:
    """Writes a face's name on it, as far as can be from places (n, 2) in the picture; returns where (1, 2)."""
    points = MILLIMETRES * np.real(face.grid(INNER, INNER)).reshape(-1, 3)
    flat = camera.seen(points)[:, :2]
    apart = np.min(length(flat[:, None] - clear), axis=1)
    best = flat[int(np.argmax(apart))]
    halo = [withStroke(linewidth=3.0, foreground="white", alpha=0.7)]
    axes.text(float(best[0]), float(best[1]), name, ha="center", va="center", path_effects=halo)
    return best[None]
