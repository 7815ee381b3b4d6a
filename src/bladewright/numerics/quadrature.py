"""Gauss-Legendre quadrature on panels."""

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from bladewright.numerics.elementary import Array, Reals

FIRST_ORDER = 12
"""Gauss points on a panel at the first attempt of `converged_quadrature`: most integrands on one knot span need no
more, and an integral costs two attempts at least. With 24 the ends of Rotor 67 take four times as long
(design/nurbs_constants.md)."""
LAST_ORDER = 72
"""Gauss points on a panel at its last attempt: more do not help an integrand that is not smooth, and smooth ones need
fewer (design/nurbs_constants.md)."""
ORDER_GROWTH = 1.7
"""Ratio of the Gauss points of two attempts: near 1 attempts are many, far above it the last one is wasteful. The ends
of Rotor 67 take 0.11 s with 1.3, 0.16 s with 1.7 and 0.28 s with 2.5 (design/nurbs_constants.md)."""
MAX_HALVINGS = 40
"""Halvings of a panel by `adaptive`: what then remains of a kink is 1e-12 of its panel. With 10 the length of a
near-cusp is 3e-10 off (design/nurbs_constants.md)."""
ADAPTIVE_ORDER = 16
"""Gauss points on a panel of `adaptive`: exact for polynomials of degree 31. With 8 or 32 a near-cusp takes the same
time (design/nurbs_constants.md)."""
ADAPTIVE_TOLERANCE = 1e-14
"""Difference between a panel and its halves, in units of the whole integral, below which `adaptive` accepts them: some
fifty roundings. With 1e-11 the length of a near-cusp is 5e-12 off (design/nurbs_constants.md)."""
TOLERANCE = 1e-13
"""Change between two attempts, in units of the integral, below which `converged_quadrature` stops: the rounding of a
sum over a thousand points. With 1e-15 the ends of Rotor 67 take twice the time (design/nurbs_constants.md)."""


@cache
def gauss(order: int) -> tuple[Reals, Reals]:
    """Nodes and weights (order,) of Gauss-Legendre quadrature on [0, 1], exact to degree 2 order - 1."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    nodes, weights = 0.5 * (nodes + 1.0), 0.5 * weights
    nodes.setflags(write=False)
    weights.setflags(write=False)
    return nodes, weights


def panels(breaks: ArrayLike, order: int) -> tuple[Reals, Reals]:
    """Nodes and weights (k * order,) of Gauss quadrature on each of the k panels between `breaks` (k + 1,)."""
    ends = np.asarray(breaks, dtype=np.float64)
    nodes, weights = gauss(order)
    steps = np.diff(ends)[:, None]
    return (ends[:-1, None] + steps * nodes).ravel(), (steps * weights).ravel()


def adaptive(function: Callable[[Reals], Array], breaks: ArrayLike) -> Array:
    """Integral () of function(x) (m,) over the panels between `breaks` (k + 1,), rising or falling.

    A panel is halved until ADAPTIVE_ORDER Gauss points on it and on each of its halves agree within ADAPTIVE_TOLERANCE
    of the whole, at most MAX_HALVINGS times: cusps and kinks between the breaks cost more points but no accuracy.
    """
    ends = np.asarray(breaks, dtype=np.float64)
    start, step = ends[:-1], np.diff(ends)
    nodes, weights = gauss(ADAPTIVE_ORDER)

    def on(low: Reals, size: Reals) -> Array:
        values = function((low[:, None] + size[:, None] * nodes).ravel()).reshape(len(low), len(nodes))
        return np.asarray(size * (values @ weights))

    coarse = on(start, step)
    done: Array = np.zeros(())
    for _ in range(MAX_HALVINGS):
        halves = np.concatenate([start, start + 0.5 * step]), np.concatenate([0.5 * step, 0.5 * step])
        fine = on(*halves)
        both = fine[: len(start)] + fine[len(start) :]
        size = np.real(done + both.sum())
        rough = np.real(both - coarse) ** 2 > (ADAPTIVE_TOLERANCE * size) ** 2
        done = done + both[~rough].sum()
        if not rough.any():
            return done
        again = np.concatenate([rough, rough])
        start, step, coarse = halves[0][again], halves[1][again], fine[again]
    return done + coarse.sum()


def quadrature_orders(first: int = FIRST_ORDER) -> list[int]:
    """Gauss points on a panel for successive attempts at an integral, growing up to LAST_ORDER."""
    found = [first]
    while found[-1] < LAST_ORDER:
        found.append(min(LAST_ORDER, int(np.ceil(found[-1] * ORDER_GROWTH))))
    return found


def converged_quadrature(value: Callable[[int], Array], first: int = FIRST_ORDER) -> Array:
    """value(order) (...) at the first order at which it changes by less than TOLERANCE of its largest entry.

    Where it does not converge, the value at LAST_ORDER.
    """
    before = value(first)
    for order in quadrature_orders(first)[1:]:
        now = value(order)
        change = np.max(np.square(np.real(now - before)), initial=0.0)
        if change <= TOLERANCE**2 * np.max(np.square(np.real(now)), initial=0.0):
            return now
        before = now
    return before
