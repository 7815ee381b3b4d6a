"""Outliers in the clouds of sections and of a blade whose designs are known, and none where a design misses."""

from functools import cache

import numpy as np
import pytest

from bladewright.fitting.matching.footpoints import nearest_footpoints
from bladewright.fitting.matching.noise import noise_of
from machines import example

NOISE = 2e-5
"""[m]"""
CLEAR = 10.0 * NOISE
"""an outlier nearer than this may be one of the noise: eight deviations of what neighbours do not share are allowed"""


@cache
def sides(*, blade=False, stagger=0.0, radius=1.0):
    """Both sides of a vane as curves, or of a stator as surfaces; the vane's turned, its nose blunter."""
    if blade:
        return tuple(example("compressor-stator").build().sides)
    vane = example("turbine-section")
    changed = vane.changed(
        {"stagger": vane.stagger + stagger, "leading_edge_radius": vane.leading_edge_radius * radius}
    )
    curves = changed.build().curves
    return curves["upper"], curves["lower"]


def cloud(seed, count, noise=NOISE, *, blade=False):
    random = np.random.default_rng(seed)
    points = np.concatenate([side(*random.random((2 if blade else 1, count // 2))) for side in sides(blade=blade)])
    return points + noise * random.normal(size=points.shape)


def strewn(points, on, random):
    """One point in twenty up to 2 mm off, to either side."""
    rows = random.choice(len(points), len(points) // 20, replace=False)
    off = random.choice([-1.0, 1.0], len(rows)) * random.uniform(4e-4, 2e-3, len(rows))
    points[rows] += off[:, None] * on.normals[rows]
    return points, rows


def patch(u):
    """The 15 points nearest to a place, all a millimetre off."""

    def planted(points, on, _):
        at = on.points[np.argmin(np.abs(on.u - u) + on.side)]
        rows = np.argsort(np.sum((on.points - at) ** 2, axis=1) + np.where(on.side == 0, 0.0, 1e-4))[:15]
        points[rows] += 1e-3 * on.normals[rows]
        return points, rows

    return planted


def pairs(points, on, random):
    """Neighbours that are half a millimetre off together."""
    order = np.lexsort((on.u, on.side))
    first = random.choice(len(points) - 1, len(points) // 50, replace=False)
    rows = np.unique(order[np.concatenate([first, first + 1])])
    points[rows] += 5e-4 * on.normals[rows]
    return points, rows


def added(points, on, random):
    """A ball of further points above the surface, as a probe leaves them."""
    at = int(np.argmin(np.abs(on.u - 0.3) + on.side))
    ball = points[at] + 1.4e-3 * on.normals[at] + 2e-4 * random.normal(size=(20, points.shape[1]))
    return np.concatenate([points, ball]), np.arange(len(points), len(points) + 20)


def bump(points, on, _):
    """A smooth hill a millimetre high, and the points on its upper part."""
    at = np.argmin(np.abs(on.u - 0.6) + on.side)
    away = np.sum((on.points - on.points[at]) ** 2, axis=1) + np.where(on.side == on.side[at], 0.0, 1.0)
    height = 1e-3 * np.exp(-away / 1.5e-3**2)
    return points + height[:, None] * on.normals, np.flatnonzero(height > 3e-4)


PLANTED = {
    "strewn": strewn,
    "patch between": patch(0.5),
    "patch beside an edge": patch(0.05),
    "patch at the leading edge": patch(0.0),
    "patch at the trailing edge": patch(1.0),
    "pairs": pairs,
    "added": added,
    "bump": bump,
}


def told(points, shapes, weights=None):
    on = nearest_footpoints(points, shapes)
    return noise_of(points, on, weights), on


@pytest.mark.parametrize(
    ("name", "count", "noise"),
    [(name, count, NOISE) for name in PLANTED for count in (400, 2000)]
    # where nothing is noise a bump has no end
    + [(name, 1000, 0.0) for name in PLANTED if name != "bump"],
)
def test_planted_outliers_of_a_section_are_found_and_nothing_else(name, count, noise):
    points = cloud(3, count, noise)
    points, wrong = PLANTED[name](points, nearest_footpoints(points, sides()), np.random.default_rng(1))
    found, on = told(points, sides())
    clear = wrong[on.distances[wrong] > CLEAR]
    missed = np.count_nonzero(found.inliers[clear])
    # those strewn lie beside each other now and then: a chain of steps may lead to one at an edge
    assert missed <= len(points) // 1000
    thrown = np.setdiff1d(np.flatnonzero(~found.inliers), wrong)
    # the flanks of a bump are off too; nothing that lies within the noise is
    assert np.all(on.distances[thrown] > 6.0 * noise)
    assert name == "bump" or len(thrown) == 0
    if noise:
        assert found.noise == pytest.approx(NOISE, rel=0.12)


@pytest.mark.parametrize("name", ["strewn", "patch between", "patch at the leading edge", "added"])
def test_planted_outliers_of_a_blade_are_found_and_nothing_else(name):
    points = cloud(0, 4000, blade=True)
    points, wrong = PLANTED[name](points, nearest_footpoints(points, sides(blade=True)), np.random.default_rng(1))
    found, on = told(points, sides(blade=True))
    clear = wrong[on.distances[wrong] > CLEAR]
    assert np.count_nonzero(found.inliers[clear]) <= len(wrong) // 50
    assert len(np.setdiff1d(np.flatnonzero(~found.inliers), wrong)) == 0


@pytest.mark.parametrize(("stagger", "radius"), [(0.0, 1.0), (5.0, 1.5), (0.5, 1.0), (0.1, 1.5), (-0.05, 1.02)])
@pytest.mark.parametrize("noise", [0.0, NOISE, 10.0 * NOISE])
def test_no_point_is_an_outlier_for_what_a_design_misses_nor_for_its_noise(stagger, radius, noise):
    for count in (200, 3000):
        found, _ = told(cloud(count, count, noise), sides(stagger=stagger, radius=radius))
        assert found.inliers.all()


def test_points_that_are_noisier_at_an_edge_are_no_outliers():
    points, random = cloud(0, 1000, 0.0), np.random.default_rng(0)
    noisier = np.where(nearest_footpoints(points, sides()).u > 0.95, 4.0, 1.0)
    found, _ = told(points + NOISE * noisier[:, None] * random.normal(size=points.shape), sides())
    # one in a thousand
    assert np.count_nonzero(~found.inliers) <= 1


@pytest.mark.parametrize("copies", [2, 8])
def test_points_that_are_there_more_than_once_are_no_outliers(copies):
    points = np.repeat(cloud(0, 400), copies, axis=0)
    for stagger in (0.0, 0.5):
        assert told(points, sides(stagger=stagger))[0].inliers.all()


def test_weights_are_inverse_variances_of_the_noise():
    points, random = cloud(0, 3000, 0.0), np.random.default_rng(0)
    weights = np.where(random.random(3000) < 0.5, 1.6, 0.4)
    points = points + NOISE / np.sqrt(weights)[:, None] * random.normal(size=points.shape)
    found, on = told(points, sides(), weights)
    # a median of 3,000 magnitudes
    assert found.noise == pytest.approx(NOISE, rel=0.05)
    assert found.inliers.all()
    assert found.correlation < 0.1
    # 0.16 mm are eight deviations of the noise, but five of a point of little weight
    rows = [np.flatnonzero((weights == each) & (np.abs(on.u - 0.5) < 0.3))[0] for each in (1.6, 0.4)]
    points[rows] = on.points[rows] + 1.6e-4 * on.normals[rows]
    assert list(told(points, sides(), weights)[0].inliers[rows]) == [False, True]


def test_points_of_no_weight_tell_nothing_of_the_noise():
    points, random = cloud(0, 1000), np.random.default_rng(0)
    weights = np.where(np.arange(1000) % 2, 1.0, 0.0)
    rough = points + 1e-3 * (weights == 0.0)[:, None] * random.normal(size=points.shape)
    found = told(rough, sides(), weights)[0]
    assert found.noise == told(rough[weights > 0.0], sides())[0].noise
    assert found.inliers[weights > 0.0].all()
    assert np.mean(found.inliers[weights == 0.0]) < 0.3
