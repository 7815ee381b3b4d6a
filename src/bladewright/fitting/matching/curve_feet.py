"""Nearest places on curves that are polynomials between their knots: Newton's iteration in one parameter."""

from functools import cache

import numpy as np

from bladewright.nurbs.basis import Reals
from bladewright.nurbs.bezier import Patches, bernstein

STEPS = 60
NOISE = 1e-13
"""relative rise of a squared distance that is rounding"""
FARTHEST = 2.0
"""widths of a piece that a step may lead"""


def walked(on: Patches, points: Reals, start: Reals, *, converged: float) -> tuple[Reals, Reals]:
    """Parameters (n,) where descents from a start (n,) end, and squared distances (n,) there.

    `converged` is a last step, of the width of a piece. Points (n, d) pass from piece to piece.
    """
    degree = on.degrees[0]
    coefficients = np.einsum("ij,kjd->ikd", _powers(degree), on.nets[:, :, 0, :-1])
    low = on.low[:, 0]
    width = on.high[:, 0] - low
    ends = low[0], on.high[-1, 0]

    def model(at: Reals, aims: Reals) -> tuple[Reals, Reals, Reals, Reals]:
        """Squared distance, half its slope and bend by the parameter, and the width of the piece, (m,) each."""
        piece = np.clip(np.searchsorted(low, at, side="right") - 1, 0, len(low) - 1)
        size = width[piece]
        t = ((at - low[piece]) / size)[:, None]
        of = coefficients[:, piece]
        value, first, second = of[degree], np.zeros_like(aims), np.zeros_like(aims)
        for row in of[degree - 1 :: -1] if degree else ():
            second = second * t + first
            first = first * t + value
            value = value * t + row
        miss = value - aims
        speed = np.einsum("md,md->m", first, first)
        bend = speed + 2.0 * np.einsum("md,md->m", miss, second)
        slope = np.einsum("md,md->m", miss, first)
        # where the distance is not convex Gauss's bend descends
        bend = np.where(bend > 0.0, bend, np.where(speed > 0.0, speed, 1.0))
        return np.einsum("md,md->m", miss, miss), slope / size, bend / size**2, size

    u = np.clip(start, *ends)
    square, slope, bend, size = model(u, points)
    step = np.clip(-slope / bend, -FARTHEST * size, FARTHEST * size)
    active = np.arange(len(u))
    for _ in range(STEPS):
        trial = np.clip(u[active] + step[active], *ends)
        far = np.abs(trial - u[active]) > converged * size[active]
        active, trial = active[far], trial[far]
        if len(active) == 0:
            break
        new = model(trial, points[active])
        better = new[0] <= square[active] * (1.0 + NOISE)
        step[active[~better]] *= 0.25
        taken = active[better]
        u[taken], square[taken], size[taken] = trial[better], new[0][better], new[3][better]
        full = -new[1][better] / new[2][better]
        step[taken] = np.clip(full, -FARTHEST * size[taken], FARTHEST * size[taken])
    return u, square


@cache
def _powers(degree: int) -> Reals:
    """The matrix (degree + 1, degree + 1) from Bernstein coefficients to those of powers."""
    orders = [bernstein(degree, np.zeros(1), order)[0] for order in range(degree + 1)]
    factorials = np.cumprod([1.0, *range(1, degree + 1)])
    return np.asarray(np.stack(orders) / factorials[:, None])
