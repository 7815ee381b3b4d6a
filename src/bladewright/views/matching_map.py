"""Deviations on the unwrapped blade: the lower side left, the leading edge in the middle, the upper side right."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.ticker import FixedLocator, FuncFormatter

from bladewright.nurbs.basis import Reals
from bladewright.views.matching_points import (
    COLOURS,
    WORST,
    Index,
    Matched,
    counted,
    cross,
    drawn,
    millimetres,
    on_sides,
    scale_of,
)
from bladewright.views.style import INK, MILLIMETRES, PALE, SOFT, titled

MOST = 20_000
"""points up to which each is drawn on the map; of more, the mean of each cell"""
CELL = 10
"""points in a cell of the map, in the mean, as long as there are no more than FINEST cells along the chord"""
FINEST = 320
ABSCISSA = "u:  trailing edge  ←  lower side  →  leading edge  ←  upper side  →  trailing edge"


def draw_map(axes: Axes, fit: Matched) -> None:
    """Draws the signed deviations of a blade over u and v."""
    scale = scale_of(fit)
    axes.set_facecolor(PALE)
    axes.grid(visible=False)
    sides = on_sides(fit) & fit.inliers
    total = int(np.count_nonzero(sides))
    if total > MOST:
        _draw_cells(axes, fit, np.flatnonzero(sides), scale)
        shown = drawn(fit, sides, WORST * 2)[-WORST:]
        told = f"mean in each cell of {counted(total, 'point')}, the {WORST} farthest as dots"
    else:
        shown = drawn(fit, sides, MOST)
        told = f"{counted(total, 'point')} on the sides"
    size = float(np.clip(1.6e5 / max(total, 1), 5.0, 60.0)) if total <= MOST else 7.0
    dots: dict[str, Any] = {"s": size, "cmap": COLOURS, "norm": scale, "rasterized": True}
    places = abscissae(fit, shown), fit.v[shown]
    axes.scatter(*places, c=millimetres(fit, shown), linewidths=0.25, edgecolors=INK, **dots)
    outliers = np.flatnonzero(on_sides(fit) & ~fit.inliers)
    told += _outliers(axes, fit, outliers, fit.v[outliers])
    others = int(np.count_nonzero(~on_sides(fit)))
    if others:
        told += f"; {counted(others, 'point')} on ends and blunt edges not shown"
    _dressed(axes)
    axes.set_ylim(-0.03, 1.03)
    titled(axes, "Deviation from the blade", f"{ABSCISSA}\n{told}", "span v [-]")
    bar = axes.figure.colorbar(ScalarMappable(norm=scale, cmap=COLOURS), ax=axes, extend="both", pad=0.012, aspect=28)
    bar.set_label("inside the blade  ←  deviation [mm]  →  outside")
    bar.outline.set_visible(False)


def draw_outline_deviation(axes: Axes, fit: Matched) -> None:
    """Draws the signed deviations of a section over u, outliers at the border."""
    scale = scale_of(fit)
    total = int(np.count_nonzero(fit.inliers))
    shown = drawn(fit, fit.inliers, MOST)
    most = max(float(np.max(np.abs(fit.deviations[fit.inliers]), initial=0.0)), fit.tolerance or 0.0) * MILLIMETRES
    limit = 1.25 * (most if most > 0.0 else 1.0)
    told = f"{counted(total, 'point')}"
    if len(shown) < total:
        told += f", {len(shown):,} of them drawn with the {WORST} farthest"
    size = float(np.clip(2e4 / max(len(shown), 1), 4.0, 30.0))
    dots: dict[str, Any] = {"s": size, "cmap": COLOURS, "norm": scale, "rasterized": len(shown) > 2000}
    values = millimetres(fit, shown)
    axes.scatter(
        abscissae(fit, shown), values, c=values, linewidths=0.35 if len(shown) < 2000 else 0.0, edgecolors=INK, **dots
    )
    outliers = np.flatnonzero(~fit.inliers)
    held = np.clip(millimetres(fit, outliers), -0.95 * limit, 0.95 * limit)
    told += _outliers(axes, fit, outliers, held)
    axes.axhline(0.0, color=INK, linewidth=0.9)
    if fit.tolerance is not None:
        for sign in (-1.0, 1.0):
            axes.axhline(sign * fit.tolerance * MILLIMETRES, color=SOFT, linewidth=1.0, linestyle="--")
        told += f"; dashed: the tolerance, {fit.tolerance * MILLIMETRES:.3g} mm"
    _dressed(axes)
    axes.set_ylim(-limit, limit)
    titled(axes, "Deviation from the section", f"{ABSCISSA}\n{told}", "deviation, outside positive [mm]")


def abscissae(fit: Matched, index: Index) -> Reals:
    """u of points on the upper side, -u of those on the lower; those on the face of a blunt edge stand at the edge."""
    places = fit.places[index]
    u = np.where(places == "leading_edge", 0.0, np.where(places == "trailing_edge", 1.0, fit.u[index]))
    return np.where(places == "lower", -u, u)


def _outliers(axes: Axes, fit: Matched, index: Index, ordinate: Reals) -> str:
    """Crosses outliers, and says how many."""
    if len(index) == 0:
        return ""
    cross(axes, abscissae(fit, index), ordinate, 200)
    return f", {counted(len(index), 'outlier')} crossed"


def _draw_cells(axes: Axes, fit: Matched, index: Index, scale: Normalize) -> None:
    along = int(np.clip(np.sqrt(4.0 * len(index) / CELL), 40, FINEST))
    shape = along, along // 4
    edges = np.linspace(-1.0, 1.0, shape[0] + 1), np.linspace(0.0, 1.0, shape[1] + 1)
    cell = [
        np.clip(np.searchsorted(ends, at, side="right") - 1, 0, count - 1)
        for ends, at, count in zip(edges, (abscissae(fit, index), fit.v[index]), shape, strict=True)
    ]
    flat = np.ravel_multi_index((cell[0], cell[1]), shape)
    number = np.bincount(flat, minlength=shape[0] * shape[1])
    total = np.bincount(flat, weights=millimetres(fit, index), minlength=len(number))
    mean = np.ma.masked_where(number == 0, total / np.maximum(number, 1)).reshape(shape)
    axes.pcolormesh(*edges, mean.T, cmap=COLOURS, norm=scale, rasterized=True)


def _dressed(axes: Axes) -> None:
    axes.set_xlim(-1.01, 1.01)
    axes.axvline(0.0, color=SOFT, linewidth=0.9, zorder=0.9)
    axes.xaxis.set_major_locator(FixedLocator(np.linspace(-1.0, 1.0, 11).tolist()))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{abs(value):g}"))
