"""Derivatives of functions that are analytic between known joints, by Chebyshev series on each piece."""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev

from bladewright.nurbs.basis import Reals

NODES = 25
"""Chebyshev nodes of a piece: with more, pieces grow longer and derivatives no more exact
(design/section_constants.py)"""
RESOLVED = 1e-13
"""size of the last two terms of a series, of its largest, above which a piece is halved: a few hundred roundings [-]"""
ROUNDING = 4e-15
"""size of a term, of the largest, below which it is dropped as rounding, which differentiating multiplies: a third
derivative of a profile through points is then within 7e-6 of its largest value instead of 1e-4, that of other sections
within 2e-6 either way (design/section_constants.py) [-]"""
HALVINGS = 7
"""how often a piece may be halved: what is not resolved on a 128th of it is a joint that nobody stated"""

Function = Callable[[Reals], Reals]
"""values (k, d) at places (k,)"""


class ChebyshevPieces:
    """A function of one real variable on pieces between ends (p + 1,), its derivatives those of the series.

    Each derivative of a series of n terms multiplies its rounding by about n^2 over the length of the piece, so pieces
    are as long as the nodes allow. Third derivatives keep five to seven digits of their largest value
    (design/section_constants.py).
    """

    def __init__(self, function: Function, ends: Sequence[float] | Reals) -> None:
        unresolved = [(float(low), float(high)) for low, high in pairwise(ends)]
        nodes = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
        fitted = np.linalg.inv(chebyshev.chebvander(nodes, NODES - 1))
        found: list[tuple[float, float, Reals]] = []
        for halving in range(HALVINGS + 1):
            if not unresolved:
                break
            places = [0.5 * (low + high) + 0.5 * (high - low) * nodes for low, high in unresolved]
            values = np.asarray(function(np.sort(np.concatenate(places))))
            values = values.reshape(len(unresolved), NODES, -1)[:, ::-1]
            later = []
            for (low, high), own in zip(unresolved, values, strict=True):
                series = fitted @ own
                size = np.sqrt(np.max(series * series))
                last = np.sqrt(np.max(series[-2:] ** 2))
                if last > RESOLVED * size and halving < HALVINGS:
                    later += [(low, 0.5 * (low + high)), (0.5 * (low + high), high)]
                else:
                    found.append((low, high, _chopped(series, size)))
            unresolved = sorted(later)
        self._pieces = sorted(found, key=lambda piece: piece[0])

    def derivatives(self, at: Reals, order: int) -> Reals:
        """Value and derivatives (k, d, order + 1) at places (k,); at a joint those of the piece behind it."""
        starts = np.array([low for low, _, _ in self._pieces])
        owner = np.clip(np.searchsorted(starts, at, side="right") - 1, 0, len(starts) - 1)
        found = np.empty((len(at), self._pieces[0][2].shape[1], order + 1))
        for k in np.unique(owner):
            low, high, series = self._pieces[k]
            here = owner == k
            t = (2.0 * at[here] - low - high) / (high - low)
            for n in range(order + 1):
                terms = chebyshev.chebder(series, n, scl=2.0 / (high - low)) if n else series
                found[here, :, n] = chebyshev.chebval(t, terms).T
        return found


def _chopped(series: Reals, size: float) -> Reals:
    """The series up to its last term above rounding."""
    above = np.flatnonzero(np.any(series * series > (ROUNDING * size) ** 2, axis=1))
    return series[: (int(above[-1]) if len(above) else 0) + 1]


def inverse(function: Callable[[Reals], Reals], ends: Reals) -> Callable[[Reals], Reals]:
    """The inverse of a function that rises from 0 to 1 over [0, 1], with or without slope at both ends.

    Near an end the secant method runs on the root of the distance from it, which has a slope there either way. `ends`
    (p + 1,) are the function's joints with 0 and 1.
    """
    table = np.unique(np.concatenate([np.linspace(a, b, 33) for a, b in pairwise(ends)]))
    values = function(table)

    def found(x: Reals) -> Reals:
        front = x < 0.5

        def off(s: Reals) -> Reals:
            value = function(s)
            near = np.where(front, value, 1.0 - value), np.where(front, x, 1.0 - x)
            roots = [np.sqrt(np.maximum(each, 0.0)) for each in near]
            return np.where(front, roots[0] - roots[1], roots[1] - roots[0])

        index = np.clip(np.searchsorted(values, x) - 1, 0, len(table) - 2)
        low, high = table[index], table[index + 1]
        at_low, at_high = off(low), off(high)
        for _ in range(60):
            span = at_high - at_low
            step = np.where(span > 0.0, at_high / np.where(span > 0.0, span, 1.0), 0.5)
            middle = np.clip(high - step * (high - low), low, high)
            value = off(middle)
            left = value < 0.0
            # Illinois: the end that stays is taken for half as far off
            low, at_low = np.where(left, middle, low), np.where(left, value, 0.5 * at_low)
            high, at_high = np.where(left, high, middle), np.where(left, 0.5 * at_high, value)
            if np.max(value * value) < 1e-32:
                return middle
        return middle

    return found
