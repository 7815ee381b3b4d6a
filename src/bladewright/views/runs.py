"""The runs of a study: parallel coordinates, a scatter matrix, and the main effects of its variables."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Colormap, LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure

from bladewright.nurbs.basis import Reals
from bladewright.views.pages import Page, checked_path, with_fixed_layout, write_figure
from bladewright.views.style import BLUE, INK, ORANGE, PALE, SHEET_DPI, SOFT, drawing_style

Flags = np.ndarray[Any, np.dtype[np.bool_]]
COLOURS: Colormap = LinearSegmentedColormap.from_list("runs", ["#1f3f7f", "#1f8f8f", "#8fbf4f", "#e0a32e", "#b23a48"])
"""Colours of runs, from the lowest to the highest value of a figure."""
MOST_AXES = 16
"""Columns that a picture shows: more cannot be read."""
MOST_TICKS = 8
"""Different values up to which each is written at its axis: their names are clear of each other."""
BINS = 8
"""Parts of a variable's range over which a figure is averaged: with 64 runs eight are in each."""
LINES = 3000
"""Runs that parallel coordinates draw, evenly chosen: more are a solid band."""


class Table(Protocol):
    """What is drawn of the runs of a study."""

    @property
    def name(self) -> str:
        """Of the study."""

    @property
    def good(self) -> Flags:
        """Whether each run (n,) has figures."""

    @property
    def parameters(self) -> Mapping[str, Sequence[Any]]:
        """Values of each variable (n,), numbers or other choices."""

    @property
    def figures(self) -> Mapping[str, Reals]:
        """Values of each quantity (n,)."""

    def heading(self, name: str) -> str:
        """A name with its unit."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Column:
    """A variable or a figure of all runs."""

    name: str
    """with its unit"""
    values: Reals
    """(n,) numbers, of choices that are none their places"""
    choices: tuple[str, ...] = ()
    """the choices by their places"""
    is_figure: bool

    @property
    def ends(self) -> tuple[float, float]:
        """Lowest and highest value; apart also where all are the same."""
        found = self.values[np.isfinite(self.values)]
        if not len(found):
            return 0.0, 1.0
        low, high = float(np.min(found)), float(np.max(found))
        margin = 0.0 if high > low else max(0.01 * high, -0.01 * high, 1e-9)
        return low - margin, high + margin

    @property
    def ticks(self) -> Reals:
        """Where an axis is marked: at each of few values, or evenly."""
        different = np.unique(self.values[np.isfinite(self.values)])
        return different if len(different) <= MOST_TICKS else np.linspace(*self.ends, 5)

    def label(self, value: float) -> str:
        """A value as it is written at an axis."""
        return self.choices[round(value)] if self.choices else f"{value:.4g}"


def draw_runs(figure: Callable[[Table], Figure], runs: Table, path: str | Path) -> None:
    """Draw runs as PNG, SVG or PDF, by the ending of `path`; FileError where it cannot be written."""
    checked_path(path)
    with drawing_style():
        write_figure(figure(runs), path, SHEET_DPI)


def parallel_coordinates(runs: Table) -> Figure:
    """A line for every run across an axis for every variable and figure, coloured by the first figure.

    Runs without figures are grey, and end at the last variable.
    """
    columns = _columns(runs)
    colour = next((column for column in columns if column.is_figure), columns[-1])
    with drawing_style():
        figure = Page(figsize=(max(7.0, 1.25 * len(columns) + 1.5), 5.6), layout="constrained")
        axes = figure.add_subplot()
        places = np.arange(len(columns))
        heights = np.column_stack([_height(column, column.values) for column in columns])
        chosen = np.unique(np.linspace(0, len(heights) - 1, min(LINES, len(heights))).round().astype(int))
        whole = chosen[np.isfinite(heights[chosen]).all(axis=1) & runs.good[chosen]]
        for run in np.setdiff1d(chosen, whole):
            axes.plot(places, heights[run], color=SOFT, linewidth=0.7, alpha=0.5, linestyle=(0, (4, 2)))
        order = whole[np.argsort(colour.values[whole])]
        faint = float(np.clip(60.0 / max(len(order), 1), 0.25, 0.9))
        scale = Normalize(*colour.ends)
        lines = LineCollection(
            [np.column_stack([places, heights[run]]) for run in order],
            linewidths=1.1,
            alpha=faint,
            cmap=COLOURS,
            norm=scale,
        )
        lines.set_array(colour.values[order])
        axes.add_collection(lines)
        _parallel_axes(axes, columns)
        bar = figure.colorbar(ScalarMappable(scale, COLOURS), ax=axes, pad=0.02, aspect=30)
        bar.set_label(colour.name)
        bar.outline.set_visible(False)
        count = len(runs.good) - int(np.count_nonzero(runs.good))
        grey = f", {count} without figures grey" if count else ""
        axes.set_title(f"{runs.name}: {len(runs.good)} runs{grey}", pad=14.0, parse_math=False)
        return with_fixed_layout(figure)


def scatter_matrix(runs: Table) -> Figure:
    """Every pair of variables and figures; of more than eight, every figure over every other column."""
    columns = _columns(runs)
    figures = [column for column in columns if column.is_figure]
    few = len(columns) <= 8
    down, across = (columns[1:], columns[:-1]) if few else (figures, columns)
    colour = figures[0] if figures else columns[-1]
    with drawing_style():
        size = (max(5.0, 1.75 * len(across) + 1.0), max(3.6, 1.75 * len(down) + 0.6))
        figure = Page(figsize=size, layout="constrained")
        panels = figure.subplots(len(down), len(across), squeeze=False, sharex="col", sharey="row")
        for row, ordinate in enumerate(down):
            for place, abscissa in enumerate(across):
                axes = panels[row, place]
                if (few and place > row) or abscissa is ordinate:
                    axes.set_axis_off()
                    continue
                axes.scatter(
                    abscissa.values[runs.good],
                    ordinate.values[runs.good],
                    c=colour.values[runs.good],
                    cmap=COLOURS,
                    norm=Normalize(*colour.ends),
                    s=9.0,
                    linewidths=0.0,
                    alpha=0.8,
                )
                _tick(axes, abscissa, along="x")
                _tick(axes, ordinate, along="y")
                if row == len(down) - 1:
                    axes.set_xlabel(_broken(abscissa.name), fontsize=8.5)
                if place == 0:
                    axes.set_ylabel(_broken(ordinate.name), fontsize=8.5)
        title = f"{runs.name}: {int(np.count_nonzero(runs.good))} runs, colour by {colour.name}"
        figure.suptitle(title, x=0.01, ha="left", fontsize=11.0, fontweight="bold", parse_math=False)
        return with_fixed_layout(figure)


def main_effects(runs: Table) -> Figure:
    """The mean of every figure over the values of every variable, and the share of its variance that this explains.

    The share is the variance of the means over the variance of the runs, the correlation ratio (Fisher, 1925): for
    independent variables an estimate of the first-order index of Sobol (1993). Bars are the means' standard errors.
    """
    columns = _columns(runs)
    variables = [column for column in columns if not column.is_figure]
    figures = [column for column in columns if column.is_figure]
    with drawing_style():
        size = (max(5.0, 1.9 * len(variables) + 1.0), max(3.6, 1.9 * len(figures) + 0.8))
        figure = Page(figsize=size, layout="constrained")
        panels = figure.subplots(len(figures), len(variables), squeeze=False, sharey="row")
        for row, ordinate in enumerate(figures):
            for place, variable in enumerate(variables):
                axes = panels[row, place]
                _effect(axes, variable, ordinate, runs.good)
                _tick(axes, variable, along="x")
                if row == len(figures) - 1:
                    axes.set_xlabel(_broken(variable.name), fontsize=8.5)
                if place == 0:
                    axes.set_ylabel(_broken(f"mean {ordinate.name}"), fontsize=8.5)
        title = f"{runs.name}: main effects over {int(np.count_nonzero(runs.good))} runs; share of the variance in each"
        figure.suptitle(title, x=0.01, ha="left", fontsize=11.0, fontweight="bold", parse_math=False)
        return with_fixed_layout(figure)


DRAWINGS: Mapping[str, Callable[[Table], Figure]] = {
    "parallel": parallel_coordinates,
    "scatter": scatter_matrix,
    "effects": main_effects,
}
"""By the options of `bladewright sweep`."""


def run_rows(runs: Table) -> list[tuple[str, ...]]:
    """Lowest, mean and highest value of every figure."""
    found = [(runs.heading(name), values[np.isfinite(values)]) for name, values in runs.figures.items()]
    return [(name, *(f"{of(values):.5g}" for of in (np.min, np.mean, np.max))) for name, values in found if len(values)]


def effect(variable: Reals, figure: Reals, groups: Sequence[Reals | Flags]) -> tuple[Reals, Reals, Reals, float]:
    """Mean abscissa, mean and standard error of a figure in each group of runs, and the share of its variance."""
    at = np.array([np.mean(variable[group]) for group in groups])
    means = np.array([np.mean(figure[group]) for group in groups])
    counts = np.array([np.count_nonzero(group) for group in groups])
    spread = np.array([np.std(figure[group], ddof=1) if np.count_nonzero(group) > 1 else 0.0 for group in groups])
    whole = float(np.var(figure))
    between = float(np.sum(counts * (means - np.mean(figure)) ** 2) / np.sum(counts))
    return at, means, spread / np.sqrt(counts), between / whole if whole > 0.0 else 0.0


def grouped(values: Reals) -> list[Flags]:
    """Runs of equal values, or, of more than twice `BINS` different ones, of equal parts of the range."""
    different = np.unique(values)
    if len(different) <= 2 * BINS:
        return [values == value for value in different]
    edges = np.linspace(different[0], different[-1], BINS + 1)
    places = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, BINS - 1)
    return [places == place for place in range(BINS) if np.any(places == place)]


def _effect(axes: Axes, variable: Column, figure: Column, good: Flags) -> None:
    known = good & np.isfinite(figure.values)
    x, y = variable.values[known], figure.values[known]
    if not len(x):
        return
    at, means, errors, share = effect(x, y, grouped(x))
    axes.axhline(float(np.mean(y)), color=SOFT, linewidth=0.9, linestyle=(0, (4, 2)))
    axes.errorbar(at, means, yerr=errors, color=BLUE, ecolor=ORANGE, marker="o", markersize=3.5, linewidth=1.4)
    axes.set_title(f"{100.0 * share:.0f} %", fontsize=9.0, pad=3.0)


def _columns(runs: Table) -> list[Column]:
    """Variables, then figures; of more than `MOST_AXES`, the first ones of both."""
    variables = [_of_choices(runs.heading(name), values) for name, values in runs.parameters.items()]
    figures = [
        Column(name=runs.heading(name), values=np.asarray(values, dtype=np.float64), is_figure=True)
        for name, values in runs.figures.items()
    ]
    room = max(MOST_AXES - len(variables), MOST_AXES // 2)
    return [*variables[: MOST_AXES - min(len(figures), room)], *figures[:room]]


def _of_choices(name: str, values: Sequence[Any]) -> Column:
    if all(isinstance(value, int | float) for value in values):
        return Column(name=name, values=np.array(values, dtype=np.float64), is_figure=False)
    words = [str(value) for value in values]
    choices = tuple(dict.fromkeys(words))
    places = {word: place for place, word in enumerate(choices)}
    return Column(name=name, values=np.array([float(places[word]) for word in words]), choices=choices, is_figure=False)


def _height(column: Column, values: Reals) -> Reals:
    low, high = column.ends
    return (values - low) / (high - low)


def _parallel_axes(axes: Axes, columns: Sequence[Column]) -> None:
    """An upright axis for every column, with ticks of its own."""
    axes.set_xlim(-0.3, len(columns) - 0.7)
    axes.set_ylim(-0.04, 1.04)
    axes.grid(visible=False)
    for side in axes.spines.values():
        side.set_visible(False)
    axes.set_yticks([])
    axes.set_xticks(range(len(columns)), [_broken(column.name) for column in columns], fontsize=8.5)
    axes.tick_params(axis="x", length=0.0)
    for place, column in enumerate(columns):
        axes.axvline(
            place, color=INK if column.is_figure else SOFT, linewidth=1.2 if column.is_figure else 0.9, zorder=3
        )
        low, high = column.ends
        for tick in column.ticks:
            height = float((tick - low) / (high - low))
            box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.6}
            axes.annotate(
                column.label(tick),
                (place, height),
                (3.0, 0.0),
                textcoords="offset points",
                fontsize=7.5,
                va="center",
                bbox=box,
                zorder=4,
            )


def _tick(axes: Axes, column: Column, *, along: Literal["x", "y"]) -> None:
    """Few ticks; words where the values are choices."""
    own: Any = axes.xaxis if along == "x" else axes.yaxis
    axes.tick_params(axis="both", labelsize=7.5)
    axes.grid(color=PALE)
    if column.choices:
        own.set_ticks(range(len(column.choices)), column.choices)
    else:
        axes.locator_params(axis=along, nbins=3)


def _broken(name: str) -> str:
    """A name over two lines where it is long: its unit below it."""
    words, sign, unit = name.rpartition(" [")
    return f"{words}\n[{unit}" if sign and len(name) > 12 else name
