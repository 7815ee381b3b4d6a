"""The structure of so many parameters that is predicted to leave least: control points go, and are exchanged."""

from dataclasses import replace

import numpy as np

from bladewright.errors import FitError
from bladewright.fitting.matching.search import ROUGH_REDUCTION, Match, Task, searched
from bladewright.fitting.model_selection.forecast import Forecast, forecast_of
from bladewright.fitting.model_selection.steps import (
    StructureStep,
    intersection_of,
    steps_down,
    steps_taken_together,
    steps_up,
    union_of,
    widest_reach,
)
from bladewright.fitting.model_selection.structure import Structure, structure_of
from bladewright.nurbs.basis import Reals

SURPLUS_DIVISOR = 4
"""one in so many of the surplus parameters is removed at a time."""
EXCHANGES, EXCHANGES_TRIED = 6, 3
"""exchanges of control points at most, with `EXCHANGES_TRIED` laws tried each time."""
EXCHANGE_GAIN = 0.995
"""ratio of predicted costs from which an exchange is worthwhile."""
FEWEST_PARAMETERS, REDUCTION = 16, 0.85
"""parameters below which none are removed before a match; `REDUCTION` is the share of them that is left each time."""
STAGES = 4
"""searches, each with the structure that the forecast about the last one prefers."""


def best_match_of_size(task: Task, match: Match, most: int) -> Match | None:
    """The match with at most so many free parameters that forecasts lead to; None without forecasts."""
    best = match if len(match.problem.paths) <= most else None
    for stage in range(STAGES):
        now = structure_of(match.design)
        forecast = forecast_of(match, widest_reach(now))
        if forecast is None:
            return best if stage else None
        structure = best_structure(forecast, now, most - _parameters_outside(match, forecast))
        if structure == now and best is not None:
            break
        try:
            start = forecast.designed(structure, forecast.prediction(structure))
            fresh = searched(task, start, rounds=1, noise=match.rms, min_reduction=ROUGH_REDUCTION)
        except FitError:
            break
        fresh = replace(fresh, evaluations=fresh.evaluations + match.evaluations)
        if best is not None and not fresh.misfit < best.misfit:
            break
        best = match = fresh
        if match.interrupted:
            break
    return best


def smallest_match(task: Task, match: Match, rms: float) -> Match | None:
    """The match of fewest parameters predicted to leave a root mean square [m]; None without forecasts."""
    structure = structure_of(match.design)
    forecast = forecast_of(match, structure)
    if forecast is None:
        return None
    count = forecast.prediction(structure).parameters
    while count > FEWEST_PARAMETERS:
        structure = _reduced(forecast, structure, int(REDUCTION * count), None)
        predicted = forecast.prediction(structure)
        left = float(np.sqrt(np.mean(predicted.rows[: forecast.points] ** 2))) * match.model.chord
        if left > rms or predicted.parameters == count:
            break
        count = predicted.parameters
    return best_match_of_size(task, match, count + _parameters_outside(match, forecast))


def _parameters_outside(match: Match, forecast: Forecast) -> int:
    """Free parameters that do not depend on the structure."""
    return len(match.problem.paths) - forecast.prediction(structure_of(match.design)).parameters


def best_structure(forecast: Forecast, structure: Structure, most: int, roots: Reals | None = None) -> Structure:
    """The structure of at most so many parameters that a forecast prefers, reached from another one."""
    found = _extended(forecast, _reduced(forecast, structure, most, roots), most, roots)
    cost = forecast.prediction(found, roots).cost
    for _ in range(EXCHANGES):
        ups = ranked_steps(forecast, found, roots)[:EXCHANGES_TRIED]
        for _, step in ups:
            other = _extended(forecast, _reduced(forecast, step.structure, most, roots), most, roots)
            fresh = forecast.prediction(other, roots).cost
            if fresh < EXCHANGE_GAIN * cost:
                found, cost = other, fresh
                break
        else:
            break
    return found


def _reduced(forecast: Forecast, structure: Structure, most: int, roots: Reals | None) -> Structure:
    """A structure with at most so many parameters: what is predicted to cost least is removed first."""
    while True:
        now = forecast.prediction(structure, roots)
        over = now.parameters - most
        if over <= 0:
            return structure
        names = set(forecast.names())
        steps = [step for step in steps_down(structure) if step.law in names]
        if not steps:
            return structure
        costs = forecast.costs(structure, [(step.law, step.structure) for step in steps], roots)
        order = sorted(zip(costs, steps, strict=True), key=lambda pair: (pair[0] - now.cost) / pair[1].parameters)
        taken: list[StructureStep] = []
        left = max(1, over // SURPLUS_DIVISOR)
        for _, step in order:
            if not taken or (step.parameters <= left and step.law not in {each.law for each in taken}):
                taken.append(step)
                left -= step.parameters
            if left <= 0:
                break
        structure = intersection_of(taken)


def _extended(forecast: Forecast, structure: Structure, most: int, roots: Reals | None) -> Structure:
    """A structure with as many parameters as allowed: what is predicted to gain most is added first."""
    while True:
        spare = most - forecast.prediction(structure, roots).parameters
        fitting = [(gain, step) for gain, step in ranked_steps(forecast, structure, roots) if step.parameters <= spare]
        if not fitting or fitting[0][0] <= 0.0:
            return structure
        structure = union_of(
            structure, steps_taken_together(fitting, max(fitting[0][1].parameters, spare // SURPLUS_DIVISOR))
        )


def ranked_steps(
    forecast: Forecast, structure: Structure, roots: Reals | None = None
) -> list[tuple[float, StructureStep]]:
    """Steps that a forecast covers with the gain predicted for each, best for each parameter first."""
    names = set(forecast.names())
    steps = [step for step in steps_up(structure) if step.law in names and _is_within(step.structure, forecast.widest)]
    if not steps:
        return []
    now = forecast.prediction(structure, roots).cost
    costs = forecast.costs(structure, [(step.law, step.structure) for step in steps], roots)
    return sorted(
        ((now - cost, step) for cost, step in zip(costs, steps, strict=True)),
        key=lambda pair: -pair[0] / pair[1].parameters,
    )


def _is_within(structure: Structure, widest: Structure) -> bool:
    """Whether a structure is nowhere wider along the chord and the walls than the widest."""
    chord = all(own <= most for own, most in zip(structure.chordwise, widest.chordwise, strict=True))
    return chord and all(structure.channel[wall] <= widest.channel[wall] for wall in ("hub", "shroud"))
