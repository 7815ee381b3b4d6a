"""Noise, misfit and outliers, told from each other by neighbours."""

import numpy as np
import pytest

from bladewright.fitting.matching.footpoints import Footpoints
from bladewright.fitting.matching.noise import noise_of

NOISE = 1e-5


def made(seed, count=2000, *, misfit=0.0, dimension=2):
    """Two flat sides a tenth apart, and heights above them: normal noise and a misfit of one wave."""
    random = np.random.default_rng(seed)
    side, u, v = np.arange(count) % 2, random.random(count), random.random(count)
    sign = np.where(side == 0, 1.0, -1.0)
    flat = [u, 0.05 * sign] + ([v] if dimension == 3 else [])
    normals = np.zeros((count, dimension))
    normals[:, 1] = sign
    heights = NOISE * random.normal(size=count) + misfit * np.sin(2.0 * np.pi * u)
    return side, u, v, np.stack(flat, axis=-1), normals, heights


def placed_feet(side, u, v, points, normals, heights):
    return Footpoints(
        side=side, u=u, v=v, points=points, normals=normals, beyond=np.zeros_like(points),
        miss=heights[:, None] * normals,
    )  # fmt: skip


def scattered(*parts):
    on = placed_feet(*parts)
    return noise_of(on.points + on.miss, on)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("seed", range(3))
def test_noise_is_found_and_is_not_taken_for_misfit(seed, dimension):
    found = scattered(*made(seed, dimension=dimension))
    # a median of 2,000 magnitudes, through neighbours that share them
    assert found.noise == pytest.approx(NOISE, rel=0.1)
    assert found.correlation < 0.1
    # of normal heights, hardly any is eight robust deviations off
    assert np.count_nonzero(~found.inliers) <= 2


@pytest.mark.parametrize("dimension", [2, 3])
def test_copies_of_points_tell_no_more_of_the_noise(dimension):
    parts = made(0, dimension=dimension)
    once, thrice = scattered(*parts), scattered(*(np.repeat(part, 3, axis=0) for part in parts))
    assert (thrice.noise, thrice.correlation) == (once.noise, once.correlation)
    np.testing.assert_array_equal(thrice.inliers, np.repeat(once.inliers, 3))


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_smooth_misfit_is_neither_noise_nor_outliers(dimension):
    found = scattered(*made(0, misfit=100.0 * NOISE, dimension=dimension))
    assert found.inliers.all()
    assert found.correlation > 0.95
    if dimension == 2:
        assert found.noise == pytest.approx(NOISE, rel=0.15)


def test_a_steady_slope_of_the_misfit_is_no_noise():
    side, u, v, points, normals, heights = made(0, dimension=3)
    found = scattered(side, u, v, points, normals, heights + 0.01 * u + 0.02 * v)
    assert found.noise == pytest.approx(NOISE, rel=0.1)
    assert found.correlation > 0.99


def test_points_in_one_row_tell_their_noise():
    side, u, _, points, normals, heights = made(0, dimension=3)
    points[:, 2] = 0.5
    found = scattered(side, u, np.full_like(u, 0.5), points, normals, heights + 0.01 * u)
    assert found.noise == pytest.approx(NOISE, rel=0.1)


@pytest.mark.parametrize(("misfit", "off"), [(0.0, 1e-3), (30.0 * NOISE, 4e-3)])
def test_single_points_off_their_neighbours_are_outliers_whatever_the_misfit(misfit, off):
    # off by more than the usual distance, which the misfit makes large
    side, u, v, points, normals, heights = made(1, misfit=misfit)
    # away from the edges, where more is allowed, and from each other
    inner = np.argsort(u)[200:1800]
    wrong = inner[::80]
    heights[wrong] += np.where(np.arange(len(wrong)) % 2, 1.0, -1.0) * off
    found = scattered(side, u, v, points, normals, heights)
    assert not found.inliers[wrong].any()
    assert np.count_nonzero(~found.inliers) <= len(wrong) + 3
    # a few wrong points change neither figure
    assert found.noise == pytest.approx(NOISE, rel=0.15)


def test_points_past_an_end_are_outliers_though_they_have_no_height():
    side, u, v, points, normals, heights = made(2, dimension=3)
    at = int(np.argmin((u - 0.5) ** 2))
    on = placed_feet(side, u, v, points, normals, heights)
    on.miss[at, 2] += 0.01
    assert not noise_of(on.points + on.miss, on).inliers[at]
    trusted = np.arange(len(u)) == at
    assert noise_of(on.points + on.miss, on, trusted=trusted).inliers[at]


def test_a_row_that_few_control_points_miss_is_cut_off_unless_a_richer_match_is_known_to_meet_it():
    side, u, v, points, normals, heights = made(2, dimension=3)
    row = v < 0.03
    heights += np.where(row, 0.02 * np.sin(np.pi * u), 0.0)
    missed = row & (heights > 0.01)
    on = placed_feet(side, u, v, points, normals, heights)
    assert not noise_of(on.points + on.miss, on).inliers[missed].any()
    assert noise_of(on.points + on.miss, on, trusted=missed).inliers[missed].all()


def test_points_repeat_each_other_where_neighbours_share_the_misfit():
    noise, misfit = scattered(*made(0)), scattered(*made(0, misfit=1e3 * NOISE))
    assert noise.independent_share(20) > 0.2
    # 2,000 points for 20 parameters: one in 50 tells something of its own
    assert misfit.independent_share(20) == pytest.approx(40.0 / 2000.0, rel=0.1)
    assert misfit.independent_share(1000) == pytest.approx(1.0)


def test_few_points_on_a_side_do_not_stop_it():
    side, u, v, points, normals, heights = made(0, count=12)
    for count in (0, 1, 2):
        on = np.where(np.arange(12) < count, 1, 0)
        assert np.isfinite(scattered(on, u, v, points, normals, heights).noise)
    assert side.sum() == 6


@pytest.mark.parametrize("dimension", [2, 3])
def test_of_more_points_than_are_compared_the_others_are_judged_by_those_beside_them(dimension):
    parts = made(3, count=60_000, misfit=5.0 * NOISE, dimension=dimension)
    inner = np.flatnonzero(np.abs(parts[1] - 0.5) < 0.4)
    wrong = inner[::80]
    parts[-1][wrong] += NOISE * np.random.default_rng(0).uniform(100.0, 1000.0, len(wrong))
    found = scattered(*parts)
    assert not found.inliers[wrong].any()
    assert np.count_nonzero(~found.inliers) <= len(wrong) + 6
    assert found.noise == pytest.approx(NOISE, rel=0.1)
