"""Laws of evolution along the span and thickness laws along the chord, with their control points."""

from collections.abc import Callable, Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any, NamedTuple, get_args, get_type_hints

import numpy as np
from matplotlib.axes import Axes

from bladewright.designs import ChordwiseLaw, Law, Part
from bladewright.nurbs.basis import Reals, greville, uniform_knots
from bladewright.section.laws import DEGREE, Span
from bladewright.views.distributions import sides_legend
from bladewright.views.style import (
    LOWER,
    MILLIMETRES,
    SERIES,
    UPPER,
    WALLS,
    label_axes,
    legend_below,
    span_colour,
    span_name,
)

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
    label_axes(axes, "Thickness as built, largest in % of chord", CHORD, "thickness across the camber [mm]")
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
    label_axes(axes, "Half thickness along the chord", CHORD, f"half thickness [% of {length_name}]")
    sides_legend(axes, [section.span for section in sections], getattr(design, "ends", WALLS))


MAX_CONTROL_POINTS = 16
"""control points along the chord above which a row of laws has no panel: the points of a given profile"""


class Panel(NamedTuple):
    """Laws of one unit that share a panel."""

    title: str
    abscissa: str
    factor: float
    laws: dict[str, Law]
    """by the name in the legend"""


class _Kind(NamedTuple):
    """What laws measure that share a panel."""

    title: str
    abscissa: str
    factor: float
    holds: Callable[[str, str], bool]
    """whether a law by its name and unit belongs here"""


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
"""the first that fits is taken"""
_REST = _Kind("Further parameters", "value [-]", 1.0, lambda *_: True)


class _Row(NamedTuple):
    """Control points along the chord, each a law."""

    name: str
    unit: str
    laws: tuple[Law, ...]


def panels_of(design: Any) -> list[Panel]:
    """Every law along the span of a blade's design, grouped by what it measures."""
    single, rows = _laws(design)
    words = {"unit": design.length_unit, "length": "chord" if hasattr(design, "section") else "length"}
    found: dict[str, Panel] = {}

    def put(kind: _Kind, title: str, name: str, law: Law) -> None:
        empty = Panel(title, kind.abscissa.format(**words), kind.factor, {})
        found.setdefault(title, empty).laws[name.replace("_", " ")] = law

    for name, unit, law in single:
        kind = next(each for each in (*_KINDS, _REST) if each.holds(name, unit))
        put(kind, kind.title, name, law)
    for row in rows:
        if len(row.laws) > MAX_CONTROL_POINTS:
            continue
        stem, _, side = row.name.rpartition("_")
        if side in ("upper", "lower") and stem in ("thickness", "weights"):
            kind = next(each for each in _KINDS if each.holds(row.name, row.unit))
            for i, law in enumerate(row.laws):
                put(kind, kind.title, f"{side}_{i + 1}", law)
            continue
        title = row.name.replace("_", " ").capitalize()
        kind = _Kind(title, "control point [deg]" if row.unit == "deg" else "control point [-]", 1.0, _REST.holds)
        for i, law in enumerate(row.laws):
            put(kind, title, str(i + 1), law)
    order = [kind.title for kind in (*_KINDS[:-2], _REST)]
    return sorted(found.values(), key=lambda panel: order.index(panel.title) if panel.title in order else len(order))


def _laws(part: Part) -> tuple[list[tuple[str, str, Law]], list[_Row]]:
    """Names, units and values of all laws, and the rows of laws, of a design and of the parts in it."""
    hints, single, rows = get_type_hints(type(part)), list[tuple[str, str, Law]](), list[_Row]()
    for each in fields(part):
        value, unit = getattr(part, each.name), each.metadata.get("unit")
        if isinstance(value, Part):
            deeper = _laws(value)
            single += deeper[0]
            rows += deeper[1]
        elif unit is None or value is None or value == ():
            continue
        elif hints[each.name] == ChordwiseLaw:
            rows.append(_Row(each.name, unit, value))
        elif tuple[float, ...] in get_args(hints[each.name]):
            single.append((each.name, unit, value))
    return single, rows


def draw_laws(axes: Axes, panel: Panel) -> None:
    """Draws laws with the span upwards; hollow marks are control points."""
    v = np.linspace(0.0, 1.0, 101)
    span = Span(v)
    for index, (name, law) in enumerate(panel.laws.items()):
        sided = name.startswith(("upper ", "lower "))
        number = name.rpartition(" ")[2] if sided else ""
        colour = SERIES[(int(number) - 1 if sided else index) % len(SERIES)]
        style, marker = (LOWER, "s") if "lower" in name else (UPPER, "o")
        points = np.array(law if isinstance(law, tuple) else (law,), dtype=float)
        axes.plot(panel.factor * np.real(span.values(law)), v, color=colour, linestyle=style, label=name)
        axes.plot(
            panel.factor * points,
            control_places(len(points)),
            color=colour,
            linestyle=":",
            linewidth=0.7,
            marker=marker,
            markersize=4.5,
            markerfacecolor="white",
        )
    low, high = axes.get_xlim()
    if high - low < 1e-3 * max(abs(low), abs(high), 1e-9):
        axes.set_xlim(low - 1.0, high + 1.0)
    axes.set_ylim(-0.03, 1.03)
    label_axes(axes, panel.title, panel.abscissa, "span v [-]")
    many = len(panel.laws) > 8
    # at most four rows: more would push the legend of a low panel over its axis
    legend_below(axes, -(-len(panel.laws) // 4), handlelength=0.9 if many else 2.0, columnspacing=0.6 if many else 1.2)
