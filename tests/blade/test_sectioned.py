"""Blades from sections: they stand on their edge curves, keep their sections, close up, and are differentiable."""

from dataclasses import replace

import jsonschema
import numpy as np
import pytest

import bladewright as bw
from bladewright import cad
from bladewright.errors import DesignError
from bladewright.files.reading import design_from, parsed
from bladewright.files.schema import schema
from bladewright.files.writing import text_of, updated
from bladewright.section.laws import Span
from machines import COARSE, built, stacked
from machines.sectioned import BLUNT, COMPRESSOR, DESIGNS, DIFFUSER, STATOR, VANE, through

SWAPPED = replace(COMPRESSOR.flow_path, hub=COMPRESSOR.flow_path.shroud, shroud=COMPRESSOR.flow_path.hub)
SHORT = replace(VANE.flow_path, hub=through((0, 0), (120, 0)), shroud=through((0, 50), (120, 60)))
V = np.linspace(0.0, 1.0, 11)


def blade_of(name):
    return built(DESIGNS[name])


@pytest.mark.parametrize("name", DESIGNS)
def test_a_blade_from_sections_keeps_its_promises(name):
    blade = blade_of(name)
    assert blade.conformance.kept, blade.conformance
    assert blade.error < 1e-6


@pytest.mark.parametrize("name", ["compressor-rotor", pytest.param("impeller", marks=pytest.mark.slow), "diffuser"])
def test_its_solid_comes_back_from_a_step_file_with_few_faces_and_small(name, tmp_path):
    blade = blade_of(name)
    trip = cad.write(blade, tmp_path / "blade.step", samples=900)
    assert trip.passed, trip.failures
    assert len(blade.surfaces) <= 6
    assert (tmp_path / "blade.step").stat().st_size < 600e3


@pytest.mark.parametrize("name", ["impeller", "stator"])
def test_given_sections_are_curves_of_constant_v_within_1e_9_of_the_chord(name):
    # at hub and shroud, and on the stream surface of the stator that is given at 0.45 of the span
    blade, u = blade_of(name), np.linspace(0.0, 1.0, 501)
    v = np.array(blade.design.flow_path.spans)
    for side, points in zip(blade.sides, blade.exact.sections(v).points(u), strict=True):
        miss = side.grid(u, v).swapaxes(0, 1) - points
        assert np.max(np.sqrt(np.sum(miss**2, axis=-1))) < 1e-9 * blade.chord
    assert blade.conformance.sections < blade.conformance.limits["sections"] == 1e-9


def test_a_blunt_edge_is_two_sharp_edges_and_a_face():
    surfaces = blade_of("impeller").surfaces
    assert list(surfaces) == ["upper", "lower", "trailing_edge", "hub", "shroud"]
    face = surfaces["trailing_edge"]
    assert np.array_equal(face.control_points[0], surfaces["upper"].control_points[-1])
    assert np.array_equal(face.control_points[-1], surfaces["lower"].control_points[-1])


def test_both_sides_share_their_round_and_sharp_edges_to_the_bit():
    upper, lower = blade_of("compressor-rotor").sides
    for edge in (0, -1):
        assert np.array_equal(upper.control_points[edge], lower.control_points[edge])


def test_the_edges_stand_on_their_curves_at_the_asked_theta():
    # the edges of the diffuser are circles of 150 and 250 mm; those of the compressor stand at the law's theta
    upper = blade_of("diffuser").sides[0]
    for u, radius in ((0.0, 0.15), (1.0, 0.25)):
        points = upper(u, V)
        assert np.sqrt(points[:, 1] ** 2 + points[:, 2] ** 2) == pytest.approx(radius, rel=1e-9)
    points = blade_of("compressor-rotor").sides[0](0.0, V)
    asked = np.radians(Span(V).values(COMPRESSOR.leading_edge_theta))
    # of the law, interpolated along the span within the tolerance
    assert np.arctan2(points[:, 1], points[:, 2]) == pytest.approx(asked, abs=1e-6)


def test_the_chord_line_spans_the_edges_at_the_sections_stagger():
    blade = blade_of("compressor-rotor")
    for section in blade.sections:
        start, end = section.camber(np.array([0.0, 1.0]))
        lines = blade.exact.sections(np.array([section.span])).lines
        assert end[0] - start[0] == pytest.approx(lines.extents()[0], rel=1e-12)
        assert np.arctan2(*(end - start)[::-1]) == pytest.approx(section.stagger, abs=1e-12)
        asked = COMPRESSOR.section.stagger(Span(np.array([section.span])))[0]
        assert section.stagger == pytest.approx(asked, abs=1e-14)


def test_sections_stand_at_hub_mid_shroud_and_on_the_given_stream_surfaces():
    assert [section.span for section in blade_of("stator").sections] == [0.0, 0.45, 0.5, 1.0]
    assert {section.plane for section in blade_of("stator").sections} == {"m'-theta"}
    section = blade_of("inlet-vane").sections[0]
    assert section.plane == "x-y"
    assert section.chord == pytest.approx(0.04 / np.cos(np.radians(30.0)), rel=1e-12)


def test_a_section_on_a_meanline_has_it():
    section = blade_of("compressor-rotor").section(1.0)
    value, slope, _ = section.meanline(np.array([0.0, 1.0]))
    assert value == pytest.approx([0.0, 0.0], abs=1e-14)
    turning = np.degrees(np.arctan(slope) + section.stagger)
    assert turning == pytest.approx([58.0, 45.0], abs=1e-10)
    assert blade_of("inlet-vane").section(0.5).meanline is None


def test_a_section_lies_on_the_built_sides():
    # the section's curves and the sides have one parameter
    blade, u = blade_of("diffuser"), np.linspace(0.0, 1.0, 33)
    section, lines = blade.section(0.5), blade.exact.sections(np.array([0.5]))
    for name, side in zip(("upper", "lower"), blade.sides, strict=True):
        points = lines.in_space(section.curves[name](u)[None])[0]
        assert np.max(np.abs(points - side(u, 0.5))) < 1e-6 * blade.chord


def test_held_knots_give_the_same_blade_to_the_bit():
    blade = blade_of("inlet-vane")
    again = VANE.build(knots=blade.knots)
    for name in ("upper", "lower"):
        assert np.array_equal(again.surfaces[name].control_points, blade.surfaces[name].control_points)


def quantity(blade):
    """Points of both sides, and the volume."""
    s = np.linspace(0.0, 1.0, 7)
    points = [blade.surfaces[name](s, v).ravel() for name, v in (("upper", 0.4), ("lower", 0.8))]
    return np.concatenate([*points, [blade.properties.volume]])


@pytest.mark.parametrize(
    ("design", "paths"),
    [
        (
            COMPRESSOR,
            (
                "leading_edge_theta[1]",
                "flow_path.hub.points[2].r",
                "leading_edge.points[1].x",
                "section.metal_angle_in[1]",
                "section.curvature_places[0]",
                "section.thickness.maximum_thickness[2]",
            ),
        ),
        (
            BLUNT,
            ("section.metal_angle_in[0]", "section.thickness.trailing_edge_thickness", "trailing_edge.points[1].x"),
        ),
    ],
    ids=["compressor", "blunt"],
)
def test_derivatives_by_the_complex_step_are_those_of_differences(design, paths):
    knots = built(design.changed("tolerance", COARSE)).knots
    found = bw.sensitivity(design, quantity, free=list(paths), knots=knots)
    values = design.parameters()
    for path in paths:
        step = 1e-4 * abs(values[path])
        ahead, back = (quantity(design.changed(path, values[path] + each).build(knots=knots)) for each in (step, -step))
        # the difference is of second order in a step of 1e-4 of the value
        assert np.max(np.abs((ahead - back) / (2.0 * step) - found[path])) < 1e-6 * np.max(np.abs(found[path])), path


def test_a_design_file_holds_each_to_the_bit_and_keeps_to_the_schema():
    validator = jsonschema.Draft202012Validator(schema())
    for design in (*DESIGNS.values(), *stacked.ALL):
        document = parsed(text_of(design), "file")
        assert repr(design_from(document, "file")) == repr(design)
        validator.validate(document)


def test_a_stream_surface_in_a_file_is_changed_in_its_place():
    changed = STATOR.changed("flow_path.stream_surfaces[0].points[1].r", 127.0)
    text = updated(changed, text_of(STATOR), "file")
    assert repr(design_from(parsed(text, "file"), "file")) == repr(changed)


@pytest.mark.parametrize(
    ("design", "message"),
    [
        (replace(COMPRESSOR, blade_count=200), "blade_count is 200: neighbouring blades intersect"),
        (
            replace(COMPRESSOR, leading_edge=through((-90, 80), (-90, 180))),
            "leading_edge does not meet the stream line",
        ),
        (
            replace(COMPRESSOR, leading_edge=COMPRESSOR.trailing_edge, trailing_edge=COMPRESSOR.leading_edge),
            "leading_edge and trailing_edge cross or are swapped",
        ),
        (
            replace(VANE, flow_path=SHORT, leading_edge=through((0.01, -1), (0.01, 61))),
            "past the upstream end of the flow path",
        ),
        (
            replace(COMPRESSOR, flow_path=SWAPPED),
            "flow_path: hub and shroud are swapped",
        ),
        (DIFFUSER.changed("section.stagger_angle", 89.5), "section: its chord line stands at 89.5 deg at v = 0.000"),
    ],
)
def test_what_cannot_be_is_refused_with_its_cause(design, message):
    with pytest.raises(DesignError, match=message):
        design.build()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[[0.0, 80.0]", '[["near", 80.0]', r'leading_edge.points\[0\].x is "near": a number'),
        ("points = [[-60.0, 90.0]", "pts = [[-60.0, 90.0]", "flow_path.hub.pts does not exist"),
        ("[0.0, 128.0]", "[0.0, true]", r"flow_path.stream_surfaces\[0\].points\[1\].r is true: a number"),
    ],
)
def test_a_meridian_that_a_file_gets_wrong_is_refused_where_it_is_wrong(old, new, message):
    text = text_of(STATOR)
    assert old in text
    with pytest.raises(DesignError, match=message):
        design_from(parsed(text.replace(old, new, 1), "file"), "file")
