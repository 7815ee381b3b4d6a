"""What is drawn is the native geometry, what the station table measures and the design's own numbers, with units."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.path import Path as Outline

from bladewright.blade.design.families import prismatic
from bladewright.designs import Stations
from bladewright.section.laws import overshoots_of
from bladewright.views.along_the_blade import camber_line
from bladewright.views.flow_marks import bow
from bladewright.views.law_charts import draw_laws
from bladewright.views.laws import Panel, constant_rows, constants_of, panels_of, place_names
from bladewright.views.meridional import blade_outline
from bladewright.views.picture import FEW_SPANS, SPANS, sheet
from bladewright.views.sections import cosine_spacing, drawn_per_unit, narrowest_gap, outline, pitch_of
from machines import example
from machines.sectioned import DESIGNS as SECTIONED
from machines.sectioned import IMPELLER
from machines.stations import TABLE

FAMILIES = (*SECTIONED.values(), *(example(name) for name in ("core-rotor", "booster-stator", "pump-inducer")))
"""designs with rows of laws of every kind"""

EXACT = 1e-12
"""rounding of a scaling"""
SAME = {"rtol": EXACT, "atol": EXACT}


def shown_spans(drawn, spans):
    """A cascade has the same section all along the span: it is drawn once."""
    return (0.5,) if drawn.name == "cascade" else spans


def lines(panel):
    return [np.column_stack(line.get_data()).astype(float) for line in panel.get_lines()]


def with_name(panel, name):
    return np.column_stack(next(line for line in panel.get_lines() if line.get_label() == name).get_data()).astype(
        float
    )


def test_sections_are_the_native_curves_in_the_unit_of_the_design(blade_drawn):
    panel, u = blade_drawn.panel("Sections"), cosine_spacing()
    shapes = [line for line in lines(panel) if len(line) == 2 * len(u)]
    assert len(shapes) == len(shown_spans(blade_drawn, SPANS))
    for v, shape in zip(shown_spans(blade_drawn, SPANS), shapes, strict=True):
        section = blade_drawn.built.section(v)
        for name, part in (("upper", shape[: len(u)]), ("lower", shape[: len(u) - 1 : -1])):
            assert np.allclose(part, section.curves[name](u) * drawn_per_unit(section), **SAME)


def test_a_drawn_section_has_the_chord_of_the_built_one(drawn):
    section = drawn.built if drawn.name == "section" else drawn.built.section(0.5)
    ends = outline(section)[[0, 200]]
    # in the plane of an annulus the mean scale stands for that along the chord: 6 % on a radial machine
    limit = {"impeller": 0.10, "fan": 1e-3}.get(drawn.name, 1e-9)
    assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(drawn.per_metre * section.chord, rel=limit)


def test_the_neighbour_stands_one_pitch_away(drawn):
    section = drawn.built if drawn.name == "section" else drawn.built.section(0.5)
    panel = drawn.panel("Section" if drawn.name == "section" else "Mid span")
    first, second = (line for line in lines(panel) if len(line) == 402)
    pitch = 0.0575 * drawn.per_metre if drawn.name in ("section", "cascade") else pitch_of(drawn.built, section)
    assert np.allclose(second - first, [0.0, pitch], **SAME)


def test_as_many_pitches_as_blades_go_around(blade_drawn):
    section = blade_drawn.built.section(0.5)
    pitch = pitch_of(blade_drawn.built, section)
    if blade_drawn.name == "cascade":
        assert pitch == pytest.approx(0.0575 * blade_drawn.per_metre)
    else:
        assert pitch * blade_drawn.design.blade_count == pytest.approx(2.0 * np.pi * drawn_per_unit(section))


def test_the_narrowest_gap_of_two_circles_lies_between_their_centres():
    turn = np.linspace(0.0, 2.0 * np.pi, 361)
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    gap = narrowest_gap(circle, circle + np.array([0.0, 5.0]))
    assert np.allclose(gap, [[0.0, 1.0], [0.0, 4.0]], atol=1e-12)  # rounding: the points are among those given


def test_curvature_is_that_of_the_section_convex_positive_per_unit_of_length(drawn):
    sections = (
        [drawn.built] if drawn.name == "section" else [drawn.built.section(v) for v in shown_spans(drawn, FEW_SPANS)]
    )
    curves = [line for line in lines(drawn.panel("Curvature")) if len(line) == 601]
    assert len(curves) == 2 * len(sections)
    for index, section in enumerate(sections):
        for name, sign, curve in zip(("upper", "lower"), (-1.0, 1.0), curves[2 * index :], strict=False):
            assert np.allclose(
                curve[:, 1], sign * section.curvature(name, cosine_spacing(601)) / drawn.per_metre, **SAME
            )
            assert np.allclose(
                curve[[0, -1], 1], 1.0 / (drawn.per_metre * np.array(section.edge_radii)), rtol=1e-6
            )  # of the promise
            assert curve[0, 0] == 0.0
            assert curve[-1, 0] == 1.0
            assert (np.diff(curve[:, 0]) > 0.0).all()


def test_thickness_is_that_of_the_section_in_the_unit_of_the_design(drawn):
    sections = [drawn.built] if drawn.name == "section" else [drawn.built.section(v) for v in shown_spans(drawn, SPANS)]
    curves = [line for line in lines(drawn.panel("Thickness as built")) if len(line) > 1]
    for section, curve in zip(sections, curves, strict=True):
        assert np.allclose(
            curve, np.column_stack([section.thickness[0], drawn.per_metre * section.thickness[1]]), **SAME
        )


@pytest.mark.parametrize("wall", ["leading_edge", "trailing_edge", "hub", "shroud"])
def test_the_channel_is_that_of_the_blade_with_the_control_points_of_the_design(blade_drawn, wall):
    panel, channel = blade_drawn.panel("Meridional"), blade_drawn.built.exact.full_channel
    drawn = with_name(panel, wall.replace("_", " "))
    assert np.allclose(drawn, blade_drawn.per_metre * channel.curve(wall)(np.linspace(0.0, 1.0, 201)), **SAME)
    for point in getattr(blade_drawn.design.channel, wall):
        assert min(np.min(np.linalg.norm(line - np.array(point), axis=1)) for line in lines(panel)) < 1e-9


def test_the_meridional_outline_holds_the_native_sides(blade_drawn):
    shape = blade_outline(blade_drawn.built)
    within, sides = Outline(shape), []
    u, v = np.meshgrid(cosine_spacing(101), np.linspace(0.01, 0.99, 23))
    for name in ("upper", "lower"):
        x, y, z = np.moveaxis(blade_drawn.built.surfaces[name](u, v), -1, 0)
        radius = z if blade_drawn.name == "cascade" else np.hypot(y, z)
        # between its 41 stations and 101 places the outline is a polygon: 1e-3 of the chord
        around = 1e-3 * blade_drawn.built.chord
        points = np.column_stack([x.ravel(), radius.ravel()])
        assert (within.contains_points(points, radius=around) | within.contains_points(points, radius=-around)).all()
        sides.append(points)
    # the same places along the sides, but other stations
    reach = np.ptp(np.concatenate(sides), axis=0)
    assert reach == pytest.approx(np.ptp(shape, axis=0), rel=3e-2)


def test_every_law_of_the_design_is_drawn_from_hub_to_shroud_or_written_as_a_constant(blade_drawn):
    design, found = blade_drawn.design, []
    for title, factor in (("Angles", 1.0), ("Leading edge position", 1.0), ("Camber t", 100.0), ("Edge radii", 100.0)):
        panel = next((axes for axes in blade_drawn.figure.axes if axes.get_title(loc="left").startswith(title)), None)
        named = [] if panel is None else [line.get_label() for line in panel.get_lines()]
        for name in [name for name in named if not name.startswith("_")]:
            law = getattr(design, name.replace(" ", "_"))
            curve = with_name(panel, name)
            assert len(set(law)) > 1
            assert curve[0] == pytest.approx([factor * law[0], 0.0], abs=1e-12)
            assert curve[-1] == pytest.approx([factor * law[-1], 1.0], abs=1e-12)
            assert any(
                len(line) == len(law) and np.allclose(line[:, 0], factor * np.array(law)) for line in lines(panel)
            )
            found.append(name)
    for each in constants_of(design):
        if not each.name.startswith(("thickness", "weights")):
            law = getattr(design, each.name.replace(" ", "_"))
            factor = 1.0 if each.unit in ("deg", design.length_unit) else 100.0
            assert each.values == pytest.approx((factor * (law[0] if isinstance(law, tuple) else law),))
            found.append(each.name)
    assert sorted(found) == sorted(set(found))
    assert len(found) == 8
    texts = [text.get_text() for axes in blade_drawn.figure.axes for text in axes.texts]
    constants = constants_of(design)
    for name, *_ in constant_rows(constants) if any(not each.default for each in constants) else []:
        assert name in texts or not name


def test_constants_say_their_unit_and_whether_anybody_gave_them():
    given = {each.name: each for each in constants_of(IMPELLER)}
    assert all(len(row) == 3 for row in constant_rows(list(given.values())))
    theta = given["leading edge theta"]
    assert theta.default
    assert constant_rows([theta]) == [("leading edge theta", "0", "deg, default")]


def test_laws_that_coincide_are_one_line_with_all_their_names():
    from matplotlib.figure import Figure

    axes, same = Figure().add_subplot(), (0.3, 0.4)
    laws = {"tangent in": same, "tangent out": (0.3, 0.35, 0.4), "other": (0.3, 0.5)}
    laws |= {"upper, at 33 %": (0.1, 0.2), "lower, at 33 %": (0.1, 0.2)}
    draw_laws(axes, Panel("Tangents", "length [%]", 100.0, laws))
    named = [line.get_label() for line in axes.get_lines() if not line.get_label().startswith("_")]
    assert named == ["tangent in = tangent out", "other", "both sides, at 33 %"]
    assert len({line.get_color() for line in axes.get_lines()}) == 3


def test_control_points_along_the_chord_are_called_by_their_places():
    assert place_names((0.0, 0.2, 1.0 / 3.0, 1.0), 4) == ["leading edge", "at 20 %", "at 33.3 %", "trailing edge"]
    assert place_names((), 2) == ["point 1", "point 2"]
    names = {panel.title: list(panel.laws) for design in FAMILIES for panel in panels_of(design)}
    assert names["Curvature"][0] == "leading edge"
    assert names["Camber angle"][-1] == "trailing edge"
    assert not any(name.isdigit() for each in names.values() for name in each)


def test_an_overshoot_of_stations_is_marked_with_its_size():
    from matplotlib.figure import Figure

    axes = Figure().add_subplot()
    law = Stations(span=(0.0, 0.4, 0.6, 1.0), values=(0.0, 0.0, 1.0, 1.0))
    draw_laws(axes, Panel("Angles", "angle [deg]", 1.0, {"metal angle out": law}))
    marked = next(line for line in axes.get_lines() if line.get_label().startswith("overshoot"))
    found = list(overshoots_of(law, ""))
    assert len(found) == 2
    assert np.column_stack(marked.get_data()) == pytest.approx(np.array([(each.value, each.v) for each in found]))
    assert marked.get_label() == f"overshoot, {max(each.amount for each in found):.2g} deg"


def test_stations_are_drawn_on_their_law():
    from matplotlib.figure import Figure

    axes = Figure().add_subplot()
    draw_laws(axes, Panel("Angles", "angle [deg]", 1.0, {"metal angle out": TABLE}))
    curve, marks = lines(axes)
    assert marks == pytest.approx(np.column_stack([TABLE.values, TABLE.span]))
    assert np.interp(marks[:, 1], curve[:, 1], curve[:, 0]) == pytest.approx(marks[:, 0], abs=1e-12)


def test_thickness_laws_are_drawn_along_span_and_chord(drawn):
    panel = drawn.panel("Half thickness along")
    for name in ("upper", "lower"):
        laws = getattr(drawn.design, f"thickness_{name}")
        points = [100.0 * (law[0] if isinstance(law, tuple) else law) for law in laws]
        assert any(len(line) == len(points) and np.allclose(line[:, 1], points) for line in lines(panel))
    if drawn.name != "section":
        panels = {panel.title: panel for panel in panels_of(drawn.design)}
        if drawn.name == "cascade":
            assert "Half thickness" not in panels
            return
        names = list(panels["Half thickness"].laws)
        assert names[0] == "upper, leading edge"
        assert len([name for name in names if "upper" in name]) == len(drawn.design.thickness_upper)


def test_weights_have_a_panel_where_there_are_some(section_drawn):
    plain, weighted = (
        prismatic(section_drawn.design.changed({"weights_upper": upper, "weights_lower": lower}))
        for upper, lower in (((), ()), ((1.0, 1.3, 1.0), (1.0, 1.2)))
    )
    assert not any(each.name.startswith("weights") for each in constants_of(plain))
    assert {each.name: each.values for each in constants_of(weighted) if each.name.startswith("weights")} == {
        "weights upper": (1.0, 1.3, 1.0),
        "weights lower": (1.0, 1.2),
    }
    panels = panels_of(weighted.changed("weights_upper[1]", (1.3, 1.4)))
    weights = next(panel for panel in panels if panel.title == "Weights")
    assert weights.laws == {
        "upper, leading edge": 1.0,
        "upper, at 50 %": (1.3, 1.4),
        "upper, trailing edge": 1.0,
    }


def test_a_built_section_is_drawn_without_the_laws_it_does_not_know(section_drawn):
    alone = [axes.get_title(loc="left") for axes in sheet(section_drawn.built).axes]
    assert "Thickness as built, largest in % of chord" in alone
    assert not any(title.startswith("Half thickness") for title in alone)


@pytest.mark.parametrize("v", [0.0, 0.5, 1.0])
def test_a_camber_line_begins_and_ends_at_the_metal_angles(blade_drawn, v):
    section = blade_drawn.built.section(v)
    line = camber_line(blade_drawn.built, section)
    # angles are those of chords between 101 points, drawn only: 0.2 deg at the ends
    assert np.degrees(line.angle[0]) == pytest.approx(np.degrees(section.metal_angle_in), abs=0.2)
    assert np.degrees(line.angle[-1]) == pytest.approx(np.degrees(section.metal_angle_out), abs=0.2)


def test_the_wrap_drawn_is_that_of_the_station_table(blade_drawn):
    table = blade_drawn.built.report([0.5])
    line = camber_line(blade_drawn.built, blade_drawn.built.section(0.5))
    wrap = line.tangential[-1] - line.tangential[0]
    assert wrap == pytest.approx(float(np.real(table.wrap[0])), rel=1e-4)


def test_throat_and_pitch_are_drawn_from_hub_to_shroud(blade_drawn):
    panel = blade_drawn.panel("Throat and pitch")
    table = blade_drawn.built.report([0.0, 1.0])
    drawn = {line.get_label(): line.get_xdata() for line in panel.get_lines()}
    ends = np.real(table.throat) * blade_drawn.per_metre
    assert drawn["throat"][[0, -1]] == pytest.approx(ends, rel=1e-9)


def test_the_arrow_of_the_rotation_goes_the_way_the_row_turns(blade_drawn):
    point = np.array([0.01, 0.02, 0.3])
    for turns in (-1, 1):
        way = bow(blade_drawn.built, point, turns)
        if blade_drawn.name == "cascade":
            assert np.sign(way[-1, 1] - way[0, 1]) == turns
        else:
            theta = np.arctan2(way[:, 1], way[:, 2])
            assert (np.sign(np.diff(theta)) == turns).all()


def test_a_row_whose_rotation_is_not_known_has_no_arrow_of_it(blade_drawn):
    standing = replace(blade_drawn.design, rotation="none")
    assert standing.turns == 0
