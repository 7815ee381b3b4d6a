"""The contract of every family's sections: exact points and derivatives of two sides, for many sections at once."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals

STEP = 1e-4
"""distance by s from an edge at which a camber line with a speed there is distinguished from one without: it has gone
less than STEP^1.5 if its abscissa starts as s^2 [-]"""


class EdgeDerivatives(NamedTuple):
    """A side at an edge: its point and first two derivatives by s, (..., 2) in the plane or (..., 3) in space."""

    point: Array
    first: Array
    second: Array

    @classmethod
    def of_side(cls, derivatives: Array) -> "EdgeDerivatives":
        """Those of a side from what `Outline.derivatives` gives at the edge alone, (..., 1, 2, 3)."""
        return cls(*(derivatives[..., 0, :, order] for order in range(3)))

    def mirrored(self) -> "EdgeDerivatives":
        """The other side's at a round edge: opposite first, equal second derivatives."""
        return EdgeDerivatives(self.point, -self.first, self.second)


@dataclass(frozen=True, kw_only=True)
class Edge:
    """How the two sides of an outline meet at an edge, with point and derivatives of each."""

    kind: Literal["round", "sharp", "blunt"]
    """round: opposite first and equal second derivatives; sharp: one point; blunt: two points and a straight face"""
    upper: EdgeDerivatives
    lower: EdgeDerivatives

    @classmethod
    def rounded(cls, upper: EdgeDerivatives) -> "Edge":
        """A round edge by its upper side."""
        return cls(kind="round", upper=upper, lower=upper.mirrored())


class Joint(NamedTuple):
    """A place where derivatives of the sides by s are not continuous."""

    s: float
    derivatives: int
    """how many of them are continuous there: 0 at a corner, 1 where the curvature jumps"""


NEAR_EDGE = 1e-3 * np.arange(1.0, 7.0)
"""s from an edge at which the slope of secants of the camber line is taken to extrapolate it to the edge: with these
six it is within 2e-5 deg of that of the native camber line on every family, and mostly within 1e-7"""
TO_THE_EDGE = np.array([6.0, -15.0, 20.0, -15.0, 6.0, -1.0])
"""Weights of Lagrange's interpolation at those places for its value at s = 0."""


class Outline(ABC):
    """Sections (...) in chords: the chord line runs from (0, 0) to (1, 0), the upper side lies on its left.

    Both sides are functions of one parameter s, 0 at the leading and 1 at the trailing edge. They are smooth between
    the joints and up to the edges; at a round edge the upper side continued to -s is the lower side. Points may be
    complex, as the parameters of a design are while it is differentiated; s, joints and kinds of edges are real, and
    the same for all sections.
    """

    @property
    @abstractmethod
    def leading_edge(self) -> Edge:
        """How the sides meet at s = 0."""

    @property
    @abstractmethod
    def trailing_edge(self) -> Edge:
        """How the sides meet at s = 1; derivatives are by s here as well."""

    @property
    @abstractmethod
    def joints(self) -> tuple[Joint, ...]:
        """The joints inside (0, 1), increasing."""

    @property
    def back(self) -> float | None:
        """The s from which on both sides run along a straight back face across the chord line; None without one."""
        return None

    @property
    def on_chord_line(self) -> bool:
        """Whether the camber line ends where the chord line does; a morph may move edges off (0, 0) and (1, 0)."""
        return True

    @property
    def cuts(self) -> tuple[float, float] | None:
        """s of the two cuts that part each side in leading edge, central box and trailing edge; None: not parted."""
        return None

    def check_limits(self, where: Sequence[str]) -> None:  # noqa: B027 - most have nothing more to be refused
        """Refuse what a family forbids besides sections that cross themselves; `where` (m,) names each."""

    @property
    def crossing_cure(self) -> str:
        """What helps where a section crosses itself or folds back."""
        return (
            "lower the thickness there, lower the curvature of the camber line there, or lower an edge radius that is "
            "larger than the thickness beside it"
        )

    @abstractmethod
    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., len(s), 2) of the upper and the lower side at s (k,) in [0, 1]."""

    @abstractmethod
    def camber(self, s: Reals) -> Array:
        """Points (..., len(s), 2) of the camber line at s (k,) in [0, 1], from (0, 0) to (1, 0)."""

    def camber_slopes(self) -> tuple[Array, Array]:
        """Slopes (...) of the camber line at its ends, extrapolated from secants at `NEAR_EDGE`."""
        first, last = self.camber(NEAR_EDGE), self.camber(1.0 - NEAR_EDGE)
        return (
            np.asarray(first[..., 1] / first[..., 0] @ TO_THE_EDGE),
            np.asarray(last[..., 1] / (last[..., 0] - 1.0) @ TO_THE_EDGE),
        )

    @property
    def breaks(self) -> Reals:
        """s (j,) inside (0, 1) at which a side of a single section is not analytic; `joints` hold for all sections."""
        return np.array([joint.s for joint in self.joints])

    @property
    def has_exact_derivatives(self) -> bool:
        """Whether `derivatives` are those of a closed form, for many sections at once."""
        return False

    def derivatives(self, s: Reals, order: int) -> tuple[Array, Array]:
        """Points and derivatives by s (k, 2, order + 1) of both sides of a single section at s (k,) off the breaks.

        Unless a family has them in closed form, they are those of Chebyshev series on the pieces.
        """
        from bladewright.section.chebyshev_pieces import ChebyshevPieces

        def sides(s: Reals) -> Reals:
            return np.concatenate([_single(side) for side in self.points(s)], axis=-1)

        found = ChebyshevPieces(sides, np.array([0.0, *self.breaks, 1.0])).derivatives(s, order)
        return found[:, :2], found[:, 2:]

    @property
    def camber_breaks(self) -> Reals:
        """t (j,) inside (0, 1) at which the camber line of a single section is not analytic."""
        return self._abscissae(self.breaks) if self._has_no_speed_at_an_edge else self.breaks

    def camber_derivatives(self, t: Reals, order: int) -> Array:
        """Points and derivatives by t (k, 2, order + 1) of a single section's camber line at t (k,) in [0, 1].

        t is a parameter by which the line has a speed everywhere: s, or the abscissa where the line has no speed by s
        at an edge. Families in closed form choose their own.
        """
        from bladewright.section.chebyshev_pieces import ChebyshevPieces, inverse

        ends = np.array([0.0, *self.breaks, 1.0])
        if not self._has_no_speed_at_an_edge:
            return ChebyshevPieces(lambda s: _single(self.camber(s)), ends).derivatives(t, order)
        place = inverse(self._abscissae, ends)

        def line(x: Reals) -> Reals:
            return np.stack([x, _single(self.camber(place(x)))[:, 1]], axis=-1)

        return ChebyshevPieces(line, np.array([0.0, *self.camber_breaks, 1.0])).derivatives(t, order)

    def _abscissae(self, s: Reals) -> Reals:
        return _single(self.camber(s))[:, 0] if len(s) else s

    @property
    def _has_no_speed_at_an_edge(self) -> bool:
        """Whether the camber line has no speed by s at an edge: u is even in s at a round one."""
        near = self._abscissae(np.array([STEP, 1.0 - STEP]))
        return bool(min(near[0], 1.0 - near[1]) < STEP**1.5)


def _single(points: Array) -> Reals:
    """Real points (k, 2) of one section, (k, 2) or (1, k, 2)."""
    return np.asarray(np.real(points[0] if points.ndim == 3 else points), dtype=np.float64)


def by_parts(parts: Sequence[tuple[NDArray[np.bool_], Array]], count: int) -> Array:
    """Points (..., count, 2) from those of several parts of a side, each at a mask (count,)."""
    shape = np.broadcast_shapes(*[points.shape[:-2] for _, points in parts])
    found = np.empty((*shape, count, 2), dtype=np.result_type(*[points for _, points in parts]))
    for inside, points in parts:
        found[..., inside, :] = points
    return found
