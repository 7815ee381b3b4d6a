"""An edge of a section close by, with the circle of its radius."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from bladewright.numerics.elementary import unit
from bladewright.views.sections import COORDINATES, along_curve, developed, outline
from bladewright.views.style import CAMBER, INK, MILLIMETRES, RED, span_colour, titled

if TYPE_CHECKING:
    from bladewright.section.section import Section

REACH, PART = 5.0, 0.15
"""half width of the picture, in edge radii, but no more than a part of the chord"""


def draw_edge(axes: Axes, section: "Section", *, trailing: bool) -> None:
    """Draws the leading or the trailing edge of a section, the circle of curvature and the camber line there."""
    radius = section.edge_radii[int(trailing)] * MILLIMETRES
    at = np.array([float(trailing)])
    tip = developed(section, section.camber(at))[0]
    inwards = np.real(unit(section.camber.derivative(at)))[0] * (-1.0 if trailing else 1.0)
    centre = tip + radius * inwards
    shape = outline(section)
    colour = span_colour(section.span)
    axes.fill(*shape.T, color=colour, alpha=0.14, linewidth=0.0)
    axes.plot(*shape.T, color=colour)
    camber = developed(section, section.camber(along_curve()))
    axes.plot(*camber.T, color=INK, linewidth=0.9, linestyle=CAMBER)
    axes.add_patch(Circle((centre[0], centre[1]), radius, fill=False, edgecolor=RED, linewidth=1.1, linestyle="--"))
    axes.plot(*centre, marker="+", color=RED, markersize=7.0)
    reach = float(np.clip(PART * section.chord * MILLIMETRES, 1.5 * radius, REACH * radius))
    middle = tip + 0.6 * reach * inwards
    axes.set_xlim(middle[0] - reach, middle[0] + reach)
    axes.set_ylim(middle[1] - reach, middle[1] + reach)
    axes.set_aspect("equal", adjustable="box")
    edge = "Trailing" if trailing else "Leading"
    titled(axes, f"{edge} edge, radius {radius:.4g} mm", *COORDINATES[section.plane])
