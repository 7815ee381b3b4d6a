"""Sweeps: which runs there are, who carries them out, and that none is lost."""

import csv
import io
import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bladewright.errors import BladewrightError, StudyError
from bladewright.files.reading import read_design
from bladewright.studies.manifest import read_manifest
from bladewright.studies.sampling import SAMPLINGS, count, read_table
from bladewright.studies.study import read_study
from bladewright.studies.sweep import planned, sweep
from bladewright.studies.variables import Range, resolved
from bladewright.studies.workers import Processes

RANGES = {
    "stagger": (-33.0, -29.0),
    "thickness_*": {"lower": 0.9, "upper": 1.1, "relative": True, "together": True},
    "pitch": [22.0, 25.0, 28.0],
}


@pytest.fixture
def section(study_file: Path):
    return read_design(study_file.parent / "turbine-section.toml")


@pytest.fixture
def variables(section):
    ranges = {
        "stagger": Range(lower=-33.0, upper=-29.0, count=5),
        "thickness_*": Range(lower=0.9, upper=1.1, count=2, relative=True, together=True),
        "pitch": Range(values=(22.0, 25.0, 28.0)),
    }
    return resolved(ranges, {"section": section})


def test_a_grid_has_every_combination_once(variables):
    runs = list(SAMPLINGS["grid"](variables, 0, 0))
    assert len({tuple(run.values()) for run in runs}) == len(runs) == count("grid", variables, 0) == 30
    assert {run["stagger"] for run in runs} == {-33.0, -32.0, -31.0, -30.0, -29.0}


def test_a_list_goes_through_the_values_of_all_variables_together(section):
    both = {"stagger": Range(values=(-30.0, -31.0)), "pitch": Range(values=(22.0, 25.0))}
    runs = list(SAMPLINGS["list"](resolved(both, {"": section}), 0, 0))
    assert runs == [{"stagger": -30.0, "pitch": 22.0}, {"stagger": -31.0, "pitch": 25.0}]
    uneven = resolved({**both, "pitch": Range(values=(22.0,))}, {"": section})
    with pytest.raises(BladewrightError, match="stagger 2, pitch 1"):
        SAMPLINGS["list"](uneven, 0, 0)


@pytest.mark.parametrize("sampling", ["latin-hypercube", "sobol"])
def test_samples_fill_the_ranges_evenly_and_a_seed_repeats_them(sampling, variables):
    runs = list(SAMPLINGS[sampling](variables, 32, 7))
    assert runs == list(SAMPLINGS[sampling](variables, 32, 7)) != list(SAMPLINGS[sampling](variables, 32, 8))
    stagger = np.array([run["stagger"] for run in runs])
    # both have one value in each of 32 equal parts; of three choices, each has its share
    assert sorted(np.floor((stagger + 33.0) / 4.0 * 32.0).astype(int)) == list(range(32))
    assert set(Counter(run["pitch"] for run in runs).values()) <= {10, 11, 12}
    if sampling == "sobol":
        assert list(SAMPLINGS[sampling](variables, 20, 7)) == runs[:20]


def test_a_table_of_runs_is_read_and_that_of_a_sweep_again(section, tmp_path):
    runs = sweep(section, {"stagger": (-33, -29), "pitch": [22.0, 25.0]}, samples=4, jobs=1)
    path = tmp_path / "runs.csv"
    rows = list(csv.reader(io.StringIO(runs.to_csv())))
    assert rows[0] == ["run", "stagger [deg]", "pitch [mm]", "verdict", "reason"]
    path.write_text("\n".join(",".join(row[:3]) for row in rows))
    assert sweep(section, path, jobs=1).parameters == runs.parameters
    bad = {
        "stagger\n": "no table of runs",
        "stagger,stagger\n1,2\n": "twice",
        "stagger,pitch\n1\n": "1 values in row 2",
        "stager\n1\n": "did you mean 'stagger'",
    }
    for text, words in bad.items():
        path.write_text(text)
        with pytest.raises(BladewrightError, match=words):
            resolved(read_table(path), {"": section})
    with pytest.raises(BladewrightError, match="cannot be read"):
        read_table(tmp_path / "nothing.csv")


def test_a_sweep_gives_columns_designs_and_reasons(section):
    runs = sweep(section, {**RANGES, "axial_chord": [30.0, -1.0]}, ["area", mean_radius], samples=8, jobs=1)
    verdicts = Counter(runs.verdicts)
    assert set(verdicts) == {"built", "refused"}
    assert len(runs) == 8 == sum(verdicts.values())
    first = int(np.flatnonzero(runs.good)[0])
    design = runs.design(runs.numbers[first])
    assert runs.figures["area"][first] == pytest.approx(design.build().area * 1e6, rel=1e-14)
    assert runs.figures["mean_radius"][first] == pytest.approx(design.build().perimeter / (2.0 * np.pi))
    assert runs.units == {"stagger": "deg", "axial_chord": "mm", "thickness_*": "-", "pitch": "mm", "area": "mm2"}
    assert np.array_equal(np.isnan(runs.figures["area"]), ~runs.good)
    assert set(runs.reasons) == {run for run, good in zip(runs.numbers, runs.good, strict=True) if not good}
    assert next(iter(runs.reasons.values())) in str(runs)
    with pytest.raises(BladewrightError, match="there is no run 9"):
        runs.design(9)


def mean_radius(section):
    return section.perimeter / (2.0 * np.pi)


@pytest.mark.parametrize("kind", ["threads", pytest.param("processes", marks=pytest.mark.slow)])
def test_several_workers_give_the_same_records_and_a_manifest_repeats_them(kind, study_file, tmp_path, monkeypatch):
    if kind == "threads":  # which start at once
        monkeypatch.setattr(Processes, "_started", lambda self: ThreadPoolExecutor(self._count))
    plan = planned(read_study(study_file))
    first, second, again = (tmp_path / f"{name}.jsonl" for name in ("first", "second", "again"))
    plan.carried_out(first, jobs=1)
    plan.carried_out(second, jobs=2)
    planned(read_study(first)).carried_out(again, jobs=1)

    def kept(path):
        return sorted((replace(each, seconds=0.0) for each in read_manifest(path)[1]), key=lambda each: each.run)

    assert len(kept(first)) == 8
    assert kept(first) == kept(second) == kept(again)


def test_a_function_that_cannot_be_sent_is_refused(section):
    with pytest.raises(BladewrightError, match="jobs=1"):
        sweep(section, RANGES, [lambda section: section.chord], jobs=2)


WRONG = {
    "7": "give a pair",
    "{}": "no lower and no upper",
    '{"lwer": 3}': "known are lower, upper",
    "[]": "give a pair",
}


@pytest.mark.parametrize("given", WRONG)
def test_a_wrong_range_is_refused(given, section):
    with pytest.raises(BladewrightError, match=WRONG[given]):
        sweep(section, {"stagger": json.loads(given)}, jobs=1)


KILLED = """
design = "turbine-section.toml"
[variables]
stagger = { lower = -33, upper = -29 }
[sweep]
samples = 150
quantities = ["area"]
"""


def killed_and_continued(folder: Path, waits: list[float]) -> Path:
    """The manifest of a sweep whose process is killed after some seconds each time, and that then ends."""
    (folder / "vane-study.toml").write_text(KILLED)
    command = [sys.executable, "-m", "bladewright", "sweep", "vane-study.toml", "--jobs", "1", "-q"]
    manifest = folder / "vane-study.jsonl"
    for wait in waits:
        before = manifest.stat().st_size if manifest.exists() else 0
        process = subprocess.Popen(command, cwd=folder)
        while process.poll() is None and (manifest.stat().st_size if manifest.exists() else 0) <= before:
            time.sleep(0.005)
        time.sleep(wait)
        process.send_signal(signal.SIGKILL)
        process.wait()
    subprocess.run(command, cwd=folder, check=True)
    return manifest


def assert_none_lost_or_doubled(manifest: Path) -> None:
    records = list(read_manifest(manifest)[1])
    assert sorted(each.run for each in records) == list(range(1, 151))
    assert len(manifest.read_bytes().splitlines()) == 151


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="SIGKILL is of Unix")
def test_a_sweep_killed_ten_times_loses_nothing(study_file):
    rng = np.random.default_rng(5)
    manifest = killed_and_continued(study_file.parent, list(rng.uniform(0.0, 0.1, 10)))
    assert_none_lost_or_doubled(manifest)


def test_an_edit_of_a_function_is_noticed_where_a_sweep_goes_on(study_file, tmp_path):
    def plan(source):
        (study_file.parent / "figures.py").write_text(source)
        return planned(read_study(study_file), quantities=["figures:size"])

    plan("def size(section): return section.area\n").carried_out(tmp_path / "runs.jsonl", jobs=1)
    same = plan("def size(section): return section.area\n").carried_out(tmp_path / "runs.jsonl", jobs=1)
    assert len(same) == 8
    edited = plan("def size(section): return 2.0 * section.area\n")
    with pytest.raises(StudyError, match="the source of size was edited since the runs of"):
        edited.carried_out(tmp_path / "runs.jsonl", jobs=1)


FATAL = """
import os
def fatal(section):
    if section.stagger < -0.57: os._exit(9)
    return 1.0
"""


@pytest.mark.slow
def test_a_run_that_stops_its_process_has_failed_and_the_others_go_on(study_file):
    (study_file.parent / "figures.py").write_text(FATAL)
    plan = planned(read_study(study_file), quantities=["figures:fatal"])
    runs = plan.carried_out(None, jobs=2)
    stopped = {run for run, reason in runs.reasons.items() if "has stopped" in reason}
    low = {run for run, stagger in zip(runs.numbers, runs.parameters["stagger"], strict=True) if stagger < -32.66}
    assert stopped == low
    assert Counter(runs.verdicts) == {"built": 8 - len(low), "failed": len(low)}
    assert low


STUBBORN = """
import time
def stubborn(section):
    while section.stagger < -0.57:
        try:
            while True: time.sleep(0.1)
        except BaseException: pass
    return 1.0
"""


@pytest.mark.slow
def test_a_run_that_ignores_its_limit_is_stopped_with_its_process(study_file):
    (study_file.parent / "figures.py").write_text(STUBBORN)
    study = read_study(study_file)
    plan = planned(replace(study, sweep=replace(study.sweep, time_limit=1.0)), quantities=["figures:stubborn"])
    runs = plan.carried_out(None, jobs=2)
    stopped = [run for run, reason in runs.reasons.items() if "ignored its limit of 1 s" in reason]
    assert len(stopped) == Counter(runs.verdicts)["failed"] > 0
    assert Counter(runs.verdicts)["built"] == 8 - len(stopped)
