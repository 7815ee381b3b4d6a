"""The blade or section that a cloud is moved onto: its sides and ends, sampled once, and true distances from them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.blade.native.blade import Blade
from bladewright.fitting.clouds.thinning import even_subset
from bladewright.fitting.matching.footpoints import CURVE_SAMPLES, SAMPLES, Side, footpoints_at
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.bezier import Patches, Samples, patches, sampled
from bladewright.nurbs.proximity import polished
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface
from bladewright.section.section import Section

OTHER_SIDE_RATIO = 3.0
"""another side is tried too where its nearest sample is at most this many times further away."""
CHORDWISE_SAMPLES, SPANWISE_SAMPLES = 241, 61
"""places along and across (`SPANWISE_SAMPLES`) a side among which evenly spread samples are chosen"""
OUTLINE_CORNERS = 60
"""corners on each curve of an end face's outline"""
FACE_SAMPLES = 9
"""samples of an end face from the upper to the lower side"""


EDGE_BAND = 0.02
"""distance from an edge, in u, within which the nearest place may change to the other side."""

Starts = Callable[[int, NDArray[np.intp]], tuple[NDArray[np.intp], Reals]]
"""patches and local parameters on a side for some points"""


@dataclass(frozen=True, kw_only=True)
class Contact:
    """The nearest places of n points on the target, in d dimensions."""

    normals: Reals
    """(n, d) unit normals of the target there"""
    beyond: Reals
    """(n, d) where the place is on the outer edge of a side the unit vector in the side that points past it, else 0"""
    miss: Reals
    """(n, d) from the place to the point"""

    part: NDArray[np.intp]
    """(n,) 0 upper side, 1 lower side, 2 and 3 the end faces"""
    place: Reals
    """(n, 2) u and v of the nearest place of the sides"""

    @property
    def distances(self) -> Reals:
        """(n,) true distances."""
        return np.sqrt(np.sum(self.miss**2, axis=-1))


@dataclass(frozen=True, kw_only=True, eq=False)
class RegistrationTarget:
    """The sides of a blade or section, and the end faces of a blade, with samples and their search trees."""

    sides: tuple[Side, Side]
    patches: tuple[Patches, ...]
    samples: tuple[Samples, ...]
    trees: tuple[cKDTree, ...]
    ends: tuple[TrimmedSurface, ...]
    end_samples: tuple[Reals, ...]
    """(k, 5) of each end face: u, v and the point"""
    end_trees: tuple[cKDTree, ...]
    outlines: tuple[Reals, ...]
    """(m, 2) polygon of each end face in its parameter plane"""

    @property
    def extent(self) -> float:
        """Largest extent of the sides along an axis [m]."""
        return max(float(np.ptp(samples.points, axis=0).max()) for samples in self.samples)

    @property
    def chord(self) -> float:
        """Mean straight distance from leading to trailing edge [m]."""
        side = self.sides[0]
        v = np.linspace(0.0, 1.0, SPANWISE_SAMPLES)
        lines = [np.real(side(u, v) if isinstance(side, Surface) else side(u)) for u in (0.0, 1.0)]
        return float(np.mean(np.sqrt(np.sum((lines[1] - lines[0]) ** 2, axis=-1))))

    def contact(self, points: Reals, hint: Contact | None = None) -> Contact:
        """The nearest places of points (n, d), by damped Newton steps from the nearest samples.

        With a `hint`, the contact of the same points a little aside, from the places of that one.
        """
        wanted, starts = self._starts(points) if hint is None else self._hinted(hint)
        square = np.full(len(points), np.inf)
        part = np.zeros(len(points), dtype=np.intp)
        place = np.zeros((len(points), 2))
        for k, on in enumerate(self.patches):
            rows = np.flatnonzero(wanted[k])
            patch, local = starts(k, rows)
            found = polished(on, points[rows], patch, local)
            better = found.square < square[rows]
            rows, patch, local = rows[better], found.patch[better], found.local[better]
            low, high = on.low[patch], on.high[patch]
            place[rows] = np.where(local >= 1.0, high, low + local * (high - low))
            square[rows], part[rows] = found.square[better], k
        footpoints = footpoints_at(points, self.sides, part, place[:, 0], place[:, 1])
        normals, beyond, miss = footpoints.normals.copy(), footpoints.beyond.copy(), footpoints.miss.copy()
        for k in range(len(self.ends)):
            rows = np.flatnonzero(wanted[2 + k])
            if len(rows):
                inside, at, normal = self._on_end(k, points[rows])
                offset = points[rows] - at
                inside &= np.sum(offset**2, axis=-1) < square[rows]
                rows = rows[inside]
                normals[rows], beyond[rows], miss[rows] = normal[inside], 0.0, offset[inside]
                square[rows], part[rows] = np.sum(miss[rows] ** 2, axis=-1), 2 + k
        return Contact(normals=normals, beyond=beyond, miss=miss, part=part, place=place)

    def _starts(self, points: Reals) -> tuple[NDArray[np.bool_], Starts]:
        """Which parts may hold the nearest places (k, n), and where to start on a side."""
        queries = [tree.query(points) for tree in (*self.trees, *self.end_trees)]
        near = np.stack([distances for distances, _ in queries])
        wanted = near <= OTHER_SIDE_RATIO * near.min(axis=0)
        wanted[:2] = near[:2] <= OTHER_SIDE_RATIO * near[:2].min(axis=0)

        def starts(k: int, rows: NDArray[np.intp]) -> tuple[NDArray[np.intp], Reals]:
            index = queries[k][1][rows]
            return self.samples[k].patch[index], self.samples[k].local[index]

        return wanted, starts

    def _hinted(self, hint: Contact) -> tuple[NDArray[np.bool_], Starts]:
        wanted = np.arange(2 + len(self.ends))[:, None] == hint.part
        u = hint.place[:, 0]
        wanted[:2] |= (u < EDGE_BAND) | (u > 1.0 - EDGE_BAND) | (hint.part >= 2)

        def starts(k: int, rows: NDArray[np.intp]) -> tuple[NDArray[np.intp], Reals]:
            return self.patches[k].at(hint.place[rows, 0], hint.place[rows, 1])

        return wanted, starts

    def _on_end(self, k: int, points: Reals) -> tuple[NDArray[np.bool_], Reals, Reals]:
        """Whether the nearest place of the whole wall lies in the end face, the place and the normal."""
        surface = self.ends[k].surface
        at = self.end_samples[k][self.end_trees[k].query(points)[1], :2].T.copy()
        domain = np.array([surface.domain_u, surface.domain_v])
        for _ in range(8):
            of = surface.derivatives(at[0], at[1], 2)
            offset = of[0, 0] - points
            a, b, c = (_dot(x, y) for x, y in ((of[1, 0],) * 2, (of[1, 0], of[0, 1]), (of[0, 1],) * 2))
            full = a + _dot(offset, of[2, 0]), b + _dot(offset, of[1, 1]), c + _dot(offset, of[0, 2])
            convex = (full[0] > 0.0) & (full[2] > 0.0) & (full[0] * full[2] - full[1] ** 2 > 1e-3 * a * c)
            a, b, c = (np.where(convex, exact, metric) for exact, metric in zip(full, (a, b, c), strict=True))
            g, h = _dot(offset, of[1, 0]), _dot(offset, of[0, 1])
            size = a * c - b * b
            at = np.clip(at - np.stack([c * g - b * h, a * h - b * g]) / size, domain[:, :1], domain[:, 1:])
        return _within(self.outlines[k], at.T), surface(*at), surface.normal(*at)

    def evenly(self, count: int) -> tuple[Reals, Reals]:
        """About `count` points (m, d) spread evenly over the target, and the unit normals there."""
        found = []
        for k, side in enumerate(self.sides):
            u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, CHORDWISE_SAMPLES))) / 2.0
            v = np.linspace(0.0, 1.0, SPANWISE_SAMPLES if isinstance(side, Surface) else 1)
            u, v = (each.ravel() for each in np.meshgrid(u, v, indexing="ij"))
            points = side(u, v) if isinstance(side, Surface) else side(u)
            rows = even_subset(points, count // 2)
            at = footpoints_at(points[rows], self.sides, np.full(len(rows), k, dtype=np.intp), u[rows], v[rows])
            found.append((at.points, at.normals))
        for end, samples in zip(self.ends, self.end_samples, strict=True):
            rows = even_subset(samples[:, 2:], max(16, count // 20))
            found.append((samples[rows, 2:], end.normal(samples[rows, 0], samples[rows, 1])))
        return np.concatenate([points for points, _ in found]), np.concatenate([normals for _, normals in found])


def target_of(built: Blade | Section) -> RegistrationTarget:
    """What a cloud is moved onto."""
    ends: tuple[TrimmedSurface, ...] = ()
    sides: tuple[Side, Side] = (
        built.sides if isinstance(built, Blade) else (built.curves["upper"], built.curves["lower"])
    )
    if isinstance(built, Blade):
        faces = [built.surfaces[name] for name in built.design.ends]
        ends = tuple(face for face in faces if isinstance(face, TrimmedSurface))
    on = tuple(patches(side) for side in sides)
    samples = tuple(sampled(each, *(SAMPLES if each.degrees[1] else CURVE_SAMPLES)) for each in on)
    end_samples = tuple(_face_samples(end) for end in ends)
    return RegistrationTarget(
        sides=sides,
        patches=on,
        samples=samples,
        trees=tuple(cKDTree(each.points) for each in samples),
        ends=ends,
        end_samples=end_samples,
        end_trees=tuple(cKDTree(each[:, 2:]) for each in end_samples),
        outlines=tuple(_outline(end) for end in ends),
    )


def _face_samples(end: TrimmedSurface) -> Reals:
    """Samples (k, 5) of a face between two boundary curves: u, v and the point, on lines between the curves."""
    t = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 101)[1:-1])) / 2.0
    first, last = end.boundary[0], end.boundary[-1]
    one = np.real(first(first.domain[0] + t * (first.domain[1] - first.domain[0])))
    other = np.real(last(last.domain[1] - t * (last.domain[1] - last.domain[0])))
    share = np.linspace(0.0, 1.0, FACE_SAMPLES)[:, None, None]
    place = ((1.0 - share) * one + share * other).reshape(-1, 2)
    return np.concatenate([place, np.real(end(place[:, 0], place[:, 1]))], axis=-1)


def _outline(end: TrimmedSurface) -> Reals:
    """Corners (m, 2) of a polygon near the boundary, in the parameter plane."""
    t = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, OUTLINE_CORNERS, endpoint=False))) / 2.0
    return np.concatenate(
        [np.real(curve(curve.domain[0] + t * (curve.domain[1] - curve.domain[0]))) for curve in end.boundary]
    )


def _within(polygon: Reals, places: Reals) -> NDArray[np.bool_]:
    """Whether places (n, 2) lie inside: a ray from there crosses the polygon an odd number of times."""
    start, end = polygon, np.roll(polygon, -1, axis=0)
    u, v = places[:, :1], places[:, 1:]
    level = (start[:, 1] > v) != (end[:, 1] > v)
    rise = np.where(end[:, 1] == start[:, 1], 1.0, end[:, 1] - start[:, 1])
    crossed = start[:, 0] + (v - start[:, 1]) / rise * (end[:, 0] - start[:, 0])
    return np.asarray(np.count_nonzero(level & (u < crossed), axis=1) % 2 == 1)


def _dot(a: Reals, b: Reals) -> Reals:
    return np.asarray(np.sum(a * b, axis=-1))
