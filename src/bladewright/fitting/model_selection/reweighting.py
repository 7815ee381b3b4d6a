"""Searches of one structure whose points weigh by their distances, so that the largest becomes small (Lawson 1961)."""

from dataclasses import replace

import numpy as np

from bladewright.errors import DesignError, FitError
from bladewright.fitting.matching.search import ROUGH_REDUCTION, Match, Task, searched
from bladewright.nurbs.basis import Reals

WEIGHTED_DEVIATION = 0.8
"""deviation, of the tolerance, from which a point's weight rises (design/matching_constants.md)."""
WEIGHT_CHANGE, WEIGHT_RANGE = (0.5, 2.0), (0.02, 50.0)
"""range by which the weight of a point changes at a time, and in all (`WEIGHT_RANGE`)
(design/matching_constants.md)."""
REWEIGHTINGS = 6
"""searches of one structure with other weights at most (design/matching_constants.md)"""
TOUCHED = 0.05
"""excess over the tolerance, of it, that the last of these is foreseen to have where they go on: each reduces it by the
same ratio as the one before. Half and twice change nothing measured (design/matching_constants.md)."""


def reweighted(weights: Reals, distances: Reals, tolerance: float) -> Reals:
    """Weights (n,) of points that rise with their distances (Lawson 1961); points that do not take part have none."""
    factors = np.clip(distances / (WEIGHTED_DEVIATION * tolerance), *WEIGHT_CHANGE)
    found = np.where(weights > 0.0, np.clip(weights * factors, *WEIGHT_RANGE), 0.0)
    return np.asarray(found * (np.sum(weights) / np.sum(found)))


def nearest_to_tolerance(task: Task, start: Match, weights: Reals, rich: Match, tolerance: float) -> Match:
    """The match nearest to a tolerance [m] of searches of one structure, whose weights (n,) rise with the distances."""
    best, design, noise, before = start, start.design, start.rms, np.inf
    weights = np.where(weights > 0.0, weights, task.weights)
    for left in reversed(range(REWEIGHTINGS)):
        if best is not start and largest_of(best, rich) <= tolerance:
            break
        weighted = replace(task, weights=weights * (np.sum(task.weights) / np.sum(weights)))
        try:
            found = searched(weighted, design, noise=noise, rounds=1, min_reduction=ROUGH_REDUCTION)
        except (FitError, DesignError):
            break
        excess = largest_of(found, rich) - tolerance
        best = found if best is start or tolerance + excess < largest_of(best, rich) else best
        if (excess / before) ** left * excess > TOUCHED * tolerance:
            break
        design, noise, before = found.design, found.rms, excess
        weights = reweighted(weights, found.state.footpoints.distances, tolerance)
    return best


def largest_of(match: Match, rich: Match) -> float:
    """The largest distance [m] of the points that took part in a rich match: ends that drew back leave none out."""
    return float(np.max(match.state.footpoints.distances[rich.rows]))


def confirmed_match(task: Task, match: Match, tolerance: float) -> Match:
    """A match of some of the points that keeps a tolerance at more of them, by their weights."""
    found = match
    for _ in range(REWEIGHTINGS):
        found = searched(task, found.design, noise=match.rms, rounds=0)
        if found.maximum <= tolerance:
            break
        weights = reweighted(task.weights, found.state.footpoints.distances, tolerance)
        task = replace(task, weights=weights * (np.sum(task.weights) / np.sum(weights)))
        found = searched(task, found.design, noise=match.rms, rounds=1, min_reduction=ROUGH_REDUCTION)
    return found
