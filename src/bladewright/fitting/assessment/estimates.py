"""What a cloud says of each parameter: covariance, intervals, and what it does not determine."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree
from scipy.special import stdtrit

from bladewright.fitting.assessment.result import Estimate
from bladewright.fitting.clouds.thinning import random_subset
from bladewright.fitting.matching.noise import neighbourhood_of
from bladewright.fitting.matching.residuals import CloudResiduals
from bladewright.fitting.matching.search import Match
from bladewright.nurbs.basis import Reals

IDENTIFIED_SPREAD = 0.3
"""standard deviation, of a parameter's own scale, below which the cloud determines it. Its 95 % interval is then about
one scale wide (design/matching_constants.md)."""
CORRELATED_POINTS, CORRELATED_NEIGHBOURS = 2000, 512
"""points whose residuals are compared with those of their neighbours, and neighbours at most; they bound the time: half
and twice change nothing (design/matching_constants.md)."""
FIRST_NEIGHBOURS, BY_CHANCE = 4, 2.0
"""neighbours that are compared first, twice as many each time, and standard errors that a correlation has by chance: 95
in 100 are lower (Bartlett 1946)"""
LARGEST_CONDITION = 1e7
"""condition of the derivatives by the scaled parameters from which one of them is not determined: half and twice change
nothing measured (design/matching_constants.md)"""
AT_BOUND = 1e-3
"""distance from a bound, of a parameter's scale, within which it lies on the bound."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ParameterEstimates:
    """How well the parameters of a match are known."""

    estimates: tuple[Estimate, ...]
    covariance: Reals
    """(k, k) in the units of the fields"""
    rank: int
    condition: float


def parameter_estimates(match: Match) -> ParameterEstimates:
    """From the derivatives of the residuals where a search ended, without the regularisation.

    The points' distances are taken as normal errors with variances inverse to the given weights, of which as many are
    independent as their autocorrelation says. A search may weigh points further by their distances; that takes no error
    away. References: Bates and Watts 1988, section 2.3 (linear approximation); Seber and Wild 1989, section 2.1.4
    (weights that are not the inverse variances).
    """
    problem = match.problem
    size = problem.scales.size
    rows = problem.cloud_residuals.residuals(match.state)
    slopes = problem.cloud_residuals.slopes(match.state, problem.paths) * size
    excess = _excess_weights(problem.cloud_residuals, len(rows))
    variance, left = _residual_variance(match, rows, excess)
    across, values, turns = np.linalg.svd(slopes, full_matrices=False)
    largest = float(values[0])
    known = values > 1e-13 * largest
    # covariance of the rotated parameters at variance one: the identity where no point is weighed further
    middle = across[:, known].T @ (excess[:, None] * across[:, known]) / np.outer(values[known], values[known])
    rank = int(np.count_nonzero(np.sqrt(variance * np.diag(middle)) < 1.0))
    kept = turns[known]
    scaled = variance * kept.T @ middle @ kept
    deviations = np.sqrt(np.diag(scaled))
    deviations[np.any(np.abs(turns[~known]) > np.sqrt(np.finfo(float).eps), axis=0)] = np.inf
    covariance = scaled * np.outer(size, size)
    factor = float(stdtrit(left, 0.975))
    values_now = problem.values_of(match.design)
    low, high = problem.scales.low, problem.scales.high
    estimates = []
    for i, path in enumerate(problem.paths):
        determined = bool(deviations[i] < IDENTIFIED_SPREAD)
        deviation = float(deviations[i] * size[i])
        value = float(values_now[i])
        near = AT_BOUND * size[i]
        estimates.append(
            Estimate(
                path=path,
                value=value,
                deviation=deviation,
                low=value - factor * deviation,
                high=value + factor * deviation,
                identified=determined,
                at_bound=bool(value - low[i] < min(near, 0.1 * abs(value)) or high[i] - value < near),
            )
        )
    smallest = float(values[-1])
    return ParameterEstimates(
        estimates=tuple(estimates),
        covariance=covariance,
        rank=rank,
        condition=largest / smallest if smallest > 0.0 else np.inf,
    )


def independent_share(places: Reals, residuals: Reals) -> float:
    """Share of residuals (n,) at places (n, d) that count as independent: the effective sample size over n.

    Its inverse is one and the sum of a residual's correlations with all others (Bayley and Hammersley 1946), here with
    ever more of the nearest until they correlate no more than by chance.
    """
    most = min(CORRELATED_NEIGHBOURS, len(residuals) // 4)
    variance = float(np.mean(residuals**2))
    if most < FIRST_NEIGHBOURS or variance == 0.0:
        return 1.0
    some = random_subset(len(residuals), CORRELATED_POINTS)
    index = cKDTree(places).query(places[some], k=most + 1)[1][:, 1:]
    correlations = np.mean(residuals[some, None] * residuals[index], axis=0) / variance
    total, first, last = 0.0, 0, FIRST_NEIGHBOURS
    while first < last:
        # each pair is counted about twice
        pairs = 0.5 * len(some) * (last - first)
        if np.mean(correlations[first:last]) < BY_CHANCE / np.sqrt(pairs):
            break
        total += float(np.sum(correlations[first:last]))
        first, last = last, min(2 * last, most)
    return 1.0 / (1.0 + total)


def _residual_variance(match: Match, rows: Reals, excess: Reals) -> tuple[float, float]:
    """Variance of the residuals of independent points, in chords, and its degrees of freedom."""
    cloud = match.problem.cloud_residuals
    points, parameters = len(cloud.points), len(match.problem.paths)
    count, taking = int(np.count_nonzero(cloud.roots)), cloud.roots > 0.0
    places = neighbourhood_of(cloud.points, match.state.footpoints).places
    independent = independent_share(places[taking], (rows / np.sqrt(excess))[:points][taking])
    variance = float(np.sum(rows[:points] ** 2 / excess[:points])) / max(count - parameters, 1) / independent
    return variance, max(independent * count - parameters, 1.0)


def undetermined_parameters(match: Match, margin: float) -> list[str]:
    """Parameters without which the points determine all others, by a margin in standard deviations.

    Each in turn is the one with the largest share in the direction that is determined least (Golub and Van Loan 2013,
    section 5.5.7).
    """
    problem = match.problem
    rows = problem.cloud_residuals.residuals(match.state)
    slopes = problem.cloud_residuals.slopes(match.state, problem.paths) * problem.scales.size
    excess = _excess_weights(problem.cloud_residuals, len(rows))
    least = margin * float(np.sqrt(_residual_variance(match, rows, excess)[0]))
    triangle, kept = np.asarray(np.linalg.qr(slopes, mode="r")), np.arange(len(problem.paths))
    while len(kept) > 1:
        _, values, turns = np.linalg.svd(triangle[:, kept])
        if values[-1] > max(least, values[0] / LARGEST_CONDITION):
            break
        kept = np.delete(kept, int(np.argmax(np.abs(turns[-1]))))
    return [path for place, path in enumerate(problem.paths) if place not in kept]


def _excess_weights(cloud_residuals: CloudResiduals, count: int) -> Reals:
    """How much more the points (count,) weigh in a search than their inverse variances; 1 for other rows."""
    found = np.ones(count)
    if cloud_residuals.precision is None:
        return found
    points = len(cloud_residuals.points)
    found[:points] = cloud_residuals.roots**2 / np.where(
        cloud_residuals.precision > 0.0, cloud_residuals.precision, 1.0
    )
    found[:points][found[:points] == 0.0] = 1.0
    found[points : points + len(cloud_residuals.ends.near)] = found[cloud_residuals.ends.near]
    return found
