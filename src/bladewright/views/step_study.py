"""Errors of central differences and of the complex step over their steps, a line for each parameter."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bladewright.nurbs.basis import Reals
from bladewright.views.pages import checked_path, write_figure
from bladewright.views.style import BLUE, GREEN, INK, ORANGE, RED, SHEET_DPI, SOFT, drawing_style, label_axes

if TYPE_CHECKING:
    from bladewright.derivatives.step_study import StepStudy


SMALLEST_ERROR = 1e-17
"""Error below which points are drawn at this value, as a logarithmic axis has no zero: below rounding of doubles."""
KINDS = {
    "angles": (BLUE, ("stagger", "metal_angle", "leading_edge_theta")),
    "lengths": (GREEN, ("channel", "leading_edge_x", "leading_edge_y", "axial_chord", "pitch", "span", "tip_", "hub_")),
    "edge radii": (RED, ("leading_edge_radius", "trailing_edge_radius")),
    "thickness, tangents, weights": (ORANGE, ("",)),
}
"""Colour of each kind of parameter, and beginnings of the names; the first kind that fits is taken."""


def draw_step_studies(studies: Sequence["StepStudy"], path: str | Path, *, title: str, limit: float) -> None:
    """Draw the check of derivatives as PNG, SVG or PDF, by the ending of `path`.

    `limit` is the largest error with which the closest difference passes. Raises FileError where the path cannot be
    written.
    """
    checked_path(path)
    with drawing_style():
        figure = Figure(figsize=(13.0, 6.6), layout="constrained")
        figure.suptitle(title, x=0.01, ha="left", fontsize=14.0, fontweight="bold", parse_math=False)
        left, right = figure.subplots(1, 2, sharey=True)
        for each in studies:
            colour = KINDS[parameter_kind(each.path)][0]
            _line(left, each.steps, each.errors, colour)
            _line(right, each.imaginary, each.floor, colour)
        _slopes(left)
        left.axhline(limit, color=INK, linewidth=1.0, linestyle=(0, (5, 3)))
        left.set_ylim(SMALLEST_ERROR / 3.0, 30.0)
        label_axes(left, "Differences", "step, of the parameter's scale", "error of the derivative, of its size")
        label_axes(right, "Complex step", "imaginary step, of the parameter's scale", "")
        figure.legend(handles=_handles(studies, limit), loc="outside lower left", ncols=5)
        write_figure(figure, path, SHEET_DPI)


def parameter_kind(path: str) -> str:
    """The kind of a parameter: a key of `KINDS`."""
    return next(kind for kind, (_, starts) in KINDS.items() if path.startswith(starts))


def _line(axes: Axes, steps: Reals, errors: Reals, colour: str) -> None:
    order = np.argsort(steps)
    at, high = steps[order], np.maximum(errors[order], SMALLEST_ERROR)
    axes.loglog(at, high, color=colour, linewidth=0.8, alpha=0.6, marker=".", markersize=3.5)


def _slopes(axes: Axes) -> None:
    """Draw the slopes that truncation and rounding have."""
    style = {"color": SOFT, "linewidth": 1.6, "linestyle": ":"}
    axes.loglog([1e-4, 1e-2], [1e-5, 1e-1], **style)
    axes.loglog([1e-10, 1e-6], [1.0, 1e-4], **style)
    axes.annotate("truncation: step²", (10**-2.9, 10**-2.6), color=INK, ha="right", fontsize=9.0)
    axes.annotate("rounding: 1 / step", (10**-7.6, 10**-2.1), color=INK, ha="left", fontsize=9.0)


def _handles(studies: Sequence["StepStudy"], limit: float) -> list[Line2D]:
    counted = [parameter_kind(each.path) for each in studies if len(each.errors)]
    lines = [
        Line2D([], [], color=colour, marker=".", label=f"{counted.count(kind)} {kind}")
        for kind, (colour, _) in KINDS.items()
        if kind in counted
    ]
    return [*lines, Line2D([], [], color=INK, linestyle=(0, (5, 3)), label=f"the closest must come below {limit:g}")]
