"""The clustering of a blade's samples along the chord, sought where another one is predicted to leave less misfit."""

from dataclasses import replace

import numpy as np
import pytest

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.fitting.assessment.acceptance import NEAR_EVERYWHERE
from bladewright.fitting.free_parameters import FreeParameters
from bladewright.fitting.matching.search import ROUGH_REDUCTION, Match, Task, searched
from bladewright.fitting.model_selection import selection
from bladewright.fitting.model_selection.selection import CLUSTERING_TOLERANCE, nearest_by_clustering
from machines import COARSE, built, example

STATOR = example("compressor-stator").changed({"tolerance": COARSE})


def _task(design: UnifiedBlade, count: int = 400) -> Task:
    sides, draw = built(design).surfaces, np.random.default_rng(3)
    points = np.concatenate([sides[name](draw.random(count), draw.random(count)) for name in ("upper", "lower")])
    return Task(points=points, weights=np.ones(2 * count), free=FreeParameters(), bounds={}, preliminary=True)


def _first(task: Task, start: UnifiedBlade) -> Match:
    return searched(task, start, noise=1e-3, rounds=3, min_reduction=ROUGH_REDUCTION)


@pytest.mark.parametrize("true", [0.4, pytest.param(0.7, marks=pytest.mark.slow)])
def test_the_clustering_of_a_cloud_is_found(true: float) -> None:
    task = _task(STATOR.changed({"clustering": true}))
    first = _first(task, STATOR)
    found = nearest_by_clustering(task, first)
    assert isinstance(found.design, UnifiedBlade)
    assert found.design.clustering == pytest.approx(true, abs=2.0 * CLUSTERING_TOLERANCE)
    assert found.misfit < 0.2 * first.misfit


def test_a_match_that_is_near_or_whose_misfit_is_of_another_kind_is_not_searched_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    task = _task(STATOR)
    near = _first(task, STATOR)
    turned = replace(task, free=FreeParameters(free=("tangent_in",)))
    staggers = {path: 1.02 * value for path, value in STATOR.parameters().items() if path.startswith("stagger")}
    far = _first(turned, STATOR.changed(staggers))
    assert far.maximum > NEAR_EVERYWHERE * far.model.chord

    def refused(*_: object, **__: object) -> Match:
        raise AssertionError("searched again")

    monkeypatch.setattr(selection, "searched", refused)
    assert nearest_by_clustering(task, near) is near
    assert nearest_by_clustering(turned, far) is far
