"""The structure of a design as its cloud asks for it: control points are added until a target is reached."""

from dataclasses import replace

import numpy as np

from bladewright.designs import Design
from bladewright.errors import DesignError
from bladewright.fitting.clouds.cloud import is_rounded
from bladewright.fitting.free_parameters import corner_radii
from bladewright.fitting.matching.search import MOST_ROUNDS, ROUGH_REDUCTION, Match, Task, searched
from bladewright.fitting.model_selection.best_structure import best_match_of_size, smallest_match
from bladewright.fitting.model_selection.given_structure import (
    GUESS_NOISE,
    QUICK_NOISE_SHARE,
    QUICK_ROUNDS,
    has_systematic_misfit,
    matched_structure,
    reduced_to,
)
from bladewright.fitting.model_selection.growth import gained_little, grown_match, with_grown_thickness
from bladewright.fitting.model_selection.identification import identified_section
from bladewright.fitting.model_selection.reshaping import reshaped, with_feasible_edges
from bladewright.fitting.model_selection.steps import FEWEST_THICKNESSES
from bladewright.fitting.model_selection.stopping import NOISE_CORRELATION, MatchTarget, needs_more
from bladewright.fitting.model_selection.structure import Structure, structure_of
from bladewright.fitting.model_selection.tolerance import match_within_tolerance
from bladewright.fitting.models.law_jacobian import stands_on_channel
from bladewright.numerics.least_squares import MIN_REDUCTION
from bladewright.section.unified import UnifiedSection

RESTART_NOISE = 0.03
"""noise assumed when a match of a section is searched once more from where it ended, of the chord: as if little were
known."""
FINEST_RESTART = 1e-6
"""misfit, of that noise, below which a match is not searched once more: it is the minimum."""
FINAL_REDUCTION = 1e-3
"""predicted relative reduction of the cost that a step of the last search needs, where the cloud is not taken for
exact."""
QUICK_POINTS, THOROUGH_POINTS = {2: 2500, 3: 1000}, 12_000
"""points of a quick search, by dimension, and of a thorough one (`THOROUGH_POINTS`): time is proportional to them."""
TOLERANCE_POINTS = 2500
"""points with which a blade grows towards a tolerance, which needs every row of them."""
REFUSED_MARGIN = 30.0
"""factor of the margin of edge radii once a design that searches allow is refused when built."""
COMPACT_RMS = 0.5
"""root mean square distance, of a tolerance, of the match from which a blade grows towards it: smaller values start
with more parameters."""
NEARLY_WITHIN = (0.3, 0.02)
"""root mean square distance, of a tolerance, and share of the points beyond it, with which points are reweighted rather
than control points added."""
GROWTH_GAIN = 0.7
"""ratio of misfits with which a match that had settled goes on growing."""
MOST_GROWTHS = 40
"""times that control points are added at most; it bounds the time."""
ROW_SPREAD = 1e-3
"""spread of the points at an end below which they stand in a row on the wall, of the chord."""
CORNERS_HELD_NOTE = (
    "the radii of the channel's corners are read off the points at hub and shroud, held, and not counted"
)
"""note where the channel's corners are read off the points (design/matches.md)"""


def selected_match(
    task: Task, first: Design, target: MatchTarget, *, base: Structure | None, guessed: bool
) -> tuple[Match, str]:
    """The match, and why it ends where no target is met.

    `first` is a first design, a guess or a start; `base` the structure from which to grow, where it is not that of
    `first`.
    """
    few = task.thinned(QUICK_POINTS[task.dimension])
    several, many = (task.thinned(most) for most in (TOLERANCE_POINTS, THOROUGH_POINTS))
    noise = GUESS_NOISE if guessed else None
    if target.structured and target.tolerance is None:
        return matched_structure(few, many, first, base, guessed=guessed), ""
    found = searched(
        few,
        first,
        noise=noise,
        rounds=2 * QUICK_ROUNDS if base is None else QUICK_ROUNDS,
        min_reduction=ROUGH_REDUCTION,
    )
    exact = guessed and target.open and not is_rounded(task.points)
    if exact and isinstance(first, UnifiedSection) and has_systematic_misfit(found, QUICK_NOISE_SHARE):
        known = identified_section(few, first)
        if known is not None:
            return (known if known.interrupted else searched(many, known.design)), ""
    standing, everything = target.parameters is not None and _ends_in_rows(found), few
    if standing:
        few, many = _with_corners_held(few), _with_corners_held(many)
    found, reason = _match_for_target(few, several, found, target, base, guessed=guessed)
    if standing:
        reason = CORNERS_HELD_NOTE
        found = (
            found if found.interrupted else searched(everything, found.design, rounds=1, min_reduction=ROUGH_REDUCTION)
        )
    if found.interrupted:
        return found, reason
    rounds = MOST_ROUNDS
    if task.dimension == 3 and not target.open:
        # growth to a tolerance has weighted points by their distances, as the search that follows will
        rounds = QUICK_ROUNDS if target.tolerance is None else 0
    if task.dimension == 3 and not target.open and _refused(found):
        many = replace(many, margin_factor=REFUSED_MARGIN * many.margin_factor)
    found = searched(many, found.design, rounds=rounds, min_reduction=MIN_REDUCTION if target.open else FINAL_REDUCTION)
    if guessed and task.dimension == 2:
        found = _restarted(many, found)
    elif guessed and target.open:
        found = _grown_further(several, many, found, target)
    if target.tolerance is not None and (not reason or found.noise_estimate.correlation >= NOISE_CORRELATION):
        found = match_within_tolerance(many, found, target, target.tolerance)
        reason = reason if found.maximum > target.tolerance else ""
    return found, reason


def _match_for_target(
    task: Task, several: Task, match: Match, target: MatchTarget, base: Structure | None, *, guessed: bool
) -> tuple[Match, str]:
    """A match with as many control points as the target asks for, by forecasts or growth, or why not."""
    solid = guessed and task.dimension == 3 and stands_on_channel(match.design) and not match.interrupted
    if solid and target.parameters is not None:
        chosen = best_match_of_size(task, match, target.parameters)
        if chosen is not None:
            return chosen, ""
    if solid and target.tolerance is not None:
        if match.rms * match.model.chord > target.tolerance:
            match = best_match_of_size(task, match, len(match.problem.paths)) or match
        if match.rms * match.model.chord < COMPACT_RMS * target.tolerance:
            match = smallest_match(task, match, COMPACT_RMS * target.tolerance) or match
        if not match.interrupted:
            task = several
            measured = searched(task, match.design, rounds=0)
            match = replace(measured, evaluations=measured.evaluations + match.evaluations)
    elif solid:
        # forecasts are linear: they are truer the nearer a match is
        match = searched(task, match.design, noise=match.rms, min_reduction=ROUGH_REDUCTION)
        match = best_match_of_size(task, match, len(match.problem.paths)) or match
    elif base is not None and not match.interrupted and _has_spare_parameters(match, target):
        match = reduced_to(task, match, base)
    return _grown_to_target(task, match, target)


def _grown_to_target(task: Task, match: Match, target: MatchTarget) -> tuple[Match, str]:
    """A match with as many control points as the target asks for, or why there are no more."""
    reason = ""
    for _ in range(MOST_GROWTHS):
        if match.interrupted:
            return match, ""
        short, reason = needs_more(match, target, task)
        if not short or _nearly_within_tolerance(match, target):
            break
        before = match.rms
        match, grew = grown_match(task, match, target)
        if not grew:
            match, grew = with_grown_thickness(task, match, target)
        if not grew or gained_little(task, match, target, before):
            break
    if target.parameters is not None and task.dimension == 2:
        match = _thickness_shared_out(task, match)
    return match, reason


def _grown_further(several: Task, many: Task, match: Match, target: MatchTarget) -> Match:
    """A match that grows on after it settled at a systematic misfit: the nearer it is, the truer are forecasts."""
    while has_systematic_misfit(match):
        more, grew = grown_match(several, match, target)
        if not grew:
            break
        fresh = more if more.interrupted else searched(many, more.design)
        if fresh.misfit > GROWTH_GAIN * match.misfit:
            return replace(match, interrupted=fresh.interrupted)
        match = fresh
    return match


def _nearly_within_tolerance(match: Match, target: MatchTarget) -> bool:
    """Whether all but a few points of a blade keep a tolerance: reweighting these may be enough."""
    footpoints = match.state.footpoints
    if (
        target.tolerance is None
        or footpoints.points.shape[1] == 2
        or match.rms * match.model.chord > NEARLY_WITHIN[0] * target.tolerance
    ):
        return False
    return bool(np.mean(footpoints.distances[match.rows] > target.tolerance) < NEARLY_WITHIN[1])


def _thickness_shared_out(task: Task, match: Match) -> Match:
    """The best of the ways to share a section's thickness control points between its sides."""
    for way in (1, -1):
        while not match.interrupted:
            structure = structure_of(match.design)
            upper, lower = structure.chordwise[0] + way, structure.chordwise[1] - way
            if min(upper, lower) < FEWEST_THICKNESSES:
                break
            design = with_feasible_edges(reshaped(match.design, replace(structure, chordwise=(upper, lower))))
            other = searched(task, design, rounds=QUICK_ROUNDS + 1, noise=match.rms, min_reduction=ROUGH_REDUCTION)
            evaluations = match.evaluations + other.evaluations
            if not (other.rms < match.rms or other.interrupted):
                match = replace(match, evaluations=evaluations)
                break
            match = replace(other, evaluations=evaluations)
    return match


def _restarted(task: Task, match: Match) -> Match:
    """The better of a match and of one searched again from it with little trust: an edge may be in a wrong place."""
    if match.interrupted or match.rms < RESTART_NOISE * FINEST_RESTART:
        return match
    other = searched(task, match.design, noise=RESTART_NOISE)
    # over all points: a match that takes more of them for outliers is no nearer (design/matches.md)
    nearer = other if other.mean_distance < match.mean_distance and other.rms < match.rms else match
    evaluations = match.evaluations + other.evaluations
    return replace(nearer, evaluations=evaluations, interrupted=other.interrupted)


def _refused(match: Match) -> bool:
    """Whether a design that searches allow is refused when it is built: its edge radii need a larger margin."""
    try:
        match.design.build()
    except DesignError:
        return True
    return False


def _ends_in_rows(match: Match) -> bool:
    """Whether rows of points show where hub and shroud are."""
    walls = match.ends.walls
    return len(walls) == 2 and all(wall.spread < ROW_SPREAD * match.model.chord for wall in walls.values())


def _with_corners_held(task: Task) -> Task:
    """A task that holds the radii of the channel's corners."""
    return replace(task, free=lambda design: tuple(p for p in task.free(design) if p not in corner_radii(design)))


def _has_spare_parameters(match: Match, target: MatchTarget) -> bool:
    """Whether a first design has more parameters than its cloud may need, or than are asked for."""
    if target.tolerance is not None and match.rms * match.model.chord > target.tolerance:
        return False
    return target.parameters is None or len(match.problem.paths) > target.parameters
