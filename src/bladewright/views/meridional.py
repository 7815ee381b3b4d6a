"""The meridional channel: its four curves with control points, stream lines and the blade's outline."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from bladewright.blade.exact import in_channel
from bladewright.nurbs.basis import Reals
from bladewright.views.sections import along_curve
from bladewright.views.style import BLUE, GREEN, INK, MILLIMETRES, ORANGE, RED, SOFT, legend_below, titled

if TYPE_CHECKING:
    from bladewright.blade.blade import Blade

CURVES = {"hub": BLUE, "shroud": ORANGE, "leading_edge": GREEN, "trailing_edge": RED}


def draw_meridional(axes: Axes, blade: "Blade") -> None:
    """Draws the channel in the (x, r) plane, or (x, z) of a cascade, equal lengths equal on both axes."""
    exact = in_channel(blade.exact, "a picture")
    u = np.linspace(-exact.before, 1.0 + exact.after, 201)
    inside = np.linspace(0.0, 1.0, 201)
    noses = blade_outline(blade) * MILLIMETRES
    axes.fill(*noses.T, color=INK, alpha=0.08, linewidth=0.0, label="blade")
    axes.plot(*noses.T, color=INK, linewidth=0.7)
    lines = np.real(exact.stations(np.linspace(0.1, 0.9, 9)).lines.position(u)) * MILLIMETRES
    for index, line in enumerate(lines):
        axes.plot(*line.T, color=SOFT, linewidth=0.6, label=None if index else "stream lines")
    for wall, colour in CURVES.items():
        curve = exact.full_channel.curve(wall)
        points = np.real(curve.control_points) * MILLIMETRES
        axes.plot(*(np.real(curve(inside)) * MILLIMETRES).T, color=colour, label=wall.replace("_", " "))
        if wall in ("hub", "shroud"):
            for part in (u[u < 0.0], u[u > 1.0]):
                axes.plot(*(np.real(curve(part)) * MILLIMETRES).T, color=colour, linewidth=0.8)
        axes.plot(
            *points.T, color=colour, linestyle=":", linewidth=0.8, marker="o", markersize=4.5, markerfacecolor="white"
        )
    if exact.clearance is not None:
        tip = np.real(exact.channel.curve(exact.clearance.wall)(inside)) * MILLIMETRES
        apart = MILLIMETRES * np.real(exact.clearance.real().distance(inside[[0, -1]]))
        stated = " to ".join(dict.fromkeys(f"{each:.3g}" for each in apart))
        axes.plot(*tip.T, color=INK, linestyle="--", linewidth=1.0, label=f"clearance {stated} mm")
    titled(axes, "Meridional channel, control points", "x [mm]", "r [mm]" if exact.mapping.revolved else "z [mm]")
    axes.set_aspect("equal", adjustable="datalim")
    legend_below(axes, 3)


def blade_outline(blade: "Blade") -> Reals:
    """What the blade covers of the meridional plane: its closed outline (n, 2) of (x, r) [m], noses included."""
    stations = blade.exact.stations(np.linspace(0.0, 1.0, 41))
    u, position, _ = stations.on_lines(np.concatenate(stations.plane.points(along_curve(101)), axis=-2))
    order = np.argsort(np.real(u), axis=-1)
    ends = np.take_along_axis(np.real(position), order[:, [0, -1], None], axis=1)
    hub, shroud = (np.real(position)[row, order[row]] for row in (0, -1))
    return np.concatenate([ends[:, 0], shroud, ends[::-1, 1], hub[::-1]])
