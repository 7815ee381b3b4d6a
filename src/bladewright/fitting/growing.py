"""A match with more control points, those that promise most."""

from dataclasses import replace

import numpy as np

from bladewright.errors import FitError
from bladewright.fitting.aim import Aim
from bladewright.fitting.choosing import ranked
from bladewright.fitting.edgewise import edge_steps
from bladewright.fitting.forecast import forecast_of
from bladewright.fitting.growth import chosen_of, gains, joined, roomier
from bladewright.fitting.opening import opened
from bladewright.fitting.reshaping import reshaped
from bladewright.fitting.search import ROUGH, Found, Task, searched
from bladewright.fitting.structure import structure_of

WORTHWHILE = 0.02
"""part of the sum of squares that growth must be foreseen to gain"""
EMPHASIS = (0.1, 10.0)
"""least and largest weight of a point by its distance, where a tolerance is to be met"""
GROWN = 3
"""part, one in so many, of the parameters that are left which is added at a time"""
MANIFOLD, MANY_MORE = 50, 10
"""parameters from which one in so many is added at a time"""
FAR = 0.5
"""of the tolerance: root mean square above which twice as many are"""


def grown(task: Task, found: Found, aim: Aim) -> tuple[Found, bool]:
    """The match with the control points that promise most, and whether there were any."""
    emphasis = None
    if aim.tolerance is not None:
        emphasis = np.clip((found.state.feet.distances / aim.tolerance) ** 2, *EMPHASIS)
    forecast = forecast_of(found, roomier(structure_of(found.design))) if task.points.shape[1] == 3 else None
    roots = None
    if forecast is not None and emphasis is not None:
        roots = np.ones(len(forecast.rows))
        roots[: len(emphasis)] = np.sqrt(emphasis)
    steps_ranked = gains(found, emphasis) if forecast is None else ranked(forecast, structure_of(found.design), roots)
    left = None if aim.parameters is None else aim.parameters - len(found.problem.paths)
    count = len(found.problem.paths)
    least = left // GROWN if left is not None else 0
    if left is None and count >= MANIFOLD:
        far = aim.tolerance is not None and found.rms * found.model.chord > FAR * aim.tolerance
        least = count // (MANY_MORE // 2 if far else MANY_MORE)
    steps = chosen_of(steps_ranked, left, least)
    if aim.tolerance is not None:
        steps += edge_steps(found, aim.tolerance)
    if not steps:
        return found, False
    total = float(np.sum(found.problem.measures.residuals(found.state) ** 2))
    if aim.parameters is None and emphasis is None and sum(gain for gain, _ in steps_ranked[:3]) < WORTHWHILE * total:
        return found, False
    structure = joined(structure_of(found.design), steps)
    if forecast is None:
        design = reshaped(found.design, structure)
    else:
        design = forecast.designed(structure, forecast.foreseen(structure, roots))
    if emphasis is not None:
        weights = task.weights * emphasis
        task = replace(task, weights=weights * (np.sum(task.weights) / np.sum(weights)))
    try:
        start = design if task.points.shape[1] == 3 else opened(design)
        fresh = searched(task, start, rounds=1, noise=found.rms, slight=ROUGH)
    except FitError:
        return found, False
    return replace(fresh, evaluations=fresh.evaluations + found.evaluations), True
