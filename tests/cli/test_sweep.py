"""`bladewright sweep`: figures, files and pictures of many designs, and what is refused."""

import json

import pytest

from bladewright.files.examples import example_text
from bladewright.files.reading import read_design
from bladewright.studies.run import record_of

STUDY = """
design = "turbine-section.toml"
[variables]
stagger = { lower = -33, upper = -29 }
pitch = { values = [24, 28] }
[sweep]
samples = 6
quantities = ["throat", "area"]
"""


@pytest.fixture
def study(tmp_path, monkeypatch):
    """The name of a study file in the working directory."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "turbine-section.toml").write_text(example_text("turbine-section"))
    (tmp_path / "study.toml").write_text(STUDY)
    return tmp_path / "study.toml"


def test_a_sweep_prints_figures_and_writes_manifest_table_and_pictures(run, study):
    study.write_text(STUDY.replace('["throat", "area"]', '["throat"]'))  # few panels, which draw fast
    pictures = ["--parallel", "p.png", "--scatter", "s.svg", "--effects", "e.pdf"]
    found = run("sweep", "study.toml", "--jobs", "1", "--csv", "out/runs.csv", *pictures)
    assert (found.status, found.err) == (0, "")
    assert "study: 6 runs: 6 built" in found.out
    assert "throat [mm]" in found.out
    written = [line.removeprefix("wrote ") for line in found.out.splitlines() if line.startswith("wrote ")]
    assert written == ["study.jsonl", "out/runs.csv", "p.png", "s.svg", "e.pdf"]
    assert all((study.parent / name).stat().st_size > 300 for name in written)


def test_the_same_command_repeats_nothing_and_the_manifest_is_a_study(run, study):
    first = run("sweep", "study.toml", "--jobs", "1", "--json").json
    before = (study.parent / "study.jsonl").read_bytes()
    assert run("sweep", "study.toml", "--jobs", "1", "--json").json == first
    assert (study.parent / "study.jsonl").read_bytes() == before
    again = run("sweep", "study.jsonl", "--jobs", "1", "-o", "again.jsonl", "--json").json
    assert again["figures"] == first["figures"]
    assert again["verdicts"] == {"built": 6}
    refused = run("sweep", "study.jsonl")
    assert refused.status == 2
    assert "name it with -o" in refused.err


def test_runs_come_from_a_table_and_files_are_verified(run, study):
    (study.parent / "runs.csv").write_text("stagger,pitch\n-30,25\n-95,25\n")
    found = run("sweep", "study.toml", "--table", "runs.csv", "--as", "step", "--jobs", "1")
    assert found.status == 0
    assert "2 runs: 1 verified, 1 refused" in found.out
    assert [path.name for path in (study.parent / "study").iterdir()] == ["turbine-section-0001.step"]


def test_the_design_of_a_run_is_one_command_from_its_files(run, study):
    run("sweep", "study.toml", "--jobs", "1")
    lines = [json.loads(line) for line in (study.parent / "study.jsonl").read_text().splitlines()[1:]]
    for path in ("study.toml", "study.jsonl"):
        found = run("sweep", path, "--member", "3", "-d", "out")
        assert (found.status, found.out) == (0, "wrote out/turbine-section-0003.toml\n")
    design = read_design("out/turbine-section-0003.toml")
    assert {"stagger": design.stagger, "pitch": design.pitch} == lines[2]["parameters"]
    assert "no run 7 in 'study.jsonl'" in run("sweep", "study.toml", "--member", "7").err


def test_an_interrupted_sweep_says_how_to_go_on(run, study, monkeypatch):
    def stopped(experiment, number, parameters):
        if number == 3:
            raise KeyboardInterrupt
        return record_of(experiment, number, parameters)

    monkeypatch.setattr("bladewright.studies.workers.record_of", stopped)
    found = run("sweep", "study.toml", "--jobs", "1")
    assert (found.status, found.out) == (130, "")
    told = "interrupted: what has ended is in 'study.jsonl', and the same command goes on"
    assert found.err.strip() == f"bladewright: {told}"
    assert len((study.parent / "study.jsonl").read_text().splitlines()) == 3


FUNCTIONS = """
import math
def nothing(section): return math.nan
def raises(section): raise RuntimeError("no solver here")
"""


def test_a_quantity_that_fails_in_every_run_is_one_paragraph_and_loses_nothing(run, study):
    (study.parent / "figures.py").write_text(FUNCTIONS)
    asked = '["area", "figures:nothing", "figures:raises"]'
    study.write_text(STUDY.replace('["throat", "area"]', asked))
    found = run("sweep", "study.toml", "--jobs", "1")
    assert found.status == 1
    assert found.err.count("\n") == 1
    assert "6 of 6 runs have failed, the first of them run 1: nothing is nan" in found.err
    assert "raises: RuntimeError: no solver here" in found.err
    lines = [json.loads(line) for line in (study.parent / "study.jsonl").read_text().splitlines()[1:]]
    assert all(line["figures"]["area"] > 0.0 and line["figures"]["nothing"] is None for line in lines)
    (study.parent / "figures.py").write_text(FUNCTIONS.replace("math.nan", "1.0").replace("raise R", "return 2; R"))
    repeated = run("sweep", "study.toml", "--jobs", "1", "--retry")
    assert (repeated.status, repeated.err) == (0, "")


def test_where_no_design_can_be_built_the_reason_is_said(run, study):
    study.write_text(STUDY.replace("lower = -33, upper = -29", "lower = 91, upper = 95"))
    found = run("sweep", "study.toml", "--jobs", "1", "--effects", "e.png")
    assert found.status == 2
    assert "nothing to draw" in found.err
    found = run("sweep", "study.toml", "--jobs", "1")
    assert found.status == 1
    assert "no design of 6 could be built: stagger" in found.err


REFUSED = {
    ("sweep", "nothing.toml"): "there is no file 'nothing.toml'",
    ("sweep", "study.toml", "--jobs", "2", "--scheduler", "tcp://x"): "leave one out",
    ("sweep", "study.toml", "--effects", "e.jpg"): "ends in '.jpg'",
    ("sweep", "study.toml", "--table", "none.csv"): "cannot be read",
    ("sweep", "turbine-section.toml"): "family does not exist",
    ("sweep", "study.toml", "-o", "turbine-section.toml"): "is no manifest of a study",
}


@pytest.mark.parametrize("words", REFUSED)
def test_wrong_calls_are_one_paragraph_and_leave_nothing(words, run, study):
    before = sorted(study.parent.iterdir())
    found = run(*words)
    assert found.status == 2
    assert REFUSED[words] in found.err
    assert found.err.count("\n") == 1
    assert sorted(study.parent.iterdir()) == before
