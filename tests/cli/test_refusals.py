"""Bad input gets one paragraph with path, value, limit and cure, and leaves nothing behind."""

import re
import sys
from pathlib import Path

import pytest

from bladewright.files.examples import example_text

TEXT = example_text("fan-rotor")


def replaced(key: str, line: str) -> str:
    """The example with another line in the place of the one that sets `key`."""
    found, count = re.subn(rf"^{key} *=.*$", lambda _: line, TEXT, flags=re.MULTILINE)
    assert count == 1
    return found


BAD_FILES = {
    "wrong type": (replaced("stagger", 'stagger = "steep"'), ["stagger", '"steep"', "number", "deg"]),
    "wrong type in a list": (replaced("stagger", "stagger = [1, true]"), ["stagger[1]", "true", "a number"]),
    "a fraction of a blade": (replaced("blade_count", "blade_count = 22.5"), ["blade_count", "22.5", "whole number"]),
    "number for a list": (replaced("thickness_lower", "thickness_lower = 0.3"), ["thickness_lower", "0.3", "list"]),
    "number for a text": (replaced("name", "name = 3"), ["name", "3", "text"]),
    "number for a table": (TEXT.partition("[channel]")[0] + "channel = 3", ["channel", "3", "table", "leading_edge"]),
    "three coordinates": (replaced("hub", "hub = [[1, 2], [3, 4, 5]]"), ["channel.hub[1]", "[3, 4, 5]", "pair"]),
    "one coordinate": (replaced("hub", "hub = [[1, 2], [3]]"), ["channel.hub[1].r", "missing"]),
    "text for a coordinate": (replaced("hub", 'hub = [[1, "x"]]'), ["channel.hub[0].r", '"x"', "number"]),
    "unknown key": (replaced("stagger", "stager = 3"), ["stager", "did you mean 'stagger'"]),
    "unknown key in a table": (replaced("hub", "hubb = [[1, 2]]"), ["channel.hubb", "did you mean 'hub'"]),
    "unknown table": (TEXT.replace("[channel]", "[chanel]"), ["chanel", "did you mean 'channel'"]),
    "missing key": (replaced("tangent_in", ""), ["tangent_in", "missing", "number"]),
    "missing key in a table": (replaced("trailing_edge", ""), ["channel.trailing_edge", "missing", "list"]),
    "missing unit": (replaced("length_unit", ""), ["length_unit", "missing", '"mm"']),
    "unknown unit": (replaced("length_unit", 'length_unit = "inch"'), ["length_unit", '"inch"', '"in"']),
    "missing family": (replaced("family", ""), ["family", "missing", '"unified"']),
    "unknown family": (replaced("family", 'family = "unifid"'), ["unifid", "did you mean 'unified'"]),
    "family of the wrong type": (replaced("family", "family = 3"), ["family", "3", "text"]),
    "unknown arrangement": (
        replaced("arrangement", 'arrangement = "anular"'),
        ["arrangement", "did you mean 'annular'"],
    ),
    "NaN": (replaced("stagger", "stagger = nan"), ["stagger", "nan", "finite"]),
    "NaN in a list": (replaced("hub", "hub = [[1, nan]]"), ["channel.hub[0].r", "nan", "finite"]),
    "infinity": (replaced("tangent_in", "tangent_in = [0.1, inf]"), ["tangent_in[1]", "inf", "finite"]),
    "beyond all floats": (replaced("tangent_in", f"tangent_in = 1{'0' * 400}"), ["tangent_in", "inf", "finite"]),
    "empty list": (replaced("stagger", "stagger = []"), ["stagger", "empty", "control point"]),
    "empty chordwise list": (replaced("thickness_upper", "thickness_upper = []"), ["thickness_upper", "empty"]),
    "empty law in a list": (
        replaced("thickness_upper", "thickness_upper = [0.1, []]"),
        ["thickness_upper[1]", "empty"],
    ),
    "zero blades": (replaced("blade_count", "blade_count = 0"), ["blade_count", "0", "1 to 10000"]),
    "90 degrees": (replaced("metal_angle_in", "metal_angle_in = [10, 90]"), ["metal_angle_in[1]", "90", "-90 and 90"]),
    "minus 95 degrees": (replaced("stagger", "stagger = -95"), ["stagger", "-95", "between -90 and 90 deg"]),
    "negative thickness": (
        replaced("thickness_lower", "thickness_lower = [-0.1]"),
        ["thickness_lower[0]", "-0.1", "raise"],
    ),
    "zero radius": (
        replaced("leading_edge_radius", "leading_edge_radius = 0"),
        ["leading_edge_radius", "0", "between"],
    ),
    "long tangent": (replaced("tangent_out", "tangent_out = 1.5"), ["tangent_out", "1.5", "not above 1"]),
    "one control point": (
        replaced("leading_edge ", "leading_edge = [[1, 2]]"),
        ["channel.leading_edge", "1", "at least 2"],
    ),
    "negative clearance": (replaced("tip_clearance", "tip_clearance = -0.5"), ["tip_clearance", "-0.5", "positive"]),
    "text for a clearance": (replaced("tip_clearance", 'tip_clearance = "0.6"'), ["tip_clearance", '"0.6"', "a pair"]),
    "three clearances": (
        replaced("tip_clearance", "tip_clearance = [1, 2, 3]"),
        ["tip_clearance", "[1, 2, 3]", "pair"],
    ),
    "one clearance in a list": (replaced("tip_clearance", "tip_clearance = [1]"), ["tip_clearance[1]", "missing"]),
    "an infinite clearance": (replaced("tip_clearance", "tip_clearance = [1, inf]"), ["tip_clearance[1]", "finite"]),
    "a clearance at each end": (
        replaced("tip_clearance", "tip_clearance = 1\nhub_clearance = 1"),
        ["tip_clearance", "hub_clearance", "stands on one"],
    ),
    "a clearance beyond the span": (
        replaced("tip_clearance", "tip_clearance = 160"),
        ["tip_clearance is 160 mm", "u = ", "the hub is", "smaller than the span"],
    ),
    "a name that is a path": (replaced("name", 'name = "a/b"'), ["name", "a/b"]),
    "a name that is no text": (replaced("name", r'name = "a\u0000b"'), ["name", "printable"]),
    "pitch in an annulus": (replaced("leading_edge_theta", "pitch = 3.0"), ["pitch", "annular", "blade_count"]),
    "no pitch in a cascade": (
        replaced("arrangement", 'arrangement = "linear"').replace("blade_count", "#"),
        ["leading_edge_theta", "linear", "leading_edge_y"],
    ),
    "swapped ends": (
        TEXT.replace("\nleading_edge  =", "\nswap =")
        .replace("\ntrailing_edge =", "\nleading_edge =")
        .replace("swap", "trailing_edge"),
        ["channel"],
    ),
    "swapped hub and shroud": (
        TEXT.replace("\nhub           =", "\nswap =").replace("\nshroud        =", "\nhub =").replace("swap", "shroud"),
        ["channel"],
    ),
    "TOML without a value": (replaced("stagger", "stagger = "), ["not valid TOML", "line 11", "stagger ="]),
    "TOML with a key twice": (TEXT.replace("[channel]", "stagger = 3\n[channel]"), ["not valid TOML", "line"]),
    "TOML nested without end": ("a = " + "[" * 100_000, ["TOML", "nested"]),
    "an integer without end": (f"a = 1{'0' * 5000}", ["TOML", "digits"]),
    "an empty file": ("", ["family", "missing"]),
}
BAD_BYTES = {
    "latin-1": (replaced("name", 'name = "Lüfter"').encode("latin-1"), ["UTF-8", "0xfc", "line 3", "ü"]),
    "UTF-16": (TEXT.encode("utf-16"), ["UTF-16", "UTF-8"]),
    "a PNG": (b"\x89PNG\r\n\x1a\n" + bytes(100), ["PNG", "UTF-8 text"]),
    "binary": (bytes(range(256)), ["binary", "UTF-8 text"]),
}
CASES = {name: (text.encode(), words) for name, (text, words) in BAD_FILES.items()} | BAD_BYTES


def assert_refused(found, *words) -> None:
    assert found.status == 2, found
    assert found.out == ""
    assert found.err.count("\n") == 1, found.err
    assert found.err.endswith("\n")
    assert "Traceback" not in found.err
    assert "fault of bladewright" not in found.err
    for word in words:
        assert word in found.err


@pytest.mark.parametrize("name", CASES)
def test_a_bad_design_file_is_refused_in_one_paragraph_and_leaves_nothing(name, run, tmp_path):
    data, words = CASES[name]
    path = tmp_path / "bad.toml"
    path.write_bytes(data)
    assert_refused(run("build", path, "-o", tmp_path / "made" / "here"), *words, "bad.toml")
    assert [each.name for each in tmp_path.iterdir()] == ["bad.toml"]


@pytest.mark.parametrize("name", ["wrong type", "latin-1", "swapped ends"])
def test_with_json_an_error_is_one_object_on_standard_output(name, run, tmp_path):
    path = tmp_path / "bad.toml"
    path.write_bytes(CASES[name][0])
    found = run("build", path, "-o", tmp_path, "--json")
    assert found.status == 2
    assert set(found.json) == {"error"}
    assert found.json["error"]["message"] in found.err


def test_a_missing_file_is_refused_with_the_nearest_name(run, design_file):
    assert_refused(
        run("build", design_file.with_name("fan-rotr.toml")), "fan-rotr.toml", f"did you mean '{design_file}'"
    )


def test_a_directory_in_the_place_of_a_file_is_refused(run, design_file):
    assert_refused(run("build", design_file.parent), "is a directory", "fan-rotor.toml")


def test_a_file_of_a_gigabyte_is_refused_before_it_is_read(run, tmp_path):
    path = tmp_path / "huge.toml"
    with path.open("wb") as stream:
        stream.truncate(1_000_000_000)
    assert_refused(run("build", path), "huge.toml", "1,000,000,000 bytes", "1,000,000")


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="this system has no /dev/zero")
def test_a_file_without_end_is_refused(run):
    assert_refused(run("build", "/dev/zero"), "does not end")


def test_an_output_below_a_file_is_refused(run, design_file):
    found = run("build", design_file, "-o", design_file / "out")
    assert_refused(found, str(design_file / "out"), "another directory")


def test_an_output_that_is_a_file_is_refused_and_stays(run, design_file, tmp_path):
    output = tmp_path / "out"
    output.write_text("mine")
    assert_refused(run("build", design_file, "-o", output), "is a file")
    assert output.read_text() == "mine"


@pytest.mark.skipif(sys.platform != "linux", reason="/proc takes no files, also from root")
def test_an_unwritable_output_is_refused(run, design_file):
    assert_refused(run("build", design_file, "-o", "/proc/bladewright"), "/proc/bladewright", "another directory")
    assert_refused(run("new", "fan-rotor", "-o", "/proc/fan-rotor.toml"), "/proc/fan-rotor.toml")
    assert_refused(run("schema", "-o", "/proc/schema.json"), "/proc/schema.json")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--set", "stagger[1]"], ["stagger[1]", "PATH=VALUE"]),
        (["--set", "stager[1]=3"], ["stager", "did you mean 'stagger'"]),
        (["--set", "stagger[9]=3"], ["stagger[9]", "5 entries", "0 to 4"]),
        (["--set", "stagger[1]=93"], ["stagger[1]", "93", "-90 and 90"]),
        (["--set", "stagger[1]=nan"], ["stagger[1]", "nan", "finite"]),
        (["--set", "stagger[1]=steep"], ["stagger[1]", "steep", "number"]),
        (["--set", "stagger=[1,"], ["stagger", "[1,", "TOML"]),
        (["--set", "stagger=1\nname='x'"], ["stagger", "TOML"]),
        (["--set", "channel.hub[0].y=3"], ["channel.hub[0].y", "known are x, r"]),
        (["--set", "blade_count=0"], ["blade_count", "0", "1 to 10000"]),
        (["--as", "step,stp"], ["stp", "step, iges"]),
        (["--as", ""], ["step, iges"]),
        (["--body", "disc"], ["disc", "blade, passage, row"]),
        (["--schema", "AP999"], ["AP999", "AP242"]),
        (["--chordal-deviation", "0.01"], ["0.01", "0.01mm"]),
        (["--chordal-deviation", "-1mm"], ["-1mm", "positive"]),
        (["--chordal-deviation", "1e999mm"], ["1e999mm", "positive"]),
        (["--extend", "7"], ["7", "0.0<=x<=0.5"]),
        (["--output"], ["--output"]),
        (["--asformat", "step"], ["--asformat"]),
    ],
)
def test_a_wrong_call_is_refused_in_one_paragraph(words, said, run, design_file):
    assert_refused(run("build", design_file, *words), *said)
    assert [each.name for each in design_file.parent.iterdir()] == [design_file.name]


def test_an_unknown_command_is_refused(run):
    assert_refused(run("biuld"), "biuld", "--help")


def test_a_missing_argument_is_refused_as_json_too(run):
    found = run("build", "--json")
    assert found.status == 2
    assert "DESIGN" in found.json["error"]["message"]
