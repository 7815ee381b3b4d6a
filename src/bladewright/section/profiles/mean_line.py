"""Profiles built as the published series are: a half thickness to both sides of a mean line, normal to it."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.chord_map import JOINT, ChordPlace, clustered_place
from bladewright.section.outline import Edge, EdgeDerivatives, Joint, Outline
from bladewright.section.power_series import (
    Series,
    composed,
    differentiated,
    point_derivatives,
    polynomial,
    relative_exponential,
    relative_logarithm,
    variable,
)

END_CLUSTERING = 0.9
"""clustering of s at a round trailing edge, whose cap is a few half thicknesses of the trailing edge long [-]"""
FAR = 0.99
"""1 - x from which on the cap of a round trailing edge is left out: there x^n is below 0.01^20, n being 20 or more
[-]"""

TrailingEdge = Literal["sharp", "blunt", "round"]
Opening = Literal["quartic", "linear"]
"""how half a thickness that is closed becomes one that ends open: by what is added to it, in proportion to x^4 or x"""


class ThicknessForm(ABC):
    """Half thicknesses T(x) = a1 sqrt(x) + a2 x + ... of sections (...), in chords."""

    end: Array
    """T(1) (..., 1)"""

    @property
    @abstractmethod
    def bend(self) -> Array:
        """-a2 / a1 (..., 1), above -1."""

    @abstractmethod
    def half(self, root: Series) -> Series:
        """T at sqrt(x) (..., k)."""


@dataclass(frozen=True, kw_only=True)
class PowerForm(ThicknessForm):
    """A polynomial in sqrt(x)."""

    coefficients: Sequence[Array]
    """(..., 1) of the powers, from the first on"""

    @property
    def bend(self) -> Array:
        """Of the first two coefficients."""
        return np.asarray(-self.coefficients[1] / self.coefficients[0])

    @property
    def end(self) -> Array:  # type: ignore[override]
        """Their sum."""
        return sum(self.coefficients[1:], self.coefficients[0])

    def half(self, root: Series) -> Series:
        """By Horner's rule."""
        return polynomial([np.zeros(()), *self.coefficients], root)


@dataclass(frozen=True, kw_only=True)
class ChebyshevForm(ThicknessForm):
    """sqrt(x) (1 - x) times Chebyshev polynomials of 2 x - 1, and the trailing edge's half thickness times x or x^4."""

    coefficients: Sequence[Array]
    """(..., 1) by degree"""
    end: Array
    opening: Opening

    @property
    def bend(self) -> Array:
        """Of the opening alone, over the polynomial at x = 0, where the one of degree k is (-1)^k."""
        if self.opening == "quartic":
            return np.zeros(())
        nose = sum(self.coefficients[::2]) - sum(self.coefficients[1::2])
        return np.asarray(-self.end / nose)

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
        return root * (1.0 - x) * value + (x if self.opening == "linear" else square * square) * self.end


class ProfileMeanLine(ABC):
    """Mean lines y(x) of sections (...): 0 at x = 0 and at x = 1, in chords."""

    joint: Array | None = None
    """x (..., 1) where two pieces meet"""
    joint_derivatives: int = 0
    """continuous derivatives of the sides there, which have one less than the mean line"""

    @abstractmethod
    def ordinate(self, x: Series, aft: NDArray[np.bool_]) -> Series:
        """y at x (..., k); `aft` (k,) marks those behind the joint."""


@dataclass(frozen=True, kw_only=True)
class MeanLineOutline(Outline):
    """Sections whose half thickness is measured normal to the mean line at x.

    A round trailing edge is the thickness T(x) times sqrt(1 - x^n), n = 2 / (T(1) cos(angle of the mean line there)): a
    nose of the radius T(1), below the blunt profile by more than 1e-3 of itself only over the last 3 T(1) of the chord.
    """

    mean_line: ProfileMeanLine
    thickness: ThicknessForm
    end: TrailingEdge
    clustering: float = 0.0
    """clustering of s at the leading edge, 0 (none) to below 1 [-]"""
    stretching: float = 0.0
    """k of the hyperbolic tangent that clusters s at a sharp or blunt trailing edge; 0: none [-]"""

    def _place(self, s: Reals, order: int) -> ChordPlace:
        return clustered_place(
            s,
            order,
            round_end=self.end == "round",
            clustering=(self.clustering, END_CLUSTERING if self.end == "round" else 0.0),
            stretching=0.0 if self.end == "round" else self.stretching,
            bend=self.thickness.bend,
            joint=self.mean_line.joint,
        )

    def _half(self, place: ChordPlace) -> Series:
        half = self.thickness.half(place.leading_root())
        if place.rest_root is None:
            return half
        return half * place.rest_root * composed(self._cap(place.rest), place.rest).sqrt()

    def _cap(self, rest: Series) -> Series:
        """(1 - x^n) / (1 - x) and its derivatives by 1 - x: half the thickness there, up to the order of `rest`."""
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
        nonzero = np.where(at_edge, 1.0, w)
        left = np.where(far, 0.0, np.exp(-power * near * log))
        first = np.where(at_edge, -0.5 * power * (power - 1.0), (power * left / (1.0 - near) - value) / nonzero)
        bend = -power * (power - 1.0) * left / (1.0 - near) ** 2
        second = np.where(at_edge, power * (power - 1.0) * (power - 2.0) / 3.0, (bend - 2.0 * first) / nonzero)
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
        place = self._place(s, order)
        ordinate, rise = self._line(place.u, s)
        half = self._half(place)
        across = half / (rise * rise + 1.0).sqrt()
        along = across * rise
        return [point_derivatives(place.u - along * sign, ordinate + across * sign) for sign in (1.0, -1.0)]

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., len(s), 2) of the upper and the lower side."""
        upper, lower = self._sides(s, 0)
        return upper[..., 0], lower[..., 0]

    def camber(self, s: Reals) -> Array:
        """Points (..., len(s), 2) of the mean line."""
        x = self._place(s, 0).u
        pair = np.broadcast_arrays(x.value, self._line(x, s)[0].value)
        return np.stack(pair, axis=-1)

    @property
    def leading_edge(self) -> Edge:
        """Round: half the square of the thickness's first coefficient, times the cosine of the mean line there."""
        return self._edge(0, "round")

    @property
    def trailing_edge(self) -> Edge:
        """Sharp, blunt or round, as in the design."""
        return self._edge(-1, self.end)

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The mean line's joint, always at the same s."""
        return () if self.mean_line.joint is None else (Joint(JOINT, self.mean_line.joint_derivatives),)

    @cached_property
    def _sides_at_edges(self) -> list[Array]:
        return self._sides(np.array([0.0, 1.0]), 2)

    def _edge(self, number: int, kind: TrailingEdge) -> Edge:
        upper, lower = (EdgeDerivatives.of_side(side[..., [number], :, :]) for side in self._sides_at_edges)
        return Edge(kind=kind, upper=upper, lower=lower)
