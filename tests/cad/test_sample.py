"""Points of CAD files."""

import numpy as np
import pytest

from bladewright import cad
from bladewright.cad.deviation import native_face
from bladewright.errors import CadError

COUNT = 800


@pytest.mark.parametrize(
    ("ending", "near"), [("step", 1e-8), ("igs", 1e-6), ("brep", 1e-8), ("stl", 0.2), ("3mf", 0.2)]
)
def test_points_lie_on_the_body_evenly_and_in_metres(rotor, filed, ending, near):
    points = cad.sample(filed("annular", ending)[0], COUNT)
    assert points.shape == (COUNT, 3)
    away = {name: native_face(face).projection.closest(points * 1e3, 1.0)[1] for name, face in rotor.surfaces.items()}
    # ends lie off the wall by 4e-7 mm, and so may points next to them
    assert np.max(np.min(list(away.values()), axis=0)) <= max(near, 1e-6)
    owner = np.argmin(list(away.values()), axis=0)
    for k in range(len(rotor.surfaces)):
        share = rotor.properties.areas[k] / rotor.properties.area
        # four standard deviations of a binomial draw
        assert np.mean(owner == k) == pytest.approx(share, abs=4.0 * np.sqrt(share * (1.0 - share) / COUNT))


def test_points_spread_by_area_and_not_by_parameter(rotor, step):
    points = cad.sample(step[0], 20_000)
    # between the walls there are the sides only; their share downstream of x, by quadrature of the area
    x = 0.03
    u = v = (np.arange(400) + 0.5) / 400
    whole = downstream = 0.0
    for name in ("upper", "lower"):
        side = rotor.surfaces[name]
        element = np.linalg.norm(np.cross(side.grid(u, v, 1, 0), side.grid(u, v, 0, 1)), axis=-1)
        place = side.grid(u, v)
        between = np.abs(np.linalg.norm(place[..., 1:], axis=-1) - 0.256) < 0.034
        whole += element[between].sum()
        downstream += element[between & (place[..., 0] > x)].sum()
    between = np.abs(np.linalg.norm(points[:, 1:], axis=-1) - 0.256) < 0.034
    share = downstream / whole
    error = np.sqrt(share * (1.0 - share) / between.sum())
    assert np.mean(points[between, 0] > x) == pytest.approx(share, abs=4.0 * error)


def test_the_same_seed_gives_the_same_points(step):
    np.testing.assert_array_equal(cad.sample(step[0], 500), cad.sample(step[0], 500))
    assert not np.array_equal(cad.sample(step[0], 500), cad.sample(step[0], 500, seed=1))


@pytest.mark.parametrize("count", [1, 7])
def test_any_number_of_points_can_be_had(step, count):
    assert cad.sample(step[0], count).shape == (count, 3)


def test_no_points_are_refused(step):
    with pytest.raises(CadError, match="at least 1"):
        cad.sample(step[0], 0)
