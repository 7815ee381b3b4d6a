"""The section that an exact cloud was drawn from: other numbers of control points and other first cambers are tried."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from bladewright.derivatives.patterns import matching
from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.clouds.thinning import drawn
from bladewright.fitting.matching.search import Found, Task, searched
from bladewright.fitting.structures.cambers import STRAIGHT, cambers
from bladewright.fitting.structures.opening import opened
from bladewright.fitting.structures.reshaping import reshaped
from bladewright.fitting.structures.structure import Structure, structure_of
from bladewright.section.limits import TANGENTS
from bladewright.section.unified import UnifiedSection

COUNTS = ((7, 7), (6, 6), (7, 6), (6, 7))
"""control points of both thicknesses that are tried: laws of 7 hold those of 3, 4 and 5, laws of 6 those of 3 and 4"""
FEWEST = 3
FEW = 1200
"""points of a trial"""
FIRST = 3e-3
"""noise of its first round, of the chord"""
ROUNDS, FURTHER = 6, 10
"""rounds of every trial, and of one that gets near"""
NEAR = 3e-6
"""misfit from which a trial goes on, of the chord"""
EXACT = 1e-9
"""misfit at which the section is known, of the chord"""
SAME = 1e-6
"""part of a thickness by which one with fewer control points may differ and still be the same"""


def identified(task: Task, first: UnifiedSection) -> Found | None:
    """The match with the numbers of control points that a cloud was drawn with; None where there is no such."""
    structure = structure_of(first)
    structures = [replace(structure, chordwise=counts) for counts in COUNTS]
    found = tried(task, first, structures)
    if found is None or not (found.rms < EXACT or found.interrupted):
        return None
    plain = plainest(found.design)
    return found if plain is found.design or found.interrupted else searched(task, plain, rounds=FURTHER)


def tried(task: Task, first: UnifiedSection, structures: Sequence[Structure]) -> Found | None:
    """The nearest match from several first cambers in each of some structures; the first one that is exact."""
    few = task.part(drawn(len(task.points), FEW))
    best: Found | None = None
    evaluations = 0
    for bounded, start in _starts(few, first, structures):
        try:
            found = searched(bounded, start, noise=FIRST, rounds=ROUNDS)
            if EXACT < found.rms < NEAR and not found.interrupted:
                found = searched(replace(few, outlying=False), found.design, rounds=FURTHER)
        except FitError:
            continue
        evaluations += found.evaluations
        if best is None or found.rms < best.rms:
            best = found
        if found.interrupted:
            best = replace(best, interrupted=True)
        if best.rms < EXACT or best.interrupted:
            break
    return None if best is None else replace(best, evaluations=evaluations)


def _starts(task: Task, first: UnifiedSection, structures: Sequence[Structure]) -> Iterator[tuple[Task, Design]]:
    # an exact cloud has none, and a nose that is not yet found looks like some
    task = replace(task, outlying=False)
    own = any(map(_of_tangents, task.bounds))
    straight = task if own else replace(task, bounds={**task.bounds, **STRAIGHT})
    designs = cambers(first, task.free)
    for structure in structures:
        yield from ((straight, opened(reshaped(design, structure))) for design in designs)


def _of_tangents(pattern: str) -> bool:
    try:
        return bool(matching(pattern, TANGENTS))
    except DesignError:
        return False


def plainest(design: Design) -> Design:
    """The same section with as few control points of each thickness as hold it."""
    found = design
    structure = structure_of(design)
    for side in (0, 1):
        for count in range(FEWEST, structure.chordwise[side]):
            counts = [*structure_of(found).chordwise]
            counts[side] = count
            fewer = reshaped(found, replace(structure, chordwise=(counts[0], counts[1])))
            again = reshaped(fewer, structure)
            values, others = (np.array([*each.parameters().values()]) for each in (design, again))
            if np.all(np.abs(others - values) <= SAME * np.abs(values)):
                found = fewer
                break
    return found
