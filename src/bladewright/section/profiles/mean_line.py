"""Profiles built as the published series are: a half thickness to both sides of a mean line, normal to it."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.outline import Edge, Joint, Outline, Start
from bladewright.section.power_series import (
    Series,
    composed,
    differentiated,
    hyperbolic_tangent,
    polynomial,
    relative_exponential,
    relative_logarithm,
    sine_and_cosine,
    variable,
)

JOINT = 0.5
"""s of the mean line's joint, where it has one"""


class ProfilePlace(NamedTuple):
    """Chord fractions as power series of s."""

    root: Series
    """sqrt(x)"""
    x: Series
    rest: Series
    """1 - x, exact next to the trailing edge"""
    end_root: Series | None
    """sqrt(1 - x), where the trailing edge is round"""


@dataclass(frozen=True, kw_only=True)
class ProfileChordMap:
    """The map from s to x, the same in form for all sections.

    sqrt(x) is analytic and odd about s = 0 but for its second derivative, and so is sqrt(1 - x) about s = 1 where the
    trailing edge is round; elsewhere x runs into s = 1 with a slope.
    """

    round_end: bool
    gathered_in: float
    """share of the steps of s drawn towards the leading edge, 0 to below 1"""
    gathered_out: float
    """the same at a round trailing edge"""
    crowded: float
    """k of the hyperbolic tangent that crowds the steps exponentially at a trailing edge that is not round; 0: none"""
    bend: float
    """-a1 / a0 of a thickness a0 sqrt(x) + a1 x + ...: with it the thickness has no second derivative at s = 0"""
    joint: Array | None
    """x (..., 1) that stands at s = `JOINT`"""

    def at(self, s: Reals, order: int) -> ProfilePlace:
        """Places at s (k,) with their derivatives up to an order."""
        sine, cosine = sine_and_cosine(self._phase(s, order))
        if self.round_end:
            root, before = sine, cosine * cosine
        else:
            # 1 - cos = 2 sin^2 of half the phase, and 1 less that is the cosine
            root, _ = sine_and_cosine(self._phase(s, order) * 0.5)
            root, before = root * np.sqrt(2.0), cosine
        ratio: Array | float = 1.0 if self.joint is None else self._ratio(self.joint)
        scale = root * root + before * ratio
        first = root / scale.sqrt()
        lift = first * first * self.bend + 1.0
        x_root = first * (first * self.bend + 1.0) / lift
        kept = ratio / scale * (x_root + 1.0) / (first + 1.0) / lift
        end = cosine * kept.sqrt() if self.round_end else None
        return ProfilePlace(root=x_root, x=x_root * x_root, rest=before * kept, end_root=end)

    def _phase(self, s: Reals, order: int) -> Series:
        """The angle that runs from 0 to pi / 2; steps gathered at the edges, odd about them."""
        angle = variable(s, order) * np.pi
        once, _ = sine_and_cosine(angle)
        twice, _ = sine_and_cosine(angle * 2.0)
        both = twice * 0.25 * (self.gathered_in + self.gathered_out)
        drawn = both + once * 0.5 * (self.gathered_in - self.gathered_out)
        phase = (angle - drawn) * 0.5
        if not self.crowded:
            return phase
        return hyperbolic_tangent(phase * (2.0 / np.pi * self.crowded)) * (0.5 * np.pi / np.tanh(self.crowded))

    def _ratio(self, joint: Array) -> Array:
        """What brings the joint to its s: a projective map of x."""
        middle = float(self._phase(np.array([JOINT]), 0).value[0])
        at = np.sin(middle) ** 2 if self.round_end else 1.0 - np.cos(middle)
        root = np.sqrt(joint)
        before_bend = 2.0 * root / (1.0 + np.sqrt(1.0 + 4.0 * self.bend * (1.0 - root) * root))
        square = before_bend * before_bend
        ratio: Array = at * (1.0 - square) / (square * (1.0 - at))
        return ratio


class ThicknessForm(ABC):
    """Half thicknesses T(x) = a1 sqrt(x) + a2 x + ... of sections (...), in chords."""

    bend: float
    """-a2 / a1, the same for all sections, not negative"""
    end: Array
    """T(1) (..., 1)"""

    @abstractmethod
    def half(self, root: Series) -> Series:
        """T at sqrt(x) (..., k)."""


@dataclass(frozen=True, kw_only=True)
class PowerForm(ThicknessForm):
    """A polynomial in sqrt(x)."""

    coefficients: Sequence[Array]
    """(..., 1) of the powers, from the first on"""
    bend: float

    @property
    def end(self) -> Array:  # type: ignore[override]
        """Their sum."""
        return sum(self.coefficients[1:], self.coefficients[0])

    def half(self, root: Series) -> Series:
        """By Horner's rule."""
        return polynomial([np.zeros(()), *self.coefficients], root)


@dataclass(frozen=True, kw_only=True)
class ChebyshevForm(ThicknessForm):
    """sqrt(x) (1 - x) times Chebyshev polynomials of 2 x - 1, and x^4 times the half thickness of the trailing edge."""

    coefficients: Sequence[Array]
    """(..., 1) by degree"""
    end: Array
    bend: float = 0.0

    def half(self, root: Series) -> Series:
        """By Clenshaw's recurrence."""
        x = root * root
        twice = x * 4.0 - 2.0
        later: Series = root * 0.0
        value: Series = later + self.coefficients[-1]
        for each in reversed(self.coefficients[1:-1]):
            value, later = twice * value - later + each, value
        value = twice * 0.5 * value - later + self.coefficients[0]
        square = x * x
        return root * (1.0 - x) * value + square * square * self.end


TrailingEdge = Literal["sharp", "blunt", "round"]

GATHERED = 0.9
"""share of the steps of s drawn towards an edge that is small"""
FAR = 0.99
"""1 - x from which on a round trailing edge is not felt"""


class MeanLine(ABC):
    """Mean lines y(x) of sections (...): 0 at x = 0 and at x = 1, in chords."""

    joint: Array | None = None
    """x (..., 1) where two pieces meet"""
    joint_derivatives: int = 0
    """continuous derivatives of the sides there, which have one less than the mean line"""

    @abstractmethod
    def ordinate(self, x: Series, aft: NDArray[np.bool_]) -> Series:
        """y at x (..., k); `aft` (k,) says which lie behind the joint."""


@dataclass(frozen=True, kw_only=True)
class MeanLineOutline(Outline):
    """Sections whose half thickness is measured normal to the mean line at x.

    A round trailing edge is the thickness T(x) times sqrt(1 - x^n), n = 2 / (T(1) cos(angle of the mean line there)): a
    nose of the radius T(1), below the blunt profile by more than 1e-3 of itself only over the last 3 T(1) of the chord.
    """

    mean_line: MeanLine
    thickness: ThicknessForm
    end: TrailingEdge
    gathered: float = 0.0
    """share of the steps of s drawn towards the leading edge"""
    crowded: float = 0.0
    """how the steps crowd at a sharp or blunt trailing edge"""

    @cached_property
    def _places(self) -> ProfileChordMap:
        return ProfileChordMap(
            round_end=self.end == "round",
            gathered_in=self.gathered,
            gathered_out=GATHERED if self.end == "round" else 0.0,
            crowded=0.0 if self.end == "round" else self.crowded,
            bend=self.thickness.bend,
            joint=self.mean_line.joint,
        )

    def _half(self, place: ProfilePlace) -> Series:
        half = self.thickness.half(place.root)
        if place.end_root is None:
            return half
        return half * place.end_root * composed(self._cap(place.rest), place.rest).sqrt()

    def _cap(self, rest: Series) -> Series:
        """(1 - x^n) / (1 - x) and its derivatives by 1 - x: half the thickness there, as far as they are asked for."""
        power = 2.0 / self.thickness.end * self._steepness
        w = rest.value
        # so far from the edge x^n vanishes, and its logarithm may not be taken at x = 0
        far = np.real(w) > FAR
        near = np.where(far, FAR, w)
        log = relative_logarithm(-near)
        value = np.where(far, 1.0 / np.where(far, w, 1.0), relative_exponential(-power * near * log) * power * log)
        if rest.order == 0:
            return Series([value])
        at_edge = np.real(w) == 0.0
        apart = np.where(at_edge, 1.0, w)
        left = np.where(far, 0.0, np.exp(-power * near * log))
        first = np.where(at_edge, -0.5 * power * (power - 1.0), (power * left / (1.0 - near) - value) / apart)
        bend = -power * (power - 1.0) * left / (1.0 - near) ** 2
        second = np.where(at_edge, power * (power - 1.0) * (power - 2.0) / 3.0, (bend - 2.0 * first) / apart)
        return Series([value, first, 0.5 * second])

    @cached_property
    def _steepness(self) -> Array:
        """1 / cos of the mean line's angle at the trailing edge (..., 1): x runs slower there than the mean line."""
        line = self.mean_line.ordinate(variable(np.ones(1), 1), np.ones(1, dtype=bool))
        return np.sqrt(1.0 + line.coefficients[1] ** 2)

    def _line(self, x: Series, s: Reals) -> tuple[Series, Series]:
        """Ordinate and slope of the mean line as series of s."""
        aft = s > JOINT
        at = variable(x.value, x.order + 1)
        ordinate = self.mean_line.ordinate(at, aft)
        return composed(ordinate, x), composed(differentiated(ordinate), x)

    def _sides(self, s: Reals, order: int) -> list[Array]:
        """Points and their derivatives by s, (..., k, 2, order + 1), of both sides."""
        place = self._places.at(s, order)
        ordinate, rise = self._line(place.x, s)
        half = self._half(place)
        across = half / (rise * rise + 1.0).sqrt()
        along = across * rise
        sides = []
        for sign in (1.0, -1.0):
            pair = [(place.x - along * sign).derivatives(), (ordinate + across * sign).derivatives()]
            sides.append(np.stack(np.broadcast_arrays(*pair), axis=-2))
        return sides

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., len(s), 2) of the upper and the lower side."""
        upper, lower = self._sides(s, 0)
        return upper[..., 0], lower[..., 0]

    def camber(self, s: Reals) -> Array:
        """Points (..., len(s), 2) of the mean line."""
        x = self._places.at(s, 0).x
        pair = np.broadcast_arrays(x.value, self._line(x, s)[0].value)
        return np.stack(pair, axis=-1)

    @property
    def leading_edge(self) -> Edge:
        """Round: half the square of the thickness's first coefficient, times the cosine of the mean line there."""
        return self._edge(0.0, "round")

    @property
    def trailing_edge(self) -> Edge:
        """Sharp, blunt or round, as asked."""
        return self._edge(1.0, self.end)

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The mean line's joint, always at the same s."""
        return () if self.mean_line.joint is None else (Joint(JOINT, self.mean_line.joint_derivatives),)

    def _edge(self, s: float, kind: TrailingEdge) -> Edge:
        starts = [Start(*(side[..., 0, :, k] for k in range(3))) for side in self._sides(np.array([s]), 2)]
        return Edge(kind=kind, upper=starts[0], lower=starts[1])
