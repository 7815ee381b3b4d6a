"""A flow passage in space: a see-through body with the blade shaded in it."""

from typing import TYPE_CHECKING, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from bladewright.domain.pieces import pieces_of
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
LINES = 6
"""lines of constant u, and of constant v, on a smooth piece of a wall"""


def draw_passage_solid(axes: Axes, passage: "Passage", *, width: int) -> None:
    """Draws the passage [mm], `width` pixels wide: solid where it is seen from within, like glass from outside."""
    blade, rims = blade_meshes(passage.blade, GRID, BLADE)
    solid, glass, traces = [], [], []
    for name, sense in outer_faces(passage).items():
        colour = COLOURS.get(name.partition("_")[0], OPENING)
        for piece in pieces_of(name, cast(Surface, passage.whole[name])).values():
            points, normals = _grid(piece, sense)
            solid.append(Mesh(points=points, normals=normals, colour=colour, side=-1))
            glass.append(Mesh(points=points, normals=normals, colour=GLASS, side=1))
            if name.startswith("hub"):
                traces += [Trace(points=line, colour=FAINT) for line in _lines(points)]
    traces += [Trace(points=line, colour=EDGE) for line in _outer_edges(passage)]
    traces += [Trace(points=line, colour=EDGE, width=2) for line in rims]
    camera = framed(viewpoint(passage.blade), np.concatenate([mesh.points.reshape(-1, 3) for mesh in solid]))
    show(axes, camera, rendered([*solid, *blade], traces, camera, width, glass=glass))
    for name in ("inlet", "outlet"):
        _named(axes, camera, passage, name)


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


def _named(axes: Axes, camera: Camera, passage: "Passage", name: str) -> None:
    """Writes a face's name on its middle."""
    middle = MILLIMETRES * np.real(cast(Surface, passage.whole[name])(0.5, 0.5))
    right, up, _ = camera.seen(middle)
    halo = [withStroke(linewidth=3.0, foreground="white", alpha=0.7)]
    axes.text(float(right), float(up), name, ha="center", va="center", path_effects=halo)
