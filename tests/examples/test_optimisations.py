"""The optimisation reaches what it promises, and leaves a design and verified CAD files."""

import json
import runpy
import sys
from pathlib import Path

import pytest

from bladewright.files.reading import read_design

FOLDER = Path(__file__).parents[2] / "examples" / "optimisation"
SCRIPTS = sorted(path.stem for path in FOLDER.glob("*.py") if path.stem != "_change")


@pytest.mark.parametrize("name", SCRIPTS)
def test_an_optimisation_reaches_its_goal_and_writes_what_it_found(name, tmp_path, monkeypatch, capsys):
    monkeypatch.syspath_prepend(FOLDER)
    monkeypatch.setattr(sys, "argv", [f"{name}.py", str(tmp_path)])
    runpy.run_path(str(FOLDER / f"{name}.py"), run_name="__main__")
    assert "iterations" in capsys.readouterr().out
    assert {path.name for path in tmp_path.iterdir()} == {
        name + suffix for suffix in (".toml", ".step", ".png", ".roundtrip.json")
    }
    assert json.loads((tmp_path / f"{name}.roundtrip.json").read_text())["passed"]
    assert read_design(tmp_path / f"{name}.toml").name == name
