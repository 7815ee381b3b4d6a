"""A match whose nearest design cannot be built."""

import numpy as np
import pytest

from bladewright.errors import DesignError
from bladewright.fitting.families import unified
from bladewright.fitting.fit import fit
from bladewright.section.unified import UnifiedSection
from machines import built, example

VANE = example("turbine-section")
LEAST = VANE.tangent_in + 0.12


def test_the_nearest_design_that_cannot_be_built_gives_way_to_one_without_hooks_at_the_edges(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Refusing the true camber stands for thin edges beside a hook, which 50 parameters are needed to reach."""
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 60))) / 2.0
    points = np.concatenate([np.real(curve(u)) for curve in built(VANE).curves.values()])
    whole = UnifiedSection.build

    def refusing(design: UnifiedSection, **given: object) -> object:
        if design.tangent_in < LEAST:
            raise DesignError("the sides cross")
        return whole(design, **given)  # type: ignore[arg-type]

    monkeypatch.setattr(unified, "STRAIGHT_CAMBER", {"tangent_*": (LEAST, 1.0)})
    monkeypatch.setattr(UnifiedSection, "build", refusing)
    found = fit(points)
    assert found.design.tangent_in >= LEAST
    assert any("cannot be built" in note for note in found.notes)
