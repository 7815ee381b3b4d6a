"""The studies end, and leave what their pages show."""

import runpy
import shutil
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "examples" / "studies"
LEFT = {
    "throat-sweep": (".jsonl", ".csv", "-parallel.png", "-scatter.png", "-effects.png"),
    "naca-23012-polar": (".csv", ".png"),
}
SAYS = {"throat-sweep": "128 built", "naca-23012-polar": "upper leading edge"}
NEEDS_XFOIL = ("naca-23012-polar",)


@pytest.mark.slow  # three pictures with thirty panels
@pytest.mark.parametrize("name", LEFT)
def test_a_study_asserts_its_number_and_leaves_its_files(name, tmp_path, monkeypatch, capsys):
    if name in NEEDS_XFOIL and shutil.which("xfoil") is None:
        pytest.skip("XFOIL is not installed: apt-get install xfoil")
    monkeypatch.setattr(sys, "argv", [f"{name}.py", str(tmp_path)])
    runpy.run_path(str(FOLDER / f"{name}.py"), run_name="__main__")
    assert SAYS[name] in capsys.readouterr().out
    assert {path.name for path in tmp_path.iterdir()} == {name + end for end in LEFT[name]}


SEARCHES = {
    "fan-mass": ([], ("fan-mass.png", "lightest-fan.toml", "lightest-fan.step")),
    "stator-throat": ([], ("stator-throat.toml", "stator-throat.step")),
    "vane-front": (
        ["--members", "3", "--population", "8", "--generations", "1", "--jobs", "1"],
        ("vane-front.png", "vane-front.jsonl", "vane-front-nsga2.jsonl"),
    ),
    "morphing-airfoil": (
        ["--edges", "8", "1", "--skin", "8", "1", "--jobs", "1"],
        ("morphing-airfoil.png", "edges.jsonl", "skin.jsonl"),
    ),
}
"""short runs, and what they leave"""
NEEDED = {"vane-front": ("pymoo",), "morphing-airfoil": ("pymoo", "neuralfoil")}


@pytest.mark.slow
@pytest.mark.parametrize("name", SEARCHES)
def test_a_search_asserts_its_numbers_and_leaves_its_files(name, tmp_path, monkeypatch):
    for module in NEEDED.get(name, ()):
        pytest.importorskip(module)
    if name == "morphing-airfoil" and shutil.which("xfoil") is None:
        pytest.skip("XFOIL is not installed")
    words, left = SEARCHES[name]
    monkeypatch.setattr(sys, "argv", [f"{name}.py", str(tmp_path), *words])
    runpy.run_path(str(FOLDER / f"{name}.py"), run_name="__main__")
    assert {path.name for path in tmp_path.iterdir()} == set(left)
