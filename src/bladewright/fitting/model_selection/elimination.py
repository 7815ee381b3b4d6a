"""Backward elimination of control points, by predictions about one match (Draper and Smith 1998, section 15.3)."""

import numpy as np

from bladewright.fitting.model_selection.prediction import LARGEST_STEP, LinearModel, Prediction
from bladewright.nurbs.basis import Reals

SURPLUS_DIVISOR = 12
"""one in so many of the surplus parameters goes between two predictions."""
CHEAP_LOSS = 3.0
"""predicted loss for each parameter, of the least, up to which a law loses control points together with it."""
WEIGHTED_DEVIATION = 0.8
"""deviation, of the tolerance, from which a point's weight rises."""
WEIGHT_CHANGE, WEIGHT_RANGE = (0.5, 2.0), (0.02, 50.0)
"""range by which the weight of a point changes at a time, and in all (`WEIGHT_RANGE`)."""
REWEIGHTINGS = 12
"""times that weights change for a prediction at most"""
PREDICTED, LARGEST_PREDICTED = 0.95, 1.5
"""largest predicted distance, of the tolerance, with which a structure is searched, and from which none is narrowed
(`LARGEST_PREDICTED`)."""


def eliminated(model: LinearModel, least: int, tolerance: float | None = None) -> list[Prediction]:
    """Structures of fewer and fewer parameters, each without what is predicted to matter least of the one before.

    With a tolerance, of the chord, points are weighed so that their largest distance becomes small.
    """
    found: list[Prediction] = []
    now = model.prediction(model.counts)
    while now is not None:
        if tolerance is not None:
            now = reweighted_prediction(model, now, tolerance)
            if now.largest > LARGEST_PREDICTED * tolerance:
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


def reweighted_prediction(model: LinearModel, prediction: Prediction, tolerance: float) -> Prediction:
    """A prediction of the same structure whose largest distance is small, as far as a tolerance asks, of the chord."""
    for _ in range(REWEIGHTINGS):
        model.weighted(reweighted(model.weights, np.abs(prediction.rows), tolerance))
        prediction = model.prediction(prediction.counts) or prediction
        if prediction.largest <= PREDICTED * tolerance:
            break
    return prediction


def reweighted(weights: Reals, distances: Reals, tolerance: float) -> Reals:
    """Weights (n,) of points that rise with their distances (Lawson 1961); points that do not take part have none."""
    factors = np.clip(distances / (WEIGHTED_DEVIATION * tolerance), *WEIGHT_CHANGE)
    found = np.where(weights > 0.0, np.clip(weights * factors, *WEIGHT_RANGE), 0.0)
    return np.asarray(found * (np.sum(weights) / np.sum(found)))


EXCHANGES_TRIED = 4
"""wider structures from which an exchange is sought, and narrower ones of each."""


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
