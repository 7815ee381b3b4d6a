"""Robust statistics: efficiency, breakdown, closed forms."""

import numpy as np
import pytest
from scipy.stats import norm

from bladewright.numerics.robust import DEVIATION_OVER_MEDIAN, TUKEY_WIDTH, median_deviation, tukey_weights


def test_the_deviation_of_normal_noise_is_found_beside_two_fifths_of_outliers():
    random = np.random.default_rng(0)
    noise = random.normal(scale=3.0, size=20_000)
    assert pytest.approx(1.0 / norm.ppf(0.75), rel=1e-4) == DEVIATION_OVER_MEDIAN
    assert median_deviation(noise) == pytest.approx(3.0, rel=0.02)
    # the median of all is the 5/6 quantile of the magnitudes of the others
    assert median_deviation(np.concatenate([noise[:12_000], np.full(8_000, 1e9)])) == pytest.approx(
        3.0 * norm.ppf(11 / 12) / norm.ppf(0.75), rel=0.03
    )


def test_means_with_tukeys_weights_have_the_efficiency_that_their_width_is_for():
    samples = np.random.default_rng(1).normal(size=(400, 500))
    means = samples.mean(axis=1)
    for _ in range(10):
        weights = tukey_weights(samples - means[:, None], TUKEY_WIDTH)
        means = np.sum(weights * samples, axis=1) / np.sum(weights, axis=1)
    assert np.var(samples.mean(axis=1)) / np.var(means) == pytest.approx(0.95, abs=0.03)
