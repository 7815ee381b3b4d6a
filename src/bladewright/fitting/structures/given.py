"""The match of a structure that is given: of an exact cloud the design that it was drawn from."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bladewright.designs import Design
from bladewright.errors import FitError
from bladewright.fitting.clouds.thinning import drawn
from bladewright.fitting.matching.search import ROUGH, ROUNDS, Found, Task, searched
from bladewright.fitting.structures.aim import NOISY
from bladewright.fitting.structures.identification import EXACT, tried
from bladewright.fitting.structures.reshaping import reshaped
from bladewright.fitting.structures.structure import Structure, structure_of
from bladewright.section.unified import UnifiedSection

FIRST = 3e-3
"""noise of the first round where the start is a guess, of the chord"""
QUICK = 2
"""rounds of a first search"""
WEAK = 0.1
"""strength of the prior where a match is only made better, of the usual"""
QUIET, CLEAR = 0.1, 0.5
"""part of the misfit that is noise up to which a cloud may be exact, after a quick search and after a thorough one"""
TURNS, NEARER = 3, 0.5
"""turns in which an exact design is sought, and ratio of the misfits of the two searches from which there is another"""
FURTHER_ROUNDS = 20
"""rounds in which a given structure is sought in a cloud that may be exact"""
EDGES, ENDS = (0.03, 0.9), 0.02
"""places in u before and after which points tell of the edges, and in v of the ends"""
NEAR = 1e-6
"""misfit of those points from which all are asked, of the chord"""
TELLING, OTHERS = 2500, 1000
"""points with which an exact design is sought: of those that tell of edges and ends, and of all"""


def structured(few: Task, many: Task, first: Design, base: Structure | None, *, guessed: bool) -> Found:
    """The match with the structure of a first design, or with that of `base`; that of some points comes first."""
    found = searched(few, first, noise=FIRST if guessed else None, rounds=ROUNDS if base is None else QUICK)
    if guessed and isinstance(first, UnifiedSection) and found.rms > EXACT and misses(found):
        other = tried(few, first, [structure_of(first)])
        if other is not None:
            nearer = min((found, other), key=lambda each: each.rms)
            found = replace(nearer, interrupted=other.interrupted)
    if base is not None and structure_of(found.design) != base and not found.interrupted:
        found = leaner(few, found, base)
    if found.interrupted:
        return found
    found = searched(many, found.design) if base is None or not guessed else _sought(many, found)
    if found.rms < EXACT and not np.all(found.scatter.inliers) and not found.interrupted:
        # points past the ends of an exact match are none, if it can be widened to hold them too
        whole = searched(replace(many, outlying=False), found.design)
        found = whole if whole.rms < EXACT else found
    return _told_by_points(many, found)


def _sought(task: Task, found: Found) -> Found:
    """The match with all points, or the exact design, which is sought by turns with and without what seems to lie off.

    Where the one search stands still the other may go on: a wrong foot holds the first, a short edge the second.
    """
    most = QUIET
    for _ in range(TURNS):
        exact = _exact(task, found, most)
        if exact is not None and (exact.rms < EXACT or exact.interrupted):
            return exact
        before = np.inf if exact is None else exact.rms
        start = exact or found
        found = searched(task, start.design)
        found = replace(found, evaluations=start.evaluations + found.evaluations)
        if found.interrupted or found.rms < EXACT or found.rms > NEARER * before or (exact is None and most > QUIET):
            break
        most = CLEAR
    return found


def _exact(task: Task, found: Found, most: float) -> Found | None:
    """The exact design near one, or the same where none is nearer; None where the cloud is not exact.

    Such a cloud has no outliers, and edges and ends that are not yet found look like some. The noise is `most` of its
    misfit at most.
    """
    every = searched(task, found.design, rounds=0)
    if not misses(every, most):
        return None
    exact_task = replace(task, outlying=False)
    exact = searched(exact_task.part(_telling(every)), found.design, noise=FIRST, rounds=FURTHER_ROUNDS)
    evaluations = found.evaluations + exact.evaluations
    if exact.rms < NEAR and not exact.interrupted:
        exact = searched(exact_task, exact.design)
        evaluations += exact.evaluations
    return replace(exact if exact.interrupted or exact.rms < every.rms else found, evaluations=evaluations)


def _telling(found: Found) -> NDArray[np.intp]:
    """Points that tell of edges and ends, which few points of a cloud may leave open, and some of all."""
    on = found.state.feet
    beside = (on.u < EDGES[0]) | (on.u > EDGES[1]) | (on.v < ENDS) | (on.v > 1.0 - ENDS)
    rows = np.flatnonzero(beside)
    return np.union1d(rows[drawn(len(rows), TELLING)], drawn(len(on.u), OTHERS))


def misses(found: Found, most: float = np.inf) -> bool:
    """Whether a search came to its end at a misfit that is no noise, and of which the noise is `most` at most."""
    quiet = found.scatter.noise < most * found.rms * found.model.chord
    return quiet and found.scatter.shared > NOISY and not found.interrupted


def leaner(task: Task, found: Found, base: Structure) -> Found:
    """A match with the structure from which to grow, or the one before where its laws leave no shape so."""
    try:
        return searched(task, reshaped(found.design, base), noise=FIRST, rounds=2 * QUICK, slight=ROUGH)
    except FitError:
        return found


def _told_by_points(task: Task, found: Found) -> Found:
    """A match whose misfit is noise, with a prior so weak that it does not shift what the points determine."""
    if found.interrupted or found.scatter.shared > NOISY:
        return found
    weak = searched(replace(task, smooth=WEAK), found.design, rounds=2)
    return replace(weak, evaluations=found.evaluations + weak.evaluations)
