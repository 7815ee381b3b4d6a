"""What a search from a first design does not reach by itself: sharp edges, edges elsewhere, another clustering.

A round edge of unknown radius and an end of the blade further in make up for each other, so that least squares alone
leave the tip of a wedge short by several radii. A nose slid along the outline is a minimum of its own. The clustering
of a blade's samples is no parameter, as no law is: what it could save is predicted from the derivatives of a match,
with all parameters refitted (variable projection: Golub and Pereyra 1973), and sought where that is much.
"""

from collections.abc import Iterator
from contextlib import suppress
from functools import partial

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.special import chdtri

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.errors import DesignError, FitError
from bladewright.fitting.assessment.acceptance import GROSS_DEVIATION, NEAR_EVERYWHERE
from bladewright.fitting.matching.footpoints import Side, nearest_footpoints
from bladewright.fitting.matching.residuals import PlacedCloud
from bladewright.fitting.matching.search import QUICK_ROUNDS, ROUGH_REDUCTION, Match, Task, searched
from bladewright.fitting.model_selection.structure import with_feasible_edges
from bladewright.section.unified_limits import ANGLES, RADII, TANGENTS

SHARP_RADIUS = 5e-6
"""radius of a sharp edge [axial chords]: a wedge of 15 deg ends 3.3e-5 before its tip (design/matching_constants.md)"""
SHARPER_BY_CHANCE = 0.05
"""probability that a round edge leaves so much less than a sharp one by chance, where it is sharp (Wilks 1938)."""
SHARP_NOTE = (
    "the points tell the {} from no sharp one, and the edges of this family are round: the radius is held "
    f"at {SHARP_RADIUS:g} (--family profile has sharp edges)"
)
EDGES = {
    "leading edge": ("leading_edge_radius", slice(None, 3)),
    "trailing edge": ("trailing_edge_radius", slice(-1, -4, -1)),
}
"""the radius of each edge, and the control points of a side from there"""


def with_sharp_edges(task: Task, match: Match) -> tuple[Task, Match, str]:
    """The match of a section with the radii of such edges held, its task, and a note of them."""
    sharp, again = list[str](), partial(searched, rounds=QUICK_ROUNDS + 1, min_reduction=ROUGH_REDUCTION)
    for name, (radius, ends) in EDGES.items() if task.dimension == 2 else ():
        if radius not in match.problem.paths or not all(_pointed(side, ends) for side in match.state.shape.sides):
            continue
        held = task.without((radius,))
        try:
            match = again(task, match.design, noise=match.rms)
            found = again(held, match.design.changed({radius: SHARP_RADIUS}), noise=match.rms)
            found.design.build()
        except (DesignError, FitError):
            continue
        before, after = (np.sum(each.state.footpoints.distances[match.rows] ** 2) for each in (match, found))
        count = np.count_nonzero(match.rows) * match.noise_estimate.independent_share(len(match.problem.paths))
        if count * np.log(after / before) < chdtri(1, SHARPER_BY_CHANCE):
            task, match, sharp = held, found, [*sharp, name]
    return task, match, SHARP_NOTE.format(" and the ".join(sharp)) if sharp else ""


def _pointed(side: Side, ends: slice) -> bool:
    """Whether the third control point of a side lies further from its edge than from its camber line."""
    edge, second, third = side.control_points[ends]
    across = (second - edge) / np.sqrt(np.sum((second - edge) ** 2))
    rise = float((third - edge) @ across)
    return 2.0 * rise**2 < float(np.sum((third - edge) ** 2))


USUAL_TANGENT, USUAL_RADIUS = 0.3, 0.01
"""tangent proportions and edge radii of further starts (design/matching_constants.md)"""


def from_other_edges(task: Task, match: Match, noise: float) -> Iterator[Match]:
    """Matches from designs whose edges lie elsewhere; `noise` is the first round's, of the chord."""
    known, names = match.design.parameters(), {path: path.partition("[")[0] for path in match.problem.paths}
    usual = {**dict.fromkeys(TANGENTS, USUAL_TANGENT), **dict.fromkeys(RADII, USUAL_RADIUS)}
    # of sections the camber line is made straight as well
    straight = [usual | dict.fromkeys(ANGLES, known["stagger"])] if "stagger" in known else []
    for values in (usual, *straight):
        changes = {path: values[name] for path, name in names.items() if name in values}
        with suppress(DesignError, FitError):
            if changes:
                start = with_feasible_edges(match.design.changed(changes))
                yield searched(task, start, noise=noise, min_reduction=ROUGH_REDUCTION)


def nearest_from_other_edges(task: Task, match: Match, noise: float) -> Match:
    """The nearest of a match and those from other edges; one as near as is trusted is not searched again."""
    if np.max(match.state.footpoints.distances) <= GROSS_DEVIATION[1] * match.model.chord:
        return match
    # all points count, as those of an edge that is not found are left out (design/matching.md)
    return min((match, *from_other_edges(task, match, noise)), key=lambda each: each.mean_distance)


WORTH_SEEKING = 0.9
"""predicted ratio of misfits below which another clustering is sought (design/matching_constants.md)"""
CLUSTERING_STEP, CLUSTERING_TOLERANCE = 1e-3, 0.03
"""step of the finite difference, and how closely the clustering is sought (design/matching_constants.md)"""


def nearest_by_clustering(task: Task, match: Match) -> Match:
    """The match with the clustering that leaves the least misfit, where another one is predicted to leave much less."""
    design, near = match.design, match.maximum <= NEAR_EVERYWHERE * match.model.chord
    if near or not isinstance(design, UnifiedBlade) or _predicted_ratio(match, design) > WORTH_SEEKING:
        return match
    best = match

    def misfit(clustering: float) -> float:
        nonlocal best
        try:
            start = with_feasible_edges(best.design.changed({"clustering": float(clustering)}))
            found = searched(task, start, noise=best.rms, rounds=QUICK_ROUNDS + 1, min_reduction=ROUGH_REDUCTION)
        except (DesignError, FitError):
            return 1.0
        best = min(best, found, key=lambda each: each.misfit)
        return found.misfit

    minimize_scalar(misfit, bounds=(0.0, 1.0), method="bounded", options={"xatol": CLUSTERING_TOLERANCE})
    return best


def _predicted_ratio(match: Match, design: UnifiedBlade) -> float:
    """Ratio [-] of the misfit that the nearest clustering is predicted to leave, to a match's own.

    Residuals r (m,) and their rates c (m,) by the clustering, without what the parameters make up for, give the step
    -c.r / c.c (Golub and Pereyra 1973).
    """
    problem, z = match.problem, match.problem.vector(design)
    values, slopes = problem.values(z), problem.derivatives(z)
    step = CLUSTERING_STEP if design.clustering < 0.5 else -CLUSTERING_STEP
    try:
        shape = match.model.shape(design.changed({"clustering": design.clustering + step}))
    except DesignError:
        return 1.0
    if values is None or slopes is None or not shape.finite:
        return 1.0
    cloud = problem.cloud_residuals
    moved = PlacedCloud(shape=shape, footpoints=nearest_footpoints(cloud.points, shape.sides, match.state.footpoints))
    own = cloud.residuals(match.state)
    rates = np.zeros(len(values[0]))
    rates[: len(own)] = (cloud.residuals(moved) - own) / step
    basis, _ = np.linalg.qr(slopes[0])  # real: of real residuals
    rows, rates = (each - basis @ (basis.T @ each) for each in (values[0], rates))
    if not np.any(rates):
        return 1.0
    change = np.clip(-(rates @ rows) / (rates @ rates), -design.clustering, 1.0 - design.clustering)
    return float(np.sqrt(np.sum((rows + change * rates) ** 2) / np.sum(rows**2)))
