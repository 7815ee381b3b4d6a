"""What a cloud says of each parameter: covariance, intervals, and what it does not determine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree
from scipy.special import stdtrit

from bladewright.fitting.clouds.thinning import random_subset
from bladewright.fitting.free_parameters import scales_of
from bladewright.fitting.matching.noise import neighbourhood_of
from bladewright.fitting.matching.residuals import regularisation_of
from bladewright.fitting.matching.search import Match
from bladewright.nurbs.basis import Reals

IDENTIFIED_SPREAD = 0.3
"""standard deviation, of a parameter's own scale, below which the cloud determines it: its 95 % interval is then about
one scale wide (design/matching_constants.md)"""
CORRELATED_POINTS, CORRELATED_NEIGHBOURS = 2000, 512
"""points that are compared with neighbours, and these at most; they bound the time (design/matching_constants.md)"""
FIRST_NEIGHBOURS, BY_CHANCE = 4, 2.0
"""neighbours compared first, doubled each time, and standard errors of a correlation by chance (95 %: Bartlett 1946)"""
LARGEST_CONDITION = 1e7
"""condition of the scaled derivatives from which a parameter is not determined (design/matching_constants.md)"""
AT_BOUND = 1e-3
"""distance from a bound, of a parameter's scale, within which it lies on the bound (design/matching_constants.md)"""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A fitted parameter, in the unit of its field."""

    path: str
    value: float
    deviation: float
    """standard deviation that the cloud's noise gives it; infinite where the cloud does not determine it"""
    low: float
    """lower end of the 95 % interval"""
    high: float
    """upper end of the 95 % interval"""
    identified: bool
    """whether the cloud determines it"""
    at_bound: bool
    """whether it lies on one of its bounds"""


@dataclass(frozen=True, kw_only=True, eq=False)
class ParameterEstimates:
    """How well the parameters of a match are known."""

    estimates: tuple[Estimate, ...]
    """the free parameters"""
    covariance: Reals
    """(k, k) of the free parameters, in their order and the units of their fields"""
    rank: int
    """number of directions in the space of the parameters that the cloud determines"""
    condition: float
    """ratio of the largest to the smallest singular value of the scaled problem"""


def parameter_estimates(match: Match) -> ParameterEstimates:
    """From the derivatives of the residuals where a search ended, without the regularisation.

    The points' distances are taken as normal errors with variances inverse to the given weights, of which as many are
    independent as their autocorrelation says. A search may weigh points further by their distances; that takes no error
    away. A parameter on a bound is held there, as an active constraint holds it (Nocedal and Wright 2006, section
    12.3). References: Bates and Watts 1988, section 2.3 (linear approximation); Seber and Wild 1989, section 2.1.4
    (weights that are not the inverse variances).
    """
    problem, scales = match.problem, match.problem.scales
    slopes, excess, variance, left = _linearised(match, problem.paths, scales.size)
    values = problem.values_of(match.design)
    # what a bound holds is known
    inside = scales.inside(values)
    across, singular, turns = np.linalg.svd(slopes[:, inside], full_matrices=False)
    largest, least = (singular[0], singular[-1]) if len(singular) else (1.0, 1.0)
    known = singular > 1e-13 * largest
    # covariance of the rotated parameters at variance one: the identity where no point is weighed further
    middle = across[:, known].T @ (excess[:, None] * across[:, known]) / np.outer(singular[known], singular[known])
    covariance = np.zeros((len(inside), len(inside)))
    covariance[np.ix_(inside, inside)] = variance * turns[known].T @ middle @ turns[known]
    spread = np.sqrt(np.diag(covariance))
    spread[np.flatnonzero(inside)[np.any(np.abs(turns[~known]) > np.sqrt(np.finfo(float).eps), axis=0)]] = np.inf
    deviations, near = spread * scales.size, AT_BOUND * scales.size
    reach = float(stdtrit(left, 0.975)) * deviations
    at_bound = (values - scales.low < np.minimum(near, 0.1 * np.abs(values))) | (scales.high - values < near)
    estimates = tuple(
        Estimate(
            path=path,
            value=float(values[i]),
            deviation=float(deviations[i]),
            low=float(values[i] - reach[i]),
            high=float(values[i] + reach[i]),
            identified=bool(spread[i] < IDENTIFIED_SPREAD),
            at_bound=bool(at_bound[i]),
        )
        for i, path in enumerate(problem.paths)
    )
    return ParameterEstimates(
        estimates=estimates,
        covariance=covariance * np.outer(scales.size, scales.size),
        rank=int(np.count_nonzero(~inside) + np.count_nonzero(np.sqrt(variance * np.diag(middle)) < 1.0)),
        condition=float(largest / least) if least > 0.0 else np.inf,
    )


def shape_covariance(match: Match) -> tuple[tuple[str, ...], Reals]:
    """The free parameters, and those of a blade that are held as undetermined; their covariance (k, k) in their units.

    What points do not determine is known by the regularisation alone, the spread of smooth designs (Wahba 1983: the
    penalty of a smoothing spline as its prior): between rows of points that moves a blade's shape.
    """
    problem, held = match.problem, () if match.state.shape.exact is None else tuple(sorted(match.held))
    paths = *problem.paths, *held
    sizes = np.append(problem.scales.size, scales_of(match.design, held, match.model.chord).size)
    slopes, _, variance, _ = _linearised(match, paths, sizes)
    prior = regularisation_of(match.design, paths, sizes, ends_shown=match.ends.in_rows(match.model.chord)).matrix
    # what a bound holds is known
    inside = np.append(problem.scales.inside(problem.values_of(match.design)), np.ones(len(held), dtype=bool))
    rows = np.concatenate([slopes / np.sqrt(variance), prior])[:, inside]
    _, singular, turns = np.linalg.svd(rows, full_matrices=False)
    covariance = np.zeros((len(inside), len(inside)))
    covariance[np.ix_(inside, inside)] = (turns.T / singular**2) @ turns
    return paths, covariance * np.outer(sizes, sizes)


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


def undetermined_parameters(match: Match, margin: float) -> list[str]:
    """Parameters without which the points determine all others, by a margin in standard deviations.

    Each has the largest share in the direction that is determined least (Golub and Van Loan 2013, section 5.5.7).
    """
    slopes, _, variance, _ = _linearised(match, match.problem.paths, match.problem.scales.size)
    least = margin * float(np.sqrt(variance))
    triangle, kept = np.asarray(np.linalg.qr(slopes, mode="r")), np.arange(slopes.shape[1])
    while len(kept) > 1:
        _, values, turns = np.linalg.svd(triangle[:, kept])
        if values[-1] > max(least, values[0] / LARGEST_CONDITION):
            break
        kept = np.delete(kept, int(np.argmax(np.abs(turns[-1]))))
    return [path for place, path in enumerate(match.problem.paths) if place not in kept]


def _linearised(match: Match, paths: Sequence[str], sizes: Reals) -> tuple[Reals, Reals, float, float]:
    """Derivatives (m, k) of residuals by scaled parameters, and how much more these weigh than inverse variances (m,).

    The parameters are the free ones, and after them some that are held, of given scales (k,). Then the variance of the
    residuals of independent points, in chords, and its degrees of freedom.
    """
    cloud, problem = match.problem.cloud_residuals, match.problem
    rows, count = cloud.residuals(match.state), len(cloud.points)
    # how far edges may stand out is a limit on them, and no point that shows them
    shown = slice(len(rows) - len(cloud.overhang.u))
    rows, slopes = rows[shown], cloud.slopes(match.state, paths)[shown] * sizes
    excess = np.ones(len(rows))
    taking = cloud.roots > 0.0
    excess[:count] = np.where(taking, cloud.roots**2 / np.where(cloud.precision > 0.0, cloud.precision, 1.0), 1.0)
    excess[count : count + len(cloud.ends.near)] = excess[cloud.ends.near]
    places = neighbourhood_of(cloud.points, match.state.footpoints).places
    share = independent_share(places[taking], (rows / np.sqrt(excess))[:count][taking])
    inside = problem.scales.inside(problem.values_of(match.design))
    points, parameters = int(np.count_nonzero(taking)), int(np.count_nonzero(inside))
    variance = float(np.sum(rows[:count] ** 2 / excess[:count])) / max(points - parameters, 1) / share
    return slopes, excess, variance, max(share * points - parameters, 1.0)
