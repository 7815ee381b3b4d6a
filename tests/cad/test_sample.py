"""Points of CAD files."""

import numpy as np
import pytest
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
from OCP.BRepTools import BRepTools
from OCP.gp import gp_Ax2, gp_Dir, gp_Elips, gp_Pnt, gp_Vec
from scipy.special import ellipe, ellipeinc

from bladewright import cad
from bladewright.cad.deviation import native_face
from bladewright.errors import CadError

COUNT = 800
ON_FACES = COUNT * 9 // 10


@pytest.mark.parametrize(
    ("ending", "near"), [("step", 1e-8), ("igs", 1e-6), ("brep", 1e-8), ("stl", 0.2), ("3mf", 0.2)]
)
def test_points_lie_on_the_body_evenly_and_in_metres(rotor, filed, ending, near):
    points = cad.sample(filed("annular", ending)[0], COUNT)
    assert points.shape == (COUNT, 3)
    away = {name: native_face(face).projection.closest(points * 1e3, 1.0)[1] for name, face in rotor.surfaces.items()}
    # ends lie off the wall by 4e-7 mm, and so may points next to them
    assert np.max(np.min(list(away.values()), axis=0)) <= max(near, 1e-6)
    owner = np.argmin(list(away.values()), axis=0)[:ON_FACES]
    for k in range(len(rotor.surfaces)):
        share = rotor.properties.areas[k] / rotor.properties.area
        # four standard deviations of a binomial draw
        assert np.mean(owner == k) == pytest.approx(share, abs=4.0 * np.sqrt(share * (1.0 - share) / ON_FACES))


def test_points_spread_by_area_and_not_by_parameter(rotor, step):
    points = cad.sample(step[0], 20_000)[:18_000]
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


def test_the_last_tenth_lies_on_edges_by_length(tmp_path):
    wide, narrow, height = 3.0, 1.0, 2.0
    ellipse = gp_Elips(gp_Ax2(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0)), wide, narrow)
    wire = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(ellipse).Edge()).Wire()
    prism = BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(wire).Face(), gp_Vec(0.0, 0.0, height)).Shape()
    BRepTools.Write_s(prism, str(tmp_path / "prism.brep"))
    points = cad.sample(tmp_path / "prism.brep", 20_000) * 1e3
    on_side = np.abs((points[:, 0] / wide) ** 2 + (points[:, 1] / narrow) ** 2 - 1.0) < 1e-9
    on_ends = np.min(np.abs(points[:, 2:] - [0.0, height]), axis=1) < 1e-9
    on_rims, on_seam = on_side & on_ends, on_side & (np.abs(points[:, 1]) < 1e-9)
    assert np.all((on_rims | on_seam)[18_000:])
    assert not np.any((on_rims | on_seam)[:18_000])
    around = 4.0 * wide * ellipe(1.0 - (narrow / wide) ** 2)
    assert np.count_nonzero(on_rims) == pytest.approx(2_000 * 2.0 * around / (2.0 * around + height), abs=1.5)
    # the part of the rims beyond half of the major axis, by its own integral
    share = 1.0 - ellipeinc(np.pi / 6.0, 1.0 - (narrow / wide) ** 2) / ellipe(1.0 - (narrow / wide) ** 2)
    error = np.sqrt(share * (1.0 - share) / np.count_nonzero(on_rims))
    assert np.mean(np.abs(points[on_rims, 0]) > 0.5 * wide) == pytest.approx(share, abs=4.0 * error)


def test_the_same_seed_gives_the_same_points(step):
    np.testing.assert_array_equal(cad.sample(step[0], 500), cad.sample(step[0], 500))
    assert not np.array_equal(cad.sample(step[0], 500), cad.sample(step[0], 500, seed=1))


@pytest.mark.parametrize("count", [1, 7])
def test_any_number_of_points_can_be_had(step, count):
    assert cad.sample(step[0], count).shape == (count, 3)


def test_no_points_are_refused(step):
    with pytest.raises(CadError, match="at least 1"):
        cad.sample(step[0], 0)
