"""Figures of a fit: the histogram of deviations, curvature with its extrema, and the table by region."""

from collections.abc import Sequence
from textwrap import shorten, wrap
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes

from bladewright.section.extrema import turning_places
from bladewright.views.curvature import draw_curvature, side_curvature
from bladewright.views.matching_points import SIDES, Matched, counted
from bladewright.views.sections import along_curve
from bladewright.views.style import BLUE, GREEN, INK, MILLIMETRES, ORANGE, RED, SOFT, WALLS, legend_below, titled

if TYPE_CHECKING:
    from bladewright.section.section import Section

REGIONS = ("sides", "leading edge", "trailing edge", "ends")
EDGES = {"leading edge": ORANGE, "trailing edge": GREEN}
COLUMNS = (0.415, 0.565, 0.715, 0.86, 1.0)
"""right ends of the table's columns after the first"""
LINES = 6
"""of failures"""


def draw_histogram(axes: Axes, fit: Matched) -> None:
    """Draws the distribution of the inliers' signed deviations, with the cloud's noise and the tolerance."""
    off = fit.deviations[fit.inliers] * MILLIMETRES
    most = float(np.max(np.abs(off), initial=0.0))
    tolerance = None if fit.tolerance is None else fit.tolerance * MILLIMETRES
    seen = most if tolerance is None or tolerance > 4.0 * most > 0.0 else max(most, tolerance)
    limit = 1.12 * (seen if seen > 0.0 else 1.0)
    bins = np.linspace(-limit, limit, 1 + 2 * int(np.clip(np.sqrt(len(off)) / 2.0, 10, 60)))
    weights = np.full(len(off), 100.0 / max(len(off), 1))
    axes.hist(off, list(bins), weights=weights, color=BLUE, alpha=0.30, label="all inliers")
    for name, colour in EDGES.items():
        own = off[fit.regions[fit.inliers] == name]
        if len(own):
            shares = np.full(len(own), 100.0 / len(own))
            axes.hist(own, list(bins), weights=shares, histtype="step", color=colour, linewidth=1.3, label=name)
    tallest = max(axes.get_ylim()[1] / 1.05, 1e-9)
    sigma = fit.noise * MILLIMETRES
    width = bins[1] - bins[0]
    if np.isfinite(sigma) and sigma > width / 3.0:
        at = np.linspace(-limit, limit, 401)
        bell = 100.0 * width / (sigma * np.sqrt(2.0 * np.pi)) * np.exp(-0.5 * (at / sigma) ** 2)
        axes.plot(at, bell, color=RED, linewidth=1.3, label=f"noise, σ = {sigma:.3g} mm")
    else:
        axes.plot([], [], color=RED, label=f"noise, σ = {sigma:.2g} mm")
    axes.axvline(0.0, color=SOFT, linewidth=0.8)
    if tolerance is not None:
        for sign in (-1.0, 1.0):
            axes.axvline(sign * tolerance, color=INK, linewidth=1.1, linestyle="--")
        axes.plot([], [], color=INK, linewidth=1.1, linestyle="--", label=f"tolerance ± {tolerance:.3g} mm")
    axes.set_xlim(-limit, limit)
    # noise far below the deviations has a needle of a bell
    axes.set_ylim(0.0, 1.1 * min(max(axes.get_ylim()[1] / 1.05, tallest), 1.5 * tallest))
    titled(axes, "Distribution of the deviations", "deviation, outside positive [mm]", "part of the points [%]")
    legend_below(axes, 2)


def draw_extrema(axes: Axes, fit: Matched, sections: Sequence["Section"], ends: tuple[str, str] = WALLS) -> None:
    """Draws the curvature of the sides along their arc, and marks the extrema that are counted."""
    draw_curvature(axes, sections, ends)
    for section in sections:
        for name in SIDES:
            arc, curvature = side_curvature(section, name)
            u = turning_places(section, name)
            marks = [np.interp(u, along_curve(len(arc)), values) for values in (arc, curvature)]
            style: dict[str, Any] = {"marker": "o" if name == "upper" else "s", "markersize": 5.0, "zorder": 4.0}
            axes.plot(*marks, linestyle="none", markerfacecolor="white", markeredgecolor=RED, **style)
    counts = ", ".join(f"{fit.extrema[name]} {name}" for name in SIDES if name in fit.extrema)
    axes.set_title(f"Curvature, extrema: {counts}")


def draw_table(axes: Axes, fit: Matched) -> None:
    """Writes whether the fit passed, why not, and the distances by region."""
    axes.axis("off")
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(0.0, 1.0)
    colour = GREEN if fit.passed else RED
    verdict = ("Passed" if fit.passed else "Not passed") + (", interrupted" if fit.interrupted else "")
    axes.set_title("Distances of the inliers [mm]")
    height, line = 0.98, 0.074
    for name, right in zip(("points", "mean", "rms", "99 %", "max"), COLUMNS, strict=True):
        axes.text(right, height, name, ha="right", va="top", fontsize=9.0, color=SOFT)
    for name, of in {"all": fit.deviation, **{name: fit.by_region.get(name) for name in REGIONS}}.items():
        height -= line
        known = of is not None and of.count > 0
        weight = "bold" if name == "all" else "normal"
        axes.text(0.0, height, name, va="top", fontsize=9.5, fontweight=weight)
        cells = ["none", *"––––"]
        if of is not None and known:
            figures = (of.mean, of.rms, of.percentile_99, of.maximum)
            cells = [f"{of.count:,}", *(f"{value * MILLIMETRES:.3g}" for value in figures)]
        for cell, right in zip(cells, COLUMNS, strict=True):
            over = known and right == COLUMNS[-1] and _beyond(fit, of)
            ink = RED if over else INK
            axes.text(right, height, cell, ha="right", va="top", fontsize=9.5, fontweight=weight, color=ink)
    height -= 1.6 * line
    axes.text(0.0, height, verdict, va="top", fontsize=12.0, fontweight="bold", color=colour)
    asked = "no tolerance asked" if fit.tolerance is None else f"tolerance {fit.tolerance * MILLIMETRES:.3g} mm"
    axes.text(1.0, height, asked, ha="right", va="top", fontsize=10.0)
    height -= 1.15 * line
    told = [piece for each in fit.failures for piece in wrap(shorten(each, 260, placeholder=" …"), 66)]
    if not told:
        told = [f"{counted(len(fit.estimates), 'free parameter')}, rank {fit.rank}"]
    for piece in told[:LINES] + (["…"] if len(told) > LINES else []):
        axes.text(0.0, height, piece, va="top", fontsize=9.0, parse_math=False)
        height -= 0.85 * line


def _beyond(fit: Matched, of: Any) -> bool:
    return fit.tolerance is not None and of.maximum > fit.tolerance
