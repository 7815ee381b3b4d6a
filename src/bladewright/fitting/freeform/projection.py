"""Nearest places of points on curves and surfaces, and the directions in which misses count."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.nurbs.basis import Reals, breaks
from bladewright.nurbs.bezier import Patches, patches, sampled
from bladewright.nurbs.closest import TOLERANCE
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.proximity import PatchPoints, nearest, polished
from bladewright.nurbs.surface import Surface

NEWTON_STEPS = 60
"""Newton steps of a point at most, halvings included"""
LAST_NEWTON_STEP = 1e-9
"""step, of the domain, after which the next Newton step is rounding."""
SAMPLES = ((6, 6), (24, 1))
"""samples along and across a patch of a surface and of a curve at which a search starts"""
CERTIFIED_SHARE = 0.01
"""share of the largest distance within which a certified search does not look for nearer places."""
AT_ONCE = 20_000
"""points that are projected onto a surface at a time; it bounds the memory."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Projections:
    """The nearest places of n points, and an orthonormal frame of each that spans the misses that count.

    A miss along a tangent is no distance: the place moves. Where a place is held at an end, it counts as well.
    """

    parameters: Reals
    """(n, k) of the places; k = 1 on a curve, 2 on a surface"""
    points: Reals
    """(n, d) the places themselves"""
    distances: Reals
    """(n,)"""
    along: Reals
    """(n, d) unit vectors from the points to their places; any normal where the distance is zero"""
    across: Reals
    """(j, d) further unit vectors that count, perpendicular to `along` and to the tangents"""
    across_of: NDArray[np.intp]
    """(j,) the points that these belong to"""


def projected(
    shape: Curve | Surface,
    points: Reals,
    near: Reals | None = None,
    *,
    closed: bool = False,
    held: tuple[NDArray[np.intp], Reals] | None = None,
) -> Projections:
    """The nearest places of points (n, d): of all, or where the descent from parameters `near` (n, k) ends.

    A closed curve has no ends to be held at. The places of points `held[0]` (j,) stay at parameters `held[1]` (j, k).
    """
    if near is None:
        near = sampled_parameters(shape, points)
    if isinstance(shape, Curve):
        parameters = _descended_on_curve(shape, points, near[:, 0], closed=closed)[:, None]
    else:
        parameters = _descended_on_surface(shape, points, near)
    domains = [shape.domain] if isinstance(shape, Curve) else [shape.domain_u, shape.domain_v]
    low, high = np.transpose(domains)
    free = np.ones_like(parameters, dtype=bool) if closed else (parameters > low) & (parameters < high)
    if held is not None:
        parameters[held[0]], free[held[0]] = held[1], False
    if isinstance(shape, Curve):
        place, tangent = shape.derivatives(parameters[:, 0], 1)
        tangents = [np.asarray(tangent)]
    else:
        of = shape.derivatives(parameters[:, 0], parameters[:, 1], 1)
        place, tangents = of[0, 0], [of[1, 0], of[0, 1]]
    return with_frames(parameters, np.asarray(place), points, tangents, free)


def nearer_projections(footpoints: Projections, others: Projections, rows: NDArray[np.bool_]) -> Projections:
    """Projections, or at some rows (n,) the others where these are nearer; without directions across."""
    better = np.zeros(len(rows), dtype=bool)
    better[rows] = others.distances < footpoints.distances[rows]
    chosen = better[rows]
    changed = {name: getattr(footpoints, name).copy() for name in ("parameters", "points", "distances", "along")}
    for name, values in changed.items():
        values[better] = getattr(others, name)[chosen]
    return replace(footpoints, across=footpoints.across[:0], across_of=footpoints.across_of[:0], **changed)


def sampled_parameters(shape: Curve | Surface, points: Reals) -> Reals:
    """Parameters (n, k) of those of many places on a shape that are nearest to points (n, d)."""
    pieces = patches(shape)
    samples = sampled(pieces, *SAMPLES[isinstance(shape, Curve)])
    index = cKDTree(samples.points).query(points)[1]
    low, high = pieces.low[samples.patch[index]], pieces.high[samples.patch[index]]
    return (low + samples.local[index] * (high - low))[:, : 1 if isinstance(shape, Curve) else 2]


def certified_parameters(shape: Curve | Surface, points: Reals, footpoints: Projections) -> Reals:
    """Parameters (n, k) of places that are nearest up to `CERTIFIED_SHARE` of the largest distance.

    Those of the given projections stay where the search has nothing nearer.
    """
    pieces = patches(shape)
    extent = float(np.ptp(shape.control_points.reshape(-1, points.shape[1]), axis=0).max())
    found = nearest(pieces, points, max(TOLERANCE * extent, CERTIFIED_SHARE * float(footpoints.distances.max())))
    nearer = np.sqrt(found.square) < footpoints.distances * (1.0 - CERTIFIED_SHARE) - TOLERANCE * extent
    parameters = _parameters(pieces, found)[:, : footpoints.parameters.shape[1]]
    return np.where(nearer[:, None], parameters, footpoints.parameters)


def with_frames(
    parameters: Reals, places: Reals, points: Reals, tangents: Sequence[Reals], free: NDArray[np.bool_]
) -> Projections:
    """Projections at known parameters (n, k); along the k `tangents` (n, d) the places are `free` (n, k) to move."""
    miss = places - points
    distances = np.sqrt(np.sum(miss**2, axis=-1))
    dimension = points.shape[1]
    along = np.zeros_like(points)
    across: list[Reals] = []
    rest_of: list[NDArray[np.intp]] = []
    moves = [free[:, k] & (np.sum(tangent**2, axis=-1) > 0.0) for k, tangent in enumerate(tangents)]
    code = np.sum([2**k * move for k, move in enumerate(moves)], axis=0)
    for value in np.unique(code):
        rows = np.flatnonzero(code == value)
        used = [tangent[rows] for k, tangent in enumerate(tangents) if value & 2**k]
        far = distances[rows] > 1e-14 * (1.0 + np.max(np.sqrt(np.sum(points**2, axis=-1)), initial=0.0))
        unit = np.where(far[:, None], miss[rows] / np.where(far, distances[rows], 1.0)[:, None], 0.0)
        # a zero column would leave the frame to chance: where nothing is missed, any normal does
        spanned = np.stack([*used, np.where(far[:, None], unit, _normals(used, rows, dimension))], axis=-1)
        frame = np.linalg.qr(spanned, mode="complete")[0]
        count = len(used)
        along[rows] = np.where(far[:, None], unit, frame[:, :, min(count, dimension - 1)])
        for k in range(count + 1, dimension):
            across.append(frame[:, :, k])
            rest_of.append(rows)
    return Projections(
        parameters=parameters,
        points=places,
        distances=distances,
        along=along,
        across=np.concatenate(across) if across else np.zeros((0, dimension)),
        across_of=np.concatenate(rest_of) if rest_of else np.zeros(0, dtype=np.intp),
    )


def newton_descent(
    derivatives: Callable[[Reals], Sequence[Reals]], points: Reals, start: Reals, domain: tuple[float, float]
) -> Reals:
    """Parameters (n,) of a curve where Newton's descent of the distance from `start` (n,) ends, within the domain.

    `derivatives` gives the curve's point and its first and second derivative (m, d). A step that would raise the
    distance is halved.
    """
    u = np.clip(start, *domain)
    active, factor = np.arange(len(u)), np.ones(len(u))
    step, square = _step(derivatives(u), points)
    for _ in range(NEWTON_STEPS):
        trial = np.clip(u[active] + factor[active] * step[active], *domain)
        moving = trial != u[active]
        active, trial = active[moving], trial[moving]
        if len(active) == 0:
            break
        new_step, new_square = _step(derivatives(trial), points[active])
        # so close to the end, whether the distance falls is rounding, and Newton's step is exact
        done = (trial - u[active]) ** 2 <= (LAST_NEWTON_STEP * (domain[1] - domain[0])) ** 2
        lower = done | (new_square <= square[active])
        taken = active[lower]
        u[taken], step[taken], square[taken], factor[taken] = trial[lower], new_step[lower], new_square[lower], 1.0
        factor[active[~lower]] *= 0.5
        active = active[~done]
    return u


def _step(of: Sequence[Reals], points: Reals) -> tuple[Reals, Reals]:
    miss = of[0] - points
    slope = np.einsum("nd,nd->n", miss, of[1])
    speed = np.einsum("nd,nd->n", of[1], of[1])
    bend = speed + np.einsum("nd,nd->n", miss, of[2])
    # where the distance is not convex, or nearly so, the speed alone gives a step that descends
    rate = np.where(bend > 1e-3 * speed, bend, speed)
    return -slope / np.where(rate > 0.0, rate, 1.0), np.einsum("nd,nd->n", miss, miss)


def _descended_on_curve(curve: Curve, points: Reals, start: Reals, *, closed: bool) -> Reals:
    def derivatives(u: Reals) -> Sequence[Reals]:
        return curve.derivatives(u, 2)

    u = newton_descent(derivatives, points, start, curve.domain)
    low, high = curve.domain
    if closed:
        seam = np.flatnonzero((u <= low) | (u >= high))
        other = newton_descent(derivatives, points[seam], np.where(u[seam] <= low, high, low), curve.domain)
        better = np.sum((curve(other) - points[seam]) ** 2, axis=-1) < np.sum(
            (curve(u[seam]) - points[seam]) ** 2, axis=-1
        )
        u[seam] = np.where(better, other, u[seam])
    return u


def _descended_on_surface(surface: Surface, points: Reals, near: Reals) -> Reals:
    pieces = patches(surface)
    place = [
        np.clip(np.searchsorted(breaks(knots), near[:, k], side="right") - 1, 0, pieces.shape[k] - 1)
        for k, knots in enumerate((surface.knots_u, surface.knots_v))
    ]
    patch = place[0] * pieces.shape[1] + place[1]
    local = np.clip((near - pieces.low[patch]) / (pieces.high - pieces.low)[patch], 0.0, 1.0)
    parts = np.array_split(np.arange(len(points)), max(1, -(-len(points) // AT_ONCE)))
    return np.concatenate(
        [_parameters(pieces, polished(pieces, points[part], patch[part], local[part])) for part in parts]
    )


def _parameters(pieces: Patches, found: PatchPoints) -> Reals:
    low, high = pieces.low[found.patch], pieces.high[found.patch]
    return np.where(found.local >= 1.0, high, low + found.local * (high - low))


def _normals(tangents: list[Reals], rows: NDArray[np.intp], dimension: int) -> Reals:
    """For each point the axis that is least along its tangents."""
    alignment = np.zeros((len(rows), dimension))
    for tangent in tangents:
        alignment = alignment + tangent**2 / np.sum(tangent**2, axis=-1, keepdims=True)
    return np.eye(dimension)[np.argmin(alignment, axis=-1)]
