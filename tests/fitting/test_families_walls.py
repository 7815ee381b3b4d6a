"""Hub and shroud of blades from sections, found with the rest of them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.designs import Point
from bladewright.fitting.families.closed_blade import (
    CONTINUATIONS,
    WALL_COUNTS,
    WALL_DISTANCE,
    WALL_MARGIN,
    _outward,
    _wall,
)
from bladewright.fitting.families.first_blades import part_of_laws
from bladewright.fitting.free_parameters import FreeParameters, gauge_parameters
from bladewright.fitting.matching.blade_ends import WallPoints
from bladewright.fitting.matching.footpoints import nearest_footpoints
from bladewright.fitting.matching.noise import noise_of
from bladewright.fitting.models.model import model_of
from bladewright.nurbs.surface import Surface
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.thickness.wennerstrom import Wennerstrom
from machines.sectioned import COMPRESSOR, DIFFUSER

VANE = replace(DIFFUSER, tolerance=1e-3)


def test_walls_that_are_free_slide_along_themselves_only():
    free = set(FreeParameters(walls=True)(VANE))
    walls = {path for path in free if path.startswith("flow_path.")}
    # its walls stand radially, at one x each; the shroud's ends say which points of both walls are joined
    across = {f"flow_path.{wall}.points[{i}].x" for wall in ("hub", "shroud") for i in (0, 1)}
    assert walls == across | {f"flow_path.shroud.points[{i}].r" for i in (0, 1)}
    edges = replace(VANE, flow_path=replace(VANE.flow_path, matched="edges"))
    assert {path for path in FreeParameters(walls=True)(edges) if path.startswith("flow_path.")} == across
    assert free - walls == set(FreeParameters()(VANE))
    assert "flow_path.hub.points[0].r" in gauge_parameters(COMPRESSOR) - gauge_parameters(COMPRESSOR, walls=True)


def test_a_walls_places_move_with_its_points_as_a_difference_says():
    model = model_of(VANE)
    paths = tuple(path for path in FreeParameters(walls=True)(VANE) if path.startswith("flow_path.hub"))
    shape, t = model.shape(VANE), np.linspace(0.1, 0.9, 5)
    rates = WallPoints(name="hub", places=np.zeros((5, 2)), spread=0.0).rates(shape, t, paths)
    values, step = VANE.parameters(), 1e-3
    for i, path in enumerate(paths):
        lines = [
            model.shape(VANE.changed({path: values[path] + way * step})).exact.wall("hub").values(t)
            for way in (1.0, -1.0)
        ]
        # a point that moves across a straight wall moves its places by parts of itself: to second order in the step
        assert rates[:, i] == pytest.approx((lines[0] - lines[1]) / (2.0 * step), abs=1e-9)


@pytest.mark.parametrize("turn", [0.0, 0.3, 1.5])
def test_a_wall_has_as_few_points_as_follow_it(turn):
    t = np.linspace(0.0, 1.0, 201)
    heading = turn * t
    line = np.cumsum(np.stack([np.cos(heading), np.sin(heading)], axis=-1), axis=0) / 201 + [0.0, 0.5]
    rows = _wall(line, np.array([CONTINUATIONS[0], CONTINUATIONS[1]]))
    assert len(rows) - 2 in WALL_COUNTS
    curve = ThroughPoints(points=tuple(Point(*row) for row in rows)).line(1.0).values(np.linspace(0.0, 1.0, 801))
    assert np.max(cKDTree(curve).query(line)[0]) < WALL_DISTANCE
    ahead, along = rows[0] - line[0], line[0] - line[1]
    assert np.sqrt(np.sum(ahead**2)) == pytest.approx(CONTINUATIONS[0], rel=0.02)
    assert np.sqrt(np.sum((rows[-1] - line[-1]) ** 2)) == pytest.approx(CONTINUATIONS[1], rel=0.02)
    # the direction of a parabola beside the end, of third order in its share of the turn
    assert abs(np.arctan2(*ahead) - np.arctan2(*along)) < 3e-3
    assert np.sqrt(np.sum((rows[1] - line[0]) ** 2)) == pytest.approx(WALL_MARGIN, rel=0.02)


def test_a_wall_whose_corner_is_a_hook_goes_on_as_it_does_before():
    t = np.linspace(0.0, 1.0, 201)
    line = np.stack([t, 0.5 + 0.1 * t**2], axis=-1)
    hooked = line.copy()
    hooked[-4:] += np.outer(np.arange(1.0, 5.0), [-4e-3, 4e-3])
    (_, plain), (_, found) = _outward(line), _outward(hooked)
    turned = np.arctan2(plain[1], plain[0]) - np.arctan2(found[1], found[0])
    assert abs(turned) < np.radians(25.0)
    last = hooked[-1] - hooked[-2]
    assert abs(np.arctan2(last[1], last[0])) > np.radians(70.0)


def test_feet_go_over_as_many_thin_patches_as_lie_on_their_way():
    # strips a hundredth wide and three long, skewed: the nearest sample may be many strips away
    count = 120
    u = np.linspace(0.0, 1.0, count)
    v = np.array([0.0, 1.0])
    net = np.stack(np.broadcast_arrays(u[:, None] + 0.5 * v, 3.0 * v, 0.0 * u[:, None]), axis=-1)
    knots = np.concatenate([[0.0], u, [1.0]])
    flat = Surface(control_points=net, knots_u=knots, knots_v=np.array([0.0, 0.0, 1.0, 1.0]), degree_u=1, degree_v=1)
    other = replace(flat, control_points=net - np.array([0.0, 0.0, 0.5]))
    random = np.random.default_rng(6)
    points = flat(*random.uniform(0.05, 0.95, (2, 300)))
    assert np.max(nearest_footpoints(points, (flat, other)).distances) < 1e-9


def test_points_past_an_end_and_level_with_the_sides_are_no_outliers():
    random = np.random.default_rng(2)
    t, z = random.random(600), random.uniform(-0.02, 1.0, 600)
    side = random.random(600) < 0.5
    bulge = 0.1 * np.sin(np.pi * t)
    points = np.stack([t, np.where(side, bulge, -bulge), z], axis=-1)
    points[:3, 1] += 0.05
    upper = [[[0.0, 0.0, v], [0.5, 0.2, v], [1.0, 0.0, v]] for v in (0.0, 1.0)]
    net = np.swapaxes(np.array(upper), 0, 1)
    knots = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0])
    ends = np.array([0.0, 0.0, 1.0, 1.0])
    sides = [
        Surface(control_points=net * [1.0, sign, 1.0], knots_u=knots, knots_v=ends, degree_u=2, degree_v=1)
        for sign in (1.0, -1.0)
    ]
    points[:, 1] *= 2.0 * t * (1.0 - t) * 0.2 / np.where(bulge > 1e-9, bulge, 1.0)
    points[:3, 1] += 0.05
    found = noise_of(points, nearest_footpoints(points, sides))
    assert np.count_nonzero(z < 0.0) > 3
    assert set(np.flatnonzero(~found.inliers)) == {0, 1, 2}


def test_a_law_that_leaves_sections_no_shape_is_a_constant_and_the_others_stay_laws():
    thickness = Wennerstrom(
        maximum_thickness=0.1,
        maximum_thickness_at=0.5,
        leading_edge_thickness=0.02,
        trailing_edge_thickness=0.03,
        trailing_edge="elliptic",
    )
    part = CurvatureMeanline(metal_angle_in=30.0, metal_angle_out=0.0, curvature=(1.0, 1.0), thickness=thickness)
    # on both sides of the middle the shape would jump
    places = 0.5 + 1e-3 * np.array([-2.0, 1.0, -1.0, 0.0, 1.0, -1.0, 2.0])
    parts = [part.changed({"thickness.maximum_thickness_at": float(each)}) for each in places]
    found = part_of_laws(parts)
    assert np.ndim(found.thickness.maximum_thickness_at) == 0
    assert len(found.metal_angle_in) == len(found.thickness.maximum_thickness) == 3
