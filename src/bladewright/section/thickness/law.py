"""What every thickness law is: parameters along the span that give half thicknesses along the chord, exactly.

A law is a part of a design; `at(span)` takes it at places along the span and gives a `Thickness`, which many sections
share: arrays (..., m, k), leading batch axes before the m places along the span, k places along the chord. Those are
given by the parameter s of the outline; `bladewright.section.chord_map` chooses u(s) so that each law's joints are at
fixed s.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from bladewright.designs import Law, Limits, Part
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.chord_map import Breakpoint
from bladewright.section.laws import Span, law_points, same_kind
from bladewright.section.outline import Joint
from bladewright.section.power_series import Series

MAXIMUM = Limits(0.0, 1.0, "it must be between 0 and 1 chord")
MAXIMUM_AT = Limits(0.05, 0.95, "the maximum must stand between 0.05 and 0.95 of the chord")
EDGE = Limits(0.0, 1.0, "it must be positive; for none leave it out and make the edge sharp")
POSITIVE = Limits(0.0, float("inf"), "it must be positive")

EdgeKind = Literal["round", "sharp", "blunt"]


class Thickness(ABC):
    """Half thicknesses of sections (..., m) in chords, on both sides of the camber line and normal to it.

    Between the joints u and the half thickness are analytic in s. At a round edge u is even and the half thickness odd
    in the distance by s from it up to their second derivatives at least, so that the sides join with opposite first and
    equal second derivatives.
    """

    @property
    @abstractmethod
    def joints(self) -> tuple[Joint, ...]:
        """Places s inside (0, 1), increasing, and how many derivatives by s are continuous there."""

    @property
    @abstractmethod
    def leading(self) -> EdgeKind:
        """How the sides meet at s = 0: blunt where the half thickness is positive there."""

    @property
    @abstractmethod
    def trailing(self) -> EdgeKind:
        """How the sides meet at s = 1."""

    @abstractmethod
    def series(self, s: Reals, order: int) -> tuple[Series, Series]:
        """Power series about s (k,), not falling, of the chord fraction u and of the half thickness, (..., m, k)."""

    @abstractmethod
    def with_breakpoints(self, further: Sequence[Breakpoint]) -> Thickness:
        """The same thickness with further joints at fixed s, those of a meanline.

        Raises DesignError for a thickness in one piece, and ValueError where the breakpoints are not in the order
        of their fixed coordinates in every section.
        """

    @abstractmethod
    def half_at(self, u: Reals) -> Array:
        """Half thicknesses (..., m, k) at chord fractions u (k,) or (..., m, k) in [0, 1]."""

    def u(self, s: Reals) -> Array:
        """Chord fractions (..., m, k) at s (k,), rising from 0 to 1."""
        return self.series(s, 0)[0].value

    def half(self, s: Reals) -> Array:
        """Half thicknesses (..., m, k) at s (k,)."""
        return self.series(s, 0)[1].value

    def derivatives(self, s: Reals, order: int = 3) -> tuple[Array, Array]:
        """Derivatives by s of order 0, 1, ... (..., m, k, order + 1) of u and of the half thickness, exact."""
        u, half = self.series(s, order)
        return u.derivatives(), half.derivatives()


@dataclass(frozen=True, kw_only=True)
class ThicknessLaw(Part, ABC):
    """Base of the thickness laws: parameters that evolve along the span."""

    path: ClassVar[str] = "thickness"
    """where a design holds its law, for messages"""

    @abstractmethod
    def at(self, span: Span) -> Thickness:
        """The half thicknesses of the sections at places along the span.

        Raises DesignError where parameters contradict each other.
        """

    def _require(self, met: Array, span: Span, name: str, value: Array, cure: str) -> None:
        """Refuse the values (..., m) of a field at the first place along the span where a condition is not met."""
        if np.all(met):
            return
        met, value = np.broadcast_arrays(met, np.real(value))
        worst = np.argwhere(~met)[0]
        place = span.v[worst[-1]] if met.shape[-1] == len(span.v) else span.v[0]
        raise DesignError(f"{self.path}.{name} is {value[tuple(worst)]:.6g} at span fraction {place:.4g}: {cure}")


def same_law(first: Law | None, second: Law | None) -> bool:
    """Whether two laws hold the same real numbers."""
    if first is None or second is None:
        return first is second
    pairs = zip(law_points(first), law_points(second), strict=False)
    return same_kind(first, second) and all(np.array_equal(np.real(a), np.real(b)) for a, b in pairs)
