"""The nearest designs that searches have reached, where the very nearest cannot be built."""

import gc
import weakref
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bladewright.errors import DesignError, FitError
from bladewright.fitting.free_parameters import FreeParameters
from bladewright.fitting.matching.search import BestSoFar, Task, searched
from machines import example

SECTION = example("turbine-section")
REFUSED = SECTION.changed({"thickness_upper[0]": 0.001})
"""whose edge needs more thickness than there is"""


@dataclass(frozen=True)
class Found:
    """The end of a round, as far as it is noted."""

    mean_distance: float
    design: Any
    count: int
    problem: Any = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "problem", SimpleNamespace(paths=("path",) * self.count))


@pytest.fixture
def noted():
    def noted(*found: Found) -> BestSoFar:
        best = BestSoFar()
        for each in found:
            best.note(each)
        return best

    return noted


def test_the_refused_section_is_refused() -> None:
    with pytest.raises(DesignError):
        REFUSED.build()


def test_the_nearest_that_can_be_built_is_given_with_a_note(noted) -> None:
    refused = Found(1e-6, REFUSED, 22)
    nearer = Found(2e-6, SECTION.changed({"stagger": -41.0}), 20)
    best = noted(Found(3e-6, SECTION, 18), nearer, refused, Found(1e-7, SECTION, 30))
    match, built, note = best.instead_of(refused, DesignError("its edge has no room"), structured=False)
    assert match.design.stagger == -41.0
    assert built.chord == pytest.approx(nearer.design.build().chord, rel=1e-12)
    assert "cannot be built (its edge has no room)" in note


def test_a_given_structure_is_kept(noted) -> None:
    refused = Found(1e-6, REFUSED, 22)
    best = noted(refused, Found(2e-6, SECTION, 20), Found(3e-6, SECTION.changed({"stagger": -41.0}), 22))
    assert best.instead_of(refused, DesignError("too thick"), structured=True)[0].design.stagger == -41.0


def test_the_nearest_of_as_many_parameters_are_kept(noted) -> None:
    refused = [Found(distance, REFUSED, 20) for distance in (2e-6, 1e-6)]
    assert noted(*refused).built() is None
    assert noted(*refused, Found(np.nan, SECTION, 9)).built() is None
    assert noted(*refused, Found(3e-6, SECTION, 20)).built() is not None
    assert noted(*refused, Found(3e-6, SECTION, 20), Found(2.5e-6, REFUSED, 20)).built() is None


@pytest.mark.parametrize(
    ("design", "cure"),
    [
        (REFUSED, "give a start design, or bounds that keep off it"),
        (
            example("compressor-stator").changed({"thickness_upper[0]": 0.001}),
            r"bounds that keep off it, or name the machine axis where it is not x \(--axis\)",
        ),
    ],
)
def test_where_none_can_be_built_the_cure_is_said(noted, design, cure) -> None:
    refused = Found(1e-6, design, 22)
    with pytest.raises(FitError, match=rf"cannot be built \(too thick\).*{cure}$"):
        noted(refused).instead_of(refused, DesignError("too thick"), structured=False)


def test_a_match_is_freed_as_soon_as_it_is_let_go() -> None:
    # a match that leads back to itself would keep its cloud until the cyclic collector runs
    curves, places = SECTION.build().curves, np.linspace(0.0, 1.0, 20)
    points = np.concatenate([curves[side](places) for side in ("upper", "lower")])
    task = Task(points=points, weights=np.ones(len(points)), free=FreeParameters(), bounds={})
    gc.disable()
    try:
        found = weakref.ref(searched(task, SECTION, rounds=1))
        assert found() is not None
        del task
        assert found() is None
    finally:
        gc.enable()
