"""Points of an edge that is not found are asked again before they are left out, and keep a match from passing."""

import numpy as np
import pytest
from scipy.stats import binomtest

import bladewright as bw
from bladewright.fitting.matching.footpoints import Footpoints, nearest_footpoints
from bladewright.fitting.matching.noise import SIGNIFICANCE, crowded_at_edges, doubted_outliers
from bladewright.section.wedge_diffuser import WedgeDiffuser
from machines import example

COUNT = 2000


def outliers_of(share_at_edge, *, inside=True, off=0.01):
    """Footpoints spread evenly along a straight side, and 40 outliers, so many of them at its leading edge."""
    u = np.linspace(0.0, 1.0, COUNT)
    at_edge = np.flatnonzero(u < 0.1)
    few = round(40 * share_at_edge)
    rows = np.concatenate([at_edge[:few], np.linspace(COUNT // 5, COUNT - 1, 40 - few).astype(int)])
    outliers = np.zeros(COUNT, dtype=bool)
    outliers[rows] = True
    normals = np.tile([0.0, 1.0], (COUNT, 1))
    sign = np.where(u < 0.1, -1.0 if inside else 1.0, np.where(np.arange(COUNT) % 2, 1.0, -1.0))
    points = np.column_stack([u, np.zeros(COUNT)])
    feet = Footpoints(
        side=np.zeros(COUNT, dtype=np.intp),
        u=u,
        v=np.zeros(COUNT),
        points=points,
        normals=normals,
        beyond=np.zeros((COUNT, 2)),
        miss=off * (outliers * sign)[:, None] * normals,
    )
    return outliers, feet


@pytest.mark.parametrize("inside", [True, False])
def test_outliers_at_an_edge_are_crowded_where_more_lie_there_than_by_chance(inside):
    found = crowded_at_edges(*outliers_of(0.3, inside=inside))
    assert list(found) == ["leading edge"]
    assert np.count_nonzero(found["leading edge"]) == 12


@pytest.mark.parametrize(("share", "inside", "off"), [(0.1, True, 0.01), (0.1, False, 0.01), (0.3, False, 0.2)])
def test_outliers_are_not_crowded_by_chance_or_where_an_edge_is_nearest_from_far_around(share, inside, off):
    assert not crowded_at_edges(*outliers_of(share, inside=inside, off=off))


def test_outliers_in_any_direction_crowd_at_a_true_edge_no_more_often_than_said():
    built, draw, found, clouds = example("turbine-section").build(), np.random.default_rng(8), 0, 60
    sides = built.curves["upper"], built.curves["lower"]
    for _ in range(clouds):
        points = np.concatenate([side((1.0 - np.cos(np.pi * draw.random(500))) / 2.0) for side in sides])
        outliers, way = draw.random(len(points)) < 0.05, draw.normal(size=points.shape)
        way *= (outliers * built.chord * draw.uniform(0.005, 0.05, len(points)) / np.hypot(*way.T))[:, None]
        found += len(crowded_at_edges(outliers, nearest_footpoints(points + way, sides)))
    assert binomtest(found, 2 * clouds, SIGNIFICANCE, alternative="greater").pvalue > 0.01


@pytest.mark.parametrize(("systematic", "doubted"), [(True, range(4)), (False, ())])
def test_outliers_with_others_beside_them_are_doubted_where_the_misfit_is_systematic(systematic, doubted):
    outliers, feet = outliers_of(0.1)
    found = doubted_outliers(outliers, feet.points + feet.miss, feet, systematic=systematic)
    assert list(np.flatnonzero(found)) == list(doubted)


def test_outliers_that_crowd_at_an_edge_are_doubted():
    outliers, feet = outliers_of(0.3)
    found = doubted_outliers(outliers, feet.points + feet.miss, feet, systematic=False)
    assert np.array_equal(np.flatnonzero(found), np.arange(12))


WEDGE = bw.WedgeDiffuserSection(
    name="wedge",
    length_unit="mm",
    chord=147.537,
    section=WedgeDiffuser(
        stagger_angle=8.9887, leading_edge_radius=0.005054, trailing_edge_radius=0.025485, wedge_angle=9.0787
    ),
)
"""a vane of whose 860 points, even along its sides, some eight lie on the arc of the leading edge"""


def matched(seed):
    """What 860 random points of the wedge are matched by."""
    u, random, points = np.linspace(0.0, 1.0, 20_001), np.random.default_rng(seed), []
    for side in ("upper", "lower"):
        curve = WEDGE.build().curves[side]
        way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(curve(u), axis=0), axis=1))])
        points.append(curve(np.interp(random.random(430) * way[-1], way, u)))
    return bw.fit(np.concatenate(points), family="wedge-diffuser")


def test_a_leading_edge_that_few_points_show_is_found():
    found = matched(1)
    assert found.passed
    assert np.all(found.inliers)
    assert found.design.section.leading_edge_radius == pytest.approx(0.005054, rel=1e-6)


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (2, 3, 4))])
def test_a_match_whose_leading_edge_is_not_found_does_not_pass(seed):
    found = matched(seed)
    near = abs(found.design.chord - WEDGE.chord) < 1e-3 * WEDGE.chord
    assert found.passed is near
