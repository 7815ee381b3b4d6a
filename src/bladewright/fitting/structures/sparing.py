"""A match within a tolerance without the control points that it does not need, as forecasts tell of them."""

from dataclasses import dataclass, replace

import numpy as np

from bladewright.designs import Design
from bladewright.errors import FitError
from bladewright.fitting.matching.search import ROUGH, Found, Task, searched
from bladewright.fitting.structures.forecast import Forecast, Foreseen, forecast_of
from bladewright.fitting.structures.growth import Step, least, roots_of, steps_back
from bladewright.fitting.structures.structure import Structure, structure_of
from bladewright.nurbs.basis import Reals

TRUSTED = 0.95
"""largest deviation that is foreseen, of the tolerance, up to which a structure is tried"""
AT_ONCE = 0.04
"""part of the parameters that go between two looks at the forecast"""
CHEAP = 3.0
"""foreseen loss for each parameter, of the least, up to which a law loses one too"""
AIMED = 0.8
"""deviation, of the tolerance, from which a point is weighed more"""
SWAY, HEAVIEST = (0.7, 1.5), (0.1, 30.0)
"""by how much the weight of a point changes at a time, and all in all"""
FAILURES = 3
"""structures that are tried and do not keep the tolerance, each half as far away as the last"""
FIRST = 0.25
"""part of the structures that are foreseen to keep a tolerance which the first one tried is away: forecasts that go too
far lose their way where laws turn much"""
HOPELESS = 1.4
"""largest deviation, of the tolerance, that other weights do not mend"""
POLISHED, GAINING = 6, 0.75
"""searches of one structure, each with other weights, and what each leaves at most of the excess over the tolerance"""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Plan:
    """A structure with fewer control points, and the weights with which it is foreseen to keep a tolerance."""

    structure: Structure
    foreseen: Foreseen
    weights: Reals
    """(n,) of the points, of those before"""


def spared_blade(task: Task, found: Found, tolerance: float) -> Found | None:
    """A match of fewer parameters within a tolerance; None where there are no forecasts."""
    failed, further = 0, FIRST
    weights = np.ones(len(task.points))
    while failed < FAILURES and not found.interrupted:
        forecast = forecast_of(found, structure_of(found.design))
        if forecast is None:
            return None
        plans = _plans(forecast, found, tolerance)
        if not plans:
            break
        number = int(np.ceil(further * len(plans)))
        start = forecast.designed(plans[number - 1].structure, plans[number - 1].foreseen)
        fresh = _tried(task, found, start, weights * plans[number - 1].weights, tolerance)
        if fresh is None:
            failed, further = failed + 1, 0.5 * further
            continue
        found, further = fresh, min(1.0, 1.5 * further)
        weights = _relative(found, task)
    return found


def _relative(found: Found, task: Task) -> Reals:
    """The weights (n,) with which a match was found, of those of its task."""
    own = found.problem.measures.roots**2 / np.where(task.weights > 0.0, task.weights, 1.0)
    return np.where(own > 0.0, own, 1.0)


def _tried(task: Task, found: Found, start: Design, weights: Reals, tolerance: float) -> Found | None:
    """The match of a foreseen design, where it keeps the tolerance."""
    evaluations, most = found.evaluations, HOPELESS * tolerance
    for _ in range(POLISHED):
        weights = weights * len(weights) / np.sum(weights)
        try:
            fresh = searched(
                replace(task, weights=task.weights * weights), start, rounds=1, noise=found.rms, slight=ROUGH
            )
        except FitError:
            return None
        evaluations += fresh.evaluations
        if fresh.maximum <= tolerance or fresh.interrupted:
            return replace(fresh, evaluations=evaluations)
        if fresh.maximum > most:
            return None
        most = tolerance + GAINING * (fresh.maximum - tolerance)
        start, weights = fresh.design, weights * _swayed(fresh.state.feet.distances, tolerance)
    return None


def _swayed(distances: Reals, tolerance: float) -> Reals:
    """By how much the weights (n,) of points change with their distances [m]."""
    return np.clip(distances / (AIMED * tolerance), *SWAY)


def _plans(forecast: Forecast, found: Found, tolerance: float) -> list[_Plan]:
    """Structures of fewer and fewer parameters that are foreseen to keep a tolerance."""
    count, roots = forecast.points, found.problem.measures.roots
    inside = roots > 0.0
    structure, weights = structure_of(found.design), np.ones(count)
    names = set(forecast.names())
    plans: list[_Plan] = []
    tried = forecast.foreseen(structure)
    while True:
        roots_now = roots_of(weights, len(forecast.rows))
        base = forecast.foreseen(structure, roots_now).cost
        steps = [step for step in steps_back(structure) if step.law in names]
        if not steps:
            return plans
        costs = forecast.costs(structure, [(step.law, step.structure) for step in steps], roots_now)
        order = np.argsort([(cost - base) / step.parameters for cost, step in zip(costs, steps, strict=True)])
        ranked = [((costs[i] - base) / steps[i].parameters, steps[i]) for i in order]
        structure = least(_cheapest(ranked, AT_ONCE * tried.parameters))
        for attempt in range(2):
            tried = forecast.foreseen(structure, roots_of(weights, len(forecast.rows)))
            heights = np.zeros(count)
            heights[inside] = np.abs(tried.rows[:count][inside] / roots[inside]) * found.model.chord
            kept = float(np.max(heights)) <= TRUSTED * tolerance
            if kept or attempt:
                break
            weights = np.clip(weights * _swayed(heights, tolerance), *HEAVIEST)
        if not kept:
            return plans
        plans.append(_Plan(structure=structure, foreseen=tried, weights=weights))


def _cheapest(ranked: list[tuple[float, Step]], most: float) -> list[Step]:
    """The steps back that go together: those that cost little more than the first, up to so many parameters."""
    taken = [ranked[0][1]]
    bound = CHEAP * max(ranked[0][0], 0.0)
    for loss, step in ranked[1:]:
        added = sum(each.parameters for each in taken)
        if loss > bound or added + step.parameters > most:
            break
        if step.law not in {each.law for each in taken}:
            taken.append(step)
    return taken
