"""Motions that bring a cloud near a target, without a guess: all sign choices of principal axes, then all turns.

Every start is followed by iterative closest points, first point to point (Besl and McKay 1992), then point to plane
(Chen and Medioni 1992), on evenly spread samples of the target; all starts at once, and those that lag are dropped.
"""

from itertools import permutations, product

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from bladewright.fitting.assessment.result import Motion
from bladewright.fitting.clouds.isolated import has_neighbours
from bladewright.fitting.clouds.thinning import even_subset, random_subset
from bladewright.fitting.registration.rigid_motion import GENERATORS, rotation_by
from bladewright.nurbs.basis import Reals

TARGET_SAMPLES = {2: 800, 3: 4000}
"""samples of the target, by dimension"""
SEARCH_POINTS = {2: 120, 3: 160}
"""points of the cloud that take part in the search, by dimension"""
START_SHIFT = 0.25
"""shift of further starts, of the target's extents, as the cloud may cover a part of it only."""
SEARCH_ROUNDS = ((3, 8, 0.25), (3, 8, 0.25), (0, 20, 0.1))
"""steps point to point, steps point to plane, and share of the starts that is kept, round by round"""
SATURATION = 0.08
"""distance, of the target's extent, beyond which a point counts no more."""
FALLBACK_TURNS = {2: 48, 3: 600}
"""turns of the fallback, by dimension: evenly many in the plane, random ones in space"""
DISTINCT_MOTIONS = 0.05
"""distance, of the target's extent, by which two motions must differ to count as different."""


def found_motions(cloud: Reals, samples: Reals, normals: Reals, *, everywhere: bool, most: int = 4) -> list[Motion]:
    """The best different motions of a cloud (n, d) onto samples (m, d) with normals, best first.

    They start from the principal axes of both or, `everywhere`, from turns all over the space of rotations.
    """
    dimension = cloud.shape[1]
    cloud = cloud[random_subset(len(cloud), 20_000)]
    cloud = cloud[has_neighbours(cloud)]
    cloud = cloud[even_subset(cloud, 8 * SEARCH_POINTS[dimension])]
    pivot, centre = np.mean(cloud, axis=0), np.mean(samples, axis=0)
    axes, goals = _axes(cloud - pivot), _axes(samples - centre)
    if everywhere:
        turns = _all_turns(dimension)
    else:
        turns = np.array([goals @ flip @ axes.T for flip in _flips(dimension)])
        turns = turns[np.linalg.det(turns) > 0.0]
    extents = np.ptp((samples - centre) @ goals, axis=0)
    lags = np.ptp((cloud - pivot) @ axes, axis=0) < 0.9 * extents
    steps = [(-START_SHIFT, 0.0, START_SHIFT) if lag and not everywhere else (0.0,) for lag in lags[:2]]
    shifts = np.array([goals[:, :2] @ (np.array(step) * extents[:2]) for step in product(*steps)])
    points = (cloud - pivot)[random_subset(len(cloud), SEARCH_POINTS[dimension])]
    rotations = np.repeat(turns, len(shifts), axis=0)
    places = centre + np.tile(shifts, (len(turns), 1))
    rotations, places, scores = _descended(points, samples, normals, rotations, places)
    extent = float(np.ptp(samples, axis=0).max())
    chosen: list[Motion] = []
    for k in np.argsort(scores):
        motion = Motion(rotation=rotations[k], translation=places[k] - rotations[k] @ pivot)
        moved = motion(cloud)
        if all(np.sqrt(np.mean((other(cloud) - moved) ** 2)) > DISTINCT_MOTIONS * extent for other in chosen):
            chosen.append(motion)
        if len(chosen) == most:
            break
    return chosen


def _descended(
    points: Reals, samples: Reals, normals: Reals, rotations: Reals, places: Reals
) -> tuple[Reals, Reals, Reals]:
    """Rotations (b, d, d), places of the pivot (b, d) and scores (b,) after closest-point steps from b starts."""
    tree = cKDTree(samples)
    width = SATURATION * float(np.ptp(samples, axis=0).max())
    count = len(GENERATORS[points.shape[1]])
    scores = np.zeros(len(rotations))
    for rigid, plane, share in SEARCH_ROUNDS:
        for step in range(rigid + plane):
            arms = np.einsum("bde,ne->bnd", rotations, points)
            distances, index = tree.query((arms + places[:, None]).reshape(-1, points.shape[1]))
            distances, index = distances.reshape(arms.shape[:2]), index.reshape(arms.shape[:2])
            middle = np.median(distances, axis=1, keepdims=True)
            weights = 1.0 / (1.0 + (distances / np.maximum(2.0 * middle, 0.02 * width)) ** 2) ** 2
            goals = samples[index]
            if step < rigid:
                rotations, places = _kabsch(points, goals, weights)
                continue
            miss = arms + places[:, None] - goals
            facing = normals[index]
            rows = np.concatenate(
                [np.einsum("bnd,kde,bne->bnk", facing, GENERATORS[points.shape[1]], arms), facing], axis=-1
            )
            right = -np.sum(facing * miss, axis=-1)
            matrix = np.einsum("bnk,bn,bnl->bkl", rows, weights, rows)
            size = np.einsum("bkk->bk", matrix)
            floor = 1e-3 * np.concatenate(
                [
                    np.repeat(size[:, :count].sum(axis=1, keepdims=True), count, axis=1),
                    np.repeat(size[:, count:].sum(axis=1, keepdims=True), size.shape[1] - count, axis=1),
                ],
                axis=1,
            )
            matrix = matrix + floor[:, :, None] * np.eye(size.shape[1]) + 1e-300 * np.eye(size.shape[1])
            change = np.linalg.solve(matrix, np.einsum("bnk,bn,bn->bk", rows, weights, right)[..., None])[..., 0]
            turn = change[:, :count]
            largest = np.sqrt(np.sum(turn**2, axis=1, keepdims=True))
            rotations = rotation_by(turn * np.minimum(1.0, 0.3 / np.maximum(largest, 1e-300))) @ rotations
            places = places + change[:, count:]
        arms = np.einsum("bde,ne->bnd", rotations, points) + places[:, None]
        distances, index = tree.query(arms.reshape(-1, points.shape[1]))
        # across the samples' spacing only the distance from the tangent plane says how good a place is
        normal_distance = np.sum(normals[index] * (arms.reshape(-1, points.shape[1]) - samples[index]), axis=-1)
        excess = np.maximum(0.0, distances - 0.3 * width)
        scores = np.mean(np.minimum(normal_distance**2 + excess**2, width**2).reshape(arms.shape[:2]), axis=1)
        kept = np.argsort(scores)[: max(12, int(share * len(scores)))]
        rotations, places, scores = rotations[kept], places[kept], scores[kept]
    return rotations, places, scores


def _kabsch(points: Reals, goals: Reals, weights: Reals) -> tuple[Reals, Reals]:
    """Rotations and places of least squares from points (n, d) to goals (b, n, d) (Kabsch 1976)."""
    share = weights / weights.sum(axis=1, keepdims=True)
    start, end = np.einsum("bn,nd->bd", share, points), np.einsum("bn,bnd->bd", share, goals)
    left, _, right = np.linalg.svd(
        np.einsum("bn,bnd,bne->bde", share, goals - end[:, None], points[None] - start[:, None])
    )
    left[:, :, -1] *= np.linalg.det(left @ right)[:, None]
    rotations = left @ right
    return rotations, end - np.einsum("bde,be->bd", rotations, start)


def _axes(centred: Reals) -> Reals:
    """Principal axes as columns, the longest first, right-handed."""
    axes: Reals = np.linalg.svd(centred, full_matrices=False)[2].T.copy()
    axes[:, -1] *= np.linalg.det(axes)
    return axes


def _flips(dimension: int) -> list[Reals]:
    """Every matrix that permutes axes and changes their signs."""
    return [
        np.eye(dimension)[list(order)] * np.array(signs)
        for order in permutations(range(dimension))
        for signs in product((1.0, -1.0), repeat=dimension)
    ]


def _all_turns(dimension: int) -> Reals:
    if dimension == 2:
        return rotation_by(np.linspace(0.0, 2.0 * np.pi, FALLBACK_TURNS[2], endpoint=False)[:, None])
    return np.asarray(Rotation.random(FALLBACK_TURNS[3], rng=np.random.default_rng(0)).as_matrix())
