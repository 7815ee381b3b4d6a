"""The sheet: every panel is there, named, legible and not blank."""

from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from bladewright.views.law_charts import FULL_STRIP, draw_strip, in_strips, law_charts, strip_height
from bladewright.views.pages import rows, with_fixed_layout
from bladewright.views.picture import sheet
from bladewright.views.style import drawing_style
from machines import example
from machines.stations import at_stations

AT_STATIONS = at_stations(example("core-rotor"))

PANELS = {
    "Sections with camber lines": ("{unit}", "{unit}"),
    "Mid span": ("{unit}", "{unit}"),
    "Meridional channel": ("x [{unit}]", "[{unit}]"),
    "Curvature of the sides": ("[-]", "curvature [1/{unit}]"),
    "Thickness as built": ("[-]", "thickness across the camber [{unit}]"),
    "Angles": ("angle [deg]", "span v [-]"),
    "Camber tangents": ("[% of extent]", "span v [-]"),
    "Edge radii": ("[% of length]", "span v [-]"),
    "Half thickness along": ("[-]", "half thickness [% of length]"),
}
VARYING = {"Angles": ("fan", "impeller"), "Camber tangents": ("fan",), "Edge radii": ("fan",)}
"""Panels of laws along the span, by the drawings in which one varies; constants are written."""
SECTION_PANELS = {
    "Section, pitch": ("x [{unit}]", "y [{unit}]"),
    "Leading edge, radius": ("x [{unit}]", "y [{unit}]"),
    "Trailing edge, radius": ("x [{unit}]", "y [{unit}]"),
    "Curvature of the sides": ("[-]", "curvature [1/{unit}]"),
    "Thickness as built": ("[-]", "thickness across the camber [{unit}]"),
    "Half thickness along": ("[-]", "half thickness [% of axial chord]"),
}


def test_every_panel_is_there_with_units_on_its_axes(drawn):
    for title, (abscissa, ordinate) in (SECTION_PANELS if drawn.name == "section" else PANELS).items():
        if title in VARYING and drawn.name not in VARYING[title]:
            assert not any(axes.get_title(loc="left") == title for axes in drawn.figure.axes)
            continue
        panel = drawn.panel(title)
        assert abscissa.format(unit=drawn.unit) in panel.get_xlabel()
        assert ordinate.format(unit=drawn.unit) in panel.get_ylabel()


def test_the_head_gives_name_and_key_numbers(drawn):
    head = " ".join(text.get_text() for text in drawn.figure.texts)
    assert drawn.design.name in head
    assert drawn.design.description in head
    assert "chord" in head
    if drawn.name == "section":
        assert f"chord {drawn.built.chord * drawn.per_metre:.4g} {drawn.unit}" in head
    else:
        assert f"mean chord {drawn.built.chord * drawn.per_metre:.4g} {drawn.unit}" in head
        assert "{} x {} poles a side".format(*drawn.built.knots.poles) in head
        assert f"error {drawn.built.error:.1e} of the chord" in head
        assert "all checks passed" in head


def test_radial_machines_have_a_radius_and_cascades_a_height(blade_drawn):
    ordinate = blade_drawn.panel("Meridional channel").get_ylabel()
    assert ordinate == (f"z [{blade_drawn.unit}]" if blade_drawn.name == "cascade" else "r [mm]")


def test_no_panel_is_blank(drawn):
    image = np.asarray(drawn.painted.canvas.buffer_rgba())[..., :3].min(axis=-1)
    for axes in drawn.figure.axes:
        x, y, wide, high = axes.get_window_extent().bounds
        part = image[image.shape[0] - int(y + high) : image.shape[0] - int(y), int(x) : int(x + wide)]
        assert (part < 200).mean() > 0.002, axes.get_title(loc="left")


def test_no_text_covers_another_or_leaves_the_sheet(drawn):
    assert legible_texts(drawn.painted) > 60


@pytest.mark.parametrize(
    "name",
    [
        "core-rotor",
        "radial-turbine",
        "given at stations",
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("booster-stator", "aachen-stator")),
    ],
)
def test_the_laws_of_a_design_of_any_family_are_legible(name):
    design = AT_STATIONS if name == "given at stations" else example(name)
    strips = in_strips(law_charts(design, [SimpleNamespace(span=v) for v in (0.0, 0.5, 1.0)], ("hub", "tip")))
    with drawing_style("in"):
        figure = Figure(figsize=(16.0, sum(map(strip_height, strips))), layout="constrained")
        for strip, charts in zip(rows(figure, *map(strip_height, strips)), strips, strict=True):
            assert sum(chart.width for chart in charts) <= FULL_STRIP + 2.0
            draw_strip(strip, charts)
        with_fixed_layout(figure).canvas.draw()
    assert legible_texts(figure) > 20


def legible_texts(figure):
    """How many texts a figure has, none of which covers another or leaves the sheet."""
    canvas = figure.canvas
    assert isinstance(canvas, FigureCanvasAgg)
    renderer = canvas.get_renderer()
    boxes = [(text.get_text(), text.get_window_extent(renderer)) for text in texts_of(figure)]
    width, height = canvas.get_width_height()
    for name, box in boxes:
        assert box.x0 >= 0.0, name
        assert box.x1 <= width, name
        assert box.y0 >= 0.0, name
        assert box.y1 <= height, name
    for (first, one), (second, other) in combinations(boxes, 2):
        overlap = min(one.x1, other.x1) - max(one.x0, other.x0), min(one.y1, other.y1) - max(one.y0, other.y0)
        assert min(overlap) <= 1.0, (first, second)  # a pixel: boxes are rounded outwards
    return len(boxes)


def test_no_legend_covers_a_panel(drawn):
    renderer = drawn.painted.canvas.get_renderer()
    panels = [axes.get_window_extent(renderer) for axes in drawn.figure.axes]
    legends = [axes.get_legend() for axes in drawn.figure.axes if axes.get_legend() is not None]
    assert legends
    for legend in legends:
        box = legend.get_window_extent(renderer)
        assert not any(box.overlaps(panel) for panel in panels)


def texts_of(figure):
    """Every text that is drawn: ticks are made beyond their axis' limits too, and on axes that are off."""
    found = list(figure.texts)
    for axes in figure.axes:
        legend = axes.get_legend()
        found += [axes._left_title, *axes.texts, *(legend.get_texts() if legend else [])]
        for axis in (axes.xaxis, axes.yaxis) if axes.axison else ():
            low, high = sorted(axis.get_view_interval())
            found += [axis.label, *(tick.label1 for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high)]
    return [text for text in found if text.get_visible() and text.get_text().strip()]


def test_equal_lengths_are_equal_on_both_axes(blade_drawn):
    for title in ("Sections", "Mid span", "Meridional"):
        panel = blade_drawn.panel(title)
        panel.apply_aspect()
        box = panel.get_window_extent()
        (left, right), (low, high) = panel.get_xlim(), panel.get_ylim()
        assert box.width / (right - left) == pytest.approx(box.height / (high - low), rel=1e-6)  # rounding of boxes


def test_a_long_head_is_shortened_and_read_as_it_is_written(section_drawn):
    design = section_drawn.design.changed({"name": "vane $a$", "description": "costs $5 or $6, " + "word " * 60})
    figure = sheet(design, section_drawn.built)
    name, _, description = figure.texts
    assert name.get_text() == "vane $a$"
    assert not name.get_parse_math()
    assert not description.get_parse_math()
    assert description.get_text().endswith("word …")
    assert name.get_window_extent().x1 < description.get_window_extent().x0
