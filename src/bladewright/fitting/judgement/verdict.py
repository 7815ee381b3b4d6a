"""Whether a match may be trusted, and why not."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bladewright.fitting.clouds.rounding import rounded
from bladewright.fitting.first.designed import AXES
from bladewright.fitting.judgement.ending import loose_ends
from bladewright.fitting.judgement.estimates import Certainty
from bladewright.fitting.judgement.unseen import thinnest, unseen_edges
from bladewright.fitting.matching.search import Found
from bladewright.fitting.structures.aim import LEAST, Aim
from bladewright.nurbs.basis import Reals

GROSS = (1.5e-3, 5e-3)
"""mean and largest distance of a match to which no tolerance is stated, of the chord"""
EXACT, SYSTEMATIC = 1e-9, 3.0
"""misfit of a given structure that is rounding, of the chord, and one that is not noise, of the cloud's noise"""
FINEST = 1e-6
"""misfit of a given structure, of the chord, below which it is no noise of a measured cloud"""
SHARED = 0.5
"""part of the misfit that neighbours share from which it is the shape's, where nothing is asked for"""
FAIR = {2: 5e-5, 3: 1e-4}
"""root mean square misfit of the shape, of the chord, below which it is near enough where nothing is asked for, by
dimension: below what a blade can be made to"""
OFF = 0.1
"""part of the points that may be outliers"""
SHOWN = 5
SIDES = ("upper", "lower")
HALF = 0.5
"""width of an open edge, of the blade's thickest, from which it is half a blade"""
SHEET = 3e-3
"""of the chord: no blade is so thin, and two sides are that are both laid through the points of one"""
TELLING = 1.5
"""points for each parameter of a blade without which they tell of no shape, where nothing is asked for"""
BARE, BETWEEN = 0.1, 0.1
"""part of the points between the edges, and where those end in u, below which a side is not seen"""


def failures_of(
    distances: Reals, inliers: NDArray[np.bool_], regions: NDArray[np.str_], found: Found, aim: Aim, *, faced: int = 0
) -> tuple[str, ...]:
    """Why a match does not pass, each a sentence; `faced` is the number of outliers that lie on end faces."""
    failures = []
    chord = found.model.chord
    kept = distances[inliers]
    if found.interrupted:
        failures.append("the search was interrupted: this is the best design so far")
    off = len(distances) - len(kept) - faced
    if off > OFF * len(distances):
        failures.append(f"{off} of {len(distances)} points lie off the blade: is it one blade, and of this family?")
    worst = int(np.flatnonzero(inliers)[np.argmax(kept)])
    if aim.tolerance is not None and kept.max() > aim.tolerance:
        failures.append(
            f"the largest deviation is {1e3 * kept.max():.4g} mm ({regions[worst]}, point {worst}), and "
            f"{1e3 * aim.tolerance:.4g} mm were asked for"
        )
    elif aim.tolerance is None:
        for word, value, limit in (("mean", np.mean(kept), GROSS[0]), ("largest", kept.max(), GROSS[1])):
            if value > limit * chord:
                failures.append(
                    f"the {word} deviation is {1e3 * value:.4g} mm, {100 * value / chord:.2g} % of the chord, and "
                    f"{100 * limit:.2g} % are allowed where no tolerance is stated: give more parameters"
                )
    failures += filter(None, (_missed(found, aim), _scarce(found, aim)))
    one_sided = _one_sided(found)
    if one_sided:
        failures.append(f"{one_sided}: is it one side of a blade alone? Give points of both")
    failures += [
        f"no point lies around the {name}, where the blade is still {1e3 * wide:.3g} mm wide, {share:.0%} of its "
        "thickest: is it half a blade? Give the points of the whole"
        for name, (wide, share) in unseen_edges(found).items()
        if share > HALF
    ]
    loose = loose_ends(found)
    if loose and aim.structured and aim.tolerance is None and not found.interrupted and found.rms < EXACT:
        failures.append(f"the sides are met exactly, but {_loose(loose)}; state the tolerance that is enough")
    if missing(distances, inliers, found, aim) and not _fair(found):
        failures.append(_unmet(found))
    return tuple(failures)


def _missed(found: Found, aim: Aim) -> str:
    """Why a given structure is not met, if it is not."""
    if not aim.structured or aim.tolerance is not None:
        return ""
    rms, noise = found.rms * found.model.chord, found.scatter.noise
    # in axes that a start shows no structure is met exactly
    least = FAIR[_points(found).shape[1]] if aim.moved else EXACT
    if found.rms > least and rms > SYSTEMATIC * noise:
        return (
            f"the misfit of the given structure is {1e3 * rms:.3g} mm rms, and the cloud's noise {1e3 * noise:.3g} mm: "
            "the structure does not hold this blade, or a better design was not found; state a tolerance, or another "
            "structure"
        )
    if least < found.rms < FINEST and not rounded(_points(found)):
        return (
            f"the misfit of the given structure is {1e3 * rms:.3g} mm rms, too much for an exact cloud and too little "
            "for the noise of another: the exact design was not found; state the tolerance that is enough"
        )
    return ""


def _scarce(found: Found, aim: Aim) -> str:
    """Why points are too few to tell of a blade where nothing is asked for, if they are."""
    shown, count = int(np.count_nonzero(found.rows)), len(found.problem.paths)
    if not aim.open or _points(found).shape[1] == 2 or shown >= TELLING * count:
        return ""
    return (
        f"{shown} points are too few for the {count} parameters of this blade: give more points, or a number of "
        "parameters"
    )


def missing(distances: Reals, inliers: NDArray[np.bool_], found: Found, aim: Aim) -> bool:
    """Whether nothing was asked for, and the shape of the cloud is not met as far as its noise lets it be told."""
    enough = LEAST[_points(found).shape[1]] * found.model.chord
    largest = float(np.max(distances[inliers]))
    return aim.open and not found.interrupted and largest > 2.0 * enough and found.scatter.shared > SHARED


def _one_sided(found: Found) -> str:
    """What tells that the points are those of one side alone, if anything does."""
    bare = _bare(found)
    if bare:
        return f"hardly a point lies on the {bare} side"
    thin = thinnest(found)
    if thin < SHEET * found.model.chord:
        return f"the blade is a sheet, no more than {1e3 * thin:.3g} mm thick at a place of its span"
    return ""


def _bare(found: Found) -> str:
    """The side of a blade that has hardly a point between its edges, if one has."""
    on = found.state.feet
    between = found.rows & (on.u > BETWEEN) & (on.u < 1.0 - BETWEEN)
    shares = {name: np.mean(on.side[between] == side) if np.any(between) else 1.0 for side, name in enumerate(SIDES)}
    return next((name for name, share in shares.items() if share < BARE), "")


def _points(found: Found) -> Reals:
    return np.asarray(found.problem.measures.points)


def _gross(distances: Reals, inliers: NDArray[np.bool_], found: Found) -> bool:
    return bool(np.mean(distances[inliers]) > GROSS[0] * found.model.chord)


def _fair(found: Found) -> bool:
    return found.rms <= FAIR[_points(found).shape[1]]


def _unmet(found: Found) -> str:
    rms, noise = 1e3 * found.rms * found.model.chord, 1e3 * found.scatter.noise
    return (
        f"the shape is not found: deviations go on from point to point, {rms:.3g} mm rms where the cloud's own noise "
        f"is {noise:.3g} mm; state the tolerance that is enough, a number of parameters, or a start"
    )


def _loose(ends: Mapping[str, float]) -> str:
    apart = ", ".join(f"{1e3 * gap:.2g} mm at the {name}" for name, gap in ends.items())
    return f"no row of points shows where the blade ends: it is known to about {apart}"


def notes_of(
    notes: tuple[str, ...],
    certainty: Certainty,
    distances: Reals,
    inliers: NDArray[np.bool_],
    found: Found,
    aim: Aim,
    *,
    faced: int = 0,
) -> tuple[str, ...]:
    """What else there is to know, each a sentence; `faced` is the number of outliers that lie on end faces."""
    said = list(notes)
    if faced:
        said.append(
            f"{faced} of {np.count_nonzero(~inliers)} outliers lie on the end faces: the sides are met without them"
        )
    if missing(distances, inliers, found, aim) and _fair(found):
        said.append(f"near enough to make, but {_unmet(found)}")
    if _points(found).shape[1] == 3 and _gross(distances, inliers, found):
        said.append(f"a blade in other axes is met no nearer than this: {AXES}")
    said += [
        f"no point lies around the {name}: where it ends and how round it is are guessed"
        for name, (_, share) in unseen_edges(found).items()
        if share <= HALF
    ]
    loose = loose_ends(found)
    if loose:
        said.append(_loose(loose))
    unknown = [each.path for each in certainty.estimates if not each.identified]
    if unknown:
        more = f" and {len(unknown) - SHOWN} more" if len(unknown) > SHOWN else ""
        said.append(f"the cloud does not determine {', '.join(unknown[:SHOWN])}{more}")
    bound = [each.path for each in certainty.estimates if each.at_bound]
    if bound:
        said.append(f"on a bound: {', '.join(bound[:SHOWN])}{'...' if len(bound) > SHOWN else ''}")
    return tuple(said)
