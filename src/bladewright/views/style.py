"""Colours, fonts and the manner of a panel, the same on every picture."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, cast

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes

MILLIMETRES = 1e3
"""millimetres in a metre"""
INK = "#22303c"
SOFT = "#8a97a3"
PALE = "#e4e9ee"
BLUE, ORANGE, GREEN, RED = "#1f6f9f", "#d9822b", "#3a8f5c", "#b23a48"
SERIES = (BLUE, ORANGE, GREEN, RED, "#7a5ea8", "#4d4d4d")
UPPER: Any = "-"
LOWER: Any = (0, (4.0, 1.6))
"""line styles of the two sides"""
CAMBER: Any = (0, (5.0, 2.0, 1.0, 2.0))
"""line style of camber lines"""
WALLS = ("hub", "shroud")
"""the ends of a blade that stands on both walls"""
_SPAN = np.array([[0.07, 0.25, 0.42], [0.12, 0.56, 0.55], [0.88, 0.44, 0.22]])

_STYLE: dict[str, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 9.5,
    "mathtext.fontset": "dejavusans",
    "axes.titlesize": 11.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titlepad": 8.0,
    "axes.labelsize": 10.0,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "axes.edgecolor": SOFT,
    "axes.linewidth": 0.8,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": PALE,
    "grid.linewidth": 0.7,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.labelsize": 9.0,
    "ytick.labelsize": 9.0,
    "text.color": INK,
    "lines.linewidth": 1.4,
    "legend.fontsize": 9.0,
    "legend.frameon": False,
    "legend.handlelength": 2.0,
    "legend.columnspacing": 1.2,
    "legend.borderaxespad": 0.2,
    "figure.facecolor": "white",
    "svg.hashsalt": "bladewright",
}


@contextmanager
def drawing_style() -> Iterator[None]:
    """The pictures' fonts and lines inside a `with` block; the caller's own settings afterwards."""
    with rc_context(cast(Any, _STYLE)):
        yield


def span_colour(v: float) -> tuple[float, float, float]:
    """Colour of the section at v: dark blue at the hub, green in the middle, orange at the shroud."""
    red, green, blue = (float(np.interp(v, [0.0, 0.5, 1.0], _SPAN[:, channel])) for channel in range(3))
    return red, green, blue


def span_name(v: float, ends: tuple[str, str] = WALLS) -> str:
    """What a legend calls the section at v of a blade whose ends have these names."""
    return {0.0: ends[0], 1.0: ends[1]}.get(v, f"{100.0 * v:.3g} % span")


def label_axes(axes: Axes, title: str, abscissa: str, ordinate: str) -> None:
    """Names a panel and its axes."""
    axes.set_title(title)
    axes.set_xlabel(abscissa)
    axes.set_ylabel(ordinate)


def legend_below(axes: Axes, columns: int, **options: Any) -> None:
    """A legend under the panel, where it covers no data."""
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, -0.15), ncols=columns, **options)
