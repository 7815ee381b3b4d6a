"""A closed section as samples in chords, unstaggered: what every family takes its start from."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve

OUTLINE_SAMPLES = 600
"""points of an outline, in equal steps; edges are found to about one step."""
OPPOSITE_COSINE = -0.2
"""cosine between the normals of two touching points below which they lie on two sides, not on one edge."""
COSINE_SLACK = 1e-3
"""slack of the cosine between a normal and an edge's direction within which they agree."""
EDGE_MOVED = 0.02
"""distance of an edge from where its normals show it, of the chord, from which it is moved there."""


@dataclass(frozen=True, kw_only=True, eq=False)
class InscribedCircles:
    """The largest circles inside an outline that touch at its points (n, 2)."""

    points: Reals
    """(n, 2) points of the outline"""
    normals: Reals
    """(n, 2) unit normals there, into the outline"""
    radii: Reals
    """(n,) radii of the circles"""
    other: NDArray[np.intp]
    """(n,) the other point at which each circle touches"""

    @property
    def centres(self) -> Reals:
        """Their centres (n, 2)."""
        return self.points + self.radii[:, None] * self.normals

    @property
    def between(self) -> NDArray[np.bool_]:
        """(n,) whether a circle touches both sides."""
        return np.sum(self.normals * self.normals[self.other], axis=1) < OPPOSITE_COSINE


def sides_between_edges(upper: Reals, lower: Reals) -> tuple[Reals, Reals, tuple[float, float] | None]:
    """Both sides (n, 2) from edge to edge, and the edges' radii where the edges were moved."""
    along = upper[-1] - upper[0]
    chord = float(np.sqrt(np.sum(along**2)))
    circles = inscribed_circles(_even_steps(np.concatenate([upper, lower[::-1]])))
    around = circles.points
    ends = [_edge(circles, along, sign) for sign in (-1.0, 1.0)]
    given = 0.5 * (upper[0] + lower[0]), 0.5 * (upper[-1] + lower[-1])
    moves = [0.0 if end is None else _distance(around[end], old) for end, old in zip(ends, given, strict=True)]
    if max(moves) < EDGE_MOVED * chord:
        return upper, lower, None
    first, last = (
        end if end is not None and away >= EDGE_MOVED * chord else int(np.argmin(np.sum((around - old) ** 2, axis=1)))
        for end, away, old in zip(ends, moves, given, strict=True)
    )
    turned = np.roll(around, -first, axis=0)
    count = (last - first) % len(around)
    above, below = turned[: count + 1], np.concatenate([turned[:1], turned[: count - 1 : -1]])
    return above, below, (float(circles.radii[first]), float(circles.radii[last]))


def inscribed_circles(around: Reals) -> InscribedCircles:
    """The circles of an outline whose points (n, 2) run once around."""
    tangent = np.roll(around, -1, axis=0) - np.roll(around, 1, axis=0)
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=-1)
    normal = normal / (np.sqrt(np.sum(normal**2, axis=1))[:, None] + 1e-300)
    x, y = around.T
    inward = normal if float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) > 0.0 else -normal
    differences = around[None] - around[:, None]
    ahead = np.einsum("ijk,ik->ij", differences, inward)
    square = np.sum(differences**2, axis=-1)
    met = ahead > 1e-9 * np.sqrt(np.max(square))
    radius = np.where(met, square / (2.0 * np.where(met, ahead, 1.0)), np.inf)
    other = np.argmin(radius, axis=1)
    least = radius[np.arange(len(around)), other]
    return InscribedCircles(
        points=around, normals=inward, radii=np.where(np.isfinite(least), least, np.max(square) ** 0.5), other=other
    )


def _edge(circles: InscribedCircles, along: Reals, sign: float) -> int | None:
    """The point in the middle of the turn around the end of the middle line downstream (1) or upstream (-1)."""
    kept = np.flatnonzero(circles.between)
    if len(kept) == 0:
        return None
    count = len(circles.points)
    last = int(kept[np.argmax(sign * (circles.centres[kept] @ along))])
    pair = sorted((last, int(circles.other[last])))
    arcs = np.arange(pair[0], pair[1] + 1), np.arange(pair[1], pair[0] + count + 1) % count
    cap = max(arcs, key=lambda arc: float(np.mean(sign * (circles.points[arc] @ along))))
    across = circles.normals[pair[0]] - circles.normals[pair[1]]
    middle = np.array([-across[1], across[0]])
    # the inward normal at an edge points away from the edge
    middle = -sign * middle if middle @ along > 0.0 else sign * middle
    cosine = circles.normals[cap] @ (middle / np.sqrt(np.sum(middle**2)))
    best = np.flatnonzero(cosine > np.max(cosine) - COSINE_SLACK)
    return int(cap[best[len(best) // 2]])


def _even_steps(around: Reals) -> Reals:
    """Points of an outline in equal steps."""
    steps = np.sqrt(np.sum(np.diff(around, axis=0, append=around[:1]) ** 2, axis=1))
    way = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.linspace(0.0, way[-1], OUTLINE_SAMPLES, endpoint=False)
    closed = np.concatenate([around, around[:1]])
    return np.stack([np.interp(at, way, closed[:, i]) for i in (0, 1)], axis=-1)


def _distance(a: Reals, b: Reals) -> float:
    return float(np.sqrt(np.sum((a - b) ** 2)))


SIDE_POINTS = 400
"""samples of each side"""
PLACES: Reals = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 121)[1:-1])) / 2.0
"""chord fractions of the mean line and the half thickness, denser towards the edges"""
MEAN_LINE_POWERS = 5
"""coefficients of the polynomial that multiplies u (1 - u) in the mean line"""
WEDGE_PLACE, WEDGE_STEP = (0.02, 0.06), 0.06
"""range of the distance behind an edge at which its wedge angle is measured, and the length over which it is
(`WEDGE_STEP`), of the chord. Further back, at 6 to 16 %, lies the thickest place of LS89."""
MEAN_LINE_TURNS = 6
"""fixed-point iterations that bring the mean line to the middle of the sides"""


@dataclass(frozen=True, kw_only=True, eq=False)
class SampledSection:
    """A section whose chord line runs from (0, 0) to (1, 0), the upper side on its left."""

    chord: float
    """distance from edge to edge [m]"""
    stagger: float
    """angle of the chord line from the first axis [rad]"""
    start: Reals
    """(2,) the leading edge [m]"""
    upper: Reals
    """(n, 2) from leading to trailing edge"""
    lower: Reals
    """(n, 2) likewise"""
    radii: tuple[float, float]
    """of the leading and the trailing edge, of the chord"""

    @cached_property
    def _line(self) -> tuple[Reals, Reals]:
        """Coefficients of the mean line's polynomial, and half thicknesses at PLACES."""
        weights: Reals = np.zeros(MEAN_LINE_POWERS)
        half: Reals = np.zeros(len(PLACES))
        for _ in range(MEAN_LINE_TURNS):
            heights = [self._heights(side, weights) for side in (self.upper, self.lower)]
            half, middle = 0.5 * (heights[0] - heights[1]), 0.5 * (heights[0] + heights[1])
            slope = _polynomial(weights, PLACES, 1)
            wanted = _polynomial(weights, PLACES, 0) + middle * np.sqrt(1.0 + slope**2)
            rows = (PLACES * (1.0 - PLACES))[:, None] * PLACES[:, None] ** np.arange(MEAN_LINE_POWERS)
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
        near = float(np.clip(self.radii[end], *WEDGE_PLACE))
        places = (near, near + WEDGE_STEP) if end == 0 else (1.0 - near, 1.0 - near - WEDGE_STEP)
        return 2.0 * float(np.arctan((self.half_at(places[1]) - self.half_at(places[0])) / WEDGE_STEP))


def reversed_flow(section: SampledSection) -> SampledSection:
    """The same section for flow from the other side: its edges exchanged, its sides kept."""
    turn = np.array([-1.0, 1.0])
    end = section.start + section.chord * np.array([np.cos(section.stagger), np.sin(section.stagger)])
    return SampledSection(
        chord=section.chord,
        stagger=-section.stagger,
        start=turn * end,
        upper=np.array([1.0, 0.0]) + turn * section.upper[::-1],
        lower=np.array([1.0, 0.0]) + turn * section.lower[::-1],
        radii=section.radii[::-1],
    )


def sampled_section(upper: Curve, lower: Curve, radii: tuple[float, float]) -> SampledSection:
    """The samples of a section in its plane, from its sides [m] and its edges' radii [m]."""
    u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, SIDE_POINTS))) / 2.0
    above, below, found = sides_between_edges(np.real(upper(u)), np.real(lower(u)))
    sides, radii = [above, below], found or radii
    # the chord line ends in the middle of a blunt edge
    start, end = (0.5 * (sides[0][at] + sides[1][at]) for at in (0, -1))
    along = end - start
    chord, stagger = float(np.hypot(*along)), float(np.arctan2(along[1], along[0]))
    turn = np.array([[np.cos(stagger), -np.sin(stagger)], [np.sin(stagger), np.cos(stagger)]]) / chord
    first, second = ((side - start) @ turn for side in sides)
    return SampledSection(
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
