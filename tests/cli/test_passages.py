"""A design becomes a flow passage in CAD files, and a file is measured against it."""

import json
import re
from pathlib import Path

import pytest


def thin_vane() -> str:
    """The vane with slender edges, around which the walls' patches do not fold."""
    text = (Path(__file__).parent / "vane.toml").read_text()
    for name, law in (("upper", "[0.04, 0.06, 0.03]"), ("lower", "[0.03, 0.03, 0.02]")):
        text = re.sub(rf"^thickness_{name} = .*$", f"thickness_{name} = {law}", text, flags=re.MULTILINE)
    return text


@pytest.fixture
def thin_file(tmp_path):
    path = tmp_path / "vane.toml"
    path.write_text(thin_vane())
    return path


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A directory with the STEP files of the vane and of its passage, made by the program."""
    from bladewright.cli import main

    directory = tmp_path_factory.mktemp("made")
    design = directory / "vane.toml"
    design.write_text(thin_vane())
    assert (
        main(["build", str(design), "-o", str(directory / "out"), "--as", "step", "--body", "blade,passage", "-q"]) == 0
    )
    return directory / "out"


def test_each_body_has_its_file_and_its_round_trip(made):
    assert sorted(each.name for each in made.iterdir()) == [
        "vane-passage.roundtrip.json", "vane-passage.step", "vane.roundtrip.json", "vane.step",
    ]  # fmt: skip
    blade, passage = (json.loads((made / f"{name}.roundtrip.json").read_text()) for name in ("vane", "vane-passage"))
    assert blade["passed"]
    assert passage["passed"]
    assert (len(blade["faces"]), len(passage["faces"])) == (4, 10)
    # a pitch of 45 mm, 50 mm high
    ring = 45.0 * 50.0
    assert passage["volume_mm3"]["cad"] + blade["volume_mm3"]["cad"] > 40.0 * ring


def test_a_passage_that_was_built_is_verified_and_no_blade_is(made, run, thin_file):
    assert run("verify", made / "vane-passage.step", thin_file, "--body", "passage").status == 0
    found = run("verify", made / "vane.step", thin_file, "--body", "passage", "--json")
    assert (found.status, found.json["passed"]) == (1, False)


def test_the_reach_of_a_passage_is_asked_for(run, thin_file, tmp_path):
    words = ["--body", "passage", "--upstream", "1.25", "--downstream", "1.5", "--outlet-angle", "-60"]
    longer = run("build", thin_file, "-o", tmp_path / "out", "--as", "step", *words, "--json")
    assert (longer.status, longer.err) == (0, "")
    assert longer.json["name"] == "vane-passage"
    # one meridional length of 40 mm on each side of what 0.25 and 0.5 would give
    ring = 40.0 * 45.0 * 50.0
    assert longer.json["roundtrips"][0]["volume_mm3"]["cad"] > 3.0 * ring
    path = tmp_path / "out" / "vane-passage.step"
    assert run("verify", path, thin_file, *words).status == 0


def test_split_faces_have_names_of_their_own(run, thin_file, tmp_path):
    found = run("build", thin_file, "-o", tmp_path, "--as", "iges", "--body", "passage", "--split", "--json")
    assert (found.status, found.err) == (0, "")
    names = {face["name"] for face in found.json["roundtrips"][0]["faces"]}
    assert len(names) == 24
    assert {"hub_upper_inlet", "periodic_lower_blade", "outlet_upper", "blade_lower"} <= names


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--upstream", "0.5"], ["--upstream", "--body passage"]),
        (["--outlet-angle", "2", "--inlet-angle", "3"], ["--inlet-angle", "--outlet-angle", "--body passage"]),
        (["--body", "passage", "--extend", "0.1"], ["--extend", "--body blade"]),
        (["--body", "passages"], ["passages", "blade, passage"]),
        (["--body", "blade,passage", "--upstream", "-1"], ["upstream", "-1"]),
        (["--body", "passage", "--downstream", "nan"], ["downstream", "nan"]),
        (["--body", "passage", "--downstream", "far"], ["--downstream", "far"]),
        (["--body", "passage", "--inlet-angle", "95"], ["inlet_angle", "95"]),
        (["--body", "passage", "--set", "pitch=5"], ["pitch"]),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else None,
)
def test_what_makes_no_passage_is_refused_and_leaves_nothing(words, said, run, thin_file, tmp_path):
    found = run("build", thin_file, "-o", tmp_path / "out", *words)
    assert (found.status, found.out, found.err.count("\n")) == (2, "", 1), found
    assert "fault of bladewright" not in found.err
    for word in said:
        assert word in found.err
    assert list(tmp_path.iterdir()) == [thin_file]


def test_a_section_needs_span_and_pitch_for_a_passage(run, tmp_path):
    section = thin_vane().partition("[channel]")[0]
    section = section.replace('"unified"', '"unified-section"').replace('arrangement = "linear"', "axial_chord = 40")
    path = tmp_path / "section.toml"
    path.write_text(section.replace("pitch = 45.0", "").replace("tolerance = 1e-4", ""))
    for change, missing in (("span=50", "pitch is missing"), ("pitch=45", "span is missing")):
        found = run("build", path, "-o", tmp_path / "out", "--body", "passage", "--set", change)
        assert found.status == 2
        assert missing in found.err
    assert list(tmp_path.iterdir()) == [path]
    words = ["--as", "step", "--body", "passage", "--set", "span=50", "--set", "pitch=45"]
    found = run("build", path, "-o", tmp_path / "out", *words, "--json")
    assert (found.status, found.err) == (0, "")
    assert found.json["files"] == [str(tmp_path / "out" / "vane-passage.step")]
