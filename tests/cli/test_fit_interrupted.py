"""Ctrl-C during `bladewright fit` of a blade: the best design so far with its report, or nothing."""

import json
import subprocess
import sys

import numpy as np
import pytest

import bladewright as bw
from machines import COARSE, built, example

MOMENTS = 0.02, 0.3, 0.8
"""seconds of the processor after the call at which the interrupts come: before there is a design, and in the search"""
INTERRUPTED = """
import signal, sys
from bladewright.cli import main
import bladewright.fitting.fit  # the moments count from the call
signal.signal(signal.SIGINT, signal.default_int_handler)  # which a background job of a shell ignores
signal.signal(signal.SIGPROF, lambda *_: signal.raise_signal(signal.SIGINT))
for moment in sys.argv[1:]:
    signal.setitimer(signal.ITIMER_PROF, float(moment))
    words = ["cloud.txt", "--start", "start.toml", "--tolerance", "1um", "-o", f"at-{moment}.toml"]
    print(main(["fit", *words, "--no-picture", "--quiet"]))
"""


@pytest.fixture(scope="module")
def interrupted(tmp_path_factory):
    """The directory in which fits were interrupted, their exit statuses, and what was printed."""
    folder, random = tmp_path_factory.mktemp("interrupted"), np.random.default_rng(0)
    stator = example("compressor-stator").changed("tolerance", COARSE)
    points = np.concatenate([side(*random.random((2, 200))) for side in built(stator).sides])
    np.savetxt(folder / "cloud.txt", points + 2e-5 * random.normal(size=points.shape))
    bw.write_design(stator.changed("stagger[0]", stator.stagger[0] + 3.0), folder / "start.toml")
    words = [sys.executable, "-c", INTERRUPTED, *map(str, MOMENTS)]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=True, timeout=300)
    return folder, dict(zip(MOMENTS, map(int, done.stdout.split()), strict=True)), done.stderr


@pytest.mark.parametrize("moment", MOMENTS)
def test_the_best_design_so_far_is_written_with_its_report_or_nothing_is(moment, interrupted):
    folder, statuses, printed = interrupted
    assert statuses[moment] == 130, printed
    found = sorted(path.name for path in folder.glob(f"at-{moment}*"))
    assert found in ([], [f"at-{moment}.fit.json", f"at-{moment}.toml"])
    if found:
        report = json.loads((folder / found[0]).read_text())
        assert report["interrupted"]
        assert not report["passed"]
        assert report["deviation"]["all"]["count"] > 0
        assert bw.read_design(folder / found[1]).build().chord > 0.0


def test_the_design_is_kept_where_there_is_one(interrupted):
    assert list(interrupted[0].glob("*.toml"))
