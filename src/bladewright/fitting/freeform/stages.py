"""The way to a good match: from stiff to soft, from given to unknown weights, from all points to the inliers."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bladewright.fitting.freeform.least_squares import Penalty, rank_of, singular_values
from bladewright.fitting.freeform.net import Net, NetMatch, NetTarget, matched_net
from bladewright.fitting.freeform.projection import projected
from bladewright.numerics.robust import TUKEY_WIDTH, median_deviation, tukey_weights
from bladewright.nurbs.basis import Reals

STIFFNESSES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-13)
"""weights of the bending, in extents of the points squared, in turn"""
STIFFNESS_COST = 1.002
"""rise of the root mean square that a stiffness may cost where points leave control points undetermined."""
WELL_DETERMINED = 1e-4
"""smallest singular value, of the largest, from which every direction is determined well."""
LAST_EVALUATIONS = (200, 80)
"""evaluations of the last descent of a curve and of a surface"""
ROUGH_FALL = 1e-3
"""relative fall of the value at which an intermediate match ends."""
KNOT_ROUNDS = 25
"""times that knots are added at most; it bounds the time."""
OUTLYING_NOISE = 4.5
"""standard deviations of the noise from which a point is an outlier."""
FIRST_WIDTH, WIDTH_FACTOR = 0.3, 2.0
"""first width of Tukey's weights, of the extent, and factor by which it shrinks to what the noise needs
(`WIDTH_FACTOR`): so slowly that the ends of a shape are reached before their points could be taken for outliers."""
NEVER_OUTLIER = 1e-10
"""distance, of the extent, up to which no point is an outlier."""


@dataclass(frozen=True, kw_only=True)
class FitOptions:
    """What is asked of a match."""

    power: float = 2.0
    weights_free: bool = False
    robust: bool = False
    always_stiff: bool = False
    """whether the bending stays as large as the noise allows, also where every direction is determined"""
    limit: float | None = None
    """largest distance, in extents"""
    extent: float = 1.0
    """of the points in their own unit, for messages"""
    progress: Callable[[str], None] | None = None

    def report(self, text: str) -> None:
        """Hands a short text to the progress, if there is one."""
        if self.progress is not None:
            self.progress(text)


@dataclass(frozen=True, kw_only=True, eq=False)
class StagedMatch:
    """A match of the inliers, and the figures of the problem."""

    match: NetMatch
    inliers: NDArray[np.bool_]
    evaluations: int

    @property
    def singular_values(self) -> Reals:
        """Of the distances by the unknowns, each scaled to length one."""
        return singular_values(self.match.data.curvature)

    @property
    def rank(self) -> int:
        """Directions of the unknowns that the points determine."""
        return rank_of(self.singular_values)


KnotSource = Callable[[StagedMatch, NetTarget, FitOptions, float], tuple[Net | None, str]]
"""gives a net with further knots, or None and the reason"""


def staged_match_within(
    net: Net, target: NetTarget, options: FitOptions, further: KnotSource, *, warm: bool
) -> tuple[StagedMatch, tuple[str, ...]]:
    """The match within a largest distance, where there is one, and why it is not reached otherwise.

    `further` gives a net with further knots, or None and the reason; a `warm` net is near already.
    """
    found = staged_match(net, target, options, warm=warm)
    evaluations, reason = found.evaluations, ""
    for _ in range(KNOT_ROUNDS):
        if options.limit is None or found.match.footpoints.distances.max() <= options.limit:
            return replace(found, evaluations=evaluations), ()
        more, reason = further(found, target, options, options.limit)
        if more is None:
            return replace(found, evaluations=evaluations), (reason,)
        options.report(f"{len(more.points)} control points")
        found = staged_match(more, target, options, warm=True)
        evaluations += found.evaluations
    return replace(found, evaluations=evaluations), (
        f"the tolerance is not reached after {KNOT_ROUNDS} rounds of knots",
    )


def staged_match(net: Net, target: NetTarget, options: FitOptions, *, warm: bool = False) -> StagedMatch:
    """The match of a net to points, stage by stage; of a `warm` one, near already, only the last stages are left."""
    inliers = np.ones(len(target.points), dtype=bool)
    total = 0
    if options.robust:
        net, inliers, total = _without_outliers(net, target, options, warm=warm)
        target = target_rows(target, inliers)
    match = _match_by_stiffnesses(net, target, options, None, last=2 if warm else None)
    total += match.evaluations
    if options.weights_free and not net.weighted:
        options.report("free weights")
        freed = replace(match.net, weighted=True, log_weights=match.net.log_weights)
        match = _match_by_stiffnesses(freed, target, options, match.footpoints.parameters, last=2)
        total += match.evaluations
    if options.power != 2.0:
        options.report(f"power {options.power:g}")
        scale = max(float(match.footpoints.distances.max()), NEVER_OUTLIER)
        penalty = Penalty(power=options.power, scale=scale)
        match = matched_net(
            match.net, target, penalty=penalty, near=match.footpoints.parameters, stiffness=_least_stiffness(match)
        )
        total += match.evaluations
    return StagedMatch(match=match, inliers=inliers, evaluations=total)


def target_rows(target: NetTarget, rows: NDArray[np.bool_]) -> NetTarget:
    """The points of some rows; held ones stay held where they are among them."""
    held = target.held
    if held is not None:
        kept = rows[held[0]]
        new = np.cumsum(rows) - 1
        held = (new[held[0][kept]], held[1][kept])
    return NetTarget(points=target.points[rows], weights=target.weights[rows], held=held)


def _match_by_stiffnesses(
    net: Net, target: NetTarget, options: FitOptions, near: Reals | None, *, last: int | None = None
) -> NetMatch:
    tried: list[NetMatch] = []
    total = 0
    levels = list(STIFFNESSES[0 if last is None else -last :])
    for stiffness in levels:
        options.report(f"{len(net.points)} control points, stiffness {stiffness:g}")
        match = matched_net(
            net, target, penalty=Penalty(), stiffness=stiffness, near=near, evaluations=20, tolerance=ROUGH_FALL
        )
        net, near = match.net, match.footpoints.parameters
        total += match.evaluations
        tried.append(match)
        if stiffness == levels[-1] and stiffness > 0.0 and _least_stiffness(match, well=options.always_stiff) == 0.0:
            levels.append(0.0)
    best = len(tried) - 1
    if options.always_stiff:
        enough = STIFFNESS_COST * max(_rms(tried[-1]), NEVER_OUTLIER)
        best = next(i for i, each in enumerate(tried) if _rms(each) <= enough)
    net, near = tried[best].net, tried[best].footpoints.parameters
    match = matched_net(
        net,
        target,
        penalty=Penalty(),
        stiffness=levels[best],
        near=near,
        certain=True,
        evaluations=LAST_EVALUATIONS[len(net.knots) - 1],
    )
    return replace(match, evaluations=total + match.evaluations)


def _least_stiffness(match: NetMatch, *, well: bool = False) -> float:
    """No stiffness where the points determine all unknowns, or determine them `well`; else the least one."""
    values = singular_values(match.data.curvature)
    determined = values[-1] > WELL_DETERMINED * values[0] if well and len(values) else rank_of(values) == len(values)
    return 0.0 if determined else STIFFNESSES[-1]


def _rms(match: NetMatch) -> float:
    return float(np.sqrt(np.mean(match.footpoints.distances**2)))


def _without_outliers(
    net: Net, target: NetTarget, options: FitOptions, *, warm: bool
) -> tuple[Net, NDArray[np.bool_], int]:
    """The net matched with Tukey's weights, and which points are no further from it than noise explains."""
    footpoints, total, width = projected(net.shape, target.points, closed=net.closed), 0, FIRST_WIDTH
    stiffnesses = [STIFFNESSES[2]] if warm else list(STIFFNESSES[:3])
    while True:
        least = max(TUKEY_WIDTH * median_deviation(footpoints.distances), NEVER_OUTLIER)
        width = max(width, least)
        options.report(f"without outliers, width {width:.2g}")
        match = matched_net(
            net,
            replace(target, weights=target.weights * tukey_weights(footpoints.distances, width)),
            penalty=Penalty(),
            stiffness=stiffnesses[0],
            near=footpoints.parameters,
            evaluations=40,
            tolerance=ROUGH_FALL,
        )
        net, footpoints = match.net, match.footpoints
        total += match.evaluations
        if width <= least and len(stiffnesses) == 1:
            break
        width, stiffnesses = width / WIDTH_FACTOR, stiffnesses[1:] or stiffnesses
    distances = footpoints.distances
    return net, distances <= max(OUTLYING_NOISE * median_deviation(distances), NEVER_OUTLIER), total
