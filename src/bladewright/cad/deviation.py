"""How far the faces of a CAD file lie from the native faces, measured in both directions."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.spatial import cKDTree

from bladewright.cad.native_body import MM
from bladewright.cad.region import Region, greville_spaced
from bladewright.cad.surface_evaluation import NurbsEvaluator, native_evaluator
from bladewright.numerics.elementary import Array
from bladewright.nurbs.domain import piece, swapped
from bladewright.nurbs.domain import reversed as run_backwards
from bladewright.nurbs.measure import area
from bladewright.nurbs.refine import Direction, direction_of
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

GAUSS_NEWTON_STEPS = 12
"""Most steps towards the nearest point of a face. From the nearest of some thousand seeds three or four are enough; the
rest is for places where the surface nearly degenerates."""
SEEDS = 4_000
"""Points of a face from the nearest of which the search starts, about 63 in each direction. More cost memory and time
for every face; fewer would let the search start beyond a fold of the surface and end in a local minimum."""
EQUAL_KNOTS = 1e-9
"""Largest difference of equal knots, of a parameter range of 1: STEP and IGES files round their knots."""


DIRECTIONS: tuple[Direction, ...] = ("u", "v")


class FaceProjection:
    """The projection of many points to a face: the nearest points of the face to them."""

    def __init__(self, region: Region, seeds: Array | None = None) -> None:
        self.region = region
        uv = region.samples(SEEDS) if seeds is None else seeds
        points = region.points(uv)
        # a side that degenerates to a point would fill the list of neighbours with copies of it
        grain = 1e-9 * max(float(np.ptp(points, axis=0).max()), 1e-300)
        _, kept = np.unique(np.round(points / grain), axis=0, return_index=True)
        self.uv = uv[kept]
        self.tree = cKDTree(points[kept])
        self.spacing = float(self.tree.query(points[kept], k=min(5, len(kept)))[0].max())

    def least_distance(self, points: Array) -> Array:
        """Distances (n,) [mm] from a box that holds the face: none of points (n, 3) is nearer to the face."""
        low, high = self.tree.mins - self.spacing, self.tree.maxes + self.spacing
        outside = np.maximum(np.maximum(low - points, points - high), 0.0)
        return np.sqrt(_dot(outside, outside))

    def closest(self, points: Array, limit: float) -> tuple[Array, Array]:
        """Parameters (n, 2) and distances (n,) [mm] of the nearest points of the face to points (n, 3).

        Where the search from the nearest seed ends further away than `limit` [mm], it may have ended in a local
        minimum, and is repeated from the next nearest seeds; not where even the seeds are so far away that no point of
        the face can lie within the limit.
        """
        seed, near = self.tree.query(points)
        uv, distance = self._search(points, self.uv[near], limit)
        doubtful = np.flatnonzero((distance > limit) & (seed < limit + 3.0 * self.spacing))
        if len(doubtful):
            _, candidates = self.tree.query(points[doubtful], k=min(8, len(self.uv)))
            for k in range(1, candidates.shape[1], 3):
                again, away = self._search(points[doubtful], self.uv[candidates[:, k]], limit)
                better = away < distance[doubtful]
                uv[doubtful[better]], distance[doubtful[better]] = again[better], away[better]
        return uv, distance

    def _search(self, points: Array, start: Array, limit: float) -> tuple[Array, Array]:
        """Nearest points of the face, found from parameters `start` (n, 2)."""
        uv, distance = self._on_surface(points, start)
        if self.region.loops:
            outside = np.flatnonzero(~self.region.contains(uv))
            if len(outside):
                uv[outside], distance[outside] = self.region.boundary.closest(points[outside], limit)
        return uv, distance

    def _on_surface(self, points: Array, start: Array) -> tuple[Array, Array]:
        """Nearest points of the untrimmed surface, by Gauss-Newton steps."""
        best, uv = np.array(start), np.array(start)
        distance = np.full(len(points), np.inf)
        active = np.arange(len(points))
        for _ in range(GAUSS_NEWTON_STEPS):
            at, along, across = self.region.evaluator.frame(uv[active])
            miss = points[active] - at
            away = np.sqrt(_dot(miss, miss))
            better = away < distance[active]
            best[active[better]], distance[active[better]] = uv[active[better]], away[better]
            a, b, c = _dot(along, along), _dot(along, across), _dot(across, across)
            e, f = _dot(along, miss), _dot(across, miss)
            # where a side of the face degenerates to a point, one of the derivatives vanishes
            a, c = a + 1e-12 * self.region.scale[0] ** 2, c + 1e-12 * self.region.scale[1] ** 2
            determinant = a * c - b * b
            step = np.stack([c * e - b * f, a * f - b * e], axis=-1) / determinant[:, None]
            moved = self.region.into_domain(uv[active] + step)
            shift = (moved - uv[active]) * self.region.scale
            uv[active] = moved
            # smaller steps change the distance by less than rounding
            active = active[_dot(shift, shift) > (1e-9 * np.maximum(away, 1e-3)) ** 2]
            if len(active) == 0:
                break
        return best, distance


def _dot(a: Array, b: Array) -> Array:
    return np.einsum("ij,ij->i", a, b)


@dataclass(frozen=True, kw_only=True, eq=False)
class FaceDeviation:
    """Distances between a native face and the faces of a file that stand for it."""

    largest: float
    """[mm]"""
    mean: float
    """[mm]"""
    worst: tuple[float, float]
    """native u and v of the largest"""


@lru_cache(maxsize=16)
def native_face(face: Surface | TrimmedSurface) -> "NativeFace":
    """A native face prepared for comparison; cached for the next file of the same body."""
    return NativeFace(face)


class NativeFace:
    """A native face, prepared once for everything that is compared with it."""

    def __init__(self, face: Surface | TrimmedSurface) -> None:
        surface = face if isinstance(face, Surface) else face.surface
        self.face = face
        self.region = Region(
            evaluator=native_evaluator(surface),
            loops=() if isinstance(face, Surface) else face.loops,
            low=np.array([surface.knots_u[0], surface.knots_v[0]]),
            high=np.array([surface.knots_u[-1], surface.knots_v[-1]]),
        )

    @cached_property
    def projection(self) -> FaceProjection:
        """The projection of points to the face."""
        return FaceProjection(self.region)

    @cached_property
    def area(self) -> float:
        """Area [m^2] by quadrature."""
        return float(area(self.face) if isinstance(self.face, Surface) else self.face.area())

    def may_hold(self, points: Array, distance: float) -> bool:
        """Whether points (n, 3) [mm] are at most a distance outside the box of the control points, per coordinate."""
        surface = self.face if isinstance(self.face, Surface) else self.face.surface
        net = MM * surface.control_points
        low, high = net.min(axis=(0, 1)) - distance, net.max(axis=(0, 1)) + distance
        return bool(np.all((points >= low) & (points <= high)))

    def same_poles(self, region: Region) -> tuple[Surface, Surface] | None:
        """The native surface or a piece of it [m] and the region's [mm], of equal degrees, knots and numbers of poles.

        The region's surface is then turned so that its parameters run as the native ones do. None for other regions.
        """
        if not isinstance(self.face, Surface) or not isinstance(region.evaluator, NurbsEvaluator) or region.loops:
            return None
        found = []
        for turned in _turned(region.evaluator.surface):
            mine = _piece_over(self.face, turned)
            if mine is not None and _same_basis(mine, turned):
                moved = float(np.max(np.abs(turned.control_points - MM * mine.control_points)))
                found.append((moved, mine, turned))
        return min(found, key=lambda each: each[0])[1:] if found else None


def _piece_over(native: Surface, other: Surface) -> Surface | None:
    """The part of a native surface over the domain of another, to whose rounded knots it has the nearest ends."""
    mine = native
    for direction in DIRECTIONS:
        knots, _ = direction_of(native, direction)
        wanted = other.domain_u if direction == "u" else other.domain_v
        start, end = (float(knots[np.argmin(np.abs(knots - place))]) for place in wanted)
        if max(abs(start - wanted[0]), abs(end - wanted[1])) > EQUAL_KNOTS:
            return None
        if (start, end) != (knots[0], knots[-1]):
            mine = piece(mine, start, end, direction)
    return mine


def _same_basis(one: Surface, other: Surface) -> bool:
    return (
        (one.degree_u, one.degree_v) == (other.degree_u, other.degree_v)
        and one.control_points.shape == other.control_points.shape
        and bool(np.allclose(one.knots_u, other.knots_u, rtol=0.0, atol=EQUAL_KNOTS))
        and bool(np.allclose(one.knots_v, other.knots_v, rtol=0.0, atol=EQUAL_KNOTS))
    )


def _turned(surface: Surface) -> Iterator[Surface]:
    """A surface with its parameters exchanged and reversed in all eight ways, one of which another program wrote."""
    for exchanged in (surface, swapped(surface)):
        for along_u in (exchanged, run_backwards(exchanged, "u")):
            yield along_u
            yield run_backwards(along_u, "v")


def deviation(native: NativeFace, regions: list[Region], count: int, limit: float) -> FaceDeviation:
    """Distances between a native face and the faces of the file that stand for it, at `count` samples each way.

    Where the file has the same control points and knots, in one face or in pieces, points at equal parameters are
    compared: an upper bound of the distance. Where that bound exceeds `limit` [mm], and for all other faces, every
    sample is projected to the other side: native samples to the file's faces, and samples of these to the native face.
    """
    pairs = [pair for region in regions if (pair := native.same_poles(region)) is not None]
    if len(pairs) == len(regions) and _cover([mine for mine, _ in pairs], native.region):
        found = [_at_equal_parameters(*pair, count // len(pairs)) for pair in pairs]
        largest = max(found, key=lambda each: each.largest)
        if largest.largest <= limit:
            return replace(largest, mean=float(np.mean([each.mean for each in found])))
    uv = native.region.samples(count)
    points = native.region.points(uv)
    distance = np.full(len(points), np.inf)
    samples = [region.samples(max(100, count // len(regions))) for region in regions]
    for region, own in zip(regions, samples, strict=True):
        projection = FaceProjection(region, own[::2] if len(own) > SEEDS else own)
        distance = np.minimum(distance, projection.closest(points, limit)[1])
    worst = int(np.argmax(distance))
    farthest, place, every = float(distance[worst]), uv[worst], [distance]
    for region, own in zip(regions, samples, strict=True):
        footpoints, distance = native.projection.closest(region.points(own), limit)
        worst = int(np.argmax(distance))
        every.append(distance)
        if distance[worst] > farthest:
            farthest, place = float(distance[worst]), footpoints[worst]
    return FaceDeviation(
        largest=farthest, mean=float(np.mean(np.concatenate(every))), worst=(float(place[0]), float(place[1]))
    )


def _cover(pieces: list[Surface], region: Region) -> bool:
    """Whether pieces cover the parameter rectangle of a face once."""
    starts = {(face.domain_u[0], face.domain_v[0]) for face in pieces}
    sizes = [np.ptp(face.domain_u) * np.ptp(face.domain_v) for face in pieces]
    whole = np.prod(region.high - region.low)
    return len(starts) == len(pieces) and bool(abs(np.sum(sizes) - whole) <= EQUAL_KNOTS * whole)


def _at_equal_parameters(surface: Surface, other: Surface, count: int) -> FaceDeviation:
    lines = int(np.sqrt(count))
    u, v = (
        greville_spaced(surface.knots_u, surface.degree_u, lines),
        greville_spaced(surface.knots_v, surface.degree_v, lines),
    )
    difference = MM * surface.grid(u, v) - other.grid(u, v)
    distance = np.sqrt(np.sum(difference * difference, axis=-1))
    worst = np.unravel_index(np.argmax(distance), distance.shape)
    return FaceDeviation(
        largest=float(distance[worst]), mean=float(distance.mean()), worst=(float(u[worst[0]]), float(v[worst[1]]))
    )
