"""What is said of a match: every point against what the design builds, and how well each parameter is known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.special import stdtrit

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.cut_lines import in_meridian
from bladewright.fitting.clouds.thinning import random_subset
from bladewright.fitting.free_parameters import EDGES, scales_of
from bladewright.fitting.matching.blade_ends import END_PARAMETERS, WallPoints, blade_ends_of
from bladewright.fitting.matching.footpoints import EDGE_PARAMETERS, Footpoints, nearest_footpoints
from bladewright.fitting.matching.noise import EDGE_BAND, neighbourhood_of, noise_of
from bladewright.fitting.matching.residuals import regularisation_of
from bladewright.fitting.matching.search import Match
from bladewright.fitting.models.model import ModelShape, blunt_edges_of, on_sides, sides_of
from bladewright.numerics.robust import median_deviation
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.closest import Descents
from bladewright.nurbs.surface import Surface
from bladewright.section.section import Section

LAST_STEP = 1e-10
"""last step of descents, in a patch's parameters: a chord of 36 mm is met to 1e-11 m, and with 1e-8 to 2e-10 m"""
OFF_SIDES = 3.0
"""standard deviations from which a point is off the sides, maybe on another face: three sigma (Pukelsheim 1994)"""

FIGURES = ("mean", "rms", "percentile_99", "maximum")
"""figures of a deviation that are reported"""


@dataclass(frozen=True, kw_only=True)
class Deviation:
    """Distances of some points of a cloud from the surface [m]."""

    count: int
    mean: float
    rms: float
    percentile_99: float
    maximum: float


def deviation_of(distances: Reals) -> Deviation:
    """The figures of distances (n,) [m]; no numbers where there are none."""
    if len(distances) == 0:
        return Deviation(count=0, **dict.fromkeys(FIGURES, math.nan))
    return Deviation(
        count=len(distances),
        mean=float(np.mean(distances)),
        rms=float(np.sqrt(np.mean(distances**2))),
        percentile_99=float(np.percentile(distances, 99.0)),
        maximum=float(np.max(distances)),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class PlacesOfPoints:
    """Where the n points of a cloud lie on what was built."""

    places: NDArray[np.str_]
    """(n,) name of the nearest curve or surface: `upper`, `lower`, or one of the blade's ends or faces"""
    u: Reals
    """(n,) parameter of the nearest place along the chord"""
    v: Reals
    """(n,) parameter of the nearest place along the span; 0 for a section"""
    deviations: Reals
    """(n,) distance from the nearest place, positive outside the blade [m]"""
    regions: NDArray[np.str_]
    """(n,) region of each point: `sides`, `leading edge`, `trailing edge` or `ends`"""
    inliers: NDArray[np.bool_]
    """(n,) whether a point took part; the others are outliers, or set aside"""
    set_aside: NDArray[np.str_]
    """(n,) what a point lies on that is none of the sides, such as `hub fillet`; empty where it took part"""
    noise: float
    """standard deviation of the cloud's own noise, as neighbouring points show it [m]"""

    @property
    def distances(self) -> Reals:
        """(n,) true distances from the surface [m]."""
        return np.sqrt(self.deviations**2)

    @property
    def outliers(self) -> NDArray[np.intp]:
        """Indices of the points that are outliers."""
        return np.flatnonzero(~self.inliers & (self.set_aside == ""))

    @property
    def worst(self) -> int:
        """Index of the inlier that is farthest off."""
        return int(np.argmax(np.where(self.inliers, self.distances, -np.inf)))

    @cached_property
    def deviation(self) -> Deviation:
        """Of all inliers."""
        return deviation_of(self.distances[self.inliers])

    @property
    def mean(self) -> float:
        """Mean distance of the inliers [m]."""
        return self.deviation.mean

    @property
    def maximum(self) -> float:
        """Largest distance of an inlier [m]."""
        return self.deviation.maximum


@dataclass(frozen=True, kw_only=True, eq=False)
class Measurement(PlacesOfPoints):
    """Where the n points of a cloud lie on what was built, with the footpoints before cuts and fillets."""

    footpoints: Footpoints


def measured(
    points: Reals,
    built: Blade | Section,
    precision: Reals | None = None,
    *,
    hidden: NDArray[np.str_] | None = None,
    finished: Blade | None = None,
    hint: Footpoints | None = None,
) -> Measurement:
    """Every point's nearest place and signed distance on a blade or section, before cuts and fillets.

    `precision` (n,) are inverse variances of the points, relative to each other. Where `hidden` (n,) is not
    empty, points off the sides are set aside: on a `wall` or a `fillet` beside the blade, or on the faces of cuts and
    fillets that the `finished` blade has, where they are nearer to these. So are points of the end faces, which are
    outliers to the sides. A `hint` are the footpoints on a blade that is hardly another one.
    """
    sides = sides_of(built)
    exact = built.exact if isinstance(built, Blade) else None
    footpoints = nearest_footpoints(points, sides, hint, converged=LAST_STEP)
    # the longest name is "cut trailing edge"
    set_aside, off = np.full(len(points), "", dtype="<U20"), footpoints.distances
    if hidden is not None and finished is not None and np.any(hidden != ""):
        rows = np.flatnonzero(hidden != "")
        rows = rows[off[rows] > OFF_SIDES * median_deviation(off[hidden == ""])]
        names, far = off_finished_faces(points[rows], finished)
        if finished is built:
            # it has no fillets of its own
            set_aside[rows] = np.where(hidden[rows] == "fillet", np.char.add(names, " fillet"), names)
        else:
            set_aside[rows] = np.where(far < off[rows], names, "")
        off[rows] = np.minimum(far, off[rows])
    rows = np.flatnonzero(set_aside == "")
    noise_estimate = noise_of(points[rows], footpoints.part(rows), None if precision is None else precision[rows])
    inliers = np.zeros(len(points), dtype=bool)
    inliers[rows] = noise_estimate.inliers
    shape = ModelShape(design=None, sides=sides, exact=exact)
    on_end_face = blade_ends_of(points, footpoints, shape, set_aside == "").on_end_face
    deviations = np.where(footpoints.heights < 0.0, -1.0, 1.0) * off
    near_edges = [footpoints.u < EDGE_BAND, footpoints.u > 1.0 - EDGE_BAND]
    footpoints, on_face = on_sides(footpoints, blunt_edges_of(built))
    on_side = np.where(footpoints.side == 0, "upper", "lower")
    places = np.select([set_aside != "", on_face < 0, on_face > 0], [set_aside, *EDGES], on_side)
    past_end = np.abs(np.sum(footpoints.miss * footpoints.beyond, axis=1)) > np.abs(footpoints.heights)
    regions = np.select([past_end, *near_edges], ["ends", *EDGE_PARAMETERS], "sides")
    if isinstance(built, Blade):
        for (name, end), face in zip(END_PARAMETERS.items(), built.design.ends, strict=True):
            rows = np.flatnonzero(on_end_face & (np.abs(footpoints.v - end) < 0.5))
            set_aside[rows[~inliers[rows] & (set_aside[rows] == "")]] = face
            outward = _off_wall(name, points[rows], built) * (1.0 if end else -1.0)
            nearer = np.abs(outward) < np.abs(deviations[rows])
            deviations[rows[nearer]] = outward[nearer]
            places[rows[nearer]], regions[rows[nearer]] = face, "ends"
    return Measurement(
        places=places,
        u=footpoints.u,
        v=footpoints.v,
        footpoints=footpoints,
        deviations=deviations,
        regions=regions,
        inliers=inliers,
        noise=noise_estimate.noise,
        set_aside=set_aside,
    )


def _off_wall(name: str, points: Reals, built: Blade) -> Reals:
    """Signed distances (n,) [m] of points (n, 3) from hub or shroud."""
    places = in_meridian(points, built.exact.mapping.revolved)
    return WallPoints(name=name, places=places).located(built.exact)[2]


def off_walls(points: Reals, built: Blade) -> dict[str, Reals]:
    """Distances (n,) [m] of points (n, 3) from the walls and faces of revolution that cuts and fillets have changed."""
    places = in_meridian(points, built.exact.mapping.revolved)
    return {name: np.sqrt(Descents((curve,)).nearest(places).square) for name, (curve, _) in built.walls.items()}


def off_finished_faces(points: Reals, built: Blade) -> tuple[NDArray[np.str_], Reals]:
    """The nearest of these faces for each of points (n, 3), such as `cut trailing edge`, and how far it is [m]."""
    off = {f"cut {name}" if name.endswith("_edge") else name: far for name, far in off_walls(points, built).items()}
    for wall, name in zip(END_PARAMETERS, built.design.ends, strict=True):
        if name not in off:
            off[name] = np.abs(_off_wall(wall, points, built))
    for name, face in built.surfaces.items():
        if "_fillet" in name and isinstance(face, Surface):
            own = f"{name.partition('_')[0]} fillet"
            far = np.sqrt(Descents((face,)).nearest(points).square)
            off[own] = np.minimum(off.get(own, np.inf), far)
    names, every = np.array([name.replace("_", " ") for name in off]), np.stack(list(off.values()))
    nearest = np.argmin(every, axis=0)
    return names[nearest], every[nearest, np.arange(len(points))]


IDENTIFIED_SPREAD = 0.3
"""deviation of a determined parameter, of its scale: the 95 % interval is about one (design/matching_constants.md)"""
CORRELATED_POINTS, CORRELATED_NEIGHBOURS = 2000, 512
"""points that are compared with neighbours, and these at most; they bound the time (design/matching_constants.md)"""
FIRST_NEIGHBOURS, BY_CHANCE = 4, 2.0
"""neighbours compared first, doubled each time, and standard errors of a correlation by chance (95 %: Bartlett 1946)"""
LARGEST_CONDITION = 1e7
"""condition of the scaled derivatives from which a parameter is not determined (design/matching_constants.md)"""


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

    @property
    def unidentified(self) -> tuple[str, ...]:
        """Parameters that the cloud does not determine."""
        return tuple(each.path for each in self.estimates if not each.identified)

    @property
    def at_bounds(self) -> tuple[str, ...]:
        """Parameters that lie on one of their bounds."""
        return tuple(each.path for each in self.estimates if each.at_bound)


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
    deviations = spread * scales.size
    reach = float(stdtrit(left, 0.975)) * deviations
    estimates = tuple(
        Estimate(
            path=path,
            value=float(values[i]),
            deviation=float(deviations[i]),
            low=float(values[i] - reach[i]),
            high=float(values[i] + reach[i]),
            identified=bool(spread[i] < IDENTIFIED_SPREAD),
            at_bound=not inside[i],
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
