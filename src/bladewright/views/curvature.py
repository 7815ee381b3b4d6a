"""Curvature along the sides of sections, from leading to trailing edge."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals
from bladewright.views.sections import along_curve
from bladewright.views.style import (
    INK,
    LOWER,
    MILLIMETRES,
    SOFT,
    UPPER,
    WALLS,
    legend_below,
    span_colour,
    span_name,
    titled,
)

if TYPE_CHECKING:
    from bladewright.section.section import Section


def side_curvature(section: "Section", name: str) -> tuple[Reals, Reals]:
    """Part of the side's arc from the leading edge (n,) and curvature there (n,) [1/mm], positive where convex."""
    u = along_curve(601)
    points = np.real(section.curves[name](u))
    steps = length(np.diff(points, axis=0)) * np.real(section.scale((points[1:, 0] + points[:-1, 0]) / 2.0))
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    outwards = -1.0 if name == "upper" else 1.0
    return arc / arc[-1], outwards * section.curvature(name, u) / MILLIMETRES


def draw_curvature(axes: Axes, sections: Sequence["Section"], ends: tuple[str, str] = WALLS) -> None:
    """Draws the curvature of both sides; linear around zero, logarithmic beyond, so that the noses drown nothing."""
    for section in sections:
        for name, style in (("upper", UPPER), ("lower", LOWER)):
            axes.plot(*side_curvature(section, name), color=span_colour(section.span), linestyle=style, linewidth=1.2)
    least = 2.0 / (MILLIMETRES * min(section.chord for section in sections))
    decade = 10.0 ** np.floor(np.log10(least))
    threshold = decade * min(each for each in (1.0, 2.0, 5.0, 10.0) if each * decade >= least)
    axes.set_yscale("symlog", linthresh=threshold, linscale=1.5)
    low, high = axes.get_ylim()
    beyond = decade * 10.0 ** np.arange(1.0, 9.0)
    beyond = beyond[beyond > 1.5 * threshold]
    ticks = np.concatenate([-beyond, threshold * np.linspace(-1.0, 1.0, 5), beyond])
    axes.set_ylim(low, high)
    axes.yaxis.set_major_locator(FixedLocator(ticks[(ticks >= low) & (ticks <= high)].tolist()))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.axhline(0.0, color=SOFT, linewidth=0.8)
    axes.set_xlim(-0.01, 1.01)
    place = "part of the arc, leading to trailing edge [-]"
    titled(axes, "Curvature of the sides, convex positive", place, "curvature [1/mm]")
    sides_legend(axes, [section.span for section in sections], ends)


def sides_legend(axes: Axes, spans: Sequence[float], ends: tuple[str, str] = WALLS) -> None:
    """A legend under the panel: the spans by colour, where there are several, and the sides by line."""
    handles = [Line2D([], [], color=span_colour(v), label=span_name(v, ends)) for v in spans]
    ink = INK if len(spans) > 1 else span_colour(spans[0])
    styles = {"upper": UPPER, "lower": LOWER}
    sides = [Line2D([], [], color=ink, linestyle=style, label=name) for name, style in styles.items()]
    handles = [*(handles if len(spans) > 1 else []), *sides]
    legend_below(axes, 3, handles=handles)
