"""More control points where the deviation is: each law in turn is given one more, and the gain is foreseen."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bladewright.errors import DesignError
from bladewright.fitting.matching.feet import placed
from bladewright.fitting.matching.problem import State
from bladewright.fitting.matching.scales import scales_of
from bladewright.fitting.matching.search import Found
from bladewright.fitting.structures.aim import Aim
from bladewright.fitting.structures.reshaping import reshaped
from bladewright.fitting.structures.structure import Structure, structure_of
from bladewright.nurbs.basis import Reals
from bladewright.section.limits import THICKNESSES

EMPHASIS = (0.1, 10.0)
"""least and largest weight of a point by its distance, where a tolerance is to be met"""
WORTH = 0.4
"""gain for each parameter, of the best, from which a law grows too"""
FINER = 8
"""control points along the chord from which a thickness grows by a quarter at a time"""
SPARE = 4
"""samples along the chord beyond a thickness's control points"""
FEWEST = 3
"""control points of a thickness"""
MOST_SAMPLES, MOST_SPAN, MOST_CURVE = 60, 12, 12


@dataclass(frozen=True, kw_only=True)
class Step:
    """One law with more control points."""

    fields: tuple[str, ...]
    """beginnings of the paths that change"""
    structure: Structure
    parameters: int
    """that it adds"""

    @property
    def law(self) -> str:
        """The name of the first law in a structure."""
        name = self.fields[0].removeprefix("channel.")
        return "place" if self.fields[0] in _fields("place") else name


def steps_from(structure: Structure) -> list[Step]:
    """What may grow."""
    found = []
    for side, name in enumerate(THICKNESSES):
        count = structure.chordwise[side]
        more = _further(count)
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
            found.append(Step(fields=_fields(name), structure=wider, parameters=added))
    for name, count in structure.channel.items():
        if count < MOST_CURVE:
            wider = replace(structure, channel={**structure.channel, name: count + 1})
            found.append(Step(fields=(f"channel.{name}",), structure=wider, parameters=2))
    return found


def steps_back(structure: Structure) -> list[Step]:
    """What may shrink by one control point, and by how many parameters."""
    found = []
    for side, name in enumerate(THICKNESSES):
        if structure.chordwise[side] > FEWEST:
            counts = [*structure.chordwise]
            counts[side] -= 1
            narrower = replace(structure, chordwise=(counts[0], counts[1]))
            found.append(Step(fields=(name,), structure=narrower, parameters=structure.span.get(name, 1)))
    for name, count in structure.span.items():
        if count > 1:
            narrower = replace(structure, span={**structure.span, name: count - 1})
            left_out = structure.chordwise[THICKNESSES.index(name)] if name in THICKNESSES else 1
            found.append(Step(fields=_fields(name), structure=narrower, parameters=left_out))
    for name, count in structure.channel.items():
        if count > 2:
            narrower = replace(structure, channel={**structure.channel, name: count - 1})
            found.append(Step(fields=(f"channel.{name}",), structure=narrower, parameters=2))
    return found


def roomier(structure: Structure) -> Structure:
    """A structure that has all steps along the chord and the walls, where laws are stepped leaf by leaf."""
    chordwise = [count + _further(count) for count in structure.chordwise]
    samples = min(MOST_SAMPLES, max(structure.samples, max(chordwise) + SPARE))
    walls = {wall: min(structure.channel[wall] + 1, MOST_CURVE) for wall in ("hub", "shroud")}
    return replace(
        structure,
        chordwise=(min(chordwise[0], samples - SPARE), min(chordwise[1], samples - SPARE)),
        samples=samples,
        channel={**structure.channel, **walls},
    )


def _further(count: int) -> int:
    """By how many control points a thickness grows at a time."""
    return max(1, count // 4) if count >= FINER else 1


def _fields(name: str) -> tuple[str, ...]:
    return ("leading_edge_theta", "leading_edge_y") if name == "place" else (name,)


def joined(structure: Structure, steps: Sequence[Step]) -> Structure:
    """A structure with several steps taken at once."""
    chordwise = [max(step.structure.chordwise[side] for step in steps) for side in (0, 1)]
    span = {name: max(step.structure.span[name] for step in steps) for name in structure.span}
    channel = {name: max(step.structure.channel[name] for step in steps) for name in structure.channel}
    samples = max(step.structure.samples for step in steps)
    return replace(structure, chordwise=(chordwise[0], chordwise[1]), span=span, channel=channel, samples=samples)


def least(steps: Sequence[Step]) -> Structure:
    """The structure that several steps back lead to together."""
    structures = [step.structure for step in steps]
    chordwise = [min(each.chordwise[side] for each in structures) for side in (0, 1)]
    span = {name: min(each.span[name] for each in structures) for name in structures[0].span}
    channel = {name: min(each.channel[name] for each in structures) for name in structures[0].channel}
    return replace(structures[0], chordwise=(chordwise[0], chordwise[1]), span=span, channel=channel)


def emphasis_of(found: Found, aim: Aim) -> Reals | None:
    """Further weights (n,) by which points far off count more; none where no tolerance is asked for."""
    if aim.tolerance is None:
        return None
    return np.clip((found.state.feet.distances / aim.tolerance) ** 2, *EMPHASIS)


def roots_of(emphasis: Reals | None, count: int) -> Reals:
    """Factors (count,) of the rows of a least squares, of which those of the points, with their weights, come first."""
    roots = np.ones(count)
    if emphasis is not None:
        roots[: len(emphasis)] = np.sqrt(emphasis)
    return roots


def gains(found: Found, emphasis: Reals | None = None) -> list[tuple[float, Step]]:
    """What each step would take off the sum of squares, foreseen linearly, best for each parameter first.

    `emphasis` (n,) are further weights of the points. Laws that are not free do not grow.
    """
    problem = found.problem
    rows = problem.measures.residuals(found.state)
    slopes = problem.measures.slopes(found.state, problem.paths) * problem.scales.size
    roots = roots_of(emphasis, len(rows))
    before = left_after(slopes, rows, roots, problem.noise)
    result = [
        (before - left_after(wider, rows, roots, problem.noise), step)
        for step, _, wider in _stepped(found, slopes, steps_from(structure_of(found.design)))
    ]
    return sorted(result, key=lambda pair: -pair[0] / pair[1].parameters)


def losses(found: Found) -> list[tuple[float, Step]]:
    """What each step back would leave of the sum of squares, foreseen linearly, least for each parameter first."""
    problem = found.problem
    slopes = problem.measures.slopes(found.state, problem.paths) * problem.scales.size
    roots = np.ones(len(slopes))
    result = [
        (left_after(narrower, rows, roots, problem.noise), step)
        for step, rows, narrower in _stepped(found, slopes, steps_back(structure_of(found.design)))
    ]
    return sorted(result, key=lambda pair: pair[0] / pair[1].parameters)


def _stepped(found: Found, slopes: Reals, steps: Sequence[Step]) -> Iterator[tuple[Step, Reals, Reals]]:
    """The steps of laws that are free, with the residuals after each and their derivatives (m, k)."""
    paths = found.problem.paths
    for step in steps:
        own = [path for path in found.design.parameters() if path.startswith(step.fields)]
        if not set(own) <= set(paths):
            continue
        kept = [i for i, path in enumerate(paths) if path not in own]
        try:
            rows, columns = _at(found, step)
        except DesignError:
            continue
        yield step, rows, np.concatenate([slopes[:, kept], columns], axis=1)


def left_after(slopes: Reals, rows: Reals, roots: Reals, noise: float) -> float:
    """The sum of squares of rows (n,) weighed by roots (n,) after the linear step that makes it least.

    `slopes` (n, k) are by scaled parameters, which are held by the spread `noise` of the prior.
    """
    count = slopes.shape[1]
    triangle = np.linalg.qr(np.column_stack([slopes * roots[:, None], rows * roots]), mode="r")
    held = np.zeros((count, count + 1))
    held[:, :-1] = noise * np.eye(count)
    # the last diagonal entry is what no step takes away
    left = np.asarray(np.linalg.qr(np.vstack([np.asarray(triangle), held]), mode="r"))[-1, -1]
    return float(left**2)


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


def _at(found: Found, step: Step) -> tuple[Reals, Reals]:
    """Residuals after a step, and their derivatives by the parameters of its law, where the cloud stands now."""
    other = reshaped(found.design, step.structure)
    paths = tuple(path for path in other.parameters() if path.startswith(step.fields))
    measures, on = found.problem.measures, found.state.feet
    shape = measures.model.shape(other)
    if not shape.finite:
        raise DesignError("a law with another number of control points left no shape: take another one")
    state = State(shape=shape, feet=placed(measures.points, shape.sides, on.side, on.u, on.v))
    rows = measures.residuals(state)
    if not paths:
        # a wall between its corners alone
        return rows, np.zeros((len(rows), 0))
    return rows, measures.slopes(state, paths) * scales_of(other, paths, found.model.chord).size
