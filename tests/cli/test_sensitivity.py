"""Derivatives on the command line: a table, its check, and the chain to a flow solver."""

import json
import re

import numpy as np
import pytest

import bladewright as bw
from bladewright.files.reading import read_design
from machines import COARSE, example


def test_the_volume_s_derivatives_are_listed_with_their_units(run, vane_file):
    found = run(
        "sensitivity", vane_file, "--free", "stagger*", "--free", "channel.leading*", "--free", "leading_edge_radius"
    )
    assert found.status == 0
    design = read_design(vane_file)
    exact = bw.sensitivity(design, lambda blade: blade.properties.volume, free=["stagger*", "leading_edge_radius"])
    for path, value in exact.items():
        unit = "mm3/deg" if path.startswith("stagger") else "mm3"
        assert any(line.split() == [path, f"{value * 1e9:.6g}", unit] for line in found.out.splitlines()), path


def test_a_program_gets_si_units(run, vane_file):
    found = run("sensitivity", vane_file, "--of", "centroid", "--json").json
    design = read_design(vane_file)
    assert found["quantity"] == "centroid"
    assert found["unit"] == "m"
    assert list(found["derivatives"]) == list(design.parameters())
    exact = bw.sensitivity(design, lambda blade: blade.properties.centroid, free="stagger*")
    for path, value in exact.items():
        assert found["derivatives"][path] == pytest.approx(list(value), rel=1e-12)
        assert found["units"][path] == "m/deg"


@pytest.fixture
def cascade_file(tmp_path):
    """A blade whose passage folds nowhere."""
    path = tmp_path / "vki-ls89.toml"
    bw.write_design(example("vki-ls89").changed("tolerance", COARSE), path)
    return path


@pytest.mark.parametrize("quantity", ["area", "inertia", "chord", "throat", "surface", "passage-volume"])
def test_every_named_quantity_has_its_derivatives(quantity, run, cascade_file):
    found = run("sensitivity", cascade_file, "--of", quantity, "--free", "stagger*", "--json")
    assert found.status == 0, found.err
    assert all(np.abs(value).max() > 0.0 for value in found.json["derivatives"].values())


def test_a_mass_has_its_derivatives_in_kilograms(run, vane_file):
    words = ("--set", "density=7800", "--free", "density", "--free", "pitch")
    found = run("sensitivity", vane_file, *words, "--of", "mass")
    assert found.status == 0
    assert "kg/(kg/m^3)" in found.out
    data = run("sensitivity", vane_file, *words, "--of", "moment-of-inertia", "--json").json
    assert data["unit"] == "kg m2"
    assert data["derivatives"]["density"] == pytest.approx(data["value"] / 7800.0)
    checked = run("sensitivity", vane_file, *words, "--check")
    assert checked.status == 0
    assert "it is that of the metal" in checked.out
    refused = run("sensitivity", vane_file, "--of", "mass")
    assert refused.status == 2
    assert "density is missing" in refused.err


@pytest.mark.parametrize(
    ("quantity", "unit"),
    [
        ("turning", "deg"),
        ("solidity", "1"),
        ("maximum-thickness", "mm"),
        ("throat_width", "mm"),
        ("outlet_area", "mm2"),
    ],
)
def test_columns_of_the_station_table_have_derivatives_in_their_own_units(quantity, unit, run, cascade_file):
    words = ["sensitivity", cascade_file, "--of", quantity, "--stations", "0.2,0.7", "--free", "metal_angle_out"]
    found = run(*words)
    assert found.status == 0, found.err
    row = next(line.split() for line in found.out.splitlines() if line.split()[0] == "metal_angle_out")
    assert row[-1] == f"{unit}/deg"
    if quantity == "turning":
        # one degree more at the trailing edge turns one degree less, at either station
        assert [float(each) for each in row[1:3]] == pytest.approx([-1.0, -1.0], rel=1e-9)


def test_changes_are_applied_first(run, vane_file):
    plain, changed = (
        run("sensitivity", vane_file, "--free", "stagger*", "--json", *more).json["value"]
        for more in ((), ("--set", "thickness_upper[1]=0.16"))
    )
    assert changed > plain


def test_a_check_passes_is_drawn_and_lists_every_parameter(run, vane_file, tmp_path):
    picture = tmp_path / "check.png"
    found = run("sensitivity", vane_file, "--check", "-o", picture, "--json")
    assert found.status == 0
    data = found.json
    assert data["passed"]
    assert [each["path"] for each in data["checks"]] == list(read_design(vane_file).parameters())
    assert picture.read_bytes().startswith(b"\x89PNG")
    idle = [each for each in data["checks"] if each["note"]]
    assert [each["path"] for each in idle] == ["pitch"]
    for each in data["checks"]:
        if not each["note"]:
            assert each["closest"] < data["limit"]
            # the floor of the complex step is flat over twenty decades
            floor = [
                error for step, error in zip(each["complex_steps"], each["complex_errors"], strict=True) if step < 1e-9
            ]
            assert len(floor) >= 4
            assert max(floor) < 1e-12


def test_a_derivative_that_is_wrong_fails_the_check(run, vane_file, monkeypatch):
    from bladewright.derivatives import step_study

    exact = step_study.stepped

    def off(design, base, paths):
        for path, built in zip(paths, exact(design, base, paths), strict=True):
            yield built if path != "stagger" else next(exact(design, base, ["metal_angle_out"]))

    monkeypatch.setattr(step_study, "stepped", off)
    found = run("sensitivity", vane_file, "--check", "--free", "stagger*", "--free", "tangent_in")
    assert found.status == 1
    assert "FAILED" in found.out
    assert "stagger: the closest difference of the surface is" in found.err


def test_points_go_out_and_a_gradient_comes_back(run, vane_file, tmp_path):
    points = tmp_path / "surface_positions.dat"
    assert run("sensitivity", vane_file, "--write-points", points, "--points", "11x4").status == 0
    written = bw.read_surface_points(points)
    rows = [
        ", ".join([str(number), *map(repr, map(float, row)), "0.0", "1.0", "0.0"])
        for number, row in zip(written.ids, written.points, strict=True)
    ]
    table = tmp_path / "surface_sens.csv"
    table.write_text("\n".join(['"PointID","x","y","z","Sensitivity_x","Sensitivity_y","Sensitivity_z"', *rows]))
    found = run(
        "sensitivity", vane_file, "--from", table, "--points-file", points, "--free", "leading_edge_y", "--json"
    )
    assert found.status == 0, found.err
    # every point moves along y with the leading edge
    assert found.json["derivatives"] == {"leading_edge_y": pytest.approx(len(written.ids) * 1e-3)}
    other = run("sensitivity", vane_file, "--set", "stagger=-20", "--from", table, "--points-file", points)
    assert other.status == 2
    assert "the points must be those of this design" in other.err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--of", "volum"], "did you mean 'volume'?"),
        (["--free", "stager"], "did you mean 'stagger"),
        (["-o", "picture.png"], "-o draws the check: ask for it with --check"),
        (["--from", "sens.csv"], "--from and --points-file belong together"),
        (["--check", "--write-points", "p.dat"], "are different tasks"),
        (["--of", "area", "--write-points", "p.dat"], "--of chooses a quantity, which --write-points does not take"),
        (["--points", "many"], "'many' is no number of points along and across: write it like 81x21"),
        (["--write-points", "p.dat", "--points", "1x5"], "at least 2 x 2 are needed"),
        (["--write-points", "absent/p.dat"], "create the directory 'absent' first"),
        (["--check", "-o", "picture.txt"], "a picture is drawn as"),
        (["--from", "absent.csv", "--points-file", "absent.dat"], "there is no file 'absent.dat.places.csv'"),
    ],
)
def test_a_call_that_makes_no_sense_is_refused_and_leaves_nothing(
    words, message, run, vane_file, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.iterdir())
    found = run("sensitivity", vane_file, *words)
    assert found.status == 2
    assert message in found.err
    assert sorted(tmp_path.iterdir()) == before


def test_a_section_has_its_own_quantities(run, tmp_path):
    assert run("new", "turbine-section", "-o", tmp_path / "section.toml").status == 0
    found = run("sensitivity", tmp_path / "section.toml", "--json").json
    assert found["quantity"] == "area"
    # the area of a section grows with the square of its chord
    design = read_design(tmp_path / "section.toml")
    assert found["derivatives"]["axial_chord"] == pytest.approx(2.0 * found["value"] / design.axial_chord, rel=1e-12)
    check = run("sensitivity", tmp_path / "section.toml", "--check", "--json")
    assert check.status == 0
    assert json.loads(check.out)["passed"]


def test_several_figures_are_named(run, vane_file):
    found = run("sensitivity", vane_file, "--of", "centroid", "--free", "stagger*").out.splitlines()[0]
    assert re.fullmatch(r"vane: centroid x [-\d.e]+, y [-\d.e]+, z [-\d.e]+ mm", found)
    found = run("sensitivity", vane_file, "--of", "turning", "--stations", "0,1", "--free", "stagger*").out
    assert re.match(r"vane: turning [-\d.e]+ deg at span 0, [-\d.e]+ deg at span 1\n", found)
    found = run("sensitivity", vane_file, "--of", "solidity", "--free", "stagger*").out
    assert re.match(r"vane: solidity [\d.]+\n", found)
