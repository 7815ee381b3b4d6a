"""The sheet of a flow passage: its body, duct, unwrapped walls and figures; of a 2D section, its curves."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bladewright.nurbs.basis import Reals
from bladewright.views.duct import INLET, OUTLET, draw_duct
from bladewright.views.pages import columns, headed, rows
from bladewright.views.passage_figures import draw_figures, figures, head, section_figures, section_head
from bladewright.views.passage_solid import draw_passage_solid
from bladewright.views.sections import COORDINATES, developed, outline
from bladewright.views.style import (
    CAMBER,
    INK,
    LOWER,
    SOFT,
    UPPER,
    span_colour,
    titled,
)
from bladewright.views.walls import draw_tightest, draw_wall

if TYPE_CHECKING:
    from bladewright.domain.passage import Passage
    from bladewright.domain.section import SectionPassage
    from bladewright.section.unified import UnifiedSection

VIEW = (900, 760)
"""of the view in space, at most [pixels]"""


def passage_sheet(passage: "Passage") -> Figure:
    """The figure of a 3D passage, not yet laid out."""
    figure = Figure(figsize=(16.0, 13.0))
    headed(figure, passage.name, passage.description, head(passage))
    top, bottom = rows(figure, 6.0, 6.0)
    # panels of their own: the legend of the duct would make the view lower
    body, duct, numbers = columns(top, 1.35, 1.0, 0.65)
    view = body.subplots()
    draw_passage_solid(view, passage, size=VIEW)
    view.set_title("Passage, see-through from outside")
    view.set_anchor("N")
    draw_duct(duct.subplots(), passage)
    draw_figures(numbers.subplots(), figures(passage))
    panels = bottom.subplots(1, 3)
    for panel, wall in zip(panels, ("hub", "shroud"), strict=False):
        draw_wall(panel, passage, wall)
    draw_tightest(panels[2], passage)
    return figure


def section_passage_sheet(design: "UnifiedSection | None", passage: "SectionPassage") -> Figure:
    """The figure of a 2D section's passage, not yet laid out; the section's design gives it its name."""
    figure = Figure(figsize=(14.0, 10.5))
    name, description = (design.name, design.description) if design is not None else ("section", "")
    headed(figure, f"{name}-passage", description, section_head(passage))
    (strip,) = rows(figure, 1.0)
    axes = strip.subplots(1, 2, width_ratios=[2.6, 1.0])
    draw_section_passage(axes[0], passage)
    draw_figures(axes[1], section_figures(passage))
    return figure


def draw_section_passage(axes: Axes, passage: "SectionPassage") -> None:
    """Draws the curves around a section [mm], its continued camber line and its neighbours."""
    section = passage.section
    colour = span_colour(section.span)
    shape, pitch = outline(section), pitch_of(passage)
    axes.fill(*shape.T, color=colour, alpha=0.14, linewidth=0.0)
    axes.plot(*shape.T, color=colour, label="section")
    for turn in (-1.0, 1.0):
        neighbour = shape + np.array([0.0, turn * pitch])
        axes.plot(*neighbour.T, color=SOFT, linewidth=0.8, label="neighbours" if turn > 0.0 else None)
    lines = {name: boundary(passage, name) for name in ("periodic_lower", "periodic_upper", "inlet", "outlet")}
    camber = (lines["periodic_lower"] + lines["periodic_upper"]) / 2.0
    axes.plot(*camber.T, color=INK, linewidth=0.8, linestyle=CAMBER, label="camber line, continued")
    for name, ink, style in (
        ("periodic_upper", INK, UPPER),
        ("periodic_lower", INK, LOWER),
        ("inlet", INLET, UPPER),
        ("outlet", OUTLET, UPPER),
    ):
        axes.plot(*lines[name].T, color=ink, linestyle=style, linewidth=1.8, label=name.replace("_", " "))
    titled(axes, f"Flow domain, pitch {pitch:.4g} mm", *COORDINATES[section.plane])
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, -0.08), ncols=4)


def pitch_of(passage: "SectionPassage") -> float:
    """Distance of neighbours [mm]."""
    return float(np.ptp(boundary(passage, "inlet")[:, 1]))


def boundary(passage: "SectionPassage", name: str) -> Reals:
    """Points (n, 2) [mm] of a curve that bounds a section's passage."""
    curve = passage.curves[name]
    low, high = curve.domain
    return developed(passage.section, curve(low + (high - low) * np.linspace(0.0, 1.0, 601)))
