"""A match with more control points, those that are predicted to gain most."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bladewright.designs import Design
from bladewright.errors import FitError
from bladewright.fitting.matching.search import ROUGH_REDUCTION, Match, Task, searched
from bladewright.fitting.model_selection.best_structure import best_structure
from bladewright.fitting.model_selection.forecast import Forecast, forecast_of
from bladewright.fitting.model_selection.reshaping import reshaped, with_feasible_edges
from bladewright.fitting.model_selection.steps import (
    MOST_CURVE,
    MOST_SPAN,
    StructureStep,
    gains,
    row_factors,
    steps_taken_together,
    steps_up,
    tolerance_weights,
    union_of,
    widest_reach,
)
from bladewright.fitting.model_selection.stopping import MatchTarget
from bladewright.fitting.model_selection.structure import structure_of
from bladewright.fitting.models.law_jacobian import stands_on_channel
from bladewright.nurbs.basis import Reals
from bladewright.section.unified_limits import THICKNESSES

EDGE_BAND = 0.05
"""distance from an edge, in u, within which a deviation belongs to it."""
FEW_BEYOND = 0.1
"""share of the points beyond the tolerance from which it is the whole blade that is not matched yet."""
GATHERED_AT_EDGE = 0.25
"""share of these points beside an edge from which all laws of the edge grow: the rows of a cloud may differ at their
edges by more than the tolerance, as Rotor 67's do (design/rotor_67_rows.py)."""
EDGE_LAWS = {
    "leading_edge": ("place", "leading_edge_radius", "metal_angle_in"),
    "trailing_edge": ("stagger", "trailing_edge_radius", "metal_angle_out"),
}
"""laws along the span that place an edge and round it, besides its curve in the channel"""


def edge_steps(match: Match, tolerance: float) -> list[StructureStep]:
    """The steps, by half as many control points again, of the edges that stay beyond a tolerance [m].

    The rows of a cloud may differ from each other at their edges: no single law is predicted to gain much there, but
    all laws of an edge together do.
    """
    footpoints, rows = match.state.footpoints, match.rows
    beyond = rows & (footpoints.distances > tolerance)
    structure = structure_of(match.design)
    if not structure.channel or not np.any(beyond) or np.mean(beyond[rows]) > FEW_BEYOND:
        return []
    steps = []
    for edge, near_edge in (
        ("leading_edge", footpoints.u < EDGE_BAND),
        ("trailing_edge", footpoints.u > 1.0 - EDGE_BAND),
    ):
        if np.mean(near_edge[beyond]) < GATHERED_AT_EDGE:
            continue
        laws = [name for name in EDGE_LAWS[edge] if name not in structure.stations]
        counts = {name: _half_as_many_again(structure.span[name], MOST_SPAN) for name in laws}
        curve = _half_as_many_again(structure.channel[edge], MOST_CURVE)
        added = sum(count - structure.span[name] for name, count in counts.items())
        added += 2 * (curve - structure.channel[edge])
        if added:
            wider = replace(structure, span={**structure.span, **counts}, channel={**structure.channel, edge: curve})
            steps.append(StructureStep(fields=(*EDGE_LAWS[edge], f"channel.{edge}"), structure=wider, parameters=added))
    return steps


def _half_as_many_again(count: int, most: int) -> int:
    return max(count, min(most, count + max(1, count // 2)))


FAR_SECTION = 5e-5
"""root mean square distance, of the chord, above which a section is tried with more control points though no gain is
predicted: at sharp edges, where thicknesses lie on their bounds, growth had stopped 7.5e-4 of the chord off."""
THICKNESS_GROWTHS = 3
"""times that both thicknesses grow before this is given up"""
NEARER_RATIO = 0.9
"""ratio of distances below which a trial is taken"""
STOPPING_DISTANCE = {2: FAR_SECTION, 3: 1e-3}
"""root mean square distance, of the chord and by dimension, below which a match is near enough to stop at little
gain."""
LITTLE_GAIN = {2: 0.75, 3: 0.9}
"""ratio of distances, by dimension, above which a match that is near enough grows no more."""


def with_grown_thickness(task: Task, match: Match, target: MatchTarget) -> tuple[Match, bool]:
    """A section with more control points of both thicknesses, and whether it is nearer.

    Where thicknesses lie on their bounds, as at a sharp edge, the gain of growth cannot be predicted linearly: the step
    predicted for the fewer ones leads out of the bounds.
    """
    structure = structure_of(match.design) if task.dimension == 2 else None
    if structure is None or not target.open or match.rms < FAR_SECTION:
        return match, False
    evaluations = match.evaluations
    for _ in range(THICKNESS_GROWTHS):
        steps = [step for step in steps_up(structure) if set(step.fields) <= set(THICKNESSES)]
        if not steps or not any(path.startswith(THICKNESSES) for path in match.problem.paths):
            break
        structure = union_of(structure, steps)
        try:
            fresh = searched(
                task,
                with_feasible_edges(reshaped(match.design, structure)),
                rounds=2,
                noise=match.rms,
                min_reduction=ROUGH_REDUCTION,
            )
        except FitError:
            break
        evaluations += fresh.evaluations
        if fresh.interrupted or fresh.rms < NEARER_RATIO * match.rms:
            return replace(fresh, evaluations=evaluations), True
    return replace(match, evaluations=evaluations), False


def gained_little(task: Task, match: Match, target: MatchTarget, before: float) -> bool:
    """Whether a match is near enough, and growth from a distance `before`, of the chord, gained little."""
    dimension = task.dimension
    return target.open and LITTLE_GAIN[dimension] * before < match.rms < STOPPING_DISTANCE[dimension]


WORTHWHILE_GAIN = 0.02
"""share of the sum of squares that growth must be predicted to gain; `WORTHWHILE_GAIN_NEAR` counts instead once a
blade's misfit is below `NEAR_MISFIT`, of the chord, where a tenth more parameters must be worth more."""
NEAR_MISFIT, WORTHWHILE_GAIN_NEAR = 1e-3, 0.2
"""misfit of a blade, of the chord, below which growth must gain more"""
SHARE_ADDED = 3
"""one in so many of the parameters is added at a time: of those left, or far from a tolerance of those there are. A
third of them reached Rotor 67's tolerance in four searches instead of seven (design/matches.md)."""
MANY_PARAMETERS, SHARE_ADDED_NEAR = 50, 10
"""parameters from which one in `SHARE_ADDED_NEAR` is added at a time near a tolerance."""
FAR_OF_TOLERANCE = 0.4
"""root mean square distance, of the tolerance, that is far from it."""


def grown_match(task: Task, match: Match, target: MatchTarget) -> tuple[Match, bool]:
    """The match with the control points predicted to gain most, and whether there were any."""
    emphasis = tolerance_weights(match, target)
    sharpened = task
    if emphasis is not None:
        weights = task.weights * emphasis
        sharpened = replace(task, weights=weights * (np.sum(task.weights) / np.sum(weights)))
    for design in _candidates(task, match, target, emphasis):
        try:
            start = design if task.dimension == 3 else with_feasible_edges(design)
            fresh = searched(sharpened, start, rounds=1, noise=match.rms, min_reduction=ROUGH_REDUCTION)
        except FitError:
            continue
        return replace(fresh, evaluations=fresh.evaluations + match.evaluations), True
    return match, False


def _candidates(task: Task, match: Match, target: MatchTarget, emphasis: Reals | None) -> Iterator[Design]:
    """Designs with more control points; the next one is for where the one before has no shape."""
    forecast = None
    if task.dimension == 3 and target.parameters is None and stands_on_channel(match.design):
        forecast = forecast_of(match, widest_reach(structure_of(match.design)))
    if forecast is not None:
        task.progress("structure")
        design = _predicted_design(forecast, match, target, emphasis)
        if design is not None:
            yield design
        elif target.open:
            return
    stepped = _stepwise_design(match, target, emphasis)
    if stepped is not None:
        yield stepped


def _least_added(match: Match, target: MatchTarget) -> int:
    """Parameters that are added at least."""
    count = len(match.problem.paths)
    if target.parameters is not None:
        return (target.parameters - count) // SHARE_ADDED
    far = target.tolerance is not None and match.rms * match.model.chord > FAR_OF_TOLERANCE * target.tolerance
    return count // (SHARE_ADDED if far else SHARE_ADDED_NEAR) if count >= MANY_PARAMETERS else 0


def _predicted_design(forecast: Forecast, match: Match, target: MatchTarget, emphasis: Reals | None) -> Design | None:
    """The design with more control points that a forecast prefers; None where none are worthwhile."""
    now = structure_of(match.design)
    roots = None if emphasis is None else row_factors(emphasis, len(forecast.rows))
    count = forecast.prediction(now).parameters
    structure = best_structure(
        forecast, now, count + max(_least_added(match, target), count // SHARE_ADDED_NEAR), roots
    )
    if target.tolerance is not None:
        steps = [StructureStep(fields=(), structure=structure, parameters=0), *edge_steps(match, target.tolerance)]
        structure = union_of(structure, steps) if len(steps) > 1 else structure
    predicted = forecast.prediction(structure, roots)
    min_gain = WORTHWHILE_GAIN if match.rms > NEAR_MISFIT else WORTHWHILE_GAIN_NEAR
    if structure == now or (target.open and predicted.cost > (1.0 - min_gain) * forecast.prediction(now).cost):
        return None
    return forecast.designed(structure, predicted)


def _stepwise_design(match: Match, target: MatchTarget, emphasis: Reals | None) -> Design | None:
    """The design with the control points predicted to gain most; None where there are none."""
    ranked = gains(match, emphasis)
    left = None if target.parameters is None else target.parameters - len(match.problem.paths)
    steps = steps_taken_together(ranked, left, _least_added(match, target))
    if target.tolerance is not None:
        steps += edge_steps(match, target.tolerance)
    if not steps:
        return None
    total = float(np.sum(match.problem.cloud_residuals.residuals(match.state) ** 2))
    if target.parameters is None and emphasis is None and sum(gain for gain, _ in ranked[:3]) < WORTHWHILE_GAIN * total:
        return None
    return reshaped(match.design, union_of(structure_of(match.design), steps))
