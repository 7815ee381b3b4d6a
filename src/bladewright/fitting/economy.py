"""No more control points than a tolerance asks for, and no more waves than it allows."""

from collections.abc import Sequence
from dataclasses import replace

from bladewright.blade.extrema import extrema_of
from bladewright.errors import DesignError, FitError
from bladewright.fitting.growth import Step, least, losses
from bladewright.fitting.reshaping import reshaped
from bladewright.fitting.search import Found, Task, searched

ROUNDS = 2
AT_ONCE = 4
"""laws that lose a control point together, those first of which it is foreseen to cost least; half as many where that
is too much"""
SMOOTHER = (10.0, 100.0, 1000.0)
"""strengths of the prior, in turn"""
CALM = 4
"""extrema of a side's curvature that a plain section has"""


def spared(task: Task, found: Found, tolerance: float) -> Found:
    """A match within a tolerance without the control points that it does not need."""
    at_once = AT_ONCE
    while at_once and found.maximum <= tolerance and not found.interrupted:
        steps = [step for _, step in losses(found)[:at_once]]
        fewer = _without(task, found, steps) if steps else None
        if fewer is not None and fewer.maximum <= tolerance and not fewer.interrupted:
            found = fewer
        else:
            at_once = min(at_once, len(steps)) // 2
    return found


def _without(task: Task, found: Found, steps: Sequence[Step]) -> Found | None:
    try:
        fresh = searched(task, reshaped(found.design, least(steps)), rounds=ROUNDS, noise=found.rms)
    except FitError:
        return None
    return replace(fresh, evaluations=fresh.evaluations + found.evaluations)


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
