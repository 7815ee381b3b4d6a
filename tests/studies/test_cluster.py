"""A Dask cluster carries out the runs of a study as this machine does."""

from dataclasses import replace

import pytest

from bladewright.errors import StudyError
from bladewright.studies.manifest import read_manifest
from bladewright.studies.study import read_study
from bladewright.studies.sweep import planned
from bladewright.studies.workers import Cluster

distributed = pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")


@pytest.fixture(params=[False, pytest.param(True, marks=pytest.mark.slow)], ids=["threads", "processes"])
def cluster(request):
    """Two workers of this machine."""
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=request.param, dashboard_address=None, silence_logs=50
    ) as found:
        yield found


def test_two_workers_give_the_same_records(cluster, study_file, tmp_path):
    plan = planned(read_study(study_file))
    here, there = tmp_path / "here.jsonl", tmp_path / "there.jsonl"
    plan.carried_out(here, jobs=1)
    plan.carried_out(there, scheduler=cluster.scheduler_address)

    def kept(path):
        return sorted((replace(each, seconds=0.0) for each in read_manifest(path)[1]), key=lambda each: each.run)

    assert kept(there) == kept(here)
    assert len(kept(there)) == 8


LONG = """
import time
def long(section):
    while section.stagger < -0.57: pass
    return 1.0
def stubborn(section):
    while section.stagger < -0.57:
        try:
            while True: time.sleep(0.1)
        except BaseException: pass
    return 1.0
"""


def limited(study_file, function, cluster):
    (study_file.parent / "figures.py").write_text(LONG)
    study = read_study(study_file)
    limited = replace(study, sweep=replace(study.sweep, time_limit=1.0))
    return planned(limited, quantities=[f"figures:{function}"]).carried_out(None, scheduler=cluster.scheduler_address)


def test_a_run_ends_at_its_limit_on_a_cluster_as_well(cluster, study_file):
    runs = limited(study_file, "long", cluster)
    late = [run for run, reason in runs.reasons.items() if reason == "it took longer than the limit of 1 s"]
    assert len(late) == runs.verdicts.count("failed") > 0
    assert runs.verdicts.count("built") == 8 - len(late)


@pytest.mark.slow
def test_a_run_that_ignores_its_limit_is_stopped_with_its_worker(study_file):
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50
    ) as cluster:
        runs = limited(study_file, "stubborn", cluster)
    stopped = [run for run, reason in runs.reasons.items() if "ignored its limit of 1 s" in reason]
    assert len(stopped) == runs.verdicts.count("failed") > 0


def test_a_scheduler_that_is_not_there_is_named(study_file):
    plan = planned(read_study(study_file))
    with pytest.raises(StudyError, match="no Dask scheduler at 'nonsense'"):
        Cluster(plan.experiment, "nonsense")
