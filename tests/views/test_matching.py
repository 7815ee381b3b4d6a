"""The sheet of a fit: every panel is there and shows what the fit holds, and nothing that matters is thinned out."""

from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PathCollection, QuadMesh
from matplotlib.figure import Figure

from bladewright.blade.native.extrema import extrema_of
from bladewright.errors import FileError
from bladewright.numerics.elementary import angle
from bladewright.views.fit_data import (
    WORST_POINTS,
    colour_scale,
    outline_at,
    points_to_draw,
    rounded_up,
    span_at_share,
    worst_span,
)
from bladewright.views.fit_deviations import (
    DRAWN_HEIGHT,
    MAP_POINTS,
    abscissae,
    draw_magnified,
    draw_map,
    draw_outline_deviation,
    magnification,
)
from bladewright.views.fit_sheet import draw_histogram, draw_table, fit_picture, fit_sheet
from bladewright.views.sections import drawn_per_unit
from bladewright.views.style import drawing_style
from machines import built
from machines.fits import DESIGNS, made
from machines.sections import EXAMPLES

_SHEETS = {}


def sheet_of(kind):
    if kind not in _SHEETS:
        fit = made(kind, extrema=extrema_of(built(DESIGNS[kind])))
        _SHEETS[kind] = fit, fit_sheet(fit)
        _SHEETS[kind][1].canvas.draw()
    return _SHEETS[kind]


def panel(figure, title):
    return next(axes for axes in figure.axes if axes.get_title(loc="left").startswith(title))


def axes_of(draw, fit):
    with drawing_style():
        figure = Figure(figsize=(8.0, 4.0))
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        draw(axes, fit)
    return axes


def draw_section(axes, fit):
    draw_magnified(axes, fit, outline_at(fit, 0.0), "Section")


@pytest.fixture(params=["section", "linear"])
def kind(request):
    return request.param


PANELS = (
    "Deviation from the ",
    "Distances of the inliers [mm]",
    "Leading edge",
    "Trailing edge",
    "Distribution of the deviations",
    "Curvature, extrema: ",
)


def test_every_panel_is_there(kind):
    figure = sheet_of(kind)[1]
    for title in PANELS:
        axes = panel(figure, title)
        if axes.axison:
            assert axes.get_xlabel()
            assert axes.get_ylabel()
    magnified = [axes for axes in figure.axes if ", deviations × " in axes.get_title(loc="left")]
    assert len(magnified) == (1 if kind == "section" else 3)


def test_no_text_covers_another_or_leaves_the_sheet(kind):
    figure = sheet_of(kind)[1]
    renderer = figure.canvas.get_renderer()
    texts = list(figure.texts)
    for axes in figure.axes:
        legend = axes.get_legend()
        texts += [axes._left_title, *axes.texts, *(legend.get_texts() if legend else [])]
        for axis in (axes.xaxis, axes.yaxis) if axes.axison else ():
            low, high = sorted(axis.get_view_interval())
            texts += [axis.label, *(tick.label1 for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high)]
    boxes = [(each.get_text(), each.get_window_extent(renderer)) for each in texts if each.get_text().strip()]
    width, height = figure.canvas.get_width_height()
    assert len(boxes) > 60
    for name, box in boxes:
        assert min(box.x0, box.y0, width - box.x1, height - box.y1) >= 0.0, name
    for (first, one), (second, other) in combinations(boxes, 2):
        overlap = min(one.x1, other.x1) - max(one.x0, other.x0), min(one.y1, other.y1) - max(one.y0, other.y0)
        assert min(overlap) <= 1.0, (first, second)  # a pixel: boxes are rounded outwards


def test_the_extrema_that_are_counted_are_marked():
    fit, figure = sheet_of("section")
    axes = panel(figure, "Curvature, extrema: ")
    marks = {line.get_marker(): len(line.get_xdata()) for line in axes.lines if line.get_linestyle() == "None"}
    assert marks == {"o": fit.extrema["upper"], "s": fit.extrema["lower"]}
    assert axes.get_title(loc="left").endswith("{upper} upper, {lower} lower".format(**fit.extrema))


def test_points_are_drawn_where_they_lie():
    fit = made("section")
    outline = outline_at(fit, 0.0)
    footpoints, normals = outline.footpoints(fit, np.arange(len(fit.u)))
    off = footpoints + normals * fit.deviations[:, None] * 1e3 - fit.cloud * 1e3
    # the outline has 801 points, so that a point between is off by a part in 1e5 of the chord of 35 mm
    assert np.abs(off).max() < 1e-5 * 35.0


@pytest.mark.parametrize("kind", ["annular", "linear"])
def test_the_outline_of_a_blade_has_the_parameters_of_its_surfaces(kind):
    fit = made(kind)
    outline = outline_at(fit, 0.3)
    for name in ("upper", "lower"):
        points = fit.built.surfaces[name](outline.u, 0.3)
        ordinate = angle(points[:, 1], points[:, 2]) * drawn_per_unit(outline.section)
        if kind == "linear":
            ordinate = points[:, 1] * 1e3
        # the surfaces are built to the design's tolerance, in chords
        assert outline.sides[name][:, 1] == pytest.approx(ordinate, abs=fit.design.tolerance * fit.built.chord * 1e3)
    across = outline.moved("upper", 0.1) - outline.sides["upper"]
    assert np.linalg.norm(across, axis=1) == pytest.approx(0.1)
    middle = (outline.sides["upper"] + outline.sides["lower"])[400] / 2.0
    assert np.sum(across[400] * (outline.sides["upper"][400] - middle)) > 0.0


@pytest.mark.parametrize("count", [100, 60_000])
def test_the_worst_points_are_always_drawn_and_the_rest_is_thinned(count):
    fit = made("annular", count)
    index = points_to_draw(fit, fit.inliers, 5000)
    assert len(index) == min(np.count_nonzero(fit.inliers), 5000)
    assert len(np.unique(index)) == len(index)
    assert fit.inliers[index].all()
    off = np.abs(fit.deviations)
    worst = np.flatnonzero(fit.inliers)[np.argsort(off[fit.inliers])[-min(count // 2, WORST_POINTS) :]]
    assert set(worst) <= set(index)
    assert (np.diff(off[index]) >= 0.0).all()
    assert (points_to_draw(fit, fit.inliers, 5000) == index).all()


@pytest.mark.parametrize("count", [300, 60_000])
def test_every_outlier_is_crossed_on_the_map(count):
    fit = made("annular", count)
    axes = axes_of(draw_map, fit)
    crosses = [line for line in axes.lines if line.get_marker() == "x"]
    assert [len(line.get_xdata()) for line in crosses] == [len(fit.outliers)]
    assert f"{len(fit.outliers):,} outliers crossed" in axes.get_xlabel()


def test_a_small_cloud_is_mapped_point_by_point_and_a_large_one_by_the_means_of_cells():
    small = axes_of(draw_map, made("annular", 300))
    dots = next(each for each in small.collections if isinstance(each, PathCollection))
    assert len(dots.get_offsets()) == 294
    large = made("annular", 3 * MAP_POINTS, outliers=0.0)
    halves = replace(large, deviations=np.where(large.places == "upper", 1e-5, -2e-5))
    axes = axes_of(draw_map, halves)
    mesh = next(each for each in axes.collections if isinstance(each, QuadMesh))
    values = mesh.get_array()
    half = values.shape[1] // 2
    assert values[:, :half].compressed() == pytest.approx(-0.02)
    assert values[:, half:].compressed() == pytest.approx(0.01)
    assert f"mean in each cell of {3 * MAP_POINTS:,} points" in axes.get_xlabel()


def test_colours_are_symmetric_and_hold_all_but_one_in_a_hundred_points():
    fit = made("annular")
    scale = colour_scale(fit)
    assert scale.vmin == -scale.vmax
    assert scale.vmax == rounded_up(1e3 * fit.deviation.percentile_99)
    assert rounded_up(0.0121) == pytest.approx(0.015)


@pytest.mark.parametrize("noise", [1e-9, 1e-6, 3e-5, 0.1])
def test_deviations_are_magnified_by_a_round_factor_to_a_part_of_the_chord(noise):
    fit = made("annular", noise=noise, deviations=noise * np.linspace(-1.0, 1.0, 400))
    factor = magnification(fit)
    assert float(f"{factor:.0e}") == factor
    assert f"{factor:.0e}"[0] in "125"
    if factor > 1.0:
        seen = factor * fit.deviation.percentile_99 / fit.built.chord
        assert DRAWN_HEIGHT / 2.5 * (1.0 - 1e-9) <= seen <= DRAWN_HEIGHT * (1.0 + 1e-9)


def test_the_histogram_holds_all_inliers_and_marks_the_tolerance():
    axes = axes_of(draw_histogram, made("section"))
    bars = [patch.get_height() for patch in axes.patches if hasattr(patch, "get_height")]
    assert sum(bars) == pytest.approx(100.0)
    dashed = {line.get_xdata()[0] for line in axes.lines if line.get_linestyle() == "--" and len(line.get_xdata())}
    assert dashed == {-0.05, 0.05}
    assert "noise, σ = 0.01 mm" in [text.get_text() for text in axes.get_legend().get_texts()]


def test_a_fit_that_fails_says_so_and_why():
    fit = made("section", failures=("the leading edge is off by 0.2 mm",), tolerance=1e-5)
    texts = {text.get_text(): text.get_color() for text in axes_of(draw_table, fit).texts}
    assert "Not passed" in texts
    assert "the leading edge is off by 0.2 mm" in texts
    assert texts[f"{fit.maximum * 1e3:.3g}"] != texts[f"{fit.mean * 1e3:.3g}"]
    assert "Passed" in {text.get_text() for text in axes_of(draw_table, made("section")).texts}


def test_sections_are_taken_where_the_cloud_is_and_edges_where_they_are_worst():
    fit = made("annular")
    half = replace(fit, v=0.5 * fit.v)
    assert span_at_share(half, 0.0) == pytest.approx(half.v[half.inliers].min())
    assert 0.48 < span_at_share(half, 1.0) <= 0.5
    edge = np.flatnonzero(half.inliers & (half.regions == "leading edge"))
    worst = edge[np.argmax(half.distances[edge])]
    assert worst_span(half, "leading edge") == half.v[worst]
    assert worst_span(replace(half, regions=np.full(len(half.u), "sides")), "leading edge") == span_at_share(half, 0.5)


def test_points_on_the_ends_are_not_mapped_and_are_counted():
    fit = made("annular")
    places = fit.places.copy()
    places[:7] = "hub"
    axes = axes_of(draw_map, replace(fit, places=places))
    assert axes.get_xlabel().endswith("; 7 points on ends and blunt edges not shown")


@pytest.mark.parametrize("draw", [draw_outline_deviation, draw_histogram, draw_table, draw_section])
def test_a_cloud_of_outliers_alone_is_drawn(draw):
    fit = made("section", 100, failures=("no point took part",))
    axes = axes_of(draw, replace(fit, inliers=np.zeros(100, dtype=bool), noise=np.nan, tolerance=None))
    axes.figure.canvas.draw()
    assert axes.get_title(loc="left")


def test_the_sheet_is_written_whole(tmp_path, monkeypatch):
    fit, figure = sheet_of("section")
    monkeypatch.setattr("bladewright.views.fit_sheet.fit_sheet", lambda _: figure)
    fit_picture(fit, tmp_path / "fit.svg")
    assert [each.name for each in tmp_path.iterdir()] == ["fit.svg"]
    assert (tmp_path / "fit.svg").read_bytes().startswith(b"<?xml")


def test_a_path_that_will_not_do_is_refused_before_anything_is_drawn(tmp_path):
    with pytest.raises(FileError, match=r"ends in '.jpg'"):
        fit_picture(None, tmp_path / "fit.jpg")


def test_points_on_a_blunt_edge_are_drawn_on_its_face():
    section = built(EXAMPLES["naca-6409-blunt"].design)
    face, u = section.curves["trailing_edge"], np.array([0.25, 0.5])
    upper, off = np.array([0.2, 0.9]), np.array([1e-5, -1e-5, 2e-5, 0.0])
    places = np.array(["upper", "upper", "trailing_edge", "trailing_edge"])
    fit = SimpleNamespace(
        cloud=np.concatenate([section.curves["upper"](upper), face(u)]),
        built=section,
        places=places,
        u=np.append(upper, [1.0, 1.0]),
        v=np.zeros(4),
        inliers=np.ones(4, dtype=bool),
        deviations=off,
    )
    outline = outline_at(fit, 0.0)
    assert outline.points.all()
    footpoints, normals = outline.footpoints(fit, np.arange(4))
    assert footpoints[2:] == pytest.approx(1e3 * face(u), abs=1e-9)
    chord_line = section.camber.derivative(np.ones(1))[0]
    assert normals[2] == pytest.approx(chord_line / np.linalg.norm(chord_line), abs=1e-9)
    assert abscissae(fit, np.arange(4)).tolist() == [0.2, 0.9, 1.0, 1.0]
