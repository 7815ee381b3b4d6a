"""The parameter s of a section on its chord: where u(s) puts the joints of a thickness law at fixed s.

The joints of a law (the place of the maximum, where an edge's ellipse ends) move with its parameters and along the
span, but those of an outline stand at the same s in all sections. So u = R(sigma(s)) in two steps:

* sigma(s) is fixed: (1 - cos pi s) / 2 between two round edges, whose even symmetry about both turns the root of u that
  a round edge has into an odd analytic function of s; 1 - cos(pi s / 2) or sin(pi s / 2) where one edge only is round,
  s where none is, so that a side leaves a sharp or blunt edge at a finite speed.
* R is a rational function on each piece between joints, (quadratic / quadratic), rising whatever the joints
  (Delbourgo and Gregory 1983): through (sigma_j, u_j), with as many continuous derivatives as the law has there, one or
  two. It is the identity where the joints stand at their usual places, and analytic in every parameter.

A law that begins as sqrt(u) + b u is not odd about its leading edge: seen from the other side the second term has the
other sign. There s is replaced in the first piece by p(s) = s + k s^2 (1 - s / s_1)^3 / (1 + c s / s_1)^2, which rises
for every k when c^2 = 1 + (k s_1)^2, keeps two derivatives at the joint s_1, and with k = -b d(sqrt u)/ds makes the
second derivative of the half thickness vanish at the edge, so that the sides have equal second derivatives there.

Nothing is lost where the law is smooth already: R has joints only where the law has.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.outline import Joint
from bladewright.section.thickness.series import Series, joined_series, sine, variable


class Place(NamedTuple):
    """Places on the chord: u, 1 - u and their roots, which change sign with s beyond a round edge."""

    u: Series
    rest: Series
    root: Series | None
    """of u; none where it is not needed: beyond the first piece, or behind an edge that is not round"""
    rest_root: Series | None


class Break(NamedTuple):
    """Where a law is less smooth."""

    u: Array
    """chord fraction (..., m)"""
    rest: Array
    """1 - u (..., m) without cancellation"""
    derivatives: int
    """how many are continuous: 1 or 2"""
    sigma: float
    """where it stands in the fixed coordinate"""


@dataclass(frozen=True, kw_only=True)
class _Piece:
    """R between two joints: rises by `rise` (..., m, 1) over `width`, with slopes at both ends."""

    start: float
    width: float
    low: Array
    rise: Array
    slope_in: Array
    slope_out: Array

    def risen(self, zeta: Series, rest: Series) -> tuple[Series, Series, Series]:
        """R's way from the start over zeta, from the end over 1 - zeta, and their common denominator."""
        secant = self.rise / self.width
        bottom = secant + (self.slope_in + self.slope_out - 2.0 * secant) * (zeta * rest)
        return secant * zeta + self.slope_in * rest, secant * rest + self.slope_out * zeta, bottom


class Stations:
    """The map u(s) of sections (..., m) with given breaks, one or more and increasing, and round edges or not.

    Two breaks of two derivatives must not be neighbours.
    """

    def __init__(
        self, breaks: Sequence[Break], *, leading_round: bool, trailing_round: bool, bend: Array | None = None
    ) -> None:
        """`bend` (..., m) is b of a half thickness that begins as sqrt(u) + b u at a round leading edge."""
        self.breaks = tuple(breaks)
        self.leading_round, self.trailing_round = leading_round, trailing_round
        self.joints = tuple(Joint(self._placed(each.sigma), each.derivatives) for each in self.breaks)
        self.ends = np.array([each.s for each in self.joints])
        self._pieces = _pieces(self.breaks)
        self._skew = None if bend is None else -bend[..., None] * self._root_slope()

    def _root_slope(self) -> Array:
        """d(sqrt u)/ds (..., m, 1) at a round leading edge."""
        start = self._pieces[0].slope_in
        return np.sqrt(start) * (0.5 * np.pi if self.trailing_round else np.sqrt(0.125) * np.pi)

    def _skewed(self, s: Series) -> Series:
        """p(s) in the first piece."""
        if self._skew is None:
            return s
        x = s * (1.0 / self.ends[0])
        drawn = x * np.sqrt(1.0 + (self._skew * self.ends[0]) ** 2) + 1.0
        rest = 1.0 - x
        return s + self._skew * (s * s * rest * rest * rest / (drawn * drawn))

    def _placed(self, sigma: float) -> float:
        """The s of a sigma."""
        if self.leading_round and self.trailing_round:
            return float(2.0 / np.pi * np.arcsin(np.sqrt(sigma)))
        if self.leading_round:
            return float(2.0 / np.pi * np.arccos(1.0 - sigma))
        return float(2.0 / np.pi * np.arcsin(sigma)) if self.trailing_round else sigma

    def pieces_of(self, s: Reals) -> list[tuple[int, Reals]]:
        """Indices of pieces and the places s on each, in the order of s, which must not fall."""
        owner = np.searchsorted(self.ends, s)
        return [(int(k), s[owner == k]) for k in np.unique(owner)]

    def place(self, piece: int, s: Reals, order: int) -> Place:
        """Series in s of the place on a piece at s (k,), which may lie beyond the piece's ends."""
        each = self._pieces[piece]
        at, back = variable(s, order), variable(1.0 - s, order, -1.0)
        if piece == 0:
            at = self._skewed(at)
        sigma, rest = _fixed(at, back, leading=self.leading_round, trailing=self.trailing_round)
        # near an edge the distance from it is what the root is taken of
        end = each.start + each.width
        ahead = sigma[0] if piece == 0 else sigma[0] - each.start
        last = piece == len(self.breaks)
        behind = rest[0] if last else end - sigma[0]
        zeta, omega = ahead / each.width, behind / each.width
        top, back, bottom = each.risen(zeta, omega)
        factor, factor_back = each.rise * top / bottom, each.rise * back / bottom
        u, left = each.low + factor * zeta, (1.0 - each.low - each.rise) + factor_back * omega
        if piece == 0:
            u = factor * zeta
        if last:
            left = factor_back * omega
        root = (factor / each.width).sqrt() * sigma[1] if piece == 0 and sigma[1] is not None else None
        rest_root = (factor_back / each.width).sqrt() * rest[1] if last and rest[1] is not None else None
        return Place(u, left, root, rest_root)

    def u(self, s: Reals, order: int = 0) -> Series:
        """Series in s of u at s (k,), which must not fall."""
        return joined_series([self.place(piece, part, order).u for piece, part in self.pieces_of(s)])


Rooted = tuple[Series, Series | None]


def _fixed(s: Series, back: Series, *, leading: bool, trailing: bool) -> tuple[Rooted, Rooted]:
    """Series of sigma(s) and, for s = 1 - back, of 1 - sigma, each with its signed root where the edge is round."""
    half, quarter = 0.5 * np.pi, 0.25 * np.pi
    if leading and trailing:
        first, last = sine(half * s), sine(half * back)
        return (first * first, first), (last * last, last)
    if leading:
        first = sine(quarter * s) * np.sqrt(2.0)
        return (first * first, first), (sine(half * back), None)
    if trailing:
        last = sine(quarter * back) * np.sqrt(2.0)
        return (sine(half * s), None), (last * last, last)
    return (s, None), (back, None)


def _pieces(breaks: tuple[Break, ...]) -> list[_Piece]:
    sigmas = np.array([0.0, *[each.sigma for each in breaks], 1.0])
    widths = np.diff(sigmas)
    lows = [np.zeros((1, 1)), *[each.u[..., None] for each in breaks]]
    rises = [high - low for low, high in pairwise(lows)]
    rises.append(breaks[-1].rest[..., None])
    secants = [rise / width for rise, width in zip(rises, widths, strict=True)]
    slopes: list[Array] = [secants[0], *[np.zeros(())] * len(breaks), secants[-1]]
    once = [k for k, each in enumerate(breaks, 1) if each.derivatives == 1]
    for k in once:
        slopes[k] = 2.0 * secants[k - 1] * secants[k] / (secants[k - 1] + secants[k])
    for k in (k for k in range(1, len(breaks) + 1) if k not in once):
        slopes[k] = _smooth_slope(widths[k - 1 : k + 1], secants[k - 1 : k + 1], slopes[k - 1], slopes[k + 1])
    return [
        _Piece(
            start=sigmas[k], width=widths[k], low=lows[k], rise=rises[k], slope_in=slopes[k], slope_out=slopes[k + 1]
        )
        for k in range(len(rises))
    ]


def _smooth_slope(widths: Reals, secants: Sequence[Array], before: Array, after: Array) -> Array:
    """The slope at a joint that makes the second derivative continuous, the positive root of a quadratic.

    Reference: Delbourgo and Gregory 1983, SIAM J. Sci. Stat. Comput. 4, eq. 2.11.
    """
    a, b = 1.0 / (widths[0] * secants[0]), 1.0 / (widths[1] * secants[1])
    linear = a * before + b * after - (1.0 / widths[0] + 1.0 / widths[1])
    constant = secants[0] / widths[0] + secants[1] / widths[1]
    quadratic = a + b
    return 2.0 * constant / (linear + np.sqrt(linear**2 + 4.0 * quadratic * constant))
