"""Blades from sections on the sheet: flow path, blunt edges, laws of any family, smoothness."""

from dataclasses import replace
from importlib import import_module
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from bladewright.blade.exact.sectioned import exact_sectioned_blade
from bladewright.section.profiles.naca4 import Naca4
from bladewright.section.profiles.points import PointsProfile
from bladewright.section.smoothness import smoothness
from bladewright.views.distributions import draw_smoothness, jump_rows, logarithmic_beyond
from bladewright.views.laws import constants_of, panels_of
from bladewright.views.meridional import FEW_SURFACES, blade_outline, built_edges, draw_meridional, draw_view
from bladewright.views.picture import sheet
from bladewright.views.sections import draw_edge, drawn_per_unit, neighbour_outline, outline
from bladewright.views.solid import blade_surfaces, draw_solid
from bladewright.views.style import VIOLET, draw_lines
from bladewright.views.text_table import draw_text_table
from machines import built
from machines.sectioned import BLUNT, COMPRESSOR, DESIGNS, IMPELLER, STATOR, VANE
from machines.sections import EXAMPLES

from .conftest import small_solid
from .test_sheet import texts_of

ROUGH = 1e-4
"""tolerance of blades that are only drawn"""


@pytest.fixture(scope="module")
def impeller():
    return built(replace(IMPELLER, tolerance=ROUGH))


@pytest.fixture(scope="module")
def drawn(impeller):
    with pytest.MonkeyPatch.context() as small:
        small.setattr(import_module("bladewright.views.picture"), "draw_solid", small_solid)
        figure = sheet(impeller)
    figure.canvas.draw()
    return figure


def titles(figure):
    return [axes.get_title(loc="left") for axes in figure.axes]


def panel(figure, title):
    return next(axes for axes in figure.axes if axes.get_title(loc="left").startswith(title))


def test_every_panel_is_there_and_no_text_covers_another(drawn):
    for title in ("Blade with", "Sections", "Mid span", "Meridional", "Slope of the curvature", "Camber angle"):
        assert panel(drawn, title)
    assert sum(title.startswith("Trailing edge, ") and "blunt" in title for title in titles(drawn)) == 3
    renderer = drawn.canvas.get_renderer()
    boxes = [text.get_window_extent(renderer) for text in texts_of(drawn)]
    assert len(boxes) > 100
    edges = np.array([[box.x0, box.x1, box.y0, box.y1] for box in boxes])
    wide = np.minimum(edges[:, None, 1], edges[None, :, 1]) - np.maximum(edges[:, None, 0], edges[None, :, 0])
    high = np.minimum(edges[:, None, 3], edges[None, :, 3]) - np.maximum(edges[:, None, 2], edges[None, :, 2])
    overlap = np.minimum(wide, high)[np.triu_indices(len(boxes), 1)]
    assert overlap.max() <= 1.0  # a pixel: boxes are rounded outwards


def test_the_edges_that_are_built_lie_on_the_curves_that_were_asked_for(impeller):
    plan = impeller.exact.meridional_view
    assert len(plan.quasi_orthogonals) == len(IMPELLER.flow_path.quasi_orthogonals)
    built = built_edges(impeller)
    assert len(built) == 3  # a blunt edge has two
    asked = plan.lines["leading_edge"].points
    gap = np.sqrt(np.min(np.sum((built[0][:, None] - asked[None]) ** 2, axis=-1), axis=1))
    assert gap.max() < 2e-3 * impeller.chord  # the curve is 201 points


def test_quasi_orthogonals_divide_the_walls_as_they_were_given(impeller):
    plan = impeller.exact.meridional_view
    for pair, line in zip(IMPELLER.flow_path.quasi_orthogonals, plan.quasi_orthogonals, strict=True):
        for fraction, end, wall in zip(pair, line[[0, -1]], ("hub", "shroud"), strict=True):
            points = plan.lines[wall].points
            along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
            nearest = int(np.argmin(np.hypot(*(points - end).T)))
            assert along[nearest] / along[-1] == pytest.approx(fraction, abs=6e-3)  # 201 points


def test_given_stream_surfaces_are_part_of_the_plan():
    surface = exact_sectioned_blade(STATOR).meridional_view.stream_surfaces[0]
    assert not surface.polygon
    assert surface.given * 1e3 == pytest.approx(np.array([(-60, 125), (0, 128), (40, 131), (120, 132)]))
    assert surface.points[[0, -1]] == pytest.approx(surface.given[[0, -1]])


def test_many_stream_surfaces_are_hairlines_without_marks(impeller):
    view = impeller.exact.meridional_view
    line = replace(view.lines["hub"], polygon=False)
    for count, marked in ((2, 2), (FEW_SURFACES + 1, 0)):
        axes = Figure().add_subplot()
        draw_view(axes, replace(view, lines={}, stream_surfaces=(line,) * count))
        violet = [each for each in axes.get_lines() if each.get_color() == VIOLET]
        assert sum(each.get_marker() == "o" for each in violet) == marked
        assert sum(each.get_marker() != "o" for each in violet) == count


def test_the_channel_is_seen_close_to_the_blade_in_both_directions(impeller):
    axes = Figure().add_subplot()
    draw_meridional(axes, impeller)
    shape, (left, right) = 1e3 * blade_outline(impeller), axes.get_xlim()
    extent = np.ptp(shape, axis=0).max()
    assert left <= shape[:, 0].min()
    assert right >= shape[:, 0].max()
    assert right - left <= np.ptp(shape[:, 0]) + 2.0 * extent


@pytest.mark.parametrize("name", ["diffuser", "inlet-vane"])
def test_a_wall_is_continued_past_the_edges_and_no_farther_than_it_reaches(name):
    exact = exact_sectioned_blade(DESIGNS[name])
    wall, inside = (
        exact.wall_points("hub", np.linspace(-50.0, 51.0, 41)),
        exact.wall_points("hub", np.array([0.0, 1.0])),
    )
    given = exact.meridional_view.lines["hub"].points
    assert wall[[0, -1]] == pytest.approx(given[[0, -1]], abs=1e-9)
    lines = exact.sections(np.zeros(1)).lines
    assert inside == pytest.approx(np.real(lines.position(np.array([0.0, 1.0])))[0], abs=1e-12)


def test_a_blunt_edge_is_a_face_of_the_drawn_blade(impeller):
    meshes, _ = blade_surfaces(impeller, (21, 9), (0.0, 0.0, 1.0))
    face = next(mesh for mesh in meshes if mesh.points.shape == (5, 9, 3))
    v = np.linspace(0.0, 1.0, 9)
    for row, side in ((0, "upper"), (-1, "lower")):
        assert face.points[row] == pytest.approx(1e3 * impeller.surfaces[side](1.0, v), abs=1e-9)


def test_an_impeller_is_seen_from_its_shroud(impeller):
    axes = Figure().add_subplot()
    draw_solid(axes, impeller, neighbours=0, width=160)
    picture = np.asarray(axes.get_images()[0].get_array())
    assert ((picture[..., 2] > 1.25 * picture[..., 0]) & (picture[..., 3] > 0.5)).sum() > 300


@pytest.mark.parametrize("design", [*DESIGNS.values(), BLUNT], ids=lambda each: each.name)
def test_every_law_of_a_family_has_a_place_in_a_panel(design):
    drawn = sum(len(panel.laws) for panel in panels_of(design)) + sum(len(each.values) for each in constants_of(design))
    apart = ("flow_path", "leading_edge.", "leading_edge_", "trailing_edge.", "pitch")
    paths = {path.split("[")[0] for path in design.parameters() if not path.startswith(apart)}
    rows = sum(
        len(value) - 1
        for path in paths
        if isinstance(value := _at(design, path), tuple) and any(isinstance(each, tuple) for each in value)
    )
    assert drawn >= len(paths) + rows
    assert all(len(panel.laws) > 0 for panel in panels_of(design))


def _at(part, path):
    for name in path.split("."):
        part = getattr(part, name)
    return part


def test_points_of_a_given_profile_have_no_panel_each():
    turn = np.linspace(0.0, 2.0 * np.pi, 20, endpoint=False)
    abscissas, ordinates = (tuple(each.tolist()) for each in (0.5 + 0.5 * np.cos(turn), 0.1 * np.sin(turn)))
    blade = replace(VANE, section=PointsProfile(abscissas=abscissas, ordinates=ordinates))
    assert [panel.title for panel in panels_of(blade)] == ["Leading edge position"]
    assert [each.name for each in constants_of(blade)] == ["stagger angle"]


def test_neighbours_in_a_plane_of_lengths_stand_as_far_apart_as_their_radius_says():
    design = replace(COMPRESSOR, plane="m-r*theta", tolerance=1e-3)
    blade = design.build()
    section = blade.section(0.5)
    shape = outline(section)
    aside = neighbour_outline(blade, section, shape)[:, 1] - shape[:, 1]
    lines = blade.exact.sections(np.array([0.5])).lines
    radius = np.real(lines.position(lines.u_at(shape[None, :, 0] / drawn_per_unit(section))))[0, :, 1]
    assert aside == pytest.approx(1e3 * radius * 2.0 * np.pi / 22, rel=1e-9)
    assert np.ptp(aside) > 0.1


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("naca-2412", "Trailing edge, sharp"),
        ("naca-6409-blunt", "Trailing edge, blunt, "),
        ("wedge diffuser with a back face", "Trailing edge, flat"),
        ("c4", "Trailing edge, radius "),
    ],
)
def test_an_edge_is_called_what_it_is(name, said):
    section, axes = built(EXAMPLES[name].design), Figure().add_subplot()
    draw_edge(axes, section, trailing=True)
    assert axes.get_title().startswith(said)
    low, high = axes.get_xlim()
    assert 0.0 < high - low < 1e3 * section.chord
    assert len(axes.patches) == 1 + (said.endswith("radius "))  # the fill, and the circle of a round one


def test_a_blunt_edge_of_an_impeller_is_drawn_as_wide_as_its_face_is(impeller):
    for v, section in ((each.span, each) for each in impeller.sections):
        ends = [side(1.0, v) for side in impeller.sides]
        width = 1e3 * np.sqrt(np.sum((ends[0] - ends[1]) ** 2))
        axes = Figure().add_subplot()
        draw_edge(axes, section, trailing=True)
        # the chord of an arc about the axis; the title has four figures
        assert float(axes.get_title().split()[-2]) == pytest.approx(width, rel=1e-3)
        shape = axes.patches[0].get_xy()
        assert np.min(np.abs(np.hypot(*np.diff(shape, axis=0).T) - width)) < 1e-3 * width


def test_the_thickness_at_a_blunt_edge_is_that_of_the_edge():
    section = built(EXAMPLES["naca-6409-blunt"].design)
    face = section.curves["trailing_edge"].control_points
    assert section.thickness[1][-1] == pytest.approx(np.hypot(*(face[1] - face[0])))
    assert section.maximum_thickness[0] == pytest.approx(0.09 * section.chord, rel=1e-2)


def test_smoothness_is_drawn_in_pieces_with_the_jumps_in_a_table():
    section = built(EXAMPLES["naca-2412"].design)
    found, chord = smoothness(section), 1e3 * section.chord
    figure = Figure(layout="constrained")
    draw_smoothness(figure.subfigures(), [section])
    camber = figure.axes[1].get_lines()
    dots = next(line for line in camber if line.get_marker() == "o").get_ydata()
    jump = found.camber.jumps[0].curvature
    assert dots == pytest.approx(np.array(jump) / chord, rel=1e-6)  # the places beside the joint
    texts = [text.get_text() for text in figure.axes[3].texts]
    assert f"{abs(jump[1] - jump[0]) / chord:.3g}" in texts
    assert "curvature [1/mm]" in texts
    assert [row[0] for row in jump_rows([(section, found)], ("hub", "tip"))] == ["upper", "lower", "camber"]


def test_the_columns_of_a_table_do_not_touch_whatever_stands_in_them():
    axes = Figure(figsize=(9.0, 3.0)).add_subplot()
    draw_text_table(
        axes, [("a name that is very much longer", "1", "mm"), ("short", "123456789", "1/mm²")], align="lrl"
    )
    FigureCanvasAgg(axes.figure).draw()
    boxes = [text.get_window_extent() for text in axes.texts]
    for line in (boxes[:3], boxes[3:]):
        assert all(left.x1 + 8.0 < right.x0 for left, right in pairwise(line))
    assert boxes[1].x1 == pytest.approx(boxes[4].x1, abs=1.0)  # a pixel


@pytest.mark.parametrize(("limits", "least"), [((-0.3, 40.0), 0.03), ((-1e6, 1e6), 0.7), ((0.0, 1e-3), 0.01)])
def test_a_logarithmic_axis_says_where_it_begins_and_its_ticks_stand_apart(limits, least):
    axes = Figure(figsize=(4.0, 3.0)).add_subplot()
    axes.plot([0.0, 1.0], limits)
    axes.set_ylabel("curvature [1/mm]")
    logarithmic_beyond(axes, least)
    begin = float(axes.get_ylabel().partition("±")[2])
    assert least <= begin <= 3.0 * least
    assert axes.get_ylabel() == f"curvature [1/mm],\nlogarithmic beyond ±{begin:g}"
    FigureCanvasAgg(axes.figure).draw()
    low, high = axes.get_ylim()
    boxes = [each.label1.get_window_extent() for each in axes.yaxis.get_major_ticks() if low <= each.get_loc() <= high]
    boxes.sort(key=lambda box: box.y0)
    assert len(boxes) >= 3
    assert all(lower.y1 <= upper.y0 + 1.0 for lower, upper in pairwise(boxes))  # a pixel: boxes are rounded outwards


def test_lines_that_coincide_are_all_seen():
    axes, x = Figure().add_subplot(), np.linspace(0.0, 1.0, 50)
    curvature = np.where(x > 0.9, 40.0, 0.01)  # of a side: 4,000 times as large at an edge
    rows = (x, x, 1.0001 * x, 1.1 * x, curvature, np.where(x > 0.9, 40.0, -0.01), 1e-17 * x)
    draw_lines(axes, [(x, y, {"color": "black"}) for y in rows])
    widths = [line.get_linewidth() for line in axes.get_lines()]
    assert widths[0] > widths[1] > widths[2] == widths[3] == widths[4] == widths[5] == widths[6]


def test_straight_camber_lines_have_no_panels_of_curvature():
    section, figure = built(EXAMPLES["wedge diffuser with a back face"].design), Figure(layout="constrained")
    draw_smoothness(figure.subfigures(), [section])
    assert [axes.get_title() for axes in figure.axes] == [
        "Slope of the curvature of the sides",
        "Largest jumps at joints",
    ]


def test_smoothness_of_a_blade_is_that_of_its_exact_sections(impeller):
    found = impeller.smoothness(0.5)
    assert found.to_dict() == smoothness(impeller.section(0.5)).to_dict()
    assert found.camber.continuous == (True, True)
    assert [line.continuous[0] for line in found.lines] == [True] * 3


def test_the_trailing_edge_of_a_published_profile_is_measured_in_its_maximum_thickness():
    profile = replace(VANE, section=Naca4(thickness=0.12, trailing_edge="blunt", trailing_edge_thickness=0.02))
    (edge,) = (each for each in constants_of(profile) if each.name == "trailing edge thickness")
    assert (edge.values, edge.unit) == ((2.0,), "% of maximum")
    varying = panels_of(profile.changed({"section.trailing_edge_thickness": (0.02, 0.03)}))
    assert [each.abscissa for each in varying if "trailing edge thickness" in each.laws] == ["thickness [% of maximum]"]
