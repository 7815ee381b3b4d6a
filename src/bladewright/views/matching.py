"""The sheet of a fit: where the cloud lies off the design, and how far."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from bladewright.views.matching_figures import draw_extrema, draw_histogram, draw_table
from bladewright.views.matching_map import draw_map, draw_outline_deviation
from bladewright.views.matching_outline import outline_at, span_of, worst_span
from bladewright.views.matching_points import Matched, counted
from bladewright.views.matching_sections import draw_edge_match, draw_magnified
from bladewright.views.pages import headed, laid_out, rows
from bladewright.views.style import MILLIMETRES, manner, span_name
from bladewright.views.writing import checked, write

DOTS = 150
"""to an inch of a PNG"""
SHARES = (0.08, 0.5, 0.92)
"""of the span that the cloud covers, where sections are drawn"""


def fit_picture(fit: Matched, path: str | Path) -> None:
    """Draws a fit, as PNG, SVG or PDF by the suffix of `path`; the file appears whole or not at all.

    On it are the deviations on the unwrapped blade (of a section: along its outline), sections with the deviations
    magnified, both edges close by, the distribution of the deviations, the curvature of the sides and the figures. Of
    large clouds a part is drawn and the panel says so, but always the points farthest off, and on the map all outliers.
    Raises FileError where the suffix is another or the path cannot be written.
    """
    checked(path)
    figure = fit_sheet(fit)
    with manner():
        write(figure, path, DOTS)


def fit_sheet(fit: Matched) -> Figure:
    """The figure that `fit_picture` writes."""
    with manner():
        return laid_out(_blade_sheet(fit) if fit.cloud.shape[-1] == 3 else _section_sheet(fit))


def _blade_sheet(fit: Matched) -> Figure:
    blade = fit.built
    figure = Figure(figsize=(16.0, 15.0))
    headed(figure, fit.design.name, fit.design.description, _head(fit))
    top, centre, bottom = rows(figure, 4.5, 4.4, 5.0)
    axes = top.subplots(1, 2, width_ratios=[2.1, 1.0])
    draw_map(axes[0], fit)
    draw_table(axes[1], fit)
    outlines = [outline_at(fit, span_of(fit, share)) for share in SHARES]
    for place, outline in zip(centre.subplots(1, 3), outlines, strict=True):
        name = _place(outline.section.span, blade.design.ends)
        draw_magnified(place, fit, outline, f"{name[:1].upper()}{name[1:]} ± {100.0 * outline.band:.2g} %")
    axes = bottom.subplots(1, 4, width_ratios=[1.0, 1.0, 1.1, 1.3])
    for place, region in zip(axes, ("leading edge", "trailing edge"), strict=False):
        outline = outline_at(fit, worst_span(fit, region))
        where = f", {_place(outline.section.span, blade.design.ends)}"
        draw_edge_match(place, fit, outline, trailing=region == "trailing edge", where=where)
    draw_histogram(axes[2], fit)
    draw_extrema(axes[3], fit, [blade.section(v) for v in (0.0, 0.5, 1.0)], blade.design.ends)
    return figure


def _section_sheet(fit: Matched) -> Figure:
    figure = Figure(figsize=(16.0, 14.0))
    headed(figure, fit.design.name, fit.design.description, _head(fit))
    top, centre, bottom = rows(figure, 3.8, 5.4, 4.6)
    axes = top.subplots(1, 2, width_ratios=[2.1, 1.0])
    draw_outline_deviation(axes[0], fit)
    draw_table(axes[1], fit)
    outline = outline_at(fit, 0.0)
    axes = centre.subplots(1, 3, width_ratios=[1.5, 1.0, 1.0])
    draw_magnified(axes[0], fit, outline, "Section")
    draw_edge_match(axes[1], fit, outline, trailing=False, where="")
    draw_edge_match(axes[2], fit, outline, trailing=True, where="")
    axes = bottom.subplots(1, 2)
    draw_histogram(axes[0], fit)
    draw_extrema(axes[1], fit, [fit.built])
    return figure


def _head(fit: Matched) -> list[str]:
    outliers = len(fit.inliers) - int(np.count_nonzero(fit.inliers))
    said = [
        "passed" if fit.passed else "NOT PASSED",
        f"{counted(len(fit.cloud), 'point')}, {counted(outliers, 'outlier')}",
        f"mean {fit.deviation.mean * MILLIMETRES:.3g} mm, largest {fit.deviation.maximum * MILLIMETRES:.3g} mm",
        f"noise {fit.noise * MILLIMETRES:.2g} mm",
        f"chord {float(np.real(fit.built.chord)) * MILLIMETRES:.4g} mm",
        counted(len(fit.estimates), "free parameter"),
    ]
    if fit.tolerance is not None:
        said.insert(3, f"tolerance {fit.tolerance * MILLIMETRES:.3g} mm")
    return said


def _place(v: float, ends: tuple[str, str]) -> str:
    return span_name(v if v in {0.0, 1.0} else round(v, 2), ends)
