"""The duct of a passage in its meridional plane, from inlet to outlet."""

from typing import TYPE_CHECKING, cast

import numpy as np
from matplotlib.axes import Axes

from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface
from bladewright.views.meridional import CURVES, blade_outline, draw_clearance
from bladewright.views.sections import along_curve
from bladewright.views.style import INK, MILLIMETRES, SOFT, legend_below, titled

if TYPE_CHECKING:
    from bladewright.domain.passage import Passage

INLET, OUTLET = "#7a5ea8", "#4d4d4d"


def draw_duct(axes: Axes, passage: "Passage") -> None:
    """Draws the native duct in the (x, r) plane, or (x, z) of a cascade, equal lengths equal on both axes."""
    blade = passage.blade
    noses = blade_outline(blade) * MILLIMETRES
    axes.fill(*noses.T, color=INK, alpha=0.08, linewidth=0.0, label="blade")
    periodic, across = cast(Surface, passage.whole["periodic_upper"]), np.linspace(0.0, 1.0, 101)
    u = np.unique(np.concatenate([np.linspace(0.0, 1.0, 401), 0.25 + 0.5 * along_curve(201)]))
    for index, line in enumerate(np.swapaxes(_meridional(passage, periodic, u, np.linspace(0.1, 0.9, 9)), 0, 1)):
        axes.plot(*line.T, color=SOFT, linewidth=0.6, label=None if index else "stream lines")
    for wall, v in (("hub", 0.0), ("shroud", 1.0)):
        line = _meridional(passage, periodic, u, np.array([v]))[:, 0]
        axes.plot(*line.T, color=CURVES[wall], linewidth=1.8, label=wall)
    for name, end, colour in (("inlet", 0.0, INLET), ("outlet", 1.0, OUTLET)):
        line = _meridional(passage, periodic, np.array([end]), across)[0]
        axes.plot(*line.T, color=colour, linewidth=1.8, label=name)
        side = cast(Surface, passage.whole["blade_upper"])
        edge = "leading_edge" if name == "inlet" else "trailing_edge"
        line = _meridional(passage, side, np.array([end]), across)[0]
        axes.plot(*line.T, color=CURVES[edge], label=edge.replace("_", " "))
    draw_clearance(axes, blade.exact.plan)
    titled(axes, "Meridional duct", "x [mm]", "r [mm]" if passage.duct.revolved else "z [mm]")
    axes.set_aspect("equal", adjustable="datalim")
    legend_below(axes, 3)


def _meridional(passage: "Passage", face: Surface, u: Reals, v: Reals) -> Reals:
    """(x, r) or (x, z) (k, l, 2) [mm] of a native face at u (k,) and v (l,)."""
    x, y, z = np.moveaxis(np.real(face.grid(u, v)), -1, 0)
    return np.stack([x, np.sqrt(y * y + z * z) if passage.duct.revolved else z], axis=-1) * MILLIMETRES
