"""The meridional channel: walls and edges with the points that give them, stream lines and the blade's outline."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes

from bladewright.nurbs.basis import Reals
from bladewright.views.sections import along_curve
from bladewright.views.style import BLUE, GREEN, INK, MILLIMETRES, ORANGE, RED, SOFT, legend_below, titled

if TYPE_CHECKING:
    from bladewright.blade.blade import Blade
    from bladewright.blade.plan import Plan, PlanLine

GIVEN = "#7a5ea8"
CURVES = {"hub": BLUE, "shroud": ORANGE, "leading_edge": GREEN, "trailing_edge": RED}


def draw_meridional(axes: Axes, blade: "Blade") -> None:
    """Draws the plan in the (x, r) plane, or (x, z) of a cascade, equal lengths equal on both axes."""
    exact, plan = blade.exact, blade.exact.plan
    noses = blade_outline(blade) * MILLIMETRES
    axes.fill(*noses.T, color=INK, alpha=0.08, linewidth=0.0, label="blade")
    axes.plot(*noses.T, color=INK, linewidth=0.7)
    for index, line in enumerate(plan.stream_lines):
        axes.plot(*(line * MILLIMETRES).T, color=SOFT, linewidth=0.6, label=None if index else "stream lines")
    for index, line in enumerate(plan.quasi_orthogonals):
        label = None if index else "quasi-orthogonals"
        axes.plot(*(line * MILLIMETRES).T, color=SOFT, linestyle=(0, (3, 2)), linewidth=0.9, label=label)
    for index, surface in enumerate(plan.stream_surfaces):
        _draw(axes, surface, GIVEN, None if index else "stream surfaces given")
    for name, asked in plan.lines.items():
        _draw(axes, asked, CURVES[name], name.replace("_", " "))
    for index, line in enumerate(built_edges(blade)):
        label = None if index else "edges as built"
        axes.plot(*(line * MILLIMETRES).T, color=INK, linestyle=(0, (1, 1.2)), linewidth=1.6, label=label)
    draw_clearance(axes, plan)
    titled(axes, "Meridional channel, given points", "x [mm]", "r [mm]" if exact.mapping.revolved else "z [mm]")
    axes.set_aspect("equal", adjustable="datalim")
    legend_below(axes, 3)


def draw_clearance(axes: Axes, plan: "Plan") -> None:
    """Draws the clearance surface, where there is one."""
    if plan.tip is None:
        return
    stated = " to ".join(dict.fromkeys(f"{each * MILLIMETRES:.3g}" for each in plan.clearance))
    tip = plan.tip * MILLIMETRES
    axes.plot(*tip.T, color=INK, linestyle="--", linewidth=1.0, label=f"clearance {stated} mm")


def built_edges(blade: "Blade") -> list[Reals]:
    """Leading and trailing edge of the native sides (n, 2) in (x, r) [m]; both sides' where one is blunt."""
    v, found = np.linspace(0.0, 1.0, 101), []
    for end, name in ((0.0, "leading_edge"), (1.0, "trailing_edge")):
        for side in blade.sides if name in blade.surfaces else blade.sides[:1]:
            x, y, z = np.moveaxis(np.real(side.grid(np.array([end]), v))[0], -1, 0)
            found.append(np.stack([x, np.sqrt(y * y + z * z) if blade.exact.mapping.revolved else z], axis=-1))
    return found


def _draw(axes: Axes, line: "PlanLine", colour: str, label: str | None) -> None:
    axes.plot(*(line.points * MILLIMETRES).T, color=colour, label=label)
    for part in line.beyond:
        axes.plot(*(part * MILLIMETRES).T, color=colour, linewidth=0.8)
    marks: dict[str, Any] = {"marker": "o", "markersize": 4.5, "markerfacecolor": "white"}
    style = ":" if line.polygon else "none"
    axes.plot(*(line.given * MILLIMETRES).T, color=colour, linestyle=style, linewidth=0.8, **marks)


def blade_outline(blade: "Blade") -> Reals:
    """What the blade covers of the meridional plane: its closed outline (n, 2) of (x, r) [m], noses included."""
    stations = blade.exact.stations(np.linspace(0.0, 1.0, 41))
    u, position, _ = stations.on_lines(np.concatenate(stations.plane.points(along_curve(101)), axis=-2))
    order = np.argsort(np.real(u), axis=-1)
    ends = np.take_along_axis(np.real(position), order[:, [0, -1], None], axis=1)
    hub, shroud = (np.real(position)[row, order[row]] for row in (0, -1))
    return np.concatenate([ends[:, 0], shroud, ends[::-1, 1], hub[::-1]])
