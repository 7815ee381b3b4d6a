"""The style of all pictures: colours, fonts, lines and resolutions, and what every panel has."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, cast

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.transforms import ScaledTranslation

from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

_LENGTH_UNIT: ContextVar[str] = ContextVar("length_unit", default="mm")
"""The unit of length of the picture that is being drawn."""
SHEET_DPI, VIEW_DPI = 150, 160
"""Pixels per inch of a sheet and of a single view as PNG: the smallest text, 9 points, is then about 19 pixels high."""
INK, SOFT, PALE = "#22303c", "#8a97a3", "#e4e9ee"
"""Colours of text and main lines, of auxiliary lines, and of grids and fills."""
BLUE, ORANGE, GREEN, RED, VIOLET, GREY = "#1f6f9f", "#d9822b", "#3a8f5c", "#b23a48", "#7a5ea8", "#4d4d4d"
SERIES = (BLUE, ORANGE, GREEN, RED, VIOLET, GREY)
"""Colours of lines that are told apart by nothing else, in the order of use."""
UPPER: Any = "-"
LOWER: Any = (0, (4.0, 1.6))
"""Line styles of the upper and the lower side."""
CAMBER: Any = (0, (5.0, 2.0, 1.0, 2.0))
"""Line style of camber lines."""
CONTROL_POINTS: dict[str, Any] = {
    "linestyle": ":",
    "linewidth": 0.7,
    "markersize": 4.5,
    "markerfacecolor": "white",
}
"""Style of the control polygons of laws: hollow marks on a dotted line."""
Line = tuple[Reals, Reals, Mapping[str, Any]]
"""Abscissae and ordinates of a line, and the options with which it is drawn."""
LINE_WIDTH, BAND = 1.3, 1.0
"""Width of a line, and how much wider one is for each that lies on it [points]."""
ALIKE = 3e-3
"""Difference of two lines, of their size, up to which one hides the other: less than the width of a line."""
LEGEND_BELOW = 0.45
"""Distance of a legend from the panel above it: ticks and the name of the axis stand between [inches]."""
WALLS = ("hub", "shroud")
"""Names of the ends of a blade that stands on both walls."""
_SPAN = np.array([[0.07, 0.25, 0.42], [0.12, 0.56, 0.55], [0.88, 0.44, 0.22]])
"""Red, green and blue of the sections at hub, mid-span and shroud."""

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
def drawing_style(unit: str = "mm") -> Iterator[None]:
    """Draw in this style and this unit of length in a `with` block, and restore the caller's settings afterwards."""
    with rc_context(cast(Any, _STYLE)), lengths_in(unit):
        yield


@contextmanager
def lengths_in(unit: str) -> Iterator[None]:
    """Take lengths in this unit in a `with` block."""
    token = _LENGTH_UNIT.set(unit)
    try:
        yield
    finally:
        _LENGTH_UNIT.reset(token)


def per_metre() -> float:
    """Units of length of the picture in a metre: geometry is in metres, pictures are in the design's unit."""
    return 1.0 / UNITS[_LENGTH_UNIT.get()]


def unit_name() -> str:
    """The name of that unit."""
    return _LENGTH_UNIT.get()


def in_unit(length: Any, digits: str = ".4g") -> str:
    """A length [m] in the unit of the picture, with its name."""
    return f"{float(length) * per_metre():{digits}} {unit_name()}"


def axis(name: str) -> str:
    """The name of an axis along which lengths are drawn, with their unit."""
    return f"{name} [{unit_name()}]"


def span_colour(v: float) -> tuple[float, float, float]:
    """Colour of the section at v: dark blue at the hub, green in the middle, orange at the shroud."""
    red, green, blue = (float(np.interp(v, [0.0, 0.5, 1.0], _SPAN[:, channel])) for channel in range(3))
    return red, green, blue


def span_name(v: float, ends: tuple[str, str] = WALLS) -> str:
    """The name in a legend of the section at v of a blade whose ends have these names."""
    return {0.0: ends[0], 1.0: ends[1]}.get(v, f"{100.0 * v:.3g} % span")


def draw_lines(axes: Axes, lines: Sequence[Line]) -> None:
    """Draw lines on top of each other so that all are seen."""
    for (x, y, options), band in zip(lines, bands([(x, y) for x, y, _ in lines]), strict=True):
        axes.plot(x, y, **{**options, **band})


def bands(lines: Sequence[tuple[Reals, Reals]]) -> list[dict[str, Any]]:
    """Width and paleness of lines in the order of drawing: those that coincide with later ones are wider and paler."""
    found = list[dict[str, Any]]()
    for index, (x, y) in enumerate(lines):
        over = sum(_alike(x, other_x) and _alike(y, other_y) for other_x, other_y in lines[index + 1 :])
        pale: dict[str, Any] = {"alpha": 0.45} if over else {}
        found.append({"linewidth": LINE_WIDTH + BAND * over, **pale})
    return found


def _alike(one: Reals, other: Reals) -> bool:
    """Whether two rows of numbers are the same in a drawing, linear or logarithmic."""
    if len(one) != len(other):
        return False
    size = np.sqrt(one * one)
    close = ALIKE * max(float(np.median(size)), ALIKE**2 * float(np.max(size)))
    return bool(np.allclose(one, other, rtol=ALIKE, atol=close))


def label_axes(axes: Axes, title: str, abscissa: str, ordinate: str) -> None:
    """Write the title of a panel and the names of its axes."""
    axes.set_title(title)
    axes.set_xlabel(abscissa)
    axes.set_ylabel(ordinate)


def legend_below(axes: Axes, columns: int, **options: Any) -> None:
    """Draw the legend under the panel and the name of its axis, where it covers no data."""
    inches = cast(Any, axes.figure).dpi_scale_trans
    under = axes.transAxes + ScaledTranslation(0.0, -LEGEND_BELOW, inches)
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, 0.0), bbox_transform=under, ncols=columns, **options)
