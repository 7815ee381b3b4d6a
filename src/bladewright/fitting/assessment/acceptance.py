"""Whether a match may be trusted, and why not."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bladewright.fitting.assessment.coverage import least_thickness, loose_ends, uncovered_edges
from bladewright.fitting.assessment.estimates import ParameterEstimates
from bladewright.fitting.assessment.lengths import with_unit
from bladewright.fitting.clouds.cloud import is_rounded
from bladewright.fitting.initial_guess.blade import AXES_HINT
from bladewright.fitting.matching.search import Match
from bladewright.fitting.model_selection.stopping import ENOUGH_DEVIATION, MatchTarget
from bladewright.nurbs.basis import Reals

GROSS_DEVIATION = (1.5e-3, 5e-3)
"""mean and largest distance allowed where no tolerance is stated, of the chord: a match beyond them is of another
blade, or has far too few parameters."""
EXACT_MISFIT, SYSTEMATIC_OVER_NOISE = 1e-9, 3.0
"""misfit of a given structure that is rounding, of the chord; `SYSTEMATIC_OVER_NOISE` is the misfit, in noises, from
which it is none."""
FINEST_NOISE = 1e-6
"""misfit of a given structure, of the chord, below which it cannot be the noise of a measured cloud."""
SHAPE_CORRELATION = 0.5
"""share of the misfit that neighbours have in common from which it is the shape's, where nothing is asked for."""
ACCEPTED_MISFIT = {2: 5e-5, 3: 1e-4}
"""root mean square misfit, of the chord and by dimension, that is near enough where nothing is asked for: less than a
blade can be made to."""
LARGEST_OUTLIER_SHARE = 0.1
"""share of the points that may be outliers: with more, the cloud is not one blade of the family."""
LISTED_NAMES = 5
"""parameters that a note lists by name"""
SIDES = ("upper", "lower")
"""names of the sides, by their number in footpoints"""
HALF_BLADE_WIDTH = 0.5
"""width of the blade where its points end, of its thickest, from which it is half a blade."""
SHEET_THICKNESS = 3e-3
"""thickness, of the chord, below which no blade is. Two sides laid through one side of Aachen's stator were 0.2 % of
the chord apart; the thinnest example, an impeller, has 1.3 %."""
FEWEST_POINTS_PER_PARAMETER = 1.5
"""points for each parameter of a blade that it needs where nothing is asked for: a hundred scattered points had passed
with 88 parameters (design/fit_clouds.md)."""
MIN_SIDE_SHARE, BETWEEN_EDGES = 0.1, 0.1
"""share of the points between the edges below which a side is not shown; `BETWEEN_EDGES` is where the edges end, in
u."""


def failures_of(
    distances: Reals,
    inliers: NDArray[np.bool_],
    regions: NDArray[np.str_],
    match: Match,
    target: MatchTarget,
    *,
    faced: int = 0,
) -> tuple[str, ...]:
    """Why a match does not pass, each a sentence; `faced` is the number of outliers on end faces."""
    failures = []
    chord = match.model.chord
    kept = distances[inliers]
    if match.interrupted:
        failures.append("the search was interrupted: this is the best design so far")
    off = len(distances) - len(kept) - faced
    if off > LARGEST_OUTLIER_SHARE * len(distances):
        failures.append(f"{off} of {len(distances)} points lie off the blade: is it one blade, and of this family?")
    worst = int(np.flatnonzero(inliers)[np.argmax(kept)])
    if target.tolerance is not None and kept.max() > target.tolerance:
        failures.append(
            f"the largest deviation is {with_unit(match.design, kept.max(), 4)} ({regions[worst]}, point {worst}), and "
            f"{with_unit(match.design, target.tolerance, 4)} were asked for"
        )
    elif target.tolerance is None:
        for word, value, limit in (
            ("mean", np.mean(kept), GROSS_DEVIATION[0]),
            ("largest", kept.max(), GROSS_DEVIATION[1]),
        ):
            if value > limit * chord:
                failures.append(
                    f"the {word} deviation is {with_unit(match.design, float(value), 4)}, "
                    f"{100 * value / chord:.2g} % of the chord, and {100 * limit:.2g} % are allowed where no "
                    "tolerance is stated: give more parameters"
                )
    failures += filter(None, (_structure_not_met(match, target), _too_few_points(match, target)))
    one_sided = _one_sided(match)
    if one_sided:
        failures.append(f"{one_sided}: is it one side of a blade alone? Give points of both")
    failures += [
        f"no point lies around the {name}, where the blade is still {with_unit(match.design, wide)} wide, "
        f"{share:.0%} of its thickest: is it half a blade? Give the points of the whole"
        for name, (wide, share) in uncovered_edges(match).items()
        if share > HALF_BLADE_WIDTH
    ]
    loose = loose_ends(match)
    if loose and target.structured and target.tolerance is None and not match.interrupted and match.rms < EXACT_MISFIT:
        failures.append(
            f"the sides are met exactly, but {_loose_ends_message(match, loose)}; state the tolerance that is enough"
        )
    if shape_not_found(distances, inliers, match, target) and not _near_enough(match):
        failures.append(_shape_not_found_message(match))
    return tuple(failures)


def _structure_not_met(match: Match, target: MatchTarget) -> str:
    """Why a given structure is not met, if it is not."""
    if not target.structured or target.tolerance is not None:
        return ""
    rms, noise = match.rms * match.model.chord, match.noise_estimate.noise
    # in axes that were found by a start no structure is met exactly
    least = ACCEPTED_MISFIT[_points(match).shape[1]] if target.registered else EXACT_MISFIT
    if match.rms > least and rms > SYSTEMATIC_OVER_NOISE * noise:
        return (
            f"the misfit of the given structure is {with_unit(match.design, rms)} rms, and the cloud's noise "
            f"{with_unit(match.design, noise)}: the structure does not hold this blade, or a better design was not "
            "found; state a tolerance, or another structure"
        )
    if least < match.rms < FINEST_NOISE and not is_rounded(_points(match)):
        return (
            f"the misfit of the given structure is {with_unit(match.design, rms)} rms, too much for an exact cloud "
            "and too little for the noise of another: the exact design was not found; state the tolerance that is "
            "enough"
        )
    return ""


def _too_few_points(match: Match, target: MatchTarget) -> str:
    """Why points are too few for a blade where nothing is asked for, if they are."""
    shown, count = int(np.count_nonzero(match.rows)), len(match.problem.paths)
    if not target.open or _points(match).shape[1] == 2 or shown >= FEWEST_POINTS_PER_PARAMETER * count:
        return ""
    return (
        f"{shown} points are too few for the {count} parameters of this blade: give more points, or a number of "
        "parameters"
    )


def shape_not_found(distances: Reals, inliers: NDArray[np.bool_], match: Match, target: MatchTarget) -> bool:
    """Whether nothing was asked for, and the misfit is not as small as the noise allows."""
    enough = ENOUGH_DEVIATION[_points(match).shape[1]] * match.model.chord
    largest = float(np.max(distances[inliers]))
    return (
        target.open
        and not match.interrupted
        and largest > 2.0 * enough
        and match.noise_estimate.correlation > SHAPE_CORRELATION
    )


def _one_sided(match: Match) -> str:
    """Why the points must be those of one side only, if anything shows it."""
    bare = _bare_side(match)
    if bare:
        return f"hardly a point lies on the {bare} side"
    thin = least_thickness(match)
    if thin < SHEET_THICKNESS * match.model.chord:
        return f"the blade is a sheet, no more than {with_unit(match.design, thin)} thick at a place of its span"
    return ""


def _bare_side(match: Match) -> str:
    """The side of a blade that has hardly a point between its edges, if one has."""
    footpoints = match.state.footpoints
    between = match.rows & (footpoints.u > BETWEEN_EDGES) & (footpoints.u < 1.0 - BETWEEN_EDGES)
    shares = {
        name: np.mean(footpoints.side[between] == side) if np.any(between) else 1.0 for side, name in enumerate(SIDES)
    }
    return next((name for name, share in shares.items() if share < MIN_SIDE_SHARE), "")


def _points(match: Match) -> Reals:
    return np.asarray(match.problem.cloud_residuals.points)


def _gross(distances: Reals, inliers: NDArray[np.bool_], match: Match) -> bool:
    return bool(np.mean(distances[inliers]) > GROSS_DEVIATION[0] * match.model.chord)


def _near_enough(match: Match) -> bool:
    return match.rms <= ACCEPTED_MISFIT[_points(match).shape[1]]


def _shape_not_found_message(match: Match) -> str:
    rms, noise = (with_unit(match.design, each) for each in (match.rms * match.model.chord, match.noise_estimate.noise))
    return (
        f"the shape is not found: deviations go on from point to point, {rms} rms where the cloud's own noise "
        f"is {noise}; state the tolerance that is enough, a number of parameters, or a start"
    )


def _loose_ends_message(match: Match, ends: Mapping[str, float]) -> str:
    gaps = ", ".join(f"{with_unit(match.design, gap, 2)} at the {name}" for name, gap in ends.items())
    return f"no row of points shows where the blade ends: it is known to about {gaps}"


def notes_of(
    notes: tuple[str, ...],
    statistics: ParameterEstimates,
    distances: Reals,
    inliers: NDArray[np.bool_],
    match: Match,
    target: MatchTarget,
    *,
    faced: int = 0,
) -> tuple[str, ...]:
    """What else there is to know, each a sentence; `faced` is the number of outliers on end faces."""
    sentences = list(notes)
    if faced:
        sentences.append(
            f"{faced} of {np.count_nonzero(~inliers)} outliers lie on the end faces: the sides are met without them"
        )
    if shape_not_found(distances, inliers, match, target) and _near_enough(match):
        sentences.append(f"near enough to make, but {_shape_not_found_message(match)}")
    if _points(match).shape[1] == 3 and _gross(distances, inliers, match):
        sentences.append(f"a blade in other axes is met no nearer than this: {AXES_HINT}")
    sentences += [
        f"no point lies around the {name}: where it ends and how round it is are guessed"
        for name, (_, share) in uncovered_edges(match).items()
        if share <= HALF_BLADE_WIDTH
    ]
    loose = loose_ends(match)
    if loose:
        sentences.append(_loose_ends_message(match, loose))
    unknown = [each.path for each in statistics.estimates if not each.identified]
    if unknown:
        more = f" and {len(unknown) - LISTED_NAMES} more" if len(unknown) > LISTED_NAMES else ""
        sentences.append(f"the cloud does not determine {', '.join(unknown[:LISTED_NAMES])}{more}")
    bound = [each.path for each in statistics.estimates if each.at_bound]
    if bound:
        sentences.append(f"on a bound: {', '.join(bound[:LISTED_NAMES])}{'...' if len(bound) > LISTED_NAMES else ''}")
    return tuple(sentences)
