"""Statistics of residuals among which some are outliers.

References: Hampel 1974 (median absolute deviation); Beaton and Tukey 1974 (biweight); Huber and Ronchetti 2009.
"""

import numpy as np

from bladewright.numerics.elementary import Reals

DEVIATION_OVER_MEDIAN = 1.4826
"""standard deviation of normal noise over its median magnitude, 1 / Phi^-1(3/4)"""
TUKEY_WIDTH = 4.685
"""standard deviations at which Tukey's weights reach zero for an efficiency of 95 % on normal noise"""


def median_deviation(residuals: Reals) -> float:
    """The standard deviation of normal residuals (n,) of mean zero, by their median magnitude: half may be outliers."""
    return DEVIATION_OVER_MEDIAN * float(np.median(np.sqrt(residuals**2)))


def tukey_weights(residuals: Reals, width: float) -> Reals:
    """Tukey's weights (n,): they fall smoothly from 1 to 0 where a residual is as large as `width`."""
    return np.asarray(np.maximum(0.0, 1.0 - (residuals / width) ** 2) ** 2)
