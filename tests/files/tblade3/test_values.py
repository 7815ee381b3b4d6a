"""T-Blade3's rules for the values of each section: splines along the span, angles, thicknesses."""

import numpy as np
import pytest
from scipy.interpolate import BSpline
from scipy.optimize import brentq

from bladewright.errors import FileError
from bladewright.files.tblade3 import SpanSpline, metal_angles, read_tblade3, section_spans, section_values

from .inputs import OLDER, SECTIONWISE, SPANWISE, written

SPANS = np.array([0.0, 0.42, 1.0])
CLOSE = 1e-14
"""a few roundings of numbers about 1"""


def witness(span, values, at):
    """The spline by scipy, its parameter by a search for the span."""
    points = np.column_stack([span, values])
    points = np.vstack([2 * points[0] - points[1], points, 2 * points[-1] - points[-2]])
    curve = BSpline(np.arange(len(points) + 4.0), points, 3)
    ends = 3.0, float(len(points))
    return [float(curve(brentq(lambda t, s=s: curve(t)[0] - s, *ends, xtol=1e-15))[1]) for s in at]


@pytest.mark.parametrize("count", [2, 3, 4, 8])
def test_a_spline_along_the_span_is_the_uniform_cubic_one_with_a_point_more_at_both_ends(count):
    draw = np.random.default_rng(count)
    span = np.concatenate([[0.0], np.sort(draw.uniform(0.05, 0.95, count - 2)), [1.0]])
    values = draw.normal(size=(count, 2))
    at = np.linspace(0.02, 0.98, 25)
    found = SpanSpline(span=span, values=values)(at)
    for column in (0, 1):
        assert found[:, column] == pytest.approx(witness(span, values[:, column], at), abs=1e-13)


def test_a_spline_meets_its_first_and_last_control_point_and_keeps_them_beyond():
    spline = SpanSpline(span=np.array([0.0, 0.3, 1.0]), values=np.array([0.3, -1.0, 0.7]))
    assert spline([0.0, 1.0, -0.5, 1.5]).tolist() == [0.3, 0.7, 0.3, 0.7]


def test_a_spline_of_control_points_on_a_line_is_that_line():
    span = np.array([0.0, 0.1, 0.25, 0.7, 1.0])
    at = np.linspace(0.0, 1.0, 41)
    assert SpanSpline(span=span, values=3.0 - 2.0 * span)(at) == pytest.approx(3.0 - 2.0 * at, abs=CLOSE)


def test_a_spline_is_continuous_where_its_segments_meet():
    span, values = np.array([0.0, 0.3, 0.5, 1.0]), np.array([0.3, -1.0, 0.7, 2.0])
    joints = (span[:-2] + 4.0 * span[1:-1] + span[2:]) / 6.0
    spline = SpanSpline(span=span, values=values)
    there = (values[:-2] + 4.0 * values[1:-1] + values[2:]) / 6.0
    for shift in (-1e-14, 0.0, 1e-14):
        assert spline(joints + shift) == pytest.approx(there, abs=1e-12)


def test_spans_are_measured_by_radius_or_along_the_axis():
    assert section_spans([(0.0, 0.5), (0.3, 0.6), (0.1, 1.0)]) == pytest.approx([0.0, 0.2, 1.0])
    assert section_spans([(0.0, 1.0), (-0.1, 0.9), (-0.4, 1.0)], along_axis=True) == pytest.approx([0.0, 0.25, 1.0])
    for along_axis, points in ((False, [(0.1, 0.5), (0.4, 0.5)]), (True, [(0.1, 0.5), (0.1, 0.9)])):
        with pytest.raises(FileError, match="there is none"):
            section_spans(points, along_axis=along_axis)


def test_a_law_is_evaluated_at_each_section_and_only_where_its_switch_asks_for_it(tmp_path):
    case = read_tblade3(written(tmp_path))
    values = section_values(case, SPANS)
    for found, law in ((values.sweep, case.sweep), (values.lean, case.lean)):
        assert found[1] == pytest.approx(witness(law.span, law.values, SPANS[1:2])[0], abs=CLOSE)
        assert found[[0, 2]].tolist() == [law.values[0], law.values[-1]]
    law = case.chord_multiplier
    assert values.chord_multiplier[1] == pytest.approx(1.0 + witness(law.span, law.values, SPANS[1:2])[0], abs=CLOSE)
    assert values.chord is None
    assert values.stagger is None
    given = section_values(read_tblade3(written(tmp_path, chord="1", scale="250 90")), SPANS)
    assert given.chord.tolist() == [0.50, 0.45, 0.40]
    assert given.chord_multiplier.tolist() == [1.0, 1.0, 1.0]
    assert given.theta_offset == pytest.approx(np.pi / 2.0, rel=1e-15)


def test_meanlines_are_splined_column_by_column(tmp_path):
    case = read_tblade3(written(tmp_path))
    meanlines = section_values(case, SPANS).meanlines
    assert [line.shape for line in meanlines] == [(5, 2)] * 3
    table = case.meanlines
    for column in range(5):
        for part, rows in enumerate((table.u, table.curvature)):
            values = [row[column] for row in rows]
            assert meanlines[1][column, part] == pytest.approx(witness(table.span, values, SPANS[1:2])[0], abs=CLOSE)
            assert meanlines[0][column, part] == values[0]


def test_straight_ends_and_a_cubic_have_no_control_points(tmp_path):
    values = section_values(read_tblade3(written(tmp_path, camber="0 spanwise_spline")), SPANS)
    assert values.meanlines is None


def test_control_points_of_a_section_are_taken_as_they_stand(tmp_path):
    switches = {"camber": "1", "thickness": "1", "multiplier": "1", "edge": "1"}
    case = read_tblade3(written(tmp_path, SECTIONWISE, "controlinputs", **switches))
    values = section_values(case, SPANS)
    assert [line.tolist() for line in values.meanlines] == [
        [list(pair) for pair in zip(u, c, strict=True)]
        for u, c in zip(case.meanlines.u, case.meanlines.curvature, strict=True)
    ]
    assert [points.tolist()[1] for points in values.multipliers] == [[0.4, 0.1], [0.4, 0.2], [0.4, 0.3]]
    assert values.leading_edges[:, 0].tolist() == [0.01, 0.02, 0.03]


def test_tables_of_the_older_format_are_splined(tmp_path):
    case = read_tblade3(written(tmp_path, OLDER, thickness="1", multiplier="1", edge="1"))
    values = section_values(case, SPANS)
    # of two control points the spline is the straight line between them
    assert values.multipliers[1] == pytest.approx(
        np.column_stack([[0.0, 0.342, 0.658, 1.0], [0.0, 0.184, 0.284, 0.0]]), abs=CLOSE
    )
    assert values.leading_edges[:, 0] == pytest.approx([0.02, 0.0284, 0.04], abs=CLOSE)
    # a leading edge that is a spline brings its own thicknesses
    assert values.leading_thickness.tolist() == values.leading_edges[:, 0].tolist()
    assert values.trailing_thickness == pytest.approx([0.01, 0.01, 0.01], abs=CLOSE)


@pytest.mark.parametrize(
    ("word", "inlet", "exits"),
    [
        # flow angles -40, -45, -50 and -10, -20, -55; the camber of the last turns the other way
        ("", [-38.5, -44.0, -49.5], [-7.5, -18.0, -56.0]),
        ("inci_dev_spline", [-37.0, None, -48.0], [-6.0, None, -61.0]),
        ("inletspline", [1.5, None, 1.5], [-12.5, -22.0, -56.0]),
        ("outletspline", [-38.5, -44.0, -49.5], [6.5, None, 7.0]),
        ("inoutspline", [1.5, None, 1.5], [6.5, None, 7.0]),
    ],
)
def test_metal_angles_are_flow_angles_less_incidence_and_deviation(tmp_path, word, inlet, exits):
    values = section_values(read_tblade3(written(tmp_path, angles=f"0 {word}")), SPANS)
    for found, expected in ((values.angle_in, inlet), (values.angle_out, exits)):
        for value, number in zip(found, expected, strict=True):
            assert number is None or value == pytest.approx(number, abs=1e-13)


@pytest.mark.parametrize(("switch", "radial"), [(0, (0, 0)), (1, (1, 1)), (2, (0, 1)), (3, (1, 0))])
def test_angles_belong_to_one_direction_on_the_stream_surface(tmp_path, switch, radial):
    case = read_tblade3(written(tmp_path, angles=f" {switch}"))
    values = section_values(case, SPANS)
    phi = np.array([[0.1, 0.7, 1.2], [0.2, 0.9, 1.5]])
    angles = metal_angles(case, values, *phi)
    for found, given, slope, across in zip(
        (angles.inlet, angles.exit), (values.angle_in, values.angle_out), phi, radial, strict=True
    ):
        # a direction of unit meridional part has these parts along x, along r and around
        along, up, around = np.cos(slope), np.sin(slope), np.tan(found)
        assert np.degrees(np.arctan(around / (up if across else along))) == pytest.approx(given, abs=1e-12)
    assert angles.camber == pytest.approx(angles.exit - angles.inlet, abs=CLOSE)
    assert angles.stagger is None


def test_a_wing_has_its_twist_as_stagger_and_its_camber(tmp_path):
    case = read_tblade3(written(tmp_path, angles="4"))
    values = section_values(case, SPANS)
    angles = metal_angles(case, values, np.zeros(3), np.zeros(3))
    assert angles.stagger == pytest.approx(np.radians(values.angle_in), abs=CLOSE)
    assert angles.camber == pytest.approx(np.radians(values.angle_out), abs=CLOSE)
    assert angles.inlet is None


def test_an_inlet_angle_of_999_makes_the_table_one_of_staggers(tmp_path):
    case = read_tblade3(written(tmp_path, sections_1=" 1  999.0  -10.0  0.61  0.50  0.10  1.5  2.5  0.0"))
    values = section_values(case, SPANS)
    assert values.stagger[[0, 2]].tolist() == [3.0, 2.0]
    assert metal_angles(case, values, SPANS, SPANS).stagger[0] == pytest.approx(np.radians(3.0), rel=1e-15)


def test_thicknesses_of_the_modified_naca_law_are_splined(tmp_path):
    case = read_tblade3(written(tmp_path))
    values = section_values(case, SPANS)
    assert values.leading_index == pytest.approx([4.0, 4.42, 5.0], abs=CLOSE)
    assert values.thickest == pytest.approx([0.35, 0.392, 0.45], abs=CLOSE)
    assert values.thickness[1] == pytest.approx(witness((0.0, 0.5, 1.0), (0.12, 0.09, 0.05), [0.42])[0], abs=CLOSE)
    assert values.trailing_thickness == pytest.approx([0.02, 0.0158, 0.01], abs=CLOSE)
    assert values.trailing_slope is None


@pytest.mark.parametrize("name", ["dy_dx_TE", "dy_dx_norm"])
def test_a_slope_at_the_trailing_edge_is_that_of_the_half_thickness(tmp_path, name):
    head, _, tail = SPANWISE.rpartition("t_TE\n")
    factor = -0.2 if name == "dy_dx_TE" else 1.7
    rows = "".join(f"{row}  {factor}\n" for row in tail.splitlines())
    values = section_values(read_tblade3(written(tmp_path, f"{head}t_TE {name}\n{rows}")), SPANS)
    expected = np.full(3, -0.2) if name == "dy_dx_TE" else -1.7 * values.thickness
    assert values.trailing_slope == pytest.approx(expected, abs=CLOSE)


def test_other_thicknesses_are_those_of_the_sections_multiplied(tmp_path):
    changes = {"tm_header": "span tm/c u_max", "tm_1": "0 0 0", "tm_2": "1 0.5 0.6"}
    values = section_values(read_tblade3(written(tmp_path, OLDER, thickness="1", **changes)), SPANS)
    assert values.thickness == pytest.approx([0.10, 0.08 * 1.21, 0.09], abs=CLOSE)
    # where u_max is 0 the section's own place holds
    assert values.thickest == pytest.approx([0.35, 0.252, 0.6], abs=CLOSE)
    assert values.leading_thickness.tolist() == [0.020, 0.018, 0.016]
    assert values.trailing_thickness.tolist() == [0.010, 0.009, 0.008]


def test_spans_that_are_not_one_for_each_section_are_refused(tmp_path):
    with pytest.raises(FileError, match="2 spans are given for the 3 sections"):
        section_values(read_tblade3(written(tmp_path)), [0.0, 1.0])
