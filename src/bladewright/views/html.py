"""Parts of HTML that notebooks and reports are made of: tables, images and their frame."""

from base64 import b64encode
from collections.abc import Sequence
from html import escape
from io import BytesIO

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from bladewright.views.style import INK, PALE, SOFT, drawing_style

Rows = Sequence[Sequence[str]]
"""Cells of a table, row by row; a row of one cell is a heading."""
CELL = "padding:1px 14px 1px 0;vertical-align:top;border:0"


def table(rows: Rows, header: Sequence[str] = ()) -> str:
    """A table: names and what they are, or under a header columns of figures, which are aligned to the right."""
    columns = max((len(row) for row in rows), default=1)
    value = f"{CELL};text-align:{'right' if header else 'left'};font-variant-numeric:tabular-nums"

    def line(cells: Sequence[str], tag: str) -> str:
        if len(cells) == 1:
            heading = f"{CELL};text-align:left;padding-top:6px"
            return f'<tr><th colspan="{columns}" style="{heading}">{escape(cells[0])}</th></tr>'
        parts = [
            f'<{tag} style="{value if index else f"{CELL};text-align:left"}">{escape(cell)}</{tag}>'
            for index, cell in enumerate(cells)
        ]
        return f"<tr>{''.join(parts)}</tr>"

    head = f"<thead>{line(header, 'th')}</thead>" if header else ""
    return (
        f'<table style="border-collapse:collapse;font-size:13px;background:white;color:{INK}">{head}'
        f"<tbody>{''.join(line(row, 'td') for row in rows)}</tbody></table>"
    )


def with_headings(rows: Sequence[tuple[str, str]]) -> Rows:
    """Names and values, of which a name without a value becomes a heading."""
    return [row if row[1] else row[:1] for row in rows]


def image(figure: Figure, title: str) -> str:
    """A figure as an image in the page, of lines and letters at any size."""
    picture = BytesIO()
    FigureCanvasAgg(figure)
    with drawing_style():
        figure.savefig(picture, format="svg", metadata={"Date": None})
    data = b64encode(picture.getvalue()).decode()
    return f'<img alt="{escape(title)}" style="max-width:100%" src="data:image/svg+xml;base64,{data}">'


def frame(title: str, remark: str, picture: str, tables: str, further: str = "") -> str:
    """What a notebook shows of a result: its name and a remark, a picture, tables beside it, and further ones below."""
    cells = f'<div style="flex:1 1 420px;max-width:600px">{picture}</div><div>{tables}</div>'
    return (
        f'<div style="background:white;color:{INK};border:1px solid {PALE};padding:8px;font-family:sans-serif">'
        f'<div style="font-size:15px"><b>{escape(title)}</b> <span style="color:{SOFT}">{escape(remark)}</span></div>'
        f'<div style="display:flex;flex-wrap:wrap;gap:16px;align-items:flex-start">{cells}</div>{further}</div>'
    )
