"""A design becomes CAD files with their round trips, and a CAD file is measured against a design."""

import dataclasses
import json
import re
from pathlib import Path

import pytest

from bladewright import cad
from bladewright.errors import CadError
from bladewright.files.reading import read_design

SUFFIXES = {"step": ".step", "iges": ".igs", "brep": ".brep", "stl": ".stl", "3mf": ".3mf"}
KEYS = {"file", "format", "unit", "passed", "failures", "limits", "solids", "shells", "free_edges", "valid", "faces"}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A directory with the vane in every format, made by the program."""
    from bladewright.cli import main

    directory = tmp_path_factory.mktemp("made")
    design = directory / "vane.toml"
    design.write_text((Path(__file__).parent / "vane.toml").read_text())
    words = ["build", str(design), "-o", str(directory / "out"), "--as", ",".join(SUFFIXES)]
    assert main([*words, "--chordal-deviation", "0.1mm", "--quiet"]) == 0
    return directory / "out"


def test_a_build_makes_each_format_and_its_round_trip_and_nothing_else(made):
    reports = [f"vane{suffix}.roundtrip.json" for suffix in list(SUFFIXES.values())[1:]]
    files = [f"vane{suffix}" for suffix in SUFFIXES.values()]
    assert sorted(each.name for each in made.iterdir()) == sorted([*files, *reports, "vane.roundtrip.json"])


@pytest.mark.parametrize("name", SUFFIXES)
def test_each_round_trip_is_one_object_that_passed(name, made):
    report = "vane" + ("" if name == "step" else SUFFIXES[name]) + ".roundtrip.json"
    found = json.loads((made / report).read_text())
    assert Path(found["file"]).name == f"vane{SUFFIXES[name]}"
    assert found["passed"] is True
    assert found["failures"] == []
    assert set(found) >= KEYS


@pytest.mark.parametrize("name", ["step", "iges"])
def test_a_file_that_was_built_is_verified(name, made, run, vane_file):
    found = run("verify", made / f"vane{SUFFIXES[name]}", vane_file, "--json")
    assert (found.status, found.err) == (0, "")
    assert found.json["passed"] is True


def test_a_file_of_another_blade_fails_with_status_one_and_says_why(made, run, vane_file):
    found = run("verify", made / "vane.step", vane_file, "--set", "stagger=-40.1", "--json")
    assert (found.status, found.json["passed"]) == (1, False)
    assert found.json["failures"]
    for failure in found.json["failures"]:
        assert f"vane.step: {failure}" in found.err


def test_building_prints_one_json_object_with_every_round_trip(run, vane_file, tmp_path):
    found = run("build", vane_file, "-o", tmp_path / "out", "--json")
    assert (found.status, found.err) == (0, "")
    assert found.json["passed"] is True
    assert found.json["files"] == [str(tmp_path / "out" / f"vane{suffix}") for suffix in (".step", ".igs")]
    assert [each["format"] for each in found.json["roundtrips"]] == ["STEP", "IGES"]
    assert found.json["roundtrips"][0] == json.loads((tmp_path / "out" / "vane.roundtrip.json").read_text())


def test_a_quiet_build_prints_nothing(run, vane_file, tmp_path):
    found = run("build", vane_file, "-o", tmp_path, "--as", "step", "-q")
    assert (found.status, found.out, found.err) == (0, "", "")


def test_with_one_format_its_round_trip_has_the_name_of_the_design(run, vane_file, tmp_path):
    run("build", vane_file, "-o", tmp_path / "out", "--as", "iges", "--set", "name=other")
    assert sorted(each.name for each in (tmp_path / "out").iterdir()) == ["other.igs", "other.roundtrip.json"]
    assert json.loads((tmp_path / "out" / "other.roundtrip.json").read_text())["format"] == "IGES"


@pytest.mark.parametrize("schema", ["AP203", "AP214", "AP242"])
def test_the_step_schema_is_the_one_asked_for(schema, run, vane_file, tmp_path):
    assert run("build", vane_file, "-o", tmp_path, "--as", "step", "--schema", schema).status == 0
    header = re.search(r"FILE_SCHEMA *\(\(([^)]*)\)", (tmp_path / "vane.step").read_text())
    named = {"AP203": "CONFIG_CONTROL_DESIGN", "AP214": "AUTOMOTIVE_DESIGN", "AP242": "AP242_MANAGED_MODEL"}
    assert named[schema] in header[1]


@pytest.mark.parametrize(("words", "solids"), [([], 1), (["--iges-surfaces"], 0)])
def test_iges_holds_a_solid_or_surfaces_as_asked(words, solids, run, vane_file, tmp_path):
    run("build", vane_file, "-o", tmp_path, "--as", "iges", *words)
    entities = re.findall(r"^ *(\d+)(?: +-?\d+)+.*D *\d+$", (tmp_path / "vane.igs").read_text(), re.MULTILINE)
    assert entities.count("186") == 2 * solids


def test_an_extended_blade_is_larger_and_verifies_as_such(run, vane_file, tmp_path):
    plain = run("build", vane_file, "-o", tmp_path / "plain", "--as", "step", "--json").json
    extended = run("build", vane_file, "-o", tmp_path / "long", "--as", "step", "--extend", "0.05", "--json").json
    volumes = [each["roundtrips"][0]["volume_mm3"]["cad"] for each in (plain, extended)]
    assert volumes[1] > 1.03 * volumes[0]
    assert extended["passed"]
    assert run("verify", tmp_path / "long" / "vane.step", vane_file, "--extend", "0.05").status == 0


def test_a_check_that_fails_gives_status_one_and_the_files_stay(run, vane_file, tmp_path, monkeypatch):
    write = cad.write

    def failing(built, path, **options):
        return dataclasses.replace(write(built, path, **options), failures=("a pole has moved",))

    monkeypatch.setattr(cad, "write", failing)
    found = run("build", vane_file, "-o", tmp_path / "out", "--as", "step")
    assert found.status == 1
    assert found.err == "vane.step: a pole has moved\n"
    assert json.loads((tmp_path / "out" / "vane.roundtrip.json").read_text())["passed"] is False
    assert (tmp_path / "out" / "vane.step").stat().st_size > 10_000


def test_an_error_in_the_second_format_leaves_nothing_of_the_first(run, vane_file, tmp_path, monkeypatch):
    write = cad.write

    def failing(built, path, **options):
        if path.suffix == ".igs":
            raise CadError("no IGES today")
        return write(built, path, **options)

    monkeypatch.setattr(cad, "write", failing)
    found = run("build", vane_file, "-o", tmp_path / "new" / "out")
    assert (found.status, found.err) == (2, "bladewright: no IGES today\n")
    assert list(tmp_path.iterdir()) == [vane_file]


def test_a_section_becomes_a_prismatic_blade_of_its_span(run, tmp_path):
    section = (Path(__file__).parent / "vane.toml").read_text().partition("[channel]")[0]
    section = section.replace('"unified"', '"unified-section"').replace('arrangement = "linear"', "axial_chord = 40")
    section = section.replace("tolerance = 1e-4", "")
    path = tmp_path / "section.toml"
    path.write_text(section)
    found = run("build", path, "-o", tmp_path / "out")
    assert found.status == 2
    assert "span" in found.err
    assert list(tmp_path.iterdir()) == [path]
    found = run("build", path, "-o", tmp_path / "out", "--as", "step", "--set", "span=50", "--json")
    assert (found.status, found.err) == (0, "")
    area = run("show", path, "--json").json["properties"]["area"]
    volume = found.json["roundtrips"][0]["volume_mm3"]["cad"]
    # The native sides miss the exact section by up to 1e-6 of the chord, along a perimeter of six mean thicknesses.
    assert volume == pytest.approx(50.0 * 1e6 * area, rel=2e-5)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("half.step", None),
        ("picture.step", b"\x89PNG\r\n\x1a\n" + bytes(2000)),
        ("empty.step", b""),
        ("text.igs", b"Dear reader,\n"),
        ("unknown.xyz", b"1 2 3\n"),
    ],
)
def test_a_broken_cad_file_is_refused_in_one_paragraph(name, content, made, run, vane_file, tmp_path):
    whole = (made / "vane.step").read_bytes()
    path = tmp_path / name
    path.write_bytes(whole[: len(whole) // 2] if content is None else content)
    found = run("verify", path, vane_file)
    assert (found.status, found.out, found.err.count("\n")) == (2, "", 1), found
    assert name in found.err
    assert "fault of bladewright" not in found.err
    assert run("verify", path, vane_file, "--json").json["error"]["message"] in found.err


def test_a_cad_file_that_is_missing_or_a_directory_is_refused(run, vane_file, tmp_path):
    for path in (tmp_path / "none.step", tmp_path):
        found = run("verify", path, vane_file)
        assert (found.status, found.err.count("\n")) == (2, 1), found
        assert str(path) in found.err
        assert "fault of bladewright" not in found.err


@pytest.mark.parametrize("jobs", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_several_designs_are_made_by_so_many_processes_though_one_is_refused(jobs, run, vane_file, tmp_path):
    text, other, broken = vane_file.read_text(), tmp_path / "other.toml", tmp_path / "broken.toml"
    other.write_text(text.replace('name = "vane"', 'name = "other"'))
    broken.write_text('family = "unified"\nname = "broken"\n')
    words = ("--as", "step", "-o", tmp_path / "made", "--jobs", jobs, "--json")
    asked = run("build", vane_file, broken, other, *words)
    assert asked.status == 2
    assert [each["name"] for each in asked.json["designs"]] == ["vane", "other"]
    assert asked.json["passed"] is False
    assert [Path(each["file"]).name for each in asked.json["refused"]] == ["broken.toml"]
    assert asked.err.startswith("bladewright: ")
    assert "broken.toml" in asked.err
    names = {"vane.step", "vane.roundtrip.json", "other.step", "other.roundtrip.json"}
    assert {path.name for path in (tmp_path / "made").iterdir()} == names


def test_designs_whose_files_would_be_the_same_are_refused(run, vane_file, tmp_path):
    twin = tmp_path / "twin.toml"
    twin.write_text(vane_file.read_text())
    asked = run("build", vane_file, twin, "-o", tmp_path / "made")
    assert asked.status == 2
    assert "both named 'vane'" in asked.err
    assert not (tmp_path / "made").exists()


def test_a_fine_split_build_is_measured_as_one(run, tmp_path):
    design = tmp_path / "vane.toml"
    design.write_text((Path(__file__).parent / "vane.toml").read_text())
    found = run("build", design, "-o", tmp_path / "out", "--as", "step", "--fine", "--split", "--json")
    assert (found.status, found.err) == (0, "")
    trip = found.json["roundtrips"][0]
    assert trip["kernel_check"] == []
    assert trip["volume_mm3"]["kernel_default"]["relative_error"] < 1e-5
    assert {face["name"]: face["pieces"] > 1 for face in trip["faces"]} == {
        "upper": True, "lower": True, "hub": False, "shroud": False,
    }  # fmt: skip
    assert run("verify", tmp_path / "out" / "vane.step", design, "--fine").status == 0


def test_a_round_trip_is_printed_in_the_unit_of_the_design(run, vane_file, tmp_path):
    built = run("build", vane_file, "-o", tmp_path, "--as", "step", "--set", "length_unit=in")
    assert built.status == 0, built.out
    blade = read_design(vane_file).changed("length_unit", "in").build()
    [told] = re.findall(r"^  volume ([\d.]+) in3 \(.* off\), area ([\d.]+) in2 \(", built.out, re.MULTILINE)
    expected = (float(blade.properties.volume) / 0.0254**3, float(blade.properties.area) / 0.0254**2)
    assert tuple(map(float, told)) == pytest.approx(expected, rel=1e-6)
    assert not re.search(r"\d mm", built.out)
    # every fraction says what it is
    assert not re.search(r"\([\d.]+e[-+]\d+\)", built.out)
    checked = run("verify", tmp_path / "vane.step", vane_file, "--set", "length_unit=in")
    assert not re.search(r"\d mm", checked.out)
