"""`bladewright show` on a CAD file: which design it was made from."""

import json

import pytest
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

from bladewright.cli.build_files import SUFFIXES
from bladewright.cli.load_design import load_design
from bladewright.origin import parameters_hash


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The vane of `vane.toml` in every format, one parameter changed."""
    from pathlib import Path

    from bladewright.cli import main

    folder = tmp_path_factory.mktemp("made")
    design = folder / "vane.toml"
    design.write_text((Path(__file__).parent / "vane.toml").read_text())
    formats = ",".join(SUFFIXES)
    words = ("build", design, "-o", folder / "out", "--as", formats, "--set", "stagger=-41.0", "--quiet")
    assert main([*map(str, words), "--chordal-deviation", "5mm"]) == 0
    return folder / "out"


@pytest.mark.parametrize("ending", SUFFIXES.values())
def test_a_file_tells_its_design_and_the_report_beside_it_the_text(run, made, ending, tmp_path):
    found = run("show", made / f"vane{ending}", "--json")
    assert found.status == 0
    design = found.json["design"]
    assert (design["name"], design["file"], design["changes"]) == ("vane", "../vane.toml", ["stagger=-41.0"])
    # the design that made the file can be made again from what is told
    (tmp_path / "again.toml").write_text(design["text"])
    again = load_design(tmp_path / "again.toml", {"stagger": -41.0})
    assert design["parameters_hash"] == parameters_hash(again)


@pytest.mark.parametrize("ending", [".step", ".igs"])
def test_a_file_without_its_report_tells_name_hash_and_changes(run, made, ending, tmp_path):
    alone = tmp_path / f"alone{ending}"
    alone.write_bytes((made / f"vane{ending}").read_bytes())
    found = run("show", alone)
    lines = found.out.splitlines()
    assert "written by bladewright" in lines[0]
    assert lines[1] == "  design      vane"
    assert lines[2].startswith("  parameters  sha256 ")
    assert lines[3] == "  changes     --set stagger=-41.0"
    assert lines[4] == "  text        not beside the file"


def test_a_report_about_another_design_is_said(run, made, tmp_path):
    (tmp_path / "vane.step").write_bytes((made / "vane.step").read_bytes())
    report = json.loads((made / "vane.roundtrip.json").read_text())
    report["design"] |= {"parameters_hash": "0" * 64}
    (tmp_path / "vane.roundtrip.json").write_text(json.dumps(report))
    found = run("show", tmp_path / "vane.step")
    assert "note: vane.roundtrip.json beside it is about another design" in found.out
    assert "not beside the file" in found.out


def test_a_foreign_file_names_no_design(run, tmp_path):
    writer = STEPControl_Writer()
    writer.Transfer(BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape(), STEPControl_AsIs)
    writer.Write(str(tmp_path / "box.step"))
    found = run("show", tmp_path / "box.step")
    assert found.status == 0
    assert "it names no design; bladewright did not write it" in found.out
    assert run("show", tmp_path / "box.step", "--json").json["design"] is None


def test_options_of_a_design_are_refused_for_a_cad_file(run, made):
    assert run("show", made / "vane.step", "-o", made / "x.png").status == 2
    assert run("show", made / "vane.step", "--set", "stagger=1").status == 2
    assert run("show", made / "none.step").err.startswith("bladewright: there is no file")
