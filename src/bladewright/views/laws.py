"""Laws of evolution along the span and thickness laws along the chord, with their control points."""

from collections.abc import Callable, Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any, NamedTuple, get_args, get_origin, get_type_hints

import numpy as np
from matplotlib.axes import Axes

from bladewright.designs import Design, Law, Part, Stations
from bladewright.section.laws import Span, law_points, places_of
from bladewright.views.distributions import CAMBER_LABEL, sides_legend
from bladewright.views.style import (
    CONTROL_POINTS,
    LOWER,
    SERIES,
    UPPER,
    label_axes,
    legend_below,
    span_colour,
)

if TYPE_CHECKING:
    from bladewright.section.section import Section

MAX_CONTROL_POINTS = 16
"""Most control points along the chord of a row of laws that gets a panel. A legend of more covers other panels; such
rows are the points of a given profile, which say nothing as laws."""


def draw_thickness_laws(axes: Axes, design: Design, sections: Sequence["Section"], ends: tuple[str, str]) -> None:
    """Draw the half-thickness laws along the chord at these sections, in percent of the design's reference length."""
    u = np.linspace(0.0, 1.0, 101)
    for section in sections:
        span = Span(np.array([section.span]))
        colour = span_colour(section.span)
        for name, style, marker in (("upper", UPPER, "o"), ("lower", LOWER, "s")):
            laws = design.thickness_laws[name]
            points = np.array([np.real(span.values(law))[0] for law in laws])
            axes.plot(u, 100.0 * np.real(span.chordwise(laws, u))[0], color=colour, linestyle=style)
            axes.plot(places_of(tuple(points)), 100.0 * points, color=colour, marker=marker, **CONTROL_POINTS)
    axes.set_ylim(bottom=0.0)
    axes.set_xlim(-0.03, 1.03)
    label_axes(axes, "Half thickness along the chord", CAMBER_LABEL, f"half thickness [% of {design.reference_length}]")
    sides_legend(axes, [section.span for section in sections], ends)


class Panel(NamedTuple):
    """Laws of one unit in one panel."""

    title: str
    abscissa: str
    factor: float
    """what values are multiplied by to be in the unit of the abscissa"""
    laws: dict[str, Law]
    """laws by their name in the legend"""


class _Kind(NamedTuple):
    """What the laws of a panel measure."""

    title: str
    abscissa: str
    factor: float
    holds: Callable[[str, str], bool]
    """whether a law of this name and unit belongs here"""


_KINDS = (
    _Kind("Angles", "angle [deg]", 1.0, lambda _, unit: unit == "deg"),
    _Kind("Position of the leading edge", "y [{unit}]", 1.0, lambda name, _: name == "leading_edge_y"),
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


class _Row(NamedTuple):
    """Control points along the chord, each a law along the span."""

    name: str
    unit: str
    laws: tuple[Law, ...]


def panels_of(design: Any) -> list[Panel]:
    """Every law along the span of a blade's design, grouped by what it measures."""
    single, rows = _laws(design)
    words = {"unit": design.length_unit, "length": design.reference_length}
    panels: dict[str, Panel] = {}

    def add(kind: _Kind, title: str, name: str, law: Law) -> None:
        empty = Panel(title, kind.abscissa.format(**words), kind.factor, {})
        panels.setdefault(title, empty).laws[name.replace("_", " ")] = law

    for name, unit, law in single:
        kind = next(each for each in (*_KINDS, _REST) if each.holds(name, unit))
        add(kind, kind.title, name, law)
    for row in rows:
        if len(row.laws) > MAX_CONTROL_POINTS:
            continue
        stem, _, side = row.name.rpartition("_")
        if side in ("upper", "lower") and stem in ("thickness", "weights"):
            kind = next(each for each in _KINDS if each.holds(row.name, row.unit))
            for i, law in enumerate(row.laws):
                add(kind, kind.title, f"{side}_{i + 1}", law)
            continue
        title = row.name.replace("_", " ").capitalize()
        kind = _Kind(title, "control point [deg]" if row.unit == "deg" else "control point [-]", 1.0, _REST.holds)
        for i, law in enumerate(row.laws):
            add(kind, title, str(i + 1), law)
    order = [kind.title for kind in (*_KINDS[:-2], _REST)]
    return sorted(panels.values(), key=lambda panel: order.index(panel.title) if panel.title in order else len(order))


def _laws(part: Part) -> tuple[list[tuple[str, str, Law]], list[_Row]]:
    """Names, units and values of the laws, and the rows of laws, of a design and of the parts in it."""
    hints, single, rows = get_type_hints(type(part)), list[tuple[str, str, Law]](), list[_Row]()
    for each in fields(part):
        value, unit, hint = getattr(part, each.name), each.metadata.get("unit"), hints[each.name]
        if unit is None and isinstance(value, Part):
            inner_single, inner_rows = _laws(value)
            single += inner_single
            rows += inner_rows
        elif unit is None or value is None or value == ():
            continue
        elif get_origin(hint) is tuple and Stations in get_args(get_args(hint)[0]):
            rows.append(_Row(each.name, unit, value))
        elif Stations in get_args(hint):
            single.append((each.name, unit, value))
    return single, rows


def draw_laws(axes: Axes, panel: Panel) -> None:
    """Draw laws with the span upwards; hollow marks are control points, and stations, on the curve."""
    v = np.linspace(0.0, 1.0, 101)
    span = Span(v)
    for index, (name, law) in enumerate(panel.laws.items()):
        sided = name.startswith(("upper ", "lower "))
        number = name.rpartition(" ")[2] if sided else ""
        colour = SERIES[(int(number) - 1 if sided else index) % len(SERIES)]
        style, marker = (LOWER, "s") if "lower" in name else (UPPER, "o")
        axes.plot(panel.factor * np.real(span.values(law)), v, color=colour, linestyle=style, label=name)
        axes.plot(
            panel.factor * np.array(law_points(law), dtype=float),
            places_of(law),
            color=colour,
            marker=marker,
            **CONTROL_POINTS,
        )
    low, high = axes.get_xlim()
    if high - low < 1e-3 * max(abs(low), abs(high), 1e-9):
        axes.set_xlim(low - 1.0, high + 1.0)
    axes.set_ylim(-0.03, 1.03)
    label_axes(axes, panel.title, panel.abscissa, "span v [-]")
    many = len(panel.laws) > 8
    # Four rows at most: more would push the legend of a low panel over its axis.
    legend_below(axes, -(-len(panel.laws) // 4), handlelength=0.9 if many else 2.0, columnspacing=0.6 if many else 1.2)
