"""What is drawn is the native geometry and the design's own numbers, in the units on the axes."""

import numpy as np
import pytest
from matplotlib.path import Path as Outline

from bladewright.blade.design.families import prismatic
from bladewright.views.laws import Panel, draw_laws, panels_of
from bladewright.views.meridional import blade_outline
from bladewright.views.picture import FEW_SPANS, SPANS, sheet
from bladewright.views.sections import cosine_spacing, drawn_per_unit, narrowest_gap, outline, pitch_of
from machines.stations import TABLE

EXACT = 1e-12
"""rounding of a scaling"""
SAME = {"rtol": EXACT, "atol": EXACT}


def lines(panel):
    return [np.column_stack(line.get_data()).astype(float) for line in panel.get_lines()]


def with_name(panel, name):
    return np.column_stack(next(line for line in panel.get_lines() if line.get_label() == name).get_data()).astype(
        float
    )


def test_sections_are_the_native_curves_in_the_unit_of_the_design(blade_drawn):
    panel, u = blade_drawn.panel("Sections"), cosine_spacing()
    shapes = [line for line in lines(panel) if len(line) == 2 * len(u)]
    assert len(shapes) == len(SPANS)
    for v, shape in zip(SPANS, shapes, strict=True):
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
    sections = [drawn.built] if drawn.name == "section" else [drawn.built.section(v) for v in FEW_SPANS]
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
    sections = [drawn.built] if drawn.name == "section" else [drawn.built.section(v) for v in SPANS]
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


def test_every_law_of_the_design_is_drawn_from_hub_to_shroud(blade_drawn):
    design, drawn = blade_drawn.design, 0
    for title, factor in (("Angles", 1.0), ("Position", 1.0), ("Camber tangents", 100.0), ("Edge radii", 100.0)):
        if title == "Position" and blade_drawn.name != "cascade":
            continue
        panel = blade_drawn.panel(title)
        named = [line.get_label() for line in panel.get_lines() if not line.get_label().startswith("_")]
        for name in named:
            law = getattr(design, name.replace(" ", "_"))
            law = law if isinstance(law, tuple) else (law,)
            curve = with_name(panel, name)
            assert curve[0] == pytest.approx([factor * law[0], 0.0], abs=1e-12)
            assert curve[-1] == pytest.approx([factor * law[-1], 1.0], abs=1e-12)
            assert any(
                len(line) == len(law) and np.allclose(line[:, 0], factor * np.array(law)) for line in lines(panel)
            )
            drawn += 1
    assert drawn == 8


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
        along_span = [a for a in drawn.figure.axes if a.get_title(loc="left") == "Half thickness"]
        labels = [line.get_label() for line in along_span[0].get_lines()]
        assert [f"upper {i + 1}" for i in range(len(drawn.design.thickness_upper))] == [
            n for n in labels if "upper" in n
        ]


def test_weights_have_a_panel_where_there_are_some(section_drawn):
    weighted = section_drawn.design.changed({"weights_upper": (1.0, 1.3, 1.0), "weights_lower": (1.0, 1.2)})
    assert "Weights" not in [panel.title for panel in panels_of(prismatic(section_drawn.design))]
    weights = next(panel for panel in panels_of(prismatic(weighted)) if panel.title == "Weights")
    assert weights.laws == {"upper 1": 1.0, "upper 2": 1.3, "upper 3": 1.0, "lower 1": 1.0, "lower 2": 1.2}


def test_a_built_section_is_drawn_without_the_laws_it_does_not_know(section_drawn):
    alone = [axes.get_title(loc="left") for axes in sheet(section_drawn.built).axes]
    assert "Thickness as built, largest in % of chord" in alone
    assert not any(title.startswith("Half thickness") for title in alone)
