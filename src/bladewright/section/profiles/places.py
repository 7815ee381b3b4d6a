"""Where on the mean line the points of a profile stand: a map of s that makes the nose's root an analytic function."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.profiles.analytic import hyperbolic_tangent, waves
from bladewright.section.thickness.series import Series, variable

JOINT = 0.5
"""s of the mean line's joint, where it has one"""


class Place(NamedTuple):
    """Chord fractions as power series of s."""

    root: Series
    """sqrt(x)"""
    x: Series
    rest: Series
    """1 - x, exact next to the trailing edge"""
    end_root: Series | None
    """sqrt(1 - x), where the trailing edge is round"""


@dataclass(frozen=True, kw_only=True)
class Places:
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

    def at(self, s: Reals, order: int) -> Place:
        """Places at s (k,) with their derivatives up to an order."""
        sine, cosine = waves(self._phase(s, order))
        if self.round_end:
            root, before = sine, cosine * cosine
        else:
            # 1 - cos = 2 sin^2 of half the phase, and 1 less that is the cosine
            root, _ = waves(self._phase(s, order) * 0.5)
            root, before = root * np.sqrt(2.0), cosine
        ratio: Array | float = 1.0 if self.joint is None else self._ratio(self.joint)
        scale = root * root + before * ratio
        first = root / scale.sqrt()
        lift = first * first * self.bend + 1.0
        x_root = first * (first * self.bend + 1.0) / lift
        kept = ratio / scale * (x_root + 1.0) / (first + 1.0) / lift
        end = cosine * kept.sqrt() if self.round_end else None
        return Place(root=x_root, x=x_root * x_root, rest=before * kept, end_root=end)

    def _phase(self, s: Reals, order: int) -> Series:
        """The angle that runs from 0 to pi / 2; steps gathered at the edges, odd about them."""
        angle = variable(s, order) * np.pi
        once, _ = waves(angle)
        twice, _ = waves(angle * 2.0)
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
