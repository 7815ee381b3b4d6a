"""Which control points a match needs least: backward elimination by predictions, without a search.

About a match of a rich structure the residuals are a linear function of its control points. Every narrower structure
is a linear subspace of these, so that the least squares of its match follow from the same derivatives by products.
Where a largest distance is asked for, points weigh by their distances, in predictions and in searches. References:
Draper and Smith 1998, section 15.3; Lawson 1961 (weights).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, block_diag, cho_factor, cho_solve

from bladewright.fitting.free_parameters import scales_of
from bladewright.fitting.matching.search import Match
from bladewright.fitting.model_selection.laws import Counts, ResizableLaw
from bladewright.fitting.model_selection.structure import Structure, reshaped, resizable_laws, structure_of
from bladewright.nurbs.basis import Reals

LARGEST_STEP = 3
"""control points that a law loses or gains at a time at most (design/matching_constants.md)."""
RIDGE = {2: 0.0, 3: 0.01}
"""cost of a change of a parameter by its scale, of the sum of squares (Hoerl and Kennard 1970), by dimension:
linearisations of blades reach about so far (design/matching_constants.md)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Prediction:
    """The least squares that a structure is predicted to leave."""

    counts: tuple[Counts, ...]
    """of the resizable laws"""
    parameters: int
    cost: float
    """sum of squares of weighted residuals, regularisation and ridge, in chords"""
    rows: Reals
    """(n,) unweighted residuals of the points, in chords; 0 of those that do not take part"""
    weights: Reals
    """(n,) of the points"""
    change: Reals
    """(k,) of the rich structure's scaled parameters"""
    inverse: Reals
    """(j, j) of the normal equations"""

    @property
    def rms(self) -> float:
        """Root mean square of the residuals, of the chord."""
        return float(np.sqrt(np.mean(self.rows**2)))

    @property
    def deviation(self) -> float:
        """Standard deviation of the noise, of the chord, if the residuals are nothing else."""
        return float(np.sqrt(np.sum(self.rows**2) / max(len(self.rows) - self.parameters, 1)))

    @property
    def largest(self) -> float:
        """The largest residual, of the chord."""
        return float(np.max(np.abs(self.rows)))


class FreeLaw:
    """A law of a match, which of its control points' numbers are free, and what is left of these with other counts."""

    def __init__(self, of: ResizableLaw, match: Match) -> None:
        problem, values, paths = match.problem, match.design.parameters(), of.paths(match.design)
        self.of, self.design, self.counts = of, match.design, of.counts_of(match.design)
        self.free = np.array([path in problem.paths for path in paths], dtype=bool)
        """(k,) which of its control points' numbers are free"""
        self.columns = np.array([problem.paths.index(path) for path in paths if path in problem.paths], dtype=int)
        """of the free ones, among the parameters of the match"""
        size = problem.scales.size
        self._unit = float(size[self.columns[0]]) if len(self.columns) else 1.0
        self._values = np.array([float(values[path]) for path in paths]) / self._unit
        # what they give depends on counts only
        self.subspace = cache(self._subspace)
        self.lost = cache(self._lost)

    def _subspace(self, counts: Counts) -> tuple[Reals, Reals, NDArray[np.bool_], Reals]:
        """Its free parameters by those with other counts, the nearest of these, which are free, and the change."""
        embedding = self.of.embedding(self.counts, counts)
        offset = self.of.offset(self.design, self.counts, counts) / self._unit
        nearest = np.asarray(np.linalg.lstsq(embedding, self._values - offset, rcond=None)[0])
        kept = np.ones(embedding.shape[1], dtype=bool)
        kept[[int(np.argmax(row)) for row in embedding[~self.free]]] = False
        shift = (embedding @ nearest + offset - self._values)[self.free]
        return embedding[np.ix_(self.free, kept)], nearest, kept, shift

    def _lost(self, counts: Counts, fewer: Counts) -> tuple[Reals, Reals]:
        """Directions (m, k) in which a law with some counts is none of those with fewer, and where these begin (k,)."""
        embedding = self.of.embedding(counts, fewer)
        directions = np.linalg.qr(embedding, mode="complete")[0][:, embedding.shape[1] :].T
        return directions, self.of.offset(self.design, counts, fewer) / self._unit


class LinearModel:
    """The residuals of a match as a linear function of its laws' control points."""

    def __init__(self, match: Match, samples: int) -> None:
        problem, size = match.problem, match.problem.scales.size
        self.match, self.design, self.samples = match, match.design, samples
        self.structure = structure_of(match.design)
        self.points, self.dimension = match.state.footpoints.points.shape
        self.slopes = problem.cloud_residuals.slopes(match.state, problem.paths) * size
        self.residuals = problem.cloud_residuals.residuals(match.state)
        """(m,) those of the points first, in chords"""
        roots = problem.cloud_residuals.roots
        weighed = np.where(roots > 0.0, roots, np.inf)
        self.slopes[: self.points] /= weighed[:, None]
        self.residuals[: self.points] /= weighed
        self._penalty = problem.regularisation.matrix
        self._penalised = problem.regularisation.residuals(problem.vector(match.design))
        laws = [FreeLaw(law, match) for law in resizable_laws(match.design)]
        # a law that is held in part keeps its control points, but for the channel's corners
        self.laws = [each for each in laws if np.any(each.free) and (each.of.holds_corners or np.all(each.free))]
        self._columns = np.concatenate([np.zeros(0, dtype=int), *(law.columns for law in self.laws)])
        self._others = np.setdiff1d(np.arange(len(problem.paths)), self._columns)
        self.weighted(roots**2)

    @property
    def counts(self) -> tuple[Counts, ...]:
        """The numbers of control points of its own laws."""
        return tuple(law.counts for law in self.laws)

    def weighted(self, weights: Reals) -> None:
        """Weigh the points by weights (n,)."""
        self.weights = weights
        roots = np.ones(len(self.residuals))
        roots[: self.points] = np.sqrt(weights)
        columns, rows = self.slopes * roots[:, None], self.residuals * roots
        self._gram = columns.T @ columns + self._penalty.T @ self._penalty
        self._right = columns.T @ rows + self._penalty.T @ self._penalised
        self.ridge = RIDGE[self.dimension] * float(rows @ rows)
        self._gram[np.diag_indices_from(self._gram)] += self.ridge
        self._cost = float(rows @ rows + self._penalised @ self._penalised)

    def prediction(self, counts: Sequence[Counts]) -> Prediction | None:
        """What the match with these numbers of control points leaves; None where it is not determined."""
        subspace, shift = self.subspace(counts)
        gram, right = subspace.T @ self._gram @ subspace, subspace.T @ (self._right + self._gram @ shift)
        # raised by their rounding
        gram[np.diag_indices_from(gram)] += len(gram) * np.finfo(float).eps * float(np.max(np.diag(gram)))
        try:
            inverse = np.asarray(cho_solve(cho_factor(gram), np.eye(len(gram))))
        except LinAlgError:
            return None
        step = -inverse @ right
        start = self._cost + 2.0 * float(self._right @ shift) + float(shift @ self._gram @ shift)
        change = subspace @ step + shift
        return Prediction(
            counts=tuple(counts),
            parameters=subspace.shape[1],
            cost=start + float(right @ step),
            rows=self.residuals[: self.points] + self.slopes[: self.points] @ change,
            weights=self.weights,
            change=change,
            inverse=inverse,
        )

    def losses(self, prediction: Prediction) -> list[tuple[float, int, int, Counts]]:
        """What narrower laws cost: loss for each parameter, their number, the law's number, and its counts.

        It is that of constraints under which a law has fewer (Wald's statistic: Seber and Wild 1989, section 5.2).
        """
        found, first = [], len(self._others)
        for i, (free_law, counts) in enumerate(zip(self.laws, prediction.counts, strict=True)):
            part, nearest, free, shift = free_law.subspace(counts)
            own = slice(first, first + part.shape[1])
            first = own.stop
            values = nearest.copy()
            values[free] += np.linalg.lstsq(part, prediction.change[free_law.columns] - shift, rcond=None)[0]
            for place, count in enumerate(counts):
                for fewer in range(max(free_law.of.fewest[place], count - LARGEST_STEP), count):
                    smaller = (*counts[:place], fewer, *counts[place + 1 :])
                    lost, offset = free_law.lost(counts, smaller)
                    if not len(lost):
                        # a row that is left out has no laws along the span to lose control points
                        continue
                    bent = lost @ (values - offset)
                    spread = lost[:, free] @ prediction.inverse[own, own] @ lost[:, free].T
                    loss = float(bent @ np.linalg.lstsq(spread, bent, rcond=None)[0])
                    found.append((loss / len(lost), len(lost), i, smaller))
        return sorted(found)

    def subspace(self, counts: Sequence[Counts]) -> tuple[Reals, Reals]:
        """The rich structure's parameters (k, j) by those of a narrower one, and their change (k,) to the nearest."""
        laws = [law.subspace(each) for law, each in zip(self.laws, counts, strict=True)]
        places, kept = np.concatenate([self._others, self._columns]), np.eye(len(self._others))
        found, shift = block_diag(kept, *(part for part, *_ in laws)), np.zeros(len(places))
        found[places] = found.copy()
        shift[places] = np.concatenate([np.zeros(len(kept)), *(change for *_, change in laws)])
        return found, shift

    def structured(self, counts: Sequence[Counts]) -> Structure:
        """The structure with these numbers of control points, and the samples that they need."""
        changed = {free_law.of.name: each for free_law, each in zip(self.laws, counts, strict=True)}
        return replace(self.structure, counts={**self.structure.counts, **changed}).with_samples(self.samples)

    def designed(self, prediction: Prediction) -> Any:
        """The predicted design, its laws within the family's bounds."""
        problem = self.match.problem
        values = problem.values_of(self.design) + problem.scales.size * prediction.change
        scales = scales_of(self.design, problem.paths, self.match.model.chord)
        values = np.clip(values, scales.low, scales.high)
        rich = self.design.changed(dict(zip(problem.paths, values.tolist(), strict=True)))
        return reshaped(rich, self.structured(prediction.counts))


SURPLUS_DIVISOR = 12
"""one in so many of the surplus parameters goes between two predictions (design/matching_constants.md)."""
CHEAP_LOSS = 3.0
"""loss for a parameter, of the least, up to which laws lose control points together (design/matching_constants.md)"""
WEIGHTED_DEVIATION = 0.8
"""deviation, of the tolerance, from which a point's weight rises (design/matching_constants.md)."""
WEIGHT_CHANGE, WEIGHT_RANGE = (0.5, 2.0), (0.02, 50.0)
"""ranges in which the weight of a point changes at a time, and in all (design/matching_constants.md)"""
REWEIGHTINGS = 12
"""times that weights change for a prediction at most (design/matching_constants.md)"""
PREDICTED, LARGEST_PREDICTED = 0.95, 1.5
"""largest predicted distance, of the tolerance, with which a structure is searched, and from which none is narrowed
(`LARGEST_PREDICTED`) (design/matching_constants.md)."""


def eliminated(model: LinearModel, least: int, tolerance: float | None = None) -> list[Prediction]:
    """Structures of fewer and fewer parameters; with a tolerance, of the chord, points weigh by their distances."""
    found: list[Prediction] = []
    now = model.prediction(model.counts)
    while now is not None:
        if tolerance is not None:
            now = reweighted_prediction(model, now, tolerance)
            if found and now.largest > LARGEST_PREDICTED * tolerance:
                break
        found.append(now)
        losses = model.losses(now)
        if now.parameters <= least or not losses:
            break
        counts, changed = list(now.counts), set[int]()
        left = max(1, (now.parameters - least) // SURPLUS_DIVISOR)
        for loss, fewer, law, smaller in losses:
            cheap = fewer <= left and loss <= CHEAP_LOSS * max(losses[0][0], 0.0)
            if law not in changed and (cheap or not changed):
                counts[law] = smaller
                changed.add(law)
                left -= fewer
        now = model.prediction(counts)
    return found


def reweighted(weights: Reals, distances: Reals, tolerance: float) -> Reals:
    """Weights (n,) of points that rise with their distances (Lawson 1961); points that do not take part have none."""
    factors = np.clip(distances / (WEIGHTED_DEVIATION * tolerance), *WEIGHT_CHANGE)
    found = np.where(weights > 0.0, np.clip(weights * factors, *WEIGHT_RANGE), 0.0)
    return np.asarray(found * (np.sum(weights) / np.sum(found)))


def reweighted_prediction(model: LinearModel, prediction: Prediction, tolerance: float) -> Prediction:
    """A prediction of the same structure whose largest distance is small, as far as a tolerance asks, of the chord."""
    for _ in range(REWEIGHTINGS):
        model.weighted(reweighted(model.weights, np.abs(prediction.rows), tolerance))
        prediction = model.prediction(prediction.counts) or prediction
        if prediction.largest <= PREDICTED * tolerance:
            break
    return prediction


EXCHANGES_TRIED = 4
"""wider structures from which an exchange is sought, and narrower ones of each (design/matching_constants.md)."""


def best_of_size(model: LinearModel, most: int) -> list[Prediction]:
    """Structures of at most so many parameters that are predicted to leave least, best first.

    Those of the elimination, and those that the best of them leads to by an exchange between two laws: a forward step
    before a backward one (Draper and Smith 1998, section 15.4).
    """
    pool = {each.counts: each for each in eliminated(model, most) if each.parameters <= most}
    if pool:
        best = min(pool.values(), key=lambda each: each.cost)
        gains = [((best.cost - each.cost) / (each.parameters - best.parameters), each) for each in _wider(model, best)]
        for _, more in sorted(gains, key=lambda pair: -pair[0])[:EXCHANGES_TRIED]:
            pool |= {each.counts: each for each in _reduced(model, more, most)}
    return sorted(pool.values(), key=lambda each: each.cost)


def _wider(model: LinearModel, of: Prediction) -> list[Prediction]:
    """The structures with one law wider in one direction, within the rich one."""
    found = []
    for i, (counts, most) in enumerate(zip(of.counts, model.counts, strict=True)):
        for place, count in enumerate(counts):
            for more in range(count + 1, min(count + LARGEST_STEP, most[place]) + 1):
                changed = (*counts[:place], more, *counts[place + 1 :])
                found.append(model.prediction([*of.counts[:i], changed, *of.counts[i + 1 :]]))
    return [each for each in found if each is not None]


def _reduced(model: LinearModel, prediction: Prediction, most: int) -> list[Prediction]:
    """The structure, or the best with one law narrower that have at most so many parameters."""
    if prediction.parameters <= most:
        return [prediction]
    enough = [each for each in model.losses(prediction) if prediction.parameters - each[1] <= most]
    counts = [(law, smaller) for _, _, law, smaller in enough[:EXCHANGES_TRIED]]
    found = [
        model.prediction([*prediction.counts[:law], smaller, *prediction.counts[law + 1 :]]) for law, smaller in counts
    ]
    return [each for each in found if each is not None]
