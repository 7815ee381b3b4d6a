"""B-spline basis functions on clamped knot vectors over [0, 1]."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BSpline

Reals = NDArray[np.float64]


def uniform_knots(count: int, degree: int) -> Reals:
    """Clamped uniform knots (count + degree + 1,) over [0, 1] for `count` control points."""
    inner = np.linspace(0.0, 1.0, count - degree + 1)
    return np.concatenate([np.zeros(degree), inner, np.ones(degree)])


def greville(knots: Reals, degree: int) -> Reals:
    """Greville abscissae (n,): the means of `degree` consecutive knots, one for each control point."""
    count = len(knots) - degree - 1
    return np.array([knots[i + 1 : i + degree + 1].mean() for i in range(count)])


def basis(knots: Reals, degree: int, u: ArrayLike, order: int = 0) -> Reals:
    """Dense matrix (len(u), n) of all basis functions' `order`-th derivatives at real parameters u (m,).

    Outside the knots' range the end polynomials are continued.
    """
    count = len(knots) - degree - 1
    return BSpline(knots, np.eye(count), degree)(np.asarray(u, dtype=np.float64), nu=order)
