"""From a first design to a match: a first search, a rich structure, the fewest control points that keep what is asked.

What the points do not determine then is held, and a last search takes more points. What a search from a first design
does not reach by itself is tried besides: sharp edges, edges elsewhere, another clustering. A round edge of unknown
radius and an end of the blade further in make up for each other, so that least squares alone leave the tip of a wedge
short by several radii. A nose slid along the outline is a minimum of its own. The clustering of a blade's samples is no
parameter, as no law is: what it could save is predicted from the derivatives of a match, with all parameters refitted
(variable projection: Golub and Pereyra 1973), and sought where that is much.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.special import chdtri

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.assessment.acceptance import GROSS_DEVIATION, NEAR_EVERYWHERE, MatchTarget, trusted_distance
from bladewright.fitting.assessment.measurement import undetermined_parameters
from bladewright.fitting.free_parameters import FreeParameters, corner_radii
from bladewright.fitting.matching.footpoints import Side, nearest_footpoints
from bladewright.fitting.matching.noise import doubted_outliers
from bladewright.fitting.matching.residuals import PlacedCloud
from bladewright.fitting.matching.search import (
    QUICK_ROUNDS,
    ROUGH_REDUCTION,
    Match,
    Task,
    can_be_built,
    evaluated,
    searched,
)
from bladewright.fitting.model_selection.elimination import reweighted
from bladewright.fitting.model_selection.structure import Structure, reshaped, structure_of, with_feasible_edges
from bladewright.fitting.model_selection.structure_search import (
    ENOUGH,
    NEAR,
    NEAR_RICH,
    StructureSearch,
    nearest_to_tolerance,
)
from bladewright.section.unified_limits import ANGLES, RADII, TANGENTS

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
    """The match from a start or a guess, and why it misses what is asked; `like` is the structure of a given design."""
    return reduced_match(rich_match(task, first, target, like=like, guessed=guessed), target)


def rich_match(task: Task, first: Design, target: MatchTarget, *, like: Structure | None, guessed: bool) -> RichMatch:
    """The match of a rich structure, or of the one that is given; arguments are those of `selected_match`."""
    several, many = task.thinned(SEVERAL_POINTS), task.thinned(THOROUGH_POINTS)
    few, noise = task.thinned(QUICK_POINTS) if task.dimension == 3 else several, GUESS_NOISE if guessed else None
    few = replace(few, preliminary=guessed and task.dimension == 3)
    found = searched(few, first, noise=noise, min_reduction=ROUGH_REDUCTION)
    found = nearest_from_other_edges(few, found) if guessed else found
    found = nearest_by_clustering(few, found) if guessed and like is None else found
    if target.structured and target.tolerance is None:
        match = _of_structure(several, many, found, like if guessed else None)
        return RichMatch(match=match, first=found, search=None, many=many, note="")
    held = target.parameters is not None and bool(corner_radii(first)) and found.ends.in_rows(found.model.chord)
    several, many = (replace(each, free=replace(each.free, corners=not held)) for each in (several, many))
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
    # narrower matches tell outliers less; at the knots of more points the design may have no shape
    with suppress(FitError):
        many = many.trusting(evaluated(many, rich.design, noise=rich.rms))
    search, note = replace(search, task=several.trusting(rich)), CORNERS_HELD_NOTE if held else ""
    return RichMatch(match=rich, first=found, search=search, many=many, note=note)


def reduced_match(begun: RichMatch, target: MatchTarget) -> tuple[Match, str]:
    """The match of the fewest control points that keep what is asked, and why it ends where no target is met."""
    rich, search, many = begun.match, begun.search, begun.many
    if search is None:
        return rich, begun.note
    if target.tolerance is not None:
        return _within(rich, search, many, target.tolerance)
    if target.parameters is not None:
        sized = search.of_size(rich, target.parameters)
        fitting = sized if len(sized.problem.paths) <= target.parameters else begun.first
        count, asked = len(fitting.problem.paths), target.parameters
        other = "" if count == asked else COUNT_NOTE.format(count, asked)
        return _searched_further(many, fitting), "; ".join(filter(None, (begun.note, other)))
    last, note = determined(many, search.near_everywhere(rich))
    limit = trusted_distance(last)
    lost = last.has_systematic_misfit and last.maximum > limit
    with suppress(FitError):
        if lost and evaluated(many, rich.design, noise=rich.rms).maximum <= limit:
            # what the last search left out or held made it miss what was predicted, which the rich match keeps
            within, _ = search.within(rich, ENOUGH * rich.model.chord)
            last, note = min((last, note), determined(many, within), key=lambda each: each[0].maximum)
    return last, note


def _within(rich: Match, search: StructureSearch, many: Task, tolerance: float) -> tuple[Match, str]:
    """The match of fewest parameters found that keeps a tolerance [m] at many points; the nearest, and why, else."""
    found, reason = search.within(rich, tolerance)
    if len(many.points) <= len(search.task.points):
        return found, reason
    whole = _reweighted_further(many, found, tolerance)
    if whole.maximum > tolerance and not reason:
        # others than those searched exceed it: these are to be met as much nearer
        nearer, _ = search.within(rich, tolerance**2 / whole.maximum)
        whole = min(whole, _reweighted_further(many, nearer, tolerance), key=lambda each: each.maximum)
    return whole, reason


def searched_with_more(task: Task, match: Match, target: MatchTarget) -> Match:
    """A match searched on with more points, the structure and what is held its own; or as it is where that fails.

    It is the exchange method of semi-infinite problems (Hettich and Kortanek 1993, section 7): one exchange.
    """
    more = replace(task, free=FreeParameters(free=match.problem.paths), held=match.held)
    if target.tolerance is None:
        return _searched_further(more, match)
    found = _reweighted_further(more, match, target.tolerance)
    return found if can_be_built(found.design) else match


def _reweighted_further(task: Task, match: Match, tolerance: float) -> Match:
    """A match of more points, brought nearer to a tolerance [m] where these exceed it; as it is if it has no shape."""
    try:
        found = evaluated(task, match.design, noise=match.rms)
    except FitError:
        return match
    if found.maximum <= tolerance:
        return found
    weights = reweighted(task.weights, found.state.footpoints.distances, tolerance)
    return nearest_to_tolerance(task, found, weights, tolerance)


def _searched_further(task: Task, match: Match) -> Match:
    """A match searched on, or as it is where that cannot be built, or is far from some points, and the match is not."""
    try:
        found = searched(task, match.design, noise=match.rms, min_reduction=FINAL_REDUCTION)
        near = max(trusted_distance(match), NEAR_RICH * match.maximum)
        if found.maximum > near or (not can_be_built(found.design) and can_be_built(match.design)):
            found = evaluated(task, match.design, noise=match.rms)
    except FitError:
        return match
    return found


def without_false_outliers(task: Task, match: Match) -> Match:
    """A match to those outliers too that may be points of a nose that is not found, where it takes most of them."""
    if len(match.rows) < len(task.points):
        # it has no shape at the knots of so many points
        return match
    inliers, feet, systematic = match.noise_estimate.inliers, match.state.footpoints, match.has_systematic_misfit
    doubted = doubted_outliers(~inliers & ~match.ends.on_end_face, task.points, feet, systematic=systematic)
    if not np.any(doubted):
        return match
    every = replace(task.part(np.flatnonzero(inliers | doubted)), allow_outliers=False)
    try:
        found = searched(every, match.design, noise=match.rms, rounds=QUICK_ROUNDS + 1, min_reduction=ROUGH_REDUCTION)
        found = evaluated(task, found.design, noise=found.rms)
    except FitError:
        return match
    return match if np.mean(found.noise_estimate.inliers[doubted]) <= 0.5 else found


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
        if not tried or found.has_systematic_misfit:
            starts.append(search.rich(found, MatchTarget(structured=True)))
        for start in starts:
            with suppress(FitError):
                tried.append(searched(several, reshaped(start.design, structure), noise=GUESS_NOISE))
        if not tried:
            return found
        found = min(tried, key=lambda each: each.rms)
        if several.dimension == 2 and found.maximum > NEAR * found.model.chord and found.has_systematic_misfit:
            found = min((found, *from_other_edges(several, found)), key=lambda each: each.rms)
    found = searched(many, found.design)
    if found.has_systematic_misfit:
        return found
    # what the points determine is not to be shifted
    weak = replace(many, regularisation_factor=WEAK_REGULARISATION * many.regularisation_factor)
    return searched(weak, found.design, rounds=QUICK_ROUNDS)


SHARP_RADIUS = 5e-6
"""radius of a sharp edge [axial chords]: a wedge of 15 deg ends 3.3e-5 before its tip (design/matching_constants.md)"""
SHARPER_BY_CHANCE = 0.05
"""probability that a round edge leaves so much less than a sharp one by chance, where it is sharp (Wilks 1938)."""
SHARP_NOTE = (
    "the points tell the {} from no sharp one, and the edges of this family are round: the radius is held "
    f"at {SHARP_RADIUS:g} (--family profile has sharp edges)"
)
EDGES = {
    "leading edge": ("leading_edge_radius", slice(None, 3)),
    "trailing edge": ("trailing_edge_radius", slice(-1, -4, -1)),
}
"""the radius of each edge, and the control points of a side from there"""


def with_sharp_edges(task: Task, match: Match) -> tuple[Task, Match, str]:
    """The match of a section with the radii of such edges held, its task, and a note of them."""
    sharp, again = list[str](), partial(searched, rounds=QUICK_ROUNDS + 1, min_reduction=ROUGH_REDUCTION)
    for name, (radius, ends) in EDGES.items() if task.dimension == 2 else ():
        if radius not in match.problem.paths or not all(_pointed(side, ends) for side in match.state.shape.sides):
            continue
        held = task.without((radius,))
        try:
            match = again(task, match.design, noise=match.rms)
            found = again(held, match.design.changed({radius: SHARP_RADIUS}), noise=match.rms)
            found.design.build()
        except (DesignError, FitError):
            continue
        before, after = (np.sum(each.state.footpoints.distances[match.rows] ** 2) for each in (match, found))
        count = np.count_nonzero(match.rows) * match.noise_estimate.independent_share(len(match.problem.paths))
        if count * np.log(after / before) < chdtri(1, SHARPER_BY_CHANCE):
            task, match, sharp = held, found, [*sharp, name]
    return task, match, SHARP_NOTE.format(" and the ".join(sharp)) if sharp else ""


def _pointed(side: Side, ends: slice) -> bool:
    """Whether the third control point of a side lies further from its edge than from its camber line."""
    edge, second, third = side.control_points[ends]
    across = (second - edge) / np.sqrt(np.sum((second - edge) ** 2))
    rise = float((third - edge) @ across)
    return 2.0 * rise**2 < float(np.sum((third - edge) ** 2))


USUAL_TANGENT, USUAL_RADIUS = 0.3, 0.01
"""tangent proportions and edge radii of further starts (design/matching_constants.md)"""


def from_other_edges(task: Task, match: Match) -> Iterator[Match]:
    """Matches from designs whose edges lie elsewhere."""
    known, names = match.design.parameters(), {path: path.partition("[")[0] for path in match.problem.paths}
    usual = {**dict.fromkeys(TANGENTS, USUAL_TANGENT), **dict.fromkeys(RADII, USUAL_RADIUS)}
    # of sections the camber line is made straight as well
    straight = [usual | dict.fromkeys(ANGLES, known["stagger"])] if "stagger" in known else []
    for values in (usual, *straight):
        changes = {path: values[name] for path, name in names.items() if name in values}
        with suppress(DesignError, FitError):
            if changes:
                start = with_feasible_edges(match.design.changed(changes))
                yield searched(task, start, noise=GUESS_NOISE, min_reduction=ROUGH_REDUCTION)


def nearest_from_other_edges(task: Task, match: Match) -> Match:
    """The nearest of a match and those from other edges; one as near as is trusted is not searched again."""
    if np.max(match.state.footpoints.distances) <= GROSS_DEVIATION[1] * match.model.chord:
        return match
    # all points count, as those of an edge that is not found are left out (design/matching.md)
    return min((match, *from_other_edges(task, match)), key=lambda each: each.mean_distance)


WORTH_SEEKING = 0.9
"""predicted ratio of misfits below which another clustering is sought (design/matching_constants.md)"""
CLUSTERING_STEP, CLUSTERING_TOLERANCE = 1e-3, 0.03
"""step of the finite difference, and how closely the clustering is sought (design/matching_constants.md)"""


def nearest_by_clustering(task: Task, match: Match) -> Match:
    """The match with the clustering that leaves the least misfit, where another one is predicted to leave much less."""
    design, near = match.design, match.maximum <= NEAR_EVERYWHERE * match.model.chord
    if near or not isinstance(design, UnifiedBlade) or _predicted_ratio(match, design) > WORTH_SEEKING:
        return match
    best = match

    def misfit(clustering: float) -> float:
        nonlocal best
        try:
            start = with_feasible_edges(best.design.changed({"clustering": float(clustering)}))
            found = searched(task, start, noise=best.rms, rounds=QUICK_ROUNDS + 1, min_reduction=ROUGH_REDUCTION)
        except (DesignError, FitError):
            return 1.0
        best = min(best, found, key=lambda each: each.misfit)
        return found.misfit

    minimize_scalar(misfit, bounds=(0.0, 1.0), method="bounded", options={"xatol": CLUSTERING_TOLERANCE})
    return best


def _predicted_ratio(match: Match, design: UnifiedBlade) -> float:
    """Ratio [-] of the misfit that the nearest clustering is predicted to leave, to a match's own.

    Residuals r (m,) and their rates c (m,) by the clustering, without what the parameters make up for, give the step
    -c.r / c.c (Golub and Pereyra 1973).
    """
    problem, z = match.problem, match.problem.vector(design)
    values, slopes = problem.values(z), problem.derivatives(z)
    step = CLUSTERING_STEP if design.clustering < 0.5 else -CLUSTERING_STEP
    try:
        shape = match.model.shape(design.changed({"clustering": design.clustering + step}))
    except DesignError:
        return 1.0
    if values is None or slopes is None or not shape.finite:
        return 1.0
    cloud = problem.cloud_residuals
    moved = PlacedCloud(shape=shape, footpoints=nearest_footpoints(cloud.points, shape.sides, match.state.footpoints))
    own = cloud.residuals(match.state)
    rates = np.zeros(len(values[0]))
    rates[: len(own)] = (cloud.residuals(moved) - own) / step
    basis, _ = np.linalg.qr(slopes[0])  # real: of real residuals
    rows, rates = (each - basis @ (basis.T @ each) for each in (values[0], rates))
    if not np.any(rates):
        return 1.0
    change = np.clip(-(rates @ rows) / (rates @ rates), -design.clustering, 1.0 - design.clustering)
    return float(np.sqrt(np.sum((rows + change * rates) ** 2) / np.sum(rows**2)))
