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

if TYPE_CHECKING:
    from matplotlib.figure import Figure


HEADER_LETTERS = 150
"""letters of the sheet's first line"""


def rows(figure: Figure, *heights: float) -> Sequence[SubFigure]:
    """A strip across the figure for each height, from the top down."""
    return list(np.atleast_1d(cast(Any, figure.subfigures(len(heights), 1, height_ratios=heights))))


def columns(strip: SubFigure, *widths: float) -> Sequence[SubFigure]:
    """A part of the strip for each width, from left to right."""
    return list(np.atleast_1d(cast(Any, strip.subfigures(1, len(widths), width_ratios=widths))))


def draw_header(figure: Figure, name: str, description: str, figures: list[str]) -> None:
    """Writes the head of a sheet, and keeps its place clear."""
    inch = 1.0 / figure.get_figheight()
    rect = (0.0, 0.0, 1.0, 1.0 - 0.85 * inch)
    figure.set_layout_engine(ConstrainedLayoutEngine(w_pad=0.12, h_pad=0.10, rect=rect))
    place: dict[str, Any] = {"ha": "left", "va": "baseline"}
    name = shorten(name, HEADER_LETTERS // 3, placeholder=" …")
    description = shorten(description, HEADER_LETTERS - 2 * len(name), placeholder=" …")
    figure.text(0.012, 1.0 - 0.42 * inch, name, fontsize=20.0, fontweight="bold", parse_math=False, **place)
    figure.text(0.012, 1.0 - 0.72 * inch, "   ·   ".join(figures), fontsize=11.0, **place)
    place["ha"] = "right"
    figure.text(0.988, 1.0 - 0.42 * inch, description, fontsize=11.0, parse_math=False, **place)


def with_fixed_layout(figure: Figure) -> Figure:
    """The figure, its panels laid out for good: it would be laid out anew, twice, when it is written."""
    FigureCanvasAgg(figure)
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.execute(figure)
    figure.set_layout_engine(None)
    return figure


SUFFIXES = (".png", ".svg", ".pdf")
_UNDATED = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}


def checked_path(path: str | Path) -> Path:
    """The path, if a picture can be written there; raises FileError where its suffix or its directory will not do."""
    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        kind = f"ends in '{path.suffix}'" if path.suffix else "has no ending"
        raise FileError(f"'{path}' {kind}: a picture is drawn as {', '.join(SUFFIXES)}; end its name in one of them")
    if path.is_dir():
        raise FileError(f"'{path}' is a directory: name the picture to write")
    if not path.parent.is_dir():
        raise FileError(f"'{path}' cannot be written: there is no directory '{path.parent}'; make it first")
    return path


def write_figure(figure: "Figure", path: str | Path, dots: int) -> None:
    """Writes a figure as PNG, SVG or PDF by the path's suffix, `dots` to an inch; raises FileError if that fails.

    The same figure gives the same bytes, whenever it is written.
    """
    path = checked_path(path)
    suffix = path.suffix.lower()
    picture = io.BytesIO()
    FigureCanvasAgg(figure)
    figure.savefig(picture, format=suffix[1:], dpi=dots, metadata=_UNDATED[suffix])
    with atomic_write(path) as unfinished:
        Path(unfinished).write_bytes(picture.getvalue())
