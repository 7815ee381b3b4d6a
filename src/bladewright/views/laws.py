"""Laws of evolution along the span, with their control points."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes

from bladewright.designs import Law, unit_of
from bladewright.section.laws import Span
from bladewright.views.style import LOWER, SERIES, UPPER, legend_below, titled
from bladewright.views.thickness import control_places


class Panel(NamedTuple):
    """Laws of one unit that share a panel."""

    title: str
    abscissa: str
    factor: float
    laws: dict[str, Law]
    """by the name in the legend"""


def panels_of(design: Any) -> list[Panel]:
    """Every law along the span of a blade's design, grouped by what it measures."""

    def of(*names: str) -> dict[str, Law]:
        return {name.replace("_", " "): getattr(design, name) for name in names}

    start = "leading_edge_theta" if design.arrangement == "annular" else "leading_edge_y"
    angles = ["stagger", "metal_angle_in", "metal_angle_out"]
    panels = [
        Panel("Angles", "angle [deg]", 1.0, of(*angles, *([start] if unit_of(design, start) == "deg" else []))),
        Panel("Camber tangents", "length [% of extent]", 100.0, of("tangent_in", "tangent_out")),
        Panel("Edge radii", "radius [% of length]", 100.0, of("leading_edge_radius", "trailing_edge_radius")),
        Panel("Half thickness", "control point [% of length]", 100.0, _chordwise(design, "thickness")),
    ]
    if design.arrangement == "linear":
        panels.insert(1, Panel("Leading edge", f"y [{design.length_unit}]", 1.0, of(start)))
    weights = _chordwise(design, "weights")
    return [*panels, Panel("Weights", "control point [-]", 1.0, weights)] if weights else panels


def draw_laws(axes: Axes, panel: Panel) -> None:
    """Draws laws with the span upwards; hollow marks are control points."""
    v = np.linspace(0.0, 1.0, 101)
    span = Span(v)
    for index, (name, law) in enumerate(panel.laws.items()):
        sided = "upper" in name or "lower" in name
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
    titled(axes, panel.title, panel.abscissa, "span v [-]")
    many = len(panel.laws) > 8
    # at most four rows: more would push the legend of a low panel over its axis
    legend_below(axes, -(-len(panel.laws) // 4), handlelength=0.9 if many else 2.0, columnspacing=0.6 if many else 1.2)


def _chordwise(design: Any, what: str) -> dict[str, Law]:
    return {
        f"{side} {index + 1}": law
        for side in ("upper", "lower")
        for index, law in enumerate(getattr(design, f"{what}_{side}"))
    }
