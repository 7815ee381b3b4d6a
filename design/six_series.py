"""How the thickness forms of the NACA 6-series and of 65-010 were fitted to published ordinates, and how far they miss.

Run: python design/six_series.py. It prints the coefficients of section/profiles/naca6.py and naca65.py.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.polynomial import chebyshev
from scipy.optimize import minimize_scalar

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.section.profiles.published import COMPRESSOR, SIX_SERIES, STATIONS

DEGREE = 12
X = STATIONS / 100.0
BASES = (0.06, 0.12, 0.21)


def values(coefficients, x):
    return np.sqrt(x) * (1.0 - x) * chebyshev.chebval(2.0 * x - 1.0, coefficients)


def fitted(ordinates):
    """Coefficients whose form goes by the ordinates (over the thickness) and is exactly 1/2 high."""
    matrix = chebyshev.chebvander(2.0 * X - 1.0, DEGREE) * (np.sqrt(X) * (1.0 - X))[:, None]
    found = np.linalg.lstsq(matrix, ordinates, rcond=None)[0]
    highest = minimize_scalar(
        lambda x: -values(found, x), bounds=(0.2, 0.6), method="bounded", options={"xatol": 1e-10}
    )
    return found * 0.5 / -highest.fun


compressor = np.round(fitted(COMPRESSOR / 10.0), 6)
print("65-010", compressor.tolist(), f"misses by {np.max(np.abs(values(compressor, X) * 10.0 - COMPRESSOR)):.4f} %")
for series in (63, 64, 65, 66):
    rows = np.array([fitted(SIX_SERIES[series, round(100 * t)] / (100.0 * t)) for t in BASES])
    powers = np.round(np.linalg.solve(np.vander(BASES, 3, increasing=True), rows), 6)
    print(series, powers.tolist())
    for t in (0.06, 0.12, 0.15, 0.21):
        form = values(powers[0] + t * (powers[1] + t * powers[2]), X) * 100.0 * t
        print(f"  {t:.2f} misses by {np.max(np.abs(form - SIX_SERIES[series, round(100 * t)])):.4f} % of the chord")
