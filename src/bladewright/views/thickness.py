"""Thickness: what sections have across their camber line, and the laws along the chord that ask for it."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes

from bladewright.nurbs.basis import Reals, greville, uniform_knots
from bladewright.section.laws import DEGREE, Span
from bladewright.views.curvature import sides_legend
from bladewright.views.style import LOWER, MILLIMETRES, UPPER, WALLS, legend_below, span_colour, span_name, titled

if TYPE_CHECKING:
    from bladewright.section.section import Section

CHORD = "along the camber, leading to trailing edge [-]"


def control_places(count: int) -> Reals:
    """Where a law's control points stand between 0 and 1 (count,); a constant stands in the middle."""
    return np.array([0.5]) if count == 1 else greville(uniform_knots(count, degree := min(count - 1, DEGREE)), degree)


def draw_thickness(axes: Axes, sections: Sequence["Section"], ends: tuple[str, str] = WALLS) -> None:
    """Draws the built thickness across the camber line [mm], its largest value marked."""
    for section in sections:
        colour = span_colour(section.span)
        u, thickness = section.thickness
        largest, place = section.maximum_thickness
        share = 100.0 * largest / section.chord
        label = f"{largest * MILLIMETRES:.3g} mm, {share:.3g} % of the chord"
        if len(sections) > 1:
            label = f"{span_name(section.span, ends)} {share:.3g} %"
        axes.plot(u, thickness * MILLIMETRES, color=colour, label=label)
        axes.plot(place, largest * MILLIMETRES, marker="o", markersize=4.0, color=colour, linestyle="none")
    axes.set_ylim(bottom=0.0)
    axes.set_xlim(-0.01, 1.01)
    titled(axes, "Thickness as built, largest in % of chord", CHORD, "thickness across the camber [mm]")
    legend_below(axes, 3, handlelength=1.2)


def draw_thickness_laws(axes: Axes, design: Any, sections: Sequence["Section"], length_name: str) -> None:
    """Draws the laws of half thickness along the chord [% of a length], with their control points."""
    u = np.linspace(0.0, 1.0, 101)
    for section in sections:
        span = Span(np.array([section.span]))
        colour = span_colour(section.span)
        for name, style, marker in (("upper", UPPER, "o"), ("lower", LOWER, "s")):
            laws = getattr(design, f"thickness_{name}")
            points = np.array([np.real(span.values(law))[0] for law in laws])
            axes.plot(u, 100.0 * np.real(span.chordwise(laws, u))[0], color=colour, linestyle=style)
            axes.plot(
                control_places(len(laws)),
                100.0 * points,
                color=colour,
                linestyle=":",
                linewidth=0.7,
                marker=marker,
                markersize=4.5,
                markerfacecolor="white",
            )
    axes.set_ylim(bottom=0.0)
    axes.set_xlim(-0.03, 1.03)
    titled(axes, "Half thickness along the chord", CHORD, f"half thickness [% of {length_name}]")
    sides_legend(axes, [section.span for section in sections], getattr(design, "ends", WALLS))
