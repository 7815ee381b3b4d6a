"""What is said of each parameter, against the closed form of linear least squares."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import t as student

from bladewright.fitting.assessment.measurement import independent_share, parameter_estimates
from bladewright.fitting.free_parameters import Scales

POINTS, COUNT = 400, 5
SIZE = np.array([5.0, 0.2, 1.0, 0.01, 3.0])
PLACES = np.column_stack([np.linspace(0.0, 1.0, POINTS), np.zeros(POINTS)])
STATE = SimpleNamespace(footpoints=SimpleNamespace(u=PLACES[:, 0], side=np.zeros(POINTS, dtype=int), points=PLACES))
"""footpoints in a row on one side"""


def found(slopes, *, alike=1, low=-np.inf, high=np.inf, seed=1, deviation=1e-3, residuals=None, edges=0):
    """A match whose derivatives are given, and whose residuals, or they are noise that so many neighbours share.

    The last of both are those of places on edges.
    """
    rows = deviation * np.repeat(np.random.default_rng(seed).normal(size=len(slopes) // alike), alike)
    rows = rows if residuals is None else np.array(residuals)
    problem = SimpleNamespace(
        scales=Scales(size=SIZE, low=np.full(COUNT, low), high=np.full(COUNT, high)),
        paths=tuple("abcde"),
        cloud_residuals=SimpleNamespace(
            residuals=lambda _: rows,
            slopes=lambda *_: slopes,
            roots=np.ones(POINTS),
            points=PLACES,
            precision=np.ones(POINTS),
            ends=SimpleNamespace(near=np.empty(0, dtype=int)),
            overhang=SimpleNamespace(u=np.empty(edges)),
        ),
        values_of=lambda _: np.arange(1.0, COUNT + 1.0),
    )
    return SimpleNamespace(problem=problem, state=STATE, design=None), rows


def slopes_of(seed):
    return np.random.default_rng(seed).normal(size=(POINTS, COUNT)) / SIZE


@pytest.mark.parametrize("seed", range(3))
def test_the_covariance_is_that_of_linear_least_squares(seed):
    slopes = slopes_of(seed)
    match, rows = found(slopes)
    statistics = parameter_estimates(match)
    variance = np.sum(rows**2) / (POINTS - COUNT)
    np.testing.assert_allclose(statistics.covariance, variance * np.linalg.inv(slopes.T @ slopes), rtol=1e-9)
    deviations = np.sqrt(np.diag(statistics.covariance))
    np.testing.assert_allclose([each.deviation for each in statistics.estimates], deviations, rtol=1e-12)
    factor = student.ppf(0.975, POINTS - COUNT)
    for each, deviation in zip(statistics.estimates, deviations, strict=True):
        assert each.high - each.value == pytest.approx(factor * deviation, rel=1e-9)
        assert each.value - each.low == pytest.approx(factor * deviation, rel=1e-9)
        assert each.identified
    assert statistics.rank == COUNT
    assert statistics.condition == pytest.approx(np.linalg.cond(slopes * SIZE))


def test_a_limit_on_how_far_edges_stand_out_shows_nothing():
    match, rows = found(slopes_of(0))
    limited, _ = found(
        np.concatenate([slopes_of(0), 10.0 * slopes_of(1)[:30]]), residuals=[*rows, *np.ones(30)], edges=30
    )
    np.testing.assert_array_equal(parameter_estimates(limited).covariance, parameter_estimates(match).covariance)


def test_a_parameter_on_a_bound_is_known_and_the_others_are_as_if_it_were_given():
    slopes = slopes_of(0)
    statistics = parameter_estimates(found(slopes, low=1.0)[0])
    others = slopes[:, 1:]
    rows = found(slopes)[1]
    variance = np.sum(rows**2) / (POINTS - COUNT + 1)
    np.testing.assert_allclose(statistics.covariance[1:, 1:], variance * np.linalg.inv(others.T @ others), rtol=1e-9)
    assert not statistics.covariance[0].any()
    first, *_ = statistics.estimates
    assert first.at_bound
    assert first.low == first.value == first.high
    assert statistics.rank == COUNT


def test_parameters_that_all_lie_on_bounds_are_all_known():
    statistics = parameter_estimates(found(slopes_of(0), low=np.arange(1.0, COUNT + 1.0))[0])
    assert not statistics.covariance.any()
    assert (statistics.rank, statistics.condition) == (COUNT, 1.0)


def test_intervals_hold_the_truth_as_often_as_they_say():
    held, slopes = [], slopes_of(0)
    for seed in range(300):
        match, rows = found(slopes, seed=seed)
        # the step to the minimum, whose residuals are what is left
        step, *_ = np.linalg.lstsq(slopes, -rows, rcond=None)
        left = rows + slopes @ step
        match.problem.cloud_residuals.residuals = lambda _, left=left: left
        match.problem.values_of = lambda _, step=step: step
        held += [each.low <= 0.0 <= each.high for each in parameter_estimates(match).estimates]
    # three standard errors of a share of 0.95 of 1,500
    assert np.mean(held) == pytest.approx(0.95, abs=3.0 * np.sqrt(0.95 * 0.05 / 1500))


def test_what_no_residual_depends_on_is_not_identified():
    slopes = slopes_of(0)
    slopes[:, 2] = 0.0
    statistics = parameter_estimates(found(slopes)[0])
    assert [each.path for each in statistics.estimates if not each.identified] == ["c"]
    assert statistics.estimates[2].deviation == np.inf
    assert statistics.rank == COUNT - 1
    assert statistics.condition > 1e15
    assert np.isfinite(statistics.covariance).all()


def test_parameters_that_do_the_same_are_not_identified():
    slopes = slopes_of(0)
    slopes[:, 3] = slopes[:, 1] * SIZE[1] / SIZE[3]
    statistics = parameter_estimates(found(slopes)[0])
    assert [each.path for each in statistics.estimates if not each.identified] == ["b", "d"]
    assert statistics.rank == COUNT - 1


@pytest.mark.parametrize("alike", [4, 16])
def test_points_that_share_their_misfit_count_as_fewer(alike):
    shares = [
        independent_share(PLACES, np.repeat(np.random.default_rng(seed).normal(size=POINTS // alike), alike))
        for seed in range(20)
    ]
    # the sum of the correlations in a block is its length, less what ever larger steps miss
    assert 0.7 / alike < np.median(shares) < 1.6 / alike
    match, rows = found(slopes_of(0), alike=alike, seed=3)
    variance = np.sum(rows**2) / (POINTS - COUNT) / independent_share(PLACES, rows)
    expected = variance * np.linalg.inv(slopes_of(0).T @ slopes_of(0))
    # beside the edges footpoints on a side are a little nearer to those on the other
    np.testing.assert_allclose(parameter_estimates(match).covariance, expected, rtol=0.1)


def test_noise_is_independent():
    shares = [independent_share(PLACES, np.random.default_rng(seed).normal(size=POINTS)) for seed in range(100)]
    # by chance one in forty is taken for a little correlated
    assert np.mean(np.array(shares) == 1.0) > 0.9
    assert min(shares) > 0.6


def test_parameters_on_a_bound_are_said():
    assert not any(each.at_bound for each in parameter_estimates(found(slopes_of(0))[0]).estimates)
    on = parameter_estimates(found(slopes_of(0), low=2.0, high=5.0)[0]).estimates
    assert [each.path for each in on if each.at_bound] == ["a", "b", "e"]


def test_weights_of_a_search_that_are_no_inverse_variances_take_no_error_away():
    slopes, random = slopes_of(0), np.random.default_rng(0)
    roots = np.sqrt(random.uniform(0.1, 10.0, POINTS))
    match, rows = found(slopes)
    cloud_residuals = match.problem.cloud_residuals
    cloud_residuals.roots = roots
    cloud_residuals.residuals, cloud_residuals.slopes = lambda _: roots * rows, lambda *_: roots[:, None] * slopes
    # of errors of one size, by hand: the inverse of the weighted curvature on both sides of what the errors do
    inverse = np.linalg.inv(slopes.T @ (roots[:, None] ** 2 * slopes))
    variance = np.sum(rows**2) / (POINTS - COUNT)
    expected = variance * inverse @ (slopes.T @ (roots[:, None] ** 4 * slopes)) @ inverse
    np.testing.assert_allclose(parameter_estimates(match).covariance, expected, rtol=1e-9)
    # as inverse variances the same weights give the plain formula
    cloud_residuals.precision = roots**2
    variance = np.sum((roots * rows) ** 2) / (POINTS - COUNT)
    np.testing.assert_allclose(parameter_estimates(match).covariance, variance * inverse, rtol=1e-9)
