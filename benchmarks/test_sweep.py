"""Sweeps: unified blades with their figures, what a run costs besides its build, and memory over many runs."""

import os
import resource
import time
from importlib import resources
from itertools import islice
from pathlib import Path

import pytest

import bladewright as bw
from bladewright.studies.run import record_of
from bladewright.studies.study import Study, SweepOptions
from bladewright.studies.sweep import planned
from bladewright.studies.variables import Range

VARIED = {
    "stagger*": {"lower": -3.0, "upper": 3.0, "offset": True},
    "metal_angle_out*": {"lower": -2.0, "upper": 2.0, "offset": True},
    "thickness_*": {"lower": 0.9, "upper": 1.1, "relative": True, "together": True},
}
FIGURES = ["volume", "centroid", "throat", "stagger@0.5", "solidity@0.5", "inertia"]
SECTION = {"stagger": {"lower": -34.0, "upper": -28.0}, "pitch": {"lower": 24.0, "upper": 30.0}}


def example(name):
    with resources.as_file(resources.files("bladewright") / "examples" / f"{name}.toml") as path:
        return bw.read_design(path)


def plan(name, ranges, quantities, samples):
    design = example(name)
    study = Study(
        name=name,
        folder=Path.cwd(),
        designs={design.name: design},
        ranges={path: Range(**given) for path, given in ranges.items()},
        sweep=SweepOptions(sampling="sobol", samples=samples),
        optimise=None,
    )
    return planned(study, quantities=quantities)


@pytest.mark.parametrize("name", ["vki-ls89", "centrifugal-impeller", "fan-rotor"])
def test_a_thousand_unified_blades_with_their_figures_in_ninety_seconds_of_two_processors(name):
    made = plan(name, VARIED, FIGURES, 64)
    runs = list(islice(made.runs(), 21))
    record_of(made.experiment, *runs[0])
    costs = []
    for run in runs[1:]:
        before = time.process_time()
        assert record_of(made.experiment, *run).verdict == "built"
        costs.append(time.process_time() - before)
    seconds = 1000 * sum(costs) / len(costs) / 2
    print(f"\n1,000 designs of {name} with six figures: {seconds:.0f} s on two processors, to reach 90 s")
    assert seconds <= 90


def test_what_a_run_costs_besides_its_build(tmp_path):
    made = plan("turbine-section", SECTION, ["area"], 2000)
    made.carried_out(None, jobs=1)
    before = os.times()
    made.carried_out(tmp_path / "runs.jsonl", jobs=2)
    after = os.times()
    driver = after.user + after.system - before.user - before.system
    print(f"\na run costs its driver {1e3 * driver / 2000:.2f} ms, to reach 5 ms")
    assert driver / 2000 <= 5e-3


def test_memory_does_not_grow_with_the_runs(tmp_path):
    made = plan("turbine-section", SECTION, ["area"], 4000)
    sizes = []

    def noted(_):
        sizes.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)

    made.carried_out(tmp_path / "runs.jsonl", jobs=1, progress=noted)
    grown = (sizes[-1] - sizes[400]) / 1024.0
    print(f"\nbetween 400 and 4,000 runs a process grows by {grown:.1f} MB, to reach 2 MB")
    assert grown <= 2.0


def test_what_dask_adds(tmp_path):
    distributed = pytest.importorskip("distributed")
    made = plan("turbine-section", SECTION, ["area"], 500)
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50
    ) as cluster:
        before = time.process_time()
        made.carried_out(tmp_path / "runs.jsonl", scheduler=cluster.scheduler_address)
        spent = time.process_time() - before
    print(f"\na run costs driver and scheduler of a Dask cluster {1e3 * spent / 500:.2f} ms, to reach 5 ms")
    assert spent / 500 <= 5e-3
