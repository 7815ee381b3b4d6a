"""Laws of evolution along the span and thickness laws along the chord, with their control points or stations."""

from collections.abc import Callable, Sequence
from dataclasses import MISSING, fields
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple, get_args, get_origin, get_type_hints

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import SubFigure
from matplotlib.ticker import MaxNLocator

from bladewright.designs import Design, Law, Part, Stations
from bladewright.section.laws import Span, law_points, overshoots_of, places_of, stations_of
from bladewright.views.distributions import CAMBER_LABEL, sides_legend
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

MAX_CONTROL_POINTS = 16
"""Most control points along the chord of a row of laws that gets a panel. A legend of more covers other panels; such
rows are the points of a given profile, which say nothing as laws."""
FEW_LAWS = 6
"""Most laws of a panel of width 1: more need a wider legend."""
MANY_POINTS = 10
"""Control points or stations along the span from which on their marks are small."""
TABLE_ROWS = 18
"""Most rows of a table of constants: what the height of a strip has room for."""
VALUES_ACROSS = 5
"""Values of a row of constants on a line."""
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


class Panel(NamedTuple):
    """Laws of one unit in one panel."""

    title: str
    abscissa: str
    factor: float
    """what values are multiplied by to be in the unit of the abscissa"""
    laws: dict[str, Law]
    """laws by their name in the legend"""


class Constant(NamedTuple):
    """A number, or a row of numbers along the chord, that is the same all along the span."""

    name: str
    values: tuple[float, ...]
    """in the unit"""
    unit: str
    default: bool
    """whether the family gives it where a design does not"""


class Chart(NamedTuple):
    """A panel of a strip."""

    width: float
    """in panels of laws"""
    height: float
    """with title and legend [inches]"""
    draw: Callable[[Axes], None]


class _Kind(NamedTuple):
    """What the laws of a panel measure."""

    title: str
    abscissa: str
    factor: float
    holds: Callable[[str, str], bool]
    """whether a law of this name and unit belongs here"""


_KINDS = (
    _Kind("Angles", "angle [deg]", 1.0, lambda _, unit: unit == "deg"),
    _Kind("Leading edge position", "y [{unit}]", 1.0, lambda name, _: name == "leading_edge_y"),
    _Kind("Lengths", "length [{unit}]", 1.0, lambda _, unit: unit == "length"),
    _Kind("Camber tangents", "length [% of extent]", 100.0, lambda name, _: name.startswith("tangent_")),
    _Kind("Tangents", "length [% of chord]", 100.0, lambda name, _: "_tangent_" in name),
    _Kind("Edge radii", "radius [% of {length}]", 100.0, lambda name, _: name.endswith("_edge_radius")),
    _Kind("Half thickness", "control point [% of {length}]", 100.0, lambda name, _: name.startswith("thickness_")),
    _Kind("Thickness", "thickness [% of chord]", 100.0, lambda name, _: name.endswith("thickness")),
    _Kind("Weights", "control point [-]", 1.0, lambda name, _: name.startswith("weights_")),
    _Kind("Places", "place [% of chord]", 100.0, lambda name, _: name.endswith(("_at", "_position"))),
)
"""Kinds of laws; the first that a law belongs to is taken."""
_REST = _Kind("Further parameters", "value [-]", 1.0, lambda *_: True)
"""The kind of a law that belongs to no other."""


class _Single(NamedTuple):
    """A law along the span."""

    name: str
    unit: str
    law: Law
    default: bool


class _Row(NamedTuple):
    """Control points along the chord, each a law along the span."""

    name: str
    unit: str
    laws: tuple[Law, ...]
    places: tuple[float, ...]
    """from the leading edge, 0, to the trailing edge, 1; none where the row does not run along the chord"""


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


def panels_of(design: Any) -> list[Panel]:
    """The laws of a blade's design that vary along the span, grouped by what they measure."""
    single, rows = _laws(design)
    panels: dict[str, Panel] = {}

    def add(kind: _Kind, title: str, name: str, law: Law) -> None:
        panel = panels.setdefault(title, Panel(title, _abscissa(kind, design), kind.factor, {}))
        while name in panel.laws:
            name += ", again"
        panel.laws[name] = law

    for each in single:
        if _varies(each.law):
            kind = _kind_of(each.name, each.unit)
            add(kind, kind.title, each.name.replace("_", " "), each.law)
    for row in rows:
        if len(row.laws) > MAX_CONTROL_POINTS or not any(_varies(law) for law in row.laws):
            continue
        kind, side = _kind_of_row(row)
        for name, law in zip(place_names(row.places, len(row.laws)), row.laws, strict=True):
            add(kind, kind.title, f"{side}, {name}" if side else name, law)
    order = [kind.title for kind in (*_KINDS[:-2], _REST)]
    return sorted(panels.values(), key=lambda panel: order.index(panel.title) if panel.title in order else len(order))


def constants_of(design: Any) -> list[Constant]:
    """The laws of a blade's design that are the same all along the span, and the rows of such laws."""
    single, rows = _laws(design)
    found = []
    for each in single:
        if not _varies(each.law):
            kind = _kind_of(each.name, each.unit)
            value = kind.factor * float(law_points(each.law)[0])
            found.append(Constant(each.name.replace("_", " "), (value,), _unit_of(kind, design), each.default))
    for row in rows:
        if len(row.laws) <= MAX_CONTROL_POINTS and not any(_varies(law) for law in row.laws):
            kind, _ = _kind_of_row(row)
            values = tuple(kind.factor * float(law_points(law)[0]) for law in row.laws)
            found.append(Constant(row.name.replace("_", " "), values, _unit_of(kind, design), default=False))
    return found


def constant_rows(constants: Sequence[Constant]) -> list[tuple[str, str, str]]:
    """Name, value and unit of each; the values of a row stand below each other in lines of a few."""
    rows = []
    for name, values, unit, default in constants:
        figures = [f"{value + 0.0:.4g}" for value in values]
        lines = ["  ".join(figures[start : start + VALUES_ACROSS]) for start in range(0, len(figures), VALUES_ACROSS)]
        rows.append((name, lines[0], f"{unit}, default" if default else unit))
        rows += [("", line, "") for line in lines[1:]]
    return rows


def draw_constants(axes: Axes, rows: Sequence[tuple[str, str, str]]) -> None:
    """Write what is the same all along the span."""
    axes.set_title("Constant along the span")
    draw_text_table(axes, rows, align="lrl")


def place_names(places: Sequence[float], count: int) -> list[str]:
    """What control points along the chord are called: by their places, or by their numbers where they have none."""
    if not places:
        return [f"point {i + 1}" for i in range(count)]
    words = {0.0: "leading edge", 1.0: "trailing edge"}
    return [words.get(round(place, 9), f"at {100.0 * place:.3g} %") for place in places]


def _kind_of(name: str, unit: str) -> _Kind:
    return next(each for each in (*_KINDS, _REST) if each.holds(name, unit))


def _kind_of_row(row: _Row) -> tuple[_Kind, str]:
    """The kind of a row, and the side that it belongs to where both sides share a panel."""
    stem, _, side = row.name.rpartition("_")
    if side in ("upper", "lower") and stem in ("thickness", "weights"):
        return _kind_of(row.name, row.unit), side
    title = row.name.replace("_", " ").capitalize()
    return _Kind(title, "control point [deg]" if row.unit == "deg" else "control point [-]", 1.0, _REST.holds), ""


def _abscissa(kind: _Kind, design: Any) -> str:
    return kind.abscissa.format(unit=design.length_unit, length=design.reference_length)


def _unit_of(kind: _Kind, design: Any) -> str:
    return _abscissa(kind, design).partition("[")[2].rstrip("]")


def _varies(law: Law) -> bool:
    """Whether a law is not the same all along the span."""
    return len(set(law_points(law))) > 1


def _laws(part: Part) -> tuple[list[_Single], list[_Row]]:
    """The laws and the rows of laws of a design and of the parts in it."""
    hints, single, rows = get_type_hints(type(part)), list[_Single](), list[_Row]()
    for each in fields(part):
        value, unit, hint = getattr(part, each.name), each.metadata.get("unit"), hints[each.name]
        if unit is None and isinstance(value, Part):
            inner_single, inner_rows = _laws(value)
            single += inner_single
            rows += inner_rows
        elif unit is None or value is None or value == ():
            continue
        elif get_origin(hint) is tuple and Stations in get_args(get_args(hint)[0]):
            rows.append(_Row(each.name, unit, value, _places(part, each.name, len(value))))
        elif Stations in get_args(hint):
            default = each.default is not MISSING and value == (each.default or 0.0)
            single.append(_Single(each.name, unit, value, default))
    return single, rows


def _places(part: Part, row: str, count: int) -> tuple[float, ...]:
    """Where the control points of a row stand along the chord."""
    if row.endswith("_places"):
        return ()
    given = part.control_places(row)
    return tuple(places_of((0.0,) * count).tolist() if given is None else given)


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
