"""From a first design to a match: a first search, a rich structure, the fewest control points that keep what is asked.

What the points do not determine then is held, and a last search takes more points.
"""

from contextlib import suppress
from dataclasses import dataclass, replace

from bladewright.designs import Design
from bladewright.errors import FitError
from bladewright.fitting.assessment.acceptance import MatchTarget, trusted_distance
from bladewright.fitting.assessment.estimates import undetermined_parameters
from bladewright.fitting.free_parameters import corner_radii
from bladewright.fitting.matching.search import (
    QUICK_ROUNDS,
    ROUGH_REDUCTION,
    Match,
    Task,
    evaluated,
    has_systematic_misfit,
    is_refused,
    searched,
    without_false_outliers,
)
from bladewright.fitting.model_selection.elimination import reweighted
from bladewright.fitting.model_selection.other_minima import (
    from_other_edges,
    nearest_by_clustering,
    nearest_from_other_edges,
    with_sharp_edges,
)
from bladewright.fitting.model_selection.structure import Structure, reshaped, structure_of
from bladewright.fitting.model_selection.structure_search import (
    ENOUGH,
    NEAR,
    NEAR_RICH,
    StructureSearch,
    nearest_to_tolerance,
)

GUESS_NOISE = 3e-3
"""noise of the first round where the start is a guess, of the chord (design/matching_constants.md)."""
FINAL_REDUCTION = 1e-3
"""predicted relative reduction of the cost that a step of the last search needs (design/matching_constants.md)"""
QUICK_POINTS, SEVERAL_POINTS, THOROUGH_POINTS = 1000, 4000, 12_000
"""points of the first search in space, those that choose control points, and the last (design/matching_constants.md)"""
WEAK_REGULARISATION = 0.1
"""factor of the regularisation where a match is only improved (design/matching_constants.md)"""
CORNERS_HELD_NOTE = "the radii of the channel's corners are read off the points, held, and not counted"
COUNT_NOTE = "the design has {} parameters, and {} were asked for: no structure of that many was found that is nearer"
HELD_NOTE = "held where a smooth design has them, as the points do not determine them: {}"
DETERMINED_MARGIN, MOST_HOLDINGS = 1.5, 3
"""standard deviations that a determined direction of the parameters has in its own scale at least, and how often
parameters are held at most (design/matching_constants.md)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class RichMatch:
    """A match before the fewest control points are sought, and what is needed to seek them."""

    match: Match
    """of a rich structure; of the structure that is given, the last"""
    first: Match
    """of a few points, and of the structure it began with"""
    search: StructureSearch | None
    """None where the structure is given"""
    many: Task
    """the points of the last search"""
    note: str


def selected_match(
    task: Task, first: Design, target: MatchTarget, *, like: Structure | None, guessed: bool
) -> tuple[Match, str]:
    """The match, and why it misses what is asked, a note, or an empty string.

    `first` is a start, or a first guess where it is `guessed`; `like` is the structure of a given design.
    """
    return reduced_match(rich_match(task, first, target, like=like, guessed=guessed), target)


def rich_match(task: Task, first: Design, target: MatchTarget, *, like: Structure | None, guessed: bool) -> RichMatch:
    """The match of a rich structure, or of the one that is given; arguments are those of `selected_match`."""
    several, many = task.thinned(SEVERAL_POINTS), task.thinned(THOROUGH_POINTS)
    few, noise = task.thinned(QUICK_POINTS) if task.dimension == 3 else several, GUESS_NOISE if guessed else None
    few = replace(few, preliminary=guessed and task.dimension == 3)
    found = searched(few, first, noise=noise, min_reduction=ROUGH_REDUCTION)
    found = nearest_from_other_edges(few, found, GUESS_NOISE) if guessed else found
    found = nearest_by_clustering(few, found) if guessed and like is None else found
    if target.structured and target.tolerance is None:
        match = _of_structure(several, many, found, like if guessed else None)
        return RichMatch(match=match, first=found, search=None, many=many, note="")
    held = target.parameters is not None and bool(corner_radii(first)) and found.ends.in_rows(found.model.chord)
    several, many = map(_with_corners_held, (several, many)) if held else (several, many)
    search = StructureSearch(task=several, samples=(like or structure_of(first)).samples, first=found.design)
    if task.dimension == 3 and guessed:
        # laws that need no control points along the span begin as constants
        found = replace(search, task=few.trusting(found), predictions=1).well_predicted(found)
        search = replace(search, first=found.design)
    near = target.open and found.maximum < NEAR * found.model.chord
    rich = found if near else search.rich(found, target)
    if len(rich.rows) < len(several.points):
        # no richer one has a shape, or none is needed: the first match, of few points, stands
        rich = evaluated(several, rich.design, noise=rich.rms)
    rich = without_false_outliers(several, rich)
    # narrower matches tell outliers less
    many = many.trusting(evaluated(many, rich.design, noise=rich.rms))
    search, note = replace(search, task=several.trusting(rich)), CORNERS_HELD_NOTE if held else ""
    return RichMatch(match=rich, first=found, search=search, many=many, note=note)


def reduced_match(begun: RichMatch, target: MatchTarget) -> tuple[Match, str]:
    """The match of the fewest control points that keep what is asked, and why it ends where no target is met."""
    rich, search, many = begun.match, begun.search, begun.many
    if search is None:
        return rich, begun.note
    if target.tolerance is not None:
        found, reason = search.within(rich, target.tolerance)
        more = len(many.points) > len(search.task.points)
        return _reweighted_further(many, found, target.tolerance) if more else found, reason
    if target.parameters is not None:
        sized = search.of_size(rich, target.parameters)
        fitting = sized if len(sized.problem.paths) <= target.parameters else begun.first
        count, asked = len(fitting.problem.paths), target.parameters
        other = "" if count == asked else COUNT_NOTE.format(count, asked)
        return _searched_further(many, fitting), "; ".join(filter(None, (begun.note, other)))
    last, note = determined(many, search.near_everywhere(rich))
    limit = trusted_distance(last)
    lost = has_systematic_misfit(last) and last.maximum > limit
    if lost and evaluated(many, rich.design, noise=rich.rms).maximum <= limit:
        # what the last search left out or held made it miss what was predicted, which the rich match keeps
        within, _ = search.within(rich, ENOUGH * rich.model.chord)
        last, note = min((last, note), determined(many, within), key=lambda each: each[0].maximum)
    return last, note


def with_points_left_out(task: Task, match: Match, target: MatchTarget) -> Match:
    """A match searched on with points that its own search left out, the structure and what is held its own.

    It is the exchange method of semi-infinite problems (Hettich and Kortanek 1993, section 7), an exchange only.
    """
    more = replace(task, free=lambda _: match.problem.paths, held=match.held)
    if target.tolerance is None:
        return _searched_further(more, match)
    found = _reweighted_further(more, match, target.tolerance)
    return match if is_refused(found) else found


def _reweighted_further(task: Task, match: Match, tolerance: float) -> Match:
    """A match of more points, brought nearer to a tolerance [m] where these exceed it."""
    found = evaluated(task, match.design, noise=match.rms)
    if found.maximum <= tolerance:
        return found
    weights = reweighted(task.weights, found.state.footpoints.distances, tolerance)
    return nearest_to_tolerance(task, found, weights, tolerance)


def _searched_further(task: Task, match: Match) -> Match:
    """A match searched on, or as it is where that cannot be built, or is far from some points, and the match is not."""
    try:
        found = searched(task, match.design, noise=match.rms, min_reduction=FINAL_REDUCTION)
        near = max(trusted_distance(match), NEAR_RICH * match.maximum)
        if found.maximum > near or (is_refused(found) and not is_refused(match)):
            found = evaluated(task, match.design, noise=match.rms)
    except FitError:
        return match
    return found


def determined(task: Task, match: Match) -> tuple[Match, str]:
    """A match searched on, with the parameters held that the points do not determine, and a note of them."""
    task, match, note = with_sharp_edges(task, match)
    held: list[str] = []
    for number in range(MOST_HOLDINGS):
        more = undetermined_parameters(match, DETERMINED_MARGIN)
        if number and not more:
            break
        held += more
        match = without_false_outliers(task.holding(held), _searched_further(task.holding(held), match))
    return match, "; ".join(filter(None, (note, HELD_NOTE.format(", ".join(held)) if held else "")))


def _of_structure(several: Task, many: Task, found: Match, structure: Structure | None) -> Match:
    """The match of a given structure, from a richer one where it is not found else; of a match's own one by None."""
    if structure is not None:
        search = StructureSearch(task=several, samples=structure.samples, first=found.design)
        tried, starts = ([found], []) if structure_of(found.design) == structure else ([], [found])
        if not tried or has_systematic_misfit(found):
            starts.append(search.rich(found, MatchTarget(structured=True)))
        for start in starts:
            with suppress(FitError):
                tried.append(searched(several, reshaped(start.design, structure), noise=GUESS_NOISE))
        if not tried:
            return found
        found = min(tried, key=lambda each: each.rms)
        if several.dimension == 2 and found.maximum > NEAR * found.model.chord and has_systematic_misfit(found):
            found = min((found, *from_other_edges(several, found, GUESS_NOISE)), key=lambda each: each.rms)
    found = searched(many, found.design)
    if has_systematic_misfit(found):
        return found
    # what the points determine is not to be shifted
    weak = replace(many, regularisation_factor=WEAK_REGULARISATION * many.regularisation_factor)
    return searched(weak, found.design, rounds=QUICK_ROUNDS)


def _with_corners_held(task: Task) -> Task:
    """A task that holds the radii of the channel's corners."""
    return replace(task, free=lambda design: tuple(p for p in task.free(design) if p not in corner_radii(design)))
