"""Globally closest points on Bezier patches: branch and bound on Bernstein coefficients.

With N / D the squared distance on a patch (D = 1 without weights) and f the smallest squared distance found so far, a
box of parameters is dropped when all Bernstein coefficients of N - f D are positive, or when Taylor's formula about its
lowest place, with bounds of the second derivatives, says so; otherwise it is halved. Where a value at the corner of a
box is below f, a descent from there finds a new closest point. A point that is missed is closer by at most a tolerance.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.bezier import Patches, bernstein, bernsteins, halving, products, sampled
from bladewright.nurbs.descent import PatchPoints, newton_step, polished

BLOCK = 2_000_000
"""Bernstein coefficients held at a time, which bounds the memory: 16 MB an array. A tenth of it, or ten times as much,
takes about the same time (design/nurbs_constants.md)."""
VALLEY_STEPS = 2
"""Newton steps towards the lowest place of a box, about which its bound is taken; without them 44 points on the axis of
an interpolated cylinder take 13 s instead of 0.04 s, with 1 or 8 as long as with 2 (design/nurbs_constants.md)."""
ROUNDING = 1e-15
"""Difference of squared distances, of the squared radius of a patch, that is rounding: a few times that of a double."""
MANY_BOXES = 20_000
"""Boxes for each query after which the tolerance grows with the square of their number, so that any search ends: five
times what a point on the axis of a cone takes."""
MAX_HALVINGS = 48
"""Halvings of a box, after which its width is near the spacing of doubles; 12 suffice in design/nurbs_constants.md."""


def nearest(on: Patches, queries: Reals, tolerance: float) -> PatchPoints:
    """The points on patches closest to queries (m, d): no other is closer by more than `tolerance` [length]."""
    search = _Search.of(on)
    chunk = max(1, BLOCK // len(on.nets))
    found = [search.nearest(queries[i : i + chunk], tolerance) for i in range(0, len(queries), chunk)]
    return PatchPoints(
        patch=np.concatenate([part.patch for part in found]),
        local=np.concatenate([part.local for part in found]),
        square=np.concatenate([part.square for part in found]),
    )


@dataclass(frozen=True, kw_only=True)
class _Boxes:
    """Boxes of patches that are not decided yet: one row for each pair of a query and a box."""

    query: NDArray[np.intp]
    patch: NDArray[np.intp]
    low: Reals
    """(k, 2) local parameters"""
    width: float
    numerator: Reals
    """(k, 2p + 1, 2q + 1) Bernstein coefficients of N"""
    denominator: Reals
    """(k, 2p + 1, 2q + 1) of D, or (k, 1, 1) without weights"""
    depth: int

    def of(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> "_Boxes":
        return _Boxes(
            query=self.query[rows],
            patch=self.patch[rows],
            low=self.low[rows],
            width=self.width,
            numerator=self.numerator[rows],
            denominator=self.denominator[rows],
            depth=self.depth,
        )

    def halved(self, *, both: bool) -> "_Boxes":
        quarters = [(i, j) for i in (0, 1) for j in ((0, 1) if both else (0,))]
        return _Boxes(
            query=np.tile(self.query, len(quarters)),
            patch=np.tile(self.patch, len(quarters)),
            low=np.concatenate([self.low + 0.5 * self.width * np.array(quarter) for quarter in quarters]),
            width=0.5 * self.width,
            numerator=_subdivided(self.numerator, quarters, both=both),
            denominator=_subdivided(self.denominator, quarters, both=both),
            depth=self.depth + 1,
        )


@dataclass(frozen=True, kw_only=True)
class _Search:
    """What the search needs to know of the patches, computed once."""

    on: Patches
    centres: Reals
    radii: Reals
    samples: cKDTree
    sample_patch: NDArray[np.intp]
    sample_local: Reals

    @classmethod
    def of(cls, on: Patches) -> "_Search":
        points, (p, q) = on.nets[..., :-1] / on.nets[..., -1:], on.degrees
        centres = 0.5 * (points.min(axis=(1, 2)) + points.max(axis=(1, 2)))
        radii = length(points - centres[:, None, None]).max(axis=(1, 2))
        starts = sampled(on, 2 * p + 2, 2 * q + 2)
        return cls(
            on=on,
            centres=centres,
            radii=radii,
            samples=cKDTree(starts.points),
            sample_patch=starts.patch,
            sample_local=starts.local,
        )

    def forms(self, patch: NDArray[np.intp]) -> Reals:
        """Squared distances on patches (k,) as forms (k, d + 2, 2p + 1, 2q + 1) of queries.

        N = forms . (1, x, |x|^2), x being the query relative to the centre; the last is D.
        """
        nets = self.on.nets[patch]
        weights = nets[..., -1:]
        moved = nets[..., :-1] - weights * self.centres[patch][:, None, None]
        factors = np.concatenate([moved, weights], axis=-1)
        squares, mixed = products(factors, factors), products(moved, weights)
        found = [squares[..., :-1].sum(axis=-1, keepdims=True), -2.0 * mixed, squares[..., -1:]]
        return np.moveaxis(np.concatenate(found, axis=-1), -1, 1)

    def nearest(self, queries: Reals, tolerance: float) -> PatchPoints:
        _, sample = self.samples.query(queries)
        best = polished(self.on, queries, self.sample_patch[sample], self.sample_local[sample])
        best = PatchPoints(patch=best.patch, local=best.local, square=best.square.copy())
        best_distance = np.sqrt(best.square)
        distance = np.sqrt(np.maximum(0.0, _square_distances(queries, self.centres)))
        # the margin covers the rounding of a difference of squares
        margin = 1e-7 * (self.radii + length(self.centres).max() + length(queries)[:, None])
        query, patch = np.nonzero(distance - self.radii < best_distance[:, None] + np.minimum(margin, self.radii))
        near, place = np.unique(patch, return_inverse=True)
        forms = self.forms(near)
        limit = max(1, BLOCK // (forms.shape[2] * forms.shape[3]))
        waiting: list[_Boxes] = []
        done = 0
        for i in range(0, len(query), limit):
            some = slice(i, i + limit)
            waiting.append(self._boxes(queries, query[some], patch[some], forms[place[some]]))
            while waiting:
                boxes = waiting.pop()
                self._improve(best, queries, boxes)
                done += len(boxes.query)
                coarser = max(1.0, done / (MANY_BOXES * len(queries))) ** 2
                boxes = boxes.of(self._open(best, boxes, coarser * tolerance))
                if len(boxes.query) and boxes.depth < MAX_HALVINGS:
                    halves = boxes.halved(both=forms.shape[3] > 1)
                    rows = np.arange(len(halves.query))
                    waiting += [halves.of(rows[k : k + limit]) for k in range(0, len(rows), limit)]
        return best

    def _boxes(self, queries: Reals, query: NDArray[np.intp], patch: NDArray[np.intp], chosen: Reals) -> _Boxes:
        x = queries[query] - self.centres[patch]
        form = np.concatenate([np.ones((len(x), 1)), x, np.sum(x * x, axis=1, keepdims=True)], axis=1)
        return _Boxes(
            query=query,
            patch=patch,
            low=np.zeros((len(query), 2)),
            width=1.0,
            numerator=(form[:, None] @ chosen.reshape(*chosen.shape[:2], -1)).reshape(len(x), *chosen.shape[2:]),
            denominator=chosen[:, -1] if self.on.rational else np.ones((len(x), 1, 1)),
            depth=0,
        )

    def _improve(self, best: PatchPoints, queries: Reals, boxes: _Boxes) -> None:
        """Descend for each query from its lowest box corner, where that is below the closest point so far."""
        values = np.stack(
            [boxes.numerator[:, i, j] / boxes.denominator[:, i, j] for i in (0, -1) for j in (0, -1)], axis=-1
        )
        corner = values.argmin(axis=1)
        value = values[np.arange(len(values)), corner]
        below = np.flatnonzero(value < best.square[boxes.query] * (1.0 - 1e-9))
        if len(below) == 0:
            return
        order = below[np.lexsort((value[below], boxes.query[below]))]
        query, first = np.unique(boxes.query[order], return_index=True)
        start = order[first]
        way = np.stack(np.divmod(corner[start], 2), axis=-1)
        local = boxes.low[start] + boxes.width * way
        if self.on.degrees[1] == 0:
            local[:, 1] = 0.0
        new = polished(self.on, queries[query], boxes.patch[start], local)
        better = new.square < best.square[query]
        best.patch[query[better]] = new.patch[better]
        best.local[query[better]] = new.local[better]
        best.square[query[better]] = new.square[better]

    def _open(self, best: PatchPoints, boxes: _Boxes, tolerance: float) -> NDArray[np.intp]:
        """The boxes that may contain a point closer than the best one by more than the tolerance."""
        square = best.square[boxes.query]
        root = np.sqrt(square)
        slack = np.where(root > tolerance, tolerance * (2.0 * root - tolerance), square)
        slack = np.maximum(slack, ROUNDING * (self.radii[boxes.patch] ** 2 + square))
        margin = boxes.numerator - (square - slack)[:, None, None] * boxes.denominator
        rows = np.flatnonzero((root > tolerance) & (margin.min(axis=(1, 2)) < 0.0))
        margin = margin[rows]
        at = (self._local(best, boxes.query[rows], boxes.patch[rows]) - boxes.low[rows]) / boxes.width
        outside = ((at < -1e-12) | (at > 1.0 + 1e-12)).any(axis=1)
        at[outside] = _lowest(margin[outside])
        return rows[_lower_bound(margin, np.clip(at, 0.0, 1.0)) < 0.0]

    def _local(self, best: PatchPoints, query: NDArray[np.intp], patch: NDArray[np.intp]) -> Reals:
        """The closest points in the local parameters of other patches: outside [0, 1] where they are not on them."""
        low, high = self.on.low, self.on.high
        home = best.patch[query]
        place = low[home] + best.local[query] * (high[home] - low[home])
        width = high[patch] - low[patch]
        return np.where(width > 0.0, (place - low[patch]) / np.where(width > 0.0, width, 1.0), 0.0)


def _lowest(values: Reals) -> Reals:
    """About where in their box (k, 2) polynomials in Bernstein form (k, m + 1, n + 1) are least, by Newton steps."""
    m, n = values.shape[1] - 1, values.shape[2] - 1
    at, eye = np.full((len(values), 2), 0.5), np.eye(2)
    at[:, 1] *= n > 0
    for _ in range(VALLEY_STEPS):
        of = bernsteins(m, at[:, 0]) @ values @ np.swapaxes(bernsteins(n, at[:, 1]), 1, 2)
        gradient = np.stack([of[:, 1, 0], of[:, 0, 1]], axis=1)
        hessian = np.stack([of[:, 2, 0], of[:, 1, 1], of[:, 1, 1], of[:, 0, 2]], axis=1).reshape(-1, 2, 2)
        metric = np.maximum(hessian, -hessian) * eye
        at = np.clip(at + newton_step(gradient, hessian, metric, np.zeros(len(at)), at), 0.0, 1.0)
    return at


def _lower_bound(values: Reals, at: Reals) -> Reals:
    """Bounds (k,) below which polynomials in Bernstein form (k, m + 1, n + 1) do not fall on their box.

    By Taylor's formula about places (k, 2), with the least second derivatives a and b and the largest twist c that the
    coefficients allow: a x^2 - 2 c |x y| + b y^2 is at least (a - c^2 / b) x^2 where b > 0, and at least
    (a - c) x^2 + (b - c) y^2.
    """
    m, n = values.shape[1] - 1, values.shape[2] - 1
    along, across = np.diff(values, axis=1), np.diff(values, axis=2)
    bends = [
        (count - 1) * count * np.diff(first, axis=1 + k).min(axis=(1, 2)) if count > 1 else np.zeros(len(values))
        for k, (first, count) in enumerate(((along, m), (across, n)))
    ]
    twist = m * n * np.square(np.diff(along, axis=2)).max(axis=(1, 2), initial=0.0) ** 0.5
    steepest = np.maximum(*bends)
    s, t = [bernstein(m, at[:, 0], order) for order in (0, 1)], [bernstein(n, at[:, 1], order) for order in (0, 1)]
    rows = [(s[a][:, None] @ values)[:, 0] for a in (0, 1)]
    bound, *slopes = (np.sum(rows[a] * t[b], axis=1) for a, b in ((0, 0), (1, 0), (0, 1)))
    for k, bend in enumerate(bends):
        with_other = np.where(bends[1 - k] == steepest, bend - twist**2 / np.where(steepest > 0.0, steepest, 1.0), 0.0)
        least = np.where(steepest > 0.0, with_other, bend - twist)
        bound += np.minimum(-at[:, k] * slopes[k], (1.0 - at[:, k]) * slopes[k])
        bound += 0.5 * np.minimum(least, 0.0) * np.maximum(at[:, k], 1.0 - at[:, k]) ** 2
    return np.asarray(bound)


def _subdivided(coefficients: Reals, quarters: list[tuple[int, int]], *, both: bool) -> Reals:
    along = halving(coefficients.shape[1] - 1)
    across = halving(coefficients.shape[2] - 1)
    halves = [matrix @ coefficients for matrix in along]
    return np.concatenate([halves[i] @ across[j].T if both else halves[i] for i, j in quarters])


def _square_distances(a: Reals, b: Reals) -> Reals:
    return np.asarray(np.sum(a * a, axis=1)[:, None] - 2.0 * a @ b.T + np.sum(b * b, axis=1))
