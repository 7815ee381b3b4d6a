"""A match with more control points, those that promise most."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bladewright.designs import Design
from bladewright.errors import FitError
from bladewright.fitting.matching.chain import own_walls
from bladewright.fitting.matching.search import ROUGH, Found, Task, searched
from bladewright.fitting.structures.aim import Aim
from bladewright.fitting.structures.choosing import best_of
from bladewright.fitting.structures.edgewise import edge_steps
from bladewright.fitting.structures.forecast import Forecast, forecast_of
from bladewright.fitting.structures.growth import Step, chosen_of, emphasis_of, gains, joined, roomier, roots_of
from bladewright.fitting.structures.opening import opened
from bladewright.fitting.structures.reshaping import reshaped
from bladewright.fitting.structures.structure import structure_of
from bladewright.nurbs.basis import Reals

WORTHWHILE = 0.02
"""part of the sum of squares that growth must be foreseen to gain"""
NEAR, WORTH_MORE = 1e-3, 0.2
"""misfit, of the chord, below which a blade is near enough for a tenth more parameters to be worth that part instead"""
GROWN = 3
"""part, one in so many, of the parameters that are left, or far from a tolerance of those that are there, which is
added at a time"""
MANIFOLD, MANY_MORE = 50, 10
"""parameters from which one in so many is added at a time near a tolerance"""
FAR = 0.4
"""of the tolerance: root mean square that is far"""


def grown(task: Task, found: Found, aim: Aim) -> tuple[Found, bool]:
    """The match with the control points that promise most, and whether there were any."""
    emphasis = emphasis_of(found, aim)
    sharpened = task
    if emphasis is not None:
        weights = task.weights * emphasis
        sharpened = replace(task, weights=weights * (np.sum(task.weights) / np.sum(weights)))
    for design in _candidates(task, found, aim, emphasis):
        try:
            start = design if task.points.shape[1] == 3 else opened(design)
            fresh = searched(sharpened, start, rounds=1, noise=found.rms, slight=ROUGH)
        except FitError:
            continue
        return replace(fresh, evaluations=fresh.evaluations + found.evaluations), True
    return found, False


def _candidates(task: Task, found: Found, aim: Aim, emphasis: Reals | None) -> Iterator[Design]:
    """Designs with more control points, the next one where the one before has no shape."""
    forecast = None
    if task.points.shape[1] == 3 and aim.parameters is None and own_walls(found.design):
        forecast = forecast_of(found, roomier(structure_of(found.design)))
    if forecast is not None:
        task.told("structure")
        design = _foreseen(forecast, found, aim, emphasis)
        if design is not None:
            yield design
        elif aim.open:
            return
    stepped = _stepped(found, aim, emphasis)
    if stepped is not None:
        yield stepped


def _more(found: Found, aim: Aim) -> int:
    """Parameters that are added at least."""
    count = len(found.problem.paths)
    if aim.parameters is not None:
        return (aim.parameters - count) // GROWN
    far = aim.tolerance is not None and found.rms * found.model.chord > FAR * aim.tolerance
    return count // (GROWN if far else MANY_MORE) if count >= MANIFOLD else 0


def _foreseen(forecast: Forecast, found: Found, aim: Aim, emphasis: Reals | None) -> Design | None:
    """The design with more control points that a forecast prefers; None where more are not worth it."""
    now = structure_of(found.design)
    roots = None if emphasis is None else roots_of(emphasis, len(forecast.rows))
    count = forecast.foreseen(now).parameters
    structure = best_of(forecast, now, count + max(_more(found, aim), count // MANY_MORE), roots)
    if aim.tolerance is not None:
        steps = [Step(fields=(), structure=structure, parameters=0), *edge_steps(found, aim.tolerance)]
        structure = joined(structure, steps) if len(steps) > 1 else structure
    told = forecast.foreseen(structure, roots)
    worth = WORTHWHILE if found.rms > NEAR else WORTH_MORE
    if structure == now or (aim.open and told.cost > (1.0 - worth) * forecast.foreseen(now).cost):
        return None
    return forecast.designed(structure, told)


def _stepped(found: Found, aim: Aim, emphasis: Reals | None) -> Design | None:
    """The design with the control points that promise most; None where there are none."""
    ranked = gains(found, emphasis)
    left = None if aim.parameters is None else aim.parameters - len(found.problem.paths)
    steps = chosen_of(ranked, left, _more(found, aim))
    if aim.tolerance is not None:
        steps += edge_steps(found, aim.tolerance)
    if not steps:
        return None
    total = float(np.sum(found.problem.measures.residuals(found.state) ** 2))
    if aim.parameters is None and emphasis is None and sum(gain for gain, _ in ranked[:3]) < WORTHWHILE * total:
        return None
    return reshaped(found.design, joined(structure_of(found.design), steps))
