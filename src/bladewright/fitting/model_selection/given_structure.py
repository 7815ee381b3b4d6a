"""The match of a structure that is given: of an exact cloud the design that it was drawn from."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bladewright.designs import Design
from bladewright.errors import FitError
from bladewright.fitting.clouds.thinning import random_subset
from bladewright.fitting.matching.search import MOST_ROUNDS, ROUGH_REDUCTION, Match, Task, searched
from bladewright.fitting.model_selection.identification import IDENTIFIED_MISFIT, nearest_trial
from bladewright.fitting.model_selection.reshaping import reshaped
from bladewright.fitting.model_selection.stopping import NOISE_CORRELATION
from bladewright.fitting.model_selection.structure import Structure, structure_of
from bladewright.section.unified import UnifiedSection

GUESS_NOISE = 3e-3
"""noise of the first round where the start is a guess, of the chord."""
QUICK_ROUNDS = 2
"""rounds of a first search"""
WEAK_REGULARISATION = 0.1
"""factor of the regularisation where a match is only improved."""
QUICK_NOISE_SHARE, THOROUGH_NOISE_SHARE = 0.1, 0.5
"""share of the misfit that is noise up to which a cloud may be exact, after a quick search (`QUICK_NOISE_SHARE`) and
after a thorough one (`THOROUGH_NOISE_SHARE`). In noisier clouds no exact design is searched, which saves time
(design/fit_made.md)."""
EXACT_TURNS, EXACT_GAIN = 3, 0.5
"""turns in which an exact design is sought; `EXACT_GAIN` is the ratio of the misfits of two searches from which there
is another turn."""
FURTHER_ROUNDS = 20
"""rounds of the search for a given structure in a cloud that may be exact"""
EDGE_BANDS, END_BAND = (0.03, 0.9), 0.02
"""places in u before and after which points show the edges, and distance in v within which they show the ends
(`END_BAND`)"""
NEARLY_EXACT = 1e-6
"""misfit of those points from which all points are used, of the chord."""
EDGE_POINTS, OTHER_POINTS = 2500, 1000
"""points with which an exact design is sought: of those that show edges and ends, and of all (`OTHER_POINTS`). A
thousand points of Rotor 67 without most of its trailing edge left that edge 4e-3 of the chord too long
(design/fit_made.md)."""


def matched_structure(few: Task, many: Task, first: Design, base: Structure | None, *, guessed: bool) -> Match:
    """The match with the structure of a first design or of `base`; some of the points are matched first."""
    found = searched(
        few, first, noise=GUESS_NOISE if guessed else None, rounds=MOST_ROUNDS if base is None else QUICK_ROUNDS
    )
    if guessed and isinstance(first, UnifiedSection) and found.rms > IDENTIFIED_MISFIT and has_systematic_misfit(found):
        other = nearest_trial(few, first, [structure_of(first)])
        if other is not None:
            nearer = min((found, other), key=lambda each: each.rms)
            found = replace(nearer, interrupted=other.interrupted)
    if base is not None and structure_of(found.design) != base and not found.interrupted:
        found = reduced_to(few, found, base)
    if found.interrupted:
        return found
    found = searched(many, found.design) if base is None or not guessed else _exact_or_nearest(many, found)
    if found.rms < IDENTIFIED_MISFIT and not np.all(found.noise_estimate.inliers) and not found.interrupted:
        # points past the ends of an exact match are no outliers if it can be extended to hold them too
        whole = searched(replace(many, allow_outliers=False), found.design)
        found = whole if whole.rms < IDENTIFIED_MISFIT else found
    return _weakly_regularised(many, found)


def _exact_or_nearest(task: Task, match: Match) -> Match:
    """The match with all points, or the exact design, sought in turns with and without apparent outliers.

    Where one search stands still the other may go on: a wrong footpoint stops the first, a short edge the second.
    """
    most = QUICK_NOISE_SHARE
    for _ in range(EXACT_TURNS):
        exact = _exact_match(task, match, most)
        if exact is not None and (exact.rms < IDENTIFIED_MISFIT or exact.interrupted):
            return exact
        before = np.inf if exact is None else exact.rms
        start = exact or match
        match = searched(task, start.design)
        match = replace(match, evaluations=start.evaluations + match.evaluations)
        if (
            match.interrupted
            or match.rms < IDENTIFIED_MISFIT
            or match.rms > EXACT_GAIN * before
            or (exact is None and most > QUICK_NOISE_SHARE)
        ):
            break
        most = THOROUGH_NOISE_SHARE
    return match


def _exact_match(task: Task, match: Match, most: float) -> Match | None:
    """The exact design near one, or that one where none is nearer; None where the cloud is not exact.

    Such a cloud has no outliers, but edges and ends that are not yet found look like some. `most` is the largest share
    of the misfit that is noise.
    """
    every = searched(task, match.design, rounds=0)
    if not has_systematic_misfit(every, most):
        return None
    exact_task = replace(task, allow_outliers=False)
    exact = searched(
        exact_task.part(_informative_points(every)), match.design, noise=GUESS_NOISE, rounds=FURTHER_ROUNDS
    )
    evaluations = match.evaluations + exact.evaluations
    if exact.rms < NEARLY_EXACT and not exact.interrupted:
        exact = searched(exact_task, exact.design)
        evaluations += exact.evaluations
    return replace(exact if exact.interrupted or exact.rms < every.rms else match, evaluations=evaluations)


def _informative_points(match: Match) -> NDArray[np.intp]:
    """Points that show edges and ends, which few points of a cloud show, and some of all."""
    footpoints = match.state.footpoints
    at_edge = (
        (footpoints.u < EDGE_BANDS[0])
        | (footpoints.u > EDGE_BANDS[1])
        | (footpoints.v < END_BAND)
        | (footpoints.v > 1.0 - END_BAND)
    )
    rows = np.flatnonzero(at_edge)
    return np.union1d(rows[random_subset(len(rows), EDGE_POINTS)], random_subset(len(footpoints.u), OTHER_POINTS))


def has_systematic_misfit(match: Match, most: float = np.inf) -> bool:
    """Whether a search ended at a misfit that is not noise, of which noise is at most the share `most`."""
    quiet = match.noise_estimate.noise < most * match.rms * match.model.chord
    return quiet and match.noise_estimate.correlation > NOISE_CORRELATION and not match.interrupted


def reduced_to(task: Task, match: Match, base: Structure) -> Match:
    """A match with the structure to grow from, or the one before where its laws leave no shape so."""
    try:
        return searched(
            task,
            reshaped(match.design, base),
            noise=GUESS_NOISE,
            rounds=2 * QUICK_ROUNDS,
            min_reduction=ROUGH_REDUCTION,
        )
    except FitError:
        return match


def _weakly_regularised(task: Task, match: Match) -> Match:
    """A match whose misfit is noise, regularised so weakly that what points determine is not shifted."""
    if match.interrupted or match.noise_estimate.correlation > NOISE_CORRELATION:
        return match
    weak = searched(replace(task, regularisation_factor=WEAK_REGULARISATION), match.design, rounds=2)
    return replace(weak, evaluations=match.evaluations + weak.evaluations)
