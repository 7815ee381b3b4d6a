"""Gauss-Legendre quadrature on panels."""

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bladewright.numerics.elementary import Array

Reals = NDArray[np.float64]

FIRST_ORDER, LAST_ORDER, MORE = 12, 72, 1.7
"""points a panel to start with, at most, and the factor between two tries of `integrated`"""
DEEPEST = 40
"""most halvings of a panel by `adaptive`"""
TOLERANCE = 1e-13
"""change between two tries, in units of the integral's size, below which `integrated` stops"""


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

    A panel is halved until sixteen Gauss points on it and on its halves agree within 1e-14 of the whole, or it is
    2^-40 of itself, so that cusps and kinks between the breaks cost more points but no accuracy.
    """
    ends = np.asarray(breaks, dtype=np.float64)
    start, step = ends[:-1], np.diff(ends)
    nodes, weights = gauss(16)

    def on(low: Reals, size: Reals) -> Array:
        values = function((low[:, None] + size[:, None] * nodes).ravel()).reshape(len(low), len(nodes))
        return np.asarray(size * (values @ weights))

    coarse = on(start, step)
    done: Array = np.zeros(())
    for _ in range(DEEPEST):
        halves = np.concatenate([start, start + 0.5 * step]), np.concatenate([0.5 * step, 0.5 * step])
        fine = on(*halves)
        both = fine[: len(start)] + fine[len(start) :]
        size = np.real(done + both.sum())
        rough = np.real(both - coarse) ** 2 > (1e-14 * size) ** 2
        done = done + both[~rough].sum()
        if not rough.any():
            return done
        again = np.concatenate([rough, rough])
        start, step, coarse = halves[0][again], halves[1][again], fine[again]
    return done + coarse.sum()


def quadrature_orders(first: int = FIRST_ORDER) -> list[int]:
    """Points a panel for successive tries of an integral, growing up to `LAST_ORDER`."""
    found = [first]
    while found[-1] < LAST_ORDER:
        found.append(min(LAST_ORDER, int(np.ceil(found[-1] * MORE))))
    return found


def converged_quadrature(value: Callable[[int], Array], first: int = FIRST_ORDER) -> Array:
    """value(order) (...) at the first order that changes it by less than 1e-13 of its largest entry.

    Where no order settles, the value at the last, 72 points a panel.
    """
    before = value(first)
    for order in quadrature_orders(first)[1:]:
        now = value(order)
        change = np.max(np.square(np.real(now - before)), initial=0.0)
        if change <= TOLERANCE**2 * np.max(np.square(np.real(now)), initial=0.0):
            return now
        before = now
    return before
