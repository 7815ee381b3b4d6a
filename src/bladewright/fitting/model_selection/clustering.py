"""The clustering of a blade's samples along the chord, where no law makes up for it.

It is no parameter of a search, as no law is: what it could save is predicted from the derivatives of a match, with all
parameters refitted (variable projection: Golub and Pereyra 1973), and sought where that is much.
"""

import numpy as np
from scipy.optimize import minimize_scalar

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.errors import DesignError, FitError
from bladewright.fitting.assessment.acceptance import NEAR_EVERYWHERE
from bladewright.fitting.matching.footpoints import nearest_footpoints
from bladewright.fitting.matching.residuals import PlacedCloud
from bladewright.fitting.matching.search import QUICK_ROUNDS, ROUGH_REDUCTION, Match, Task, searched
from bladewright.fitting.model_selection.reshaping import with_feasible_edges

WORTH_SEEKING = 0.9
"""ratio of the misfit that another clustering is predicted to leave, to a match's own, below which it is sought: of
first matches whose clustering is the cloud's own 0.91 to 1, of four of eight others 0.77 to 0.87
(design/matching.md)."""
CLUSTERING_STEP, CLUSTERING_TOLERANCE = 1e-3, 0.03
"""step of the finite difference, whose error is far below that of the prediction, and how closely the clustering is
sought: by 0.01 a blade ends at the same match (design/matching.md)"""


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
            rounds = QUICK_ROUNDS + 1
            found = searched(task, start, noise=best.rms, rounds=rounds, min_reduction=ROUGH_REDUCTION)
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
