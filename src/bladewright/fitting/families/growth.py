"""Growth of the families that are one part: control points are added where they are predicted to gain most."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.matching.search import Match, Task
from bladewright.fitting.model_selection.steps import predicted_rest, residuals_of, row_factors
from bladewright.fitting.model_selection.stopping import MatchTarget, needs_more
from bladewright.nurbs.basis import Reals

PredictedGain = tuple[float, int, Design]
"""reduction of the sum of squares for each parameter, number of added parameters, and the design"""


def predicted_gains(
    task: Task, match: Match, designs: Iterable[Design], emphasis: Reals | None = None
) -> list[PredictedGain]:
    """Designs with more control points than a match's, best predicted gain for each parameter first.

    The gains are linear predictions, without a search. `emphasis` (n,) are further weights of the points. Designs
    without a shape, or that gain nothing, are left out.
    """
    cloud_residuals, paths = match.problem.cloud_residuals, match.problem.paths
    values = match.design.parameters()
    rows = cloud_residuals.residuals(match.state)
    slopes = cloud_residuals.slopes(match.state, paths) * match.problem.scales.size
    roots = row_factors(emphasis, len(rows))
    before = predicted_rest(slopes, rows, roots, match.problem.noise)
    ranked: list[PredictedGain] = []
    for design in designs:
        try:
            free = task.free(design)
            fresh = design.parameters()
            own = tuple(path for path in free if values.get(path) != fresh[path])
            kept = [i for i, path in enumerate(paths) if path in fresh and path not in own]
            rows, columns = residuals_of(match, design, own)
        except (DesignError, FitError):
            continue
        wider = np.concatenate([slopes[:, kept], columns], axis=1)
        gain = before - predicted_rest(wider, rows, roots, match.problem.noise)
        more = len(free) - len(paths)
        if gain > 0.0 and more > 0:
            ranked.append((gain / more, more, design))
    return sorted(ranked, key=lambda each: -each[0])


WORTHWHILE_RATIO = 0.9
"""ratio of misfits below which further control points are worthwhile where no target is stated."""
PATIENCE = 2
"""times in a row that further control points may be in vain before growth ends"""
MOST_GROWTHS = 30
"""times that control points are added at most; it bounds the time."""
FUTILE_REASON = "further control points bring the design hardly nearer to the points"
"""why growth ended where it was in vain"""

GrowthStep = Callable[[Task, Match, MatchTarget, int], Iterator[Match]]
"""matches near to one with control points more; the number says how often growth was taken back"""


def grown_to_target(
    task: Task, match: Match, target: MatchTarget, wider: GrowthStep, *, coarse: float
) -> tuple[Match, str]:
    """A match with as many control points as the target needs, or why there are no more.

    A step that brings the design no nearer is taken back, and another is tried. What is grown can be built, with native
    sides of the `coarse` tolerance.
    """
    best, trials_without_gain, back = match, 0, 0
    for _ in range(MOST_GROWTHS):
        short, reason = needs_more(match, target, task)
        if not short or match.interrupted:
            met = not short and not reason
            return match if met or match.rms <= best.rms or target.parameters is not None else best, reason
        tried = [
            each for each in wider(task, match, target, back) if _allowed(each, target) and can_be_built(each, coarse)
        ]
        if not tried and not back:
            return best, "no control point can be added to the design that leaves it one that can be built"
        fresh = min(tried, key=lambda each: each.rms, default=None)
        if fresh is None or (fresh.rms > match.rms and fresh.maximum > match.maximum):
            if back < PATIENCE and not (fresh is not None and fresh.interrupted):
                back += 1
                continue
            if fresh is None or target.parameters is None:
                return best, FUTILE_REASON
        match, back = fresh, 0
        trials_without_gain = trials_without_gain + 1 if match.rms > WORTHWHILE_RATIO * best.rms else 0
        best = match if match.rms < WORTHWHILE_RATIO * best.rms or target.parameters is not None else best
        if target.open and trials_without_gain > PATIENCE:
            return best, FUTILE_REASON
    return best, f"control points were added {MOST_GROWTHS} times, and no more are"


def can_be_built(match: Match, tolerance: float) -> bool:
    """Whether the design can be built with a tolerance, that is, its sections do not cross themselves."""
    design: Any = match.design
    try:
        replace(design, tolerance=max(design.tolerance, tolerance)).build()
    except DesignError:
        return False
    return True


def _allowed(match: Match, target: MatchTarget) -> bool:
    return target.parameters is None or len(match.problem.paths) <= target.parameters
