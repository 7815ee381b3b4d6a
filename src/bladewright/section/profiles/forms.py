"""Thickness forms: half thicknesses over the chord as functions of the root of x, which are analytic at the nose."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bladewright.numerics.elementary import Array
from bladewright.section.thickness.series import Series, polynomial


class Form(ABC):
    """Half thicknesses T(x) = a1 sqrt(x) + a2 x + ... of sections (...), in chords."""

    bend: float
    """-a2 / a1, the same for all sections, not negative"""
    end: Array
    """T(1) (..., 1)"""

    @abstractmethod
    def half(self, root: Series) -> Series:
        """T at sqrt(x) (..., k)."""


@dataclass(frozen=True, kw_only=True)
class Powers(Form):
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
class Chebyshev(Form):
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
