"""Sectors and wheels on the command line: built, found, weighed, differentiated, refused."""

import json

import pytest

from bladewright.files.examples import example_text
from machines import COARSE

DISC = ("--set", "disc.thickness=5", "--set", "density=7800", "--set", f"tolerance={COARSE}")


@pytest.fixture(scope="module")
def propeller(tmp_path_factory):
    path = tmp_path_factory.mktemp("wheel") / "propeller.toml"
    path.write_text(example_text("propeller"))
    return path


@pytest.fixture(scope="module")
def made(propeller):
    """A directory with the STEP files of a sector and a wheel of three blades."""
    from bladewright.cli import main

    words = ["build", str(propeller), "-o", str(propeller.parent / "out"), "--as", "step", "--body", "sector,wheel"]
    assert main([*words, *DISC, "-q"]) == 0
    return propeller.parent / "out"


def test_a_sector_and_a_wheel_have_their_files_and_a_wheel_is_all_sectors(made):
    assert sorted(each.name for each in made.iterdir()) == [
        "propeller-sector.roundtrip.json", "propeller-sector.step",
        "propeller-wheel.roundtrip.json", "propeller-wheel.step",
    ]  # fmt: skip
    sector, wheel = (
        json.loads((made / f"propeller-{body}.roundtrip.json").read_text()) for body in ("sector", "wheel")
    )
    assert sector["passed"]
    assert wheel["passed"]
    assert (sector["solids"], wheel["solids"]) == (1, 1)
    assert wheel["volume_mm3"]["native"] == pytest.approx(3.0 * sector["volume_mm3"]["native"], rel=1e-9)
    assert "blade_03_upper" in [face["name"] for face in wheel["faces"]]


@pytest.mark.slow
def test_a_file_tells_which_body_it_holds(made, run, propeller):
    found = run("verify", made / "propeller-sector.step", propeller, *DISC, "--json")
    assert (found.status, found.json["body"]) == (0, "sector")


def test_a_wheel_is_found_and_each_kind_of_its_faces_named_once(made, run, propeller):
    found = run("verify", made / "propeller-wheel.step", propeller, *DISC)
    assert found.status == 0, found.err
    assert "blade_*_upper" in found.out
    assert "the worst of 3" in found.out
    assert "blade_02" not in found.out


def test_a_wheel_is_shown_and_its_mass_differentiated(run, propeller):
    shown = run("show", propeller, "--body", "wheel", *DISC, "--json").json
    assert (shown["name"], shown["blades"]) == ("propeller-wheel", 3)
    assert shown["mass"]["mass_kg"] == pytest.approx(7800.0 * shown["properties"]["volume"])
    words = ("--of", "wheel-mass", "--free", "density", "--free", "disc.*", "--free", "stagger[1]", "--json")
    found = run("sensitivity", propeller, *DISC, *words).json
    assert found["derivatives"]["density"] == pytest.approx(found["value"] / 7800.0)
    assert found["derivatives"]["disc.thickness"] > 0.0
    assert found["derivatives"]["stagger[1]"] != 0.0


@pytest.mark.parametrize("body", ["sector", "wheel"])
def test_a_wheel_without_a_disc_is_refused_and_told_what_to_add(run, propeller, tmp_path, body):
    refused = run("build", propeller, "-o", tmp_path / "out", "--body", body)
    assert refused.status == 2
    assert "neither disc nor shroud_ring is given" in refused.err
    assert "add a table [disc]" in refused.err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("points", "why"),
    [
        ([[-60, 150], [-60, 60], [80, 60], [80, 190]], "points[0] is (-60, 150), which lies 40 off the hub"),
        ([[-60, 190], [10, 220], [20, 60], [80, 190]], "its outline cuts the hub near"),
    ],
)
def test_a_disc_that_does_not_fit_is_found_before_a_file_is_written(run, propeller, tmp_path, points, why):
    out = tmp_path / "out"
    words = ("build", propeller, "-o", out, "--as", "stl", "--chordal-deviation", "5mm", "--set", f"tolerance={COARSE}")
    assert run(*words).status == 0
    before = {each.name: each.read_bytes() for each in out.iterdir()}
    disc = ("--set", f"disc.outline.points={points}", "--set", "stagger[0]=-33")
    refused = run(*words, "--body", "blade,wheel", *disc)
    assert refused.status == 2
    assert why in refused.err
    assert {each.name: each.read_bytes() for each in out.iterdir()} == before


def test_a_cascade_has_no_wheel(run, vane_file, tmp_path):
    refused = run("build", vane_file, "-o", tmp_path / "out", "--body", "wheel")
    assert refused.status == 2
    assert "is a cascade, and sectors and wheels are annular" in refused.err
