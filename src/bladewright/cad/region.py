"""The region of the parameter plane that a face keeps: inside its trimming loops, or the whole rectangle."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.cad.surface_evaluation import SurfaceEvaluator
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import greville
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.trim_loop import TrimLoop, contained, trim_loop

POINTS_PER_CURVE = 400
"""Points of the boundary polygon on each trimming curve. They only start the search for the nearest point of the true
curve, which is then found by Newton steps, so that the number trades time for safety, not for accuracy."""


SEAM = 1e-9
"""Largest distance of the two sides of a seam, as a fraction of the face's extent: so much may be a file's rounding."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Region:
    """A face: the surface under it, and the closed loops of parameter curves that trim it."""

    evaluator: SurfaceEvaluator
    loops: tuple[tuple[Curve, ...], ...]
    """none where the face is the whole parameter rectangle"""
    low: Array
    """(2,) lower bounds of the parameters"""
    high: Array
    """(2,) upper bounds of the parameters"""

    @cached_property
    def boundary(self) -> "BoundaryPolygon":
        """The trimming loops as a dense polygon."""
        return BoundaryPolygon.of(self)

    def points(self, uv: Array) -> Array:
        """Points (n, 3) [mm]."""
        return self.evaluator.frame(uv)[0]

    @cached_property
    def scale(self) -> Array:
        """(2,) root mean square length [mm] of the derivatives by the two parameters: millimetres per unit of each."""
        share = np.stack(np.meshgrid(*([np.linspace(0.02, 0.98, 7)] * 2)), axis=-1).reshape(-1, 2)
        _, along, across = self.evaluator.frame(self.low + share * (self.high - self.low))
        return np.array([np.sqrt(np.mean(np.sum(t * t, axis=-1))) for t in (along, across)])

    def into_domain(self, uv: Array) -> Array:
        """Parameters moved by whole periods to where the face lies, and clipped to the bounds but across seams."""
        uv = np.array(uv)
        if self.evaluator.period:
            middle = 0.5 * (self.low[0] + self.high[0])
            uv[:, 0] -= self.evaluator.period * np.round((uv[:, 0] - middle) / self.evaluator.period)
            uv[:, 1] = np.clip(uv[:, 1], self.low[1], self.high[1])
            return uv
        across_seam = self.low + (uv - self.low) % (self.high - self.low)
        return np.where(self._closed, across_seam, np.clip(uv, self.low, self.high))

    @cached_property
    def _closed(self) -> NDArray[np.bool_]:
        """(2,) whether the face is a whole turn in either parameter, so that it goes on beyond its seam."""
        surface = getattr(self.evaluator, "surface", None)
        if self.loops or surface is None:
            return np.zeros(2, dtype=bool)
        net = surface.control_points
        ends = [np.max(np.abs(np.take(net, 0, axis) - np.take(net, -1, axis))) for axis in (0, 1)]
        return np.array(ends) <= SEAM * np.ptp(net, axis=(0, 1)).max()

    def contains(self, uv: Array) -> Array:
        """Whether parameters (n, 2) lie in the face: inside an odd number of its loops."""
        return contained(self._loop, uv[:, 0], uv[:, 1]) if self.loops else np.ones(len(uv), dtype=bool)

    @cached_property
    def _loop(self) -> TrimLoop:
        return trim_loop(self.loops)

    def samples(self, count: int) -> Array:
        """Parameters (about count, 2) spread over the face and along its boundary."""
        if not self.loops:
            return self._rectangle_samples(count)
        every = np.arange(0, len(self.boundary.uv), max(1, len(self.boundary.uv) * 10 // count))
        # and the corners, where a face may degenerate to a point
        border = self.boundary.uv[np.union1d(every, np.arange(0, len(self.boundary.uv), POINTS_PER_CURVE))]
        lines = int(np.sqrt(count))
        inner = self._scan_line_samples(count - len(border), lines)
        # the polygon deviates from the true boundary: points outside the latter are moved to it
        outside = ~self.contains(inner)
        inner[outside] = self.boundary.nearest(inner[outside])
        return np.concatenate([border, inner])

    def _rectangle_samples(self, count: int) -> Array:
        lines = int(np.sqrt(count))
        u, v = (np.linspace(self.low[k], self.high[k], lines) for k in (0, 1))
        surface = getattr(self.evaluator, "surface", None)
        if surface is not None:
            # as dense as the control points, so that no displaced control point is missed
            u = greville_spaced(surface.knots_u, surface.degree_u, lines)
            v = greville_spaced(surface.knots_v, surface.degree_v, lines)
        return np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)

    def _scan_line_samples(self, count: int, lines: int) -> Array:
        """Points inside the boundary polygon, on parallel lines across its longer direction."""
        polygon, following = self.boundary.uv * self.scale, self.boundary.uv[self.boundary.following] * self.scale
        along = int(np.argmax(np.ptp(polygon, axis=0)))
        low, high = polygon[:, along].min(), polygon[:, along].max()
        found = []
        shares = np.diff(np.linspace(0, count, lines + 1).astype(int))
        for level, wanted in zip(low + (np.arange(lines) + 0.5) / lines * (high - low), shares, strict=True):
            start, end = polygon[:, along] - level, following[:, along] - level
            crossed = (start < 0.0) != (end < 0.0)
            share = start[crossed] / (start[crossed] - end[crossed])
            other = 1 - along
            at = np.sort(polygon[crossed, other] + share * (following[crossed, other] - polygon[crossed, other]))
            widths = at[1::2] - at[::2]
            ends = np.concatenate([[0.0], np.cumsum(widths)])
            place = (np.arange(wanted) + 0.5) / wanted * ends[-1]
            gap = np.clip(np.searchsorted(ends, place, side="right") - 1, 0, len(widths) - 1)
            line = np.empty((wanted, 2))
            line[:, along], line[:, other] = level, at[::2][gap] + place - ends[gap]
            found.append(line)
        return np.concatenate(found) / self.scale


@dataclass(frozen=True, kw_only=True, eq=False)
class BoundaryPolygon:
    """The boundary of a face as a dense polygon, with the trimming curve that each vertex lies on."""

    region: Region
    curves: tuple[Curve, ...]
    uv: Array
    """(n, 2) vertices"""
    curve: Array
    """(n,) index of the curve that each vertex lies on"""
    parameter: Array
    """(n,) parameter of each vertex on its curve"""
    following: Array
    """(n,) index of the next vertex of the same loop"""
    preceding: Array
    """(n,) index of the previous vertex of the same loop"""

    @staticmethod
    def of(region: Region) -> "BoundaryPolygon":
        """The boundary of a region."""
        uv, which, parameters, loops = [], [], [], []
        total, index = 0, 0
        for loop in region.loops:
            first = total
            for curve in loop:
                s = greville_spaced(curve.knots, curve.degree, POINTS_PER_CURVE + 1)[:-1]
                uv.append(np.real(curve(s)))
                which.append(np.full(POINTS_PER_CURVE, index))
                parameters.append(s)
                total, index = total + POINTS_PER_CURVE, index + 1
            loops.append(np.arange(first + 1, total + 1))
            loops[-1][-1] = first
        following = np.concatenate(loops)
        preceding = np.empty_like(following)
        preceding[following] = np.arange(total)
        return BoundaryPolygon(
            region=region,
            curves=tuple(curve for loop in region.loops for curve in loop),
            uv=np.concatenate(uv),
            curve=np.concatenate(which),
            parameter=np.concatenate(parameters),
            following=following,
            preceding=preceding,
        )

    @cached_property
    def points(self) -> Array:
        """(n, 3) [mm]."""
        return self.region.points(self.uv)

    @cached_property
    def _parameter_tree(self) -> cKDTree:
        return cKDTree(self.uv * self.region.scale)

    @cached_property
    def _space_tree(self) -> cKDTree:
        return cKDTree(self.points)

    def nearest(self, uv: Array) -> Array:
        """The vertices (n, 2) nearest to parameters (n, 2)."""
        return self.uv[self._parameter_tree.query(uv * self.region.scale)[1]] if len(uv) else np.zeros((0, 2))

    def closest(self, points: Array, limit: float) -> tuple[Array, Array]:
        """Parameters (n, 2) and distances (n,) [mm] of the points of the boundary nearest to points (n, 3).

        The search starts from the nearest vertices. Where it ends further away than `limit` [mm], the boundary may
        nearly touch itself and the vertex lie across the gap: there it is repeated from everywhere nearby.
        """
        _, near = self._space_tree.query(points)
        every = np.arange(len(points))
        uv, distance = self._searched(points, np.tile(every, 2), np.concatenate([near, self.preceding[near]]))
        doubtful = np.flatnonzero(distance > limit)
        if len(doubtful):
            uv[doubtful], distance[doubtful] = self._searched(points[doubtful], *self._starts(points[doubtful]))
        return uv, distance

    def _searched(self, points: Array, which: Array, start: Array) -> tuple[Array, Array]:
        """The nearest point of the boundary to each of points (n, 3), of searches for `which` from vertices `start`."""
        uv, distance = np.zeros((len(which), 2)), np.zeros(len(which))
        for index, curve in enumerate(self.curves):
            mine = np.flatnonzero(self.curve[start] == index)
            wanted, s = points[which[mine]], self.parameter[start[mine]]
            for _ in range(8):
                at, along, across = self.region.evaluator.frame(curve(s))
                turn = curve.derivative(s)
                tangent = turn[:, :1] * along + turn[:, 1:] * across
                step = _dot(tangent, wanted - at) / _dot(tangent, tangent)
                moved = np.clip(s + step, curve.knots[0], curve.knots[-1])
                settled = np.max(np.abs(moved - s), initial=0.0) <= 1e-12 * (curve.knots[-1] - curve.knots[0])
                s = moved
                if settled:
                    break
            uv[mine] = curve(s)
            distance[mine] = np.sqrt(_square(self.region.points(uv[mine]) - wanted))
        order = np.lexsort((distance, which))
        best = order[np.unique(which[order], return_index=True)[1]]
        return uv[best], distance[best]

    def _starts(self, points: Array) -> tuple[Array, Array]:
        """Which of points (n, 3), and the vertex before a place that may be nearest to it: (k,) each."""
        away, _ = self._space_tree.query(points)
        steps = self.points[self.following] - self.points
        squares = np.maximum(_square(steps), 1e-300)
        # a segment as near as a vertex has an end within this
        ends = self._space_tree.query_ball_point(points, np.sqrt(away**2 + squares.max() / 4.0) * (1.0 + 1e-9))
        which = np.repeat(np.arange(len(points)), [len(found) for found in ends])
        vertex = np.concatenate([np.zeros(0, dtype=int), *ends]).astype(int)
        pairs = [which * len(self.uv) + segment for segment in (vertex, self.preceding[vertex])]
        which, start = np.divmod(np.unique(np.concatenate(pairs)), len(self.uv))
        offset = points[which] - self.points[start]
        share = np.clip(_dot(offset, steps[start]) / squares[start], 0.0, 1.0)
        away = np.sqrt(_square(offset - share[:, None] * steps[start]))
        # how far the curve may be from its polygon
        turns = np.sqrt(_square(steps - steps[self.preceding]))
        sag = np.maximum(turns, turns[self.following])[start] / 8.0
        nearest = np.full(len(points), np.inf)
        np.minimum.at(nearest, which, away + sag)
        kept = away - sag <= nearest[which]
        return which[kept], start[kept]


def greville_spaced(knots: Array, degree: int, count: int) -> Array:
    """Parameters (count,) over the whole domain, distributed as the Greville abscissae are."""
    sites = np.unique(greville(knots, degree))
    return np.interp(np.linspace(0.0, len(sites) - 1.0, count), np.arange(len(sites)), sites)


def _dot(a: Array, b: Array) -> Array:
    # a sum over an axis of two or three entries takes ten times as long
    return np.einsum("ij,ij->i", a, b)


def _square(a: Array) -> Array:
    return np.einsum("ij,ij->i", a, a)
