"""How the parameter of a cut blade runs across the blade that it is cut from.

With l and h the places where a line of the uncut blade begins and ends, and L and H their means, a place w in [0, 1] is

    V(w) = L + (H - L) w + (l - L) g(1 - w; b0) + (h - H) g(w; b1),   g(w; b) = (max(0, w - 1 + b) / b)^3,

so that curves of constant V stay what they are up to the lengths b0 and b1 in which they bend to the cuts. Where a cut
is too oblique for that, L and H are those of each line, and its parameter is stretched evenly.
"""

from dataclasses import dataclass
from math import perm

import numpy as np

from bladewright.blade.native.cut_lines import Near
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import JOINT_TOLERANCE, Reals, knots_with_joints

POWER = 3
"""Power with which curves bend: two derivatives are continuous where they begin to."""
BENT = 5.0
"""Length of the part that bends, over how far the cut departs from its mean: with power 3 curves come no closer than to
1 - 3/5 of their distance."""
LEAST_BENT = 0.2
"""Least length of the part that bends: in a shorter one, knots would lie closer than the cut asks for."""

CLEAR = 0.02
"""The same where a joint of the uncut blade lies so near to the cut."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Stretch(FrozenRecord):
    """How the parameter runs, chosen from the real blade and held in derivatives."""

    low: float
    """L, the mean place at which the cut blade begins"""
    high: float
    """H, where it ends"""
    bent: tuple[float, float]
    """b0 and b1"""
    even: bool
    """whether L and H are those of each line instead"""

    def places(self, w: Reals, low: Array, high: Array, levels: tuple[Array, Array], order: int = 0) -> Array:
        """V, or a derivative by w, for l and h that broadcast with w; `levels` are L and H of each line."""
        first, last = levels if self.even else (np.asarray(self.low), np.asarray(self.high))
        line = first + (last - first) * w if order == 0 else (last - first) + 0.0 * w if order == 1 else 0.0 * w
        start = (-1) ** order * _bend(1.0 - w, self.bent[0], order)
        return line + (low - first) * start + (high - last) * _bend(w, self.bent[1], order)

    def knots(self, knots: Reals, degree: int) -> Reals:
        """Knots over [0, 1] of the cut blade, from those over [0, 1] of the uncut one."""
        inner = (knots[(knots > 0.0) & (knots < 1.0)] - self.low) / (self.high - self.low)
        inner = inner[(inner > JOINT_TOLERANCE) & (inner < 1.0 - JOINT_TOLERANCE)]
        whole = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
        joints = [(self.bent[0], POWER - 1), (1.0 - self.bent[1], POWER - 1)]
        return knots_with_joints(whole, degree, [each for each in joints if 0.0 < each[0] < 1.0])


@dataclass(frozen=True, kw_only=True, eq=False)
class CutChoices(FrozenRecord):
    """What a cut chooses for the real blade, and derivatives hold."""

    stretch: Stretch
    mirrored: tuple[bool, bool]
    """whether the lower side mirrors the upper one at the edges: where they are round, and not cut"""
    near: Near
    """about where lines of the faces meet the cuts"""


def stretch_between(low: Reals, high: Reals, knots: Reals, *, straight: bool = False) -> Stretch:
    """The stretch of lines that begin and end at these places (n,); even where curves could not bend, or `straight`.

    Curves bend past the last of the `knots` at which the uncut blade has less than three derivatives, where the cut
    leaves the room: a knot line that is bent itself is no knot line of the cut blade.
    """
    first, last = float(np.mean(low)), float(np.mean(high))
    away = [float(np.max(np.square(each - mean))) ** 0.5 for each, mean in ((low, first), (high, last))]
    needed = [BENT * gap / (last - first) for gap in away]
    levels, counts = np.unique(knots, return_counts=True)
    joints = (levels[counts >= POWER] - first) / (last - first)
    joints = joints[(joints > 0.0) & (joints < 1.0)]
    bent = []
    for least, room in zip(needed, (joints, 1.0 - joints), strict=True):
        nearest = float(np.min(room, initial=1.0))
        roomy = max(LEAST_BENT, least)
        bent.append(1.0 if least < JOINT_TOLERANCE else nearest if max(least, CLEAR) < nearest < roomy else roomy)
    even = straight or max(bent) > 1.0
    return Stretch(low=first, high=last, bent=(1.0, 1.0) if even else (bent[0], bent[1]), even=even)


def _bend(w: Reals, bent: float, order: int) -> Reals:
    """g or one of its derivatives by w."""
    away = np.maximum(0.0, w - 1.0 + bent) / bent
    return perm(POWER, order) * away ** (POWER - order) / bent**order
