"""The parameter s of a section on its chord: the map u(s) to the chord fraction, by which joints are at fixed s.

Near a round edge a half thickness grows as the root of the distance from it. Both maps make that root an odd analytic
function of s about the edge, so that a side and its other side are one smooth curve there; at a sharp or blunt edge u
has a slope by s.

Thickness laws in pieces (`ChordMap`). Their joints (the place of the maximum, where an edge's ellipse ends) move with
the parameters and along the span, but those of an outline are at the same s in all sections. So u = R(sigma(s)):

* sigma(s) is fixed: (1 - cos pi s) / 2 between two round edges, 1 - cos(pi s / 2) or sin(pi s / 2) where only one edge
  is round, s where none is.
* R is a rational function on each piece between joints, quadratic over quadratic, that rises whatever the joints
  (Delbourgo and Gregory 1983): through (sigma_j, u_j), with as many continuous derivatives as the law has there, one or
  two. It is the identity where the joints are at their usual places, and analytic in every parameter; it has joints
  only where the law has.

A law that begins as sqrt(u) + b u is not odd about its leading edge: seen from the other side the second term has the
other sign. There s is replaced in the first piece by p(s) = s + k s^2 (1 - s / s_1)^3 / (1 + c s / s_1)^2, which rises
for every k when c^2 = 1 + (k s_1)^2, keeps two derivatives at the joint s_1, and with k = -b d(sqrt u)/ds makes the
second derivative of the half thickness vanish at the edge, so that the sides have equal second derivatives there.

Profiles on a mean line (`clustered_place`) have at most one joint and a published form of thickness; there the steps
of s are clustered towards the edges as well.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.outline import Joint
from bladewright.section.power_series import Series, hyperbolic_tangent, joined_series, sine_and_cosine, variable

JOINT = 0.5
"""s of the joint of a profile's mean line, where it has one: the middle, so that both pieces have equally many points
[-]"""


class ChordPlace(NamedTuple):
    """Chord fractions as power series of s: u, 1 - u and their roots, which change sign with s beyond a round edge."""

    u: Series
    rest: Series
    """1 - u, without cancellation next to the trailing edge"""
    root: Series | None
    """of u; None beyond the first piece, or behind a leading edge that is not round"""
    rest_root: Series | None
    """of 1 - u; None before the last piece, or in front of a trailing edge that is not round"""

    def leading_root(self) -> Series:
        """The root of u, for formulas of the piece behind a round leading edge."""
        if self.root is None:
            raise ValueError("the root of u is known behind a round leading edge only")
        return self.root

    def trailing_root(self) -> Series:
        """The root of 1 - u, for formulas of the piece before a round trailing edge."""
        if self.rest_root is None:
            raise ValueError("the root of 1 - u is known before a round trailing edge only")
        return self.rest_root


class Breakpoint(NamedTuple):
    """A joint of a thickness law or a meanline, before the map gives it its s."""

    u: Array
    """chord fraction (..., m)"""
    rest: Array
    """1 - u (..., m) without cancellation"""
    derivatives: int
    """how many are continuous: 1 or 2"""
    sigma: float
    """its fixed coordinate"""


class ChordMap:
    """The map u(s) of sections (..., m) with one breakpoint or more, increasing, between edges that are round or not.

    Two breakpoints with two continuous derivatives must not be neighbours.
    """

    def __init__(
        self, breaks: Sequence[Breakpoint], *, leading_round: bool, trailing_round: bool, bend: Array | None = None
    ) -> None:
        """`bend` (..., m) is b of a half thickness that begins as sqrt(u) + b u at a round leading edge."""
        self.breaks = tuple(breaks)
        self.leading_round, self.trailing_round = leading_round, trailing_round
        self.joints = tuple(Joint(self._placed(each.sigma), each.derivatives) for each in self.breaks)
        self.ends = np.array([each.s for each in self.joints])
        self._sigmas = np.array([0.0, *[each.sigma for each in self.breaks], 1.0])
        self._widths = np.diff(self._sigmas)
        self._lows = [np.zeros((1, 1)), *[each.u[..., None] for each in self.breaks]]
        self._rises = [high - low for low, high in pairwise(self._lows)] + [self.breaks[-1].rest[..., None]]
        self._slopes = self._slopes_at_sigmas()
        self._skew = None if bend is None else -bend[..., None] * self._root_slope()

    def _slopes_at_sigmas(self) -> list[Array]:
        """Slopes of R (..., m, 1) at both edges and the breakpoints."""
        widths, count = self._widths, len(self.breaks)
        secants = [rise / width for rise, width in zip(self._rises, widths, strict=True)]
        slopes: list[Array] = [secants[0], *[np.zeros(())] * count, secants[-1]]
        once = [k for k, each in enumerate(self.breaks, 1) if each.derivatives == 1]
        for k in once:
            slopes[k] = 2.0 * secants[k - 1] * secants[k] / (secants[k - 1] + secants[k])
        for k in (k for k in range(1, count + 1) if k not in once):
            slopes[k] = _smooth_slope(widths[k - 1 : k + 1], secants[k - 1 : k + 1], slopes[k - 1], slopes[k + 1])
        return slopes

    def _root_slope(self) -> Array:
        """d(sqrt u)/ds (..., m, 1) at a round leading edge."""
        return np.sqrt(self._slopes[0]) * (0.5 * np.pi if self.trailing_round else np.sqrt(0.125) * np.pi)

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
        at, back = variable(s, order), variable(1.0 - s, order, -1.0)
        if piece == 0:
            at = self._skewed(at)
        sigma, rest = _fixed(at, back, leading=self.leading_round, trailing=self.trailing_round)
        # near an edge the distance from it is what the root is taken of
        start, width = self._sigmas[piece], self._widths[piece]
        end, low, rise = start + width, self._lows[piece], self._rises[piece]
        ahead = sigma[0] if piece == 0 else sigma[0] - start
        last = piece == len(self.breaks)
        behind = rest[0] if last else end - sigma[0]
        zeta, omega = ahead / width, behind / width
        # R's way from the start over zeta, from the end over omega = 1 - zeta, and their common denominator
        secant, slope_in, slope_out = rise / width, self._slopes[piece], self._slopes[piece + 1]
        bottom = secant + (slope_in + slope_out - 2.0 * secant) * (zeta * omega)
        factor = rise * (secant * zeta + slope_in * omega) / bottom
        factor_back = rise * (secant * omega + slope_out * zeta) / bottom
        u, left = low + factor * zeta, (1.0 - low - rise) + factor_back * omega
        if piece == 0:
            u = factor * zeta
        if last:
            left = factor_back * omega
        root = (factor / width).sqrt() * sigma[1] if piece == 0 and sigma[1] is not None else None
        rest_root = (factor_back / width).sqrt() * rest[1] if last and rest[1] is not None else None
        return ChordPlace(u, left, root, rest_root)

    def u(self, s: Reals, order: int = 0) -> Series:
        """Series in s of u at s (k,), which must not fall."""
        return joined_series([self.place(piece, part, order).u for piece, part in self.pieces_of(s)])


Rooted = tuple[Series, Series | None]


def _sine(angle: Series) -> Series:
    return sine_and_cosine(angle)[0]


def _fixed(s: Series, back: Series, *, leading: bool, trailing: bool) -> tuple[Rooted, Rooted]:
    """Series of sigma(s) and, for s = 1 - back, of 1 - sigma, each with its signed root where the edge is round."""
    half, quarter = 0.5 * np.pi, 0.25 * np.pi
    if leading and trailing:
        first, last = _sine(half * s), _sine(half * back)
        return (first * first, first), (last * last, last)
    if leading:
        first = _sine(quarter * s) * np.sqrt(2.0)
        return (first * first, first), (_sine(half * back), None)
    if trailing:
        last = _sine(quarter * back) * np.sqrt(2.0)
        return (_sine(half * s), None), (last * last, last)
    return (s, None), (back, None)


def _smooth_slope(widths: Reals, secants: Sequence[Array], before: Array, after: Array) -> Array:
    """The slope at a joint that makes the second derivative continuous, the positive root of a quadratic.

    Reference: Delbourgo and Gregory 1983, SIAM J. Sci. Stat. Comput. 4, eq. 2.11.
    """
    a, b = 1.0 / (widths[0] * secants[0]), 1.0 / (widths[1] * secants[1])
    linear = a * before + b * after - (1.0 / widths[0] + 1.0 / widths[1])
    constant = secants[0] / widths[0] + secants[1] / widths[1]
    quadratic = a + b
    return 2.0 * constant / (linear + np.sqrt(linear**2 + 4.0 * quadratic * constant))


def clustered_place(
    s: Reals,
    order: int,
    *,
    round_end: bool,
    clustering: tuple[float, float],
    stretching: float,
    bend: Array,
    joint: Array | None,
) -> ChordPlace:
    """Places at s (k,) with their derivatives up to an order, by a map that is the same in form for all sections.

    sqrt(x) is analytic and odd about s = 0 but for its second derivative, and so is sqrt(1 - x) about s = 1 where the
    trailing edge is round; elsewhere x runs into s = 1 with a slope. `clustering` are the amplitudes of the sine waves
    that cluster the steps of s at the leading and at a round trailing edge, 0 (none) to below 1 [-]; `stretching` is k
    of the hyperbolic tangent that clusters them at a sharp or blunt one, 0: none [-]. `bend` is -a1 / a0 (..., 1) of a
    thickness a0 sqrt(x) + a1 x + ...: with it the thickness has no second derivative at s = 0. `joint` is x (..., 1) of
    the mean line's joint, which is at s = `JOINT`.
    """
    phase = _clustered_phase(s, order, clustering, stretching)
    sine, cosine = sine_and_cosine(phase)
    if round_end:
        root, before = sine, cosine * cosine
    else:
        # 1 - cos = 2 sin^2 of half the phase, and 1 less that is the cosine
        root, _ = sine_and_cosine(phase * 0.5)
        root, before = root * np.sqrt(2.0), cosine
    ratio: Array | float = 1.0
    if joint is not None:
        middle = float(_clustered_phase(np.array([JOINT]), 0, clustering, stretching).value[0])
        ratio = _joint_ratio(joint, np.sin(middle) ** 2 if round_end else 1.0 - np.cos(middle), bend)
    scale = root * root + before * ratio
    first = root / scale.sqrt()
    lift = first * first * bend + 1.0
    x_root = first * (first * bend + 1.0) / lift
    kept = ratio / scale * (x_root + 1.0) / (first + 1.0) / lift
    end = cosine * kept.sqrt() if round_end else None
    return ChordPlace(u=x_root * x_root, rest=before * kept, root=x_root, rest_root=end)


def _clustered_phase(s: Reals, order: int, clustering: tuple[float, float], stretching: float) -> Series:
    """The angle that runs from 0 to pi / 2; steps clustered at the edges, odd about them."""
    angle = variable(s, order) * np.pi
    once, _ = sine_and_cosine(angle)
    twice, _ = sine_and_cosine(angle * 2.0)
    both = twice * 0.25 * (clustering[0] + clustering[1])
    drawn = both + once * 0.5 * (clustering[0] - clustering[1])
    phase = (angle - drawn) * 0.5
    if not stretching:
        return phase
    return hyperbolic_tangent(phase * (2.0 / np.pi * stretching)) * (0.5 * np.pi / np.tanh(stretching))


def _joint_ratio(joint: Array, at: float, bend: Array) -> Array:
    """Ratio of the projective map of x that brings the joint to its place."""
    root = np.sqrt(joint)
    before_bend = 2.0 * root / (1.0 + np.sqrt(1.0 + 4.0 * bend * (1.0 - root) * root))
    square = before_bend * before_bend
    return np.asarray(at * (1.0 - square) / (square * (1.0 - at)))
