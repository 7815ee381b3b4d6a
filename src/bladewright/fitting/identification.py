"""The numbers of control points that a section was made with, where its cloud is exact enough to tell."""

from dataclasses import replace

from bladewright.errors import FitError
from bladewright.fitting.reshaping import reshaped
from bladewright.fitting.search import Found, Task, searched
from bladewright.fitting.structure import structure_of

COUNTS = range(3, 9)
"""control points of a thickness that are tried"""
SWEEPS = 2
ROUNDS = 6
EXACT = 1e-9
"""misfit at which the numbers are known, of the chord"""


def identified(task: Task, found: Found) -> Found:
    """The nearest match among those with other numbers of control points of the one and the other thickness.

    The sides' misfits add up, so that each side's number is found apart from the other's.
    """
    for _ in range(SWEEPS):
        before = found
        for side in (0, 1):
            found = min((found, *_others(task, found, side)), key=lambda each: each.rms)
            if found.rms < EXACT or found.interrupted:
                return found
        if found is before:
            break
    return found


def _others(task: Task, found: Found, side: int) -> list[Found]:
    tried: list[Found] = []
    structure = structure_of(found.design)
    for count in COUNTS:
        counts = [*structure.chordwise]
        if count == counts[side] or found.interrupted:
            continue
        counts[side] = count
        other = reshaped(found.design, replace(structure, chordwise=(counts[0], counts[1])))
        try:
            fresh = searched(task, other, rounds=ROUNDS)
        except FitError:
            continue
        tried.append(replace(fresh, evaluations=fresh.evaluations + found.evaluations))
        if fresh.rms < EXACT or fresh.interrupted:
            break
    return tried
