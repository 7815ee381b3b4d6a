"""Laws of evolution along the span and thickness laws along the chord, with their control points or stations."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import SubFigure
from matplotlib.ticker import MaxNLocator

from bladewright.designs import Design
from bladewright.section.laws import Span, law_points, overshoots_of, places_of, stations_of
from bladewright.views.distributions import CAMBER_LABEL, sides_legend
from bladewright.views.laws import Panel, constant_rows, constants_of, panels_of
from bladewright.views.style import (
    CONTROL_POINTS,
    LOWER,
    RED,
    SERIES,
    UPPER,
    Line,
    draw_lines,
    label_axes,
    legend_below,
    span_colour,
)
from bladewright.views.text_table import draw_text_table, text_width

if TYPE_CHECKING:
    from bladewright.section.section import Section

FEW_LAWS = 6
"""Most laws of a panel of width 1: more need a wider legend."""
MANY_POINTS = 10
"""Control points or stations along the span from which on their marks are small."""
TABLE_ROWS = 18
"""Most rows of a table of constants: what the height of a strip has room for."""
FULL_STRIP, LEAST_STRIP = 7.0, 4.5
"""Widths of a strip of panels, in panels: the most that still have room for their legends, and those that a strip of
fewer is divided into, so that a lone panel is not stretched."""
LEGEND_WIDTH = 145.0
"""Width of the legend of a panel of width 1 [points]: that of the narrowest, without the names of its axes."""
HANDLE, BETWEEN = 24.0, 12.0
"""Width of a line beside its name in a legend, and of the gap between its columns [points]."""
PANEL_HEIGHT, LEGEND_LINE, TABLE_LINE = 3.8, 0.17, 0.21
"""Heights of a panel, of a line of its legend and of a row of a table [inches]."""
ONE_LINE = 28
"""Most letters of a name in a legend that is not broken."""
SAME = 1e-9
"""Distance of two laws, of the range of their panel, up to which they are one line."""


class Chart(NamedTuple):
    """A panel of a strip."""

    width: float
    """in panels of laws"""
    height: float
    """with title and legend [inches]"""
    draw: Callable[[Axes], None]


def law_charts(design: Any, sections: Sequence["Section"], ends: tuple[str, str]) -> list[Chart]:
    """What a sheet shows of a design's laws.

    Those that vary along the span, the thickness along the chord of these sections in families that give it, and the
    constants as text.
    """
    charts = [_law_chart(panel) for panel in panels_of(design)]
    if design.thickness_laws:
        draw = partial(draw_thickness_laws, design=design, sections=sections, ends=ends)
        charts.append(Chart(1.6, PANEL_HEIGHT + 2 * LEGEND_LINE, draw))
    constants = constants_of(design)
    rows = constant_rows(constants) if any(not each.default for each in constants) else []
    for start in range(0, len(rows), TABLE_ROWS):
        piece = rows[start : start + TABLE_ROWS]
        charts.append(Chart(1.6, 0.7 + TABLE_LINE * len(piece), partial(draw_constants, rows=piece)))
    return charts


def _law_chart(panel: Panel) -> Chart:
    """The chart of a panel, wider and higher for more laws."""
    names = [_joined(names) for names in _alike(panel)]
    width = 1.0 if len(names) <= FEW_LAWS else 2.0
    columns = max(1, int((LEGEND_WIDTH * width + BETWEEN) / (max(map(text_width, names)) + HANDLE + BETWEEN)))
    lines = -(-len(names) // columns) + sum(name.count("\n") for name in names)
    return Chart(width, PANEL_HEIGHT + LEGEND_LINE * lines, partial(draw_laws, panel=panel, columns=columns))


def in_strips(charts: Sequence[Chart]) -> list[list[Chart]]:
    """The charts in strips that are about as full as each other."""
    if not charts:
        return []
    ends = np.cumsum([chart.width for chart in charts])
    count = int(np.ceil(ends[-1] / FULL_STRIP))
    middles = ends - 0.5 * np.array([chart.width for chart in charts])
    own = np.minimum((count * middles / ends[-1]).astype(int), count - 1)
    strips = [[chart for chart, index in zip(charts, own, strict=True) if index == strip] for strip in range(count)]
    return [strip for strip in strips if strip]


def strip_height(charts: Sequence[Chart]) -> float:
    """The height of a strip [inches]."""
    return max(chart.height for chart in charts)


def draw_strip(strip: SubFigure, charts: Sequence[Chart]) -> None:
    """Draw charts beside each other; few of them leave a part of the strip free."""
    widths = [chart.width for chart in charts]
    rest = LEAST_STRIP - sum(widths)
    free = [rest] if rest > 0.0 else []
    places = strip.subplots(1, len(widths + free), width_ratios=widths + free, squeeze=False)[0]
    for place, chart in zip(places, charts, strict=False):
        chart.draw(place)
    for place in places[len(charts) :]:
        place.remove()


def draw_thickness_laws(axes: Axes, design: Design, sections: Sequence["Section"], ends: tuple[str, str]) -> None:
    """Draw the half-thickness laws along the chord at these sections, in percent of the design's reference length."""
    u, lines = np.linspace(0.0, 1.0, 101), list[Line]()
    for section in sections:
        span = Span(np.array([section.span]))
        colour = span_colour(section.span)
        for name, style, marker in (("upper", UPPER, "o"), ("lower", LOWER, "s")):
            laws = design.thickness_laws[name]
            points = np.array([np.real(span.values(law))[0] for law in laws])
            curve = 100.0 * np.real(span.chordwise(laws, u))[0]
            lines.append((u, curve, {"color": colour, "linestyle": style}))
            axes.plot(places_of(tuple(points)), 100.0 * points, color=colour, marker=marker, **CONTROL_POINTS)
    draw_lines(axes, lines)
    axes.set_ylim(bottom=0.0)
    axes.set_xlim(-0.03, 1.03)
    label_axes(axes, "Half thickness along the chord", CAMBER_LABEL, f"half thickness [% of {design.reference_length}]")
    sides_legend(axes, [section.span for section in sections], ends)


def draw_laws(axes: Axes, panel: Panel, columns: int = 1) -> None:
    """Draw laws with the span upwards, those that coincide as one line with all their names.

    Hollow marks are control points; full ones are stations, on the curve, and where it overshoots them it is marked.
    """
    v = np.linspace(0.0, 1.0, 101)
    span = Span(v)
    curves = {name: panel.factor * np.real(span.values(law)) for name, law in panel.laws.items()}
    lines = _alike(panel)
    places = list(dict.fromkeys(_place(names[0]) for names in lines))
    overshoots = []
    for names in lines:
        law, curve = panel.laws[names[0]], curves[names[0]]
        colour = _colour(places.index(_place(names[0])), len(places))
        style, marker = (LOWER, "s") if names[0].startswith("lower, ") else (UPPER, "o")
        axes.plot(curve, v, color=colour, linestyle=style, label=_joined(names))
        given = panel.factor * np.real(np.array(law_points(law)))
        marks = {**CONTROL_POINTS, "color": colour, "marker": marker}
        if stations_of(law) is not None:
            marks |= {"linestyle": "none", "markerfacecolor": colour, "markersize": 3.6}
        if len(given) > MANY_POINTS:
            marks["markersize"] = 2.0
        axes.plot(given, places_of(law), **marks)
        overshoots += list(overshoots_of(law, names[0]))
    if overshoots:
        places_over = np.array([(panel.factor * each.value, each.v) for each in overshoots])
        worst = panel.factor * max(each.amount for each in overshoots)
        label = f"overshoot, {worst:.2g} {panel.abscissa.partition('[')[2].rstrip(']')}"
        axes.plot(*places_over.T, color=RED, linestyle="none", marker="x", markersize=7.0, label=label)
    low, high = axes.get_xlim()
    if high - low < 1e-3 * max(abs(low), abs(high), 1e-9):
        axes.set_xlim(low - 1.0, high + 1.0)
    axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.set_ylim(-0.03, 1.03)
    label_axes(axes, panel.title, panel.abscissa, "span v [-]")
    legend_below(axes, columns, handlelength=1.8)


def _alike(panel: Panel) -> list[list[str]]:
    """The names of laws in groups of which each is one line."""
    span = Span(np.linspace(0.0, 1.0, 101))
    curves = {name: np.real(span.values(law)) for name, law in panel.laws.items()}
    values = np.array(list(curves.values()))
    close, groups = SAME * max(float(np.ptp(values)), SAME), list[list[str]]()
    for name, curve in curves.items():
        same = (group for group in groups if np.allclose(curves[group[0]], curve, rtol=0.0, atol=close))
        group = next(same, None)
        if group is None:
            groups.append([name])
        else:
            group.append(name)
    return groups


def _joined(names: Sequence[str]) -> str:
    """The name of a line that is several laws."""
    places = list(dict.fromkeys(map(_place, names)))
    if all(f"{side}, {place}" in names for place in places for side in ("upper", "lower")):
        names = [f"both sides, {place}" for place in places]
    whole = " = ".join(names)
    return whole if len(whole) <= ONE_LINE else " =\n".join(names)


def _place(name: str) -> str:
    """The name of a law without its side, by which it gets its colour."""
    return name.removeprefix("upper, ").removeprefix("lower, ")


def _colour(index: int, count: int) -> Any:
    """The colour of one of so many lines."""
    return SERIES[index] if count <= len(SERIES) else colormaps["turbo"](0.05 + 0.9 * index / (count - 1))


def draw_constants(axes: Axes, rows: Sequence[tuple[str, str, str]]) -> None:
    """Write what is the same all along the span."""
    axes.set_title("Constant along the span")
    draw_text_table(axes, rows, align="lrl")
