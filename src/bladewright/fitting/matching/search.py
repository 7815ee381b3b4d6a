"""The search for a design of one structure: rounds of least squares, each with the noise that the last one left.

A round's regularisation is as strong as the noise is large, so that a search from afar is held together by it, and a
search in exact data ends free of it. Knots, outliers and what lies at the ends are found anew for every round.
"""

from collections.abc import Callable, Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bladewright.designs import Design
from bladewright.domain.row import turn_matrix
from bladewright.errors import BladewrightError, DesignError, FitError
from bladewright.fitting.clouds.thinning import random_subset
from bladewright.fitting.free_parameters import FreeParameters, scales_of
from bladewright.fitting.matching.blade_ends import FACE_BAND, ROW_BAND, BladeEnds, blade_ends_of, edge_overhang_of
from bladewright.fitting.matching.footpoints import nearest_footpoints
from bladewright.fitting.matching.noise import EXACT, NoiseEstimate, noise_of
from bladewright.fitting.matching.residuals import CloudResiduals, MatchProblem, PlacedCloud, regularisation_of
from bladewright.fitting.models.model import Model, model_of
from bladewright.numerics.least_squares import FIRST_DAMPING, MIN_REDUCTION, constrained_minimum
from bladewright.nurbs.basis import Reals

EVALUATIONS_PER_ROUND = 10
"""evaluations in a round, after which knots, outliers and noise are updated (design/matching_constants.md)"""
MOST_ROUNDS = 12
"""rounds of a search at most: it bounds the time (design/matching_constants.md)"""
SETTLED_RATIO = 0.995
"""ratio of a round's misfit to the one before from which a search has settled (design/matching_constants.md)"""
ROUGH_REDUCTION = 0.01
"""predicted relative reduction of the cost that a step on the way needs (design/matching_constants.md)"""
REGULARISATION_DECAY = 0.5
"""ratio of the noise that a fading regularisation is for to that of the round before, at most (iteratively regularised
Gauss-Newton: Bakushinskii 1992; design/matching.md)"""
QUICK_ROUNDS = 2
"""rounds of a search on the way (design/matching_constants.md); of one on whose misfit a decision rests one more"""
FAST_RATIO = 0.5
"""ratio of misfits below which the next round is predicted to have the same (design/matching_constants.md)"""
EXACT_MISFIT = 3e-14
"""misfit below which nothing is left to find, of the chord: rounding (design/matching_constants.md)"""
NATIVE_TOLERANCE_OF_NOISE = 0.1
"""tolerance of the native surfaces in a round, of the noise (design/matching_constants.md)"""
KEPT_DESIGNS = 3
"""designs of as many parameters that are kept, as the nearest may not be built (design/matching_constants.md)"""
REFUSED_MARGIN = 6.0
"""factor of the margin of edge radii where a match is refused when built (design/matching_constants.md)"""
EDGE_RADIUS_MARGIN = {2: 2e-6, 3: 2e-5}
"""margin by which the control point that sets an edge's radius is held below the thickness beside it, of the section's
extent, by dimension: a blade is refused between its stations too (design/matching_constants.md)"""
NOISE_CORRELATION = 0.15
"""share of the misfit that neighbours have in common below which it is noise (design/matching_constants.md)"""
FAR_OFF = 3.0
"""rms misfit, in standard deviations by the median, beyond which it is no noise (design/matching_constants.md)"""
EXACT_NOISE = 1e-5
"""noise of an exact cloud, of the chord: errors reach half of `EXACT` (Tippett 1925; design/matching_constants.md)"""

Progress = Callable[[str], None]
"""is handed a few words on what is done"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Match:
    """A design found for a cloud: where a search ended.

    It does not hold the task, whose best designs so far are matches: only the cyclic collector would free the clouds.
    """

    design: Design
    problem: MatchProblem
    state: PlacedCloud
    noise_estimate: NoiseEstimate
    ends: BladeEnds
    damping: float
    evaluations: int
    converged: bool = False
    """whether the last descent converged"""
    interrupted: bool = False
    turn: float = 0.0
    """angle about x by which the task's points are turned [rad]"""
    held: frozenset[str] = frozenset()
    """parameters of the task that are held as the points do not determine them"""

    @property
    def model(self) -> Model:
        """The model of the last round."""
        return self.problem.model

    @property
    def rows(self) -> NDArray[np.bool_]:
        """(n,) whether a point takes part as a point of the sides."""
        return self.noise_estimate.inliers & ~self.ends.on_end_face

    @property
    def rms(self) -> float:
        """Root mean square of the distances of those points, of the chord."""
        return float(np.sqrt(np.mean(self.state.footpoints.distances[self.rows] ** 2))) / self.model.chord

    @property
    def mean_distance(self) -> float:
        """Mean distance of all points except those on end faces, outliers included [m]."""
        return float(np.mean(self.state.footpoints.distances[~self.ends.on_end_face]))

    @cached_property
    def misfit(self) -> float:
        """Root mean square of all residuals, those of ends, walls and edges included, of the chord."""
        residuals = self.problem.cloud_residuals.residuals(self.state)
        return float(np.sqrt(np.sum(residuals**2) / max(1.0, float(np.count_nonzero(self.rows)))))

    @property
    def maximum(self) -> float:
        """Largest distance of those points [m]."""
        return float(np.max(self.state.footpoints.distances[self.rows]))

    @property
    def has_systematic_misfit(self) -> bool:
        """Whether the misfit is not noise: neighbours share it, or few points are far off."""
        estimate = self.noise_estimate
        return estimate.correlation > NOISE_CORRELATION or self.rms * self.model.chord > FAR_OFF * estimate.noise

    @property
    def is_exact(self) -> bool:
        """Whether neighbouring points tell that the cloud has next to no noise."""
        return self.noise_estimate.noise < EXACT_NOISE * self.model.chord


@dataclass(frozen=True, eq=False)
class BestSoFar:
    """The nearest matches so far, by their number of parameters, as the last may be interrupted, or cannot be built."""

    found: dict[int, list[Match]] = field(default_factory=dict)

    def note(self, found: Match) -> None:
        """Keeps the end of a round if few of as many parameters are nearer."""
        if np.isfinite(found.mean_distance):
            alike = [*self.found.get(count := len(found.problem.paths), ()), found]
            self.found[count] = sorted(alike, key=lambda each: each.mean_distance)[:KEPT_DESIGNS]

    def built(
        self, least_tolerance: float = 0.0, suits: Callable[[Match], bool] = lambda _: True
    ) -> tuple[Match, Any] | None:
        """The nearest match that suits and can be built, no finer than a tolerance, and what it builds, or None."""
        suitable = filter(suits, chain.from_iterable(self.found.values()))
        for found in sorted(suitable, key=lambda each: each.mean_distance):
            tolerance = getattr(found.design, "tolerance", None)
            design = found.design.changed({} if tolerance is None else {"tolerance": max(tolerance, least_tolerance)})
            with suppress(BladewrightError):
                return replace(found, design=design), design.build()
        return None

    def instead_of(self, refused: Match, error: Exception, *, structured: bool) -> tuple[Match, Any, str]:
        """The same of the family of a match that cannot be built, and a note; raises FitError where there is none.

        It has as many parameters at most, and the same ones where the structure is given (`structured`).
        """
        paths = refused.problem.paths

        def suits(found: Match) -> bool:
            alike = found.problem.paths == paths if structured else len(found.problem.paths) <= len(paths)
            return alike and isinstance(found.design, type(refused.design))

        found, refusal = self.built(suits=suits), f"the nearest design cannot be built ({error})"
        if found is None:
            axis = ", or name the machine axis where it is not x (--axis)" if refused.design.dimension == 3 else ""
            raise FitError(f"{refusal}; give a start design, or bounds that keep off it{axis}") from error
        return *found, f"{refusal}, and the nearest that can is given"


@dataclass(frozen=True, kw_only=True, eq=False)
class Task:
    """What is sought: points, weights, free parameters and bounds."""

    points: Reals
    """(n, d) of the cloud [m]"""
    weights: Reals
    """(n,) of the points in the sum of squares, 1 on average"""
    free: FreeParameters = field(default_factory=FreeParameters)
    """the free parameters of a design, whatever its structure"""
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """lowest and highest values by pattern, in the units of the fields"""
    progress: Progress = lambda _: None
    regularisation_factor: float = 1.0
    """factor of the regularisation"""
    margin_factor: float = 1.0
    """factor of the margin that keeps edge radii from what is refused"""
    precision: Reals | None = None
    """(n,) inverse variances of the points, relative to each other; None where they are equal"""
    allow_outliers: bool = True
    """whether points may be outliers; where none may, edges stand out of exact ones no further than of noisy ones"""
    trusted: NDArray[np.bool_] | None = None
    """(n,) points that are no outliers"""
    cut_edges: frozenset[str] = frozenset()
    """edges that are cut off, which may stand out of the cloud"""
    preliminary: bool = False
    """whether a search is only to begin another: what its few control points miss is shared by neighbours, no noise"""
    walls: tuple[Reals, ...] = ()
    """(m, 2) points of hub and shroud beside the blade, in (x, r) or (x, z) [m]: they show where it ends"""
    outline: tuple[Reals, ...] = ()
    """(m, 2) places of hub and shroud on the outline of the points [m], by which a preliminary search knows its ends"""
    turn: float = 0.0
    """angle about x by which the points are turned from where they are given [rad]"""
    held: frozenset[str] = frozenset()
    """parameters that are held as the points do not determine them"""
    best_so_far: BestSoFar = field(default_factory=BestSoFar)

    @property
    def dimension(self) -> int:
        """2 for a cloud of a section, 3 for one of a blade."""
        return int(self.points.shape[1])

    def thinned(self, most: int) -> "Task":
        """The same task with at most so many of its points, drawn at random but always the same."""
        return self.part(random_subset(len(self.points), most))

    def turned(self, angle: float) -> "Task":
        """The same task with its points (n, 3) turned about x, so that theta grows by an angle [rad]."""
        if not angle:
            return self
        return replace(self, points=self.points @ turn_matrix(angle).T, turn=self.turn + angle)

    def without(self, paths: Collection[str]) -> "Task":
        """The same task with some parameters that do not change."""
        return replace(self, free=replace(self.free, held=self.free.held.union(paths)))

    def holding(self, held: Collection[str]) -> "Task":
        """The same task with some parameters held that the points do not determine."""
        return replace(self.without(held), held=self.held | {*held})

    def trusting(self, match: Match) -> "Task":
        """The same task, in which no point is an outlier that a match of it counts as the blade's."""
        return replace(self, trusted=match.rows)

    def part(self, rows: NDArray[np.intp]) -> "Task":
        """The same task with some of the points (m,)."""
        return replace(
            self,
            points=self.points[rows],
            weights=self.weights[rows],
            precision=None if self.precision is None else self.precision[rows],
            trusted=None if self.trusted is None else self.trusted[rows],
        )


def can_be_built(design: Any) -> bool:
    """Whether `build` does not refuse a design."""
    try:
        design.build()
    except DesignError:
        return False
    return True


def buildable(task: Task, match: Match) -> Match | None:
    """A match that `build` takes: where it is refused, one whose edge radii are kept further off; None of none."""
    if can_be_built(match.design):
        return match
    # what a match holds stays held
    further = replace(task, margin_factor=REFUSED_MARGIN, free=FreeParameters(free=match.problem.paths))
    try:
        found = searched(further, match.design, noise=match.rms, rounds=1, min_reduction=ROUGH_REDUCTION)
    except FitError:
        return None
    return found if can_be_built(found.design) else None


def searched(
    task: Task,
    start: Design | Match,
    *,
    rounds: int = MOST_ROUNDS,
    noise: float | None = None,
    min_reduction: float = MIN_REDUCTION,
    enough: Callable[[Match], bool] = lambda found: found.misfit < EXACT_MISFIT,
    settled: float = SETTLED_RATIO,
    fading: bool = False,
) -> Match:
    """The design nearest to the cloud that a search from `start`, a design or a match evaluated for it, finds.

    `noise`, of the chord, is the first round's; None takes the misfit of the start, and a match brings its own. The
    structure is that of `start`. `min_reduction` is the relative reduction of the cost that a step must predict. The
    search ends after a round that is `enough`, or leaves more than the share `settled` of the misfit. While the misfit
    is systematic, the regularisation does not rise, and falls where it is `fading`. Raises FitError where the start has
    no shape, and KeyboardInterrupt after it has noted the best design of a round that was interrupted.
    """
    found, rounds_without_gain = start if isinstance(start, Match) else evaluated(task, start, noise=noise), 0
    task.best_so_far.note(found)
    for number in range(rounds):
        before = found.misfit
        if number and enough(found):
            break
        try:
            prepared = found if number == 0 else evaluated(task, found.design, noise=noise, before=found)
            found = _descended_round(task, prepared, min_reduction)
        except (DesignError, FitError):
            # at finer knots, or in a derivative, the design has no shape: the round before stands
            break
        task.best_so_far.note(found)
        rms = f"{1e3 * found.rms * found.model.chord:.3g} mm rms, {1e3 * found.maximum:.3g} mm at most"
        task.progress(f"{len(found.problem.paths)} parameters, {rms}")
        ratio = found.misfit / before
        rounds_without_gain = rounds_without_gain + 1 if ratio**2 > min(settled**2, 1.0 - min_reduction) else 0
        if number and rounds_without_gain and (found.converged or rounds_without_gain > 1):
            break
        last = found.rms if noise is None else noise
        noise = found.rms * (max(ratio, 1e-3) if ratio < FAST_RATIO else 1.0)
        if found.has_systematic_misfit:
            least = REGULARISATION_DECAY * last if fading else last
            noise = min(noise, max(least, found.noise_estimate.noise / found.model.chord))
    return found


def evaluated(task: Task, design: Design, *, noise: float | None, before: Match | None = None) -> Match:
    """A design as it stands before a round, whose problem begins with the start of the round `before`.

    `noise` is the round's, of the chord; None takes the misfit. Raises FitError where the design has no shape.
    """
    start = design if before is None else before.problem.start
    points, paths = task.points, task.free(start)
    tolerance = float(np.clip(NATIVE_TOLERANCE_OF_NOISE * (noise or 1.0), getattr(design, "tolerance", 1e-6), EXACT))
    try:
        model = model_of(design, tolerance)
        shape = model.shape(design)
    except DesignError as error:
        raise FitError(f"the start design has no shape ({error}); give another start, or none") from error
    if not shape.finite:
        raise FitError("the start design has no shape near its edges: give another start, or none")
    footpoints = nearest_footpoints(points, shape.sides)
    trusted = task.trusted if task.allow_outliers else np.ones(len(points), dtype=bool)
    noise_estimate = noise_of(points, footpoints, task.precision, trusted=trusted)
    walls = task.walls or (task.outline if task.preliminary else ())
    # where no design gives the ends, the outline of the points does
    reach = FACE_BAND if task.outline else ROW_BAND
    ends = blade_ends_of(points, footpoints, shape, noise_estimate.inliers, walls, reach)
    rows = noise_estimate.inliers & ~ends.on_end_face
    if noise is None:
        noise = float(np.sqrt(np.mean(footpoints.distances[rows] ** 2))) / model.chord
    # of a cloud without noise the true edge is to cost nothing, but where points are doubted
    exact = task.allow_outliers and noise_estimate.noise < EXACT * float(np.max(np.ptp(points, axis=0)))
    scales = scales_of(start, paths, model.chord, task.bounds)
    share = noise_estimate.independent_share(len(paths))
    shown, own = ends.in_rows(model.chord), 1.0 if task.preliminary else share
    regularisation = regularisation_of(start, paths, scales.size, ends_shown=shown, independent_share=own)
    regularisation = regularisation.scaled(task.regularisation_factor / float(np.sqrt(share / own)))
    cloud_residuals = CloudResiduals(
        points=points,
        roots=np.sqrt(task.weights * rows),
        model=model,
        ends=ends,
        overhang=edge_overhang_of(points, shape.sides, rows, exact=exact, cut_edges=task.cut_edges),
        noise=noise,
        precision=np.ones(len(points)) if task.precision is None else task.precision,
    )
    begun = PlacedCloud(shape=shape, footpoints=footpoints)
    problem = MatchProblem(
        cloud_residuals=cloud_residuals,
        start=start,
        paths=paths,
        scales=scales,
        regularisation=regularisation.scaled(noise),
        edge_height_noise=noise / float(np.sqrt(share / task.regularisation_factor**2)),
        begun=begun,
        margin=EDGE_RADIUS_MARGIN[points.shape[1]] * task.margin_factor,
    )
    return Match(
        design=design,
        problem=problem,
        state=begun,
        noise_estimate=noise_estimate,
        ends=ends,
        damping=FIRST_DAMPING if before is None else before.damping,
        turn=task.turn,
        held=task.held,
        evaluations=1 if before is None else before.evaluations + 1,
    )


def _descended_round(task: Task, match: Match, min_reduction: float) -> Match:
    """What a descent from a prepared design finds; where it is interrupted, its best design is noted first."""
    problem = match.problem
    try:
        start, steps = problem.vector(match.design), EVALUATIONS_PER_ROUND
        descent = constrained_minimum(problem, start, steps=steps, damping=match.damping, min_reduction=min_reduction)
    except KeyboardInterrupt:
        task.best_so_far.note(_moved(match, problem.best))
        raise
    return replace(_moved(match, descent.z), damping=descent.damping, converged=descent.converged)


def _moved(match: Match, z: Reals) -> Match:
    """The match at other variables of its problem, or as it is where they describe no shape."""
    problem = match.problem
    state = problem.state(z) or match.state
    evaluations = match.evaluations + problem.evaluations
    return replace(match, design=state.shape.design, state=state, evaluations=evaluations)
