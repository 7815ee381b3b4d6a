"""Sections in their developed plane: the shapes along the span, and the passage between two neighbours."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals
from bladewright.views.style import (
    CAMBER,
    INK,
    MILLIMETRES,
    PALE,
    RED,
    SOFT,
    WALLS,
    legend_below,
    span_colour,
    span_name,
    titled,
)

if TYPE_CHECKING:
    from bladewright.blade.blade import Blade
    from bladewright.section.section import Section

COORDINATES = {
    "x-y": ("x [mm]", "y [mm]"),
    "m-y": ("m [mm]", "y [mm]"),
    "m'-theta": (r"$m'\,\bar{r}$ [mm]", r"$\theta\,\bar{r}$ [mm]"),
    "m-r*theta": ("m [mm]", r"$r\,\theta$ [mm]"),
    "u-y/L": (r"$u\,L$ [mm]", r"$r\,\theta$ [mm]"),
}
"""the developed planes' axes; a bar is the mean along the section, so that angles are true and lengths near it"""
ALONE = 4.0
"""pitch, in chords, from which on a neighbour is not drawn"""


def along_curve(count: int = 201) -> Reals:
    """Parameters (count,) from 0 to 1, dense towards both edges."""
    return (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, count))) / 2.0


def size_of(section: "Section") -> float:
    """Millimetres in a unit of the section's plane, the mean between its edges."""
    ends = np.real(section.camber.control_points[[0, -1], 0])
    return float(np.mean(np.real(section.scale(np.linspace(ends[0], ends[1], 65))))) * MILLIMETRES


def developed(section: "Section", points: Reals) -> Reals:
    """Points (n, 2) of the section's plane in millimetres."""
    return np.real(points) * size_of(section)


def outline(section: "Section") -> Reals:
    """The closed section (n, 2) in millimetres: upper side from leading to trailing edge, lower side back."""
    u = along_curve()
    upper, lower = (developed(section, section.curves[name](u)) for name in ("upper", "lower"))
    closing = upper[:1] if section.edges[0] == "blunt" else upper[:0]
    return np.concatenate([upper, lower[::-1], closing])


def pitch_of(blade: "Blade", section: "Section") -> float:
    """Tangential distance of neighbours in the section's developed plane [mm]."""
    from bladewright.section.checks import UNITS

    design = blade.design
    if design.pitch is not None:
        return design.pitch * UNITS[design.length_unit] * MILLIMETRES
    radius = size_of(section)
    if section.plane != "m'-theta":
        lines = blade.exact.stations(np.array([section.span])).lines
        radius = float(np.mean(np.real(lines.position(np.linspace(0.0, 1.0, 65))[..., 1]))) * MILLIMETRES
    return 2.0 * np.pi / (design.blade_count or 1) * radius


def neighbours(blade: "Blade", section: "Section", shape: Reals) -> Reals:
    """The closed section (n, 2) [mm] one pitch away from a drawn one of a blade."""
    mapping, pitch = blade.exact.mapping, pitch_of(blade, section)
    aside = np.full(len(shape), pitch)
    if not mapping.keeps_ordinate and mapping.revolved:
        lines = blade.exact.stations(np.array([section.span])).lines
        radius = lines.position(lines.u_at((shape[:, 0] / size_of(section))[None]))[..., 1]
        turn = np.full(radius.shape, 2.0 * np.pi / (blade.design.blade_count or 1))
        aside = np.real(mapping.start(turn, radius, lines.lengths[..., None]))[0] * size_of(section)
    return np.stack([shape[:, 0], shape[:, 1] + aside], axis=-1)


def draw_sections(axes: Axes, sections: Sequence["Section"], ends: tuple[str, str] = WALLS) -> None:
    """Draws sections along the span over one another, each with its camber line."""
    for section in sections:
        colour = span_colour(section.span)
        shape = outline(section)
        axes.fill(*shape.T, color=colour, alpha=0.10, linewidth=0.0)
        axes.plot(*shape.T, color=colour, label=span_name(section.span, ends))
        camber = developed(section, section.camber(along_curve()))
        axes.plot(*camber.T, color=colour, linewidth=0.8, linestyle=CAMBER)
    titled(axes, "Sections with camber lines", *COORDINATES[sections[0].plane])
    axes.set_aspect("equal", adjustable="datalim")
    legend_below(axes, 5, handlelength=1.0, columnspacing=0.9)


def draw_passage(axes: Axes, section: "Section", pitch: float | None, title: str, blade: "Blade | None" = None) -> None:
    """Draws a section with its camber line, and its neighbour one pitch [mm] away with the narrowest gap between.

    The neighbour's place is the blade's where one is given.
    """
    shape = outline(section)
    colour = span_colour(section.span)
    chord = section.chord * MILLIMETRES
    axes.fill(*shape.T, color=colour, alpha=0.14, linewidth=0.0)
    axes.plot(*shape.T, color=colour)
    camber = developed(section, section.camber(along_curve()))
    axes.plot(*camber.T, color=INK, linewidth=0.9, linestyle=CAMBER, label="camber line")
    axes.plot(*camber[[0, -1]].T, color=SOFT, linewidth=0.8, linestyle=":", label=f"chord {chord:.4g} mm")
    if pitch is not None and pitch < ALONE * chord:
        neighbour = shape + np.array([0.0, pitch]) if blade is None else neighbours(blade, section, shape)
        axes.fill(*neighbour.T, color=PALE, linewidth=0.0)
        axes.plot(*neighbour.T, color=SOFT)
        gap = narrowest(shape, neighbour)
        width = float(length(gap[1] - gap[0]))
        axes.plot(*gap.T, color=RED, linewidth=1.1, marker="o", markersize=3.0, label=f"narrowest {width:.4g} mm")
    if pitch is not None:
        title = f"{title}, pitch {pitch:.4g} mm"
    titled(axes, title, *COORDINATES[section.plane])
    axes.set_aspect("equal", adjustable="datalim")
    legend_below(axes, 3, handlelength=1.5, columnspacing=0.9)


def narrowest(shape: Reals, neighbour: Reals) -> Reals:
    """The two points (2, 2) of two closed outlines that are nearest to one another."""
    apart = length(shape[:, None] - neighbour[None])
    first, second = np.unravel_index(int(np.argmin(apart)), apart.shape)
    return np.stack([shape[first], neighbour[second]])
