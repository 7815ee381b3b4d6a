"""Fronts of searches: their members among all designs, over two or three aims, or in parallel coordinates."""

from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bladewright.nurbs.basis import Reals
from bladewright.views.pages import Page, checked_path, with_fixed_layout, write_figure
from bladewright.views.runs import Table, parallel_coordinates
from bladewright.views.style import INK, RED, SERIES, SHEET_DPI, SOFT, drawing_style, label_axes

NAMED = 12
"""Most members that carry the numbers of their runs: more cover each other."""
MARKS = ("o", "D", "s", "^", "v", "P")
"""Marks of fronts in one picture, in the order of use."""
Labels = Sequence[str]


class Front(Protocol):
    """What is drawn of a Pareto set."""

    @property
    def name(self) -> str:
        """Of the study."""

    @property
    def members(self) -> tuple[int, ...]:
        """Numbers of the runs (m,)."""

    @property
    def aims(self) -> Sequence[str]:
        """What is to be small or large, k figures with their units."""

    @property
    def table(self) -> Reals:
        """(m, k or more) figures of the members, the aims' first."""

    @property
    def others(self) -> Reals:
        """(n, k or more) figures of all other designs that keep the constraints."""

    @property
    def start(self) -> Reals:
        """(k,) figures that the search began with."""

    @property
    def best(self) -> Table:
        """The members with their parameters."""


def draw_fronts(fronts: Sequence[Front], path: str | Path, labels: Labels = ()) -> None:
    """Draw fronts of the same aims as PNG, SVG or PDF, by the ending of `path`; FileError where that cannot be."""
    checked_path(path)
    with drawing_style():
        write_figure(front_figure(fronts, labels), path, SHEET_DPI)


def front_figure(fronts: Sequence[Front], labels: Labels = ()) -> Figure:
    """The members of fronts among the other designs: over two aims, in space and pairs over three, else side by side.

    With more than three aims, or one, it is the first front alone in parallel coordinates.
    """
    aims = fronts[0].aims
    names = [*labels, *(front.name for front in fronts[len(labels) :])]
    if len(aims) not in {2, 3}:
        return parallel_coordinates(fronts[0].best)
    with drawing_style():
        if len(aims) == 2:
            figure = Page(figsize=(8.0, 5.6), layout="constrained")
            _pair(figure.add_subplot(), fronts, names, (0, 1))
        else:
            figure = Page(figsize=(12.0, 9.6), layout="constrained")
            space: Any = figure.add_subplot(2, 2, 1, projection="3d")
            _space(space, fronts, names)
            for place, pair in enumerate(combinations(range(3), 2), start=2):
                _pair(figure.add_subplot(2, 2, place), fronts, names, pair, legend=False)
        figure.suptitle(_title(fronts), x=0.01, ha="left", fontsize=11.0, fontweight="bold", parse_math=False)
        return with_fixed_layout(figure)


def _title(fronts: Sequence[Front]) -> str:
    if len(fronts) > 1:
        return fronts[0].name
    front = fronts[0]
    count = len(front.members) + len(front.others)
    return f"{front.name}: {len(front.members)} Pareto optimal of {count} designs that keep the constraints"


def _pair(axes: Axes, fronts: Sequence[Front], names: Labels, pair: tuple[int, int], *, legend: bool = True) -> None:
    """The members over two of the aims."""
    first, second = pair
    flat = len(fronts[0].aims) == 2
    for front in fronts:
        axes.plot(*front.others[:, [first, second]].T, ".", color=SOFT, markersize=3.0, alpha=0.45, zorder=1)
    for place, (front, name) in enumerate(zip(fronts, names, strict=True)):
        colour = SERIES[place % len(SERIES)]
        line = "-" if flat and len(front.members) <= 40 else "none"
        axes.plot(
            *front.table[:, [first, second]].T,
            color=colour,
            linestyle=line,
            linewidth=0.8,
            marker=MARKS[place % len(MARKS)],
            markersize=4.5,
            label=f"{name} ({len(front.members)})",
            zorder=3,
        )
        if flat and len(fronts) == 1 and len(front.members) <= NAMED:
            for number, at in zip(front.members, front.table[:, [first, second]], strict=True):
                axes.annotate(str(number), at, (5.0, 4.0), textcoords="offset points", fontsize=8.0, color=INK)
    axes.plot(*fronts[0].start[[first, second]], "*", color=RED, markersize=11.0, label="start", zorder=4)
    label_axes(axes, "", fronts[0].aims[first], fronts[0].aims[second])
    if legend:
        axes.plot([], [], ".", color=SOFT, label="other designs")
        axes.legend()


def _space(axes: Any, fronts: Sequence[Front], names: Labels) -> None:
    """The members over all three aims."""
    for place, (front, name) in enumerate(zip(fronts, names, strict=True)):
        colour, mark = SERIES[place % len(SERIES)], MARKS[place % len(MARKS)]
        at: Any = front.table[:, :3].T
        axes.scatter(*at, color=colour, marker=mark, s=18.0, label=f"{name} ({len(front.members)})", depthshade=False)
    own: Any = np.array(fronts[0].start[:3])
    axes.scatter(*own, color=RED, marker="*", s=90.0, label="start", depthshade=False)
    axes.set_xlabel(fronts[0].aims[0], fontsize=8.5)
    axes.set_ylabel(fronts[0].aims[1], fontsize=8.5)
    axes.set_zlabel(fronts[0].aims[2], fontsize=8.5)
    axes.tick_params(labelsize=7.5)
    axes.legend(loc="upper left")


def front_rows(front: Front) -> list[tuple[str, ...]]:
    """Lowest and highest value of every aim in the set."""
    return [
        (name, f"{values.min():.5g}", f"{values.max():.5g}")
        for name, values in zip(front.aims, front.table.T, strict=False)
        if len(values)
    ]
