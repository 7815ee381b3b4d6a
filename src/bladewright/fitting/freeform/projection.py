"""Nearest places of points on curves and surfaces, and the directions in which misses count."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bladewright.nurbs.basis import Reals
from bladewright.nurbs.closest import TOLERANCE, Descents, Places, closest_on_curve
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface

LAST_STEP = 1e-10
"""last step of a descent, in the parameters of a patch: distances of exact points are exact to it."""
CERTIFIED_SHARE = 0.01
"""share of the largest distance within which a certified search does not look for nearer places."""


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
    search, count = Descents((shape,)), len(points)
    start = None if near is None else Places(shape=np.zeros(count, dtype=np.intp), u=near[:, 0], v=near[:, -1])
    found = search.nearest(points, start, converged=LAST_STEP)
    parameters = np.stack([found.u, found.v], axis=-1)[:, : 1 if isinstance(shape, Curve) else 2]
    domains = [shape.domain] if isinstance(shape, Curve) else [shape.domain_u, shape.domain_v]
    low, high = np.transpose(domains)
    if closed:
        seam = np.flatnonzero((found.u <= low) | (found.u >= high))
        other = Places(shape=found.shape[seam], u=low + high - found.u[seam], v=found.v[seam])
        past = search.nearest(points[seam], other, converged=LAST_STEP)
        parameters[seam, 0] = np.where(past.square < found.square[seam], past.u, found.u[seam])
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


def certified_parameters(shape: Curve, points: Reals, footpoints: Projections) -> Reals:
    """Parameters (n, 1) on a curve that are nearest up to `CERTIFIED_SHARE` of the largest distance.

    Those of the given projections stay where the search has nothing nearer.
    """
    extent = float(np.ptp(shape.control_points, axis=0).max())
    share = max(TOLERANCE, CERTIFIED_SHARE * float(footpoints.distances.max()) / extent)
    found = closest_on_curve(shape, points, tolerance=share)
    nearer = found.distances < footpoints.distances * (1.0 - CERTIFIED_SHARE) - TOLERANCE * extent
    return np.where(nearer[:, None], found.u[:, None], footpoints.parameters)


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


def _normals(tangents: list[Reals], rows: NDArray[np.intp], dimension: int) -> Reals:
    """For each point the axis that is least along its tangents."""
    alignment = np.zeros((len(rows), dimension))
    for tangent in tangents:
        alignment = alignment + tangent**2 / np.sum(tangent**2, axis=-1, keepdims=True)
    return np.eye(dimension)[np.argmin(alignment, axis=-1)]
