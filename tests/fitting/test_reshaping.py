"""The same shape with other numbers of control points, and the structures that ask for it."""

import numpy as np
import pytest

import bladewright as bw
from bladewright.fitting.model_selection.structure import reshaped, resizable_laws, structure_of
from bladewright.section.laws import law_basis
from machines import example

NAMES = ("turbine-section", "compressor-stator", "radial-turbine", "vki-ls89")
UNSEEN = ("pitch", "tip_clearance", "hub_clearance", "span", "fillet")


def design(name):
    found = example(name)
    if not isinstance(found, bw.UnifiedBlade | bw.UnifiedSection):
        pytest.fail(f"{name} is not of the unified family")
    return found


def wider(design):
    """The structure in which every law has as many more control points as its basis holds exactly."""
    more, structure = {1: 2, 2: 3, 3: 4, 4: 5, 5: 7}, structure_of(design)
    for law in resizable_laws(design):
        counts = zip(law.counts_of(design), law.most, strict=True)
        structure = structure.resized(law.name, tuple(min(more.get(count, count), most) for count, most in counts))
    return structure


@pytest.mark.parametrize("name", NAMES)
def test_with_its_own_structure_a_design_is_the_same(name):
    before, after = design(name), reshaped(design(name), structure_of(design(name)))
    assert structure_of(after) == structure_of(before)
    old, new = before.parameters(), after.parameters()
    for path, value in new.items():
        # a law that is one number is spread where another of its field is several
        known = old.get(path, old.get(path.rpartition("[")[0]))
        assert value == pytest.approx(known, rel=1e-12, abs=1e-15), path


@pytest.mark.parametrize("name", ["turbine-section", "compressor-stator"])
def test_more_control_points_whose_knots_hold_the_old_ones_leave_the_shape(name):
    before = design(name)
    # the channel of a blade keeps its degree where it has more control points than that
    after = reshaped(before, wider(before))
    assert len(after.parameters()) > len(before.parameters())
    old, new = before.build(), after.build()
    u, v = np.linspace(0.0, 1.0, 41), np.linspace(0.0, 1.0, 41)
    for side in ("upper", "lower"):
        if name == "turbine-section":
            places = [each.curves[side](u) for each in (old, new)]
        else:
            places = [each.surfaces[side](u, v) for each in (old, new)]
        # the native surfaces are within 1e-6 of the chord of the exact ones
        np.testing.assert_allclose(places[1], places[0], atol=2e-6 * old.chord)


def test_thicknesses_with_fewer_control_points_stay_positive():
    thin = design("turbine-section").changed(
        {f"thickness_upper[{i}]": value for i, value in enumerate((0.2, 1e-4, 1e-4, 1e-4, 0.3))}
    )
    found = reshaped(thin, structure_of(thin).resized("thickness_upper", (4, 1)).resized("thickness_lower", (3, 1)))
    assert (len(found.thickness_upper), len(found.thickness_lower)) == (4, 3)
    assert min(*found.thickness_upper, *found.thickness_lower) > 0.0
    # the free least squares would not
    rows = np.linspace(0.0, 1.0, 101)
    law = law_basis(5, rows) @ np.array(thin.thickness_upper)
    assert np.min(np.linalg.lstsq(law_basis(4, rows), law, rcond=None)[0]) < 0.0


def test_laws_with_fewer_control_points_are_the_nearest():
    blade = design("compressor-stator")
    flat = reshaped(blade, structure_of(blade).resized("stagger", (1, 1)))
    # the mean of a parabola over the span
    assert flat.stagger == pytest.approx(np.mean(blade.stagger), rel=1e-2)
    assert flat.metal_angle_in == blade.metal_angle_in
