"""The sheet of a fit: where the cloud lies off the design, how far, and the figures by region."""

from collections.abc import Sequence
from pathlib import Path
from textwrap import shorten, wrap
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bladewright.section.curvature_extrema import turning_places
from bladewright.views.distributions import draw_curvature, side_curvature
from bladewright.views.fit_data import SIDES, FitResult, count_of, outline_at, span_at_share, worst_span
from bladewright.views.fit_deviations import draw_edge_points, draw_magnified, draw_map, draw_outline_deviation
from bladewright.views.pages import Page, checked_path, draw_header, rows, with_fixed_layout, write_figure
from bladewright.views.sections import cosine_spacing
from bladewright.views.style import (
    BLUE,
    GREEN,
    INK,
    ORANGE,
    RED,
    SHEET_DPI,
    SOFT,
    WALLS,
    axis,
    drawing_style,
    in_unit,
    label_axes,
    legend_below,
    per_metre,
    span_name,
    unit_name,
)
from bladewright.views.text_table import LINE, Row, draw_text_table

if TYPE_CHECKING:
    from bladewright.section.section import Section


REGIONS = ("sides", "leading edge", "trailing edge", "ends")
"""Regions of the blade in the table of distances."""
EDGE_COLOURS = {"leading edge": ORANGE, "trailing edge": GREEN}
"""Colours of the histograms of the regions at the edges."""
FAILURE_LINES = 6
"""Most lines of failures under the table, which its panel has room for."""
SPAN_SHARES = (0.08, 0.5, 0.92)
"""Where sections are drawn, in fractions of the span that the cloud covers: near both ends and in the middle."""


def fit_picture(fit: FitResult, path: str | Path) -> None:
    """Draw a fit as PNG, SVG or PDF, by the ending of `path`; the file is written whole or not at all.

    It shows the deviations on the unwrapped blade (of a section: along its outline), sections with magnified
    deviations, close-ups of both edges, the distribution of the deviations, the curvature of the sides and the figures.
    Of large clouds a part is drawn, and the panel says so; the points farthest off are always drawn, and on the map all
    outliers. Raises FileError where the ending is another or the path cannot be written.
    """
    checked_path(path)
    figure = fit_sheet(fit)
    with drawing_style():
        write_figure(figure, path, SHEET_DPI)


def fit_sheet(fit: FitResult) -> Figure:
    """The figure that `fit_picture` writes."""
    with drawing_style(fit.design.length_unit):
        return with_fixed_layout(_blade_sheet(fit) if fit.cloud.shape[-1] == 3 else _section_sheet(fit))


def _blade_sheet(fit: FitResult) -> Figure:
    blade = fit.built
    figure = Page(figsize=(16.0, 15.0))
    draw_header(figure, fit.design.name, fit.design.description, _header(fit))
    top, centre, bottom = rows(figure, 4.5, 4.4, 5.0)
    axes = top.subplots(1, 2, width_ratios=[2.1, 1.0])
    draw_map(axes[0], fit)
    draw_table(axes[1], fit)
    outlines = [outline_at(fit, span_at_share(fit, share)) for share in SPAN_SHARES]
    for place, outline in zip(centre.subplots(1, 3), outlines, strict=True):
        name = _place(outline.section.span, blade.design.law_ends)
        draw_magnified(place, fit, outline, f"{name[:1].upper()}{name[1:]} ± {100.0 * outline.band:.2g} %")
    axes = bottom.subplots(1, 4, width_ratios=[1.0, 1.0, 1.1, 1.3])
    for place, region in zip(axes, ("leading edge", "trailing edge"), strict=False):
        outline = outline_at(fit, worst_span(fit, region))
        where = f", {_place(outline.section.span, blade.design.law_ends)}"
        draw_edge_points(place, fit, outline, trailing=region == "trailing edge", where=where)
    draw_histogram(axes[2], fit)
    draw_extrema(axes[3], fit, [blade.section(v) for v in (0.0, 0.5, 1.0)], blade.design.law_ends)
    return figure


def _section_sheet(fit: FitResult) -> Figure:
    figure = Page(figsize=(16.0, 14.0))
    draw_header(figure, fit.design.name, fit.design.description, _header(fit))
    top, centre, bottom = rows(figure, 3.8, 5.4, 4.6)
    axes = top.subplots(1, 2, width_ratios=[2.1, 1.0])
    draw_outline_deviation(axes[0], fit)
    draw_table(axes[1], fit)
    outline = outline_at(fit, 0.0)
    axes = centre.subplots(1, 3, width_ratios=[1.5, 1.0, 1.0])
    draw_magnified(axes[0], fit, outline, "Section")
    draw_edge_points(axes[1], fit, outline, trailing=False, where="")
    draw_edge_points(axes[2], fit, outline, trailing=True, where="")
    axes = bottom.subplots(1, 2)
    draw_histogram(axes[0], fit)
    draw_extrema(axes[1], fit, [fit.built])
    return figure


def _header(fit: FitResult) -> list[str]:
    outliers = len(fit.outliers)
    header = [
        "passed" if fit.passed else "NOT PASSED",
        f"{count_of(len(fit.cloud), 'point')}, {count_of(outliers, 'outlier')}",
        f"mean {in_unit(fit.deviation.mean, '.3g')}, largest {in_unit(fit.deviation.maximum, '.3g')}",
        f"noise {in_unit(fit.noise, '.2g')}",
        f"chord {in_unit(float(np.real(fit.built.chord)))}",
        count_of(len(fit.estimates), "free parameter"),
    ]
    if fit.tolerance is not None:
        header.insert(3, f"tolerance {in_unit(fit.tolerance, '.3g')}")
    return header


def _place(v: float, ends: tuple[str, str]) -> str:
    return span_name(v if v in {0.0, 1.0} else round(v, 2), ends)


def draw_histogram(axes: Axes, fit: FitResult) -> None:
    """Draw the distribution of the inliers' signed deviations, with the noise of the cloud and the tolerance."""
    deviation = fit.deviations[fit.inliers] * per_metre()
    most = float(np.max(np.abs(deviation), initial=0.0))
    tolerance = None if fit.tolerance is None else fit.tolerance * per_metre()
    largest = most if tolerance is None or tolerance > 4.0 * most > 0.0 else max(most, tolerance)
    limit = 1.12 * (largest if largest > 0.0 else 1.0)
    bins = np.linspace(-limit, limit, 1 + 2 * int(np.clip(np.sqrt(len(deviation)) / 2.0, 10, 60)))
    weights = np.full(len(deviation), 100.0 / max(len(deviation), 1))
    axes.hist(deviation, list(bins), weights=weights, color=BLUE, alpha=0.30, label="all inliers")
    for name, colour in EDGE_COLOURS.items():
        part = deviation[fit.regions[fit.inliers] == name]
        if len(part):
            shares = np.full(len(part), 100.0 / len(part))
            axes.hist(part, list(bins), weights=shares, histtype="step", color=colour, linewidth=1.3, label=name)
    tallest = max(axes.get_ylim()[1] / 1.05, 1e-9)
    sigma = fit.noise * per_metre()
    width = bins[1] - bins[0]
    if np.isfinite(sigma) and sigma > width / 3.0:
        abscissa = np.linspace(-limit, limit, 401)
        bell = 100.0 * width / (sigma * np.sqrt(2.0 * np.pi)) * np.exp(-0.5 * (abscissa / sigma) ** 2)
        axes.plot(abscissa, bell, color=RED, linewidth=1.3, label=f"noise, σ = {sigma:.3g} {unit_name()}")
    else:
        axes.plot([], [], color=RED, label=f"noise, σ = {sigma:.2g} {unit_name()}")
    axes.axvline(0.0, color=SOFT, linewidth=0.8)
    if tolerance is not None:
        for sign in (-1.0, 1.0):
            axes.axvline(sign * tolerance, color=INK, linewidth=1.1, linestyle="--")
        axes.plot([], [], color=INK, linewidth=1.1, linestyle="--", label=f"tolerance ± {tolerance:.3g} {unit_name()}")
    axes.set_xlim(-limit, limit)
    # Noise far below the deviations makes a narrow, high bell that is cut off.
    axes.set_ylim(0.0, 1.1 * min(max(axes.get_ylim()[1] / 1.05, tallest), 1.5 * tallest))
    label_axes(axes, "Distribution of the deviations", axis("deviation, outside positive"), "part of the points [%]")
    legend_below(axes, 2)


def draw_extrema(axes: Axes, fit: FitResult, sections: Sequence["Section"], ends: tuple[str, str] = WALLS) -> None:
    """Draw the curvature of the sides along their arc, and mark the extrema that are counted."""
    draw_curvature(axes, sections, ends)
    for section in sections:
        for name in SIDES:
            arc, curvature = side_curvature(section, name)
            u = turning_places(section, name)
            places = [np.interp(u, cosine_spacing(len(arc)), values) for values in (arc, curvature)]
            style: dict[str, Any] = {"marker": "o" if name == "upper" else "s", "markersize": 5.0, "zorder": 4.0}
            axes.plot(*places, linestyle="none", markerfacecolor="white", markeredgecolor=RED, **style)
    counts = ", ".join(f"{fit.extrema[name]} {name}" for name in SIDES if name in fit.extrema)
    axes.set_title(f"Curvature, extrema: {counts}")


def draw_table(axes: Axes, fit: FitResult) -> None:
    """Write the distances by region, whether the fit passed, and why not."""
    axes.set_title(f"Distances of the inliers [{unit_name()}]")
    rows, inks = list[Row](), dict[tuple[int, int], str]()
    for name, of in {"all": fit.deviation, **{name: fit.by_region.get(name) for name in REGIONS}}.items():
        cells = ["none", *"––––"]
        if of is not None and of.count > 0:
            figures = (of.mean, of.rms, of.percentile_99, of.maximum)
            cells = [f"{of.count:,}", *(f"{value * per_metre():.3g}" for value in figures)]
            if _beyond(fit, of):
                inks[len(rows), len(cells)] = RED
        rows.append((name, *cells))
    header = ("", "points", "mean", "rms", "99 %", "max")
    height = draw_text_table(axes, rows, align="lrrrrr", header=header, inks=inks)
    result = ("Passed" if fit.passed else "Not passed") + (", interrupted" if fit.interrupted else "")
    stated = "no tolerance asked" if fit.tolerance is None else f"tolerance {in_unit(fit.tolerance, '.3g')}"
    place: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points", "va": "top"}
    ink = GREEN if fit.passed else RED
    axes.annotate(result, (0.0, 1.0), (0.0, -height), fontsize=12.0, fontweight="bold", color=ink, **place)
    height += 1.4 * LINE
    lines = [stated, *(piece for each in fit.failures for piece in wrap(shorten(each, 260, placeholder=" …"), 66))]
    if not fit.failures:
        lines.append(f"{count_of(len(fit.estimates), 'free parameter')}, rank {fit.rank}")
    for piece in lines[: FAILURE_LINES + 1] + (["…"] if len(lines) > FAILURE_LINES + 1 else []):
        axes.annotate(piece, (0.0, 1.0), (0.0, -height), fontsize=9.0, parse_math=False, **place)
        height += 0.9 * LINE


def _beyond(fit: FitResult, of: Any) -> bool:
    return fit.tolerance is not None and of.maximum > fit.tolerance
