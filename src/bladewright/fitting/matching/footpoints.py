"""Footpoints: the nearest places of a cloud on the two sides of a blade or section.

On curves, which are polynomials between their knots, Newton's iteration runs in one parameter; on surfaces it runs
patch by patch.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.nurbs.basis import Reals
from bladewright.nurbs.bezier import Patches, Samples, bernstein, patches, sampled
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.proximity import PatchPoints, polished
from bladewright.nurbs.surface import Surface

CURVE_STEPS = 60
"""Newton steps of a point on a curve at most; steps that raised the distance and were shortened count too."""
ROUNDING = 1e-13
"""relative rise of a squared distance that still counts as no rise: a few hundred times the rounding of a double."""
LONGEST_STEP = 2.0
"""longest Newton step, in widths of the polynomial piece it starts from. Longer ones leave the piece whose derivatives
predicted them."""


def _descended_on_curve(pieces: Patches, points: Reals, start: Reals, *, converged: float) -> tuple[Reals, Reals]:
    """Parameters (n,) where descents from a start (n,) end, and squared distances (n,) there.

    `converged` is the last step, of the width of a piece. Points (n, d) pass from piece to piece.
    """
    degree = pieces.degrees[0]
    coefficients = np.einsum("ij,kjd->ikd", _powers(degree), pieces.nets[:, :, 0, :-1])
    low = pieces.low[:, 0]
    width = pieces.high[:, 0] - low
    ends = low[0], pieces.high[-1, 0]

    def model(at: Reals, targets: Reals) -> tuple[Reals, Reals, Reals, Reals]:
        """Squared distance, half its slope and bend by the parameter, and the width of the piece, (m,) each."""
        piece = np.clip(np.searchsorted(low, at, side="right") - 1, 0, len(low) - 1)
        size = width[piece]
        t = ((at - low[piece]) / size)[:, None]
        of = coefficients[:, piece]
        value, first, second = of[degree], np.zeros_like(targets), np.zeros_like(targets)
        for row in of[degree - 1 :: -1] if degree else ():
            second = second * t + first
            first = first * t + value
            value = value * t + row
        miss = value - targets
        speed = np.einsum("md,md->m", first, first)
        bend = speed + 2.0 * np.einsum("md,md->m", miss, second)
        slope = np.einsum("md,md->m", miss, first)
        # where the distance is not convex, the Gauss-Newton second derivative still descends
        bend = np.where(bend > 0.0, bend, np.where(speed > 0.0, speed, 1.0))
        return np.einsum("md,md->m", miss, miss), slope / size, bend / size**2, size

    u = np.clip(start, *ends)
    square, slope, bend, size = model(u, points)
    step = np.clip(-slope / bend, -LONGEST_STEP * size, LONGEST_STEP * size)
    active = np.arange(len(u))
    for _ in range(CURVE_STEPS):
        trial = np.clip(u[active] + step[active], *ends)
        far = np.abs(trial - u[active]) > converged * size[active]
        active, trial = active[far], trial[far]
        if len(active) == 0:
            break
        new = model(trial, points[active])
        better = new[0] <= square[active] * (1.0 + ROUNDING)
        step[active[~better]] *= 0.25
        taken = active[better]
        u[taken], square[taken], size[taken] = trial[better], new[0][better], new[3][better]
        full = -new[1][better] / new[2][better]
        step[taken] = np.clip(full, -LONGEST_STEP * size[taken], LONGEST_STEP * size[taken])
    return u, square


@cache
def _powers(degree: int) -> Reals:
    """The matrix (degree + 1, degree + 1) from Bernstein coefficients to those of powers."""
    orders = [bernstein(degree, np.zeros(1), order)[0] for order in range(degree + 1)]
    factorials = np.cumprod([1.0, *range(1, degree + 1)])
    return np.asarray(np.stack(orders) / factorials[:, None])


Side = Curve | Surface
"""one side of a section or of a blade"""
OTHER_SIDE_RATIO = 2.0
"""the other side is tried too where its nearest sample is at most this many times further away than the nearest of all:
the samples are only about so exact."""
EDGE_BAND = 0.02
"""distance from the trailing edge, in u, within which a known footpoint may change to the other side. Wider bands cost
projections that change nothing."""
DEEP_SHARE, DEEP_EXTENT = 0.25, 1e-5
"""a point inside the blade is projected onto the other side too where it lies deeper than this share of the thickness
there (`DEEP_SHARE`), and deeper than this share of the cloud's extent (`DEEP_EXTENT`), which keeps noise out."""
CONVERGED = 1e-8
"""last step of a descent, in the parameters of a patch: distances of points off the surface are exact to its square."""
SAMPLES = (6, 5)
"""samples along and across a patch from which descents start. More cost time for every projection, fewer start at the
wrong hump."""
EDGE_PATCHES, EDGE_SAMPLES = (0.05, 0.9), (4, 17)
"""u before and after which a patch is sampled more densely (`EDGE_PATCHES`), and its samples along and across
(`EDGE_SAMPLES`). Along the span samples must be as close to each other as the two sides are beside an edge: with fewer,
three of 5,000 points of a mixed-flow pump were projected onto the wrong side."""
CURVE_SAMPLES = (24, 1)
"""samples along a piece of a curve from which descents start; on curves they are cheap."""
AT_ONCE = 20_000
"""points that are projected at a time; it bounds the memory, not the result."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Footpoints:
    """The nearest places of n points on the sides, in d dimensions."""

    side: NDArray[np.intp]
    """(n,) 0 upper, 1 lower"""
    u: Reals
    v: Reals
    """(n,) parameter along the span; 0 on curves"""
    points: Reals
    """(n, d) the footpoints themselves"""
    normals: Reals
    """(n, d) unit normals there, out of the blade"""
    beyond: Reals
    """(n, d) at an end of the blade the unit vector in the surface that points past the end; 0 elsewhere"""
    miss: Reals
    """(n, d) vectors from the footpoints to the points"""

    @property
    def distances(self) -> Reals:
        """(n,) true distances."""
        return np.sqrt(np.sum(self.miss**2, axis=-1))

    @property
    def heights(self) -> Reals:
        """(n,) signed distances along the normals."""
        return np.sum(self.miss * self.normals, axis=-1)

    def part(self, rows: NDArray[Any]) -> "Footpoints":
        """Some of them, by their numbers or as a mask (n,)."""
        return Footpoints(**{each.name: getattr(self, each.name)[rows] for each in fields(Footpoints)})


def concatenated(parts: Sequence[Footpoints]) -> Footpoints:
    """Several sets of footpoints as one, in order."""
    names = [each.name for each in fields(Footpoints)]
    return Footpoints(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


def nearest_footpoints(
    points: Reals, sides: Sequence[Side], hint: Footpoints | None = None, *, converged: float = CONVERGED
) -> Footpoints:
    """The nearest places of points (n, d) on the upper and the lower side.

    Each descent starts at the nearest of samples that are close to each other where the sides bend, and takes damped
    Newton steps, around the leading edge if need be, until it converges. With a `hint`, footpoints on sides that have
    moved little since, it starts there. `converged` is the last step in the parameters of a patch: signed distances of
    points off the sides are exact to its square, distances of points on them to itself.
    """
    pieces = _ring(sides)
    best, around, v = np.full(len(points), np.inf), np.zeros(len(points)), np.zeros(len(points))
    for rows, patch, local in _starts(points, pieces) if hint is None else _hinted(pieces, hint):
        if len(rows) == 0:
            continue
        for part in np.array_split(np.arange(len(rows)), max(1, -(-len(rows) // AT_ONCE))):
            where = rows[part]
            square, *place = _descended(pieces, points[where], patch[part], local[part], converged)
            nearer = square < best[where]
            where = where[nearer]
            best[where] = square[nearer]
            around[where], v[where] = place[0][nearer], place[1][nearer]
    found = footpoints_at(points, sides, (around < 0.0).astype(np.intp), np.abs(around), v)
    rows = _deep_inside(found, points, sides)
    if hint is None:
        rows = np.union1d(rows, np.flatnonzero(found.u > 1.0 - EDGE_BAND))
    if len(rows) == 0:
        return found
    square, *place = _descended(pieces, points[rows], *pieces.at(-around[rows], v[rows]), converged)
    nearer = square < best[rows]
    around[rows[nearer]], v[rows[nearer]] = place[0][nearer], place[1][nearer]
    return footpoints_at(points, sides, (around < 0.0).astype(np.intp), np.abs(around), v) if np.any(nearer) else found


def _deep_inside(footpoints: Footpoints, points: Reals, sides: Sequence[Side]) -> NDArray[np.intp]:
    """The points so deep inside a blade that their nearest place may lie on its other side."""
    heights = footpoints.heights
    rows = np.flatnonzero(heights < -DEEP_EXTENT * float(np.max(np.ptp(points, axis=0))))
    if len(rows) == 0:
        return rows
    across = (
        footpoints_at(points[rows], sides, 1 - footpoints.side[rows], footpoints.u[rows], footpoints.v[rows]).points
        - footpoints.points[rows]
    )
    return rows[heights[rows] < -DEEP_SHARE * np.sqrt(np.sum(across**2, axis=-1))]


def _descended(
    pieces: Patches, points: Reals, patch: NDArray[np.intp], local: Reals, converged: float
) -> tuple[Reals, Reals, Reals]:
    """Squared distances (m,) where descents from places on patches end, and both parameters there."""
    if not (pieces.degrees[1] or pieces.rational):
        low = pieces.low[patch, 0]
        start = low + local[:, 0] * (pieces.high[patch, 0] - low)
        around, square = _descended_on_curve(pieces, points, start, converged=converged)
        return square, around, np.zeros(len(points))
    found = polished(pieces, points, patch, local, converged=converged)
    return found.square, *_parameters(pieces, found)


Start = tuple[NDArray[np.intp], NDArray[np.intp], Reals]
"""points that are projected, their patches and local parameters"""


def _ring(sides: Sequence[Side]) -> Patches:
    """The patches of both sides in a row: u runs from -1, the trailing edge, along the lower side to 0, and on to 1."""
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


def _starts(points: Reals, pieces: Patches) -> list[Start]:
    """Starts at the nearest sample, and at the nearest on the other side where that is not much further away."""
    samples = sampled(pieces, *(SAMPLES if pieces.degrees[1] else CURVE_SAMPLES))
    if pieces.degrees[1]:
        around = 0.5 * np.abs(pieces.low[:, 0] + pieces.high[:, 0])
        near_trailing_edge = np.flatnonzero((around < EDGE_PATCHES[0]) | (around > EDGE_PATCHES[1]))
        more = sampled(replace(pieces, nets=pieces.nets[near_trailing_edge]), *EDGE_SAMPLES)
        samples = Samples(
            points=np.concatenate([samples.points, more.points]),
            patch=np.concatenate([samples.patch, near_trailing_edge[more.patch]]),
            local=np.concatenate([samples.local, more.local]),
        )
    lower = pieces.low[samples.patch, 0] < 0.0
    halves = np.flatnonzero(lower), np.flatnonzero(~lower)
    nearest = [cKDTree(samples.points[half]).query(points) for half in halves]
    found = []
    for k, half in enumerate(halves):
        rows = np.flatnonzero(nearest[k][0] <= OTHER_SIDE_RATIO * nearest[1 - k][0])
        index = half[nearest[k][1][rows]]
        found.append((rows, samples.patch[index], samples.local[index]))
    return found


def _hinted(pieces: Patches, hint: Footpoints) -> list[Start]:
    """Starts at known footpoints, and beside a trailing edge on the other side too."""
    around = np.where(hint.side == 0, hint.u, -hint.u)
    every, at_edge = np.arange(len(around)), np.flatnonzero(hint.u > 1.0 - EDGE_BAND)
    return [(every, *pieces.at(around, hint.v)), (at_edge, *pieces.at(-around[at_edge], hint.v[at_edge]))]


def footpoints_at(points: Reals, sides: Sequence[Side], side: NDArray[np.intp], u: Reals, v: Reals) -> Footpoints:
    """Footpoints at known sides and parameters."""
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
    return Footpoints(side=side, u=u, v=v, points=at, normals=normals, beyond=beyond, miss=points - at)


def _parameters(pieces: Patches, found: PatchPoints) -> tuple[Reals, Reals]:
    low, high = pieces.low[found.patch], pieces.high[found.patch]
    place = np.where(found.local >= 1.0, high, low + found.local * (high - low))
    return place[:, 0], place[:, 1]


def _unit(vectors: Reals) -> Reals:
    size = np.sqrt(np.sum(vectors**2, axis=-1, keepdims=True))
    return np.asarray(vectors / np.where(size > 0.0, size, 1.0))
