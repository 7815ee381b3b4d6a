"""How a search of one aim has come to its optimum."""

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bladewright.nurbs.basis import Reals
from bladewright.views.pages import Page, checked_path, with_fixed_layout, write_figure
from bladewright.views.style import BLUE, ORANGE, SHEET_DPI, drawing_style, label_axes

SMALLEST = 1e-16
"""Violation below which a point is drawn at this value: a logarithmic axis has no zero."""


class Search(Protocol):
    """What is drawn of an optimum."""

    @property
    def name(self) -> str:
        """Of the study."""

    @property
    def aim(self) -> str:
        """What was to be small or large, with its unit."""

    @property
    def rows(self) -> Sequence[tuple[str, float, float]]:
        """Name with unit, start and end of each variable and figure."""

    @property
    def history(self) -> Reals:
        """(1 + iterations, 2) the aim's figure, and the largest violation of a constraint."""


def optimum_rows(search: Search) -> list[tuple[str, ...]]:
    """Every variable and figure at the start and as found."""
    return [(name, f"{before:.5g}", f"{after:.5g}") for name, before, after in search.rows]


def draw_optimum(search: Search, path: str | Path) -> None:
    """Draw it as PNG, SVG or PDF, by the ending of `path`; FileError where it cannot be written."""
    checked_path(path)
    with drawing_style():
        write_figure(optimum_figure(search), path, SHEET_DPI)


def optimum_figure(search: Search) -> Figure:
    """The aim and the largest violation of a constraint over the iterations."""
    with drawing_style():
        figure = Page(figsize=(9.0, 4.2), layout="constrained")
        left, right = figure.subplots(1, 2)
        count = np.arange(len(search.history))
        left.plot(count, search.history[:, 0], color=BLUE, marker="o", markersize=3.0)
        right.semilogy(count, np.maximum(search.history[:, 1], SMALLEST), color=ORANGE, marker="o", markersize=3.0)
        label_axes(left, search.name, "iteration", search.aim)
        label_axes(right, "Constraints", "iteration", "largest violation, in its size")
        for axes in (left, right):
            axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        return with_fixed_layout(figure)
