"""A closed section as samples in chords, unstaggered: what every family takes its start from."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.fitting.families.edges import split
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve

POINTS = 400
"""of each side"""
PLACES: Reals = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 121)[1:-1])) / 2.0
"""chord fractions of the mean line and the half thickness"""
POWERS = 5
"""of the polynomial that multiplies u (1 - u) in the mean line"""
BESIDE, STEP = (0.02, 0.06), 0.06
"""how far behind an edge, and over which part of the chord, its wedge is seen, of the chord"""
TURNS = 6
"""times that the mean line is brought to the middle"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sampled:
    """A section whose chord line runs from (0, 0) to (1, 0), the upper side on its left."""

    chord: float
    """[m]"""
    stagger: float
    """[rad]"""
    start: Reals
    """(2,) the leading edge [m]"""
    upper: Reals
    """(n, 2) from leading to trailing edge"""
    lower: Reals
    """(n, 2)"""
    radii: tuple[float, float]
    """of the leading and the trailing edge"""

    @cached_property
    def _line(self) -> tuple[Reals, Reals]:
        """Coefficients of the mean line's polynomial, and half thicknesses at PLACES."""
        weights: Reals = np.zeros(POWERS)
        half: Reals = np.zeros(len(PLACES))
        for _ in range(TURNS):
            heights = [self._heights(side, weights) for side in (self.upper, self.lower)]
            half, middle = 0.5 * (heights[0] - heights[1]), 0.5 * (heights[0] + heights[1])
            slope = _polynomial(weights, PLACES, 1)
            wanted = _polynomial(weights, PLACES, 0) + middle * np.sqrt(1.0 + slope**2)
            rows = (PLACES * (1.0 - PLACES))[:, None] * PLACES[:, None] ** np.arange(POWERS)
            weights = np.asarray(np.linalg.lstsq(rows, wanted, rcond=None)[0])
        return weights, np.maximum(half, 1e-6)

    def _heights(self, side: Reals, weights: Reals) -> Reals:
        """Heights at PLACES of a side above the mean line, along its normals."""
        u = np.clip(side[:, 0], 0.0, 1.0)
        for _ in range(4):
            v, slope = _polynomial(weights, u, 0), _polynomial(weights, u, 1)
            ahead = (side[:, 0] - u) + slope * (side[:, 1] - v)
            u = np.clip(u + ahead / (1.0 + slope**2), 0.0, 1.0)
        v, slope = _polynomial(weights, u, 0), _polynomial(weights, u, 1)
        height = ((side[:, 1] - v) - slope * (side[:, 0] - u)) / np.sqrt(1.0 + slope**2)
        order = np.argsort(u, kind="stable")
        return np.interp(PLACES, u[order], height[order])

    def mean(self, u: Reals, order: int = 0) -> Reals:
        """Ordinates of the mean line (n,), or derivatives, at chord fractions u (n,)."""
        return _polynomial(self._line[0], u, order)

    @property
    def half(self) -> Reals:
        """Half thicknesses at PLACES, normal to the mean line."""
        return self._line[1]

    def half_at(self, u: float) -> float:
        """The half thickness at a chord fraction."""
        return float(np.interp(u, PLACES, self.half))

    @property
    def thickest(self) -> tuple[float, float]:
        """The largest full thickness, and its chord fraction."""
        at = int(np.argmax(self.half))
        return 2.0 * float(self.half[at]), float(PLACES[at])

    @property
    def angles(self) -> tuple[float, float]:
        """Angles of the mean line at its ends from the chord line [rad]."""
        slope = self.mean(np.array([0.0, 1.0]), 1)
        return float(np.arctan(slope[0])), float(np.arctan(slope[1]))

    @property
    def most_cambered(self) -> tuple[float, float]:
        """The ordinate of the mean line farthest from the chord line, and its chord fraction."""
        values = self.mean(PLACES)
        at = int(np.argmax(values**2))
        return float(values[at]), float(PLACES[at])

    def wedge(self, end: int) -> float:
        """Angle between the sides where they leave the leading (0) or the trailing edge (1) [rad]."""
        near = float(np.clip(self.radii[end], *BESIDE))
        places = (near, near + STEP) if end == 0 else (1.0 - near, 1.0 - near - STEP)
        return 2.0 * float(np.arctan((self.half_at(places[1]) - self.half_at(places[0])) / STEP))


def reversed_flow(section: Sampled) -> Sampled:
    """The same section for the flow that comes from the other side: its edges exchanged, its sides as they are."""
    turn = np.array([-1.0, 1.0])
    end = section.start + section.chord * np.array([np.cos(section.stagger), np.sin(section.stagger)])
    return Sampled(
        chord=section.chord,
        stagger=-section.stagger,
        start=turn * end,
        upper=np.array([1.0, 0.0]) + turn * section.upper[::-1],
        lower=np.array([1.0, 0.0]) + turn * section.lower[::-1],
        radii=section.radii[::-1],
    )


def sampled(upper: Curve, lower: Curve, radii: tuple[float, float]) -> Sampled:
    """The samples of a section in its plane, from its sides [m] and its edges' radii [m]."""
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, POINTS))) / 2.0
    above, below, found = split(np.real(upper(u)), np.real(lower(u)))
    sides, radii = [above, below], found or radii
    # the chord line ends in the middle of a blunt edge
    start, end = (0.5 * (sides[0][at] + sides[1][at]) for at in (0, -1))
    along = end - start
    chord, stagger = float(np.hypot(*along)), float(np.arctan2(along[1], along[0]))
    turn = np.array([[np.cos(stagger), -np.sin(stagger)], [np.sin(stagger), np.cos(stagger)]]) / chord
    first, second = ((side - start) @ turn for side in sides)
    return Sampled(
        chord=chord,
        stagger=stagger,
        start=start,
        upper=first,
        lower=second,
        radii=(min(radii[0] / chord, 0.5), min(radii[1] / chord, 0.5)),
    )


def _polynomial(weights: Reals, u: Reals, order: int) -> Reals:
    """u (1 - u) times a polynomial, or a derivative."""
    whole = np.polynomial.Polynomial([0.0, 1.0, -1.0]) * np.polynomial.Polynomial(weights)
    return np.asarray((whole.deriv(order) if order else whole)(u))
