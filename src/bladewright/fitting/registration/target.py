"""The blade or section that a cloud is moved onto: its sides and ends, sampled once, and true distances from them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.blade.native.blade import Blade
from bladewright.fitting.clouds.thinning import even_subset
from bladewright.fitting.matching.footpoints import Side, footpoints_at
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.closest import Descents, Places
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface
from bladewright.section.section import Section

END_RATIO = 3.0
"""an end face is tried too where its nearest sample is at most this many times further away than the sides."""
LAST_STEP = 1e-12
"""last step of a descent, in the parameters of a patch: exact points are brought back to rounding."""
CHORDWISE_SAMPLES, SPANWISE_SAMPLES = 241, 61
"""places along and across (`SPANWISE_SAMPLES`) a side among which evenly spread samples are chosen"""
OUTLINE_CORNERS = 60
"""corners on each curve of an end face's outline"""
FACE_SAMPLES = 9
"""samples of an end face from the upper to the lower side"""


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
    places: Places
    """the nearest places of the sides"""

    @property
    def distances(self) -> Reals:
        """(n,) true distances."""
        return np.sqrt(np.sum(self.miss**2, axis=-1))


@dataclass(frozen=True, kw_only=True, eq=False)
class RegistrationTarget:
    """The sides of a blade or section, and the end faces of a blade, with samples and their search trees."""

    search: Descents
    """of the sides"""
    ends: tuple[TrimmedSurface, ...]
    end_samples: tuple[Reals, ...]
    """(k, 5) of each end face: u, v and the point"""
    end_trees: tuple[cKDTree, ...]
    outlines: tuple[Reals, ...]
    """(m, 2) polygon of each end face in its parameter plane"""

    @property
    def extent(self) -> float:
        """Largest extent of the sides along an axis [m]."""
        return max(float(np.ptp(samples.points, axis=0).max()) for samples, _ in self.search.samples)

    @property
    def sides(self) -> tuple[Side, ...]:
        """The upper and the lower side."""
        return self.search.shapes

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
        places = self.search.nearest(points, None if hint is None else hint.places, converged=LAST_STEP)
        square, part = places.square.copy(), places.shape.copy()
        footpoints = footpoints_at(points, self.sides, places.shape, places.u, places.v)
        normals, beyond, miss = footpoints.normals, footpoints.beyond, footpoints.miss
        for k, tree in enumerate(self.end_trees):
            away, index = tree.query(points)
            rows = np.flatnonzero(away <= END_RATIO * np.sqrt(square) if hint is None else hint.part == 2 + k)
            surface, start = self.ends[k].surface, self.end_samples[k][index[rows]]
            found = Descents((surface,)).nearest(
                points[rows], Places(shape=np.zeros(len(rows), dtype=np.intp), u=start[:, 0], v=start[:, 1])
            )
            inside = (found.square < square[rows]) & _within(self.outlines[k], np.stack([found.u, found.v], axis=-1))
            rows, u, v = rows[inside], found.u[inside], found.v[inside]
            normals[rows], beyond[rows], miss[rows] = surface.normal(u, v), 0.0, points[rows] - surface(u, v)
            square[rows], part[rows] = found.square[inside], 2 + k
        return Contact(normals=normals, beyond=beyond, miss=miss, part=part, places=places)

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
    end_samples = tuple(_face_samples(end) for end in ends)
    return RegistrationTarget(
        search=Descents(sides),
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
