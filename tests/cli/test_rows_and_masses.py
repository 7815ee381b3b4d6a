"""Rows and masses on the command line, and tables that --set makes."""

import json

import pytest


@pytest.fixture
def vane(vane_file):
    return vane_file


def test_a_row_is_built_verified_and_weighed(run, vane, tmp_path):
    words = ("--body", "blade,row", "--blades", "3", "--set", "density=7800")
    made = run("build", vane, "-o", tmp_path / "out", *words, "--json")
    assert made.status == 0, made.err
    assert sorted(each.name for each in (tmp_path / "out").iterdir()) == [
        "vane-row.roundtrip.json", "vane-row.step", "vane.igs", "vane.igs.roundtrip.json", "vane.roundtrip.json",
        "vane.step",
    ]  # fmt: skip
    masses = made.json["masses"]
    assert masses["row"]["mass_kg"] == pytest.approx(3.0 * masses["blade"]["mass_kg"])
    volume = made.json["roundtrips"][0]["volume_mm3"]["cad"]
    assert masses["blade"]["mass_kg"] == pytest.approx(7800e-9 * volume, rel=1e-6)
    # the middle blade is a pitch of 45 mm away
    shift = masses["row"]["centre_m"][1] - masses["blade"]["centre_m"][1]
    assert shift == pytest.approx(0.045)
    assert len(json.loads((tmp_path / "out" / "vane-row.roundtrip.json").read_text())["placements"]) == 3

    found = run("verify", tmp_path / "out" / "vane-row.step", vane, "--blades", "3", "--json")
    assert (found.status, found.json["body"], found.json["solids"]) == (0, "row", 3)
    more = run("verify", tmp_path / "out" / "vane-row.step", vane, "--blades", "4")
    assert more.status == 1
    assert "blade_04 is missing" in more.out + more.err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--body", "row"), "is a cascade, which has no end: say how many blades"),
        (("--body", "row", "--blades", "3", "--as", "iges"), "which step and brep files keep"),
        (("--blades", "3"), "--blades counts those of a row: ask for one with --body row"),
        (("--walls", "trimmed"), "--walls shapes a passage: ask for one with --body passage"),
        (("--set", "hub_fillet.radius=-1"), "hub_fillet.radius is -1: a fillet's size must be positive"),
        (("--set", "cut.trailing_edg.x=3"), "cut.trailing_edg does not exist; did you mean 'trailing_edge'?"),
        (("--set", "density=0"), "density is 0"),
    ],
)
def test_what_cannot_be_is_refused_and_leaves_nothing(words, said, run, vane, tmp_path):
    refused = run("build", vane, "-o", tmp_path / "out", *words)
    assert refused.status == 2
    assert said in refused.err
    assert not (tmp_path / "out").exists()


def test_show_tells_the_mass_of_a_blade_and_of_a_row(run, vane):
    words = ("--set", "density=7800")
    blade = run("show", vane, *words)
    assert blade.status == 0
    assert "inertia about axis" in blade.out
    row = run("show", vane, "--body", "row", "--blades", "2", *words, "--json").json
    assert (row["name"], row["blades"], row["faces"]) == ("vane-row", 2, 8)
    assert row["mass"]["mass_kg"] == pytest.approx(7800.0 * row["properties"]["volume"])


def test_trimmed_walls_are_built_and_told(run, vane, tmp_path):
    shown = run("show", vane, "--body", "passage", "--walls", "trimmed")
    assert shown.status == 0, shown.err
    assert "trimmed faces of their exact surfaces" in shown.out
    made = run("build", vane, "-o", tmp_path, "--as", "step", "--body", "passage", "--walls", "trimmed", "--json").json
    assert [face["name"] for face in made["roundtrips"][0]["faces"]][:2] == ["hub", "shroud"]


def test_a_table_that_the_file_lacks_is_made_by_set_and_recorded(tmp_path):
    from bladewright import design_origin
    from bladewright.files.changing import changed_design
    from bladewright.files.examples import example_text
    from bladewright.files.reading import parsed

    document = parsed(example_text("fan-rotor"), "fan-rotor")
    changes = {"cut.trailing_edge.radius": 93, "cut.tip": {"x": 12}, "hub_fillet": {"radius": 2.0}, "density": 4430}
    design = changed_design(document, "fan-rotor", changes)
    assert design.cut.trailing_edge.radius == 93.0
    assert design.cut.tip.x == 12.0
    assert design.hub_fillet.radius == 2.0
    assert design.density == 4430.0
    again = changed_design(document, "fan-rotor", {**changes, "hub_fillet.radius": 3.0})
    assert again.hub_fillet.radius == 3.0
    path = tmp_path / "fan.toml"
    path.write_text(example_text("fan-rotor"))
    assert "cut.tip={x = 12}" in design_origin(path, changes).changes
