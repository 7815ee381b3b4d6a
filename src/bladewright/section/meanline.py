"""Meanlines of sections as functions v(u) over the chord, from (0, 0) to (1, 0), many at once."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bladewright.numerics.elementary import Array, concatenated
from bladewright.nurbs.basis import Reals
from bladewright.section.chord_map import Breakpoint
from bladewright.section.chord_spline import by_abscissa

UNIFORM_CUBIC = (
    np.array([[1.0, 4.0, 1.0, 0.0], [-3.0, 0.0, 3.0, 0.0], [3.0, -6.0, 3.0, 0.0], [-1.0, 3.0, -3.0, 1.0]]) / 6
)
"""powers (rows) of the uniform cubic B-spline's four basis functions on a segment"""
STRAIGHT = (0.10, 0.05)
"""lengths of the straight ends of a mixed meanline at the leading and at the trailing edge [chords], as in T-Blade3"""
STRAIGHT_AT = (0.1, 0.95)
"""sigma of these ends in the map u(s): their chord fractions in a usual blade, where the map is then the identity"""


class Meanline(ABC):
    """Meanlines (..., m) in chords: v(0) = v(1) = 0, slopes measured from the chord line."""

    @property
    @abstractmethod
    def angle_in(self) -> Array:
        """Camber angle chi (..., m) at the leading edge, from the chord line [rad]."""

    @property
    @abstractmethod
    def angle_out(self) -> Array:
        """Camber angle chi (..., m) at the trailing edge, from the chord line [rad]."""

    @property
    @abstractmethod
    def joints(self) -> Array:
        """Chord fractions (..., m, j), rising, where `smooth` derivatives of v are continuous and the next is not."""

    @property
    @abstractmethod
    def smooth(self) -> int:
        """How many derivatives are continuous at the joints."""

    @abstractmethod
    def derivatives(self, u: Array) -> tuple[Array, Array, Array, Array]:
        """v and its first three derivatives (..., m, k) at u (..., m, k) or (k,) in [0, 1]."""

    @abstractmethod
    def fourth(self, u: Array) -> Array:
        """The fourth derivative of v (..., m, k) there."""

    @property
    def kinks(self) -> tuple[Breakpoint, ...]:
        """Those of the joints at which the second derivative jumps, so that both sides have kinks; mostly none."""
        return ()

    def of_first_section(self, u: Array) -> tuple[Array, Array, Array]:
        """v and its first two derivatives (..., k) at u (..., k) of the first section."""
        value, slope, bend, _ = self.derivatives(u)
        return value[..., 0, :], slope[..., 0, :], bend[..., 0, :]


def backward(places: Reals) -> NDArray[np.bool_]:
    """Which steps (..., n - 1) of control points' places (..., n) keep u(t) of their spline from rising.

    A step may be zero between two inner places, but not at an end nor beside another such step: there u'(t) would be
    zero at a joint.
    """
    steps = np.diff(places, axis=-1)
    still = steps == 0.0
    lone = still & ~np.roll(still, 1, axis=-1)
    lone[..., [0, -1]] = False
    return np.asarray((steps <= 0.0) & ~lone)


@dataclass(frozen=True, kw_only=True, eq=False)
class CurvedMeanline(Meanline):
    """The meanline whose second derivative is kappa S(u), kappa so that its ends include the given camber.

    S is the cubic B-spline curve (u(t), S(t)) on the uniform basis; the control polygon is extended at both ends, so
    that the curve meets its first and last control point. With the integrals I of S and J of I from the leading edge,
    v' = kappa (I - J1), v = kappa (J - u J1), J1 = J(1). All is exact: between two joints u and S are cubic in t, I and
    J of degree six and nine. Reference: Nemnem et al. 2014, eqs. 5, 6, 9, 10 and 13, with `scale` in closed form in the
    place of their secant iteration.
    """

    places: Array
    """u (..., m, n) of the control points, rising from 0 to 1, none of their steps `backward`"""
    values: Array
    """S (..., m, n) of the control points"""
    camber: Array
    """chi_out - chi_in (..., m) [rad]"""

    @cached_property
    def _powers(self) -> Array:
        """Coefficients (..., m, n - 1, powers of t, 4) of u, S, I and J on each segment."""
        u, s = (_segments(each) for each in np.broadcast_arrays(self.places, self.values))
        slope = u[..., 1:] * np.arange(1.0, 4.0)
        first = _accumulated(_product(s, slope))
        second = _accumulated(_product(first, slope))
        padded = [np.pad(each, [(0, 0)] * (each.ndim - 1) + [(0, 10 - each.shape[-1])]) for each in (u, s, first)]
        return np.stack([*padded, second], axis=-1)

    @cached_property
    def _totals(self) -> tuple[Array, Array]:
        """I and J (..., m) over the whole chord."""
        ends = np.sum(self._powers[..., -1, :, 2:], axis=-2)
        return ends[..., 0], ends[..., 1]

    @cached_property
    def _scale_and_largest(self) -> tuple[Array, Reals]:
        return _camber_scale(self._totals, self.camber)

    @property
    def scale(self) -> Array:
        """kappa (..., m); nan where no kappa gives the camber."""
        return self._scale_and_largest[0]

    @property
    def largest_camber(self) -> Reals:
        """The most (...) that meanlines of this S turn [rad], where `scale` is nan."""
        return self._scale_and_largest[1]

    @property
    def angle_in(self) -> Array:
        return np.arctan(-self.scale * self._totals[1])

    @property
    def angle_out(self) -> Array:
        first, second = self._totals
        return np.arctan(self.scale * (first - second))

    @property
    def joints(self) -> Array:
        return self._powers[..., 1:, 0, 0]

    @property
    def smooth(self) -> int:
        return 4

    def integrals(self, u: Array) -> tuple[Array, Array, Array, Array]:
        """J, I, S and dS/du (..., m, k) at u (..., m, k) or (k,)."""
        value, rate, _ = by_abscissa(self._powers, u)
        return value[..., 3], value[..., 2], value[..., 1], rate[..., 1] / rate[..., 0]

    def derivatives(self, u: Array) -> tuple[Array, Array, Array, Array]:
        second, first, bend, slope = self.integrals(u)
        whole, kappa = self._totals[1][..., None], self.scale[..., None]
        return kappa * (second - u * whole), kappa * (first - whole), kappa * bend, kappa * slope

    def fourth(self, u: Array) -> Array:
        _, rate, bend = by_abscissa(self._powers, u)
        second = (bend[..., 1] - rate[..., 1] / rate[..., 0] * bend[..., 0]) / rate[..., 0] ** 2
        return np.asarray(self.scale[..., None] * second)


def _camber_scale(totals: tuple[Array, Array], camber: Array) -> tuple[Array, Reals]:
    """The scale kappa (..., m) that gives meanlines the camber chi_out - chi_in [rad], and the largest there is (...).

    `totals` are I1 and J1. With P = J1 (I1 - J1), the tangent of chi_out - chi_in is kappa I1 / (1 - kappa^2 P):

        P sin(camber) kappa^2 + I1 cos(camber) kappa - sin(camber) = 0.

    Where P >= 0, exactly one root belongs to the camber rather than to the camber less 180 deg. Where P < 0, the
    meanline leaves both edges to the same side of the chord line, and there are two roots or none: taken is the
    smaller, which goes to the straight line as the camber goes to zero. No camber gives kappa = 0 whatever the law,
    also where I1 = 0 and every kappa would do. Where no root is, kappa is nan, and the largest camber [rad] is below
    the one asked for.
    """
    first, second = totals
    product = second * (first - second)
    sine, cosine = np.sin(camber), np.cos(camber)
    linear = first * cosine
    square = linear**2 + 4.0 * product * sine**2
    inflected = np.real(product) < 0.0
    with np.errstate(invalid="ignore", divide="ignore"):
        to_inflection = np.arctan(np.sqrt(np.real(first) ** 2 / (-4.0 * np.real(product))))
        largest = np.where(inflected, to_inflection, np.where(np.real(first) == 0.0, 0.0, np.pi))
        none = inflected & ((np.real(square) < 0.0) | (np.real(cosine) <= 0.0)) | (np.real(first) == 0.0)
        side = np.where(np.real(first) < 0.0, -1.0, 1.0)
        root = side * np.sqrt(np.where(none, 1.0, square))
        direct = 2.0 * sine / np.where(none, 1.0, linear + root)
        other = (root - linear) / np.where(none | (np.real(cosine) >= 0.0), 1.0, 2.0 * product * sine)
    scale = np.where(np.real(cosine) >= 0.0, direct, other)
    straight = np.real(sine) == 0.0
    return np.where(none, np.where(straight, 0.0 * scale, np.nan), scale), largest


@dataclass(frozen=True, kw_only=True, eq=False)
class MixedMeanline(Meanline):
    """A meanline of two straight ends and a cubic between, which meets them with their slopes.

    The ends are `STRAIGHT` chords long and lie along the metal angles.
    """

    angles: tuple[Array, Array]
    """chi (..., m) at the leading and at the trailing edge [rad]"""

    @property
    def angle_in(self) -> Array:
        return self.angles[0]

    @property
    def angle_out(self) -> Array:
        return self.angles[1]

    @property
    def joints(self) -> Array:
        ends = np.broadcast_arrays(STRAIGHT[0] * np.cos(self.angles[0]), 1.0 - STRAIGHT[1] * np.cos(self.angles[1]))
        return np.stack(ends, axis=-1)

    @property
    def smooth(self) -> int:
        return 1

    @property
    def kinks(self) -> tuple[Breakpoint, ...]:
        first, last = self.joints[..., 0], self.joints[..., 1]
        return (
            Breakpoint(first, 1.0 - first, 1, STRAIGHT_AT[0]),
            Breakpoint(last, STRAIGHT[1] * np.cos(self.angle_out), 1, STRAIGHT_AT[1]),
        )

    def derivatives(self, u: Array) -> tuple[Array, Array, Array, Array]:
        low, high = self.joints[..., :1], self.joints[..., 1:]
        steep, flat = (np.tan(each)[..., None] for each in self.angles)
        span = high - low
        rise = flat * (high - 1.0) - steep * low
        # the cubic's coefficients in w = u - low
        bend = (3.0 * rise / span - 2.0 * steep - flat) / span
        twist = (steep + flat - 2.0 * rise / span) / span**2
        w = u - low
        ahead, behind = np.real(w) < 0.0, np.real(u) > np.real(high)
        zero = 0.0 * (w + steep + flat)

        def chosen(first: Array, middle: Array, last: Array) -> Array:
            return np.where(ahead, first, np.where(behind, last, middle)) + zero

        return (
            chosen(steep * u, steep * low + w * (steep + w * (bend + w * twist)), flat * (u - 1.0)),
            chosen(steep, steep + w * (2.0 * bend + 3.0 * w * twist), flat),
            chosen(zero, 2.0 * bend + 6.0 * w * twist, zero),
            chosen(zero, 6.0 * twist + zero, zero),
        )

    def fourth(self, u: Array) -> Array:
        steep, flat = self.angles
        return 0.0 * (u + (steep + flat)[..., None])


def _segments(points: Array) -> Array:
    """Powers (..., n - 1, 4) on its segments of a curve from the first to the last control point (..., n)."""
    before = 2.0 * points[..., :1] - points[..., 1:2]
    after = 2.0 * points[..., -1:] - points[..., -2:-1]
    extended = concatenated([before, points, after], axis=-1)
    count = points.shape[-1] - 1
    windows = np.stack([extended[..., k : k + count] for k in range(4)], axis=-1)
    return windows @ UNIFORM_CUBIC.T


def _product(a: Array, b: Array) -> Array:
    """Coefficients of the product of polynomials (..., p) and (..., q)."""
    total = np.zeros((*a.shape[:-1], a.shape[-1] + b.shape[-1] - 1), dtype=np.result_type(a, b))
    for k in range(b.shape[-1]):
        total[..., k : k + a.shape[-1]] += a * b[..., k : k + 1]
    return total


def _accumulated(powers: Array) -> Array:
    """Coefficients (..., segments, p + 1) of the integral from the first segment's start on."""
    terms = powers / np.arange(1.0, powers.shape[-1] + 1.0)
    total = np.cumsum(np.sum(terms, axis=-1), axis=-1)
    start = concatenated([np.zeros_like(total[..., :1]), total[..., :-1]], axis=-1)
    return concatenated([start[..., None], terms], axis=-1)
