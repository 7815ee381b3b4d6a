"""How many control points a design needs: a rich one is matched first, and laws lose what the aim does not need.

The rich match is held by the regularisation of its laws (P-splines: Eilers and Marx 1996). About it the least squares
of narrower structures are predicted; backward elimination ranks them (Draper and Smith 1998, section 15.3), and what
is predicted to keep the aim with the fewest parameters is searched. The aim is a number of parameters, or a largest
distance; where nothing is asked, the cloud's noise (Morozov 1966), or a distance that the rich match keeps.
"""

from dataclasses import dataclass, replace
from functools import partial
from itertools import islice

import numpy as np

from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.assessment.acceptance import NEAR_EVERYWHERE, MatchTarget, trusted_distance
from bladewright.fitting.assessment.estimates import undetermined_parameters
from bladewright.fitting.free_parameters import corner_radii
from bladewright.fitting.matching.noise import EXACT
from bladewright.fitting.matching.search import (
    QUICK_ROUNDS,
    ROUGH_REDUCTION,
    Match,
    Task,
    evaluated,
    has_systematic_misfit,
    is_exact,
    is_refused,
    searched,
    without_false_outliers,
)
from bladewright.fitting.model_selection.edges import from_other_edges, trusted_or_from_other_edges, with_sharp_edges
from bladewright.fitting.model_selection.elimination import (
    LARGEST_PREDICTED,
    PREDICTED,
    LinearModel,
    Prediction,
    best_of_size,
    confirmed_match,
    eliminated,
    largest_of,
    nearest_to_tolerance,
    reweighted,
    reweighted_prediction,
)
from bladewright.fitting.model_selection.reshaping import (
    rich_structure,
    widened_where_feasible,
    wider_structure,
)
from bladewright.fitting.model_selection.structure import Structure, reshaped, rows_shown, structure_of

GUESS_NOISE = 3e-3
"""noise of the first round where the start is a guess, of the chord (design/matching_constants.md)."""
FINAL_REDUCTION = 1e-3
"""predicted relative reduction of the cost that a step of the last search needs: half and twice change nothing measured
(design/matching_constants.md)."""
QUICK_POINTS, SEVERAL_POINTS, THOROUGH_POINTS = 1000, 4000, 12_000
"""points of the first search in space, of those that choose control points, and of the last; time grows with them."""
WEAK_REGULARISATION = 0.1
"""factor of the regularisation where a match is only improved."""
REFUSED_MARGIN = 6.0
"""factor of the margin of edge radii where a rich match that searches allow is refused when built."""
CORNERS_HELD_NOTE = "the radii of the channel's corners are read off the points, held, and not counted"
"""note where the channel's corners are read off the points"""
HELD_NOTE = "the points do not determine {}, which are held where a smooth design has them"
"""note where parameters are held"""
DETERMINED_MARGIN, MOST_HOLDINGS = 1.5, 3
"""standard deviations that a determined direction of the parameters has in its own scale at least, more than one as the
search that follows changes the residuals; and how often parameters are held at most (`MOST_HOLDINGS`). Half and twice
change nothing measured (design/matching_constants.md)."""
NOISE_REASON = "what is left is the cloud's own noise, {:.2g} mm: more control points would follow it"


def selected_match(
    task: Task, first: Design, target: MatchTarget, *, like: Structure | None, guessed: bool
) -> tuple[Match, str]:
    """The match, and why it ends where no target is met.

    `first` is a first design, a guess or a start; `like` is the structure of a given design.
    """
    several, many = task.thinned(SEVERAL_POINTS), task.thinned(THOROUGH_POINTS)
    few, noise = task.thinned(QUICK_POINTS) if task.dimension == 3 else several, GUESS_NOISE if guessed else None
    few = replace(few, preliminary=guessed and task.dimension == 3)
    found = searched(few, first, noise=noise, min_reduction=ROUGH_REDUCTION)
    found = trusted_or_from_other_edges(several, found, GUESS_NOISE) if task.dimension == 2 and guessed else found
    if target.structured and target.tolerance is None:
        return _of_structure(several, many, found, like or structure_of(first), guessed=guessed), ""
    held = target.parameters is not None and bool(corner_radii(first)) and found.ends.in_rows(found.model.chord)
    reason = CORNERS_HELD_NOTE if held else ""
    several, many = map(_with_corners_held, (several, many)) if held else (several, many)
    selection = _Selection(task=several, samples=(like or structure_of(first)).samples, first=found.design)
    if task.dimension == 3 and guessed:
        # laws that need no control points along the span begin as constants
        found = replace(selection, task=few).well_predicted(found)
        selection = replace(selection, first=found.design)
    near = target.open and found.maximum < NEAR * found.model.chord
    rich = found if near else selection.rich(found, target, sampled=target.parameters is None)
    if len(rich.rows) < len(several.points):
        # no richer one has a shape, or none is needed: the first match, of few points, stands
        rich = evaluated(several, rich.design, noise=rich.rms)
    rich = without_false_outliers(several, rich)
    if target.parameters is not None:
        sized = selection.of_size(rich, target.parameters)
        found = sized if len(sized.problem.paths) <= target.parameters else found
    elif target.tolerance is not None:
        found, reason = selection.within(rich, target.tolerance)
    else:
        found = selection.near_everywhere(rich)
    if target.tolerance is not None:
        confirmed = len(many.points) == len(several.points)
        return (found if confirmed else confirmed_match(many, found, target.tolerance)), reason
    if not target.open:
        return _searched_further(many, found), reason
    last, note = determined(many, found)
    if has_systematic_misfit(last) and last.maximum > trusted_distance(last):
        # what the last search left out or held made it miss what was predicted
        within, _ = selection.within(rich, ENOUGH * rich.model.chord)
        last, note = min((last, note), determined(many, within), key=lambda each: each[0].maximum)
    return last, note


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


def _of_structure(several: Task, many: Task, found: Match, structure: Structure, *, guessed: bool) -> Match:
    """The match of a given structure: from a richer one where it is not found else."""
    if guessed:
        selection = _Selection(task=several, samples=structure.samples, first=found.design)
        tried = [found] if structure_of(found.design) == structure else []
        starts = [found] if not tried else []
        if not tried or has_systematic_misfit(found):
            starts.append(selection.rich(found, MatchTarget(structured=True)))
        for start in starts:
            try:
                tried.append(searched(several, reshaped(start.design, structure), noise=GUESS_NOISE))
            except FitError:
                continue
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


TRIED_PARAMETERS, MOST_TRIED = 100, 4
"""parameters of the structures of one size that are searched, in all, as predictions are linear; and structures at most
(`MOST_TRIED`), so that one can be built. With one of 22 the ORC nozzle is met by 1.68e-3 of the chord, not 1.50e-3;
with half of either LS89 is met by 1.0e-3, not 8.1e-4 (design/matching_constants.md)."""
STAGES = 3
"""times that structures are predicted anew about the match that they have led to: half and twice change nothing
measured (design/matching_constants.md)."""
NEAR_RICH = 1.25
"""largest distance that a match keeps whose misfit is no noise and of which nothing is asked, of that of a rich one:
half and twice change nothing measured (design/matching_constants.md)."""
NOISE_QUANTILE = 1.645
"""standard errors by which a misfit may pass the noise, which one of pure noise does once in twenty times
(design/matching_constants.md)."""
NEAR, ENOUGH = 0.5 * EXACT, 0.8 * NEAR_EVERYWHERE
"""largest distances, of the chord, that matches are predicted to have of which nothing is asked: where they can be
exact, and else. They are parts of what is asked of the matches themselves, as predictions are linear."""
TRIED_SHARES = (1.0, 0.75, 0.5, 0.25, 0.0)
"""which of the structures that are predicted to do are searched, from that of fewest parameters, until one does
(design/matching_constants.md)"""
SETTLED_RICH = 0.9
"""ratio of the misfits of two rounds above which the search of a rich structure has settled (design/matching.md)"""
RICHER_GAIN = 0.6
"""ratio of the misfits of two rich structures above which a richer one is of no use: a third as many control points
again bring a cubic spline nearer by (3/4)^4, a third, half as many by a fifth (de Boor 1978, chapter 12)."""


@dataclass(frozen=True, kw_only=True)
class _Selection:
    """The search for structures."""

    task: Task
    samples: int
    """along the chord at least"""
    first: Design
    """what searches begin from where predictions have no shape"""

    def holds(self, match: Match, tolerance: float) -> bool:
        """Whether a match of the same structure is predicted to keep a tolerance [m] where points are weighed so."""
        if match.maximum <= tolerance:
            return True
        model, relative = self._model(match), tolerance / match.model.chord
        found = model.prediction(model.counts)
        return found is not None and reweighted_prediction(model, found, relative).largest <= PREDICTED * relative

    def rich(self, match: Match, target: MatchTarget, *, sampled: bool = False) -> Match:
        """The match of a rich structure, and of ever richer ones until one is near enough or comes hardly nearer.

        Where it is to be `sampled`, the first has no more control points along the chord than its samples determine. In
        space, where points are exact or something is asked, a structure loses what it does not need before it grows.
        """
        found, least = match, target.tolerance or NEAR * match.model.chord
        search = partial(searched, min_reduction=ROUGH_REDUCTION, settled=SETTLED_RICH, fading=True)
        shown = len(self.task.points), rows_shown(match.state.footpoints.v[match.rows])
        while found is match or (has_systematic_misfit(found) and not self._is_enough(found, target)):
            try:
                slim = self.task.dimension == 3 and (not target.open or is_exact(found))
                about = self._without_surplus(found) if slim and found is not match else found.design
                first = partial(rich_structure, sampled=sampled)
                widened = first if found is match else partial(wider_structure, slim=slim)
                design = widened_where_feasible(about, widened(about, self.task.free(about), *shown))
                richer = search(self.task, design, noise=found.rms, enough=lambda each: each.maximum <= least)
                richer = without_false_outliers(self.task, richer)
            except (DesignError, FitError):
                break
            before, found = found, richer if found is match or richer.rms < found.rms else found
            if before is not match and min(richer.rms / before.rms, richer.maximum / before.maximum) > RICHER_GAIN:
                break
        return found

    def _is_enough(self, rich: Match, target: MatchTarget) -> bool:
        """Whether a rich match needs no richer one: where nothing is asked, exact points are met more nearly."""
        if target.open:
            return rich.maximum <= (NEAR if is_exact(rich) else NEAR_EVERYWHERE) * rich.model.chord
        return target.tolerance is None or self.holds(rich, target.tolerance)

    def _without_surplus(self, rich: Match) -> Design:
        """The design of the fewest control points that is predicted to leave hardly more than a rich match."""
        candidates = eliminated(model := self._model(rich), 0)
        chosen = [each for each in candidates if each.rms <= NEAR_RICH * candidates[0].rms]
        start = self._start(model, chosen[-1]) if chosen else None
        return rich.design if start is None else start.design

    def of_size(self, rich: Match, most: int) -> Match:
        """The match of at most so many parameters that predictions lead to; the rich one where none can be built."""
        best, about = None, rich
        for _ in range(STAGES):
            model = self._model(about)
            searches = (self._searched(model, each) for each in best_of_size(model, most)[:MOST_TRIED])
            built = (each for found in searches if found and (each := self._built(found)))
            fresh = min(islice(built, max(1, TRIED_PARAMETERS // most)), key=lambda each: each.misfit, default=None)
            if fresh is None or (best is not None and fresh.misfit >= best.misfit):
                break
            best, about = fresh, self._widened(fresh)
        return best or rich

    def _built(self, match: Match) -> Match | None:
        """A match that can be built: where it is refused, one whose edge radii are kept further from what is."""
        if not is_refused(match):
            return match
        roots = match.problem.cloud_residuals.roots
        weights = np.where(roots > 0.0, roots**2, self.task.weights)
        task = replace(self.task, margin_factor=REFUSED_MARGIN * self.task.margin_factor, weights=weights)
        try:
            found = searched(task, match.design, noise=match.rms, rounds=1, min_reduction=ROUGH_REDUCTION)
        except FitError:
            return None
        return None if is_refused(found) else found

    def well_predicted(self, rich: Match) -> Match:
        """The match of fewest parameters that is at the cloud's noise, or where its misfit is none, near everywhere."""
        model = self._model(rich)
        candidates = eliminated(model, 0)
        # what the rich match leaves is the noise, where its neighbours share none of it (Morozov 1966)
        noise = (candidates[0].deviation if candidates else 0.0) * (1.0 + NOISE_QUANTILE / np.sqrt(2.0 * model.points))
        nearest = NEAR_RICH * min((each.largest for each in candidates), default=0.0)
        aim = max(NEAR if is_exact(rich) or nearest <= EXACT else ENOUGH, nearest)
        near = max(trusted_distance(rich), NEAR_RICH * largest_of(rich, rich))
        systematic = has_systematic_misfit(rich)
        chosen = [each for each in candidates if (each.largest <= aim if systematic else each.deviation <= noise)]
        chosen = chosen or candidates[:1]
        tried: list[Match] = []
        for number in dict.fromkeys(int(share * (len(chosen) - 1)) for share in TRIED_SHARES if chosen):
            fresh = self._searched(model, chosen[number])
            found = None if fresh is None else self._built(fresh)
            if found is not None:
                tried.append(found)
                if not has_systematic_misfit(found) or largest_of(found, rich) <= near:
                    break
        return min(tried, key=lambda each: largest_of(each, rich), default=rich)

    def near_everywhere(self, rich: Match) -> Match:
        """The match that predicts well, or one that is nearer where that is far from some points."""
        found, limit = self.well_predicted(rich), trusted_distance(rich)
        if not has_systematic_misfit(found) or largest_of(found, rich) <= limit:
            return found
        weights = reweighted(self.task.weights, found.state.footpoints.distances, limit)
        nearer = nearest_to_tolerance(self.task, found, weights, rich, limit)
        if largest_of(nearer, rich) > limit or is_refused(nearer):
            nearer, _ = self.within(rich, limit)
        return nearer if largest_of(nearer, rich) < largest_of(found, rich) and not is_refused(nearer) else found

    def within(self, rich: Match, tolerance: float) -> tuple[Match, str]:
        """The match of fewest parameters found that keeps a tolerance [m]; the nearest, and why, where none does."""
        found = rich if largest_of(rich, rich) <= tolerance and not is_refused(rich) else None
        nearest = rich
        if has_systematic_misfit(rich) or largest_of(rich, rich) <= tolerance:
            tried = self._narrowed(rich, rich, tolerance)
            while tried and largest_of(tried[-1], rich) <= tolerance:
                found, tried = tried[-1], self._narrowed(tried[-1], rich, tolerance)
            nearest = min([rich, *tried], key=lambda each: largest_of(each, rich))
        if found is not None:
            return found, ""
        if not has_systematic_misfit(nearest):
            return self.well_predicted(rich), NOISE_REASON.format(1e3 * rich.noise_estimate.noise)
        return nearest, "no structure was found that keeps the tolerance"

    def _narrowed(self, about: Match, rich: Match, tolerance: float) -> list[Match]:
        """Matches of fewer parameters by predictions about one, with more until the last keeps a tolerance [m]."""
        model, most = self._model(about), len(about.problem.paths) - (about is not rich)
        relative = tolerance / model.chord
        fewer = [each for each in eliminated(model, 0, relative) if each.parameters <= most]
        kept = [each for each in fewer if each.largest <= PREDICTED * relative]
        kept = kept or sorted(fewer, key=lambda each: each.largest)[:1]
        found: list[Match] = []
        for number in dict.fromkeys(int(share * (len(kept) - 1)) for share in TRIED_SHARES if kept):
            start = self._start(model, kept[number])
            match = start and self._built(nearest_to_tolerance(self.task, start, kept[number].weights, rich, tolerance))
            found += [match] if match else []
            if match and largest_of(match, rich) <= tolerance:
                break
        return found

    def _model(self, match: Match) -> LinearModel:
        self.task.progress("structure")
        return LinearModel(match, self.samples)

    def _widened(self, match: Match) -> Match:
        """A match with more control points in every law, not searched, or the same where that leaves it no shape."""
        try:
            free, rows = self.task.free(match.design), rows_shown(match.state.footpoints.v[match.rows])
            design = reshaped(match.design, wider_structure(match.design, free, len(self.task.points), rows))
            return searched(self.task, design, noise=match.rms, rounds=0)
        except (DesignError, FitError):
            return match

    def _searched(self, model: LinearModel, prediction: Prediction) -> Match | None:
        """The match of a predicted structure; None where it has no shape."""
        start = self._start(model, prediction)
        if start is None:
            return None
        try:
            return searched(
                self.task, start.design, rounds=QUICK_ROUNDS, noise=prediction.rms, min_reduction=ROUGH_REDUCTION
            )
        except (FitError, DesignError):
            return None

    def _start(self, model: LinearModel, prediction: Prediction) -> Match | None:
        """The predicted design or the nearest to the rich match; the first design in its structure if none has a shape.

        Predictions that go too far are no nearer than the rich match.
        """
        structure = model.structured(prediction.counts).with_samples(self.samples)
        designs = (
            partial(model.designed, prediction),
            partial(model.designed, replace(prediction, change=np.zeros_like(prediction.change))),
            partial(reshaped, self.first, structure),
        )
        found: Match | None = None
        for number, design in enumerate(designs):
            if number == len(designs) - 1 and found is not None:
                break
            try:
                fresh = evaluated(self.task, design(), noise=prediction.rms)
            except (DesignError, FitError):
                continue
            found = fresh if found is None or fresh.misfit < found.misfit else found
            if found.misfit < LARGEST_PREDICTED * prediction.rms:
                break
        return found


def _with_corners_held(task: Task) -> Task:
    """A task that holds the radii of the channel's corners."""
    return replace(task, free=lambda design: tuple(p for p in task.free(design) if p not in corner_radii(design)))
