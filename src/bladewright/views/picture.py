"""The sheet of a blade or a section, and views of a blade or a passage alone."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from bladewright.blade.design.row_design import RowDesign
from bladewright.blade.exact.exact_blade import MIDDLE
from bladewright.blade.native.blade import Blade
from bladewright.designs import Design
from bladewright.domain.passage import Passage
from bladewright.domain.section import SectionPassage
from bladewright.errors import DesignError
from bladewright.section.section import Section
from bladewright.views.along_the_blade import (
    draw_camber_angle,
    draw_flow_area,
    draw_lean,
    draw_throat,
    draw_wrap,
    has_throat,
)
from bladewright.views.body import BladedBody, body_sheet
from bladewright.views.distributions import draw_curvature, draw_smoothness, draw_thickness
from bladewright.views.law_charts import draw_strip, draw_thickness_laws, in_strips, law_charts, strip_height
from bladewright.views.meridional import draw_meridional
from bladewright.views.pages import Page, checked_path, draw_header, rows, with_fixed_layout, write_figure
from bladewright.views.passage import passage_sheet, section_passage_sheet
from bladewright.views.sections import (
    distinct,
    draw_edge,
    draw_edges,
    draw_feet,
    draw_neighbour,
    draw_sections,
    pitch_of,
)
from bladewright.views.solid import draw_passage_solid, draw_solid, viewpoints
from bladewright.views.style import SHEET_DPI, VIEW_DPI, WALLS, drawing_style, in_unit, per_metre, span_name, unit_name

SPANS, FEW_SPANS = (0.0, 0.25, 0.5, 0.75, 1.0), (0.0, 0.5, 1.0)
"""Span fractions of the sections drawn on top of each other, and of those in panels where more would hide each
other."""
PASSAGE_VIEW = (1250, 1000)
"""Largest width and height of a view of a passage alone [pixels]: what its figure of 10 x 8 inches shows."""
Built = Blade | Section | Passage | SectionPassage | BladedBody
"""What a design builds, and the flow domain around it."""


def picture(design: Design | Built, path: str | Path, *, blade: Built | None = None) -> None:
    """Draw a design as PNG, SVG or PDF, by the ending of `path`: sections, curvature, channel, laws and a 3D view.

    `blade` is what the design builds, where that is already known; `design` may also be the built object itself (the
    laws of a section are then unknown and not drawn). Either may be a flow passage: its duct, its unwrapped walls, its
    figures and a 3D view are drawn. The file is written whole or not at all. Raises FileError where the ending is
    another or the path cannot be written, DesignError where the design cannot be built.
    """
    checked_path(path)
    figure = sheet(design, blade)
    with drawing_style():
        write_figure(figure, path, SHEET_DPI)


def blade_view(blade: Blade | RowDesign, path: str | Path) -> None:
    """Draw the blade in its row on the hub, shaded, as PNG, SVG or PDF by the ending of `path`.

    Raises FileError where the ending is another or the path cannot be written.
    """
    checked_path(path)
    if not isinstance(blade, Blade | RowDesign):
        raise DesignError(
            f"a {type(blade).__name__} was given: only a blade has a 3D view; draw the one that "
            "prismatic(section, span) makes"
        )
    built = blade if isinstance(blade, Blade) else blade.build()
    with drawing_style(built.design.length_unit):
        figure = Figure(figsize=(10.0, 8.0), layout="constrained")
        draw_solid(figure.add_subplot(), built, neighbours=None, width=1250)
        write_figure(figure, path, VIEW_DPI)


def passage_view(passage: Passage, path: str | Path) -> None:
    """Draw a flow passage as a see-through body with the blade in it, as PNG, SVG or PDF by the ending of `path`.

    Raises FileError where the ending is another or the path cannot be written.
    """
    checked_path(path)
    if not isinstance(passage, Passage):
        raise DesignError(
            f"a {type(passage).__name__} was given: only a passage has this view; draw the one that "
            "passage(blade) makes"
        )
    with drawing_style(passage.blade.design.length_unit):
        figure = Figure(figsize=(10.0, 8.0), layout="constrained")
        draw_passage_solid(figure.add_subplot(), passage, size=PASSAGE_VIEW)
        write_figure(figure, path, VIEW_DPI)


def sheet(design: Design | Built, blade: Built | None = None) -> Figure:
    """The figure that `picture` writes."""
    known = design if isinstance(design, Design) else None
    built: Any = design if known is None else (blade or known.build())
    with drawing_style(_unit_of(known, built)):
        match built:
            case Passage():
                figure = passage_sheet(built)
            case SectionPassage():
                figure = section_passage_sheet(known, built)
            case Section():
                figure = _section_sheet(known, built)
            case Blade():
                figure = _blade_sheet(built)
            case _:
                figure = body_sheet(built)
        return with_fixed_layout(figure)


def _unit_of(design: Any, built: Any) -> str:
    """The unit of the design's lengths; millimetres where a section is drawn of which no design is known."""
    match built:
        case Blade():
            design = built.design
        case Section() | SectionPassage():
            pass
        case _:
            design = built.blade.design
    return "mm" if design is None else str(design.length_unit)


def _blade_sheet(blade: Blade) -> Figure:
    sections = distinct([blade.section(v) for v in blade.exact.shown_spans(SPANS)])
    few = [section for section in sections if section.span in FEW_SPANS]
    middle = sections[len(sections) // 2]
    pitch = pitch_of(blade, middle)
    strips = in_strips(law_charts(blade.design, few, blade.design.law_ends))
    along = [draw_camber_angle, draw_wrap, *([draw_flow_area, draw_throat] if has_throat(blade) else []), draw_lean]
    heights = [5.4, 4.6, 4.4, 3.6, 4.4, *map(strip_height, strips)]
    figure = Page(figsize=(16.0, sum(heights) + 0.9))
    header = _blade_header(blade, middle)
    if len(sections) == 1:
        header.insert(1, "one section all along the span")
    draw_header(figure, blade.name, blade.description, header)
    top, centre, shape, edges, smooth, *bottom = rows(figure, *heights)
    axes = top.subplots(1, 4, width_ratios=[1.2, 1.2, 1.0, 1.0])
    for place, view, title in zip(axes, viewpoints(blade), ("Blade with neighbours", "The other side"), strict=False):
        draw_solid(place, blade, neighbours=2, width=640, view=view)
        place.set_title(title)
    draw_sections(axes[2], sections, blade.design.law_ends)
    draw_feet(axes[2], blade, sections)
    draw_neighbour(axes[3], middle, pitch, _span_title(middle, blade.design.law_ends), blade)
    for place, draw in zip(shape.subplots(1, len(along)), along, strict=True):
        draw(place, blade, sections)
    axes = centre.subplots(1, 3)
    draw_meridional(axes[0], blade)
    draw_curvature(axes[1], few, blade.design.law_ends)
    draw_thickness(axes[2], sections, blade.design.law_ends)
    draw_edges(edges, few, blade.design.law_ends)
    draw_smoothness(smooth, few, blade.design.law_ends)
    for strip, charts in zip(bottom, strips, strict=True):
        draw_strip(strip, charts)
    return figure


def _section_sheet(design: Any, section: Section) -> Figure:
    from bladewright.section.checks import UNITS

    pitch = None
    if design is not None and design.pitch is not None:
        pitch = design.pitch * UNITS[design.length_unit] * per_metre()
    figure = Page(figsize=(16.0, 15.4))
    name, description = (design.name, design.description) if design is not None else ("section", "")
    draw_header(figure, name, description, _section_header(section, pitch))
    top, bottom, smooth = rows(figure, 6.0, 4.6, 4.4)
    axes = top.subplots(1, 3, width_ratios=[1.6, 1.0, 1.0])
    draw_neighbour(axes[0], section, pitch, "Section")
    draw_edge(axes[1], section, trailing=False)
    draw_edge(axes[2], section, trailing=True)
    has_laws = design is not None and bool(design.thickness_laws)
    axes = bottom.subplots(1, 3 if has_laws else 2)
    draw_curvature(axes[0], [section])
    draw_thickness(axes[1], [section])
    if has_laws:
        draw_thickness_laws(axes[2], design, [section], WALLS)
    draw_smoothness(smooth, [section])
    return figure


def _blade_header(blade: Blade, middle: Section) -> list[str]:
    columns, rows = blade.knots.poles
    count, place = blade.design.blade_count, _span_title(middle, blade.design.law_ends)
    solidity = float(blade.report([middle.span]).solidity[0])
    return [
        "linear cascade" if count is None else f"{count} blade{'s' if count > 1 else ''}",
        f"mean chord {in_unit(blade.chord)}",
        f"solidity at {place.lower()} {solidity:.3g}",
        f"{columns} x {rows} poles a side",
        f"error {blade.error:.1e} of the chord",
        "all checks passed" if blade.conformance.kept else "a check failed",
    ]


def _span_title(section: Section, ends: tuple[str, str]) -> str:
    """The title that says at which span fraction a section lies."""
    return "Mid span" if section.span == MIDDLE else span_name(section.span, ends).capitalize()


def _section_header(section: Section, pitch: float | None) -> list[str]:
    chord = section.chord * per_metre()
    header = [
        f"chord {chord:.4g} {unit_name()}",
        f"area {section.area * per_metre() ** 2:.4g} {unit_name()}²",
        f"perimeter {in_unit(section.perimeter)}",
        "stagger {:.3g}°, metal angles {:.3g}° and {:.3g}°".format(
            *(np.degrees(each) for each in (section.stagger, section.metal_angle_in, section.metal_angle_out))
        ),
        f"poles {' and '.join(str(len(curve.control_points)) for curve in section.curves.values())}",
    ]
    return [*header, f"chord / pitch {chord / pitch:.3g}"] if pitch is not None else header
