"""The part of a surface that a face keeps: inside closed chains of plane curves, or all of the parameter rectangle."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from bladewright.cad.surface_evaluation import SurfaceEvaluator
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import greville
from bladewright.nurbs.curve import Curve

POINTS_PER_CURVE = 400
"""points on each boundary curve"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Region:
    """A face: a carrier and the chains of curves (n, 2) in its parameters that bound it, the face to their left."""

    carrier: SurfaceEvaluator
    chains: tuple[tuple[Curve, ...], ...]
    """none where the face is the whole rectangle"""
    low: Array
    """(2,) smallest parameters of the carrier that are needed"""
    high: Array
    """(2,) largest parameters"""

    @cached_property
    def rim(self) -> "BoundaryPolygon":
        """The boundary, sampled."""
        return BoundaryPolygon.of(self)

    def points(self, uv: Array) -> Array:
        """Points (n, 3) [mm]."""
        return self.carrier.frame(uv)[0]

    @cached_property
    def scale(self) -> Array:
        """(2,) millimetres that a unit of each parameter is worth, on average."""
        share = np.stack(np.meshgrid(*([np.linspace(0.02, 0.98, 7)] * 2)), axis=-1).reshape(-1, 2)
        _, along, across = self.carrier.frame(self.low + share * (self.high - self.low))
        return np.array([np.sqrt(np.mean(np.sum(t * t, axis=-1))) for t in (along, across)])

    def brought_near(self, uv: Array) -> Array:
        """Parameters moved by whole periods to where the face is, and into the carrier's domain."""
        uv = np.array(uv)
        if self.carrier.period:
            middle = 0.5 * (self.low[0] + self.high[0])
            uv[:, 0] -= self.carrier.period * np.round((uv[:, 0] - middle) / self.carrier.period)
            uv[:, 1] = np.clip(uv[:, 1], self.low[1], self.high[1])
            return uv
        return np.clip(uv, self.low, self.high)

    def contains(self, uv: Array) -> Array:
        """Whether parameters (n, 2) lie in the face, exact also next to its boundary."""
        return self.rim.left(uv) if self.chains else np.ones(len(uv), dtype=bool)

    def sampled(self, count: int) -> Array:
        """Parameters (count, 2), spread over the face and along its boundary."""
        if not self.chains:
            return self._rectangle(count)
        every = np.arange(0, len(self.rim.uv), max(1, len(self.rim.uv) * 10 // count))
        # with the corners, where a face may collapse
        border = self.rim.uv[np.union1d(every, np.arange(0, len(self.rim.uv), POINTS_PER_CURVE))]
        lines = int(np.sqrt(count))
        inner = self._between(count - len(border), lines)
        # the polygon cuts corners: what it lets in by mistake goes to the true boundary
        astray = ~self.contains(inner)
        inner[astray] = self.rim.nearest(inner[astray])
        return np.concatenate([border, inner])

    def _rectangle(self, count: int) -> Array:
        lines = int(np.sqrt(count))
        u, v = (np.linspace(self.low[k], self.high[k], lines) for k in (0, 1))
        surface = getattr(self.carrier, "surface", None)
        if surface is not None:
            # as dense as the control points, so that no pole moves unseen
            u = greville_spaced(surface.knots_u, surface.degree_u, lines)
            v = greville_spaced(surface.knots_v, surface.degree_v, lines)
        return np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)

    def _between(self, count: int, lines: int) -> Array:
        """Points on lines across the polygon's longer direction."""
        polygon, ahead = self.rim.uv * self.scale, self.rim.uv[self.rim.ahead] * self.scale
        along = int(np.argmax(np.ptp(polygon, axis=0)))
        low, high = polygon[:, along].min(), polygon[:, along].max()
        found = []
        shares = np.diff(np.linspace(0, count, lines + 1).astype(int))
        for level, wanted in zip(low + (np.arange(lines) + 0.5) / lines * (high - low), shares, strict=True):
            start, end = polygon[:, along] - level, ahead[:, along] - level
            crossed = (start < 0.0) != (end < 0.0)
            share = start[crossed] / (start[crossed] - end[crossed])
            other = 1 - along
            at = np.sort(polygon[crossed, other] + share * (ahead[crossed, other] - polygon[crossed, other]))
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
    """The boundary of a face as a dense polygon that knows its curves."""

    region: Region
    curves: tuple[Curve, ...]
    uv: Array
    """(n, 2) points of the polygons"""
    curve: Array
    """(n,) which curve a point belongs to"""
    parameter: Array
    """(n,) its parameter there"""
    ahead: Array
    """(n,) index of the next point of its polygon"""
    behind: Array
    """(n,) index of the point before"""

    @staticmethod
    def of(region: Region) -> "BoundaryPolygon":
        """The boundary of a region."""
        uv, which, parameters, ahead = [], [], [], []
        total, index = 0, 0
        for chain in region.chains:
            first = total
            for curve in chain:
                s = greville_spaced(curve.knots, curve.degree, POINTS_PER_CURVE + 1)[:-1]
                uv.append(np.real(curve(s)))
                which.append(np.full(POINTS_PER_CURVE, index))
                parameters.append(s)
                total, index = total + POINTS_PER_CURVE, index + 1
            following = np.arange(first + 1, total + 1)
            following[-1] = first
            ahead.append(following)
        following = np.concatenate(ahead)
        behind = np.empty_like(following)
        behind[following] = np.arange(total)
        return BoundaryPolygon(
            region=region,
            curves=tuple(curve for chain in region.chains for curve in chain),
            uv=np.concatenate(uv),
            curve=np.concatenate(which),
            parameter=np.concatenate(parameters),
            ahead=following,
            behind=behind,
        )

    @cached_property
    def points(self) -> Array:
        """(n, 3) [mm]."""
        return self.region.points(self.uv)

    @cached_property
    def _flat(self) -> cKDTree:
        return cKDTree(self.uv * self.region.scale)

    @cached_property
    def _space(self) -> cKDTree:
        return cKDTree(self.points)

    @cached_property
    def _sag(self) -> Array:
        """(n,) [mm] eight times what the polygon cuts off the curve next to a point."""
        steps = (self.uv[self.ahead] - self.uv) * self.region.scale
        turns = np.sqrt(_square(steps - steps[self.behind]))
        return np.maximum(turns, np.maximum(turns[self.ahead], turns[self.behind]))

    def left(self, uv: Array) -> Array:
        """Whether parameters (n, 2) lie to the left of the boundary: of its nearest point.

        At a corner the mean of both normals decides (Baerentzen and Aanaes 2005); within the polygon's sag the curve
        itself does.
        """
        scale = self.region.scale
        _, near = self._flat.query(uv * scale)
        offset = (uv - self.uv[near]) * scale
        onward = _unit((self.uv[self.ahead[near]] - self.uv[near]) * scale)
        onto = _unit((self.uv[near] - self.uv[self.behind[near]]) * scale)
        # the nearest point lies on the segment that the offset leans to, else in the corner
        tangent = onward + onto
        tangent = np.where((_dot(offset, onward) > 0.0)[:, None], onward, tangent)
        tangent = np.where(((_dot(offset, onto) < 0.0) & (_dot(offset, onward) <= 0.0))[:, None], onto, tangent)
        height = tangent[:, 0] * offset[:, 1] - tangent[:, 1] * offset[:, 0]
        inside = height > 0.0
        close = np.flatnonzero(np.abs(height) <= self._sag[near] + 1e-12 * scale.max())
        if len(close):
            inside[close] = self._left_of_curve(uv[close], near[close], inside[close])
        return inside

    def _left_of_curve(self, uv: Array, near: Array, otherwise: Array) -> Array:
        inside = np.array(otherwise)
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
        """The polygon's points (n, 2) nearest to parameters (n, 2)."""
        return self.uv[self._flat.query(uv * self.region.scale)[1]] if len(uv) else np.zeros((0, 2))

    def closest(self, points: Array) -> tuple[Array, Array]:
        """Parameters (n, 2) and distances (n,) [mm] of the boundary's points nearest to points (n, 3)."""
        _, near = self._space.query(points)
        uv, distance = np.array(self.uv[near]), np.full(len(points), np.inf)
        # the nearest vertex may end one curve and start the next: both are tried
        for start in (near, self.behind[near]):
            for index in np.unique(self.curve[start]):
                mine = np.flatnonzero(self.curve[start] == index)
                curve = self.curves[index]
                s = self.parameter[start[mine]]
                for _ in range(8):
                    at, along, across = self.region.carrier.frame(curve(s))
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
    """Parameters (count,) over the whole domain, as dense as the Greville abscissae."""
    sites = np.unique(greville(knots, degree))
    return np.interp(np.linspace(0.0, len(sites) - 1.0, count), np.arange(len(sites)), sites)


def _dot(a: Array, b: Array) -> Array:
    # a sum over an axis of two or three entries takes ten times as long
    return np.einsum("ij,ij->i", a, b)


def _square(a: Array) -> Array:
    return np.einsum("ij,ij->i", a, a)


def _unit(a: Array) -> Array:
    return a / np.maximum(np.sqrt(_square(a)), 1e-300)[..., None]
