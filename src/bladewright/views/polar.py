"""Polars as pictures: lift, drag, moment and glide ratio, and pressure and friction around the airfoil."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.ticker import MaxNLocator

from bladewright.views.html import Rows, table
from bladewright.views.pages import Page, checked_path, with_fixed_layout, write_figure
from bladewright.views.style import INK, LOWER, SERIES, SHEET_DPI, SOFT, UPPER, drawing_style, label_axes

if TYPE_CHECKING:
    from bladewright.aerodynamics.polar import Polar
    from bladewright.aerodynamics.surface_flow import SurfaceFlow

CURVES = (
    ("Lift", "alpha", "cl", "angle of attack [deg]", "cl"),
    ("Drag", "cd", "cl", "cd", "cl"),
    ("Moment", "cl", "cm", "cl", "cm"),
    ("Lift over drag", "alpha", "lift_to_drag", "angle of attack [deg]", "cl / cd"),
)
"""The four panels: title, attributes of a polar, names of the axes."""
CHORD, PANEL = 6.3, 3.0
"""Length of the airfoil under the pressures, and height of both together [inches]."""
SHOWN_ANGLES = 3
"""Most angles of a polar whose pressure is drawn, if none are named."""


def polar_figure(polars: "Polar | Sequence[Polar]", angles: Sequence[float] | None = None) -> Figure:
    """The four curves of one polar or of several, and cp and cf at some of the angles of the first that has them.

    `angles` [deg] are those; where None its lowest, its highest and the one of the best lift over drag.
    """
    shown = cast("Sequence[Polar]", polars if isinstance(polars, list | tuple) else [polars])
    of = next((each for each in shown if any(each.flows)), None)
    flows = [] if of is None else [of.flow(angle) for angle in (_chosen(of) if angles is None else angles)]
    with drawing_style():
        figure = Page(figsize=(15.0, 8.2 if flows else 4.4), layout="constrained")
        figure.suptitle(_title(shown), x=0.01, ha="left", fontsize=13.0, fontweight="bold", parse_math=False)
        strips = np.atleast_1d(np.asarray(figure.subfigures(2 if flows else 1, 1)))
        for axes, (title, x, y, *names) in zip(strips[0].subplots(1, len(CURVES)), CURVES, strict=True):
            _curve(axes, shown, x, y)
            label_axes(axes, title, *names)
        if len(shown) > 1:
            strips[0].legend(*strips[0].axes[0].get_legend_handles_labels(), loc="outside lower left", ncols=4)
        if flows and of is not None:
            _draw_flows(strips[1], of, flows)
        return with_fixed_layout(figure)


def draw_polar(polars: "Polar | Sequence[Polar]", path: str | Path, angles: Sequence[float] | None = None) -> None:
    """Draw `polar_figure` as PNG, SVG or PDF, by the ending of `path`; raises FileError where it cannot be written."""
    checked_path(path)
    figure = polar_figure(polars, angles)
    with drawing_style():
        write_figure(figure, path, SHEET_DPI)


def polar_rows(polar: "Polar") -> Rows:
    """Conditions, the best lift over drag, the most lift, and remarks."""
    rows = [
        ("solver", polar.solver),
        ("Reynolds number", f"{polar.reynolds:.6g}"),
        ("Mach number", f"{polar.conditions.mach:.4g}"),
        ("angles", f"{len(polar.alpha)}, {int(np.count_nonzero(polar.converged))} converged"),
    ]
    if np.any(polar.converged):
        best, most = int(np.nanargmax(polar.lift_to_drag)), int(np.nanargmax(polar.cl))
        rows += [
            ("best cl / cd", f"{polar.lift_to_drag[best]:.4g} at {polar.alpha[best]:.4g}°, cl {polar.cl[best]:.4g}"),
            ("most cl", f"{polar.cl[most]:.4g} at {polar.alpha[most]:.4g}°"),
        ]
    return [*rows, *(("", text) for text in (*polar.failures, *polar.remarks))]


def polar_table(polar: "Polar") -> str:
    """The same as HTML."""
    return table(polar_rows(polar))


def _title(polars: Sequence["Polar"]) -> str:
    first = polars[0]
    same = all((each.reynolds, each.conditions.mach) == (first.reynolds, first.conditions.mach) for each in polars)
    flow = f", Reynolds number {first.reynolds:.4g}, Mach number {first.conditions.mach:.3g}" if same else ""
    names = dict.fromkeys(each.name for each in polars)
    solvers = f", {first.solver}" if len({each.solver for each in polars}) == 1 else ""
    return f"{', '.join(names)}{flow}{solvers}"


def _label(polar: "Polar", polars: Sequence["Polar"]) -> str:
    """What tells a polar from the others."""
    told = {
        polar.name: {each.name for each in polars},
        polar.solver: {each.solver for each in polars},
        f"Re {polar.reynolds:.4g}": {f"Re {each.reynolds:.4g}" for each in polars},
        f"Mach {polar.conditions.mach:.3g}": {f"Mach {each.conditions.mach:.3g}" for each in polars},
    }
    return ", ".join(words for words, others in told.items() if len(others) > 1) or polar.name


def _curve(axes: Axes, polars: Sequence["Polar"], x: str, y: str) -> None:
    for index, polar in enumerate(polars):
        # a gap where the solver did not converge, a mark where a curve is a single point
        style: dict[str, Any] = {"marker": "o", "markersize": 2.6, "linewidth": 1.2}
        axes.plot(
            getattr(polar, x),
            getattr(polar, y),
            color=SERIES[index % len(SERIES)],
            label=_label(polar, polars),
            **style,
        )
    axes.xaxis.set_major_locator(MaxNLocator(6))


def _chosen(polar: "Polar") -> list[float]:
    """Angles whose pressure is drawn: the lowest, that of the best lift over drag, and the highest."""
    with_flow = [i for i, flow in enumerate(polar.flows) if flow is not None]
    best = max(with_flow, key=lambda i: float(polar.lift_to_drag[i]))
    places = sorted({min(with_flow, key=lambda i: float(polar.alpha[i])), best, max(with_flow)})
    return [float(polar.alpha[i]) for i in places[:SHOWN_ANGLES]]


def _draw_flows(strip: SubFigure, polar: "Polar", flows: Sequence["SurfaceFlow"]) -> None:
    """Draw cp over the airfoil, upwards where it is low, and cf."""
    outline = np.concatenate([polar.airfoil.points, polar.airfoil.points[:1]])
    height = 0.2 + CHORD * float(np.ptp(outline[:, 1]))
    grid = strip.add_gridspec(2, 2, height_ratios=[max(PANEL - height, 0.5 * PANEL), height])
    pressure, friction = strip.add_subplot(grid[0, 0]), strip.add_subplot(grid[:, 1])
    for index, flow in enumerate(flows):
        colour = SERIES[index % len(SERIES)]
        for part, style in ((slice(None, flow.stagnation + 1), UPPER), (slice(flow.stagnation, None), LOWER)):
            label = f"{flow.alpha:.4g}°" if style == UPPER else None
            pressure.plot(flow.x[part], flow.cp[part], color=colour, linestyle=style, label=label)
            friction.plot(flow.x[part], flow.cf[part], color=colour, linestyle=style, label=label)
    pressure.invert_yaxis()
    pressure.tick_params(labelbottom=False)
    for axes in (pressure, friction):
        axes.axhline(0.0, color=SOFT, linewidth=0.8)
    label_axes(pressure, f"Pressure, {polar.solver}", "", "cp (upwards where low)")
    label_axes(friction, "Skin friction", "x / chord", "cf")
    pressure.legend(title="upper side whole, lower dashed", loc="upper right")
    below = strip.add_subplot(grid[1, 0])
    below.plot(outline[:, 0], outline[:, 1], color=INK, linewidth=1.0)
    below.set_xlim(pressure.get_xlim())
    below.margins(y=0.0)
    below.set_aspect("equal", adjustable="datalim")
    below.set_yticks([])
    below.spines["left"].set_visible(False)
    below.set_xlabel("x / chord")
