"""More control points where the deviation is: each law in turn is given one more, and the gain is foreseen."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bladewright.errors import DesignError
from bladewright.fitting.feet import placed
from bladewright.fitting.problem import State
from bladewright.fitting.reshaping import reshaped
from bladewright.fitting.scales import scales_of
from bladewright.fitting.search import Found
from bladewright.fitting.structure import Structure, structure_of
from bladewright.nurbs.basis import Reals
from bladewright.section.limits import THICKNESSES

WORTH = 0.4
"""gain for each parameter, of the best, from which a law grows too"""
FINER = 8
"""control points along the chord from which a thickness grows by a quarter at a time"""
SPARE = 4
"""samples along the chord beyond a thickness's control points"""
MOST_SAMPLES, MOST_SPAN, MOST_CURVE = 60, 12, 10


@dataclass(frozen=True, kw_only=True)
class Step:
    """One law with more control points."""

    fields: tuple[str, ...]
    """beginnings of the paths that change"""
    structure: Structure
    parameters: int
    """that it adds"""


def steps_from(structure: Structure) -> list[Step]:
    """What may grow."""
    found = []
    for side, name in enumerate(THICKNESSES):
        count = structure.chordwise[side]
        more = max(1, count // 4) if count >= FINER else 1
        counts = [*structure.chordwise]
        counts[side] = count + more
        samples = max(structure.samples, counts[side] + SPARE)
        if samples <= MOST_SAMPLES:
            wider = replace(structure, chordwise=(counts[0], counts[1]), samples=samples)
            found.append(Step(fields=(name,), structure=wider, parameters=more * structure.span.get(name, 1)))
    for name, count in structure.span.items():
        if count < MOST_SPAN:
            wider = replace(structure, span={**structure.span, name: count + 1})
            added = structure.chordwise[THICKNESSES.index(name)] if name in THICKNESSES else 1
            field = "leading_edge_theta" if name == "place" else name
            fields = ("leading_edge_theta", "leading_edge_y") if name == "place" else (field,)
            found.append(Step(fields=fields, structure=wider, parameters=added))
    for name, count in structure.channel.items():
        if count < MOST_CURVE:
            wider = replace(structure, channel={**structure.channel, name: count + 1})
            found.append(Step(fields=(f"channel.{name}",), structure=wider, parameters=2))
    return found


def joined(structure: Structure, steps: Sequence[Step]) -> Structure:
    """A structure with several steps taken at once."""
    chordwise = [max(step.structure.chordwise[side] for step in steps) for side in (0, 1)]
    span = {name: max(step.structure.span[name] for step in steps) for name in structure.span}
    channel = {name: max(step.structure.channel[name] for step in steps) for name in structure.channel}
    samples = max(step.structure.samples for step in steps)
    return replace(structure, chordwise=(chordwise[0], chordwise[1]), span=span, channel=channel, samples=samples)


def gains(found: Found, emphasis: Reals | None = None) -> list[tuple[float, Step]]:
    """What each step would take off the sum of squares, foreseen linearly, best for each parameter first.

    `emphasis` (n,) are further weights of the points. Laws that are not free do not grow.
    """
    problem = found.problem
    rows = problem.measures.residuals(found.state)
    slopes = problem.measures.slopes(found.state, problem.paths) * problem.scales.size
    roots = np.ones(len(rows))
    if emphasis is not None:
        roots[: len(emphasis)] = np.sqrt(emphasis)
    before = _reduced(slopes, rows, roots, problem.noise)
    result = []
    for step in steps_from(structure_of(found.design)):
        own = [path for path in found.design.parameters() if path.startswith(step.fields)]
        if not set(own) <= set(problem.paths):
            continue
        kept = [i for i, path in enumerate(problem.paths) if path not in own]
        try:
            columns = _columns(found, step)
        except DesignError:
            continue
        after = _reduced(np.concatenate([slopes[:, kept], columns], axis=1), rows, roots, problem.noise)
        result.append((before - after, step))
    return sorted(result, key=lambda pair: -pair[0] / pair[1].parameters)


def _reduced(slopes: Reals, rows: Reals, roots: Reals, noise: float) -> float:
    """The sum of squares after the step that makes it least, parameters held by the prior's spread."""
    count = slopes.shape[1]
    triangle = np.linalg.qr(np.column_stack([slopes * roots[:, None], rows * roots]), mode="r")
    reduced = np.asarray(triangle)
    matrix = np.vstack([reduced[:, :-1], noise * np.eye(count)])
    aim = np.concatenate([-reduced[:, -1], np.zeros(count)])
    step, *_ = np.linalg.lstsq(matrix, aim, rcond=None)
    return float(np.sum((matrix @ step - aim) ** 2))


def chosen_of(ranked: Sequence[tuple[float, Step]], most: int | None = None, least: int = 0) -> list[Step]:
    """The steps that are worth taking together, of at most so many parameters, and of so many at least if they help."""
    if not ranked:
        return []
    best = ranked[0][0] / ranked[0][1].parameters
    taken: list[Step] = []
    left = np.inf if most is None else most
    for gain, step in ranked:
        added = sum(each.parameters for each in taken)
        worth = not taken or gain / step.parameters >= WORTH * best or (added < least and gain > 0.0)
        if step.parameters <= left and worth:
            taken.append(step)
            left -= step.parameters
    return taken


def _columns(found: Found, step: Step) -> Reals:
    """Derivatives of the residuals by the parameters of the law that grows, where its cloud stands now."""
    wider = reshaped(found.design, step.structure)
    paths = tuple(path for path in wider.parameters() if path.startswith(step.fields))
    measures, on = found.problem.measures, found.state.feet
    shape = measures.model.shape(wider)
    if not shape.finite:
        raise DesignError("a law that grows left no shape: take another one")
    state = State(shape=shape, feet=placed(measures.points, shape.sides, on.side, on.u, on.v))
    return measures.slopes(state, paths) * scales_of(wider, paths, found.model.chord).size
