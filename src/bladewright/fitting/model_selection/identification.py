"""The section that an exact cloud was drawn from: other numbers of control points and other first cambers are tried."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from bladewright.derivatives.patterns import matching
from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.matching.search import Match, Task, searched
from bladewright.fitting.model_selection.reshaping import reshaped, with_feasible_edges
from bladewright.fitting.model_selection.structure import Structure, structure_of
from bladewright.section.unified import UnifiedSection
from bladewright.section.unified_limits import TANGENTS

PLAIN_TANGENT = 0.35
"""tangent length of a camber that is as plain as it can be, of the meridional length"""
TURNING_RATIO = 0.6
"""turning from one edge to the chord, of that from the chord to the other edge, by which one edge predicts the
other."""
STRAIGHT_CAMBER = {"tangent_*": (0.12, 1.0)}
"""bounds while a guess is far off: shorter tangents let the camber reach an edge by a hook (design/fit_made.md)."""


def trial_cambers(design: UnifiedSection, free: Callable[[Design], tuple[str, ...]]) -> list[UnifiedSection]:
    """A section with equal turning at both edges, as it is, and with either edge predicted by the other.

    An edge's direction shows in few points, and a search may end at a wrong one. What is not free stays.
    """
    into, out = design.metal_angle_in - design.stagger, design.metal_angle_out - design.stagger
    alike = (into - out) / 2.0
    changes: list[dict[str, float]] = [
        {"metal_angle_in": alike, "tangent_in": PLAIN_TANGENT, "metal_angle_out": -alike, "tangent_out": PLAIN_TANGENT},
        {},
        {"metal_angle_out": -TURNING_RATIO * into, "tangent_out": PLAIN_TANGENT},
        {"metal_angle_in": -out / TURNING_RATIO, "tangent_in": PLAIN_TANGENT},
    ]
    changeable = set(free(design))
    found = []
    for change in changes:
        turned = {name: value + (design.stagger if "angle" in name else 0.0) for name, value in change.items()}
        kept = {name: value for name, value in turned.items() if name in changeable and abs(value) < 88.0}
        found.append(design.changed(kept))
    return found


TRIAL_COUNTS = ((7, 7), (6, 6), (7, 6), (6, 7))
"""control points of both thicknesses that are tried: laws of 7 contain those of 3, 4 and 5, laws of 6 those of 3 and 4
(design/fit_made.md)."""
FEWEST_THICKNESSES = 3
"""control points of a thickness at least"""
TRIAL_POINTS = 1200
"""points of a trial"""
TRIAL_NOISE = 3e-3
"""noise of a trial's first round, of the chord"""
TRIAL_ROUNDS, FURTHER_ROUNDS = 6, 10
"""rounds of every trial, and of one that gets near (`FURTHER_ROUNDS`)"""
PROMISING_MISFIT = 3e-6
"""misfit from which a trial goes on, of the chord"""
IDENTIFIED_MISFIT = 1e-9
"""misfit at which the section is known, of the chord. A limit of 1e-10 would have refused sections that are found
within 1e-9 (design/fit_made.md)."""
SAME_THICKNESS = 1e-6
"""relative difference by which a thickness with fewer control points may differ and still be the same."""


def identified_section(task: Task, first: UnifiedSection) -> Match | None:
    """The match with the numbers of control points that a cloud was drawn with; None where there is none."""
    structure = structure_of(first)
    structures = [replace(structure, chordwise=counts) for counts in TRIAL_COUNTS]
    found = nearest_trial(task, first, structures)
    if found is None or not (found.rms < IDENTIFIED_MISFIT or found.interrupted):
        return None
    plain = plainest(found.design)
    return found if plain is found.design or found.interrupted else searched(task, plain, rounds=FURTHER_ROUNDS)


def nearest_trial(task: Task, first: UnifiedSection, structures: Sequence[Structure]) -> Match | None:
    """The nearest match from several first cambers in each of some structures; the first one that is exact."""
    few = task.thinned(TRIAL_POINTS)
    best: Match | None = None
    evaluations = 0
    for bounded, start in _starts(few, first, structures):
        try:
            found = searched(bounded, start, noise=TRIAL_NOISE, rounds=TRIAL_ROUNDS)
            if IDENTIFIED_MISFIT < found.rms < PROMISING_MISFIT and not found.interrupted:
                found = searched(replace(few, allow_outliers=False), found.design, rounds=FURTHER_ROUNDS)
        except FitError:
            continue
        evaluations += found.evaluations
        if best is None or found.rms < best.rms:
            best = found
        if found.interrupted:
            best = replace(best, interrupted=True)
        if best.rms < IDENTIFIED_MISFIT or best.interrupted:
            break
    return None if best is None else replace(best, evaluations=evaluations)


def _starts(task: Task, first: UnifiedSection, structures: Sequence[Structure]) -> Iterator[tuple[Task, Design]]:
    # an exact cloud has no outliers, and an edge that is not yet found looks like some
    task = replace(task, allow_outliers=False)
    own = any(map(_of_tangents, task.bounds))
    straight = task if own else replace(task, bounds={**task.bounds, **STRAIGHT_CAMBER})
    designs = trial_cambers(first, task.free)
    for structure in structures:
        yield from ((straight, with_feasible_edges(reshaped(design, structure))) for design in designs)


def _of_tangents(pattern: str) -> bool:
    try:
        return bool(matching(pattern, TANGENTS))
    except DesignError:
        return False


def plainest(design: Design) -> Design:
    """The same section with as few control points of each thickness as can represent it."""
    found = design
    structure = structure_of(design)
    for side in (0, 1):
        for count in range(FEWEST_THICKNESSES, structure.chordwise[side]):
            counts = [*structure_of(found).chordwise]
            counts[side] = count
            fewer = reshaped(found, replace(structure, chordwise=(counts[0], counts[1])))
            again = reshaped(fewer, structure)
            values, others = (np.array([*each.parameters().values()]) for each in (design, again))
            if np.all(np.abs(others - values) <= SAME_THICKNESS * np.abs(values)):
                found = fewer
                break
    return found
