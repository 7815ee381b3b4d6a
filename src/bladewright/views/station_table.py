"""The station table as HTML, and its quantities drawn along the span."""

from html import escape
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from bladewright.views.html import Rows, table
from bladewright.views.pages import Page, with_fixed_layout
from bladewright.views.style import BLUE, drawing_style

if TYPE_CHECKING:
    from bladewright.section.station_table import StationTable

ACROSS = 6
"""Panels in a row."""


def station_figure(stations: "StationTable") -> Figure:
    """A panel for every quantity, over the span fraction."""
    names = [name for name in stations.names if name != "span"]
    with drawing_style(stations.length_unit):
        down = -(-len(names) // ACROSS)
        figure = Page(figsize=(16.0, 2.6 * down), layout="constrained")
        panels = figure.subplots(down, ACROSS, squeeze=False, sharey=True)
        for axes, name in zip(panels.flat, names, strict=False):
            words, unit = stations.heading(name)
            axes.plot(stations.values(name), stations.span, color=BLUE, marker="o", markersize=3.0)
            axes.set_title(words.replace("_", " "), fontsize=9.5)
            axes.set_xlabel(f"[{unit}]")
        for axes in panels.flat[len(names) :]:
            axes.remove()
        for axes in panels[:, 0]:
            axes.set_ylabel("span [-]")
        return with_fixed_layout(figure)


def station_html(stations: "StationTable") -> str:
    """Quantities as rows and stations as columns, and what is said of the whole."""
    names = [name for name in stations.names if name != "span"]
    header = ("", "", *(f"{100.0 * v:.4g} %" for v in stations.span))
    rows: Rows = [
        (name.replace("_", " "), unit, *map(_figure, stations.values(own)))
        for own, (name, unit) in ((own, stations.heading(own)) for own in names)
    ]
    remarks = "".join(f'<p style="margin:4px 0">{escape(remark)}</p>' for remark in stations.remarks)
    return f"{table(rows, header)}{remarks}"


def _figure(value: float) -> str:
    return f"{value + 0.0:.5g}" if np.isfinite(value) else "flat"
