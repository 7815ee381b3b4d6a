"""How far the faces of a CAD file lie from the native faces, measured in both directions."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from scipy.spatial import cKDTree

from bladewright.cad.native_body import MM
from bladewright.cad.region import Region, greville_spaced
from bladewright.cad.surface_evaluation import NurbsEvaluator, native_evaluator
from bladewright.numerics.elementary import Array
from bladewright.nurbs.domain import reversed as run_backwards
from bladewright.nurbs.domain import swapped
from bladewright.nurbs.measure import area
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

GAUSS_NEWTON_STEPS = 12
"""most Gauss-Newton steps; from the nearest of some thousand seeds three or four are needed"""
SEEDS = 4_000
"""points of a face from the nearest of which the search starts"""


class ClosestPointOnFace:
    """A face that many points are brought to; what the search needs is prepared once."""

    def __init__(self, region: Region, seeds: Array | None = None) -> None:
        self.region = region
        uv = region.sampled(SEEDS) if seeds is None else seeds
        points = region.points(uv)
        # a side that is a single point would fill the list of neighbours with itself
        grain = 1e-9 * max(float(np.ptp(points, axis=0).max()), 1e-300)
        _, kept = np.unique(np.round(points / grain), axis=0, return_index=True)
        self.uv = uv[kept]
        self.tree = cKDTree(points[kept])
        self.spacing = float(self.tree.query(points[kept], k=min(5, len(kept)))[0].max())

    def closest(self, points: Array, limit: float) -> tuple[Array, Array]:
        """Parameters (n, 2) and distances (n,) [mm] of the nearest points of the face to points (n, 3).

        Where the first start ends further away than `limit`, the next nearest seeds are tried too, so that a local
        minimum is not taken for the answer; not so where all seeds are so far that the answer is beyond it.
        """
        seed, near = self.tree.query(points)
        uv, distance = self._from(points, self.uv[near])
        doubtful = np.flatnonzero((distance > limit) & (seed < limit + 3.0 * self.spacing))
        if len(doubtful):
            _, candidates = self.tree.query(points[doubtful], k=min(8, len(self.uv)))
            for k in range(1, candidates.shape[1], 3):
                again, away = self._from(points[doubtful], self.uv[candidates[:, k]])
                better = away < distance[doubtful]
                uv[doubtful[better]], distance[doubtful[better]] = again[better], away[better]
        return uv, distance

    def _from(self, points: Array, start: Array) -> tuple[Array, Array]:
        uv, distance = self._feet(points, start)
        if self.region.chains:
            outside = np.flatnonzero(~self.region.contains(uv))
            if len(outside):
                uv[outside], distance[outside] = self.region.rim.closest(points[outside])
        return uv, distance

    def _feet(self, points: Array, start: Array) -> tuple[Array, Array]:
        """Nearest points of the untrimmed carrier."""
        best, uv = np.array(start), np.array(start)
        distance = np.full(len(points), np.inf)
        active = np.arange(len(points))
        for _ in range(GAUSS_NEWTON_STEPS):
            at, along, across = self.region.carrier.frame(uv[active])
            miss = points[active] - at
            away = np.sqrt(_dot(miss, miss))
            better = away < distance[active]
            best[active[better]], distance[active[better]] = uv[active[better]], away[better]
            a, b, c = _dot(along, along), _dot(along, across), _dot(across, across)
            e, f = _dot(along, miss), _dot(across, miss)
            # where a side of the face is a single point, one of the derivatives vanishes
            a, c = a + 1e-12 * self.region.scale[0] ** 2, c + 1e-12 * self.region.scale[1] ** 2
            determinant = a * c - b * b
            step = np.stack([c * e - b * f, a * f - b * e], axis=-1) / determinant[:, None]
            moved = self.region.brought_near(uv[active] + step)
            shift = (moved - uv[active]) * self.region.scale
            uv[active] = moved
            # below this the distance changes by less than rounding
            active = active[_dot(shift, shift) > (1e-9 * np.maximum(away, 1e-3)) ** 2]
            if len(active) == 0:
                break
        return best, distance


def _dot(a: Array, b: Array) -> Array:
    return np.einsum("ij,ij->i", a, b)


EQUAL_KNOTS = 1e-9
"""Difference of knots below which a file, which rounds them, gave them back."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Deviation:
    """Distances between a native face and what a file made of it."""

    largest: float
    """[mm]"""
    mean: float
    """[mm]"""
    worst: tuple[float, float]
    """native parameters of the place where it is largest"""


@lru_cache(maxsize=16)
def native_face(face: Surface | TrimmedSurface) -> "NativeFace":
    """A native face as the measure of others; kept for the next file of the same body."""
    return NativeFace(face)


class NativeFace:
    """A native face, prepared once for all that is compared with it."""

    def __init__(self, face: Surface | TrimmedSurface) -> None:
        surface = face if isinstance(face, Surface) else face.surface
        self.face = face
        self.region = Region(
            carrier=native_evaluator(surface),
            chains=() if isinstance(face, Surface) else (face.boundary,),
            low=np.array([surface.knots_u[0], surface.knots_v[0]]),
            high=np.array([surface.knots_u[-1], surface.knots_v[-1]]),
        )

    @cached_property
    def target(self) -> ClosestPointOnFace:
        """The face as something that points are brought to."""
        return ClosestPointOnFace(self.region)

    @cached_property
    def area(self) -> float:
        """[m^2] by quadrature."""
        return float(area(self.face) if isinstance(self.face, Surface) else self.face.area())

    def pole_for_pole(self, region: Region) -> tuple[Surface, Surface] | None:
        """The native surface [m] and a region's [mm], where the latter is the whole of a surface with the same degrees,
        knots and number of control points; None otherwise.
        """  # noqa: D205
        if not isinstance(self.face, Surface) or not isinstance(region.carrier, NurbsEvaluator) or region.chains:
            return None
        mine = self.face
        found = [
            (np.max(np.abs(turned.control_points - MM * mine.control_points)), turned)
            for turned in _turned(region.carrier.surface)
            if _same_basis(mine, turned)
        ]
        return (mine, min(found, key=lambda each: float(each[0]))[1]) if found else None


def _same_basis(one: Surface, other: Surface) -> bool:
    return (
        (one.degree_u, one.degree_v) == (other.degree_u, other.degree_v)
        and one.control_points.shape == other.control_points.shape
        and bool(np.allclose(one.knots_u, other.knots_u, rtol=0.0, atol=EQUAL_KNOTS))
        and bool(np.allclose(one.knots_v, other.knots_v, rtol=0.0, atol=EQUAL_KNOTS))
    )


def _turned(surface: Surface) -> Iterator[Surface]:
    """A surface and itself run in other directions, as a program that turns a face round writes it."""
    for exchanged in (surface, swapped(surface)):
        for half in (exchanged, run_backwards(exchanged, "u")):
            yield half
            yield run_backwards(half, "v")


def deviation(meant: NativeFace, regions: list[Region], count: int, limit: float) -> Deviation:
    """Distances between a native face and the file's faces that stand for it, from `count` samples each way.

    Where the control points came back one for one, points at equal parameters are compared, which bounds the distance
    from above; where that bound is not below `limit`, and for all others, each sample is brought to the nearest point
    of the other side.
    """
    pair = meant.pole_for_pole(regions[0]) if len(regions) == 1 else None
    if pair is not None:
        found = _at_equal_parameters(*pair, count)
        if found.largest <= limit:
            return found
    uv = meant.region.sampled(count)
    points = meant.region.points(uv)
    away = np.full(len(points), np.inf)
    samples = [region.sampled(max(100, count // len(regions))) for region in regions]
    for region, seeds in zip(regions, samples, strict=True):
        away = np.minimum(
            away, ClosestPointOnFace(region, seeds[::2] if len(seeds) > SEEDS else seeds).closest(points, limit)[1]
        )
    worst = int(np.argmax(away))
    largest, place, every = float(away[worst]), uv[worst], [away]
    for region, back in zip(regions, samples, strict=True):
        feet, away = meant.target.closest(region.points(back), limit)
        worst = int(np.argmax(away))
        every.append(away)
        if away[worst] > largest:
            largest, place = float(away[worst]), feet[worst]
    return Deviation(
        largest=largest, mean=float(np.mean(np.concatenate(every))), worst=(float(place[0]), float(place[1]))
    )


def _at_equal_parameters(surface: Surface, other: Surface, count: int) -> Deviation:
    lines = int(np.sqrt(count))
    u, v = (
        greville_spaced(surface.knots_u, surface.degree_u, lines),
        greville_spaced(surface.knots_v, surface.degree_v, lines),
    )
    away = _length(MM * surface.grid(u, v) - other.grid(u, v))
    worst = np.unravel_index(np.argmax(away), away.shape)
    return Deviation(
        largest=float(away[worst]), mean=float(away.mean()), worst=(float(u[worst[0]]), float(v[worst[1]]))
    )


def _length(vectors: Array) -> Array:
    return np.sqrt(np.sum(vectors * vectors, axis=-1))
