"""Derivatives of what is smooth to one side of a place."""

import numpy as np

NODES = 20


def one_sided(points, place, step, order):
    """Derivative (2,) of points(s) -> (k, 2) at a place, by values within `step` to one side of it, and its rounding.

    Exact for polynomials of degree 19 but for rounding, which is what errors of four units in the last place of the
    values would become.
    """
    nodes = np.sort(place + step * (1.0 - np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)) / 2.0)
    values = points(nodes)
    middle, half = place + step / 2.0, np.fabs(step) / 2.0
    vandermonde = np.polynomial.chebyshev.chebvander((nodes - middle) / half, NODES - 1)
    slopes = np.polynomial.chebyshev.chebder(np.eye(NODES), order)
    at_end = np.polynomial.chebyshev.chebval((place - middle) / half, slopes) / half**order
    row = np.linalg.solve(vandermonde.T, at_end)
    return row @ values, 4.0 * np.finfo(float).eps * np.sum(np.fabs(row)) * np.max(np.fabs(values))
