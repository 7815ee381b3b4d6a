"""Rows, sectors and wheels: their view in space, their half section, and their figures."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bladewright.errors import DesignError
from bladewright.nurbs.basis import Reals
from bladewright.views.faces import Face, borders, is_closed, meridian_line, sampled, turns_along_u
from bladewright.views.masses import mass_rows
from bladewright.views.meridional import CURVES, blade_outline, draw_covered, draw_cuts
from bladewright.views.pages import Page, checked_path, columns, draw_header, rows, write_figure
from bladewright.views.passage import cubic, draw_figures
from bladewright.views.raster import Polyline, ShadedGrid, framing_camera, rendered
from bladewright.views.solid import (
    BLADE,
    EDGE,
    FAINT,
    FILLET,
    HUB,
    edge_rows,
    mixed,
    places_on,
    show_rendering,
    viewpoint,
    viewpoints,
)
from bladewright.views.style import (
    GREY,
    SOFT,
    VIEW_DPI,
    WALLS,
    axis,
    drawing_style,
    in_unit,
    label_axes,
    legend_below,
    per_metre,
    unit_name,
)
from bladewright.views.view3d import Group, Scene, all_points, with_copies

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade

BODIES = ("row", "sector", "wheel")
"""The names under which they are shown."""
NUMBERED = re.compile(r"(blade|hub|shroud)_0*(\d+)(?:_(\w+))?$")
"""Names of the faces that a row or a wheel has once for each of its blades."""
CUT = (0.86, 0.84, 0.80)
"""Colour of the cuts between two sectors."""
ALONE, BESIDE = (1250, 1000), (800, 700)
"""Largest width and height of a view alone and of one of two beside each other [pixels]."""
FINE, COARSE = (121, 33), (41, 11)
"""Points along and across a side of a blade, in pictures and in views that turn."""
AROUND = 3
"""Points of a full turn, in points along a side."""
WIDEST = 44
"""Letters in a line of names of faces."""
SUNK = 1e-3
"""How far walls are drawn inside the metal, in chords: more than their grids are off, less than is seen."""
NOUGHT = 1e-9
"""Distance from the axis, in chords, that a table shows as 0: rounding."""
Rows = list[tuple[str, str]]
"""Names and values of a table; a heading has no value."""


class BladedBody(Protocol):
    """A body made of blades: a row, a sector, a wheel."""

    @property
    def name(self) -> str:
        """Name of the product."""

    @property
    def description(self) -> str:
        """One line about it."""

    @property
    def blade(self) -> "Blade":
        """One of its blades."""

    @property
    def surfaces(self) -> Mapping[str, Face]:
        """Its faces [m]."""

    @property
    def orientations(self) -> Mapping[str, int]:
        """+1 for a face whose dS/du x dS/dv points out of the body, -1 for the others."""

    @property
    def properties(self) -> Any:
        """Volume, area and centroid."""

    @property
    def metal(self) -> Any:
        """The design that states the density."""

    def mass_report(self) -> Any:
        """Mass, centre and inertia."""


def body_view(body: BladedBody, path: str | Path) -> None:
    """Draw a row, a sector or a wheel in space, shaded, as PNG, SVG or PDF by the ending of `path`.

    Raises FileError where the ending is another or the path cannot be written, DesignError where something else is
    given.
    """
    checked_path(path)
    if getattr(body, "shown_as", "") not in BODIES:
        raise DesignError(f"a {type(body).__name__} was given: draw what row, sector or wheel of a blade makes")
    with drawing_style(body.blade.design.length_unit):
        figure = Figure(figsize=(10.0, 8.0), layout="constrained")
        draw_body(figure.add_subplot(), body, size=ALONE, view=viewpoint(body.blade))
        write_figure(figure, path, VIEW_DPI)


def body_sheet(body: BladedBody) -> Figure:
    """The sheet of a row, a sector or a wheel, before its layout."""
    figure = Page(figsize=(16.0, 13.0))
    volume = f"volume {cubic(body.properties.volume)}"
    draw_header(figure, body.name, body.description, [_count(body), volume, f"{len(body.surfaces)} faces"])
    top, bottom = rows(figure, 7.0, 5.0)
    views = top.subplots(1, 2)
    seen = viewpoints(body.blade, opposite=True)
    for place, view, title in zip(views, seen, ("In space", "The other side"), strict=True):
        draw_body(place, body, size=BESIDE, view=view)
        place.set_title(title)
        place.set_anchor("N")
    section, numbers = columns(bottom, 1.4, 1.0)
    draw_half_section(section.subplots(), body)
    draw_figures(numbers.subplots(), body_figures(body))
    return figure


def draw_body(axes: Axes, body: BladedBody, *, size: tuple[int, int], view: Reals) -> None:
    """Draw the body at most `size` pixels wide and high, as the viewer with axes `view` (3, 3) sees it."""
    scene = body_scene(body, FINE)
    camera = framing_camera(view, all_points(scene))
    width = int(min(size[0], size[1] * camera.extent[0] / camera.extent[1]))
    show_rendering(axes, camera, rendered(*with_copies(scene), camera, width))


def body_scene(body: BladedBody, size: tuple[int, int] = COARSE) -> Scene:
    """The body in space; what it has once for each blade is one group with its places."""
    copies = max((int(found[2]) for name in body.surfaces if (found := NUMBERED.match(name))), default=1)
    design = body.blade.design
    step = design.spacing if design.blade_count else per_metre() * float(np.real(design.spacing))
    repeated, once = (list[ShadedGrid](), list[Polyline]()), (list[ShadedGrid](), list[Polyline]())
    for name, face in body.surfaces.items():
        found = NUMBERED.match(name)
        if found and int(found[2]) > 1:
            continue
        surfaces, lines = repeated if found else once
        own = (found[3] or found[1]) if found else name.removeprefix("blade_")
        of_blade = body.blade if name.startswith("blade_") else None
        surface, around = _drawn(own, face, size, whole=copies > 1, of_blade=of_blade)
        if own in WALLS:
            # a fillet's foot is tangent to the wall, which must not be seen through it
            sunk = SUNK * per_metre() * body.blade.chord * body.orientations[name]
            surface = replace(surface, points=surface.points - sunk * surface.normals)
        surfaces.append(surface)
        lines += [] if found and not found[3] else around
    turns = [step * k for k in range(copies)]
    groups = [Group(surfaces=repeated[0], lines=repeated[1], turns=turns), Group(surfaces=once[0], lines=once[1])]
    return Scene(blade=body.blade, groups=[group for group in groups if group.surfaces])


def _drawn(
    name: str, face: Face, size: tuple[int, int], *, whole: bool, of_blade: "Blade | None"
) -> tuple[ShadedGrid, list[Polyline]]:
    """A face with the lines around it that are edges of the body."""
    if of_blade is not None:
        fillet, edges = "fillet" in name, edge_rows(of_blade, name)
        points, normals = sampled(face, *places_on(name, size))
        lines = borders(face) if edges is None else [points[:, row] for row in edges]
        colour = mixed(BLADE, FILLET) if fillet else BLADE
        ink = FAINT if fillet else EDGE
    else:
        count = AROUND * size[0] if whole and name not in WALLS else size[0]
        along, around = np.linspace(0.0, 1.0, size[1]), np.linspace(0.0, 1.0, count)
        cyclic = "cyclic" in name
        turned = not cyclic and turns_along_u(face)
        points, normals = sampled(face, *((around, along) if turned else (along, around)))
        lines = [line for line in borders(face) if is_closed(line) or not whole]
        colour, ink = CUT if cyclic else HUB, EDGE
    surface = ShadedGrid(points=points, normals=normals, colour=colour)
    return surface, [Polyline(points=line, colour=ink) for line in lines]


def draw_half_section(axes: Axes, body: BladedBody) -> None:
    """Draw what the body covers in the (x, r) plane, or (x, z) of a cascade: its disc, its ring and its blades."""
    for label, lines in carried_lines(body).items():
        outline = chained(lines)
        axes.fill(*outline.T, color=SOFT, alpha=0.45, linewidth=0.0, label=label)
        for line in lines:
            axes.plot(*line.T, color=GREY, linewidth=1.0)
            axes.plot(*line[[0, -1]].T, color=GREY, linestyle="none", marker=".", markersize=3.0)
    draw_covered(axes, body.blade)
    covered = blade_outline(body.blade.plain) * per_metre()
    draw_cuts(axes, body.blade, covered)
    view = body.blade.exact.meridional_view
    for name in ("hub", "shroud"):
        axes.plot(*(view.lines[name].points * per_metre()).T, color=CURVES[name], linewidth=1.2, label=name)
    revolved = body.blade.exact.mapping.revolved
    label_axes(axes, "Half section", axis("x"), axis("r" if revolved else "z"))
    axes.set_aspect("equal", adjustable="datalim")
    legend_below(axes, 5)


def carried_lines(body: BladedBody) -> dict[str, list[Reals]]:
    """Meridional lines (n, 2) [unit of the picture] of the faces of revolution around the disc, and around the ring."""
    found = dict[str, list[Reals]]()
    for name, face in body.surfaces.items():
        numbered = NUMBERED.match(name)
        if name.startswith("blade") or "cyclic" in name or (numbered and int(numbered[2]) > 1):
            continue
        where = "shroud ring" if name.startswith(("shroud", "ring")) else "disc"
        found.setdefault(where, []).append(meridian_line(face))
    return found


def chained(lines: Sequence[Reals]) -> Reals:
    """Points (n, 2) along lines, each taken on from the end of the one before by its nearer end."""
    outline, left = lines[0], list(lines[1:])
    while left:
        gaps = [
            (float(np.sum((line[end] - outline[-1]) ** 2)), index, end)
            for index, line in enumerate(left)
            for end in (0, -1)
        ]
        _, index, end = min(gaps)
        line = left.pop(index)
        outline = np.concatenate([outline, line if end == 0 else line[::-1]])
    return outline


def body_figures(body: BladedBody) -> Rows:
    """Volume, area, centroid, mass and faces."""
    found, blade = body.properties, body.blade
    centroid = per_metre() * np.real(found.centroid)
    centroid = np.where(np.square(centroid) < (NOUGHT * per_metre() * blade.chord) ** 2, 0.0, centroid)
    area = float(np.real(found.area)) * per_metre() ** 2
    rows_of = [
        ("Geometry", ""),
        ("volume", cubic(found.volume)),
        ("volume of a blade", cubic(blade.properties.volume)),
        ("surface", f"{area:.6g} {unit_name()}²"),
        ("centroid", f"{', '.join(f'{x:.4g}' for x in centroid)} {unit_name()}"),
        ("mean chord", in_unit(blade.chord)),
    ]
    masses = mass_rows(body)
    rows_of += [("Mass", ""), *masses] if masses else []
    names = dict.fromkeys(NUMBERED.sub(r"\1 \3", name).replace("_", " ").strip() for name in body.surfaces)
    kinds = [name.removeprefix("blade ") for name in names if name.startswith("blade")]
    others = [name for name in names if not name.startswith("blade")]
    rows_of += [(f"{len(body.surfaces)} faces", "")]
    for title, found_names in (("of a blade", kinds), ("others", others)):
        # names of two words are not broken
        lines = wrap(", ".join(name.replace(" ", "\0") for name in found_names), WIDEST)
        rows_of += [(" " if index else title, line.replace("\0", " ")) for index, line in enumerate(lines)]
    return rows_of


def _count(body: BladedBody) -> str:
    count = body.blade.design.blade_count
    return "linear cascade" if count is None else f"{count} blade{'s' if count > 1 else ''}"
