"""How much of a cloud's distances is noise, and how much a misfit of the design: neighbouring points tell.

A misfit of the design varies slowly along the surface; noise does not.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.fitting.clouds.thinning import random_subset
from bladewright.fitting.matching.footpoints import Footpoints
from bladewright.fitting.matching.outliers import ALWAYS_INLIER, OUTLYING_NOISE, neighbourhood_of, outliers_of
from bladewright.numerics.robust import median_deviation
from bladewright.nurbs.basis import Reals

COMPARED_POINTS = 20_000
"""points that are compared with their neighbours; it bounds the time, and their noise is known to half a percent."""


@dataclass(frozen=True, kw_only=True, eq=False)
class NoiseEstimate:
    """The noise of a cloud, its inliers, and how far neighbours share their distances."""

    noise: float
    """standard deviation of what neighbours do not share, of a point of the mean weight [m]"""
    inliers: NDArray[np.bool_]
    """(n,) whether a point takes part; the others are outliers"""
    correlation: float
    """share of the inliers' variance that neighbours have in common: 0 for pure noise, 1 for a misfit of the design"""

    def independent_share(self, parameters: int) -> float:
        """Share of the points that count as independent, for a design with so many parameters.

        A misfit is shared by as many neighbours as there are points for two parameters.
        """
        points = float(np.count_nonzero(self.inliers)) / (2.0 * parameters)
        return 1.0 / (1.0 + self.correlation * max(points - 1.0, 0.0))


def noise_of(
    points: Reals, footpoints: Footpoints, weights: Reals | None = None, *, allow_outliers: bool = True
) -> NoiseEstimate:
    """The noise estimate of points (n, d) about their footpoints; unless `allow_outliers`, every point is an inlier.

    Weights (n,) are inverse variances relative to each other. A point of weight 0 tells nothing of the noise, and is an
    outlier where it lies further off than every inlier.
    """
    if weights is not None and not np.all(weights > 0.0):
        return _noise_of_weighted(points, footpoints, weights, allow_outliers=allow_outliers)
    if len(points) > COMPARED_POINTS:
        return _noise_of_many(points, footpoints, weights, allow_outliers=allow_outliers)
    weights = np.ones(len(points)) if weights is None else weights / np.mean(weights)
    heights, distances = footpoints.heights, footpoints.distances
    around = neighbourhood_of(points, footpoints)
    inliers = np.ones(len(points), dtype=bool)
    if allow_outliers:
        past = np.sqrt(np.sum((footpoints.miss - heights[:, None] * footpoints.normals) ** 2, axis=-1))
        inliers = ~outliers_of(heights, past, distances, weights, footpoints, around)
    index = around.index
    kept = inliers & inliers[index].all(axis=1)
    kept = kept if np.any(kept) else np.ones(len(points), dtype=bool)
    others, height, own_weight = weights[index[kept]], heights[kept], weights[kept]
    total = np.sum(others, axis=1)
    # scaled to the variance of the noise
    difference = (height - np.sum(others * heights[index[kept]], axis=1) / total) / np.sqrt(
        1.0 / own_weight + 1.0 / total
    )
    variance, own = float(np.mean(own_weight * height**2)), float(np.mean(difference**2))
    correlation = float(np.clip(1.0 - own / variance, 0.0, 1.0)) if variance > 0.0 else 0.0
    return NoiseEstimate(noise=median_deviation(difference), inliers=inliers, correlation=correlation)


def _noise_of_many(
    points: Reals, footpoints: Footpoints, weights: Reals | None, *, allow_outliers: bool
) -> NoiseEstimate:
    """The noise estimate of some of the points; the others are inliers where they are level with one beside them."""
    rows = random_subset(len(points), COMPARED_POINTS)
    part = footpoints.part(rows)
    found = noise_of(points[rows], part, None if weights is None else weights[rows], allow_outliers=allow_outliers)
    inliers = np.ones(len(points), dtype=bool)
    if allow_outliers:
        kept = part.part(found.inliers)
        beside = cKDTree(kept.points).query(footpoints.points)[1]
        level = np.hypot(found.noise, found.noise) if weights is None else found.noise * np.sqrt(1.0 + 1.0 / weights)
        near = ALWAYS_INLIER * float(np.max(np.ptp(points, axis=0)))
        step = footpoints.distances - kept.distances[beside]
        inliers = step <= OUTLYING_NOISE * level + near
        inliers[rows] = found.inliers
    return replace(found, inliers=inliers)


def _noise_of_weighted(points: Reals, footpoints: Footpoints, weights: Reals, *, allow_outliers: bool) -> NoiseEstimate:
    """The noise estimate of the points that have a weight, and which of the others are inliers."""
    rows = weights > 0.0
    part = footpoints.part(rows)
    found = noise_of(points[rows], part, weights[rows], allow_outliers=allow_outliers)
    inliers = np.ones(len(points), dtype=bool)
    inliers[rows] = found.inliers
    if allow_outliers:
        inliers[~rows] = footpoints.distances[~rows] <= np.max(part.distances[found.inliers])
    return replace(found, inliers=inliers)
