"""Tables as text in a panel: columns as wide as what stands in them."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

from bladewright.views.style import INK

Row = Sequence[str]
"""The cells of a row."""
SIZE = 9.5
"""Height of the letters [points]."""
LINE, GAP = 14.5, 13.0
"""Distance between lines, and least distance between columns [points]."""
LETTERS = FontProperties(family="DejaVu Sans")


def text_width(text: str, weight: str = "normal") -> float:
    """How wide a text is [points]."""
    font = LETTERS.copy()
    font.set_weight(weight)
    return float(TextPath((0.0, 0.0), text, size=SIZE, prop=font).get_extents().x1) if text.strip() else 0.0


def draw_text_table(
    axes: Axes,
    rows: Sequence[Row],
    *,
    align: str,
    header: Row | None = None,
    inks: Mapping[tuple[int, int], Any] = MappingProxyType({}),
) -> float:
    """Write rows of cells from the upper left corner of a panel; returns their height [points].

    `align` has "l" or "r" for each column. The header is bold, and so are rows of a name alone. `inks` are colours by
    row and column, where they differ.
    """
    axes.set_axis_off()
    lines = [*([header] if header else []), *rows]
    bold = [row is header or not any(row[1:]) for row in lines]
    widths = [
        max(text_width(row[column], "bold" if heavy else "normal") for row, heavy in zip(lines, bold, strict=True))
        for column in range(len(align))
    ]
    starts = np.cumsum([0.0, *(width + GAP for width in widths)])
    for index, row in enumerate(lines):
        for column, cell in enumerate(row):
            right = align[column] == "r"
            axes.annotate(
                cell,
                (0.0, 1.0),
                (starts[column] + (widths[column] if right else 0.0), -LINE * (index + 0.6)),
                xycoords="axes fraction",
                textcoords="offset points",
                ha="right" if right else "left",
                va="center",
                fontsize=SIZE,
                fontweight="bold" if bold[index] else "normal",
                color=inks.get((index - bool(header), column), INK),
                parse_math=False,
            )
    return LINE * (len(lines) + 0.6)
