"""Blades with cuts and fillets as starts: the blade before them is matched, and what is found has them again."""

from functools import cache

import numpy as np
import pytest

from bladewright.blade.design.cut import AtRadius, AtX, Cut
from bladewright.blade.design.fillet import Fillet
from bladewright.fitting.fit import fit
from bladewright.fitting.placing import finished
from machines import COARSE, built, example

PLAIN = example("compressor-stator").changed({"tolerance": COARSE, "hub_clearance": None})
FINISHED = PLAIN.changed(
    {"hub_fillet": Fillet(radius=1.0), "cut": Cut(tip=AtRadius(radius=225.0), trailing_edge=AtX(x=38.0))}
)


@cache
def cloud(count=150):
    """Points of the sides, the fillet and the face of the cut edge."""
    random, blade = np.random.default_rng(3), built(FINISHED)
    upper, lower = blade.sides
    sides = [side(*random.random((2, count))) for side in (upper, lower)]
    fillet = [
        face(*random.random((2, 40)))
        for name, face in blade.surfaces.items()
        if name in {"hub_fillet_upper", "hub_fillet_lower"}
    ]
    v = random.random(40)
    first, last = (side(np.ones(40), v) for side in (upper, lower))
    return np.concatenate([*sides, *fillet, first + random.random((40, 1)) * (last - first)])


@pytest.mark.parametrize("given", ["start", pytest.param("like", marks=pytest.mark.slow)])
def test_a_start_keeps_its_fillets_and_cuts_and_points_on_them_are_set_aside(given):
    near = FINISHED.changed(
        {"stagger[1]": FINISHED.stagger[1] + 0.5, "metal_angle_in[1]": FINISHED.metal_angle_in[1] - 1}
    )
    found = fit(cloud(), **{given: near}, free=["stagger*", "metal_angle_*"])
    assert found.passed
    assert (found.design.hub_fillet, found.design.cut) == (FINISHED.hub_fillet, FINISHED.cut)
    assert found.maximum < 1e-6 * found.chord
    assert found.design.stagger == pytest.approx(FINISHED.stagger, abs=1e-3)
    kinds = {kind: each.count for kind, each in found.by_kind_set_aside.items()}
    assert kinds["hub fillet"] == pytest.approx(80, abs=3)
    assert kinds["cut trailing edge"] == pytest.approx(40, abs=3)
    # on the faces of what was found, not on those of the start
    assert np.max(found.distances) < 1e-5 * found.chord
    assert not found.outliers.size


def test_lengths_of_cuts_and_fillets_are_in_the_unit_of_the_design_that_gets_them():
    inches = finished(example("vaned-diffuser").plain.changed("length_unit", "in"), FINISHED)
    assert inches.hub_fillet.radius == pytest.approx(1.0 / 25.4)
    assert inches.cut.tip.radius == pytest.approx(225.0 / 25.4)
