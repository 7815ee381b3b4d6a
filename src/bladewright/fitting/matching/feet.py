"""Nearest places of a cloud on the two sides of a blade or section."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.fitting.matching.curve_feet import walked
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.bezier import Patches, Samples, patches, sampled
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.polish import Places, polished
from bladewright.nurbs.surface import Surface

Side = Curve | Surface
NEAR = 2.0
"""the other side is tried too where its nearest sample is not this much further away"""
EDGE = 0.02
"""how near to the trailing edge, in u, a known foot may change sides"""
DEEP, SHALLOW = 0.25, 1e-5
"""a point inside the blade is sought on its other side too where its foot is so much of the thickness there away, and
more than so much of the cloud's extent"""
CONVERGED = 1e-8
"""last step of a descent, in the parameters of a patch"""
SAMPLES = (6, 5)
"""samples along and across a patch; a patch is small where the side bends"""
BESIDE, BESIDE_EDGES = (0.05, 0.9), (4, 17)
"""u before and after which a patch is beside an edge, and samples of those: along the span they must be as close to
each other as the sides are there"""
CURVE_SAMPLES = (24, 1)
AT_ONCE = 20_000
"""points that are projected at a time, to bound the memory"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Feet:
    """The nearest places of n points on the sides, in d dimensions."""

    side: NDArray[np.intp]
    """(n,) 0 upper, 1 lower"""
    u: Reals
    v: Reals
    """0 on curves"""
    points: Reals
    """(n, d) the places themselves"""
    normals: Reals
    """(n, d) unit normals there, out of the blade"""
    beyond: Reals
    """(n, d) at an end of the blade the unit vector in the surface that points past it; 0 elsewhere"""
    miss: Reals
    """(n, d) from the place to the point"""

    @property
    def distances(self) -> Reals:
        """(n,) true distances."""
        return np.sqrt(np.sum(self.miss**2, axis=-1))

    @property
    def heights(self) -> Reals:
        """(n,) signed distances along the normals."""
        return np.sum(self.miss * self.normals, axis=-1)

    def part(self, rows: NDArray[Any]) -> "Feet":
        """Some of them, by their numbers or as a mask (n,)."""
        return Feet(**{each.name: getattr(self, each.name)[rows] for each in fields(Feet)})


def joined(parts: Sequence[Feet]) -> Feet:
    """Feet one after the other."""
    names = [each.name for each in fields(Feet)]
    return Feet(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


def feet(points: Reals, sides: Sequence[Side], hint: Feet | None = None, *, converged: float = CONVERGED) -> Feet:
    """The nearest places of points (n, d) on the upper and the lower side.

    Each starts from the nearest of samples that are close to each other where the sides bend, and descends by damped
    Newton steps, around the leading edge where need be, until it converges. With a `hint`, the feet on sides that have
    moved little since, it starts from there. `converged` is the last step in the parameters of a patch: heights above
    the sides are exact to its square, the distances of points on them to itself.
    """
    on = _ring(sides)
    best, around, v = np.full(len(points), np.inf), np.zeros(len(points)), np.zeros(len(points))
    for rows, patch, local in _starts(points, on) if hint is None else _hinted(on, hint):
        if len(rows) == 0:
            continue
        for part in np.array_split(np.arange(len(rows)), max(1, -(-len(rows) // AT_ONCE))):
            where = rows[part]
            square, *place = _descended(on, points[where], patch[part], local[part], converged)
            nearer = square < best[where]
            where = where[nearer]
            best[where] = square[nearer]
            around[where], v[where] = place[0][nearer], place[1][nearer]
    found = placed(points, sides, (around < 0.0).astype(np.intp), np.abs(around), v)
    rows = _deep(found, points, sides)
    if hint is None:
        rows = np.union1d(rows, np.flatnonzero(found.u > 1.0 - EDGE))
    if len(rows) == 0:
        return found
    square, *place = _descended(on, points[rows], *on.at(-around[rows], v[rows]), converged)
    nearer = square < best[rows]
    around[rows[nearer]], v[rows[nearer]] = place[0][nearer], place[1][nearer]
    return placed(points, sides, (around < 0.0).astype(np.intp), np.abs(around), v) if np.any(nearer) else found


def _deep(on: Feet, points: Reals, sides: Sequence[Side]) -> NDArray[np.intp]:
    """The points so deep inside a blade that their nearest place may lie on its other side."""
    heights = on.heights
    rows = np.flatnonzero(heights < -SHALLOW * float(np.max(np.ptp(points, axis=0))))
    if len(rows) == 0:
        return rows
    across = placed(points[rows], sides, 1 - on.side[rows], on.u[rows], on.v[rows]).points - on.points[rows]
    return rows[heights[rows] < -DEEP * np.sqrt(np.sum(across**2, axis=-1))]


def _descended(
    on: Patches, points: Reals, patch: NDArray[np.intp], local: Reals, converged: float
) -> tuple[Reals, Reals, Reals]:
    """Squared distances (m,) where descents from places on patches end, and both parameters there."""
    if not (on.degrees[1] or on.rational):
        low = on.low[patch, 0]
        start = low + local[:, 0] * (on.high[patch, 0] - low)
        around, square = walked(on, points, start, converged=converged)
        return square, around, np.zeros(len(points))
    found = polished(on, points, patch, local, converged=converged)
    return found.square, *_parameters(on, found)


Start = tuple[NDArray[np.intp], NDArray[np.intp], Reals]
"""points that are projected, their patches and local parameters"""


def _ring(sides: Sequence[Side]) -> Patches:
    """The patches of both sides as one: u runs from -1, the trailing edge, along the lower side to 0, and on to 1."""
    upper, lower = (patches(side) for side in sides)
    rows, columns = lower.shape
    order = np.arange(rows * columns).reshape(rows, columns)[::-1].ravel()
    mirror = np.array([-1.0, 1.0])
    ends = np.where(mirror < 0.0, lower.high, lower.low), np.where(mirror < 0.0, lower.low, lower.high)
    return Patches(
        nets=np.concatenate([lower.nets[order, ::-1], upper.nets]),
        low=np.concatenate([(mirror * ends[0])[order], upper.low]),
        high=np.concatenate([(mirror * ends[1])[order], upper.high]),
        shape=(rows + upper.shape[0], columns),
        rational=lower.rational or upper.rational,
    )


def _starts(points: Reals, on: Patches) -> list[Start]:
    """From the nearest sample, and from that on the other half where it is not much further."""
    samples = sampled(on, *(SAMPLES if on.degrees[1] else CURVE_SAMPLES))
    if on.degrees[1]:
        around = 0.5 * np.abs(on.low[:, 0] + on.high[:, 0])
        beside = np.flatnonzero((around < BESIDE[0]) | (around > BESIDE[1]))
        more = sampled(replace(on, nets=on.nets[beside]), *BESIDE_EDGES)
        samples = Samples(
            points=np.concatenate([samples.points, more.points]),
            patch=np.concatenate([samples.patch, beside[more.patch]]),
            local=np.concatenate([samples.local, more.local]),
        )
    lower = on.low[samples.patch, 0] < 0.0
    halves = np.flatnonzero(lower), np.flatnonzero(~lower)
    nearest = [cKDTree(samples.points[half]).query(points) for half in halves]
    found = []
    for k, half in enumerate(halves):
        rows = np.flatnonzero(nearest[k][0] <= NEAR * nearest[1 - k][0])
        index = half[nearest[k][1][rows]]
        found.append((rows, samples.patch[index], samples.local[index]))
    return found


def _hinted(on: Patches, hint: Feet) -> list[Start]:
    """From known feet, and from the other side of a trailing edge beside it."""
    around = np.where(hint.side == 0, hint.u, -hint.u)
    every, beside = np.arange(len(around)), np.flatnonzero(hint.u > 1.0 - EDGE)
    return [(every, *on.at(around, hint.v)), (beside, *on.at(-around[beside], hint.v[beside]))]


def placed(points: Reals, sides: Sequence[Side], side: NDArray[np.intp], u: Reals, v: Reals) -> Feet:
    """Feet at known parameters."""
    at, normals, beyond = np.empty_like(points), np.empty_like(points), np.zeros_like(points)
    for k, shape in enumerate(sides):
        rows = np.flatnonzero(side == k)
        sign = 1.0 if k == 0 else -1.0
        if isinstance(shape, Curve):
            at[rows] = shape(u[rows])
            along = np.asarray(shape.derivative(u[rows]))
            normals[rows] = sign * _unit(np.stack([-along[:, 1], along[:, 0]], axis=-1))
            continue
        at[rows] = shape(u[rows], v[rows])
        along, across = (np.asarray(shape.derivative(u[rows], v[rows], *order)) for order in ((1, 0), (0, 1)))
        normals[rows] = sign * _unit(np.cross(across, along))
        out = sign * _unit(np.cross(along, normals[rows]))
        low, high = shape.domain_v
        beyond[rows] = out * ((v[rows] >= high).astype(float) - (v[rows] <= low))[:, None]
    return Feet(side=side, u=u, v=v, points=at, normals=normals, beyond=beyond, miss=points - at)


def _parameters(on: Patches, found: Places) -> tuple[Reals, Reals]:
    low, high = on.low[found.patch], on.high[found.patch]
    place = np.where(found.local >= 1.0, high, low + found.local * (high - low))
    return place[:, 0], place[:, 1]


def _unit(vectors: Reals) -> Reals:
    size = np.sqrt(np.sum(vectors**2, axis=-1, keepdims=True))
    return np.asarray(vectors / np.where(size > 0.0, size, 1.0))
