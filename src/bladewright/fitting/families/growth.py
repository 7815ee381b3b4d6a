"""Growth of the families that are one part: control points are added where they are predicted to gain most."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.matching.footpoints import footpoints_at
from bladewright.fitting.matching.residuals import PlacedCloud
from bladewright.fitting.matching.scales import scales_of
from bladewright.fitting.matching.search import Match, Task
from bladewright.fitting.model_selection.match_target import MatchTarget
from bladewright.fitting.model_selection.selection import NOISE_CORRELATION, NOISE_REASON
from bladewright.nurbs.basis import Reals

WEIGHT_RANGE = (0.1, 10.0)
"""least and largest weight of a point by its distance, where a tolerance is to be met: wider ranges leave all but the
worst points out of account."""
ENOUGH_DEVIATION = {2: 5e-7, 3: 5e-5}
"""largest deviation at which nothing is added where no target is stated, of the chord, by dimension."""
MOST_PARAMETERS = {2: 80, 3: 340}
"""parameters above which nothing is added, by dimension; it bounds the time."""
POINTS_PER_PARAMETER = {2: 2, 3: 3}
"""points for each parameter at least, by dimension: published profiles have few points, and exact ones."""


def tolerance_weights(match: Match, target: MatchTarget) -> Reals | None:
    """Further weights (n,) by which distant points count more; none where no tolerance is asked for."""
    if target.tolerance is None:
        return None
    return np.clip((match.state.footpoints.distances / target.tolerance) ** 2, *WEIGHT_RANGE)


def row_factors(emphasis: Reals | None, count: int) -> Reals:
    """Factors (count,) of the rows of a least-squares problem, those of the points first."""
    roots = np.ones(count)
    if emphasis is not None:
        roots[: len(emphasis)] = np.sqrt(emphasis)
    return roots


def predicted_rest(slopes: Reals, rows: Reals, roots: Reals, noise: float) -> float:
    """The sum of squares of rows (n,) weighted by roots (n,) after the linear step that minimises it.

    `slopes` (n, k) are by scaled parameters, which are held by the spread `noise` of the regularisation.
    """
    count = slopes.shape[1]
    triangle = np.linalg.qr(np.column_stack([slopes * roots[:, None], rows * roots]), mode="r")
    penalty = np.zeros((count, count + 1))
    penalty[:, :-1] = noise * np.eye(count)
    # the last diagonal entry is what no step removes
    left = np.asarray(np.linalg.qr(np.vstack([np.asarray(triangle), penalty]), mode="r"))[-1, -1]
    return float(left**2)


def residuals_of(match: Match, design: Design, paths: tuple[str, ...]) -> tuple[Reals, Reals]:
    """Residuals (n,) of a design at a match's footpoints, and derivatives (n, p) by its scaled parameters `paths`.

    Raises DesignError where the design has no shape.
    """
    cloud_residuals, footpoints = match.problem.cloud_residuals, match.state.footpoints
    shape = cloud_residuals.model.shape(design)
    if not shape.finite:
        raise DesignError("a law with another number of control points left no shape: take another one")
    state = PlacedCloud(
        shape=shape,
        footpoints=footpoints_at(cloud_residuals.points, shape.sides, footpoints.side, footpoints.u, footpoints.v),
    )
    rows = cloud_residuals.residuals(state)
    if not paths:
        # a wall with no control points but its corners
        return rows, np.zeros((len(rows), 0))
    return rows, cloud_residuals.slopes(state, paths) * scales_of(design, paths, match.model.chord).size


def needs_more(match: Match, target: MatchTarget, task: Task) -> tuple[bool, str]:
    """Whether more control points are wanted; if not and the target is not met, why."""
    count = len(match.problem.paths)
    dimension = task.dimension
    if target.parameters is not None:
        return count < target.parameters, ""
    limit = target.tolerance if target.tolerance is not None else ENOUGH_DEVIATION[dimension] * match.model.chord
    if match.maximum <= limit:
        return False, ""
    noise = match.noise_estimate.noise
    if match.noise_estimate.correlation < NOISE_CORRELATION:
        return (
            False,
            NOISE_REASON.format(1e3 * noise),
        )
    if count >= min(MOST_PARAMETERS[dimension], len(task.points) // POINTS_PER_PARAMETER[dimension]):
        return False, f"the design has {count} parameters, and more are not added"
    return True, ""


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
        if not short:
            return match if not reason or match.rms <= best.rms or target.parameters is not None else best, reason
        tried = [
            each for each in wider(task, match, target, back) if _allowed(each, target) and can_be_built(each, coarse)
        ]
        if not tried and not back:
            return best, "no control point can be added to the design that leaves it one that can be built"
        fresh = min(tried, key=lambda each: each.rms, default=None)
        if fresh is None or (fresh.rms > match.rms and fresh.maximum > match.maximum):
            if back < PATIENCE:
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
