"""Thickness laws made of pieces along the chord, and the map u(s) that puts their joints at fixed s."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span
from bladewright.section.outline import Joint
from bladewright.section.power_series import Series, joined_series, sine, variable
from bladewright.section.thickness.law import EdgeKind, Thickness


class ChordPlace(NamedTuple):
    """Places on the chord: u, 1 - u and their roots, which change sign with s beyond a round edge."""

    u: Series
    rest: Series
    root: Series | None
    """of u; none where it is not needed: beyond the first piece, or behind an edge that is not round"""
    rest_root: Series | None


class Breakpoint(NamedTuple):
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
class _RationalPiece:
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


class ChordMap:
    """The map u(s) of sections (..., m) with given breaks, one or more and increasing, and round edges or not.

    Two breaks of two derivatives must not be neighbours.
    """

    def __init__(
        self, breaks: Sequence[Breakpoint], *, leading_round: bool, trailing_round: bool, bend: Array | None = None
    ) -> None:
        """`bend` (..., m) is b of a half thickness that begins as sqrt(u) + b u at a round leading edge."""
        self.breaks = tuple(breaks)
        self.leading_round, self.trailing_round = leading_round, trailing_round
        self.joints = tuple(Joint(self._placed(each.sigma), each.derivatives) for each in self.breaks)
        self.ends = np.array([each.s for each in self.joints])
        self._pieces = _rational_pieces(self.breaks)
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

    def place(self, piece: int, s: Reals, order: int) -> ChordPlace:
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
        return ChordPlace(u, left, root, rest_root)

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


def _rational_pieces(breaks: tuple[Breakpoint, ...]) -> list[_RationalPiece]:
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
        _RationalPiece(
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


Formula = Callable[[ChordPlace], Series]
"""half thickness at a place"""

PLACES = np.linspace(0.0, 1.0, 97)[1:-1]
"""where the half thickness is asked to be positive"""


class PiecewiseThickness(Thickness):
    """One formula a piece, between the breaks of the stations."""

    def __init__(self, stations: ChordMap, pieces: Sequence[Formula], *, leading: EdgeKind, trailing: EdgeKind) -> None:
        self._stations, self._formulas = stations, tuple(pieces)
        self._leading, self._trailing = leading, trailing

    @property
    def joints(self) -> tuple[Joint, ...]:
        return self._stations.joints

    @property
    def leading(self) -> EdgeKind:
        return self._leading

    @property
    def trailing(self) -> EdgeKind:
        return self._trailing

    def series(self, s: Reals, order: int) -> tuple[Series, Series]:
        found = [(k, self._stations.place(k, part, order)) for k, part in self._stations.pieces_of(s)]
        half = joined_series([self._formulas[k](place) for k, place in found])
        return joined_series([place.u for _, place in found]), half

    def half_at(self, u: Reals) -> Array:
        zero = Series([np.zeros(())])
        place = ChordPlace(zero + u, zero + (1.0 - u), zero + np.sqrt(u), zero + np.sqrt(1.0 - u))
        half = _safely(self._formulas[0], place)
        for k, each in enumerate(self._stations.breaks):
            later = np.real(u) > np.real(each.u)[..., None]
            half = np.where(later, _safely(self._formulas[k + 1], place), half)
        return half

    def parted(self, further: Sequence[Breakpoint]) -> "PiecewiseThickness":
        """The same thickness with further joints at fixed s, those of a meanline that it is laid on.

        Raises ValueError where the breaks do not stand in the order of their fixed coordinates in every section.
        """
        own = self._stations.breaks
        breaks = sorted((*own, *further), key=lambda each: each.sigma)
        places = np.stack(np.broadcast_arrays(*[np.real(each.u) for each in breaks]))
        if np.any(np.diff(places, axis=0) <= 0.0):
            raise ValueError("breaks change their order")
        owners = [sum(each.sigma <= start for each in own) for start in (0.0, *(each.sigma for each in breaks))]
        ends = self._stations
        stations = ChordMap(breaks, leading_round=ends.leading_round, trailing_round=ends.trailing_round)
        last = len(owners) - 1
        formulas = [_anywhere(self._formulas[k], front=i > 0, rear=i < last) for i, k in enumerate(owners)]
        return PiecewiseThickness(stations, formulas, leading=self._leading, trailing=self._trailing)


def _anywhere(formula: Formula, *, front: bool, rear: bool) -> Formula:
    """A formula also in a part of its piece that no longer reaches the edge in front or behind whose root it takes."""

    def half(place: ChordPlace) -> Series:
        place = place._replace(root=place.u.sqrt()) if front else place
        return formula(place._replace(rest_root=place.rest.sqrt()) if rear else place)

    return half


def _safely(formula: Formula, place: ChordPlace) -> Array:
    """Values of a formula outside its piece as well, where they are not used."""
    with np.errstate(invalid="ignore"):
        return formula(place).value


def ellipse(length: Array, height: Array, *, leading: bool) -> Formula:
    """The round end of semi-axes `length` along the chord and `height` across (..., m), its tip at the edge."""
    ratio, diameter = (height / length)[..., None], 2.0 * length[..., None]

    def half(place: ChordPlace) -> Series:
        distance, root = (place.u, place.root) if leading else (place.rest, place.rest_root)
        if root is None:
            raise ValueError("an ellipse needs a round edge")  # a law that forgot to say so
        return ratio * root * (diameter - distance).sqrt()

    return half


def check_positive(thickness: Thickness, path: str, span: Span) -> None:
    """Refuse a half thickness that is not positive inside a section; raises DesignError with the place."""
    u, half = (np.real(each.value) for each in thickness.series(PLACES, 0))
    u, half = np.broadcast_arrays(u, half)
    if np.all(half > 0.0):
        return
    worst = np.unravel_index(np.argmin(half), half.shape)
    place = span.v[worst[-2]] if half.shape[-2] == len(span.v) else span.v[0]
    raise DesignError(
        f"{path} gives a half thickness of {half[worst]:.3g} chords at u = {u[worst]:.3g}, span fraction {place:.4g}: "
        f"it must be positive; raise the maximum thickness or the thickness of the edge nearby"
    )
