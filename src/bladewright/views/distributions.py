"""Distributions along a section: curvature, its slope with the jumps at joints, and thickness."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import SubFigure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals
from bladewright.section.smoothness import STEADY, SmoothLine, Smoothness
from bladewright.views.sections import cosine_spacing
from bladewright.views.style import (
    INK,
    LOWER,
    SOFT,
    UPPER,
    WALLS,
    axis,
    in_unit,
    label_axes,
    legend_below,
    per_metre,
    span_colour,
    span_name,
    unit_name,
)

if TYPE_CHECKING:
    from bladewright.section.section import Section

ARC_LABEL = "part of the arc, leading to trailing edge [-]"
"""Name of the abscissa along a side."""
CAMBER_LABEL = "along the camber, leading to trailing edge [-]"
"""Name of the abscissa along the camber line."""
EDGE_SHARE = 0.05
"""Fraction of the arc length at either end that does not set the scale of an axis: values at the edges are far larger
than between them."""


def side_curvature(section: "Section", name: str) -> tuple[Reals, Reals]:
    """Fraction of a side's arc length from the leading edge (n,) and curvature there (n,) [1/mm], convex positive."""
    u = cosine_spacing(601)
    points = np.real(section.curves[name](u))
    steps = length(np.diff(points, axis=0)) * np.real(section.scale((points[1:, 0] + points[:-1, 0]) / 2.0))
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    outwards = -1.0 if name == "upper" else 1.0
    return arc / arc[-1], outwards * section.curvature(name, u) / per_metre()


def draw_curvature(axes: Axes, sections: Sequence["Section"], ends: tuple[str, str] = WALLS) -> None:
    """Draw the curvature of both sides, linear about zero and logarithmic beyond, as it is far larger at the edges."""
    for section in sections:
        for name, style in (("upper", UPPER), ("lower", LOWER)):
            axes.plot(*side_curvature(section, name), color=span_colour(section.span), linestyle=style, linewidth=1.2)
    least = 2.0 / (per_metre() * min(section.chord for section in sections))
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
    label_axes(axes, "Curvature of the sides, convex positive", ARC_LABEL, f"curvature [1/{unit_name()}]")
    sides_legend(axes, [section.span for section in sections], ends)


def draw_thickness(axes: Axes, sections: Sequence["Section"], ends: tuple[str, str] = WALLS) -> None:
    """Draw the thickness across the camber line as built [mm], and mark its largest value."""
    for section in sections:
        colour = span_colour(section.span)
        u, thickness = section.thickness
        largest, place = section.maximum_thickness
        share = 100.0 * largest / section.chord
        label = f"{in_unit(largest, '.3g')}, {share:.3g} % of the chord"
        if len(sections) > 1:
            label = f"{span_name(section.span, ends)} {share:.3g} %"
        axes.plot(u, thickness * per_metre(), color=colour, label=label)
        axes.plot(place, largest * per_metre(), marker="o", markersize=4.0, color=colour, linestyle="none")
    axes.set_ylim(bottom=0.0)
    axes.set_xlim(-0.01, 1.01)
    label_axes(axes, "Thickness as built, largest in % of chord", CAMBER_LABEL, axis("thickness across the camber"))
    legend_below(axes, 3, handlelength=1.2)


def sides_legend(axes: Axes, spans: Sequence[float], ends: tuple[str, str] = WALLS) -> None:
    """Draw a legend under the panel: span fractions by colour, where there are several, and sides by line style."""
    handles = [Line2D([], [], color=span_colour(v), label=span_name(v, ends)) for v in spans]
    ink = INK if len(spans) > 1 else span_colour(spans[0])
    styles = {"upper": UPPER, "lower": LOWER}
    sides = [Line2D([], [], color=ink, linestyle=style, label=name) for name, style in styles.items()]
    handles = [*(handles if len(spans) > 1 else []), *sides]
    legend_below(axes, 3, handles=handles)


def draw_smoothness(strip: SubFigure, by_span: Mapping[float, Smoothness], ends: tuple[str, str] = WALLS) -> None:
    """Draw the slope of the sides' curvature, curvature and slope of the camber lines, and a table of jumps.

    `by_span` holds the smoothness of sections by their span fraction; lengths are in chords, in the section's plane.
    """
    axes = strip.subplots(1, 4, width_ratios=[1.0, 0.85, 0.85, 1.15])
    spans = list(by_span)
    for v, each in by_span.items():
        colour = span_colour(v)
        _draw(axes[0], each.upper, each.upper.slope, colour, UPPER, order=1)
        # On the lower side a convex bend turns the other way.
        _draw(axes[0], each.lower, -each.lower.slope, colour, LOWER, order=1)
        _draw(axes[1], each.camber, each.camber.curvature, colour, UPPER, order=0)
        _draw(axes[2], each.camber, each.camber.slope, colour, UPPER, order=1)
    sides = [line for each in by_span.values() for line in (each.upper, each.lower)]
    square = max(float(np.median(line.curvature**2)) for line in sides)
    _logarithmic(axes[0], np.concatenate([line.slope[_inside(line)] for line in sides]), least=STEADY * square)
    for place, name in ((axes[1], "curvature"), (axes[2], "slope")):
        _limited(place, [getattr(each.camber, name)[_inside(each.camber)] for each in by_span.values()])
    label_axes(axes[0], "Slope of the curvature of the sides", ARC_LABEL, "d curvature / d arc × chord² [-]")
    label_axes(axes[1], "Curvature of the camber line", ARC_LABEL, "curvature × chord [-]")
    label_axes(axes[2], "Slope of the camber's curvature", ARC_LABEL, "d curvature / d arc × chord² [-]")
    for place in axes[:3]:
        place.axhline(0.0, color=SOFT, linewidth=0.8)
        place.set_xlim(-0.01, 1.01)
    sides_legend(axes[0], spans, ends)
    _table(axes[3], by_span, ends)


def _draw(axes: Axes, line: SmoothLine, values: Reals, colour: Any, style: Any, *, order: int) -> None:
    """Draw one line, with a gap and two dots where the curvature (order 0) or its slope (order 1) jumps at a joint."""
    joints = [jump.at for jump in line.jumps if jump.place == "joint" and not jump.continuous[order]]
    cuts = [int(np.searchsorted(line.arc, at, side="left")) for at in joints]
    for part in np.split(np.arange(len(values)), cuts):
        axes.plot(line.arc[part], values[part], color=colour, linestyle=style, linewidth=1.2)
    dots = np.array([k for cut in cuts for k in (cut - 1, cut) if cut < len(values)], dtype=int)
    axes.plot(line.arc[dots], values[dots], color=colour, linestyle="none", marker="o", markersize=2.6)


def _inside(line: SmoothLine) -> Any:
    """Whether each point of a line (n,) is away from both edges."""
    return (line.arc > EDGE_SHARE) & (line.arc < 1.0 - EDGE_SHARE)


def _logarithmic(axes: Axes, values: Reals, *, least: float) -> None:
    """Scale the axis linearly where most of the values are, at least up to `least`, and logarithmically beyond."""
    median = float(np.median(np.sqrt(values * values), axis=None)) if len(values) else 1.0
    threshold = 10.0 ** np.ceil(np.log10(max(2.0 * median, least, 1e-3)))
    axes.set_yscale("symlog", linthresh=threshold, linscale=1.5)
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -threshold), max(high, threshold))


def _limited(axes: Axes, values: Sequence[Reals]) -> None:
    """Set limits that hold the values and zero, with a margin."""
    low, high = min(0.0, *(float(each.min()) for each in values)), max(0.0, *(float(each.max()) for each in values))
    margin = 0.08 * (high - low) or 1.0
    axes.set_ylim(low - margin, high + margin)


def _table(axes: Axes, by_span: Mapping[float, Smoothness], ends: tuple[str, str]) -> None:
    """Write a table of the largest jumps at joints, as fractions of the largest value on the line."""
    axes.set_axis_off()
    axes.set_title("Jumps at joints, of the largest value")
    place: dict[str, Any] = {"transform": axes.transAxes, "va": "top", "fontsize": 9.5}
    columns = (0.36, 0.70)
    for x, name in zip(columns, ("curvature", "its slope"), strict=True):
        axes.text(x, 0.97, name, color=INK, fontweight="bold", **place)
    rows = [(v, line) for v, each in by_span.items() for line in each.lines]
    step = min(0.92 / (len(rows) + 1), 0.1)
    for index, (v, line) in enumerate(rows):
        height = 0.97 - step * (index + 1)
        name = line.name if len(by_span) == 1 else f"{span_name(v, ends)}, {line.name}"
        axes.text(0.0, height, name, color=span_colour(v), **place)
        for x, smooth, jump in zip(columns, line.continuous, (line.curvature_jump, line.slope_jump), strict=True):
            axes.text(x, height, "continuous" if smooth else percent(jump) if jump else "with it", color=INK, **place)


def percent(share: float) -> str:
    """A fraction in percent, to two digits."""
    value = 100.0 * share
    return f"{value:.0f} %" if value >= 10.0 else f"{value:.2g} %" if value >= 1e-3 else f"{value:.0e} %"
