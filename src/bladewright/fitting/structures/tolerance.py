"""A match within a tolerance: at every point, with no more control points than it asks for and as calm as it allows."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bladewright.blade.extrema import extrema_of
from bladewright.errors import DesignError, FitError
from bladewright.fitting.matching.descent import SLIGHT
from bladewright.fitting.matching.search import ROUGH, Found, Task, searched
from bladewright.fitting.structures.aim import Aim
from bladewright.fitting.structures.growing import grown
from bladewright.fitting.structures.growth import Step, least, losses
from bladewright.fitting.structures.reshaping import reshaped
from bladewright.fitting.structures.sparing import spared_blade

LATER = 4
"""times that more is added where points outside the quick searches stay beyond the tolerance"""
SHARPER = 4
"""times that points are weighed by their distances before anything is added"""
ROUNDS = 2
AT_ONCE = {2: (4, 1), 3: (8, 4)}
"""laws that lose a control point together, those first of which it is foreseen to cost least; half as many where that
is too much, down to so few: searches of blades are dear"""
SMOOTHER = (3.0, 10.0, 30.0, 100.0, 1000.0)
"""strengths of the prior, in turn"""
CALM = 4
"""extrema of a side's curvature that a plain section has"""


def kept(task: Task, found: Found, aim: Aim, tolerance: float) -> Found:
    """The match that keeps a tolerance, where a little more brings it there, with as little as keeps it."""
    found = _everywhere(task, found, aim, tolerance)
    return calmed(task, spared(task, found, tolerance), tolerance)


def _everywhere(task: Task, found: Found, aim: Aim, tolerance: float) -> Found:
    """A match that keeps a tolerance at the points of a thorough search too, where a little more brings it there."""
    found = _within(task, found, tolerance)
    for _ in range(LATER):
        if found.maximum <= tolerance or found.interrupted:
            break
        found, grew = grown(task, found, aim)
        if not grew:
            break
        found = _within(task, found, tolerance)
    return found


def _within(task: Task, found: Found, tolerance: float) -> Found:
    """A match whose largest deviations are weighed more, where that brings them within the tolerance."""
    best, weights = found, task.weights
    for _ in range(SHARPER):
        if best.maximum <= tolerance or best.interrupted:
            break
        distances = found.state.feet.distances
        weights = weights * np.clip((distances / tolerance) ** 2, 0.3, 4.0)
        weights = weights * (np.sum(task.weights) / np.sum(weights))
        rounds = ROUNDS if task.points.shape[1] == 2 else 1
        found = searched(replace(task, weights=weights), found.design, rounds=rounds, slight=_slight(task))
        best = found if found.maximum < best.maximum else best
    return best


def spared(task: Task, found: Found, tolerance: float) -> Found:
    """A match within a tolerance without the control points that it does not need."""
    if task.points.shape[1] == 3 and found.maximum <= tolerance:
        fewer_still = spared_blade(task, found, tolerance)
        if fewer_still is not None:
            return fewer_still
    most, least_at_once = AT_ONCE[task.points.shape[1]]
    at_once = most
    while at_once >= least_at_once and found.maximum <= tolerance and not found.interrupted:
        steps = [step for _, step in losses(found)[:at_once]]
        fewer = _without(task, found, steps) if steps else None
        if fewer is not None and fewer.maximum <= tolerance and not fewer.interrupted:
            found = fewer
        else:
            at_once = min(at_once, len(steps)) // 2
    return found


def _without(task: Task, found: Found, steps: Sequence[Step]) -> Found | None:
    try:
        fresh = searched(
            task, reshaped(found.design, least(steps)), rounds=ROUNDS, noise=found.rms, slight=_slight(task)
        )
    except FitError:
        return None
    return replace(fresh, evaluations=fresh.evaluations + found.evaluations)


def _slight(task: Task) -> float:
    """What a step must promise: searches of blades are dear."""
    return SLIGHT if task.points.shape[1] == 2 else ROUGH


def calmed(task: Task, found: Found, tolerance: float) -> Found:
    """A match within a tolerance whose sides' curvature has fewer extrema, where a smoother one has."""
    waves = _waves(found)
    for strength in SMOOTHER:
        if waves is None or waves <= CALM or found.interrupted or found.maximum > tolerance:
            break
        fresh = searched(replace(task, smooth=strength * task.smooth), found.design, rounds=1)
        fewer = _waves(fresh)
        if fresh.maximum > tolerance or fewer is None or fewer > waves:
            break
        found, waves = replace(fresh, evaluations=fresh.evaluations + found.evaluations), fewer
    return found


def _waves(found: Found) -> int | None:
    """Extrema of the curvature of the side that has most; None where the design cannot be built."""
    try:
        return max(extrema_of(found.design.build()).values())
    except DesignError:
        return None
