"""The station table on the command line: as text, JSON and CSV; rotation and its warning; bad stations."""

import csv

import numpy as np
import pytest

from bladewright.files.reading import read_design

SECTION = """
family = "unified-section"
length_unit = "in"
name = "vane"
pitch = 1.2
axial_chord = 1.0
stagger = -30.0
metal_angle_in = 10.0
metal_angle_out = -60.0
tangent_in = 0.4
tangent_out = 0.5
leading_edge_radius = 0.02
trailing_edge_radius = 0.01
thickness_upper = [0.05, 0.08, 0.03]
thickness_lower = [0.05, 0.06, 0.03]
"""


def columns_of(text):
    """The table's rows by name, each with its unit and figures."""
    lines = [line.split("  ") for line in text.splitlines() if line.startswith("  ")]
    rows = [[word.strip() for word in line if word.strip()] for line in lines]
    return {row[0]: row[1:] for row in rows}


def test_show_prints_the_table_and_columns_do_not_touch(run, vane_file):
    found = run("show", vane_file, "--stations", "0,0.5,1")
    assert (found.status, found.err) == (0, "")
    rows = columns_of(found.out)
    assert rows["span"] == ["-", "0", "0.5", "1"]
    table = read_design(vane_file).build().report([0.0, 0.5, 1.0])
    assert rows["metal angle out"][0] == "deg"
    assert [float(each) for each in rows["throat"][1:]] == pytest.approx(table.values("throat"), rel=1e-5)


def test_json_and_csv_hold_the_table(run, vane_file, tmp_path):
    found = run("show", vane_file, "--stations", "0.25,0.75", "--csv", tmp_path / "table.csv", "--json").json
    assert found["table"]["stations"]["span"] == [0.25, 0.75]
    with (tmp_path / "table.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["solidity"]) for row in rows] == found["table"]["stations"]["solidity"]
    assert [float(row["metal_angle_in [deg]"]) for row in rows] == found["table"]["stations"]["metal_angle_in"]


def test_csv_alone_has_the_usual_stations(run, vane_file, tmp_path):
    assert run("show", vane_file, "--csv", tmp_path / "table.csv").status == 0
    with (tmp_path / "table.csv").open() as file:
        assert [row["span"] for row in csv.DictReader(file)] == ["0.0", "0.25", "0.5", "0.75", "1.0"]


def test_build_puts_the_table_into_its_json(run, vane_file, tmp_path):
    found = run("build", vane_file, "-o", tmp_path / "out", "--as", "brep", "--stations", "0.5", "--json").json
    assert found["table"]["units"]["chord"] == "mm"
    assert found["suction_side"] in ("upper", "lower")


def test_a_section_in_inches_has_its_one_station_in_inches(run, tmp_path):
    (tmp_path / "vane.toml").write_text(SECTION)
    found = run("show", tmp_path / "vane.toml", "--stations", "0.5", "--json").json["table"]
    assert found["units"]["chord"] == "in"
    assert found["stations"]["chord"] == pytest.approx([1.0 / np.cos(np.radians(30.0))], rel=1e-12)


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        ("0,1.5", "1.5 is no span fraction"),
        ("hub,tip", "'hub,tip' is no list"),
        ("", "is no list"),
        ("nan", "nan is no"),
    ],
)
def test_bad_stations_are_refused(run, vane_file, words, reason):
    found = run("show", vane_file, "--stations", words)
    assert (found.status, found.err.count("\n")) == (2, 1)
    assert reason in found.err


def test_a_table_of_a_passage_is_refused(run, vane_file):
    found = run("show", vane_file, "--stations", "0.5", "--body", "passage")
    assert found.status == 2
    assert "leave out --body passage" in found.err


def test_rotation_is_told_and_a_wrong_one_warned_of(run, vane_file):
    assert "WARNING" not in run("show", vane_file, "--set", "rotation=none").out
    told = {turn: run("show", vane_file, "--set", f"rotation={turn}", "--json").json for turn in ("clockwise", "none")}
    assert told["none"]["rotation"] == "none"
    assert "the row stands still" in told["none"]["flow"]
    both = [run("show", vane_file, "--set", f"rotation={turn}").out for turn in ("clockwise", "counterclockwise")]
    assert sum("WARNING" in text and "along the rotation" in text for text in both) == 1
    found = run("show", vane_file, "--set", "rotation=left")
    assert found.status == 2
    assert "clockwise" in found.err


def test_where_the_flow_comes_from_is_said_once(run, vane_file, tmp_path):
    words = ["build", vane_file, "-o", tmp_path, "--as", "brep"]
    for command in (["show", vane_file], words):
        for more in ([], ["--stations", "0.5"]):
            assert run(*command, *more).out.count("without incidence") == 1
