"""Closest points on curves and surfaces: globally, with their derivatives, or by descents from samples or a start."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from bladewright.errors import GeometryError
from bladewright.numerics.elementary import Array, dot, length
from bladewright.nurbs.basis import Reals, corners
from bladewright.nurbs.bezier import Patches, Samples, patches, sampled
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.descent import polished
from bladewright.nurbs.proximity import nearest
from bladewright.nurbs.surface import Surface

TOLERANCE = 1e-9
"""Default of `tolerance`, in units of the extent of the control points: how much nearer a point may be that the search
passes over. On a blade of 100 mm that is 1e-7 mm, below what any CAD file keeps. A thousand times as much or as little
takes the same time (design/nurbs_constants.md)."""
STATIONARY = 1e-7
"""Largest cosine of the angle between the distance and a tangent for which the point counts as a perpendicular foot,
whose parameter moves with the data; at an end or a kink it stays. It must exceed what the search leaves of the cosine
(about the root of rounding) and lie below the angle of any kink that matters."""


@dataclass(frozen=True, kw_only=True)
class ClosestOnCurve:
    """The points on a curve closest to given points (...)."""

    u: Array
    """(...) parameters, complex where curve or points are"""
    points: Array
    """(..., d) on the curve"""
    distances: Array
    """(...); at distance zero they have no derivative"""


@dataclass(frozen=True, kw_only=True)
class ClosestOnSurface:
    """The points on a surface closest to given points (...)."""

    u: Array
    """(...) parameters, complex where surface or points are"""
    v: Array
    """(...)"""
    points: Array
    """(..., d) on the surface"""
    distances: Array
    """(...); at distance zero they have no derivative"""


def closest_on_curve(curve: Curve, points: ArrayLike, *, tolerance: float = TOLERANCE) -> ClosestOnCurve:
    """The points on a curve, ends included, that are closest to points (..., d).

    The search is global (see `proximity`): no other point is closer by more than `tolerance` times the extent of the
    control points. Of several that are equally close it returns any. With complex control points or points the search
    takes real parts, and the parameters' imaginary part is that of one more Newton step; a parameter at an end or a
    kink, where the distance is not stationary, stays. Raises GeometryError where dimensions differ or points are not
    finite.
    """
    queries, found = _search(curve, points, tolerance)
    u: Array = np.clip(found[:, 0], *curve.domain).reshape(queries.shape[:-1])
    if np.iscomplexobj(curve.homogeneous) or np.iscomplexobj(queries):
        point, first, second = curve.derivatives(u, 2)
        miss = point - queries
        slope, rate = dot(miss, first), dot(first, first) + dot(miss, second)
        free = _stationary(slope, first, miss)
        u = u - 1j * np.where(free, slope.imag / np.where(free, rate.real, 1.0), 0.0)
    reached = curve(u)
    return ClosestOnCurve(u=u, points=reached, distances=length(reached - queries))


def closest_on_surface(surface: Surface, points: ArrayLike, *, tolerance: float = TOLERANCE) -> ClosestOnSurface:
    """The points on a surface, edges included, that are closest to points (..., d).

    As `closest_on_curve` on a curve. A point with a whole line of closest points, such as one on the axis of a surface
    of revolution, takes up to a tenth of a second instead of a fraction of a millisecond; distances below a millionth
    of a patch's size are told apart to 3e-8 of it, which is the rounding of their squares.
    """
    queries, found = _search(surface, points, tolerance)
    u: Array = np.clip(found[:, 0], *surface.domain_u).reshape(queries.shape[:-1])
    v: Array = np.clip(found[:, 1], *surface.domain_v).reshape(queries.shape[:-1])
    if np.iscomplexobj(surface.homogeneous) or np.iscomplexobj(queries):
        of = surface.derivatives(u, v, 2)
        miss = of[0, 0] - queries
        slope_u, slope_v = dot(miss, of[1, 0]), dot(miss, of[0, 1])
        free_u, free_v = _stationary(slope_u, of[1, 0], miss), _stationary(slope_v, of[0, 1], miss)
        uu = np.where(free_u, (dot(of[1, 0], of[1, 0]) + dot(miss, of[2, 0])).real, 1.0)
        vv = np.where(free_v, (dot(of[0, 1], of[0, 1]) + dot(miss, of[0, 2])).real, 1.0)
        uv = np.where(free_u & free_v, (dot(of[1, 0], of[0, 1]) + dot(miss, of[1, 1])).real, 0.0)
        step_u, step_v = np.where(free_u, slope_u.imag, 0.0), np.where(free_v, slope_v.imag, 0.0)
        determinant = uu * vv - uv**2
        u = u - 1j * (vv * step_u - uv * step_v) / determinant
        v = v - 1j * (uu * step_v - uv * step_u) / determinant
    reached = surface(u, v)
    return ClosestOnSurface(u=u, v=v, points=reached, distances=length(reached - queries))


def _search(shape: Curve | Surface, points: ArrayLike, tolerance: float) -> tuple[Array, Reals]:
    """The points as an array (..., d), and the parameters (m, 2) closest to their real parts."""
    queries, flat = _queries(points, shape.control_points.shape[-1])
    on = patches(shape)
    found = nearest(on, flat, tolerance * _extent(shape.control_points))
    return queries, on.low[found.patch] + found.local * (on.high - on.low)[found.patch]


def _queries(points: ArrayLike, dimension: int) -> tuple[Array, Reals]:
    queries = np.asarray(points)
    if queries.ndim == 0 or queries.shape[-1] != dimension:
        raise GeometryError(
            f"points of shape {queries.shape} were given for a shape in {dimension} dimensions: give (..., {dimension})"
        )
    flat = np.array(queries.real, dtype=np.float64).reshape(-1, dimension)
    if len(flat) == 0 or not np.isfinite(flat).all():
        raise GeometryError(f"{len(flat)} points were given, not all of them finite: give at least one, and no NaN")
    return queries, flat


def _extent(control_points: Array) -> float:
    flat = control_points.real.reshape(-1, control_points.shape[-1])
    return float(np.ptp(flat, axis=0).max())


def _stationary(slope: Array, tangent: Array, miss: Array) -> NDArray[np.bool_]:
    """Where the distance is perpendicular to a tangent, so that it is stationary in that parameter."""
    size = length(tangent.real) * length(miss.real)
    moves = length(tangent.real) > 0.0
    return np.asarray(
        moves & (slope.real**2 <= (STATIONARY * size) ** 2 + 1e-24 * dot(tangent.real, tangent.real) ** 2)
    )


CONVERGED = 1e-8
"""Last step of a descent, in the parameters of a patch: distances of points off the shape are exact to its square."""
SAMPLES = {1: (24, 1), 2: (6, 5)}
"""Samples along and across a patch of a curve and of a surface from which descents start. More cost time for every
search, fewer start at the wrong hump."""
LEAST_ACROSS = 20
"""Samples across a surface at least, however few its patches: with 5 across a prismatic blade that leans, 7 of 2,200
points ended at a corner a twentieth of the chord off (design/matching.md)."""
OTHER_SHAPE_RATIO = 4.0
"""Another smooth piece is tried too where its nearest sample is at most this many times as far as the nearest of all:
with 2 a few of 8,000 points beside a thin edge are found on its wrong side, in as much time
(design/nurbs_constants.md)."""
OFF_CORNER = 0.01
"""distance from the ends of a patch, along u, from which descents start: small against the way between two samples"""
JOINT_BAND = 0.02
"""Distance from the last u, of the domain, within which a place on one of two shapes may be nearer on the other. Wider
bands cost descents that change nothing."""
AT_ONCE = 20_000
"""Descents at a time; it bounds the memory, not the result."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Places:
    """Places on one or several shapes, one for each of n points."""

    shape: NDArray[np.intp]
    """(n,) index of the shape"""
    u: Reals
    v: Reals
    """(n,) parameters; v is 0 on curves"""
    square: Reals = field(default_factory=lambda: np.empty(0))
    """(n,) squared distances of the points, where they are known"""


@dataclass(frozen=True, eq=False)
class Descents:
    """Searches for the nearest places on a curve or surface, or on two, that end at local minima of the distance.

    Two shapes join at u = 0 and may join at u = 1, as the sides of a blade do at its edges: descents cross from one to
    the other. Complex shapes count by their real parts.
    """

    shapes: tuple[Curve | Surface, ...]

    @cached_property
    def patches(self) -> Patches:
        """The Bezier patches of one shape, or of two in a row.

        Of two, u runs from -1 along the second shape, backwards, to 0 and on to 1 along the first.
        """
        first, *more = (patches(shape) for shape in self.shapes)
        for second in more:
            rows, columns = second.shape
            order, mirror = np.arange(rows * columns).reshape(rows, columns)[::-1].ravel(), np.array([-1.0, 1.0])
            ends = np.where(mirror < 0.0, second.high, second.low), np.where(mirror < 0.0, second.low, second.high)
            return Patches(
                nets=np.concatenate([second.nets[order, ::-1], first.nets]),
                low=np.concatenate([(mirror * ends[0])[order], first.low]),
                high=np.concatenate([(mirror * ends[1])[order], first.high]),
                shape=(rows + first.shape[0], columns),
                rational=second.rational or first.rational,
            )
        return first

    @cached_property
    def samples(self) -> tuple[Samples, tuple[tuple[NDArray[np.intp], cKDTree], ...]]:
        """Samples of all patches, and for each smooth piece the indices of its own, with their search tree.

        Beside the corner of a blunt edge, face and side have nearest places of their own.
        """
        along, across = SAMPLES[1 + (self.patches.degrees[1] > 0)]
        if across > 1:
            across = max(across, -(-LEAST_ACROSS // self.patches.shape[1]))
        found = sampled(self.patches, along, across)
        ends = [
            sign * corners(*(each.knots, each.degree) if isinstance(each, Curve) else (each.knots_u, each.degree_u))
            for sign, each in zip((1.0, -1.0), self.shapes, strict=False)
        ]
        middles = np.mean([self.patches.low[:, 0], self.patches.high[:, 0]], axis=0)
        piece = np.asarray(np.searchsorted(np.unique(np.concatenate(ends)), middles))[found.patch]
        own = [np.flatnonzero(piece == k) for k in np.unique(piece)]
        return found, tuple((rows, cKDTree(found.points[rows])) for rows in own)

    def nearest(self, points: Reals, start: Places | None = None, *, converged: float = CONVERGED) -> Places:
        """The nearest places of points (n, d): from the nearest samples, or from a `start` (n,).

        `converged` is the last step in the parameters of a patch: distances of points off a shape are exact to its
        square, those of points on it to itself.
        """
        two = len(self.shapes) > 1
        if start is None:
            samples, trees = self.samples
            queries = [tree.query(points) for _, tree in trees]
            least = np.min([distance for distance, _ in queries], axis=0)
            rows = [np.flatnonzero(distance <= OTHER_SHAPE_RATIO * least) for distance, _ in queries]
            chosen = np.concatenate(
                [own[index[some]] for (own, _), (_, index), some in zip(trees, queries, rows, strict=True)]
            )
            every = np.concatenate(rows)
            # inside its piece, as a descent that starts at a corner may take either way
            local = np.clip(samples.local[chosen], *np.array([[OFF_CORNER, 0.0], [1.0 - OFF_CORNER, 1.0]]))
            square, u, v = self._descended(points, every, samples.patch[chosen], local, converged)
            around = np.where(u < 0.0, -u, u)
        else:
            every, around = np.arange(len(points)), start.u
            u, v, square = np.where(start.shape > 0, -start.u, start.u), start.v, np.empty(0)
        edge = np.flatnonzero((around > 1.0 - JOINT_BAND) & two)
        if start is None:
            more = self._descended(points, every[edge], *self.patches.at(-u[edge], v[edge]), converged)
            square, u, v = (np.concatenate(pair) for pair in zip((square, u, v), more, strict=True))
            every = np.append(every, every[edge])
        else:
            every, at = np.append(every, edge), (np.append(u, -u[edge]), np.append(v, v[edge]))
            square, u, v = self._descended(points, every, *self.patches.at(*at), converged)
        order = np.lexsort((square, every))
        best = order[np.searchsorted(every[order], np.arange(len(points)))]
        u, shape = u[best], ((u[best] < 0.0) & two).astype(np.intp)
        return Places(shape=shape, u=np.where(shape > 0, -u, u), v=v[best], square=square[best])

    def globally_nearest(self, points: Reals) -> Places:
        """The nearest places of points (n, d) by the global search: for few of them, as it takes longer."""
        on = self.patches
        found = nearest(on, points, TOLERANCE * max(_extent(each.control_points) for each in self.shapes))
        low, high = on.low[found.patch], on.high[found.patch]
        u, v = (low + found.local * (high - low)).T
        shape = (u < 0.0).astype(np.intp) if len(self.shapes) > 1 else np.zeros(len(u), dtype=np.intp)
        return Places(shape=shape, u=np.where(shape > 0, -u, u), v=v, square=found.square)

    def _descended(
        self, points: Reals, rows: NDArray[np.intp], patch: NDArray[np.intp], local: Reals, converged: float
    ) -> tuple[Reals, Reals, Reals]:
        """Squared distances (m,) of the points in `rows` (m,), and both parameters, where descents end."""
        square, place = np.empty(len(rows)), np.empty((len(rows), 2))
        for first in range(0, len(rows), AT_ONCE):
            part = slice(first, first + AT_ONCE)
            found = polished(self.patches, points[rows[part]], patch[part], local[part], converged=converged)
            low, high = self.patches.low[found.patch], self.patches.high[found.patch]
            place[part] = np.where(found.local >= 1.0, high, low + found.local * (high - low))
            square[part] = found.square
        return square, place[:, 0], place[:, 1]
