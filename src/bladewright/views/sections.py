"""Sections in their developed plane: along the span, next to their neighbour, and close up at both edges."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle
from matplotlib.ticker import MaxNLocator

from bladewright.numerics.elementary import length, unit
from bladewright.nurbs.basis import Reals
from bladewright.views.style import (
    CAMBER,
    INK,
    MILLIMETRES,
    PALE,
    RED,
    SOFT,
    WALLS,
    label_axes,
    legend_below,
    span_colour,
    span_name,
)

if TYPE_CHECKING:
    from matplotlib.figure import SubFigure

    from bladewright.blade.native.blade import Blade
    from bladewright.section.section import Section


COORDINATES = {
    "x-y": ("x [mm]", "y [mm]"),
    "m-y": ("m [mm]", "y [mm]"),
    "m'-theta": (r"$m'\,\bar{r}$ [mm]", r"$\theta\,\bar{r}$ [mm]"),
    "m-r*theta": ("m [mm]", r"$r\,\theta$ [mm]"),
    "u-y/L": (r"$u\,L$ [mm]", r"$r\,\theta$ [mm]"),
}
"""the developed planes' axes; a bar is the mean along the section, so that angles are true and lengths near it"""
ISOLATED_PITCH = 4.0
"""pitch, in chords, from which on a neighbour is not drawn"""


def cosine_spacing(count: int = 201) -> Reals:
    """Parameters (count,) from 0 to 1, dense towards both edges."""
    return (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, count))) / 2.0


def millimetres_per_unit(section: "Section") -> float:
    """Millimetres in a unit of the section's plane, the mean between its edges."""
    ends = np.real(section.camber.control_points[[0, -1], 0])
    return float(np.mean(np.real(section.scale(np.linspace(ends[0], ends[1], 65))))) * MILLIMETRES


def developed(section: "Section", points: Reals) -> Reals:
    """Points (n, 2) of the section's plane in millimetres."""
    return np.real(points) * millimetres_per_unit(section)


def outline(section: "Section") -> Reals:
    """The closed section (n, 2) in millimetres: upper side from leading to trailing edge, lower side back."""
    u = cosine_spacing()
    upper, lower = (developed(section, section.curves[name](u)) for name in ("upper", "lower"))
    closing = upper[:1] if section.edges[0] == "blunt" else upper[:0]
    return np.concatenate([upper, lower[::-1], closing])


def pitch_of(blade: "Blade", section: "Section") -> float:
    """Tangential distance of neighbours in the section's developed plane [mm]."""
    from bladewright.section.checks import UNITS

    design = blade.design
    if design.pitch is not None:
        return design.pitch * UNITS[design.length_unit] * MILLIMETRES
    radius = millimetres_per_unit(section)
    if section.plane != "m'-theta":
        lines = blade.exact.sections(np.array([section.span])).lines
        radius = float(np.mean(np.real(lines.position(np.linspace(0.0, 1.0, 65))[..., 1]))) * MILLIMETRES
    return 2.0 * np.pi / (design.blade_count or 1) * radius


def neighbour_outline(blade: "Blade", section: "Section", shape: Reals) -> Reals:
    """The closed section (n, 2) [mm] one pitch away from a drawn one of a blade."""
    mapping, pitch = blade.exact.mapping, pitch_of(blade, section)
    aside = np.full(len(shape), pitch)
    if not mapping.keeps_ordinate and mapping.revolved:
        lines = blade.exact.sections(np.array([section.span])).lines
        radius = lines.position(lines.u_at((shape[:, 0] / millimetres_per_unit(section))[None]))[..., 1]
        turn = np.full(radius.shape, 2.0 * np.pi / (blade.design.blade_count or 1))
        aside = np.real(mapping.start(turn, radius, lines.lengths[..., None]))[0] * millimetres_per_unit(section)
    return np.stack([shape[:, 0], shape[:, 1] + aside], axis=-1)


def draw_sections(axes: Axes, sections: Sequence["Section"], ends: tuple[str, str] = WALLS) -> None:
    """Draws sections along the span over one another, each with its camber line."""
    for section in sections:
        colour = span_colour(section.span)
        shape = outline(section)
        axes.fill(*shape.T, color=colour, alpha=0.10, linewidth=0.0)
        axes.plot(*shape.T, color=colour, label=span_name(section.span, ends))
        camber = developed(section, section.camber(cosine_spacing()))
        axes.plot(*camber.T, color=colour, linewidth=0.8, linestyle=CAMBER)
    label_axes(axes, "Sections with camber lines", *COORDINATES[sections[0].plane])
    axes.set_aspect("equal", adjustable="datalim")
    legend_below(axes, 5, handlelength=1.0, columnspacing=0.9)


def draw_neighbour(
    axes: Axes, section: "Section", pitch: float | None, title: str, blade: "Blade | None" = None
) -> None:
    """Draws a section with its camber line, and its neighbour one pitch [mm] away with the narrowest gap between.

    The neighbour's place is the blade's where one is given.
    """
    shape = outline(section)
    colour = span_colour(section.span)
    chord = section.chord * MILLIMETRES
    axes.fill(*shape.T, color=colour, alpha=0.14, linewidth=0.0)
    axes.plot(*shape.T, color=colour)
    camber = developed(section, section.camber(cosine_spacing()))
    axes.plot(*camber.T, color=INK, linewidth=0.9, linestyle=CAMBER, label="camber line")
    axes.plot(*camber[[0, -1]].T, color=SOFT, linewidth=0.8, linestyle=":", label=f"chord {chord:.4g} mm")
    if pitch is not None and pitch < ISOLATED_PITCH * chord:
        neighbour = shape + np.array([0.0, pitch]) if blade is None else neighbour_outline(blade, section, shape)
        axes.fill(*neighbour.T, color=PALE, linewidth=0.0)
        axes.plot(*neighbour.T, color=SOFT)
        gap = narrowest_gap(shape, neighbour)
        width = float(length(gap[1] - gap[0]))
        axes.plot(*gap.T, color=RED, linewidth=1.1, marker="o", markersize=3.0, label=f"narrowest {width:.4g} mm")
    if pitch is not None:
        title = f"{title}, pitch {pitch:.4g} mm"
    label_axes(axes, title, *COORDINATES[section.plane])
    axes.set_aspect("equal", adjustable="datalim")
    legend_below(axes, 3, handlelength=1.5, columnspacing=0.9)


def narrowest_gap(shape: Reals, neighbour: Reals) -> Reals:
    """The two points (2, 2) of two closed outlines that are nearest to one another."""
    apart = length(shape[:, None] - neighbour[None])
    first, second = np.unravel_index(int(np.argmin(apart)), apart.shape)
    return np.stack([shape[first], neighbour[second]])


EDGE_WINDOW_RADII, EDGE_WINDOW_CHORDS = 5.0, 0.15
"""half width of the picture, in edge radii, but no more than a part of the chord"""
FLAT_EDGE_RADIUS = 100.0
"""radius, in chords, from which on an edge is called flat"""
SHARP_EDGE_SIZE = 0.01
"""what stands for the radius of a sharp edge, of the chord"""
AT_EDGE = {"m'-theta": (r"$m'\,r_e$ [mm]", r"$\theta\,r_e$ [mm]")}
"""axes where lengths are true at the edge, whose radius is r_e; otherwise they are `COORDINATES`"""


def draw_edges(strip: "SubFigure", sections: Sequence["Section"], ends: tuple[str, str]) -> None:
    """Draws both edges of sections along the span beside each other."""
    axes = strip.subplots(1, 2 * len(sections))
    for index, section in enumerate(sections):
        for trailing in (False, True):
            place = axes[index + len(sections) * trailing]
            draw_edge(place, section, trailing=trailing)
            name, _, said = place.get_title(loc="left").partition(", ")
            place.set_title(f"{name}, {span_name(section.span, ends)}\n{said}", fontsize=9.5)
            place.set_ylabel("")
            place.xaxis.set_major_locator(MaxNLocator(3))
            place.yaxis.set_major_locator(MaxNLocator(4))


def draw_edge(axes: Axes, section: "Section", *, trailing: bool) -> None:
    """Draws the leading or the trailing edge of a section and the camber line there, of a round one the circle too.

    Lengths are true at the edge. A flat one that is round by its directions alone, as the back face of a wedge
    diffuser's vane, has no circle.
    """
    true = edge_scale(section, trailing=trailing)
    at, kind = np.array([float(trailing)]), section.edges[int(trailing)]
    tip = true * developed(section, section.camber(at))[0]
    inwards = np.real(unit(section.camber.derivative(at)))[0] * (-1.0 if trailing else 1.0)
    shape = true * outline(section)
    colour = span_colour(section.span)
    axes.fill(*shape.T, color=colour, alpha=0.14, linewidth=0.0)
    axes.plot(*shape.T, color=colour)
    camber = true * developed(section, section.camber(cosine_spacing()))
    axes.plot(*camber.T, color=INK, linewidth=0.9, linestyle=CAMBER)
    size, said = edge_size(section, trailing=trailing)
    if kind == "round" and size < EDGE_WINDOW_CHORDS * float(np.real(section.chord)) * MILLIMETRES:
        centre = tip + size * inwards
        axes.add_patch(Circle((centre[0], centre[1]), size, fill=False, edgecolor=RED, linewidth=1.1, linestyle="--"))
        axes.plot(*centre, marker="+", color=RED, markersize=7.0)
    reach = edge_half_width(section, size)
    middle = tip + 0.6 * reach * inwards
    axes.set_xlim(middle[0] - reach, middle[0] + reach)
    axes.set_ylim(middle[1] - reach, middle[1] + reach)
    axes.set_aspect("equal", adjustable="box")
    edge = "Trailing edge" if trailing else "Leading edge"
    label_axes(axes, f"{edge}, {said}", *AT_EDGE.get(section.plane, COORDINATES[section.plane]))


def edge_scale(section: "Section", *, trailing: bool) -> float:
    """Lengths at an edge over those of the developed section there, which is scaled by its mean radius."""
    end = np.real(section.camber.control_points[-1 if trailing else 0, :1])
    return float(np.real(section.scale(end))[0]) * MILLIMETRES / millimetres_per_unit(section)


def edge_half_width(section: "Section", size: float) -> float:
    """Half width [mm] of the picture of an edge of a size [mm]."""
    widest = EDGE_WINDOW_CHORDS * float(np.real(section.chord)) * MILLIMETRES
    return min(max(widest, 1.5 * size), EDGE_WINDOW_RADII * size) if size < widest else widest


def edge_size(section: "Section", *, trailing: bool) -> tuple[float, str]:
    """A length [mm] that says how large the edge is, and how it is called."""
    kind, end = section.edges[int(trailing)], -1 if trailing else 0
    if kind == "round":
        radius = section.edge_radii[int(trailing)] * MILLIMETRES
        flat = radius > FLAT_EDGE_RADIUS * float(np.real(section.chord)) * MILLIMETRES
        return radius, "flat" if flat else f"radius {radius:.4g} mm"
    sides = [developed(section, section.curves[name](np.array([0.0, 1.0]))) for name in ("upper", "lower")]
    width = edge_scale(section, trailing=trailing) * float(length(sides[0][end] - sides[1][end]))
    if kind == "blunt":
        return 0.5 * width, f"blunt, {width:.4g} mm"
    return SHARP_EDGE_SIZE * float(np.real(section.chord)) * MILLIMETRES, "sharp"
