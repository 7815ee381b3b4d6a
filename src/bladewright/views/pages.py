"""Pages: a header with the name and key figures, rows of panels under it, and the file they are written to."""

import io
from collections.abc import Sequence
from pathlib import Path
from textwrap import shorten
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure, SubFigure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from bladewright.atomic_write import atomic_write
from bladewright.errors import FileError
from bladewright.views.style import drawing_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure


HEADER_LETTERS = 150
"""Most characters in the first line of a sheet, name and description together: what fits a width of 16 inches."""

HEADER_HEIGHT = 0.85
"""Height kept clear for the header [inches]: two lines of text with their margins."""
SUFFIXES = (".png", ".svg", ".pdf")
"""Endings of the formats in which a picture can be written."""
_UNDATED: dict[str, dict[str, Any]] = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
"""Metadata without a date, so that the same figure gives the same bytes."""


NOTEBOOK_DPI = 80
"""Pixels per inch of a page in a notebook: one of 16 inches is as wide as a window, and half a megabyte."""


class Page(Figure):
    """A figure that a notebook shows as the last line of a cell, also where pyplot was never loaded."""

    def _repr_png_(self) -> bytes:
        picture = io.BytesIO()
        FigureCanvasAgg(self)
        with drawing_style():
            self.savefig(picture, format="png", dpi=NOTEBOOK_DPI)
        return picture.getvalue()


def rows(figure: Figure, *heights: float) -> Sequence[SubFigure]:
    """Strips across the figure with these relative heights, from the top down."""
    return list(np.atleast_1d(cast(Any, figure.subfigures(len(heights), 1, height_ratios=heights))))


def columns(strip: SubFigure, *widths: float) -> Sequence[SubFigure]:
    """Parts of a strip with these relative widths, from left to right."""
    return list(np.atleast_1d(cast(Any, strip.subfigures(1, len(widths), width_ratios=widths))))


def draw_header(figure: Figure, name: str, description: str, figures: list[str]) -> None:
    """Write the header of a sheet, and keep the panels below it."""
    inch = 1.0 / figure.get_figheight()
    rect = (0.0, 0.0, 1.0, 1.0 - HEADER_HEIGHT * inch)
    figure.set_layout_engine(ConstrainedLayoutEngine(w_pad=0.12, h_pad=0.10, rect=rect))
    place: dict[str, Any] = {"ha": "left", "va": "baseline"}
    name = shorten(name, HEADER_LETTERS // 3, placeholder=" …")
    description = shorten(description, HEADER_LETTERS - 2 * len(name), placeholder=" …")
    figure.text(0.012, 1.0 - 0.42 * inch, name, fontsize=20.0, fontweight="bold", parse_math=False, **place)
    figure.text(0.012, 1.0 - 0.72 * inch, "   ·   ".join(figures), fontsize=11.0, **place)
    place["ha"] = "right"
    figure.text(0.988, 1.0 - 0.42 * inch, description, fontsize=11.0, parse_math=False, **place)


def with_fixed_layout(figure: Figure) -> Figure:
    """The figure with its panels laid out once; otherwise the layout engine runs twice when the figure is written."""
    FigureCanvasAgg(figure)
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.execute(figure)
    figure.set_layout_engine(None)
    return figure


def checked_path(path: str | Path) -> Path:
    """The path, where a picture can be written to it; raises FileError where its ending or its directory is wrong."""
    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        kind = f"ends in '{path.suffix}'" if path.suffix else "has no ending"
        raise FileError(f"'{path}' {kind}: a picture is drawn as {', '.join(SUFFIXES)}; end its name in one of them")
    if path.is_dir():
        raise FileError(f"'{path}' is a directory: name the picture to write")
    if not path.parent.is_dir():
        raise FileError(f"'{path}' cannot be written: there is no directory '{path.parent}'; make it first")
    return path


def write_figure(figure: "Figure", path: str | Path, dpi: int) -> None:
    """Write a figure as PNG, SVG or PDF by the path's ending, with `dpi` pixels per inch in a PNG.

    The same figure gives the same bytes, whenever it is written. Raises FileError where it cannot be written.
    """
    path = checked_path(path)
    suffix = path.suffix.lower()
    picture = io.BytesIO()
    FigureCanvasAgg(figure)
    figure.savefig(picture, format=suffix[1:], dpi=dpi, metadata=_UNDATED[suffix])
    with atomic_write(path) as unfinished:
        Path(unfinished).write_bytes(picture.getvalue())
