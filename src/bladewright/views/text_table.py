"""Tables as text in a panel: columns as wide as what stands in them."""

from collections.abc import Sequence

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


def text_width(text: str, size: float = SIZE, weight: str = "normal") -> float:
    """How wide a text is [points]."""
    font = LETTERS.copy()
    font.set_weight(weight)
    return float(TextPath((0.0, 0.0), text, size=size, prop=font).get_extents().x1) if text.strip() else 0.0


def draw_text_table(
    axes: Axes, rows: Sequence[Row], *, align: str, header: Row | None = None, inks: Sequence[object] = ()
) -> None:
    """Write rows of cells from the upper left corner of a panel: columns left ("l") or right ("r"), the header bold.

    `inks` are the colours of the first cells.
    """
    axes.set_axis_off()
    lines = [*([header] if header else []), *rows]
    widths = [max(text_width(row[column], weight="bold") for row in lines) for column in range(len(align))]
    starts = np.cumsum([0.0, *(width + GAP for width in widths)])
    for index, row in enumerate(lines):
        number = index - (1 if header else 0)
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
                fontweight="bold" if number < 0 else "normal",
                color=inks[number] if inks and column == 0 and number >= 0 else INK,
                parse_math=False,
            )
