"""Each example is a short script that makes verified CAD files and asserts a number; exports/ holds what they make."""

import json
import runpy
import sys
from pathlib import Path

import pytest

from bladewright.files.examples import examples

ROOT = Path(__file__).parents[2]
EXPORTS = ROOT / "exports"
QUICK = ("turbine-section",)
"""the machine that is made fastest; the blades of all are judged in test_machines.py"""
SCRIPTS = sorted(path.stem for path in (ROOT / "examples").glob("*.py") if path.stem not in {"_common", "make_all"})


def test_every_built_in_machine_but_the_readme_s_has_a_script():
    assert set(SCRIPTS) == set(examples()) - {"fan-rotor"}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name in QUICK else [pytest.mark.slow]) for name in SCRIPTS]
)
def test_a_script_makes_verified_files_and_its_number_holds(name, tmp_path, monkeypatch, capsys):
    monkeypatch.syspath_prepend(ROOT / "examples")
    monkeypatch.setattr(sys, "argv", [f"{name}.py", str(tmp_path)])
    runpy.run_path(str(ROOT / "examples" / f"{name}.py"), run_name="__main__")
    assert capsys.readouterr().out.strip()
    suffixes = (".step", ".igs", ".png", ".roundtrip.json")
    assert {path.name for path in tmp_path.iterdir()} == {name + suffix for suffix in suffixes}
    assert json.loads((tmp_path / f"{name}.roundtrip.json").read_text())["passed"]
    # a number is asserted, after it was measured
    assert "\nassert " in (ROOT / "examples" / f"{name}.py").read_text().split("print(")[1]


@pytest.mark.parametrize("name", SCRIPTS)
def test_exports_hold_what_a_script_makes(name):
    report = json.loads((EXPORTS / f"{name}.roundtrip.json").read_text())
    assert report["passed"]
    assert report["file"] == f"{name}.step"
    assert (EXPORTS / f"{name}.step").read_bytes().startswith(b"ISO-10303-21;")
    assert (EXPORTS / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert f"[{name}]({name}.png)" in (EXPORTS / "README.md").read_text(encoding="utf-8")


def test_exports_stay_below_sixteen_megabytes():
    assert sum(path.stat().st_size for path in EXPORTS.iterdir()) < 16e6
