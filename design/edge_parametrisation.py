"""Is the parametrisation next to an edge monotone? Measures the least slope a' / alpha over all rises.

    python design/edge_parametrisation.py

Recorded on 2026-11-21, least slope over alpha, sides alike and sides unlike (speeds x 0.8 or 1.25, rises x 0.6 or 1.5):
BRAKE 10: 0.91, 0.68; 20: 0.84, 0.57; 40: 0.68, 0.16; 60: 0.52, -0.36 (not monotone). 20 keeps the slope positive with a
margin.
"""

import numpy as np
from numpy.polynomial import Polynomial

X = np.linspace(0.0, 1.0, 4001)
FALL = Polynomial([1.0, -1.0]) ** 4
P = (Polynomial([0.0, 1.0, 4.0]) * FALL).deriv()(X)
Q = (Polynomial([0.0, 0.0, 0.5]) * FALL).deriv()(X)


def least_slope(brake: float, *, unlike: bool) -> float:
    """Least a' / alpha over rises from -100 to 100,000 knot spans."""
    speeds, rises = ((0.8, 1.25), (0.6, 1.5)) if unlike else ((1.0,), (1.0,))
    least = np.inf
    for rise in np.concatenate([-np.geomspace(0.1, 100.0, 60), np.geomspace(0.1, 1e5, 300)]):
        alpha = (1.0 + rise**2 / brake) ** (-1.0 / 3.0)
        for speed in speeds:
            for share in rises:
                slope = 1.0 + (alpha * speed - 1.0) * P - rise * share * alpha**2 * speed * Q
                least = min(least, float(np.min(slope)) / alpha)
    return least


if __name__ == "__main__":
    for brake in (10.0, 20.0, 40.0, 60.0):
        alike, unlike = (least_slope(brake, unlike=each) for each in (False, True))
        print(f"BRAKE {brake:g}: {alike:.2f}, {unlike:.2f}")
