"""Periodic boundaries keep abreast of the blade's sides, so that cross-lines run across the flow."""

import numpy as np
import pytest

from bladewright.blade.exact.sectioned import exact_sectioned_blade
from bladewright.domain.camber_correspondence import CamberCorrespondence
from bladewright.domain.extents import end_camber_lines
from machines import example

NAMES = ("core-rotor", "backswept-impeller", "wedge-diffuser", "booster-stator", "vaned-diffuser")
T = np.linspace(0.0, 1.0, 201)


@pytest.fixture(params=NAMES, scope="module")
def ends(request):
    design = example(request.param)
    return end_camber_lines(exact_sectioned_blade(design))


def lag(ends, way):
    """Largest distance along the flow of the camber from amid both sides (), in lengths of the blade, of hub and
    shroud the mean."""
    sides = sum(ends.side(T, sign) for sign in (1, -1)) / 2.0
    ahead = (ends.in_plane(ends.stations.camber(way(T))) - sides)[..., 0]
    return np.max(np.abs(np.mean(ahead / np.ptp(sides[..., 0], axis=-1)[:, None], axis=0)))


def test_the_camber_is_kept_amid_the_sides(ends):
    way = ends.fitted_correspondence(0.35)
    # beside round edges the sides stand still, and the camber may not
    assert lag(ends, way) < min(0.1, 0.85 * lag(ends, CamberCorrespondence(slopes=way.slopes)))


def test_it_goes_on_all_the_way_and_leaves_the_edges_as_stated(ends):
    way = ends.fitted_correspondence(0.35)
    assert way(np.array([0.0, 1.0])) == pytest.approx([0.0, 1.0], abs=1e-14)
    assert np.min(np.diff(way(T))) > 0.0
    # round edges as slowly as asked, and others as the sides that meet there
    for slope, kind in zip(way.slopes, ends.stations.edge_kinds, strict=True):
        assert (slope == pytest.approx(0.35)) == (kind == "round")
