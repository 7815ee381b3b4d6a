"""Which points of a cloud are outliers, and how much of the others' distances is noise: neighbouring points tell.

Along a surface the signed distances of points change steadily, by noise and by what the design misses. Outliers are
small groups, of one point or of many, that no step within the noise leads to. Where the rest is matched well, distances
alone tell them. A misfit of the design varies slowly along the surface; noise does not.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.special import bdtrc, ndtri

from bladewright.fitting.clouds.thinning import MOST_POINTS, even_subset, groups, random_subset, without_copies
from bladewright.fitting.matching.footpoints import BETWEEN_EDGES, EDGE_PARAMETERS, Footpoints
from bladewright.numerics.robust import DEVIATION_OVER_MEDIAN, median_deviation
from bladewright.nurbs.basis import Reals

NEIGHBOURS = {2: 4, 3: 8}
"""neighbours that a point is compared with, by dimension: a ring on a surface (design/matching_constants.md)"""
OUTLYING_NOISE = 6.0
"""distance of an outlier, in standard deviations of the noise (design/matching_constants.md)"""
NEIGHBOUR_STEP = 5.0
"""largest difference of neighbours on one surface, in standard deviations of the noise
(design/matching_constants.md)"""
OUTLYING_MISFIT, OUTLYING_MISFIT_AT_EDGES = 6.0, 60.0
"""distance of an outlier, in usual misfits of the design, and near an edge (design/matching_constants.md)"""
MATCHED = 1.0 / 3.0
"""misfit, of the noise, below which distances are noise: it adds 5 % to their standard deviation"""
EDGE_BAND = 0.03
"""distance from an edge, in u, within which a point counts as near it (design/matching_constants.md)"""
SIDES_APART = 0.05
"""distance that the sides of a thin blade are taken to have at least, of the extent (design/matching_constants.md)"""
CHANCE_EXCESS = 3.0
"""excess of the usual distance over the noise by chance, in multiples of the noise over the root of the number of
points (design/matching_constants.md)"""
LARGEST_GROUP, SMALL_GROUP = 0.05, 20
"""largest group of outliers, of all points, and points it may have in any case (design/matching_constants.md)"""
END_BAND, WRONG_END_SHARE = 0.02, 0.2
"""distance from an end, in v, within which points show it, and share of them past it from which it is the end that is
wrong (design/matching_constants.md)"""
PAST_END_BY_CHANCE, LEVEL_SLOPE = 1, 0.05
"""points level with the sides that may lie past an end by chance, and height per length past it up to which a point is
level (design/matching.md)"""
LARGEST_OUTLIER_SHARE = 0.15
"""share of outliers from which it is the design that lies off, and all points count as inliers
(design/matching_constants.md)"""
LOCAL_POINTS, LOCAL_OVERLAP = 128, 16
"""points around a site whose noise and misfit are alike, and sites around a point (design/matching_constants.md)"""
DEVIATION_OVER_QUARTILE = 1.0 / float(ndtri(5.0 / 8.0))
"""standard deviation of normal noise over the lower quartile of its magnitude, which end faces spoil less than the
median (design/matching_constants.md)"""
CORE_NEIGHBOURS = 3
"""points of the large groups beside a small one to which a step within the noise may lead
(design/matching_constants.md)"""
EXACT = 1e-4
"""distance to which exact points are to be met, of the extent of the cloud or of the chord: no point nearer is an
outlier (design/matching_constants.md)"""
CROWD = 2
"""neighbours that are outliers beside one of a part that is not found: of 1 % that scatter, 3 in 1,000 have so many"""
SIGNIFICANCE = 1e-3
"""probability of what is called no chance: the level of tests of good matches (Neyman and Pearson 1933)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Neighbourhood:
    """Which of n points are beside each other on the sides of a design."""

    places: Reals
    """(n, d + 1) the footpoints, and a coordinate that holds the sides apart except at the edges"""
    index: NDArray[np.intp]
    """(n, k) the nearest other points; the point itself where there are no others"""
    extent: float
    """largest extent of the cloud [m]"""


def neighbourhood_of(points: Reals, footpoints: Footpoints) -> Neighbourhood:
    """The neighbours of points (n, d) with known footpoints."""
    extent = float(np.ptp(points, axis=0).max())
    inward = np.minimum(np.minimum(footpoints.u, 1.0 - footpoints.u) / EDGE_BAND, 1.0)
    lifted = np.where(footpoints.side == 0, 1.0, -1.0) * SIDES_APART * extent * inward
    places = np.column_stack([footpoints.points, lifted])
    count = NEIGHBOURS[points.shape[1]]
    neighbours = min(count + 1, len(points))
    index = np.reshape(cKDTree(places).query(places, k=neighbours)[1], (len(points), neighbours))
    # of several points in one place, the point itself is not always found first
    own = index == np.arange(len(points))[:, None]
    index = np.where(own, index[:, :1], index)[:, 1:]
    return Neighbourhood(
        places=places, index=np.pad(index, ((0, 0), (0, count - neighbours + 1)), mode="edge"), extent=extent
    )


def _outliers_of(footpoints: Footpoints, weights: Reals, around: Neighbourhood) -> NDArray[np.bool_]:
    """Which of n points are outliers; weights (n,) are positive inverse variances, relative to each other."""
    heights, distances = footpoints.heights, footpoints.distances
    past = np.sqrt(np.sum((footpoints.miss - heights[:, None] * footpoints.normals) ** 2, axis=-1))
    index, roots = around.index, np.sqrt(weights)
    # a median of k neighbours has about 1 / k of the variance
    spread_out = np.sqrt(1.0 / weights + np.mean(1.0 / weights[index], axis=1) / index.shape[1])
    deviations = np.abs(heights - np.median(heights[index], axis=1)) / spread_out
    noise = median_deviation(deviations)
    usual = median_deviation(roots * distances)
    chance = 1.0 + CHANCE_EXCESS / np.sqrt(len(heights))
    misfit = float(np.sqrt(max(usual**2 - (chance * noise) ** 2, 0.0)))
    # the points around each of some sites, and the site of every point
    sites = even_subset(around.places, max(1, LOCAL_OVERLAP * len(heights) // LOCAL_POINTS))
    near = cKDTree(around.places).query(around.places[sites], k=min(LOCAL_POINTS, len(heights)))[1]
    near, site = near.reshape(len(sites), -1), cKDTree(around.places[sites]).query(around.places)[1]
    level = np.maximum(noise, DEVIATION_OVER_QUARTILE * np.quantile(deviations[near], 0.25, axis=1)[site]) / roots
    edge = (footpoints.u < EDGE_BAND) | (footpoints.u > 1.0 - EDGE_BAND)
    # a misfit of the design is told from outliers by going on from point to point
    matched = misfit < MATCHED * noise
    local = np.full(len(heights), misfit)
    if not matched and footpoints.points.shape[1] == 2:
        # on a blade points of an end face may be most of those around
        usual_near = np.median((roots * distances)[near[:, : LOCAL_POINTS // 2]], axis=1)
        local = np.maximum(misfit, DEVIATION_OVER_MEDIAN * usual_near[site])
    least = np.hypot(OUTLYING_NOISE * level, np.where(edge, OUTLYING_MISFIT_AT_EDGES, OUTLYING_MISFIT) * local)
    least = np.maximum(least, EXACT * around.extent)
    far = distances > least
    if not np.any(far):
        return far
    level_past = np.abs(heights) <= np.maximum(least, LEVEL_SLOPE * past)
    wrong = _short_of_ends(far & (past > least), level_past, footpoints)
    beyond = (past > least) & ~wrong
    largest = min(max(SMALL_GROUP, int(LARGEST_GROUP * len(heights))), len(heights) // 5)
    found = far & (beyond | _cut_off(heights, level, beyond, largest, around))
    # past an end that is wrong, only the signed distance from the sides counts
    off_surface = np.where(wrong, np.abs(heights), distances)
    if matched:
        found |= ~edge & (off_surface > least)
    return found if np.mean(found) < LARGEST_OUTLIER_SHARE else np.zeros_like(found)


def _short_of_ends(past: NDArray[np.bool_], level: NDArray[np.bool_], footpoints: Footpoints) -> NDArray[np.bool_]:
    """Whether points (n,) are at an end that is wrong: many are past it, or most of these `level` with the sides."""
    wrong = np.zeros(len(past), dtype=bool)
    for at_end in (footpoints.v < END_BAND, footpoints.v > 1.0 - END_BAND):
        past_end, onwards = int(np.count_nonzero(past & at_end)), int(np.count_nonzero(past & level & at_end))
        if past_end > WRONG_END_SHARE * np.count_nonzero(at_end) or onwards > max(PAST_END_BY_CHANCE, past_end // 2):
            wrong |= at_end
    return wrong


def _cut_off(
    heights: Reals, level: Reals, beyond: NDArray[np.bool_], largest: int, around: Neighbourhood
) -> NDArray[np.bool_]:
    """Whether points (n,) are in a group of at most `largest` that no step within the noise leads to."""

    def steps(start: NDArray[np.intp], end: NDArray[np.intp]) -> NDArray[np.bool_]:
        allowed = NEIGHBOUR_STEP * np.maximum(level[start], level[end]) + EXACT * around.extent
        return (np.abs(heights[end] - heights[start]) <= allowed) & ~beyond[start] & ~beyond[end]

    index = around.index
    own = np.broadcast_to(np.arange(len(heights))[:, None], index.shape)
    linked = steps(own, index)
    label = groups(linked, index)
    size = np.bincount(label)[label]
    core = np.flatnonzero(size > largest if np.any(size > largest) else size == size.max())
    separate = np.setdiff1d(np.arange(len(heights)), core)
    if len(separate) == 0:
        return np.zeros(len(heights), dtype=bool)
    _, near = cKDTree(around.places[core]).query(around.places[separate], k=min(CORE_NEIGHBOURS, len(core)))
    near = core[near.reshape(len(separate), -1)]
    reached = np.any(steps(np.broadcast_to(separate[:, None], near.shape), near), axis=1)
    return ~np.isin(label, label[np.concatenate([core, separate[reached]])])


def crowded_at_edges(outliers: NDArray[np.bool_], footpoints: Footpoints) -> dict[str, NDArray[np.bool_]]:
    """Which of n points are outliers at an edge, by its name, where more are than chance puts there.

    Outliers lie anywhere, to either side of a true surface; those of an edge that is not found lie at it. By chance,
    inside as many are at an edge as points are; outside, an edge is nearest to what came from as far around it as it is
    off (as many at most: Hoeffding 1956). Reference: Conover 1999, section 3.1 (binomial test).
    """
    found, off, inside = {}, int(np.count_nonzero(outliers)), outliers & (footpoints.heights < 0.0)
    for name, end in EDGE_PARAMETERS.items():
        at_edge = np.abs(footpoints.u - end) < BETWEEN_EDGES
        if not np.any(outliers & at_edge) or np.all(outliers):
            continue
        reach = np.sort(cKDTree(footpoints.points[at_edge]).query(footpoints.points[~outliers])[0])
        around = np.searchsorted(reach, footpoints.distances[outliers], side="right") / len(reach)
        shares = (inside & at_edge, 0.5 * float(np.mean(at_edge))), (outliers & at_edge, float(np.mean(around)))
        for crowded, share in shares:
            count = int(np.count_nonzero(crowded))
            if count and bdtrc(count - 1, off, share) < SIGNIFICANCE:
                found[name] = crowded
    return found


def doubted_outliers(
    outliers: NDArray[np.bool_], points: Reals, footpoints: Footpoints, *, systematic: bool
) -> NDArray[np.bool_]:
    """Which outliers of points (n, d) may be the blade's: they crowd at edges, or in a `systematic` misfit anywhere."""
    doubted = np.any([np.zeros_like(outliers), *crowded_at_edges(outliers, footpoints).values()], axis=0)
    if systematic:
        doubted |= outliers & (np.sum(outliers[neighbourhood_of(points, footpoints).index], axis=1) >= CROWD)
    return doubted


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
    points: Reals, footpoints: Footpoints, weights: Reals | None = None, *, trusted: NDArray[np.bool_] | None = None
) -> NoiseEstimate:
    """The noise estimate of points (n, d) about their footpoints; those `trusted` (n,) are no outliers.

    Weights (n,) are inverse variances relative to each other. A point of weight 0 tells nothing of the noise, and is an
    outlier where it lies further off than every inlier. Of many points some tell the noise, and others are inliers
    where they are level with one beside them.
    """
    trusted = np.zeros(len(points), dtype=bool) if trusted is None else trusted
    weights = np.ones(len(points)) if weights is None else weights
    weighed = np.flatnonzero(weights > 0.0)
    rows = weighed if len(weighed) < len(points) else random_subset(len(points), MOST_POINTS)
    rows = rows[without_copies(points[rows])]
    part = footpoints.part(rows)
    found = _shared_noise(points[rows], part, weights[rows] / np.mean(weights[rows]), trusted[rows])
    if len(rows) == len(points):
        return found
    kept = part.part(found.inliers)
    if len(weighed) < len(points):
        inliers = footpoints.distances <= np.max(kept.distances)
    else:
        beside = cKDTree(kept.points).query(footpoints.points)[1]
        level = found.noise * np.sqrt(1.0 + 1.0 / weights)
        near = EXACT * float(np.max(np.ptp(points, axis=0)))
        inliers = footpoints.distances - kept.distances[beside] <= OUTLYING_NOISE * level + near
    inliers[rows] = found.inliers
    return replace(found, inliers=inliers | trusted)


def _shared_noise(points: Reals, footpoints: Footpoints, weights: Reals, trusted: NDArray[np.bool_]) -> NoiseEstimate:
    """The noise estimate of points (n, d) of positive weights (n,), one on average, by what neighbours share."""
    heights, around = footpoints.heights, neighbourhood_of(points, footpoints)
    inliers = ~_outliers_of(footpoints, weights, around) | trusted
    index = around.index
    kept = inliers & inliers[index].all(axis=1)
    kept = kept if np.any(kept) else np.ones(len(points), dtype=bool)
    others, height, own_weight = weights[index[kept]], heights[kept], weights[kept]
    if points.shape[1] == 2:
        # two neighbours to each side of a curve cancel the slope of a misfit themselves
        total = np.sum(others, axis=1)
        expected, spread = np.sum(others * heights[index[kept]], axis=1) / total, 1.0 / total
    else:
        shares = _linear_shares(around.places[kept], around.places[index[kept]], footpoints.normals[kept])
        expected, spread = np.sum(shares * heights[index[kept]], axis=1), np.sum(shares**2 / others, axis=1)
    # scaled to the variance of the noise
    difference = (height - expected) / np.sqrt(1.0 / own_weight + spread)
    variance, own = float(np.mean(own_weight * height**2)), float(np.mean(difference**2))
    correlation = float(np.clip(1.0 - own / variance, 0.0, 1.0)) if variance > 0.0 else 0.0
    return NoiseEstimate(noise=median_deviation(difference), inliers=inliers, correlation=correlation)


FLAT = 1e-3
"""extent of neighbours across their row, of that along it, below which only the slope along it is told
(design/matching.md)"""


def _linear_shares(places: Reals, beside: Reals, normals: Reals) -> Reals:
    """Shares (n, k) of the heights of points (n, k, 4) in that of a plane through them at places (n, 4) [m].

    The normals (n, 3) are those of the surface. The difference from the plane leaves out the slope of a misfit, which
    neighbours to one side do not cancel. Reference: Gasser, Sroka and Jennen-Steinmetz 1986 (pseudo-residuals).
    """
    offsets = (beside - places[:, None])[..., : normals.shape[1]]
    offsets = offsets - np.sum(offsets * normals[:, None], axis=-1, keepdims=True) * normals[:, None]
    size = np.sqrt(np.mean(offsets**2, axis=(1, 2), keepdims=True))
    offsets = offsets / np.where(size > 0.0, size, 1.0)
    rows = np.concatenate([np.ones((*offsets.shape[:2], 1)), offsets], axis=-1)
    return np.asarray(np.linalg.pinv(rows, rcond=FLAT)[:, 0])
