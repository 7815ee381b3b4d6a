"""What every family begins with: the sections of a closed blade, in chords, and its flow path and edge curves."""

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial.polynomial import polyfit, polyval
from numpy.typing import ArrayLike
from scipy.integrate import cumulative_trapezoid
from scipy.spatial import cKDTree

from bladewright.blade.design.flow_path import FlowPath
from bladewright.blade.design.meridional_curve import ControlPolygon, Meridian, ThroughPoints
from bladewright.blade.flow_path.stream_surfaces import stream_surfaces
from bladewright.designs import Point
from bladewright.errors import DesignError, FitError
from bladewright.fitting.free_parameters import WALLS
from bladewright.numerics.elementary import cumulative_length, unit
from bladewright.nurbs.basis import Reals, basis, uniform_knots
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


WALL_COUNTS = (3, 4, 5, 7, 9)
"""points on each wall beside the blade; the fewest are taken that are near enough (design/matching_constants.md)"""
WALL_DISTANCE = 0.01
"""distance from a wall that is near enough, of its length: points show it no better (design/matching_constants.md)"""
WALL_MARGIN = 0.1
"""distance of the first and last of these points from the blade, of its length (design/matching_constants.md)"""
CONTINUATIONS = (0.8, 0.4, 0.2)
"""lengths of straight continuations that are tried in turn, of the wall's (design/matching_constants.md)"""
DIRECTION_SHARE = 0.25
"""share of a wall beside an end that shows where it goes on: the corner itself may be a hook (design/matching.md)"""
LEAST_RADIUS = 0.6
"""share of the radius at its end that the continuation may lose, not to meet the axis (design/matching_constants.md)"""
EDGE_POINTS = 4
"""points on an edge curve (design/matching_constants.md)"""
EDGE_OVERREACH = 0.06
"""length by which an edge curve reaches past the walls, of its length (design/matching_constants.md)"""
OPPOSITE_CURVE = {"leading_edge": "trailing_edge", "trailing_edge": "leading_edge", "hub": "shroud", "shroud": "hub"}
"""the curve in whose place each stands when the flow comes from the other side"""
CURVE_PLACES: Reals = np.linspace(0.0, 1.0, 201)
"""parameters at which curves are sampled"""


@dataclass(frozen=True, kw_only=True)
class ClosedChannel:
    """A closed blade's channel, for the flow that it was found for, or for flow from the other side."""

    exact: Any
    """the exact blade"""
    backwards: bool = False

    def values(self, name: str, at: Reals) -> Reals:
        """Points (m, 2) of one of the four curves in (x, r) [m]: walls downstream, edges from hub to shroud."""
        channel = self.exact.channel
        if self.backwards:
            name, at = OPPOSITE_CURVE[name], 1.0 - at
        return np.asarray(np.real(channel.line(name).values(at)))

    def flow_path(self, metre: float, *, revolved: bool) -> FlowPath:
        """Hub and shroud, continued straight by equal parts of their lengths, so that the blade's ends match.

        How far says which of their points are joined; where these surfaces fold, fractions count from edge to edge.
        """
        lines = [self.values(name, CURVE_PLACES) for name in WALLS]
        for longest in CONTINUATIONS:
            # a cascade has no axis, and its span may lie anywhere
            most = [np.full(2, longest)] if not revolved else [_shares_off_axis(line, longest) for line in lines]
            shares = np.min(most, axis=0)
            hub, shroud = (ThroughPoints(points=_points(_wall(line, shares), metre)) for line in lines)
            path = FlowPath(hub=hub, shroud=shroud)
            with suppress(DesignError):
                stream_surfaces(path, metre, revolved=revolved)
                return path
        return replace(path, matched="edges")

    def edge(self, name: str, metre: float) -> ThroughPoints:
        """An edge as a straight curve through a few points that reaches past both walls, as far as these may be off."""
        own, *walls = (cumulative_length(self.values(curve, CURVE_PLACES))[-1] for curve in (name, *WALLS))
        first, last = self._reaching_past_walls(name, EDGE_OVERREACH + 2.0 * WALL_DISTANCE * max(walls) / own)
        return ThroughPoints(points=_points(np.linspace(first, last, EDGE_POINTS), metre))

    def edge_like(self, name: str, curve: Any, metre: float) -> Meridian:
        """The edge with the points of another curve, in their places along the edge."""
        if not isinstance(curve, ThroughPoints | ControlPolygon):
            raise FitError(
                f"the {name} of `like` is given by corners or by a stacking: only points or control points are "
                "fitted; give the design as start"
            )
        given = metre * np.real(np.array(curve.given))
        # how far it reaches past the walls, the given points say
        line = self._reaching_past_walls(name, 1.0)
        # the coordinate in which the edge has its extent is held, the other is the edge's there
        held = 1 if np.ptp(given[:, 1]) >= np.ptp(given[:, 0]) else 0
        order = np.argsort(line[:, held])
        rows = np.eye(len(given))
        if isinstance(curve, ControlPolygon):
            degree = min(len(given) - 1, curve.degree)
            rows = basis(uniform_knots(len(given), degree), degree, CURVE_PLACES)
        wanted = np.interp(rows @ given[:, held], line[order, held], line[order, 1 - held])
        given[:, 1 - held] = np.linalg.lstsq(rows, wanted, rcond=None)[0]
        points: dict[str, Any] = {"control_points" if curve.polygon else "points": _points(given, metre)}
        return replace(curve, **points)

    def _reaching_past_walls(self, name: str, share: float) -> Reals:
        """The ends (2, 2) of the straight line nearest to an edge, past both walls by a share of its length."""
        # a corner may have slid along its wall, and a line through it would meet that wall twice
        line = polyfit(CURVE_PLACES, self.values(name, CURVE_PLACES), 1)
        return np.asarray(polyval(np.array([-share, 1.0 + share]), line).T)


def _wall(line: Reals, shares: Reals) -> Reals:
    """Points of a wall, a line (n, 2) continued straight by shares (2,) of it: as few as follow it."""
    size = float(cumulative_length(line)[-1])
    first, last = (shares * size)[:, None] * _outward(line)
    longer = np.concatenate([[line[0] + first], line, [line[-1] + last]])
    along = cumulative_length(longer)
    low, high = along[1] - WALL_MARGIN * size, along[-2] + WALL_MARGIN * size
    for count in WALL_COUNTS:
        at = np.concatenate([along[:1], np.linspace(max(low, 0.5 * along[1]), high, count), along[-1:]])
        at[-2] = min(at[-2], 0.5 * (along[-1] + along[-2]))
        rows = np.stack([np.interp(at, along, axis) for axis in longer.T], axis=-1)
        curve = np.real(ThroughPoints(points=_points(rows, 1.0)).line(1.0).values(np.linspace(0.0, 1.0, 801)))
        if np.max(cKDTree(curve).query(line)[0]) <= WALL_DISTANCE * size:
            break
    return rows


def _outward(line: Reals) -> Reals:
    """The directions (2, 2) in which a line leaves its ends, those of parabolas beside them."""
    count = max(3, round(DIRECTION_SHARE * len(line)))
    places = np.arange(count, dtype=np.float64)
    ends = [polyfit(places, each[:count], 2) for each in (line, line[::-1])]
    return unit(np.stack([-each[1] for each in ends]))


def _shares_off_axis(line: Reals, longest: float) -> Reals:
    """The shares (2,) of a line's length by which it may be continued at its ends, so as to keep off the axis."""
    fall = -float(cumulative_length(line)[-1]) * _outward(line)[:, 1]
    most = LEAST_RADIUS * np.maximum(line[[0, -1], 1], 0.0)
    return np.minimum(longest, np.divide(most, fall, out=np.full(2, np.inf), where=fall > 0.0))


def _points(rows: ArrayLike, metre: float) -> tuple[Point, ...]:
    return tuple(Point(*row) for row in (np.asarray(rows) / metre).tolist())
