"""Files that were made from another design file stay, unless they are to go."""

import json
from dataclasses import replace

import pytest

from bladewright.cli.overwriting import overwritten
from bladewright.errors import FileError
from bladewright.origin import Origin

MADE = Origin(name="vane", parameters_hash="1" * 64, file="../vane.toml", text="pitch = 45")
OTHER = replace(MADE, parameters_hash="2" * 64, file="../other.toml", text="pitch = 46")
EDITED = replace(OTHER, file="../vane.toml")


@pytest.fixture
def folder(tmp_path):
    """A folder with two design files, and with a file made from the first in `out`."""
    for name in ("vane.toml", "other.toml", "out/vane.step"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    record(tmp_path, MADE.to_dict())
    return tmp_path


def record(folder, design):
    (folder / "out" / "vane.roundtrip.json").write_text(json.dumps({"file": "vane.step", "design": design}))


def asked(folder, design, origin, *, force=False):
    out = folder / "out"
    files, reports = [out / "vane.step", out / "vane.igs"], [out / "vane.roundtrip.json", out / "vane.x.roundtrip.json"]
    return overwritten(files, reports, folder / design, origin, force=force)


def test_the_same_design_overwrites_and_nothing_is_said(folder):
    assert asked(folder, "vane.toml", MADE) == ""


def test_nothing_is_said_where_there_is_no_file(folder):
    (folder / "out" / "vane.step").unlink()
    assert asked(folder, "other.toml", OTHER) == ""


def test_an_edited_design_overwrites_and_that_is_said(folder):
    text = asked(folder, "vane.toml", EDITED)
    assert text == f"vane.step overwritten: '{folder / 'vane.toml'}' was edited since"


def test_another_design_file_does_not_overwrite_unless_by_force(folder):
    with pytest.raises(FileError, match=r"vane.step' was made from '.*/vane.toml', not from '.*/other.toml'.*--name"):
        asked(folder, "other.toml", OTHER)
    text = asked(folder, "other.toml", OTHER, force=True)
    assert text == f"vane.step overwritten: made from '{folder / 'vane.toml'}' before"


def test_a_copy_is_the_same_design_until_it_is_edited(folder):
    assert asked(folder, "other.toml", replace(MADE, file="../other.toml")) == ""


def test_folders_may_be_moved_with_or_without_the_files_made(folder):
    # together: the path between them is the same; the files alone: the name of the design file is
    moved = folder.rename(folder.with_name("moved"))
    assert "was edited" in asked(moved, "vane.toml", EDITED)
    record(moved, replace(MADE, file="../gone/vane.toml").to_dict())
    assert "was edited" in asked(moved, "vane.toml", EDITED)
    with pytest.raises(FileError, match="was made from"):
        asked(moved, "other.toml", OTHER)


def test_a_file_of_unknown_origin_stays_unless_by_force(folder):
    (folder / "out" / "vane.roundtrip.json").unlink()
    with pytest.raises(FileError, match=r"vane.step' exists, and no report beside it tells from which design file"):
        asked(folder, "vane.toml", MADE)
    assert "nothing says" in asked(folder, "vane.toml", MADE, force=True)


@pytest.mark.parametrize("design", [None, [], {"name": 3}, {"name": "vane"}])
def test_a_broken_report_tells_nothing(folder, design):
    record(folder, design)
    with pytest.raises(FileError, match="no report beside it tells"):
        asked(folder, "vane.toml", MADE)


def test_building_records_the_design_and_says_what_it_overwrites(run, vane_file):
    out = vane_file.parent / "out"
    words = ("build", vane_file, "-o", out, "--as", "step", "--json")
    assert run(*words).json["overwritten"] is None
    found = run(*words, "--set", "stagger=-41.5")
    assert found.json["overwritten"] == "vane.step overwritten: with --set stagger=-41.5, without --set before"
    report = json.loads((out / "vane.roundtrip.json").read_text())
    assert report == found.json["roundtrips"][0]
    assert report["design"]["text"] == vane_file.read_text()
    assert (report["design"]["file"], report["design"]["changes"]) == ("../vane.toml", ["stagger=-41.5"])
    assert "unit" in report


def test_another_design_is_built_by_force_or_under_a_name_of_its_own(run, vane_file):
    out, other = vane_file.parent / "out", vane_file.with_name("other.toml")
    words = ("-o", out, "--as", "stl", "--chordal-deviation", "5mm")
    assert run("build", vane_file, *words).status == 0
    other.write_text(vane_file.read_text().replace("pitch = 45", "pitch = 46"))
    before = (out / "vane.stl").read_bytes()
    assert run("build", other, *words).status == 2
    assert (out / "vane.stl").read_bytes() == before
    assert run("build", other, *words, "--name", "other").status == 0
    assert {each.name for each in out.glob("*.stl")} == {"vane.stl", "other.stl"}
    assert run("build", vane_file, other, *words, "--name", "both").status == 2
