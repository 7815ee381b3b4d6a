"""Fewer points of a cloud."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from bladewright.fitting.clouds.thinning import even_subset, isolated_points, random_subset
from machines import built, example


def uneven(seed, count=4000, dimension=3):
    """Points of which half lie in a hundredth of the extent."""
    points = np.random.default_rng(seed).random((count, dimension))
    points[::2] *= 0.01
    return points


@pytest.mark.parametrize("most", [1, 37, 500, 5000])
@pytest.mark.parametrize("dimension", [2, 3])
def test_points_are_fewer_and_in_order(most, dimension):
    points = uneven(0, dimension=dimension)
    for rows in (random_subset(len(points), most), even_subset(points, most)):
        assert 0 < len(rows) <= min(most, len(points))
        assert np.all(np.diff(rows) > 0)
    assert len(random_subset(len(points), most)) == min(most, len(points))


def test_all_points_are_kept_where_they_are_few_enough():
    points = uneven(0, count=100)
    assert np.array_equal(random_subset(100, 100), np.arange(100))
    assert np.array_equal(even_subset(points, 100), np.arange(100))


@pytest.mark.parametrize("seed", range(3))
def test_what_is_spread_is_as_dense_everywhere_and_as_near_to_all(seed):
    points = uneven(seed)
    rows = even_subset(points, 300)
    # half of those drawn lie in the dense corner, where one cell of the grid holds it
    assert np.mean(points[random_subset(len(points), 300)].max(axis=1) < 0.01) > 0.4
    assert np.mean(points[rows].max(axis=1) < 0.01) < 0.02
    # the diagonal of a cell, of which there are at most 300 in the cube
    assert cKDTree(points[rows]).query(points)[0].max() < np.sqrt(3.0) / 5.0


@pytest.mark.parametrize("seed", range(3))
def test_what_is_spread_does_not_depend_on_the_order_nor_the_place_of_the_points(seed):
    points = uneven(seed)
    order = np.random.default_rng(seed).permutation(len(points))
    plain, mixed = points[even_subset(points, 200)], points[order][even_subset(points[order], 200)]
    assert {tuple(each) for each in plain} == {tuple(each) for each in mixed}
    # of an exact power of two: no rounding
    assert np.array_equal(even_subset(points, 200), even_subset(4.0 * points, 200))


def test_points_in_one_place_are_one():
    assert len(even_subset(np.ones((50, 2)), 10)) == 1


@pytest.mark.parametrize("name", ["aachen-stator", "compressor-stator"])
def test_points_strewn_about_rows_are_told_in_the_most_and_no_other_is(name):
    random, sides = np.random.default_rng(0), built(example(name)).sides
    u, v = (
        each.ravel() for each in np.meshgrid(0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 80)), np.linspace(0, 1, 21))
    )
    points = np.concatenate([side(u, v) for side in sides]) + 1e-5 * random.normal(size=(2 * len(u), 3))
    off = random.random(len(points)) < 0.03
    points += off[:, None] * random.uniform(-0.05, 0.05, points.shape) * np.ptp(points)
    told = isolated_points(points)
    assert np.mean(told[off]) > 0.5
    assert not np.any(told[~off])


def test_hardly_a_point_of_a_cloud_that_becomes_ten_times_as_dense_stands_alone():
    random, sides = np.random.default_rng(1), built(example("compressor-stator")).sides
    points = np.concatenate([side(random.random(4000) ** 2, random.random(4000)) for side in sides])
    points = points[(points[:, 1] > np.median(points[:, 1])) | (random.random(len(points)) < 0.1)]
    assert np.mean(isolated_points(points)) < 2e-3
