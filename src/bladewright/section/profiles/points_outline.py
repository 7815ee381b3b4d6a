"""Sections through a closed contour of points: where its edges and corners are, and the splines between them."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross2, dot, magnitude
from bladewright.numerics.roots import bracketed_root
from bladewright.nurbs.basis import Reals
from bladewright.section.offset import merged_joints
from bladewright.section.outline import Edge, EdgeDerivatives, Joint, Outline
from bladewright.section.power_series import Series, point_derivatives, polynomial, variable
from bladewright.section.profiles.quintic_spline import QuinticSpline

MIN_CORNER_TURNING = 30.0
"""turning of a contour's polygon from which a point may be a corner: a smooth nose of six points or more turns by less
at each [deg]"""
MAX_NEIGHBOUR_TURNING = 0.1
"""largest turning at the neighbours of a corner, of the corner's own: on a round nose neighbours turn as much
[-]"""
EDGE_SPEED = 0.5
"""speed of the spline's parameter by s at the edges, of the mean of both sides: half of it, because the curvature is
largest there [-]"""
STEPS = 40
"""Newton steps to the ends of the chord line at most; they start at the farthest points, and few are taken"""
SETTLED = 1e-8
"""size of the last Newton step, of the longest that is allowed: its error is the square of that, below rounding [-]"""
CAMBER = 6
"""degree of the camber line less two: for an oval two degrees more come nearer to the middle of the sides by a sixth
(design/section_constants.py), and leave the line less smooth for the passage's boundaries"""
MIDDLE = (0.15, 0.85)
"""s between which the camber line is fitted to the middle of the sides, which is no camber line near a
round edge [-]"""
MIDDLES = 43
"""places at which it is fitted, six for each coefficient"""
SAME_PLACE = 1e-9
"""difference by s below which a joint is at the same place in all sections: above rounding of a root [-]"""
Indices = NDArray[np.intp]
Kind = Literal["round", "sharp", "blunt"]


class Contour(NamedTuple):
    """Indices of a contour's points, counter-clockwise, and where its edges are among them."""

    order: Indices
    """indices of the points as given, from the trailing edge, or from the leading edge where only that is broken"""
    leading: tuple[int, ...]
    """places in `order` of the leading edge's corners, or of the point farthest from the trailing edge"""
    trailing: tuple[int, ...]
    """places in `order` of the trailing edge's corners, or of the point farthest from the leading edge"""
    kinds: tuple[Kind, Kind]
    """of the leading and the trailing edge"""


def contour(points: Reals) -> Contour:
    """The contour of points (n, 2) in order along it, in either sense; the leading edge has the smaller abscissa.

    A corner is a point where the polygon turns by 30 deg or more and ten times as much as beside it. Raises
    DesignError for corners that are not at the edges.
    """
    order = np.arange(len(points))
    ahead = np.roll(points, -1, axis=0)
    if np.sum(cross2(points, ahead)) < 0.0:
        order = order[::-1]
    placed = points[order]
    differences = placed[:, None] - placed
    first, second = np.unravel_index(np.argmax(dot(differences, differences)), differences.shape[:2])
    le, te = (int(first), int(second)) if placed[first, 0] < placed[second, 0] else (int(second), int(first))
    corners = [int(i) for i in _corners(placed)]
    chord = placed[te] - placed[le]
    along = (placed - placed[le]) @ chord / dot(chord, chord)
    ends: list[tuple[int, ...]] = []
    for tip, there in ((le, along < 0.1), (te, along > 0.9)):
        own = tuple(i for i in corners if there[i])
        if len(own) > 2 or (len(own) == 2 and (own[1] - own[0]) % len(placed) not in (1, len(placed) - 1)):
            raise _misplaced(order[own[0]], placed[own[0]])
        ends.append(own or (tip,))
    for i in corners:
        if all(i not in end for end in ends):
            raise _misplaced(order[i], placed[i])
    kinds: list[Kind] = ["round" if end[0] not in corners else "sharp" if len(end) == 1 else "blunt" for end in ends]
    leading, trailing = (_ordered(end, len(placed)) for end in ends)
    start = leading[-1] if kinds[1] == "round" and kinds[0] != "round" else trailing[-1]
    turned = (np.arange(len(placed)) + start) % len(placed)
    where = {int(i): k for k, i in enumerate(turned)}
    return Contour(
        order=order[turned],
        leading=tuple(where[i] for i in leading),
        trailing=tuple(where[i] for i in trailing),
        kinds=(kinds[0], kinds[1]),
    )


def _ordered(end: tuple[int, ...], count: int) -> tuple[int, ...]:
    """The corners of an edge in the sense of the contour."""
    return end if len(end) == 1 or (end[1] - end[0]) % count == 1 else end[::-1]


def _corners(points: Reals) -> Indices:
    """Indices of the points of a closed polygon (n, 2) that are corners."""
    ahead = np.roll(points, -1, axis=0) - points
    behind = np.roll(ahead, 1, axis=0)
    turning = np.degrees(np.arctan2(cross2(behind, ahead), dot(behind, ahead)))  # real: points to judge by
    size = np.abs(turning)  # real: angles
    before, after = np.roll(size, 1), np.roll(size, -1)
    # at a blunt edge the other corner is no smooth neighbour: both are judged together, by the neighbours outside
    paired = (size >= MIN_CORNER_TURNING) & (np.maximum(before, after) >= MIN_CORNER_TURNING)
    whole = np.where(paired, size + np.maximum(before, after), size)
    neighbours = np.where(paired, np.minimum(before, after), np.maximum(before, after))
    return np.flatnonzero((size >= MIN_CORNER_TURNING) & (neighbours <= MAX_NEIGHBOUR_TURNING * whole))


def _misplaced(index: int, point: Reals) -> DesignError:
    return DesignError(
        f"the contour has a corner at point {int(index)}, ({point[0]:g}, {point[1]:g}), that is not one of an edge: "
        "profiles are smooth but for sharp edges, one point each, and blunt ones, two points each; give more points "
        "there, or take the corner away"
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class SplineSide:
    """A piece of a spline, from leading to trailing edge."""

    spline: QuinticSpline
    start: Array
    """parameter (...) at the leading edge"""
    end: Array
    """parameter (...) at the trailing edge"""

    def parameter(self, s: Series, edge_speed: Array) -> Series:
        """The spline's parameter at s (k,): with the speed `edge_speed` (...) and no second derivative at both ends."""
        way = (self.end - self.start)[..., None]
        own = np.where(np.real(way) < 0.0, -1.0, 1.0) * edge_speed[..., None]
        eased = polynomial(
            [np.zeros(()), np.zeros(()), np.zeros(()), np.array(10.0), np.array(-15.0), np.array(6.0)], s
        )
        return s * own + eased * (way - own) + self.start[..., None]


@dataclass(frozen=True, kw_only=True, eq=False)
class PointsOutline(Outline):
    """Sections (...) through points (..., n, 2) in the order of their contour."""

    given: Array
    contour: Contour

    @property
    def leading_edge(self) -> Edge:
        """Round, sharp or blunt, as the points are."""
        return self._edge(0.0, 0)

    @property
    def trailing_edge(self) -> Edge:
        """Round, sharp or blunt, as the points are."""
        return self._edge(1.0, 1)

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """Knots of the splines, where they are at the same s in all sections."""
        found = []
        for side in self._sides:
            lengths = [np.real(side.start)[..., None], np.real(side.end)[..., None]]
            knots, edge_speed = side.spline.breaks, np.real(self._edge_speed)
            whole = np.real(side.spline.sites)[..., -1:] if side.spline.closed else 0.0
            for shift in (-1.0, 0.0, 1.0) if side.spline.closed else (0.0,):
                places = knots + shift * whole
                low, high = np.minimum(*lengths), np.maximum(*lengths)
                inside = np.all((places > low) & (places < high), axis=tuple(range(places.ndim - 1)))
                if np.any(inside):
                    found += self._joints_of(side, places[..., inside], edge_speed)
        return merged_joints(found)

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., len(s), 2) of the upper and the lower side."""
        upper, lower = (
            np.stack(np.broadcast_arrays(*(each.value for each in self._in_chords(side, s, 0))), axis=-1)
            for side in self._sides
        )
        return upper, lower

    @property
    def has_exact_derivatives(self) -> bool:
        return True

    def derivatives(self, s: Reals, order: int) -> tuple[Array, Array]:
        """Points and derivatives by s (..., k, 2, order + 1) of both sides, exact."""
        upper, lower = (point_derivatives(*self._in_chords(side, s, order)) for side in self._sides)
        return upper, lower

    def camber(self, s: Reals) -> Array:
        """Points (..., len(s), 2) of the polynomial nearest to the middle between the sides, away from the edges."""
        x = np.sin(0.5 * np.pi * s) ** 2
        rows = np.polynomial.chebyshev.chebvander(2.0 * x - 1.0, CAMBER) * (x * (1.0 - x))[:, None]
        height = self._camber @ rows.T
        return np.stack(np.broadcast_arrays(x, height), axis=-1)

    @property
    def camber_breaks(self) -> Reals:
        """None: the camber line is one polynomial."""
        return np.empty(0)

    @cached_property
    def _camber(self) -> Array:
        """Coefficients (..., c) of the Chebyshev polynomials that x (1 - x) is multiplied by, by least squares."""
        upper, lower = self.points(np.linspace(*MIDDLE, MIDDLES))
        middle = 0.5 * (upper + lower)
        x = middle[..., 0]
        rows = [x * (1.0 - x)]
        rows.append(rows[0] * (2.0 * x - 1.0))
        for _ in range(CAMBER - 1):
            rows.append(2.0 * (2.0 * x - 1.0) * rows[-1] - rows[-2])
        matrix = np.stack(rows, axis=-1)
        turned = np.swapaxes(matrix, -1, -2)
        # the normal equations stay analytic, and with so few polynomials they are well conditioned
        return np.linalg.solve(turned @ matrix, turned @ middle[..., 1:])[..., 0]

    @cached_property
    def _sides(self) -> tuple[SplineSide, SplineSide]:
        """The upper and the lower side."""
        given, shape = self.given, self.contour
        closing = np.concatenate([given, given[..., :1, :]], axis=-2)
        zero = 0.0 * given[..., 0, 0]
        if shape.kinds == ("round", "round"):
            spline = QuinticSpline(points=given, closed=True)
            whole = spline.sites[..., -1]
            leading, trailing = self._ends(spline, spline.sites[..., shape.leading[0]], zero)
            return (
                SplineSide(spline=spline, start=leading, end=trailing),
                SplineSide(spline=spline, start=leading, end=trailing + whole),
            )
        broken = 0 if shape.kinds[1] == "round" else 1
        around = closing if shape.kinds[broken] == "sharp" else given
        if "round" in shape.kinds:
            spline = QuinticSpline(points=around, closed=False)
            last = spline.sites[..., -1]
            own = shape.leading if broken else shape.trailing
            tip = 0.5 * (around[..., 0, :] + around[..., -1, :])
            edge = self._farthest(spline, spline.sites[..., own[0]], tip)
            if broken:
                return SplineSide(spline=spline, start=edge, end=zero), SplineSide(spline=spline, start=edge, end=last)
            return SplineSide(spline=spline, start=last, end=edge), SplineSide(spline=spline, start=zero, end=edge)
        upper = QuinticSpline(points=given[..., : shape.leading[0] + 1, :], closed=False)
        lower = QuinticSpline(points=around[..., shape.leading[-1] :, :], closed=False)
        return (
            SplineSide(spline=upper, start=upper.sites[..., -1], end=zero),
            SplineSide(spline=lower, start=zero, end=lower.sites[..., -1]),
        )

    @staticmethod
    def _farthest(spline: QuinticSpline, start: Array, tip: Array) -> Array:
        """Parameter (...) of the spline's point farthest from a tip (..., 2), near a start, by Newton's method."""
        t = start
        limit = 0.02 * np.real(spline.sites[..., -1])
        for _ in range(STEPS):
            x, y = (each.coefficients for each in spline.at(variable(t[..., None], 2)))
            point, first, second = (np.stack([x[k][..., 0], y[k][..., 0]], axis=-1) * (1, 1, 2)[k] for k in range(3))
            difference = point - tip
            step = -dot(difference, first) / (dot(first, first) + dot(difference, second))
            t = t + np.where(magnitude(np.real(step)) > limit, np.copysign(limit, np.real(step)), step)
            if np.all(magnitude(np.real(step)) <= SETTLED * limit):
                break
        return t

    @staticmethod
    def _ends(spline: QuinticSpline, leading: Array, trailing: Array) -> tuple[Array, Array]:
        """Parameters (...) of the two points farthest from each other, near given ones, by Newton's method."""
        limit = 0.02 * np.real(spline.sites[..., -1])
        for _ in range(STEPS):
            rows = []
            for t in (leading, trailing):
                x, y = (each.coefficients for each in spline.at(variable(t[..., None], 2)))
                rows.append([np.stack([x[k][..., 0], y[k][..., 0]], axis=-1) * (1, 1, 2)[k] for k in range(3)])
            (a, da, dda), (b, db, ddb) = rows
            difference = a - b
            values = dot(difference, da), -dot(difference, db)
            own = dot(da, da) + dot(difference, dda), dot(db, db) - dot(difference, ddb)
            both = -dot(da, db)
            determinant = own[0] * own[1] - both * both
            steps = (
                -(values[0] * own[1] - values[1] * both) / determinant,
                -(values[1] * own[0] - values[0] * both) / determinant,
            )
            leading, trailing = (
                t + np.where(magnitude(np.real(step)) > limit, np.copysign(limit, np.real(step)), step)
                for t, step in zip((leading, trailing), steps, strict=True)
            )
            if all(np.all(magnitude(np.real(step)) <= SETTLED * limit) for step in steps):
                break
        return leading, trailing

    @cached_property
    def _edge_speed(self) -> Array:
        ways = [side.end - side.start for side in self._sides]
        return 0.5 * EDGE_SPEED * (magnitude(ways[0]) + magnitude(ways[1]))

    @cached_property
    def chord_line(self) -> tuple[Array, Array]:
        """The leading edge (..., 2), and the way to the trailing edge (..., 2)."""
        tips = []
        for at in ("start", "end"):
            found = []
            for side in self._sides:
                pair = side.spline.at(Series([getattr(side, at)[..., None]]))
                found.append(np.stack([each.value[..., 0] for each in pair], axis=-1))
            tips.append(0.5 * (found[0] + found[1]))
        return tips[0], tips[1] - tips[0]

    def _in_chords(self, side: SplineSide, s: Reals, order: int) -> tuple[Series, Series]:
        x, y = side.spline.at(side.parameter(variable(s, order), self._edge_speed))
        start, way = self.chord_line
        square = dot(way, way)[..., None]
        difference = x - start[..., 0, None], y - start[..., 1, None]
        cosine, sine = way[..., 0, None] / square, way[..., 1, None] / square
        return difference[0] * cosine + difference[1] * sine, difference[1] * cosine - difference[0] * sine

    def _joints_of(self, side: SplineSide, places: Reals, edge_speed: Reals) -> list[Joint]:
        def difference(s: Array) -> tuple[Array, Array]:
            found = side.parameter(variable(s, 1), edge_speed)
            return np.real(found.value) - places, np.real(found.coefficients[1])

        s = bracketed_root(difference, np.zeros(places.shape), np.ones(places.shape))
        rows = s.reshape(-1, s.shape[-1])
        return [Joint(float(row[0]), 4) for row in rows.T if np.ptp(row) <= SAME_PLACE]

    def _edge(self, s: float, end: int) -> Edge:
        upper, lower = (EdgeDerivatives.of_side(side) for side in self.derivatives(np.array([s]), 2))
        return Edge(kind=self.contour.kinds[end], upper=upper, lower=lower)
