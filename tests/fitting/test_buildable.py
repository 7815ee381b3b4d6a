"""A match whose nearest design cannot be built."""

import numpy as np
import pytest

from bladewright.errors import DesignError
from bladewright.fitting.families import unified
from bladewright.fitting.free_parameters import free_parameters_of
from bladewright.fitting.matching.search import Task, searched
from bladewright.section.unified import UnifiedSection
from machines import example

VANE: UnifiedSection = example("turbine-section")  # type: ignore[assignment]
LEAST = VANE.tangent_in + 0.05


def test_the_nearest_design_that_cannot_be_built_gives_way_to_one_without_hooks_at_the_edges(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Refusing the true camber stands for thin edges beside a hook, which 50 parameters are needed to reach."""
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 120))) / 2.0
    points = np.concatenate([np.real(curve(u)) for curve in VANE.build().curves.values()])
    task = Task(
        points=points, weights=np.ones(len(points)), free=free_parameters_of(None, None, started=False), bounds={}
    )
    whole = UnifiedSection.build

    def refusing(design: UnifiedSection, **given: object) -> object:
        if design.tangent_in < LEAST:
            raise DesignError("the sides cross")
        return whole(design, **given)  # type: ignore[arg-type]

    monkeypatch.setattr(unified, "STRAIGHT_CAMBER", {"tangent_*": (LEAST, 1.0)})
    monkeypatch.setattr(UnifiedSection, "build", refusing)
    nearest = searched(task, VANE, rounds=1)
    found, built, reason = unified._buildable(task, nearest, fewer=True)
    assert found.design.tangent_in >= LEAST
    assert "cannot be built" in reason
    assert built is not None
