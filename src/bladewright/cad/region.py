"""The region of the parameter plane that a face keeps: inside its trimming loops, or the whole rectangle."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from bladewright.cad.surface_evaluation import SurfaceEvaluator
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import greville
from bladewright.nurbs.curve import Curve

POINTS_PER_CURVE = 400
"""Points of the boundary polygon on each trimming curve. They only start the search for the nearest point of the true
curve, which is then found by Newton steps, so that the number trades time for safety, not for accuracy."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Region:
    """A face: the surface under it, and the closed loops of parameter curves that trim it, the face to their left."""

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
        """Parameters moved by whole periods to where the face lies, and clipped to the bounds."""
        uv = np.array(uv)
        if self.evaluator.period:
            middle = 0.5 * (self.low[0] + self.high[0])
            uv[:, 0] -= self.evaluator.period * np.round((uv[:, 0] - middle) / self.evaluator.period)
            uv[:, 1] = np.clip(uv[:, 1], self.low[1], self.high[1])
            return uv
        return np.clip(uv, self.low, self.high)

    def contains(self, uv: Array) -> Array:
        """Whether parameters (n, 2) lie in the face; decided on the true trimming curves, also next to them."""
        return self.boundary.contains(uv) if self.loops else np.ones(len(uv), dtype=bool)

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

    @cached_property
    def _sag(self) -> Array:
        """(n,) [mm] Eight times the distance between polygon and curve next to each vertex, by second differences."""
        steps = (self.uv[self.following] - self.uv) * self.region.scale
        turns = np.sqrt(_square(steps - steps[self.preceding]))
        return np.maximum(turns, np.maximum(turns[self.following], turns[self.preceding]))

    def contains(self, uv: Array) -> Array:
        """Whether parameters (n, 2) lie inside: to the left of the nearest point of the boundary.

        At a vertex the mean of the tangents on both sides decides (Baerentzen and Aanaes 2005); nearer to the polygon
        than its deviation from the curve, the curve itself decides.
        """
        scale = self.region.scale
        _, near = self._parameter_tree.query(uv * scale)
        offset = (uv - self.uv[near]) * scale
        onward = _unit((self.uv[self.following[near]] - self.uv[near]) * scale)
        onto = _unit((self.uv[near] - self.uv[self.preceding[near]]) * scale)
        # the nearest point lies on the segment along which the offset has a component, else it is the vertex
        tangent = onward + onto
        tangent = np.where((_dot(offset, onward) > 0.0)[:, None], onward, tangent)
        tangent = np.where(((_dot(offset, onto) < 0.0) & (_dot(offset, onward) <= 0.0))[:, None], onto, tangent)
        height = tangent[:, 0] * offset[:, 1] - tangent[:, 1] * offset[:, 0]
        inside = height > 0.0
        close = np.flatnonzero(np.abs(height) <= self._sag[near] + 1e-12 * scale.max())
        if len(close):
            inside[close] = self._left_of_curve(uv[close], near[close], inside[close])
        return inside

    def _left_of_curve(self, uv: Array, near: Array, of_polygon: Array) -> Array:
        """Whether parameters lie to the left of their curve; `of_polygon` where a curve's end is nearest."""
        inside = np.array(of_polygon)
        scale = self.region.scale
        for index in np.unique(self.curve[near]):
            mine = np.flatnonzero(self.curve[near] == index)
            curve = self.curves[index]
            first, last = curve.knots[0], curve.knots[-1]
            s = self.parameter[near[mine]]
            for _ in range(6):
                tangent, miss = curve.derivative(s) * scale, (uv[mine] - curve(s)) * scale
                s = np.clip(s + _dot(tangent, miss) / _dot(tangent, tangent), first, last)
            tangent, miss = curve.derivative(s) * scale, (uv[mine] - curve(s)) * scale
            within = (s > first) & (s < last)
            side = tangent[:, 0] * miss[:, 1] - tangent[:, 1] * miss[:, 0] >= 0.0
            inside[mine[within]] = side[within]
        return inside

    def nearest(self, uv: Array) -> Array:
        """The vertices (n, 2) nearest to parameters (n, 2)."""
        return self.uv[self._parameter_tree.query(uv * self.region.scale)[1]] if len(uv) else np.zeros((0, 2))

    def closest(self, points: Array) -> tuple[Array, Array]:
        """Parameters (n, 2) and distances (n,) [mm] of the points of the boundary nearest to points (n, 3)."""
        _, near = self._space_tree.query(points)
        uv, distance = np.array(self.uv[near]), np.full(len(points), np.inf)
        # the nearest vertex may be the end of one curve and the start of the next: both are tried
        for start in (near, self.preceding[near]):
            for index in np.unique(self.curve[start]):
                mine = np.flatnonzero(self.curve[start] == index)
                curve = self.curves[index]
                s = self.parameter[start[mine]]
                for _ in range(8):
                    at, along, across = self.region.evaluator.frame(curve(s))
                    turn = curve.derivative(s)
                    tangent = turn[:, :1] * along + turn[:, 1:] * across
                    step = _dot(tangent, points[mine] - at) / _dot(tangent, tangent)
                    moved = np.clip(s + step, curve.knots[0], curve.knots[-1])
                    settled = np.max(np.abs(moved - s)) <= 1e-12 * (curve.knots[-1] - curve.knots[0])
                    s = moved
                    if settled:
                        break
                place = curve(s)
                away = np.sqrt(_square(self.region.points(place) - points[mine]))
                better = away < distance[mine]
                uv[mine[better]], distance[mine[better]] = place[better], away[better]
        return uv, distance


def greville_spaced(knots: Array, degree: int, count: int) -> Array:
    """Parameters (count,) over the whole domain, distributed as the Greville abscissae are."""
    sites = np.unique(greville(knots, degree))
    return np.interp(np.linspace(0.0, len(sites) - 1.0, count), np.arange(len(sites)), sites)


def _dot(a: Array, b: Array) -> Array:
    # a sum over an axis of two or three entries takes ten times as long
    return np.einsum("ij,ij->i", a, b)


def _square(a: Array) -> Array:
    return np.einsum("ij,ij->i", a, a)


def _unit(a: Array) -> Array:
    return a / np.maximum(np.sqrt(_square(a)), 1e-300)[..., None]
