"""Which points of a cloud lie off the surface that the others show.

Along a surface the heights of points change steadily, by noise and by what a design misses: outliers are small groups,
of one point or of many, that no step within the noise leads to. Where the rest is matched well, distances alone tell.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from bladewright.fitting.clouds.thinning import spread
from bladewright.fitting.matching.footpoints import Footpoints
from bladewright.nurbs.basis import Reals

NEIGHBOURS = {2: 4, 3: 8}
"""neighbours asked, by dimension"""
OUTLYING_NOISE = 8.0
"""deviations of the noise that an outlier exceeds"""
NEIGHBOUR_STEP = 5.0
"""deviations of the noise by which neighbours on one surface differ at most"""
OUTLYING_MISFIT, OUTLYING_MISFIT_AT_EDGES = 6.0, 60.0
"""usual misfits that an outlier exceeds, and near an edge, where a misfit is large and neighbours are few"""
STEEPEST_MISFIT = 40.0
"""usual misfits by which the misfit may change along the extent"""
STEEPER_THAN_AROUND = 4.0
"""by how much steeper than around a point the misfit may become"""
EDGE_BAND = 0.03
"""how near, in u"""
SIDES_APART = 0.05
"""how far apart the two sides of a thin blade are taken to be, of the extent"""
STEADY_MISFIT = 100.0
"""usual misfits from which a small group away from the edges is no misfit, though heights rise to it steadily"""
CHANCE_EXCESS = 3.0
"""by how much more than the noise distances may usually be by chance, of the root of the number of points"""
LARGEST_GROUP, SMALL_GROUP = 0.05, 20
"""largest group of outliers, of the points, and however few there are"""
END_BAND, WRONG_END_SHARE = 0.02, 0.2
"""how near an end of the blade points are, in v, and the part of them which past it shows that the end is wrong"""
PAST_END_BY_CHANCE = 1
"""points past an end, level with the sides, that may be there by chance"""
LEVEL_SLOPE = 0.05
"""height, of the way past an end, up to which a point is level with the sides, which may bend there"""
SPIKE_SLOPE, SPIKE_NEIGHBOURS = 2.0, 0.1
"""slope to all neighbours that no surface has, and their height, of the point's own, from which they are on it"""
LARGEST_OUTLIER_SHARE = 0.15
"""part of the points from which it is the design that lies off, and not they"""
LOCAL_POINTS, LOCAL_SITES = 64, 5000
"""points around each of so many sites whose noise is taken to be alike"""
DEVIATION_OVER_QUARTILE = 3.1384
"""standard deviation of normal noise over the lower quartile of its magnitude, which a group of outliers spoils less"""
CORE_NEIGHBOURS = 3
"""points of the large groups beside a small one to which a step may lead"""
ALWAYS_INLIER = 1e-6
"""distance up to which no point is an outlier, of the cloud's extent"""
DEVIATION_OVER_MEDIAN = 1.4826
"""standard deviation of normal noise over its median magnitude"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Neighbourhood:
    """Which of n points are beside each other on the sides of a design."""

    places: Reals
    """(n, d + 1) the feet, and how far from both edges, so that the sides are apart but at the edges"""
    index: NDArray[np.intp]
    """(n, k) the nearest others; a point itself where there are no others"""
    extent: float
    """[m]"""


def neighbourhood_of(points: Reals, on: Footpoints) -> Neighbourhood:
    """The neighbours of points (n, d) with known feet."""
    extent = float(np.ptp(points, axis=0).max())
    inward = np.minimum(np.minimum(on.u, 1.0 - on.u) / EDGE_BAND, 1.0)
    lifted = np.where(on.side == 0, 1.0, -1.0) * SIDES_APART * extent * inward
    places = np.column_stack([on.points, lifted])
    count = NEIGHBOURS[points.shape[1]]
    asked = min(count + 1, len(points))
    index = np.reshape(cKDTree(places).query(places, k=asked)[1], (len(points), asked))
    # among points in one place a point is not always the first that is found
    own = index == np.arange(len(points))[:, None]
    index = np.where(own, index[:, :1], index)[:, 1:]
    return Neighbourhood(
        places=places, index=np.pad(index, ((0, 0), (0, count - asked + 1)), mode="edge"), extent=extent
    )


def outliers_of(
    heights: Reals, past: Reals, distances: Reals, weights: Reals, on: Footpoints, around: Neighbourhood
) -> NDArray[np.bool_]:
    """Which of n points are outliers, by their heights above the surface, their way past its ends and distances [m].

    Weights are positive, and inverse variances relative to each other.
    """
    index, roots = around.index, np.sqrt(weights)
    # a median of k neighbours has about 1 / k of the variance
    spread_out = np.sqrt(1.0 / weights + np.mean(1.0 / weights[index], axis=1) / index.shape[1])
    off = np.abs(heights - np.median(heights[index], axis=1)) / spread_out * np.sqrt(1.0 + 1.0 / index.shape[1])
    noise = DEVIATION_OVER_MEDIAN * float(np.median(off))
    usual = DEVIATION_OVER_MEDIAN * float(np.median(roots * distances))
    chance = 1.0 + CHANCE_EXCESS / np.sqrt(len(heights))
    misfit = float(np.sqrt(max(usual**2 - (chance * noise) ** 2, 0.0)))
    level = np.maximum(noise, _local_noise(off, around)) / roots
    edge = (on.u < EDGE_BAND) | (on.u > 1.0 - EDGE_BAND)
    near = ALWAYS_INLIER * around.extent
    least = np.hypot(OUTLYING_NOISE * level, np.where(edge, OUTLYING_MISFIT_AT_EDGES, OUTLYING_MISFIT) * misfit) + near
    spikes = _spikes(heights, OUTLYING_NOISE * level + near, around)
    far = (distances > least) | spikes
    if not np.any(far):
        return far
    wrong = _short_of_ends(far & (past > least), np.abs(heights) <= np.maximum(least, LEVEL_SLOPE * past), on)
    beyond = (past > least) & ~wrong
    largest = min(max(SMALL_GROUP, int(LARGEST_GROUP * len(heights))), len(heights) // 5)
    # what differs by more than the noise is no noise
    noisy = misfit == 0.0 and noise > near
    slopes = np.zeros(len(heights)) if noisy else _slopes(heights, level, misfit, around)
    found = spikes | (far & (beyond | _cut_off(heights, level, beyond, slopes, largest, around)))
    # what is past an end that is wrong lies off the surface by its height alone
    off_surface = np.where(wrong, np.abs(heights), distances)
    steady = ~found & (off_surface > np.hypot(OUTLYING_NOISE * level, STEADY_MISFIT * misfit) + near)
    label = _groups(steady, steady, index)
    # around an edge a few points are all that tells of a radius: it may be wrong alone
    found |= steady & (_sizes(label) <= largest) & ~np.isin(label, label[edge & steady])
    return found if np.mean(found) < LARGEST_OUTLIER_SHARE else np.zeros_like(found)


def _spikes(heights: Reals, least: Reals, around: Neighbourhood) -> NDArray[np.bool_]:
    """Whether points (n,) stand higher off their neighbours, which are on the surface, than these are away.

    No wrong radius of an edge does that.
    """
    index, footpoints = around.index, around.places[:, :-1]
    way = np.sqrt(np.sum((footpoints[index] - footpoints[:, None]) ** 2, axis=-1))
    step = np.abs(heights[index] - heights[:, None])
    steep = (step > SPIKE_SLOPE * way) & (step > np.maximum(least[:, None], least[index]))
    level = np.median(np.abs(heights[index]), axis=1) < SPIKE_NEIGHBOURS * np.abs(heights)
    return np.asarray(np.all(steep, axis=1) & level)


def _short_of_ends(past: NDArray[np.bool_], level: NDArray[np.bool_], on: Footpoints) -> NDArray[np.bool_]:
    """Whether points (n,) are at an end of the blade that so many are past that it is the end which is wrong.

    So it is, too, where most of those past it are `level` with the sides that go on there.
    """
    wrong = np.zeros(len(past), dtype=bool)
    for beside in (on.v < END_BAND, on.v > 1.0 - END_BAND):
        there, onwards = int(np.count_nonzero(past & beside)), int(np.count_nonzero(past & level & beside))
        if there > WRONG_END_SHARE * np.count_nonzero(beside) or onwards > max(PAST_END_BY_CHANCE, there // 2):
            wrong |= beside
    return wrong


def _local_noise(off: Reals, around: Neighbourhood) -> Reals:
    """The noise (n,) around each point."""
    sites = spread(around.places, LOCAL_SITES)
    _, near = cKDTree(around.places).query(around.places[sites], k=min(LOCAL_POINTS, len(off)))
    noise = DEVIATION_OVER_QUARTILE * np.quantile(off[near.reshape(len(sites), -1)], 0.25, axis=1)
    return np.asarray(noise[cKDTree(around.places[sites]).query(around.places)[1]])


def _slopes(heights: Reals, level: Reals, misfit: float, around: Neighbourhood) -> Reals:
    """How much heights may change along the surface (n,) by a misfit that varies steadily."""
    index = around.index
    way = np.sqrt(np.sum((around.places[index] - around.places[:, None]) ** 2, axis=-1)) + ALWAYS_INLIER * around.extent
    change = np.maximum(np.abs(heights[index] - heights[:, None]) - NEIGHBOUR_STEP * level[:, None], 0.0) / way
    return STEEPER_THAN_AROUND * _lower(_lower(change)[index]) + STEEPEST_MISFIT * misfit / around.extent


def _lower(values: Reals) -> Reals:
    """The lower median (n,) of values (n, k)."""
    middle = (values.shape[1] - 1) // 2
    return np.asarray(np.partition(values, middle, axis=1)[:, middle])


def _cut_off(
    heights: Reals, level: Reals, beyond: NDArray[np.bool_], slopes: Reals, largest: int, around: Neighbourhood
) -> NDArray[np.bool_]:
    """Whether points (n,) are in a group of at most `largest` that no step leads to."""

    def steps(start: NDArray[np.intp], end: NDArray[np.intp]) -> NDArray[np.bool_]:
        way = np.sqrt(np.sum((around.places[end] - around.places[start]) ** 2, axis=-1))
        allowed = NEIGHBOUR_STEP * np.maximum(level[start], level[end]) + ALWAYS_INLIER * around.extent
        allowed += np.minimum(slopes[start], slopes[end]) * way
        return (np.abs(heights[end] - heights[start]) <= allowed) & ~beyond[start] & ~beyond[end]

    index = around.index
    own = np.broadcast_to(np.arange(len(heights))[:, None], index.shape)
    linked = steps(own, index)
    label = _groups(np.ones(len(heights), dtype=bool), linked, index)
    size = _sizes(label)
    core = np.flatnonzero(size > largest if np.any(size > largest) else size == size.max())
    apart = np.flatnonzero(~np.isin(np.arange(len(heights)), core))
    if len(apart) == 0:
        return np.zeros(len(heights), dtype=bool)
    _, near = cKDTree(around.places[core]).query(around.places[apart], k=min(CORE_NEIGHBOURS, len(core)))
    near = core[near.reshape(len(apart), -1)]
    reached = np.any(steps(np.broadcast_to(apart[:, None], near.shape), near), axis=1)
    joined = np.zeros(len(heights), dtype=bool)
    joined[label[core]] = True
    joined[label[apart[reached]]] = True
    return ~joined[label]


def _groups(rows: NDArray[np.bool_], linked: NDArray[np.bool_], index: NDArray[np.intp]) -> NDArray[np.intp]:
    """Labels (n,) of the groups that neighbours (n, k) make with each other where they are `linked`.

    Only points in `rows` are in groups with others; `linked` is (n, k), or (n,) for all ways from a point.
    """
    count = len(index)
    taken = rows[:, None] & rows[index] & (linked if linked.ndim == 2 else linked[:, None])
    start, way = np.nonzero(taken)
    graph = csr_array((np.ones(len(start), dtype=np.int8), (start, index[start, way])), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.intp)


def _sizes(label: NDArray[np.intp]) -> NDArray[np.intp]:
    """Number of points (n,) in the group of each."""
    return np.bincount(label)[label]
