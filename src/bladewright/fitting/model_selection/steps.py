"""Steps between structures: one law with more or fewer control points, and what each is predicted to gain or lose."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bladewright.designs import Design
from bladewright.errors import DesignError
from bladewright.fitting.matching.footpoints import footpoints_at
from bladewright.fitting.matching.residuals import PlacedCloud
from bladewright.fitting.matching.scales import scales_of
from bladewright.fitting.matching.search import Match
from bladewright.fitting.model_selection.reshaping import reshaped
from bladewright.fitting.model_selection.stopping import MatchTarget
from bladewright.fitting.model_selection.structure import Structure, structure_of
from bladewright.nurbs.basis import Reals
from bladewright.section.unified_limits import THICKNESSES

WEIGHT_RANGE = (0.1, 10.0)
"""least and largest weight of a point by its distance, where a tolerance is to be met: wider ranges leave all but the
worst points out of account."""
MIN_GAIN_OF_BEST = 0.4
"""gain for each parameter, of the best, from which a law grows together with it."""
QUARTER_STEPS_FROM = 8
"""control points along the chord from which a thickness grows by a quarter at a time."""
SPARE_SAMPLES = 4
"""samples along the chord beyond a thickness's control points: fewer leave its law undetermined."""
FEWEST_THICKNESSES = 3
"""control points of a thickness at least"""
MOST_SAMPLES, MOST_SPAN, MOST_CURVE = 60, 12, 12
"""samples along the chord, control points along the span (`MOST_SPAN`) and of a curve of the channel (`MOST_CURVE`) at
most; they bound the time."""


@dataclass(frozen=True, kw_only=True)
class StructureStep:
    """One law with more or fewer control points."""

    fields: tuple[str, ...]
    """beginnings of the paths that change"""
    structure: Structure
    parameters: int
    """by how many parameters the structures differ"""

    @property
    def law(self) -> str:
        """The name of the first law in a structure."""
        name = self.fields[0].removeprefix("channel.")
        return "place" if self.fields[0] in _fields("place") else name


def steps_up(structure: Structure) -> list[StructureStep]:
    """The structures with more control points in one law."""
    found = []
    for side, name in enumerate(THICKNESSES):
        count = structure.chordwise[side]
        more = _thickness_step(count)
        counts = [*structure.chordwise]
        counts[side] = count + more
        samples = max(structure.samples, counts[side] + SPARE_SAMPLES)
        if samples <= MOST_SAMPLES:
            wider = replace(structure, chordwise=(counts[0], counts[1]), samples=samples)
            found.append(StructureStep(fields=(name,), structure=wider, parameters=more * structure.span.get(name, 1)))
    for name, count in structure.span.items():
        if count < MOST_SPAN and name not in structure.stations:
            wider = replace(structure, span={**structure.span, name: count + 1})
            added = structure.chordwise[THICKNESSES.index(name)] if name in THICKNESSES else 1
            found.append(StructureStep(fields=_fields(name), structure=wider, parameters=added))
    for name, count in structure.channel.items():
        if count < MOST_CURVE:
            wider = replace(structure, channel={**structure.channel, name: count + 1})
            found.append(StructureStep(fields=(f"channel.{name}",), structure=wider, parameters=2))
    return found


def steps_down(structure: Structure) -> list[StructureStep]:
    """The structures with one control point fewer in one law."""
    found = []
    for side, name in enumerate(THICKNESSES):
        if structure.chordwise[side] > FEWEST_THICKNESSES:
            counts = [*structure.chordwise]
            counts[side] -= 1
            narrower = replace(structure, chordwise=(counts[0], counts[1]))
            found.append(StructureStep(fields=(name,), structure=narrower, parameters=structure.span.get(name, 1)))
    for name, count in structure.span.items():
        if count > 1 and name not in structure.stations:
            narrower = replace(structure, span={**structure.span, name: count - 1})
            left_out = structure.chordwise[THICKNESSES.index(name)] if name in THICKNESSES else 1
            found.append(StructureStep(fields=_fields(name), structure=narrower, parameters=left_out))
    for name, count in structure.channel.items():
        if count > 2:
            narrower = replace(structure, channel={**structure.channel, name: count - 1})
            found.append(StructureStep(fields=(f"channel.{name}",), structure=narrower, parameters=2))
    return found


def widest_reach(structure: Structure) -> Structure:
    """A structure wide enough for all steps along the chord and the walls, where laws move point by point."""
    chordwise = [count + _thickness_step(count) for count in structure.chordwise]
    samples = min(MOST_SAMPLES, max(structure.samples, max(chordwise) + SPARE_SAMPLES))
    walls = {wall: min(structure.channel[wall] + 1, MOST_CURVE) for wall in ("hub", "shroud")}
    return replace(
        structure,
        chordwise=(min(chordwise[0], samples - SPARE_SAMPLES), min(chordwise[1], samples - SPARE_SAMPLES)),
        samples=samples,
        channel={**structure.channel, **walls},
    )


def _thickness_step(count: int) -> int:
    """By how many control points a thickness grows at a time."""
    return max(1, count // 4) if count >= QUARTER_STEPS_FROM else 1


def _fields(name: str) -> tuple[str, ...]:
    return ("leading_edge_theta", "leading_edge_y") if name == "place" else (name,)


def union_of(structure: Structure, steps: Sequence[StructureStep]) -> Structure:
    """A structure with several steps up taken at once."""
    chordwise = [max(step.structure.chordwise[side] for step in steps) for side in (0, 1)]
    span = {name: max(step.structure.span[name] for step in steps) for name in structure.span}
    channel = {name: max(step.structure.channel[name] for step in steps) for name in structure.channel}
    samples = max(step.structure.samples for step in steps)
    return replace(structure, chordwise=(chordwise[0], chordwise[1]), span=span, channel=channel, samples=samples)


def intersection_of(steps: Sequence[StructureStep]) -> Structure:
    """The structure that several steps down lead to together."""
    structures = [step.structure for step in steps]
    chordwise = [min(each.chordwise[side] for each in structures) for side in (0, 1)]
    span = {name: min(each.span[name] for each in structures) for name in structures[0].span}
    channel = {name: min(each.channel[name] for each in structures) for name in structures[0].channel}
    return replace(structures[0], chordwise=(chordwise[0], chordwise[1]), span=span, channel=channel)


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


def gains(match: Match, emphasis: Reals | None = None) -> list[tuple[float, StructureStep]]:
    """What each step is predicted to take off the sum of squares, best for each parameter first.

    Predictions are linear. `emphasis` (n,) are further weights of the points. Laws that are held do not grow.
    """
    problem = match.problem
    rows = problem.cloud_residuals.residuals(match.state)
    slopes = problem.cloud_residuals.slopes(match.state, problem.paths) * problem.scales.size
    roots = row_factors(emphasis, len(rows))
    before = predicted_rest(slopes, rows, roots, problem.noise)
    result = [
        (before - predicted_rest(wider, rows, roots, problem.noise), step)
        for step, _, wider in _predicted_systems(match, slopes, steps_up(structure_of(match.design)))
    ]
    return sorted(result, key=lambda pair: -pair[0] / pair[1].parameters)


def losses(match: Match) -> list[tuple[float, StructureStep]]:
    """What each step down is predicted to leave of the sum of squares, least for each parameter first."""
    problem = match.problem
    slopes = problem.cloud_residuals.slopes(match.state, problem.paths) * problem.scales.size
    roots = np.ones(len(slopes))
    result = [
        (predicted_rest(narrower, rows, roots, problem.noise), step)
        for step, rows, narrower in _predicted_systems(match, slopes, steps_down(structure_of(match.design)))
    ]
    return sorted(result, key=lambda pair: pair[0] / pair[1].parameters)


def _predicted_systems(
    match: Match, slopes: Reals, steps: Sequence[StructureStep]
) -> Iterator[tuple[StructureStep, Reals, Reals]]:
    """The steps of free laws, with the residuals after each and their derivatives (m, k)."""
    paths = match.problem.paths
    for step in steps:
        own = [path for path in match.design.parameters() if path.startswith(step.fields)]
        if not set(own) <= set(paths):
            continue
        kept = [i for i, path in enumerate(paths) if path not in own]
        try:
            rows, columns = _residuals_after(match, step)
        except DesignError:
            continue
        yield step, rows, np.concatenate([slopes[:, kept], columns], axis=1)


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


def steps_taken_together(
    ranked: Sequence[tuple[float, StructureStep]], most: int | None = None, least: int = 0
) -> list[StructureStep]:
    """The steps worth taking together, of at most `most` parameters, and of `least` if they help."""
    if not ranked:
        return []
    best = ranked[0][0] / ranked[0][1].parameters
    taken: list[StructureStep] = []
    left = np.inf if most is None else most
    for gain, step in ranked:
        added = sum(each.parameters for each in taken)
        worthwhile = not taken or gain / step.parameters >= MIN_GAIN_OF_BEST * best or (added < least and gain > 0.0)
        if step.parameters <= left and worthwhile:
            taken.append(step)
            left -= step.parameters
    return taken


def _residuals_after(match: Match, step: StructureStep) -> tuple[Reals, Reals]:
    """Residuals after a step at the present footpoints, and their derivatives by its law's parameters."""
    other = reshaped(match.design, step.structure)
    return residuals_of(match, other, tuple(path for path in other.parameters() if path.startswith(step.fields)))


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
