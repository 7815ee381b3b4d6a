"""How far the middle surface of a pitch stands beside the camber surface, so that a blade stays within its pitch.

Where one side is much thicker than the other, it may lie more than half a pitch from the camber line, though neighbours
stand clear of each other. The middle of both sides is then within half a pitch of both. A nose that stands out past a
steep edge lies beside the camber line that goes on at the slope of the edge; the middle line goes on at constant theta
first, and turns to that slope with the distance d past the edge: slope (d - ease (1 - exp(-d / ease))).
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, frozen
from bladewright.nurbs.basis import Reals

TERMS = (8, 20)
"""Chebyshev terms along the span and along the camber line: the middle need not be met, only neared."""
EASE = 3.0
"""Way over which it turns, in lengths of the nose past the edge: at the nose's end it has gone 0.15 of the slope's."""
SHARES = np.concatenate([[0.0], 0.5 - 0.5 * np.cos(np.pi * (np.arange(48) + 0.5) / 48.0), [1.0]])
"""Shares of the camber line at which the middle of the sides is taken."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MiddleShift(FrozenRecord):
    """theta, or y in a cascade, by which the middle surface stands above the camber surface."""

    terms: Reals
    """(n_v, n_t) coefficients of Chebyshev polynomials of 2 v - 1 and of 2 t - 1"""
    eases: tuple[float, float] = (0.0, 0.0)
    """ways in m', or m in a cascade, past the leading and the trailing edge over which the line turns"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "terms", frozen(np.asarray(self.terms, dtype=np.float64)))

    def __call__(self, v: Reals, t: Reals) -> Reals:
        """Shifts (m, k) at v (m,) and at shares t (k,) of the camber line."""
        along_v, along_t = (_polynomials(at, count) for at, count in zip((v, t), self.terms.shape, strict=True))
        return np.asarray(along_v @ self.terms @ along_t.T)

    def past(self, edge: int, distance: Array) -> Array:
        """What d is less by at distances (...) past the leading (0) or the trailing edge (1), in m', or m."""
        ease = self.eases[edge]
        return ease * (1.0 - np.exp(-distance / ease)) if ease else 0.0 * distance


def fitted_shift(v: Reals, camber: Reals, around: Reals) -> MiddleShift:
    """The shift to the middle of the least and the greatest theta that sections have at the camber lines' abscissae.

    `camber` (m, len(SHARES), 2) are camber lines at v (m,) and `around` (m, n, 2) closed outlines in (m', theta), of
    the real design.
    """
    middle = np.array([_middle(outline, line[:, 0]) for outline, line in zip(around, camber, strict=True)])
    wanted = middle - camber[..., 1]
    known = np.isfinite(wanted)
    along_v, along_t = (_polynomials(at, count) for at, count in zip((v, SHARES), TERMS, strict=True))
    matrix = (along_v[:, None, :, None] * along_t[None, :, None, :]).reshape(*wanted.shape, -1)[known]
    terms = np.asarray(np.linalg.lstsq(matrix, wanted[known], rcond=None)[0])  # real: a real choice
    ahead = float(np.max(camber[:, 0, 0] - np.min(around[..., 0], axis=1)))
    behind = float(np.max(np.max(around[..., 0], axis=1) - camber[:, -1, 0]))
    return MiddleShift(terms=terms.reshape(TERMS), eases=(EASE * max(ahead, 0.0), EASE * max(behind, 0.0)))


def _middle(outline: Reals, abscissae: Reals) -> Reals:
    """The middle (k,) of the least and the greatest theta of a closed outline (n, 2); NaN where it is not met."""
    start, end = outline, np.roll(outline, -1, axis=0)
    step = end - start
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (abscissae[:, None] - start[:, 0]) / step[:, 0]
        theta = np.where((share >= 0.0) & (share <= 1.0), start[:, 1] + share * step[:, 1], np.nan)
    met = np.any(np.isfinite(theta), axis=1)
    found = np.full(len(abscissae), np.nan)
    found[met] = 0.5 * (np.nanmin(theta[met], axis=1) + np.nanmax(theta[met], axis=1))
    return found


def _polynomials(at: Reals, count: int) -> Reals:
    return np.asarray(chebyshev.chebvander(2.0 * at - 1.0, count - 1))
