"""The outline of segmented airfoils: the spans of their B-splines, by a parameter that passes joints smoothly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, TypeVar

import numpy as np

from bladewright.numerics.elementary import Array, concatenated
from bladewright.nurbs.basis import Reals
from bladewright.section.offset import merged_joints
from bladewright.section.outline import Edge, EdgeDerivatives, Joint, Outline
from bladewright.section.power_series import Series, point_derivatives, polynomial, polynomial_points, variable
from bladewright.section.segmented.segment import DEGREE, powers
from bladewright.section.segmented.skin import Band, check_bands

CUTS = (0.4, 0.7)
"""s of the front and the rear cut: the leading edge's share is larger than its length's, for its curvature [-]"""
ENDS = (0.0, *CUTS, 1.0)
Parameter = TypeVar("Parameter", Array, Series)


@dataclass(frozen=True, kw_only=True, eq=False)
class SegmentedSide:
    """Three segments from the leading to the trailing edge."""

    controls: tuple[Array, Array, Array]
    """(..., m, n, 2) of each"""
    speeds: tuple[tuple[Array, Array], ...]
    """(..., m) size of each segment's derivative by its own parameter at both ends; it counts where the tangent is
    continuous"""
    continuity: tuple[int, int]
    """how many derivatives are continuous at the front and at the rear cut"""

    @property
    def joints(self) -> list[Joint]:
        """Inner knots and cuts."""
        places = self.starts
        inner = {0: 2, **dict(zip(np.cumsum(self.counts)[:-1].tolist(), self.continuity, strict=True))}
        return [Joint(float(s), inner.get(k, DEGREE - 1)) for k, s in enumerate(places)][1:]

    @cached_property
    def counts(self) -> list[int]:
        """Knot spans of each segment."""
        return [each.shape[-2] - DEGREE for each in self.controls]

    @cached_property
    def starts(self) -> Reals:
        """s (p,) at which each span begins."""
        return np.concatenate(
            [np.linspace(low, high, n + 1)[:-1] for low, high, n in zip(ENDS, ENDS[1:], self.counts, strict=False)]
        )

    @cached_property
    def powers(self) -> Array:
        """Coefficients (..., m, p, 4, 2) of all spans."""
        return concatenated([powers(each) for each in self.controls], axis=-3)

    def rates(self) -> list[tuple[Array, Array]]:
        """Speeds (..., m) by s at both ends of each segment, were its parameter linear in s."""
        widths = np.diff(ENDS)
        return [(first / width, last / width) for (first, last), width in zip(self.speeds, widths, strict=True)]


@dataclass(frozen=True, kw_only=True, eq=False)
class SegmentedOutline(Outline):
    """Sections (..., m) in chords of the airfoil that is not morphed; a morph moves their edges off that chord line.

    Where the tangent is continuous, both segments at a joint pass it with the harmonic mean of their speeds, and where
    the curvature is, with no second derivative of their own parameters by s: so the sides are once or twice
    differentiable by s there, as their segments are smooth. A segment's parameter is linear in s but for its first and
    its last span, where it is the quintic polynomial with these derivatives. It rises: the harmonic mean is less than
    twice either speed, and up to 2.9 times the mean speed would do.
    """

    upper: SegmentedSide
    lower: SegmentedSide
    nose: int
    """how many derivatives of the outline are continuous at the leading edge"""
    blunt: bool
    """whether the trailing edge is open, and closed by a straight face"""
    morphed: bool = False
    bands: tuple[Band, ...] = ()
    """of the segments whose skin is morphed"""
    old_sides: tuple[SegmentedSide, SegmentedSide] | None = None
    """the upper and the lower side before their skins were morphed"""

    @property
    def sides(self) -> tuple[SegmentedSide, SegmentedSide]:
        """The upper and the lower side."""
        return self.upper, self.lower

    @property
    def cuts(self) -> tuple[float, float]:
        """s of the front and the rear cut, which part each side in three segments."""
        return CUTS

    @cached_property
    def leading_edge(self) -> Edge:
        return self._edge(0, "round" if self.nose == 2 else "sharp")

    @cached_property
    def trailing_edge(self) -> Edge:
        return self._edge(1, "blunt" if self.blunt else "sharp")

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        return merged_joints([*self.upper.joints, *self.lower.joints])

    @property
    def on_chord_line(self) -> bool:
        return not self.morphed

    @property
    def crossing_cure(self) -> str:
        turned = "turn the edges by smaller angles of morph, or " if self.morphed else ""
        return f"{turned}bring the inner control points and the scale factors of that segment nearer to its joints"

    def check_limits(self, where: Sequence[str]) -> None:
        for k, (old, new) in enumerate(zip(self.old_sides or self.sides, self.sides, strict=True)):
            bands = [band for band in self.bands if band.side == k]
            if bands:
                check_bands(bands, new.counts, old.powers, new.powers, where)

    def points(self, s: Reals) -> tuple[Array, Array]:
        found = []
        for side in (0, 1):
            coefficients, t = self._placed(side, s, s)
            found.append(polynomial_points(coefficients, t[..., None])[..., 0, :])
        return found[0], found[1]

    @property
    def has_exact_derivatives(self) -> bool:
        return True

    def derivatives(self, s: Reals, order: int) -> tuple[Array, Array]:
        """Points and derivatives by s (..., m, k, 2, order + 1) of both sides, exact; at a joint those behind it."""
        found = []
        for side in (0, 1):
            coefficients, t = self._placed(side, s, variable(s, order))
            x, y = (polynomial([coefficients[..., power, axis] for power in range(DEGREE + 1)], t) for axis in (0, 1))
            found.append(point_derivatives(x, y))
        return found[0], found[1]

    def camber(self, s: Reals) -> Array:
        """The middle between the sides at equal s."""
        upper, lower = self.points(s)
        return 0.5 * (upper + lower)

    @cached_property
    def _at_edges(self) -> tuple[Array, Array]:
        return self.derivatives(np.array([0.0, 1.0]), 2)

    def _edge(self, end: int, kind: Literal["round", "sharp", "blunt"]) -> Edge:
        upper, lower = (EdgeDerivatives.of_side(side[..., end : end + 1, :, :]) for side in self._at_edges)
        return Edge(kind=kind, upper=upper, lower=lower)

    @cached_property
    def _slopes(self) -> list[tuple[Array, Array]]:
        """For each side dt/ds (..., m, p) at start and end of each span, over that of a linear parameter."""
        rates = [side.rates() for side in self.sides]
        found = []
        for own, other, side in zip(rates, rates[::-1], self.sides, strict=True):
            one = np.ones_like(own[0][0] + other[0][0])
            at_nose = _shared(own[0][0], other[0][0]) if self.nose else one
            starts, ends = [at_nose], []
            for k, smooth in enumerate(side.continuity):
                ends.append(_shared(own[k][1], own[k + 1][0]) if smooth else one)
                starts.append(_shared(own[k + 1][0], own[k][1]) if smooth else one)
            ends.append(one)
            first, last = [], []
            for start, end, count in zip(starts, ends, side.counts, strict=True):
                first += [start, *[one] * (count - 1)]
                last += [*[one] * (count - 1), end]
            found.append((_row(first), _row(last)))
        return found

    def _placed(self, side: int, s: Reals, at: Parameter) -> tuple[Array, Parameter]:
        """Coefficients (..., m, k, 4, 2) of a side's spans at s (k,), and their parameter; of s or its series."""
        own = self.sides[side]
        span = np.clip(np.searchsorted(own.starts, s, side="right") - 1, 0, len(own.starts) - 1)
        widths = np.diff(np.append(own.starts, 1.0))
        first, last = (each[..., span] for each in self._slopes[side])
        return own.powers[..., span, :, :], _eased((at - own.starts[span]) / widths[span], first, last)


def _shared(own: Array, other: Array) -> Array:
    """The harmonic mean of two speeds, over the first."""
    return 2.0 * other / (own + other)


def _row(columns: Sequence[Array]) -> Array:
    return np.stack(np.broadcast_arrays(*columns), axis=-1)


def _eased(share: Parameter, first: Array, last: Array) -> Parameter:
    """The quintic polynomial from 0 to 1 with these slopes and no second derivative at its ends."""
    # by Hermite's basis: the slopes' parts above 1 have no value at the ends
    cube = share * share * share
    rest = 1.0 - share
    front = share - cube * (6.0 + share * (-8.0 + 3.0 * share))
    back = (rest * rest * rest * (6.0 + rest * (-8.0 + 3.0 * rest))) - rest
    return share + front * (first - 1.0) + back * (last - 1.0)
