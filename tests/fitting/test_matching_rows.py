"""The rows of design/matching.py: their shapes are closed, and their distances are true."""

import foreign_blades
import matching_measures
import numpy as np
import pytest
from matching_clouds import example, points_of, sides_of

from machines import built


@pytest.mark.parametrize("name", foreign_blades.SHAPES)
def test_the_pieces_of_a_shape_make_a_closed_contour(name):
    shape = foreign_blades.SHAPES[name]()
    ends = np.concatenate([piece(np.array([0.0, 1.0])) for piece in shape.pieces(0.5)])
    apart = np.sqrt(np.sum((ends[:, None] - ends) ** 2, axis=-1)) + np.eye(len(ends))
    assert np.max(np.min(apart, axis=1)) < 1e-12
    assert np.count_nonzero(apart < 1e-12) == len(ends)


@pytest.mark.parametrize("name", ["turbine-section", "compressor-stator"])
def test_distances_are_those_by_which_points_were_moved_along_normals(name):
    shape = built(example(name))
    points = points_of(shape, 100, np.random.default_rng(1))
    away = 1e-4 * shape.chord
    side = sides_of(shape)[0]
    if points.shape[1] == 2:
        slope = side.derivative(np.array([0.4]))[0]
        moved = side(np.array([0.4]))[0] + away * np.array([-slope[1], slope[0]]) / np.sqrt(np.sum(slope**2))
    else:
        normal = np.cross(*(side.derivative(0.4, 0.6, *order) for order in ((1, 0), (0, 1))))
        moved = side(0.4, 0.6) + away * normal / np.sqrt(np.sum(normal**2))
    found = matching_measures.distances(np.vstack([points, moved]), sides_of(shape))
    assert np.max(found[:-1]) < 1e-9 * shape.chord
    assert found[-1] == pytest.approx(away, rel=1e-9)
