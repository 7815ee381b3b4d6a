"""An edge of a section close by, with the circle of its radius where it is round."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle
from matplotlib.ticker import MaxNLocator

from bladewright.numerics.elementary import length, unit
from bladewright.views.sections import COORDINATES, along_curve, developed, outline, size_of
from bladewright.views.style import CAMBER, INK, MILLIMETRES, RED, span_colour, span_name, titled

if TYPE_CHECKING:
    from matplotlib.figure import SubFigure

    from bladewright.section.section import Section

REACH, PART = 5.0, 0.15
"""half width of the picture, in edge radii, but no more than a part of the chord"""
FLAT = 100.0
"""radius, in chords, from which on an edge is called flat"""
SHARP = 0.01
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
    true = magnified(section, trailing=trailing)
    at, kind = np.array([float(trailing)]), section.edges[int(trailing)]
    tip = true * developed(section, section.camber(at))[0]
    inwards = np.real(unit(section.camber.derivative(at)))[0] * (-1.0 if trailing else 1.0)
    shape = true * outline(section)
    colour = span_colour(section.span)
    axes.fill(*shape.T, color=colour, alpha=0.14, linewidth=0.0)
    axes.plot(*shape.T, color=colour)
    camber = true * developed(section, section.camber(along_curve()))
    axes.plot(*camber.T, color=INK, linewidth=0.9, linestyle=CAMBER)
    size, said = edge_size(section, trailing=trailing)
    if kind == "round" and size < PART * float(np.real(section.chord)) * MILLIMETRES:
        centre = tip + size * inwards
        axes.add_patch(Circle((centre[0], centre[1]), size, fill=False, edgecolor=RED, linewidth=1.1, linestyle="--"))
        axes.plot(*centre, marker="+", color=RED, markersize=7.0)
    reach = edge_reach(section, size)
    middle = tip + 0.6 * reach * inwards
    axes.set_xlim(middle[0] - reach, middle[0] + reach)
    axes.set_ylim(middle[1] - reach, middle[1] + reach)
    axes.set_aspect("equal", adjustable="box")
    edge = "Trailing edge" if trailing else "Leading edge"
    titled(axes, f"{edge}, {said}", *AT_EDGE.get(section.plane, COORDINATES[section.plane]))


def magnified(section: "Section", *, trailing: bool) -> float:
    """Lengths at an edge over those of the developed section there, which is scaled by its mean radius."""
    end = np.real(section.camber.control_points[-1 if trailing else 0, :1])
    return float(np.real(section.scale(end))[0]) * MILLIMETRES / size_of(section)


def edge_reach(section: "Section", size: float) -> float:
    """Half width [mm] of the picture of an edge of a size [mm]."""
    widest = PART * float(np.real(section.chord)) * MILLIMETRES
    return min(max(widest, 1.5 * size), REACH * size) if size < widest else widest


def edge_size(section: "Section", *, trailing: bool) -> tuple[float, str]:
    """A length [mm] that says how large the edge is, and how it is called."""
    kind, end = section.edges[int(trailing)], -1 if trailing else 0
    if kind == "round":
        radius = section.edge_radii[int(trailing)] * MILLIMETRES
        flat = radius > FLAT * float(np.real(section.chord)) * MILLIMETRES
        return radius, "flat" if flat else f"radius {radius:.4g} mm"
    sides = [developed(section, section.curves[name](np.array([0.0, 1.0]))) for name in ("upper", "lower")]
    width = magnified(section, trailing=trailing) * float(length(sides[0][end] - sides[1][end]))
    if kind == "blunt":
        return 0.5 * width, f"blunt, {width:.4g} mm"
    return SHARP * float(np.real(section.chord)) * MILLIMETRES, "sharp"
