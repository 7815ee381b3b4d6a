"""Pages: a head with the name and key figures, and rows of panels under it."""

from collections.abc import Sequence
from textwrap import shorten
from typing import Any, cast

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure, SubFigure
from matplotlib.layout_engine import ConstrainedLayoutEngine

LONGEST = 150
"""letters of the sheet's first line"""


def rows(figure: Figure, *heights: float) -> Sequence[SubFigure]:
    """A strip across the figure for each height, from the top down."""
    return list(np.atleast_1d(cast(Any, figure.subfigures(len(heights), 1, height_ratios=heights))))


def columns(strip: SubFigure, *widths: float) -> Sequence[SubFigure]:
    """A part of the strip for each width, from left to right."""
    return list(np.atleast_1d(cast(Any, strip.subfigures(1, len(widths), width_ratios=widths))))


def headed(figure: Figure, name: str, description: str, figures: list[str]) -> None:
    """Writes the head of a sheet, and keeps its place clear."""
    inch = 1.0 / figure.get_figheight()
    rect = (0.0, 0.0, 1.0, 1.0 - 0.85 * inch)
    figure.set_layout_engine(ConstrainedLayoutEngine(w_pad=0.12, h_pad=0.10, rect=rect))
    place: dict[str, Any] = {"ha": "left", "va": "baseline"}
    name = shorten(name, LONGEST // 3, placeholder=" …")
    description = shorten(description, LONGEST - 2 * len(name), placeholder=" …")
    figure.text(0.012, 1.0 - 0.42 * inch, name, fontsize=20.0, fontweight="bold", parse_math=False, **place)
    figure.text(0.012, 1.0 - 0.72 * inch, "   ·   ".join(figures), fontsize=11.0, **place)
    place["ha"] = "right"
    figure.text(0.988, 1.0 - 0.42 * inch, description, fontsize=11.0, parse_math=False, **place)


def laid_out(figure: Figure) -> Figure:
    """The figure, its panels laid out for good: it would be laid out anew, twice, when it is written."""
    FigureCanvasAgg(figure)
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.execute(figure)
    figure.set_layout_engine(None)
    return figure
