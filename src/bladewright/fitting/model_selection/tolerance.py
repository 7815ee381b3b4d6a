"""A match within a tolerance: at every point, with as few control points and as smooth as it allows."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bladewright.blade.native.extrema import extrema_of
from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.matching.search import ROUGH_REDUCTION, Match, Task, searched
from bladewright.fitting.model_selection.forecast import Forecast, Prediction, forecast_of
from bladewright.fitting.model_selection.growth import grown_match
from bladewright.fitting.model_selection.reshaping import reshaped
from bladewright.fitting.model_selection.steps import StructureStep, intersection_of, losses, row_factors, steps_down
from bladewright.fitting.model_selection.stopping import MatchTarget
from bladewright.fitting.model_selection.structure import Structure, structure_of
from bladewright.numerics.least_squares import MIN_REDUCTION
from bladewright.nurbs.basis import Reals

TRUSTED_DEVIATION = 0.95
"""largest predicted deviation, of the tolerance, up to which a structure is tried."""
REMOVED_AT_ONCE = 0.04
"""share of the parameters that is removed between two evaluations of the forecast."""
CHEAP_LOSS = 3.0
"""predicted loss for each parameter, of the least, up to which a law loses a control point together with it."""
WEIGHTED_DEVIATION = 0.8
"""deviation, of the tolerance, from which a point's weight rises."""
WEIGHT_CHANGE, WEIGHT_RANGE = (0.7, 1.5), (0.1, 30.0)
"""range by which the weight of a point changes at a time, and in all (`WEIGHT_RANGE`)."""
MOST_FAILURES = 3
"""structures that are tried and miss the tolerance, each half as far away as the last."""
FIRST_SHARE = 0.25
"""share of the structures predicted to keep a tolerance by which the first one tried is away. Trying all, or half of
them, ended 0.4 to 0.6 mm off on Rotor 67 (design/matches.md)."""
HOPELESS_DEVIATION = 1.4
"""largest deviation, of the tolerance, that other weights do not correct."""
REWEIGHTINGS, REWEIGHTING_GAIN = 6, 0.75
"""searches of one structure with other weights, and the share of the excess over the tolerance that each may leave
(`REWEIGHTING_GAIN`): three quarters, as three searches had given up 0.4 % above Rotor 67's tolerance
(design/matches.md)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _SmallerStructure:
    """A structure with fewer control points, and the weights with which it is predicted to keep a tolerance."""

    structure: Structure
    prediction: Prediction
    weights: Reals
    """(n,) of the points, relative to those before"""


def reduced_blade(task: Task, match: Match, tolerance: float) -> Match | None:
    """A match of fewer parameters within a tolerance; None where there are no forecasts."""
    failed, further = 0, FIRST_SHARE
    weights = np.ones(len(task.points))
    while failed < MOST_FAILURES and not match.interrupted:
        forecast = forecast_of(match, structure_of(match.design))
        if forecast is None:
            return None
        plans = _smaller_structures(forecast, match, tolerance)
        if not plans:
            break
        number = int(np.ceil(further * len(plans)))
        start = forecast.designed(plans[number - 1].structure, plans[number - 1].prediction)
        fresh = _match_of_prediction(task, match, start, weights * plans[number - 1].weights, tolerance)
        if fresh is None:
            failed, further = failed + 1, 0.5 * further
            continue
        match, further = fresh, min(1.0, 1.5 * further)
        weights = _weights_of_match(match, task)
    return match


def _weights_of_match(match: Match, task: Task) -> Reals:
    """The weights (n,) with which a match was found, relative to those of its task."""
    own = match.problem.cloud_residuals.roots**2 / np.where(task.weights > 0.0, task.weights, 1.0)
    return np.where(own > 0.0, own, 1.0)


def _match_of_prediction(task: Task, match: Match, start: Design, weights: Reals, tolerance: float) -> Match | None:
    """The match of a predicted design, where it keeps the tolerance."""
    evaluations, most = match.evaluations, HOPELESS_DEVIATION * tolerance
    for _ in range(REWEIGHTINGS):
        weights = weights * len(weights) / np.sum(weights)
        try:
            fresh = searched(
                replace(task, weights=task.weights * weights),
                start,
                rounds=1,
                noise=match.rms,
                min_reduction=ROUGH_REDUCTION,
            )
        except FitError:
            return None
        evaluations += fresh.evaluations
        if fresh.maximum <= tolerance or fresh.interrupted:
            return replace(fresh, evaluations=evaluations)
        if fresh.maximum > most:
            return None
        most = tolerance + REWEIGHTING_GAIN * (fresh.maximum - tolerance)
        start, weights = fresh.design, weights * _weight_factors(fresh.state.footpoints.distances, tolerance)
    return None


def _weight_factors(distances: Reals, tolerance: float) -> Reals:
    """Factors by which the weights (n,) of points change with their distances [m]."""
    return np.clip(distances / (WEIGHTED_DEVIATION * tolerance), *WEIGHT_CHANGE)


def _smaller_structures(forecast: Forecast, match: Match, tolerance: float) -> list[_SmallerStructure]:
    """Structures of fewer and fewer parameters that are predicted to keep a tolerance."""
    count, roots = forecast.points, match.problem.cloud_residuals.roots
    inside = roots > 0.0
    structure, weights = structure_of(match.design), np.ones(count)
    names = set(forecast.names())
    plans: list[_SmallerStructure] = []
    tried = forecast.prediction(structure)
    while True:
        roots_now = row_factors(weights, len(forecast.rows))
        base = forecast.prediction(structure, roots_now).cost
        steps = [step for step in steps_down(structure) if step.law in names]
        if not steps:
            return plans
        costs = forecast.costs(structure, [(step.law, step.structure) for step in steps], roots_now)
        order = np.argsort([(cost - base) / step.parameters for cost, step in zip(costs, steps, strict=True)])
        ranked = [((costs[i] - base) / steps[i].parameters, steps[i]) for i in order]
        structure = intersection_of(_cheapest(ranked, REMOVED_AT_ONCE * tried.parameters))
        for attempt in range(2):
            tried = forecast.prediction(structure, row_factors(weights, len(forecast.rows)))
            heights = np.zeros(count)
            heights[inside] = np.abs(tried.rows[:count][inside] / roots[inside]) * match.model.chord
            kept = float(np.max(heights)) <= TRUSTED_DEVIATION * tolerance
            if kept or attempt:
                break
            weights = np.clip(weights * _weight_factors(heights, tolerance), *WEIGHT_RANGE)
        if not kept:
            return plans
        plans.append(_SmallerStructure(structure=structure, prediction=tried, weights=weights))


def _cheapest(ranked: list[tuple[float, StructureStep]], most: float) -> list[StructureStep]:
    """The steps down that go together: those that cost little more than the first, up to so many parameters."""
    taken = [ranked[0][1]]
    bound = CHEAP_LOSS * max(ranked[0][0], 0.0)
    for loss, step in ranked[1:]:
        added = sum(each.parameters for each in taken)
        if loss > bound or added + step.parameters > most:
            break
        if step.law not in {each.law for each in taken}:
            taken.append(step)
    return taken


LATER_GROWTHS = 4
"""times that control points are added where points outside the quick searches stay beyond the tolerance."""
WEIGHTED_SEARCHES = 4
"""searches with points weighted by their distances before anything is added"""
SEARCH_ROUNDS = 2
"""rounds of each of these searches"""
LAWS_AT_ONCE = {2: (4, 1), 3: (8, 4)}
"""laws that lose a control point together, by dimension, those predicted to cost least first: half as many where that
is too much, down to the second number. Searches of blades are dear."""
SMOOTHING = (3.0, 10.0, 30.0, 100.0, 1000.0)
"""factors of the regularisation that are tried in turn"""
PLAIN_EXTREMA = 4
"""extrema of a side's curvature that a plain section has"""


def match_within_tolerance(task: Task, match: Match, target: MatchTarget, tolerance: float) -> Match:
    """The match that keeps a tolerance, where growth brings it there, with as few parameters as keep it."""
    match = _within_everywhere(task, match, target, tolerance)
    return smoothed(task, reduced(task, match, tolerance), tolerance)


def _within_everywhere(task: Task, match: Match, target: MatchTarget, tolerance: float) -> Match:
    """A match that keeps a tolerance at the points of a thorough search too, where growth brings it there."""
    match = _within(task, match, tolerance)
    for _ in range(LATER_GROWTHS):
        if match.maximum <= tolerance or match.interrupted:
            break
        match, grew = grown_match(task, match, target)
        if not grew:
            break
        match = _within(task, match, tolerance)
    return match


def _within(task: Task, match: Match, tolerance: float) -> Match:
    """A match whose largest deviations are weighted more, where that brings them within the tolerance."""
    best, weights = match, task.weights
    for _ in range(WEIGHTED_SEARCHES):
        if best.maximum <= tolerance or best.interrupted:
            break
        distances = match.state.footpoints.distances
        weights = weights * np.clip((distances / tolerance) ** 2, 0.3, 4.0)
        weights = weights * (np.sum(task.weights) / np.sum(weights))
        rounds = SEARCH_ROUNDS if task.dimension == 2 else 1
        match = searched(
            replace(task, weights=weights), match.design, rounds=rounds, min_reduction=_min_reduction(task)
        )
        best = match if match.maximum < best.maximum else best
    return best


def reduced(task: Task, match: Match, tolerance: float) -> Match:
    """A match within a tolerance without the control points that it does not need."""
    if task.dimension == 3 and match.maximum <= tolerance:
        fewer_still = reduced_blade(task, match, tolerance)
        if fewer_still is not None:
            return fewer_still
    most, least_at_once = LAWS_AT_ONCE[task.dimension]
    at_once = most
    while at_once >= least_at_once and match.maximum <= tolerance and not match.interrupted:
        steps = [step for _, step in losses(match)[:at_once]]
        fewer = _without(task, match, steps) if steps else None
        if fewer is not None and fewer.maximum <= tolerance and not fewer.interrupted:
            match = fewer
        else:
            at_once = min(at_once, len(steps)) // 2
    return match


def _without(task: Task, match: Match, steps: Sequence[StructureStep]) -> Match | None:
    try:
        fresh = searched(
            task,
            reshaped(match.design, intersection_of(steps)),
            rounds=SEARCH_ROUNDS,
            noise=match.rms,
            min_reduction=_min_reduction(task),
        )
    except FitError:
        return None
    return replace(fresh, evaluations=fresh.evaluations + match.evaluations)


def _min_reduction(task: Task) -> float:
    """The relative reduction that a step must predict: searches of blades are dear."""
    return MIN_REDUCTION if task.dimension == 2 else ROUGH_REDUCTION


def smoothed(task: Task, match: Match, tolerance: float) -> Match:
    """A match within a tolerance whose sides' curvature has fewer extrema, where a smoother one has."""
    waves = _curvature_extrema(match)
    for strength in SMOOTHING:
        if waves is None or waves <= PLAIN_EXTREMA or match.interrupted or match.maximum > tolerance:
            break
        fresh = searched(
            replace(task, regularisation_factor=strength * task.regularisation_factor), match.design, rounds=1
        )
        fewer = _curvature_extrema(fresh)
        if fresh.maximum > tolerance or fewer is None or fewer > waves:
            break
        match, waves = replace(fresh, evaluations=fresh.evaluations + match.evaluations), fewer
    return match


def _curvature_extrema(match: Match) -> int | None:
    """Extrema of the curvature of the side that has most; None where the design cannot be built."""
    try:
        return max(extrema_of(match.design.build()).values())
    except DesignError:
        return None
