"""The studies end, and leave what their pages show."""

import runpy
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "examples" / "studies"
LEFT = {"throat-sweep": (".jsonl", ".csv", "-parallel.png", "-scatter.png", "-effects.png")}


@pytest.mark.parametrize("name", LEFT)
def test_a_study_asserts_its_number_and_leaves_its_files(name, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", [f"{name}.py", str(tmp_path)])
    runpy.run_path(str(FOLDER / f"{name}.py"), run_name="__main__")
    assert "128 built" in capsys.readouterr().out
    assert {path.name for path in tmp_path.iterdir()} == {name + end for end in LEFT[name]}
