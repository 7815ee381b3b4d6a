"""Arc length of a plane line that is known by its points only."""

from collections.abc import Callable, Sequence
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev

from bladewright.numerics.elementary import length, magnitude
from bladewright.nurbs.basis import Reals

NODES = 40
"""Chebyshev points on each piece to begin with: with them alone arc lengths and their inverse are within 3e-6 of the
whole (design/section_constants.py)"""
MAX_NODES = 320
"""Chebyshev points on each piece at most: 80 are within 3e-8, and more gain nothing (design/section_constants.py)"""
RESOLVED = 1e-10
"""size of the last four coefficients of the speed, of the largest, above which the points are doubled [-]"""
TABLE = 50
"""intervals on each piece of the table from which Newton's method for the inverse starts"""
STEPS = 6
"""Newton steps of the inverse: it is then within 1e-9 of where twice as many lead, with 4 steps within 1e-4, because
the speed may vanish at an end of the line (design/section_constants.py)"""
SETTLED = 1e-9
"""step of Newton's method after which it is exact: the next one would be its square [-]"""


class ArcLength:
    """Arc length w in [0, 1], of the whole, of a real line that is smooth between the ends of its pieces.

    Each piece is replaced by its Chebyshev interpolant (Trefethen 2013, chapter 3), whose speed is integrated exactly;
    the speed may vanish at an end of the line.
    """

    def __init__(self, line: Callable[[Reals], Reals], ends: Sequence[float]) -> None:
        """`line` returns points (k, 2) at parameters (k,) within the increasing `ends` of the pieces."""
        self._ends = np.array(ends)
        count = NODES
        speed = self._speeds(line, count)
        while count < MAX_NODES and np.max(magnitude(speed[:, -4:])) > RESOLVED * np.max(magnitude(speed)):
            count *= 2
            speed = self._speeds(line, count)
        risen = chebyshev.chebint(speed, lbnd=-1, axis=1)
        total = chebyshev.chebval(1.0, risen.T)
        self._whole = float(np.sum(total))
        risen[1:, 0] += np.cumsum(total)[:-1]
        # coefficients (pieces, 2, count + 1) of the length and of its derivative
        self._coefficients = np.stack([risen, np.pad(speed, [(0, 0), (0, 1)])], axis=1) / self._whole
        shares = np.linspace(0.0, 1.0, TABLE, endpoint=False)
        table = self._ends[:-1, None] + np.diff(self._ends)[:, None] * shares
        self._table = np.append(table, self._ends[-1])
        lengths = self._coefficients[:, 0] @ _polynomials(2.0 * shares - 1.0, count)
        self._lengths = np.append(lengths, 1.0)
        self._places: dict[float, float] = {}

    def _speeds(self, line: Callable[[Reals], Reals], count: int) -> Reals:
        """Chebyshev coefficients (pieces, count) of the speed on each piece."""
        nodes, transform, slope = _chebyshev(count)
        half = np.diff(self._ends)[:, None] / 2.0
        places = self._ends[:-1, None] + half * (1.0 + nodes)
        return np.asarray(length(slope @ line(places.ravel()).reshape(*places.shape, 2)) @ transform.T)

    def lengths(self, s: Reals) -> Reals:
        """Arc lengths (k,) at parameters s (k,)."""
        return self._values(s)[0]

    def places(self, w: Reals) -> Reals:
        """Parameters (k,) at arc lengths w (k,) in [0, 1]; those that were asked for before are remembered."""
        asked = w.tolist()
        new = [each for each in asked if each not in self._places]
        if new:
            self._places |= zip(new, self._searched(np.array(new)).tolist(), strict=True)
        return np.array([self._places[each] for each in asked])

    def _searched(self, w: Reals) -> Reals:
        """Parameters (k,) at arc lengths w (k,)."""
        table = self._table
        cell = np.clip(np.searchsorted(self._lengths, w, side="right") - 1, 0, len(table) - 2)
        low, high = table[cell], table[cell + 1]
        s = np.interp(w, self._lengths, table)
        moving = np.arange(len(w))
        for _ in range(STEPS):
            value, slope = self._values(s[moving])
            still = slope == 0.0
            new = s[moving] - np.where(still, 0.0, value - w[moving]) / np.where(still, 1.0, slope)
            new = np.clip(new, low[moving], high[moving])
            settled = np.square(new - s[moving]) < SETTLED**2
            s[moving] = new
            moving = moving[~settled]
            if not len(moving):
                break
        return np.where(w <= 0.0, self._ends[0], np.where(w >= 1.0, self._ends[-1], s))

    def _values(self, s: Reals) -> tuple[Reals, Reals]:
        """Arc lengths and their derivatives (k,) at parameters (k,)."""
        piece = np.clip(np.searchsorted(self._ends, s, side="right") - 1, 0, len(self._ends) - 2)
        half = (self._ends[piece + 1] - self._ends[piece]) / 2.0
        values = _polynomials((s - self._ends[piece]) / half - 1.0, self._coefficients.shape[-1] - 1)
        value, slope = np.einsum("kcn,nk->ck", self._coefficients[piece], values)
        return value, slope / half


@cache
def _chebyshev(count: int) -> tuple[Reals, Reals, Reals]:
    """Chebyshev points (count,), and matrices from values there to coefficients and to slopes there."""
    nodes = np.cos(np.pi * (np.arange(count) + 0.5) / count)[::-1]
    transform = np.asarray(chebyshev.chebvander(nodes, count - 1).T * (2.0 / count), dtype=np.float64)
    transform[0] /= 2.0
    slope: Reals = chebyshev.chebvander(nodes, count - 2) @ chebyshev.chebder(transform)
    return nodes, transform, slope


def _polynomials(x: Reals, degree: int) -> Reals:
    """Chebyshev polynomials (degree + 1, k) at places (k,) in [-1, 1]."""
    return np.cos(np.multiply.outer(np.arange(degree + 1.0), np.arccos(np.clip(x, -1.0, 1.0))))
