"""T-Blade3 files that describe no blade are refused in one paragraph, with file, line and cure."""

import re

import pytest

from bladewright.errors import FileError
from bladewright.files.tblade3 import read_tblade3

from .inputs import OLDER, SECTIONWISE, SPANWISE, lines, place_of, written

TEXTS = [
    key
    for key in lines()
    if key.endswith(("_title", "_blank", "_header", "title_1", "title_2", "title_3", "title_4"))
    or key in ("title", "name")
]
NUMBERS = [key for key in lines() if key not in TEXTS]
OLD = {"thickness": "1", "multiplier": "1", "edge": "1"}


def refusal(path):
    with pytest.raises(FileError) as caught:
        read_tblade3(path)
    message = str(caught.value)
    assert "\n" not in message
    assert str(path.parent) in message
    return message


@pytest.mark.parametrize(
    ("key", "line", "said"),
    [
        ("row", "-1", "the blade row's number is -1: it must be at least 0"),
        ("blades", "0", "the number of blades is 0"),
        ("blades", "2.5", "the number of blades is 2.5: a whole number is needed"),
        ("blades", "many", "'many' is no number"),
        ("scale_title", " Blade Scaling factor (in):", "characters 24 and 25 are 'in'"),
        ("scale_title", "", "characters 24 and 25"),
        ("scale", "0.0", "the scaling factor is 0: it must be positive"),
        ("scale", "nan", "the scaling factor must be a number"),
        ("streamlines", "1", "the number of streamlines is 1: it must be at least 2"),
        ("angles", " 5", "none of the digits 0 to 4"),
        ("angles", " 0 or 1", "2 of the digits 0 to 4"),
        ("camber", " 2 spanwise_spline", "the camber switch is '2 spanwise_spline': it must be one of 0, 1"),
        ("camber", " 1 chordwise_spline", "only 'spanwise_spline' may stand there"),
        ("thickness", " 3", "thickness of the kind 3 was removed"),
        ("thickness", " 4", "give one of 0, 1, 2, 5"),
        ("thickness", " 6", "the thickness switch is '6': it must be one of 0, 1, 2, 5"),
        ("multiplier", " 2", "the switch of the thickness multiplier is '2'"),
        ("edge", " 2", "a leading edge with a sting was removed"),
        ("edge", " 3", "the switch of the leading edge is '3': it must be one of 0, 1"),
        ("chord", " 3", "the chord switch is '3': it must be one of 0, 1, 2"),
        ("true", " yes", "the switch of true lean and sweep is 'yes'"),
        ("clustering", " 5 2.0", "the clustering switch is '5 2.0'"),
        ("sections_2", " 2  -45.0  -20.0  0.72", "row 2 of 3 of the sectionwise properties must be 9 numbers"),
        ("sections_2", " 2,,-20.0 0.7 1 1 1 1 1", "an empty place between commas"),
        ("curves_count", " 1", "the number of points of the leading- and trailing-edge curves is 1"),
        ("curves_2", " 0.1 0.2 0.3", "must be 4 numbers, and the line holds 3 numbers"),
        ("radial", " 2", "the switch of variable radial stacking is '2'"),
        ("types_2", " 2  sect1 40.0 -15.0  0.40  0.018", "row 2 of 3 of the types of section"),
        ("types_2", " sect1 40.0 -15.0  0.40  0.018 0.01", "row 2 of 3 of the types of section"),
        ("blending_count", " -1 0 0", "the number of rows of the blending"),
        ("code", " 150000", "150 % of the chord"),
        ("code", " 200", "200 % of the half thickness"),
        ("code", " 25.5", "a whole number is needed"),
        ("sweep_count", "           1", "the number of control points of sweep is 1: it must be at least 2"),
        ("sweep_2", " 0.0  0.02", "span of the control points of sweep is 0 after 0: it must increase"),
        ("lean_2", " 1.4  0.02", "span of the control points of lean is 1 after 1.4: it must increase"),
        ("in_beta_1", " 0.1  3.0", "is 0.1 in the first row, where it must be 0"),
        ("out_beta_2", " 0.9  3.0", "is 0.9 in the last row, where it must be 1"),
        ("tm_header", " span  thickness", "'tm/c' or 'u_max' or both"),
        ("hub", " none", "the hub offset must be a number"),
        ("stream_2_2", " 0.0  -0.75", "streamline 2 of 3 has the radius -0.75"),
        ("stream_2_2", " 0  0", "streamline 2 of 3 is closed after 1 points"),
    ],
)
def test_a_wrong_value_is_refused_with_its_line(tmp_path, key, line, said):
    message = refusal(written(tmp_path, **{key: line}))
    assert said in message
    assert f"line {place_of(key)}:" in message or re.search(rf"line {place_of(key) + 1}:.*after", message)


def test_a_switch_of_an_early_file_that_is_none_is_refused_with_its_line(tmp_path):
    early = ("true_title", "true", "clustering_title", "clustering")
    message = refusal(written(tmp_path, without=early, sweep_count="           3  x"))
    assert f"line {place_of('sweep_count') - 4}: column 15 holds 'x'" in message


def test_a_title_without_airfoil_is_refused_where_the_camber_switch_stands_alone(tmp_path):
    path = written(tmp_path, SECTIONWISE, "controlinputs", camber="1", thickness="1", thickness_title=" Thickness")
    assert f"line {place_of('thickness_title')}: " in refusal(path)


@pytest.mark.parametrize("section", ["stk_u", "stk_v"])
def test_a_stacking_point_off_its_section_is_refused(tmp_path, section):
    point = {"stk_u": "140.0 -15.0", "stk_v": "40.0 -115.0"}[section]
    message = refusal(written(tmp_path, radial="1", types_2=f" 2  sect1 {point}  0.40  0.018  0.009"))
    assert section in message
    assert f"line {place_of('types_2')}:" in message


@pytest.mark.parametrize("kept", range(len(lines()) - 1))
def test_a_file_cut_short_after_any_line_is_refused(tmp_path, kept):
    path = written(tmp_path)
    path.write_text("\n".join(list(lines().values())[:kept]) + "\n")
    refusal(path)


@pytest.mark.parametrize("key", NUMBERS)
def test_a_word_in_the_place_of_any_numbers_is_refused_with_its_line(tmp_path, key):
    assert f"line {place_of(key)}:" in refusal(written(tmp_path, **{key: " oops"}))


FREE = [key for key in NUMBERS if re.fullmatch(r"stream_\d_\d", key)]
"""a streamline may be a point longer or shorter"""


@pytest.mark.parametrize("key", [key for key in NUMBERS if key not in FREE])
def test_a_line_of_numbers_that_is_missing_is_refused(tmp_path, key):
    refusal(written(tmp_path, without=(key,)))


@pytest.mark.parametrize("key", [key for key in NUMBERS if key not in (*FREE, "tip", "stream_3_end")])
def test_a_line_of_numbers_too_many_is_refused_unless_texts_may_follow(tmp_path, key):
    refusal(written(tmp_path, **{key: f"{lines()[key]}\n{lines()[key]}"}))


@pytest.mark.parametrize(
    ("text", "kind", "switches"),
    [
        (SPANWISE, "spancontrolinputs", {}),
        (OLDER, "spancontrolinputs", OLD),
        (SECTIONWISE, "controlinputs", {**OLD, "camber": "1"}),
    ],
    ids=["current", "older", "sectionwise"],
)
def test_a_second_file_cut_short_after_any_line_is_refused(tmp_path, text, kind, switches):
    rows = text.splitlines()
    for kept in range(len(rows)):
        path = written(tmp_path, "\n".join(rows[:kept]) + "\n", kind, **switches)
        if kept == len(rows) - 1 and not rows[kept].strip():
            continue
        assert f"{kind}.7.dat" in refusal(path)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("   3   5", "   3   2", "the number of control points of the curvature is 2"),
        ("   3   5", "   4   5", "row 4 of 4 of the control points of the curvature"),
        ("   3   5", "   3   6", "row 1 of 3 of the control points of the curvature must be 11 numbers"),
        ("   3   5", "   1   5", "the numbers of rows and columns"),
        ("0.45 ", "1.45 ", "it must increase"),
        ("0.25  0.55", "0.55  0.25", "u of the control points of the curvature is 0.25 after 0.55 at the span 0.45"),
        ("LE_radius", "radius", "needs the columns span, LE_radius, u_max, t_max and t_TE"),
        ("0.015", "thin", "'thin' is no number"),
        (
            SPANWISE[SPANWISE.index("\nSpan control points, Chord & thickness") :],
            "",
            "ends without a table of LE_radius",
        ),
    ],
)
def test_a_wrong_span_table_is_refused(tmp_path, old, new, said):
    assert old in SPANWISE
    assert said in refusal(written(tmp_path, SPANWISE.replace(old, new)))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (" 5\nu and v", " 2\nu and v", "the number of the control points of the curvature of section 2 of 3 is 2"),
        ("  0.5 ,", "  0.1 ,", "u of the control points of the curvature of section 2 of 3 is 0.1 after 0.25"),
        ("  1.0 ,", "  0.9 ,", "is 0.9 in the last row, where it must be 1"),
        (" 0 ,.0", " 0 ,o", "the control points of the thickness multiplier of section 1 of 3"),
        ("0.6 0.9", "0.6", "the leading edge of section 1 of 3 must be 13 numbers"),
        ("Thickness multiplier", "Leading edge", "degree and number of segments of the leading edge"),
    ],
)
def test_a_wrong_table_of_a_section_is_refused(tmp_path, old, new, said):
    assert old in SECTIONWISE
    path = written(tmp_path, SECTIONWISE.replace(old, new), "controlinputs", camber="1", **OLD)
    assert said in refusal(path)


@pytest.mark.parametrize(
    ("switches", "wanted"),
    [
        ({}, "spancontrolinputs.7.dat"),
        ({"camber": "0 spanwise_spline", "thickness": "0"}, "spancontrolinputs.7.dat"),
        ({"camber": "1", "thickness": "0"}, "controlinputs.7.dat"),
        ({"camber": "0", "thickness": "1", "multiplier": "1"}, "controlinputs.7.dat"),
        ({"camber": "0", "thickness": "1", "edge": "1"}, "controlinputs.7.dat"),
    ],
)
def test_a_missing_second_file_is_named_with_the_reason(tmp_path, switches, wanted):
    message = refusal(written(tmp_path, None, **switches))
    assert f"{tmp_path / wanted}'" in message
    assert "there is none" in message


def test_a_second_file_of_another_row_is_named(tmp_path):
    path = written(tmp_path, None)
    (tmp_path / "spancontrolinputs.8.dat").write_text(SPANWISE)
    assert "beside it are spancontrolinputs.8.dat" in refusal(path)


def test_a_name_without_a_row_is_refused_where_a_second_file_is_needed(tmp_path):
    path = written(tmp_path).rename(tmp_path / "rotor.dat")
    assert "name it 3dbgbinput.R.dat" in refusal(path)


def test_the_second_file_alone_is_refused_with_the_name_of_the_first(tmp_path):
    written(tmp_path)
    assert f"{tmp_path / '3dbgbinput.7.dat'}" in refusal(tmp_path / "spancontrolinputs.7.dat")


@pytest.mark.parametrize(("changes", "said"), [({"camber": "1"}, "on line 14"), ({"edge": "1"}, "line 20, to 0")])
def test_switches_that_exclude_each_other_are_refused(tmp_path, changes, said):
    assert said in refusal(written(tmp_path, **changes))


def test_the_older_format_is_refused_for_the_modified_naca_thickness(tmp_path):
    assert "a file of the older format has no such thickness" in refusal(written(tmp_path, OLDER))


def test_a_file_that_is_not_there_is_refused(tmp_path):
    assert "there is no file" in refusal(tmp_path / "3dbgbinput.1.dat")
