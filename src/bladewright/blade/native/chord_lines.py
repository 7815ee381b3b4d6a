"""Chord lines in the meridional plane: their lengths, and places on them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from bladewright.numerics.elementary import Array, dot, length, unit
from bladewright.numerics.quadrature import panels

if TYPE_CHECKING:
    from bladewright.blade.exact.section_stack import SectionStack

ALONG = panels(np.linspace(0.0, 1.0, 33), 8)
"""Places along a chord line and their weights: lengths of polynomials are exact to rounding, and those of splines
through points, whose third derivatives jump, to some 1e-9."""
HALFWAY_STEPS = 8
"""Newton steps to half the meridional length: they converge quadratically from half the parameter."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ChordLines:
    """The m chord lines of sections in (x, r), or (x, z) in a cascade, each by u from 0 to 1 between the edges."""

    stack: SectionStack
    annular: bool

    @cached_property
    def lengths(self) -> Array:
        """Meridional lengths (m,) [m]."""
        return self.length_to(np.ones(len(self.stack.v)), conformal=False)

    @cached_property
    def extents(self) -> Array:
        """Delta m' (m,) between the edges, or the meridional lengths in a cascade."""
        return self.length_to(np.ones(len(self.stack.v)), conformal=True)

    def slope(self, u: Array) -> Array:
        """Unit vectors (m, 2) downstream at u (m,)."""
        return unit(self.stack.chord_line(u[:, None], 1)[..., 0, :])

    def length_to(self, u: Array, *, conformal: bool) -> Array:
        """Meridional lengths (m,), or increases of m', from the leading edge to u (m,)."""
        places = u[:, None] * ALONG[0]
        speed = length(self.stack.chord_line(places, 1))
        if conformal and self.annular:
            speed = speed / self.stack.chord_line(places)[..., 1]
        return u * np.sum(ALONG[1] * speed, axis=-1)

    @cached_property
    def halfway(self) -> Array:
        """u (m,) at half the meridional length."""
        u: Array = np.full(len(self.stack.v), 0.5)
        for _ in range(HALFWAY_STEPS):
            rate = length(self.stack.chord_line(u[:, None], 1)[..., 0, :])
            u = u - (self.length_to(u, conformal=False) - self.lengths / 2.0) / rate
        return u

    def nearest(self, place: Array) -> Array:
        """u (m,) of the points nearest to places (m, 2)."""
        tried = np.linspace(0.0, 1.0, 65)
        away = length(np.real(self.stack.chord_line(tried) - place[:, None, :]))
        u: Array = tried[np.argmin(away, axis=-1)]
        for _ in range(HALFWAY_STEPS):
            point, slope = (self.stack.chord_line(u[:, None], order)[..., 0, :] for order in (0, 1))
            u = u - dot(point - place, slope) / dot(slope, slope)
        return u
