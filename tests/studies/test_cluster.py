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


def test_a_scheduler_that_is_not_there_is_named(study_file):
    plan = planned(read_study(study_file))
    with pytest.raises(StudyError, match="no Dask scheduler at 'nonsense'"):
        Cluster(plan.experiment, "nonsense")
