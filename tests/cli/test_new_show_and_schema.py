"""Starting from an example, looking at what a design builds, and the schema for editors."""

import json
import tomllib

import pytest

from bladewright.files.examples import example_text, examples
from bladewright.files.reading import read_design
from bladewright.files.schema import schema
from bladewright.files.templates import template_text, templates

SECTION = """
family = "profile-section"
name = "vane"
length_unit = "mm"
chord = 60.0
[section]
kind = "naca-4"
thickness = 0.12
camber = 0.04
camber_position = 0.4
"""


def test_new_lists_the_examples_with_a_line_about_each(run):
    found = run("new")
    for name in examples():
        assert f"{name} " in found.out
    assert run("new", "--json").json == {"examples": examples(), "templates": templates()}


@pytest.mark.parametrize("name", templates())
def test_new_writes_a_template(run, tmp_path, name):
    file = tmp_path / f"{name}.toml"
    assert run("new", "--template", name, "-o", file).status == 0
    assert file.read_text() == template_text(name)
    assert read_design(file).name


def test_an_example_and_a_template_at_once_are_refused(run):
    found = run("new", "propeller", "--template", "propeller")
    assert found.status == 2
    assert "give one of them" in found.err


def test_an_unknown_template_names_the_nearest(run):
    found = run("new", "--template", "turbin-vane")
    assert found.status == 2
    assert "did you mean 'turbine-vane'" in found.err


@pytest.mark.parametrize("name", examples())
def test_new_writes_an_example_that_reads(name, run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run("new", name).status == 0
    assert (tmp_path / f"{name}.toml").read_text() == example_text(name)
    assert read_design(f"{name}.toml").name == name


def test_new_overwrites_nothing_unless_forced(run, tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text("mine")
    found = run("new", "fan-rotor", "-o", path)
    assert found.status == 2
    assert "--force" in found.err
    assert path.read_text() == "mine"
    assert run("new", "fan-rotor", "-o", path, "--force", "--json").json["file"] == str(path)
    assert path.read_text() == example_text("fan-rotor")


def test_new_names_the_nearest_example(run):
    found = run("new", "fan-rotr")
    assert (found.status, found.err.count("\n")) == (2, 1)
    assert "did you mean 'fan-rotor'" in found.err


def test_a_design_that_is_the_name_of_an_example_says_how_to_write_it(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("fan-rotor", "fan-rotor.toml"):
        found = run("show", name)
        assert found.status == 2
        assert "bladewright new fan-rotor" in found.err


def test_the_schema_is_printed_or_written(run, tmp_path):
    assert run("schema").json == schema()
    assert run("schema", "--json").json == schema()
    assert run("schema", "-o", tmp_path / "schema.json").status == 0
    assert json.loads((tmp_path / "schema.json").read_text()) == schema()


def test_show_prints_properties_and_checks(run, vane_file):
    found = run("show", vane_file, "--json")
    assert (found.status, found.err) == (0, "")
    data = found.json
    assert (data["name"], data["family"]) == ("vane", "unified")
    assert data["promises"]["kept"] is True
    assert data["error"] <= read_design(vane_file).tolerance
    assert data["parameters"] == len(read_design(vane_file).parameters())
    assert set(data["surfaces"]) == {"upper", "lower", "hub", "shroud"}
    blade = read_design(vane_file).build()
    assert data["properties"]["volume"] == pytest.approx(float(blade.properties.volume), rel=1e-12)
    text = run("show", vane_file).out
    assert f"{float(blade.properties.volume) * 1e9:.6g} mm3" in text
    assert "all 8 passed" in text
    assert "at most 0.001 allowed" in text


def test_set_changes_what_is_shown_as_it_changes_the_file(run, vane_file):
    changes = ["--set", "length_unit=m"]
    volumes = [run("show", vane_file, *words, "--json").json["properties"]["volume"] for words in ([], changes)]
    assert volumes[1] == pytest.approx(1e9 * volumes[0], rel=1e-9)


def test_a_check_that_fails_gives_status_one(run, vane_file, monkeypatch):
    from bladewright.blade.native import conformance

    monkeypatch.setitem(conformance.LIMITS, "edge_radius", 1e-12)
    found = run("show", vane_file)
    assert found.status == 1
    assert "edge_radius" in found.err
    assert "1e-12" in found.err
    assert "1 of 8 FAILED" in found.out
    assert "at most 1e-12 allowed: FAILED" in found.out


def test_show_draws_a_picture(run, tmp_path):
    (tmp_path / "vane.toml").write_text(SECTION)
    picture = tmp_path / "new" / "vane.png"
    found = run("show", tmp_path / "vane.toml", "-o", picture, "--json")
    assert (found.status, found.json["picture"]) == (0, str(picture))
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("name", ["new/vane.gif", "file/vane.png", "new/"])
def test_show_refuses_a_picture_that_cannot_be_before_it_works(run, tmp_path, monkeypatch, name):
    (tmp_path / "vane.toml").write_text(SECTION)
    (tmp_path / "file").touch()
    before = sorted(tmp_path.iterdir())
    monkeypatch.setattr("bladewright.cli.show.built_from", lambda *_: pytest.fail("it worked"))
    found = run("show", tmp_path / "vane.toml", "-o", f"{tmp_path}/{name}")
    assert (found.status, found.out) == (2, "")
    assert sorted(tmp_path.iterdir()) == before


def test_show_leaves_no_folder_behind_where_the_design_is_refused(run, tmp_path):
    (tmp_path / "vane.toml").write_text(SECTION.replace("chord = 60.0", "chord = 60.0\npitch = 1e-3"))
    assert run("show", tmp_path / "vane.toml", "-o", tmp_path / "new" / "vane.png").status == 2
    assert not (tmp_path / "new").exists()


def test_show_says_how_smooth_a_section_is(run, tmp_path):
    (tmp_path / "vane.toml").write_text(SECTION)
    found = run("show", tmp_path / "vane.toml", "--json")
    assert found.status == 0
    section = found.json["smoothness"][0]
    assert section["span"] == 0.0
    # two parabolas of 2 m / p^2 and 2 m / (1 - p)^2, level where they meet
    assert section["camber"]["joints"][0]["curvature"] == pytest.approx([-0.5, -0.08 / 0.36], rel=1e-6)
    text = run("show", tmp_path / "vane.toml").out
    # from -0.5 to -0.2222 of a chord of 60 mm
    line = next(line for line in text.splitlines() if "camber line" in line)
    assert "curvature jumps by 0.00463 1/mm at 4" in line
    assert "its slope with it" in line


def test_show_says_how_smooth_a_blade_is_from_hub_to_shroud(run, vane_file):
    found = run("show", vane_file, "--json").json["smoothness"]
    assert [each["span"] for each in found] == [0.0, 0.5, 1.0]
    assert all(each["upper"]["curvature_continuous"] for each in found)


def test_a_picture_of_an_unknown_kind_is_refused(run, vane_file, tmp_path):
    found = run("show", vane_file, "-o", tmp_path / "vane.bmpx")
    assert found.status == 2
    assert ".png, .svg, .pdf" in found.err
    assert list(tmp_path.iterdir()) == [vane_file]


def test_examples_say_what_they_are():
    for name, line in examples().items():
        assert line, f"{name}.toml has no description"
        assert tomllib.loads(example_text(name))["name"] == name


def test_show_says_which_law_overshoots_its_stations_or_creases(run, vane_file):
    stations = "{span=[0, 0.3, 0.4, 1], values=[10, 10, 14, 14], interpolation='%s'}"
    found = run("show", vane_file, "--set", f"stagger={stations % 'natural'}")
    assert found.status == 0
    assert found.out.count("stagger ") == 2
    assert "overshoots its stations" in found.out
    assert 'interpolation = "monotone"' in found.out
    data = run("show", vane_file, "--json", "--set", f"stagger={stations % 'natural'}").json["laws"]
    assert [(each["law"], each["unit"]) for each in data["overshoots"]] == [("stagger", "deg")] * 2
    assert all(each["amount"] > 0.004 for each in data["overshoots"])
    assert "laws" not in run("show", vane_file, "--json", "--set", f"stagger={stations % 'monotone'}").json
    found = run("show", vane_file, "--set", f"stagger={stations % 'linear'}")
    assert "creases the surfaces at span 0.3, 0.4: it is linear" in found.out


def test_a_law_at_stations_is_set_and_differentiated_by_its_paths(run, vane_file):
    changes = ["--set", "stagger={span=[0, 0.4, 1], values=[10, 13, 14]}"]
    found = run("sensitivity", vane_file, "--of", "volume", "--check", "--free", "stagger*", *changes)
    assert found.status == 0
    assert "stagger.values[1]" in found.out
    found = run("show", vane_file, "--set", "stagger={span=[0, 0.5], values=[10, 12]}")
    assert (found.status, found.err.count("\n")) == (2, 1)
    assert "stagger.span runs from 0 to 0.5" in found.err


TABLE = "r [mm],metal_angle_in [deg],metal_angle_out [deg],chord [mm]\n100,44,10,50\n130,53,34,50\n160,60,48,50\n"


def test_new_makes_a_design_of_a_table(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rotor.csv").write_text(TABLE)
    found = run("new", "--from-table", "rotor.csv", "--set", "blade_count=17")
    assert (found.status, found.err) == (0, "")
    assert "wrote rotor.toml" in found.out
    assert "flow_path: assumed: a straight annulus" in found.out
    design = read_design("rotor.toml")
    assert design.section.metal_angle_out.values == (10.0, 34.0, 48.0)
    assert design.blade_count == 17
    assert run("new", "--from-table", "rotor.csv").status == 2
    data = run("new", "--from-table", "rotor.csv", "-o", "other.toml", "--json").json
    assert (data["table"], data["file"]) == ("rotor.csv", "other.toml")
    assert "flow_path" in data["remarks"]


def test_new_refuses_a_bad_table_and_writes_nothing(run, tmp_path):
    for text, words in (("r,chord\n1,2\n", "no unit"), (TABLE.replace("34", "x"), "metal_angle_out is 'x'")):
        (tmp_path / "rotor.csv").write_text(text)
        found = run("new", "--from-table", tmp_path / "rotor.csv", "-o", tmp_path / "rotor.toml")
        assert (found.status, found.err.count("\n")) == (2, 1)
        assert words in found.err
        assert not (tmp_path / "rotor.toml").exists()
    assert run("new", "fan-rotor", "--from-table", tmp_path / "rotor.csv").status == 2
    assert run("new", "fan-rotor", "--set", "blade_count=3").status == 2
