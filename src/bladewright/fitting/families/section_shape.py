"""What every family takes its first section from: sides, camber line and edges of a closed section, in chords."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial
from scipy.integrate import cumulative_trapezoid

from bladewright.nurbs.basis import Reals
from bladewright.section.section import Section

PLACES: Reals = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 201))) / 2.0
"""places from the leading to the trailing edge at which a section is sampled"""
INNER = (PLACES > 0.03) & (PLACES < 0.97)
"""those away from the edges: beside an edge the middle of the sides may bend towards a corner"""
CAMBER_TERMS = 5
"""coefficients of the polynomial that multiplies x (1 - x) in a camber line (design/matching_constants.md)"""
FINE_PLACES = 2001
"""places along a curve between which it is taken as linear, within 1e-7 of its length (design/matching_constants.md)"""
EDGE_PLACE = 0.02
"""chord fraction, from an edge, at which the half thickness bounds its radius (design/matching_constants.md)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class SectionShape:
    """A section whose chord line runs from (0, 0) to (1, 0), by places s (n,) from leading to trailing edge."""

    chord: float
    """distance from edge to edge [m]"""
    stagger: float
    """angle of the chord line from the first axis [rad]"""
    start: Reals
    """(2,) the leading edge [m]"""
    upper: Reals
    """(n, 2) of the upper side"""
    lower: Reals
    """(n, 2) of the lower side"""
    edge_radii: tuple[float, float]
    """of the leading and the trailing edge, of the chord; rough where a camber line bends at an edge"""
    ends_known: bool = False
    """whether the chord line ends where the points do, as that of a contour"""

    @cached_property
    def camber(self) -> Polynomial:
        """The camber line's ordinate by the chord fraction, from the middle of the sides away from the edges."""
        x, y = (0.5 * (self.upper + self.lower))[INNER].T
        rows = (x * (1.0 - x))[:, None] * np.vander(x, CAMBER_TERMS, increasing=True)
        return Polynomial([0.0, 1.0, -1.0]) * Polynomial(np.linalg.lstsq(rows, y, rcond=None)[0])

    def angles(self, x: Reals) -> Reals:
        """Angles (n,) of the camber line from the chord line at chord fractions (n,) [rad]."""
        return np.asarray(np.arctan(self.camber.deriv()(x)))

    def half(self, x: Reals) -> Reals:
        """Half thicknesses (n,) at chord fractions (n,)."""
        places = np.maximum.accumulate(0.5 * (self.upper + self.lower)[:, 0])
        return np.interp(x, places, 0.5 * np.sqrt(np.sum((self.upper - self.lower) ** 2, axis=-1)))

    @property
    def radii(self) -> tuple[float, float]:
        """Of the edges: between those of the parabola through the half thickness beside them, and of a plate."""
        beside = self.half(np.array([EDGE_PLACE, 1.0 - EDGE_PLACE]))
        first, last = np.clip(self.edge_radii, beside**2 / (2.0 * EDGE_PLACE), beside)
        return float(first), float(last)

    @property
    def thickest(self) -> tuple[float, float]:
        """The largest full thickness, and its chord fraction."""
        half = self.half(PLACES)
        at = int(np.argmax(half))
        return 2.0 * float(half[at]), float(PLACES[at])

    @property
    def most_cambered(self) -> tuple[float, float]:
        """The ordinate of the camber line farthest from the chord line, and its chord fraction."""
        heights = self.camber(PLACES)
        at = int(np.argmax(heights**2))
        return float(heights[at]), float(PLACES[at])

    @property
    def along(self) -> Reals:
        """The direction (2,) of the chord line."""
        return np.array([np.cos(self.stagger), np.sin(self.stagger)])

    def within(self, first: float, last: float) -> "SectionShape":
        """The same section without so much of its chord at its leading and trailing edge, unless its ends are known."""
        if self.ends_known:
            return self
        start = self.start + first * self.chord * self.along
        return replace(self, chord=(1.0 - first - last) * self.chord, start=start)

    def reversed(self) -> "SectionShape":
        """The same section for flow from the other side: its edges exchanged, its sides kept."""
        turn = np.array([-1.0, 1.0])
        end = self.start + self.chord * self.along
        upper, lower = ([1.0, 0.0] + turn * side[::-1] for side in (self.upper, self.lower))
        return replace(
            self, stagger=-self.stagger, start=turn * end, upper=upper, lower=lower, edge_radii=self.edge_radii[::-1]
        )


def unrolled(section: Section, points: Reals, turn: float = 0.0) -> Reals:
    """Points (n, 2) of a section in the plane (m', theta), after a turn [rad], in (m, r theta) [m]: dm = r dm'."""
    at = np.linspace(min(np.min(points[:, 0]), 0.0), max(np.max(points[:, 0]), 0.0), FINE_PLACES)
    radius = np.real(section.scale(at))
    way = cumulative_trapezoid(radius, at, initial=0.0)
    way -= np.interp(0.0, at, way)
    x, around = points.T
    return np.stack([np.interp(x, at, way), np.interp(x, at, radius) * (around + turn)], axis=-1)


def section_shape(section: Section, *, unroll: bool = False, turn: float = 0.0) -> SectionShape:
    """The shape of a built section, in its plane, or in the plane (m, r theta) after a `turn` about x [rad]."""
    upper, lower = (np.real(section.curves[name](PLACES)) for name in ("upper", "lower"))
    if unroll:
        upper, lower = unrolled(section, upper, turn), unrolled(section, lower, turn)
    # the chord line ends in the middle of a blunt edge
    start, end = (0.5 * (upper[at] + lower[at]) for at in (0, -1))
    along = end - start
    chord, stagger = float(np.hypot(*along)), float(np.arctan2(along[1], along[0]))
    upright = np.array([[np.cos(stagger), -np.sin(stagger)], [np.sin(stagger), np.cos(stagger)]]) / chord
    scale: Any = np.ones(2) if unroll else np.real(section.scale(np.array([start[0], end[0]])))
    radii = (float(radius / (each * chord)) for radius, each in zip(section.edge_radii, scale, strict=True))
    first, last = (min(radius, 0.5) for radius in radii)
    upper, lower = ((side - start) @ upright for side in (upper, lower))
    return SectionShape(chord=chord, stagger=stagger, start=start, upper=upper, lower=lower, edge_radii=(first, last))
