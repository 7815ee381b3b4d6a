"""The structure of fewest parameters that keeps an aim: about a match narrower ones are predicted, and searched.

The aim is a number of parameters, or a largest distance; where nothing is asked, the cloud's noise (Morozov 1966), or a
distance that a rich match keeps, which the regularisation of its laws holds (P-splines: Eilers and Marx 1996).
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice

import numpy as np

from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.assessment.acceptance import NEAR_EVERYWHERE, MatchTarget, trusted_distance
from bladewright.fitting.matching.footpoints import Footpoints, part_of
from bladewright.fitting.matching.noise import EXACT
from bladewright.fitting.matching.search import (
    QUICK_ROUNDS,
    ROUGH_REDUCTION,
    Match,
    Task,
    buildable,
    can_be_built,
    evaluated,
    searched,
)
from bladewright.fitting.model_selection.elimination import (
    LARGEST_PREDICTED,
    PREDICTED,
    LinearModel,
    Prediction,
    best_of_size,
    eliminated,
    reweighted,
)
from bladewright.fitting.model_selection.laws import MOST_SPAN
from bladewright.fitting.model_selection.structure import (
    reshaped,
    rich_structure,
    widened_where_feasible,
    wider_structure,
)
from bladewright.nurbs.basis import Reals

NOISE_REASON = "what is left is the cloud's own noise, {:.2g} mm: more control points would follow it"
TRIED_PARAMETERS, MOST_TRIED = 100, 4
"""parameters of the structures of one size that are searched, in all, as predictions are linear; and structures at most
(`MOST_TRIED`), so that one can be built (design/matching_constants.md)"""
STAGES = 2
"""times that structures are predicted anew about the match that they led to (design/matching_constants.md)"""
NEAR_RICH = 1.25
"""largest distance, of a rich match's, of one of which nothing is asked (design/matching_constants.md)"""
NOISE_QUANTILE = 1.645
"""standard errors by which a misfit may pass the noise, as once in twenty by chance (design/matching_constants.md)"""
TO_SPARE = 0.8
"""share of the largest distance that is asked for which a rich match reaches, so that control points can be left out,
and which is predicted of matches of which nothing is asked, as predictions are linear (design/matching.md)"""
NEAR, ENOUGH = 0.5 * EXACT, TO_SPARE * NEAR_EVERYWHERE
"""largest distances predicted where nothing is asked, of the chord: of exact points, and else (design/matching.md)"""
WORTHWHILE, MOST_PREDICTIONS = 0.9, 8
"""share of the parameters of a match that a structure may have with which a search for fewer goes on; and matches about
which structures are predicted for one aim at most (design/matching_constants.md)"""
SETTLED_RICH = 0.9
"""ratio of misfits above which a rich search has settled, and a richer structure gains nothing (design/matching.md)"""
EXPLAINED = 0.25
"""share of the misfit that a rich structure's linear model leaves at most where it is trusted (design/matching.md)"""
RICHER_GAIN = 0.6
"""ratio of the misfits of two rich structures above which a richer one is of no use: a third as many control points
again bring a cubic spline nearer by (3/4)^4, a third, half as many by a fifth (de Boor 1978, chapter 12)."""


@dataclass(frozen=True, kw_only=True)
class StructureSearch:
    """The search for the structure of few parameters that keeps an aim."""

    task: Task
    samples: int
    """along the chord at least"""
    first: Design
    """what searches begin from where predictions have no shape"""
    predictions: int = MOST_PREDICTIONS
    """matches about which structures are predicted at most"""

    def rich(self, match: Match, target: MatchTarget) -> Match:
        """The match of a rich structure, and of ever richer ones until one is near enough or comes hardly nearer."""
        found, least = match, target.tolerance or NEAR * match.model.chord
        # where a structure or a number is asked, rich laws may have more control points along the chord than samples
        # determine
        first_structure = partial(rich_structure, sampled=target.open or target.tolerance is not None)
        search = partial(searched, min_reduction=ROUGH_REDUCTION, settled=SETTLED_RICH, fading=True)
        shown = len(self.task.points), self._rows_shown(match)
        while found is match or (found.has_systematic_misfit and not self._is_enough(found, target)):
            try:
                # in space structures begin without what they are predicted not to need; exact clouds, and those of
                # which something is asked, lose that before they grow as well
                slim = self.task.dimension == 3 and (not target.open or found.is_exact)
                about = self._without_surplus(found) if slim and found is not match else found.design
                widened = first_structure if found is match else partial(wider_structure, slim=slim)
                design = widened_where_feasible(about, widened(about, self.task.free(about), *shown))
                if self.task.dimension == 3:
                    wide = evaluated(self.task, design, noise=found.rms)
                    design = self._without_surplus(wide, EXPLAINED * found.rms)
                richer = search(self.task, design, noise=found.rms, enough=lambda each: each.maximum <= least)
            except (DesignError, FitError):
                break
            limit = target.tolerance or NEAR_EVERYWHERE * match.model.chord
            # one that is near everywhere comes before one that is nearer on average
            nearer = (richer.maximum > limit, richer.rms) < (found.maximum > limit, found.rms)
            before, found = found, richer if found is match or nearer else found
            near = found.maximum <= NEAR_EVERYWHERE * match.model.chord
            ratio = min(richer.rms / before.rms, richer.maximum / before.maximum)
            gained = ratio <= (RICHER_GAIN if near else SETTLED_RICH)
            # one that is no nearer would be searched from again, for ever
            if before is not match and (found is before or not gained):
                break
        return found

    def _is_enough(self, rich: Match, target: MatchTarget) -> bool:
        """Whether a rich match needs no richer one: where nothing is asked, exact points are met more nearly."""
        if target.open:
            return rich.maximum <= (NEAR_RICH * NEAR if rich.is_exact else NEAR_EVERYWHERE) * rich.model.chord
        return target.tolerance is None or rich.maximum <= TO_SPARE * target.tolerance

    def _without_surplus(self, rich: Match, most: float = np.inf) -> Design:
        """The design of fewest control points predicted to be hardly worse, and within `most` rms; or the rich one."""
        candidates = eliminated(model := self._model(rich), 0)
        chosen = [each for each in candidates if each.rms <= min(NEAR_RICH * candidates[0].rms, most)]
        start = self._start(model, chosen[-1]) if chosen else None
        return rich.design if start is None else start.design

    def of_size(self, rich: Match, most: int) -> Match:
        """The match of at most so many parameters that predictions lead to; the rich one where none can be built."""
        best = None
        for _ in range(STAGES):
            model = self._model(self._widened(best, rounds=self.task.dimension - 2) if best else rich)
            searches = (self._searched(model, each) for each in best_of_size(model, most)[:MOST_TRIED])
            built = (each for found in searches if found and (each := buildable(self.task, found)))
            fresh = min(islice(built, max(1, TRIED_PARAMETERS // most)), key=lambda each: each.misfit, default=None)
            if fresh is None or (best is not None and fresh.misfit >= best.misfit):
                break
            best = fresh
        return best or rich

    def well_predicted(self, rich: Match) -> Match:
        """The match of fewest parameters that is at the cloud's noise, or where its misfit is none, near everywhere."""
        model = self._model(rich)
        # what the rich match leaves is the noise, where its neighbours share none of it (Morozov 1966)
        whole = model.prediction(model.counts)
        noise = (0.0 if whole is None else whole.deviation) * (1.0 + NOISE_QUANTILE / np.sqrt(2.0 * model.points))
        systematic, exact, least = rich.has_systematic_misfit, rich.is_exact, rich.maximum

        def predicted(model: LinearModel) -> list[Prediction]:
            nonlocal systematic
            candidates = eliminated(model, 0)
            if not systematic:
                at_noise = [each for each in candidates if each.deviation <= noise]
                # exact points that need nearly every control point have another structure: near is enough
                fewest = min((each.parameters for each in at_noise), default=0)
                systematic = exact and model.match is rich and fewest > WORTHWHILE * len(rich.problem.paths)
            if not systematic:
                return at_noise
            nearest = NEAR_RICH * min((each.largest for each in candidates), default=0.0)
            aim = max(NEAR if exact or nearest <= EXACT else ENOUGH, nearest)
            return [each for each in candidates if each.largest <= aim]

        def kept(match: Match) -> bool:
            # one that is nearer than the rich match shows that others can be
            nonlocal least
            largest, chord = match.maximum, rich.model.chord
            least = min(least, largest)
            limit = NEAR if exact or least <= NEAR * chord else NEAR_EVERYWHERE
            return not match.has_systematic_misfit or largest <= max(limit * chord, NEAR_RICH * least)

        found, nearby = self._fewest(rich, None, predicted=predicted, search=self._searched, kept=kept)
        return found or nearby or rich

    def near_everywhere(self, rich: Match) -> Match:
        """The match that predicts well, or one that is nearer where that is far from some points."""
        found, limit = self.well_predicted(rich), trusted_distance(rich)
        # hardly further than the rich match is near enough
        enough = max(limit, min(NEAR_RICH * rich.maximum, NEAR_EVERYWHERE * rich.model.chord))
        if not found.has_systematic_misfit or found.maximum <= enough or rich.maximum > limit:
            return found
        nearer, _ = self.within(rich, limit)
        return nearer if nearer.maximum < found.maximum and can_be_built(nearer.design) else found

    def within(self, rich: Match, tolerance: float) -> tuple[Match, str]:
        """The match of fewest parameters found that keeps a tolerance [m]; the nearest, and why, where none does."""
        relative = tolerance / rich.model.chord

        def predicted(model: LinearModel) -> list[Prediction]:
            return [each for each in eliminated(model, 0, relative) if each.largest <= PREDICTED * relative]

        def reweighted_search(model: LinearModel, prediction: Prediction) -> Match | None:
            start = self._start(model, prediction)
            return start and nearest_to_tolerance(self.task, start, prediction.weights, tolerance)

        def kept(match: Match) -> bool:
            return match.maximum <= tolerance

        found, nearest = rich if kept(rich) and can_be_built(rich.design) else None, None
        if kept(rich) or rich.has_systematic_misfit:
            found, nearest = self._fewest(
                rich, found, rounds=1, predicted=predicted, search=reweighted_search, kept=kept
            )
        if found is not None:
            return found, ""
        nearest = min(filter(None, (rich, nearest)), key=lambda each: each.maximum)
        if not nearest.has_systematic_misfit:
            return self.well_predicted(rich), NOISE_REASON.format(1e3 * rich.noise_estimate.noise)
        return nearest, "no structure was found that keeps the tolerance"

    def _fewest(
        self,
        rich: Match,
        found: Match | None,
        *,
        predicted: Callable[[LinearModel], list[Prediction]],
        search: Callable[[LinearModel, Prediction], Match | None],
        kept: Callable[[Match], bool],
        rounds: int = 0,
    ) -> tuple[Match | None, Match | None]:
        """The match of fewest parameters found that is `kept`, and the nearest of those that are not.

        Each structure is `predicted` about the last match, widened and searched for some `rounds`, as a linear model
        about a rich match does not reach as far as narrow structures lie. Where its `search` leads no nearer, or
        nothing wider than what has failed is predicted, one between this and the last that was kept is searched. A rich
        match that is kept is the first of them, so that none is searched that would save little.
        """
        nearest, least, about, failed, narrowest = None, np.inf, rich, 0, True
        for _ in range(self.predictions):
            model, last = self._model(about), found or rich
            most = WORTHWHILE * len(last.problem.paths) if found or kept(rich) else np.inf
            predictions = predicted(model)
            promising = [each for each in predictions if failed < each.parameters <= most]
            if not predictions and about is rich and (whole := model.prediction(model.counts)):
                promising = [whole]
            if promising:
                chosen = promising[-1 if narrowest else len(promising) // 2]
                fresh = search(model, chosen)
                match = fresh and buildable(self.task, fresh)
                enough = match is not None and kept(match)
                if predictions and not enough:
                    failed = chosen.parameters
                if match is not None and (enough or match.maximum < least):
                    found, nearest = (match, nearest) if enough else (found, match)
                    least = np.inf if enough else match.maximum
                    about, narrowest = self._widened(match, rounds), True
                    continue
            if about is last and not (promising and predictions):
                break
            about, narrowest = last, False
        return found, nearest

    def _model(self, match: Match) -> LinearModel:
        self.task.progress("structure")
        return LinearModel(match, self.samples)

    def _rows_shown(self, match: Match) -> int:
        """How many control points along the span the points of the task show, or those of a match that has fewer."""
        if len(match.rows) < len(self.task.points):
            # by finer knots a design may have no shape
            with suppress(FitError):
                match = evaluated(self.task, match.design, noise=match.rms)
        return rows_shown(match.state.footpoints.part(match.rows))

    def _widened(self, match: Match, rounds: int = 0) -> Match:
        """A match with more control points in every law after some rounds, or as it is where that has no shape."""
        try:
            free, rows = self.task.free(match.design), self._rows_shown(match)
            design = reshaped(match.design, wider_structure(match.design, free, len(self.task.points), rows))
            return searched(self.task, design, noise=match.rms, rounds=rounds, min_reduction=ROUGH_REDUCTION)
        except (DesignError, FitError):
            return match

    def _searched(self, model: LinearModel, prediction: Prediction) -> Match | None:
        """The match of a predicted structure; None where it has no shape."""
        quick = partial(searched, rounds=QUICK_ROUNDS, min_reduction=ROUGH_REDUCTION)
        with suppress(FitError, DesignError):
            start = self._start(model, prediction)
            return start and quick(self.task, start, noise=prediction.rms)
        return None

    def _start(self, model: LinearModel, prediction: Prediction) -> Match | None:
        """The predicted design, that nearest to the rich match, or the first in its structure if none has a shape."""
        designs = (
            partial(model.designed, prediction),
            partial(model.designed, replace(prediction, change=np.zeros_like(prediction.change))),
            partial(reshaped, self.first, model.structured(prediction.counts)),
        )
        found: list[Match] = []
        for design in designs:
            # predictions that go too far are no nearer than the rich match
            if found and (design is designs[-1] or found[0].misfit < LARGEST_PREDICTED * prediction.rms):
                break
            with suppress(DesignError, FitError):
                found.append(evaluated(self.task, design(), noise=prediction.rms))
        return min(found, key=lambda each: each.misfit, default=None)


REWEIGHTED_SEARCHES = 6
"""searches of one structure with other weights at most (design/matching_constants.md)"""
TOUCHED = 0.05
"""largest excess over the tolerance, as a share of it, that the last of these searches is foreseen to have; where it is
more, they end (design/matching_constants.md)"""


def nearest_to_tolerance(task: Task, start: Match, weights: Reals, tolerance: float) -> Match:
    """The match nearest to a tolerance [m] of searches of one structure, whose weights (n,) rise with the distances."""
    tried, last, before = [start], start, np.inf
    weights = np.where(weights > 0.0, weights, task.weights)
    for left in reversed(range(REWEIGHTED_SEARCHES)):
        weighted = replace(task, weights=weights * (np.sum(task.weights) / np.sum(weights)))
        try:
            last = searched(weighted, last.design, noise=last.rms, rounds=1, min_reduction=ROUGH_REDUCTION)
        except (FitError, DesignError):
            break
        tried.append(last)
        excess = last.maximum - tolerance
        # each reduces it by the same ratio as the one before
        if excess <= 0.0 or (excess / before) ** left * excess > TOUCHED * tolerance:
            break
        before, weights = excess, reweighted(weights, last.state.footpoints.distances, tolerance)
    return min(tried, key=lambda each: each.maximum)


ROWS_PER_KNOT = 3
"""rows of points for each inner knot of a law along the span, where Ruppert 2002 has four (design/matching.md)"""
CHORD_PARTS = 10
"""parts of each side, along the chord, in each of which rows are counted (design/matching_constants.md)"""


def rows_shown(feet: Footpoints) -> int:
    """How many control points along the span points show, by their footpoints (n,).

    A spline's control points are determined where each basis function has a place of its own (Schoenberg and Whitney
    1953), but between so few it swings: a cubic one has an inner knot for every few rows, and fewer control points than
    rows, by the median of parts of the chord. Rows that lead across the design's lines show more of the span: knots go
    by the most equal parts of it that all have points.
    """
    order = 4
    most = ROWS_PER_KNOT * (MOST_SPAN - order)
    part = part_of(feet.u, CHORD_PARTS, feet.side)
    rows = int(np.median([_apart(feet.v[part == number], 1.0 / most) for number in np.unique(part)]))
    filled = next((n for n in range(most, 1, -1) if len(np.unique(part_of(feet.v, n))) == n), 1)
    return min(rows - (rows > order), order + filled // ROWS_PER_KNOT)


def _apart(places: Reals, distance: float) -> int:
    """How many of some places (n,) are at least a distance apart, taken from the lowest on."""
    ordered, count, row = np.sort(places), 0, 0
    while row < len(ordered):
        count, row = count + 1, int(np.searchsorted(ordered, ordered[row] + distance))
    return count
