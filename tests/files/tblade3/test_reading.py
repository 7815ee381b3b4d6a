"""T-Blade3's input files: every layout that its reader takes is read to the same record."""

import math
from dataclasses import replace

import pytest

from bladewright.files.tblade3 import is_tblade3, read_tblade3
from bladewright.files.tblade3.case import LEADING_EDGE
from bladewright.files.tblade3.fortran_input import fortran_number, list_directed_items

from .inputs import EDGE, LAWS, OLDER, SECTIONWISE, SPANWISE, STREAMLINES, lines, place_of, written

REMARKS = {"file": "", "companion": "", "unused": (), "unsupported": (), "notes": ()}


def plain(case):
    """A case without what depends on where its files lie, and without remarks."""
    return replace(case, **REMARKS)


def test_every_number_of_the_main_file_is_in_the_case(tmp_path):
    case = read_tblade3(written(tmp_path))
    assert (case.title, case.name, case.row, case.suffix, case.blade_count) == (
        "Input of our own",
        "windmill",
        7,
        "7",
        11,
    )
    assert (case.unit, case.scale, case.unit_length, case.theta_offset) == ("mm", 250.0, 0.25, 0.0)
    assert (case.angles, case.angle_spline, case.curvature_camber, case.spanwise) == ("axial", "", True, True)
    assert (case.thickness, case.thickness_multiplier, case.leading_edge, case.chord) == (
        "naca",
        False,
        "elliptic",
        "multiplied",
    )
    assert (case.true_sweep, case.true_lean) == (False, False)
    assert (case.clustering, case.clustering_parameter) == ("elliptic", 15.0)
    row = case.sections[1]
    assert (row.label, row.in_beta, row.out_beta, row.mach, row.chord) == (2, -45.0, -20.0, 0.72, 0.45)
    assert (row.thickness, row.incidence, row.deviation, row.secondary_flow_angle) == (0.08, 1.0, 2.0, 0.0)
    assert (row.type, row.stack_u, row.stack_v, row.thickest) == ("sect1", 40.0, -15.0, 0.4)
    assert (row.leading_thickness, row.trailing_thickness) == (0.018, 0.009)
    assert case.leading_curve == ((0.10, 0.50), (0.12, 1.0))
    assert case.trailing_curve == ((0.40, 0.52), (0.38, 0.99))
    assert case.blending == ((0.0, 1.0, 0.0), (1.0, 1.0, 0.0))
    laws = (case.sweep, case.lean, case.in_beta, case.out_beta, case.chord_multiplier, case.thickness_multipliers)
    for law, (_, rows) in zip(laws, LAWS.values(), strict=True):
        assert tuple(zip(law.span, law.values, strict=True)) == rows
    assert case.thickest is None
    assert (case.hub_offset, case.hub_inflation, case.tip_offset, case.tip_inflation) == (0.0, None, 0.0, None)
    assert case.streamlines == tuple(STREAMLINES.values())


def test_every_number_of_the_span_tables_is_in_the_case(tmp_path):
    case = read_tblade3(written(tmp_path))
    assert case.companion == str(tmp_path / "spancontrolinputs.7.dat")
    assert case.meanlines.span == (0.0, 0.45, 1.0)
    assert case.meanlines.u[1] == (0.0, 0.25, 0.55, 0.85, 1.0)
    assert case.meanlines.curvature[2] == (0.3, 0.2, 0.6, 0.4, 0.2)
    naca = case.naca
    assert naca.span == (0.0, 0.5, 1.0)
    assert (naca.leading_index, naca.thickest) == ((4.0, 4.5, 5.0), (0.35, 0.40, 0.45))
    assert (naca.thickness, naca.trailing_thickness) == ((0.12, 0.09, 0.05), (0.02, 0.015, 0.01))
    assert (naca.trailing_slope, naca.slope_normalised, naca.spline_switch) == (None, False, 1)
    assert case.multipliers is None
    assert case.leading_edges is None


@pytest.mark.parametrize(("name", "normalised"), [("dy_dx_TE", False), ("dy_dx_norm", True)])
def test_a_sixth_column_is_the_slope_at_the_trailing_edge(tmp_path, name, normalised):
    head, _, tail = SPANWISE.rpartition("t_TE\n")
    rows = "".join(f"{row}  -0.{i}\n" for i, row in enumerate(tail.splitlines(), 1))
    naca = read_tblade3(written(tmp_path, f"{head}t_TE {name}\n{rows}")).naca
    assert naca.trailing_slope == (-0.1, -0.2, -0.3)
    assert naca.slope_normalised is normalised
    assert naca.trailing_thickness == (0.02, 0.015, 0.01)


def test_the_older_span_tables_give_the_first_curvature_and_the_ends_of_the_multiplier(tmp_path):
    case = read_tblade3(written(tmp_path, OLDER, thickness="1", multiplier="1", edge="1"))
    assert case.meanlines.u == ((0.0, 0.2, 0.5, 0.8, 1.0), (0.0, 0.3, 0.6, 0.9, 1.0))
    assert case.meanlines.curvature == ((0.0, 0.6, 0.4, 0.2, 0.05), (0.0, 0.2, 0.6, 0.4, 0.2))
    assert case.multipliers.u == ((0.0, 0.3, 0.7, 1.0), (0.0, 0.4, 0.6, 1.0))
    assert case.multipliers.values == ((0.0, 0.1, 0.2, 0.0), (0.0, 0.3, 0.4, 0.0))
    edges = case.leading_edges
    assert (edges.degree, edges.segments, edges.span) == (4, 5, (0.0, 1.0))
    assert dict(zip(LEADING_EDGE, edges.values[1], strict=True)) == {
        **dict(zip(LEADING_EDGE, map(float, EDGE.split()), strict=True)),
        "leading_thickness": 0.04,
    }


def test_the_older_span_tables_may_give_the_multiplier_at_the_trailing_edge(tmp_path):
    text = OLDER.replace("0.10  0.20\n", "0.10  0.20  0.6\n").replace("0.30  0.40\n", "0.30  0.40  0.7\n")
    case = read_tblade3(written(tmp_path, text, thickness="1", multiplier="1"))
    assert case.multipliers.values == ((0.0, 0.1, 0.2, 0.6), (0.0, 0.3, 0.4, 0.7))


@pytest.mark.parametrize("switches", [{"multiplier": "1"}, {"edge": "1"}, {}])
def test_tables_that_no_switch_asks_for_are_passed_over(tmp_path, switches):
    case = read_tblade3(written(tmp_path, OLDER, thickness="1", **switches))
    assert (case.leading_edges is not None) == ("edge" in switches)
    by_section = read_tblade3(written(tmp_path, SECTIONWISE, "controlinputs", thickness="1", camber="1", **switches))
    assert (by_section.leading_edges is not None) == ("edge" in switches)


def test_control_points_section_by_section_may_differ_in_number(tmp_path):
    case = read_tblade3(
        written(tmp_path, SECTIONWISE, "controlinputs", camber="1", thickness="2", multiplier="1", edge="1")
    )
    assert case.companion.endswith("controlinputs.7.dat")
    assert case.thickness == "quartic-sharp"
    assert [len(row) for row in case.meanlines.u] == [4, 5, 6]
    assert case.meanlines.span is None
    assert case.meanlines.u[1] == (0.0, 0.25, 0.5, 0.75, 1.0)
    assert case.meanlines.curvature[0] == pytest.approx((0.1, 0.3, 0.5, 0.7))
    assert case.multipliers.values == ((0.0, 0.1, 0.0), (0.0, 0.2, 0.0), (0.0, 0.3, 0.0))
    assert [row[0] for row in case.leading_edges.values] == [0.01, 0.02, 0.03]


def test_camber_and_thickness_without_control_points_need_no_second_file(tmp_path):
    case = read_tblade3(written(tmp_path, None, camber="0", thickness="0"))
    assert (case.companion, case.meanlines, case.naca) == (None, None, None)


LAYOUTS = {
    "commas": {"sections_1": "1,-40.0,-10.0,0.61,0.50,0.10,1.5,2.5,0.0"},
    "a slash ends a line": {"sections_1": " 1 -40.0 -10.0 0.61 0.50 0.10 1.5 2.5 0.0 / and words"},
    "words behind the numbers": {"sweep_1": " 0.0 0.01 ! at the hub", "blades": "11 blades", "row": "7 rotor"},
    "exponents of Fortran": {"sections_2": " 2 -4.5D+01 -.2d2 72.0-2 45.E-2 8E-2 1. 2. 0."},
    "repeat counts": {"blending_1": " 0.0 1 0", "hub": " 1*0.0", "lean_3": "1.0, 1*0"},
    "tabs": {"curves_1": "\t0.10\t0.50\t0.40\t0.52"},
    "a row on two lines": {"sections_3": " 3 -50.0 -55.0 0.83 0.40\n 0.06 0.5 1.0 0.0"},
    "blank lines before numbers": {"streamlines": "\n   3", "in_beta_2": "\n  0.3  -1.0"},
    "other titles": {
        key: "anything 1 2 3"
        for key in lines()
        if key.endswith(("_title", "_blank")) and key not in ("scale_title", "stream_blank", "stream_title")
    },
    "other headers": {
        key: "anything at all"
        for key in lines()
        if key.endswith("_header") and key not in ("tm_header", "stream_header")
    },
    "texts above the streamlines": {"stream_title": "one\n\ntwo\n3 three"},
    "text behind the streamlines": {"stream_3_end": " 0 0\n whatever follows\n 1 2 3"},
    "a streamline closed by a radius of zero": {"stream_2_end": "  0.75  0.0"},
    "a comma in the closing row": {"stream_1_end": "0,0"},
    "columns of a grid": {
        "types_header": " J  type |stk_u |stk_v |umxthk |lethk |tethk |Jcells(Grid:4n+1) |eta_ofst |BGgrid |",
        "types_1": " 1  sect1 30.0   5.0  0.35  0.020  0.010 15 10 0",
        "types_2": " 2  sect1 40.0 -15.0  0.40  0.018  0.009 15 10 0",
        "types_3": " 3  sect1 50.0   0.0  0.45  0.016  0.008 15 10 0",
    },
    "more blending switches": {"blending_count": " 2 0 0 0 0"},
    "a whole number with a point": {"blades": " 11."},
    "leading zeros": {"code": "  +055020"},
    "a title that starts with Airfoil": {"thickness_title": "Airfoil, 0 to 5"},
}


@pytest.mark.parametrize("name", LAYOUTS)
def test_a_layout_that_fortran_reads_alike_gives_the_same_case(tmp_path, name):
    plainly = plain(read_tblade3(written(tmp_path)))
    case = read_tblade3(written(tmp_path, **LAYOUTS[name]))
    assert plain(case) == plainly
    assert any("Jcells" in sentence for sentence in case.unused) == (name == "columns of a grid")


def test_line_ends_of_windows_and_a_byte_order_mark_change_nothing(tmp_path):
    path = written(tmp_path)
    plainly = read_tblade3(path)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().replace(b"\n", b"\r\n"))
    assert read_tblade3(path) == plainly


@pytest.mark.parametrize(
    ("changes", "field", "value"),
    [
        ({"scale": " 250.0  4.5"}, "theta_offset", 4.5),
        ({"scale_title": " Blade Scaling factor (cm):"}, "unit", "cm"),
        ({"scale_title": " Blade Scaling factor (m):"}, "unit", "m"),
        ({"scale_title": " Blade Scaling factor (m )"}, "unit", "m"),
        ({"angles": " 1 inletspline"}, "angle_spline", "inletspline"),
        ({"angles": " 2"}, "angles", "axial-radial"),
        ({"angles": " 3 outletspline"}, "angles", "radial-axial"),
        ({"angles": " 4  inoutspline"}, "angles", "wing"),
        ({"angles": " 0 inci_dev_spline"}, "angle_spline", "inci_dev_spline"),
        ({"chord": "0"}, "chord", "meridional"),
        ({"chord": "1"}, "chord", "given"),
        ({"true": "1"}, "true_sweep", True),
        ({"true": "1"}, "true_lean", True),
        ({"clustering": "0"}, "clustering", "uniform"),
        ({"clustering": "1 2.5"}, "clustering_parameter", 2.5),
        ({"clustering": "2 1"}, "clustering", "exponential"),
        ({"clustering": "3 1"}, "clustering", "hyperbolic"),
        ({"multiplier": "1"}, "thickness_multiplier", True),
        ({"hub": " -0.015  0.03"}, "hub_inflation", 0.03),
        ({"hub": " -0.015  0.03"}, "hub_offset", -0.015),
        ({"tip": " 0.02"}, "tip_offset", 0.02),
        ({"tip": " 0.02 0.01 words"}, "tip_inflation", 0.01),
        ({"tip": " 0.02 words"}, "tip_inflation", None),
        ({"name": " 'two words'"}, "name", "two words"),
    ],
)
def test_a_switch_or_an_optional_number_is_read(tmp_path, changes, field, value):
    assert getattr(read_tblade3(written(tmp_path, **changes)), field) == value


@pytest.mark.parametrize(
    ("header", "row", "multiplier", "thickest"),
    [
        ("span tm/c", "0.5", 0.5, None),
        ("span u_max", "0.4", None, 0.4),
        ("span tm/c u_max", "0.5 0.4", 0.5, 0.4),
        ("span u_max tm/c", "0.4 0.5", 0.5, 0.4),
    ],
)
def test_the_header_says_which_thickness_columns_follow(tmp_path, header, row, multiplier, thickest):
    case = read_tblade3(written(tmp_path, tm_header=header, tm_1=f"0.0 {row}", tm_2=f"1.0 {row}"))
    found = [law and law.values for law in (case.thickness_multipliers, case.thickest)]
    assert found == [value and (value, value) for value in (multiplier, thickest)]


@pytest.mark.parametrize(
    ("code", "centroid", "along", "above"),
    [
        ("000000", False, 0.0, 0.0),
        ("100000", False, 1.0, 0.0),
        ("025000", False, 0.25, 0.0),
        ("050030", False, 0.5, 0.3),
        ("-050030", False, 0.5, -0.3),
        ("200000", True, 2.0, 0.0),
    ],
)
def test_the_stacking_code_holds_chord_and_height(tmp_path, code, centroid, along, above):
    stackings = read_tblade3(written(tmp_path, code=code)).stackings
    assert len(stackings) == 3
    assert len(set(stackings)) == 1
    assert (stackings[0].centroid, stackings[0].along, stackings[0].above) == (centroid, along, above)


def test_variable_stacking_takes_the_point_of_each_section(tmp_path):
    changes = {"radial": "1", "types_3": " 3  sect1 200  0.0  0.45  0.016  0.008"}
    stackings = read_tblade3(written(tmp_path, **changes)).stackings
    assert [each.along for each in stackings[:2]] == [0.3, 0.4]
    assert [each.above for each in stackings] == [0.05, -0.15, 0.0]
    assert [each.centroid for each in stackings] == [False, False, True]


def test_a_count_beside_column_twelve_is_read_whole_and_said(tmp_path):
    case = read_tblade3(written(tmp_path, sweep_count="3"))
    assert len(case.sweep.span) == 3
    assert any(f"column 12 of line {place_of('sweep_count')}" in note for note in case.notes)
    assert not any("column 12" in note for note in read_tblade3(written(tmp_path)).notes)


def test_a_unit_that_the_columns_contradict_is_that_of_the_columns_and_said(tmp_path):
    case = read_tblade3(written(tmp_path, scale_title="Blade Scaling factor (mm):"))
    assert case.unit_length == 250.0
    assert any("characters 24 and 25" in note for note in case.notes)


def test_an_early_file_without_the_later_switches_is_read(tmp_path):
    case = read_tblade3(written(tmp_path, without=("true_title", "true", "clustering_title", "clustering")))
    assert (case.true_sweep, case.true_lean, case.clustering) == (False, False, "uniform")
    assert len(case.sections) == 3
    assert any("early version" in note for note in case.notes)


EARLY = ("true_title", "true", "clustering_title", "clustering")


@pytest.mark.parametrize("switch", ["0", "1"])
def test_an_early_file_has_true_sweep_and_lean_in_a_third_column_where_column_15_is_a_switch(tmp_path, switch):
    rows = {f"lean_{i}": f"  {span}  9.0  {value}" for i, span, value in ((1, 0.0, 0.3), (2, 0.4, 0.2), (3, 1.0, 0.1))}
    case = read_tblade3(written(tmp_path, without=EARLY, lean_count=f"           3  {switch}", **rows))
    assert (case.true_sweep, case.true_lean) == (False, switch == "1")
    assert case.lean.values == (0.3, 0.2, 0.1)
    assert case.sweep.values == read_tblade3(written(tmp_path)).sweep.values


def test_a_third_column_of_an_early_file_without_its_switch_has_no_effect_and_that_is_said(tmp_path):
    changes = {"sweep_header": " span delta_m true_sweep", "sweep_2": "  0.5  0.02  7.0"}
    case = read_tblade3(written(tmp_path, without=EARLY, **changes))
    assert case.sweep.values[1] == 0.02
    assert any("the column true_sweep has no effect: column 15" in note for note in case.notes)


def test_a_current_file_has_no_switch_in_column_15(tmp_path):
    case = read_tblade3(written(tmp_path, lean_count="           3  1"))
    assert not case.true_lean


def test_the_files_of_a_case_share_the_text_between_the_last_two_dots(tmp_path):
    case = read_tblade3(written(tmp_path, file_name="my.3dbgbinput.2offset.dat"))
    assert case.suffix == "2offset"
    assert case.companion.endswith("spancontrolinputs.2offset.dat")


def test_letters_of_the_second_file_may_be_large_or_small(tmp_path):
    path = written(tmp_path)
    (tmp_path / "spancontrolinputs.7.dat").rename(tmp_path / "SpanControlInputs.7.DAT")
    assert read_tblade3(path).naca is not None


def test_what_has_no_effect_is_said_and_what_has_is_not(tmp_path):
    case = read_tblade3(written(tmp_path))
    assert any("mrel_in" in sentence for sentence in case.unused)
    assert any("table in_beta*" in sentence for sentence in case.unused)
    assert not any("chord_multiplier" in sentence for sentence in case.unused)
    splined = read_tblade3(written(tmp_path, angles="0 inci_dev_spline", chord="1"))
    assert not any("table in_beta*" in sentence for sentence in splined.unused)
    assert any("Incidence and Deviation" in sentence for sentence in splined.unused)
    assert any("chord_multiplier" in sentence for sentence in splined.unused)
    assert not any("column chord" in sentence for sentence in splined.unused)
    assert case.unsupported == ()


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"types_2": " 2  crcle 40.0 -15.0  0.40  0.018  0.009"}, "'crcle'"),
        ({"types_1": " 1  2412 40.0 -15.0  0.40  0.018  0.009"}, "'2412', the four-digit profile NACA 2412"),
        ({"types_3": " 3  mine 40.0 -15.0  0.40  0.018  0.009"}, "'mine', which T-Blade3 takes for the name of a file"),
        ({"hub": "0.0 0.02"}, "hub inflation 0.02"),
        ({"hub": "0.0 0.02"}, "the blade is the one without it"),
        ({"tip": "0.0 -0.01"}, "tip inflation -0.01"),
        ({"sections_1": " 1  999.0  -10.0  0.61  0.50  0.10  1.5  2.5  0.0"}, "staggers"),
    ],
)
def test_what_goes_beyond_meanline_and_thickness_is_said(tmp_path, changes, said):
    assert any(said in sentence for sentence in read_tblade3(written(tmp_path, **changes)).unsupported)


def test_what_t_blade3_itself_fails_at_is_said(tmp_path):
    assert any("1.2.2" in note for note in read_tblade3(written(tmp_path, OLDER, thickness="1")).notes)
    assert any("wrong stagger" in note for note in read_tblade3(written(tmp_path, true="1")).notes)
    assert read_tblade3(written(tmp_path)).notes == ()


def test_a_main_input_file_is_told_from_others():
    assert is_tblade3("\n".join(lines().values()))
    assert not is_tblade3(SPANWISE)
    assert not is_tblade3("NDIM = 2\nN_BLADES = 3\nstagger = -30")


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("1 2,3 , 4", ["1", "2", "3", "4"]),
        ("3*0.5 2*", ["0.5", "0.5", "0.5", None, None]),
        ("1,,2", ["1", None, "2"]),
        (",1", [None, "1"]),
        ("1 / 2", ["1"]),
        ("1 2/", ["1", "2"]),
        ("'a, b' c", ["a, b", "c"]),
        ("", []),
    ],
)
def test_a_line_falls_into_values_as_in_fortran(line, expected):
    assert list_directed_items(line) == expected


@pytest.mark.parametrize(
    ("word", "value"),
    [
        ("1", 1),
        ("-1.5D-3", -1.5e-3),
        (".5", 0.5),
        ("5.", 5),
        ("+2d1", 20),
        ("1.5-3", 1.5e-3),
        ("2Q0", 2),
        ("1E+2", 100),
    ],
)
def test_a_word_is_the_number_that_fortran_reads(word, value):
    assert math.isclose(fortran_number(word), value, rel_tol=1e-15)


@pytest.mark.parametrize("word", ["", "one", "1.2.3", "1e", "nan", "inf", "1e999", "--1", "0x10", "1_000", None])
def test_a_word_that_is_no_number_is_none(word):
    assert fortran_number(word) is None


def test_a_table_of_multipliers_that_is_not_asked_for_may_hold_anything(tmp_path):
    odd = OLDER.replace("   0.3  0.7  0.10  0.20", "   0.3").replace("   0.4  0.6  0.30  0.40", "   0.4")
    case = read_tblade3(written(tmp_path, odd, thickness="1", edge="1"))
    assert case.multipliers is None
    assert len(case.leading_edges.values) == 2


def test_a_table_of_multipliers_along_the_span_is_taken_whole_and_that_is_said(tmp_path):
    case = read_tblade3(written(tmp_path, OLDER, thickness="1", multiplier="1"))
    assert any("reads the first half of the table" in note for note in case.notes)


@pytest.mark.parametrize(
    "changed",
    [
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace("\n", "\r"),
        lambda text: text.replace("\n", " \f\n"),
        lambda text: text.replace("\n", " \u2028\n"),
        lambda text: text.rstrip("\n"),
        lambda text: "\ufeff" + text,
    ],
    ids=["of Windows", "of old", "a form feed", "a separator", "none at the end", "a mark before the first"],
)
def test_line_ends_and_marks_of_editors_change_nothing(tmp_path, changed):
    path = written(tmp_path)
    expected = plain(read_tblade3(path))
    for file in tmp_path.glob("*.dat"):
        file.write_bytes(changed(file.read_text()).encode())
    assert plain(read_tblade3(path)) == expected
