"""Bracketed roots of many equations at once, with their derivatives, and where a function crosses given levels."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from bladewright.numerics.elementary import Array

EPSILON = float(np.finfo(np.float64).eps)
"""Relative spacing of doubles, to which `level_crossings` are found."""
STEPS = 80
"""Iterations: bisection alone needs no more until a bracket is below the spacing of doubles."""


def bracketed_root(function: Callable[[Array], tuple[Array, Array]], low: ArrayLike, high: ArrayLike) -> Array:
    """Roots (...) between `low` and `high` (...) of a function that has different signs there, or is zero at one.

    `function(x)` returns value and slope (...) at real x (...). Newton's steps are taken where they stay inside the
    bracket and halve the step before, bisection elsewhere, on real parts; where values are complex, the root's
    imaginary part is that of one more Newton step, which makes it the derivative of the root.
    """
    below, above = (np.array(end, dtype=np.float64) for end in np.broadcast_arrays(low, high))
    rising = np.real(function(above)[0]) >= np.real(function(below)[0])
    root = 0.5 * (below + above)
    step = above - below
    for _ in range(STEPS):
        value, slope = (np.real(part) for part in function(root))
        to_right = (value < 0.0) == rising
        below, above = np.where(to_right, root, below), np.where(to_right, above, root)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = root - value / slope
        inside = (newton > below) & (newton < above) & ((newton - root) ** 2 < 0.25 * step**2)
        after = np.where(value == 0.0, root, np.where(inside, newton, 0.5 * (below + above)))
        step, root = after - root, after
        settled = step**2 <= np.spacing(np.maximum(root, -root)) ** 2
        if settled.all():
            break
    value, slope = function(root)
    if np.iscomplexobj(value) or np.iscomplexobj(slope):
        return np.asarray(root - 1j * np.imag(value) / np.real(slope))
    return root


def level_crossings(
    function: Callable[[Array], Array], places: ArrayLike, values: ArrayLike, levels: ArrayLike
) -> Array:
    """Arguments (k,), increasing, at which a continuous real function equals a level, or any of several, to rounding.

    `values` (m,) are the function's at increasing `places` (m,); two crossings between neighbouring places are missed.
    """
    at, targets = np.asarray(places, dtype=np.float64), np.atleast_1d(np.asarray(levels, dtype=np.float64))
    difference = np.asarray(values, dtype=np.float64) - targets[:, None]
    row, first = np.nonzero(difference[:, :-1] * difference[:, 1:] < 0.0)
    found = at[np.nonzero(difference == 0.0)[1]]
    if len(first):
        from scipy.optimize import elementwise

        bracket, exact = (at[first], at[first + 1]), {"xatol": 0.0, "xrtol": EPSILON, "fatol": 0.0, "frtol": 0.0}
        roots = elementwise.find_root(
            lambda x, level: function(x) - level, bracket, args=(targets[row],), tolerances=exact, maxiter=STEPS
        )
        found = np.concatenate([roots.x, found])
    return np.sort(found)
