"""What is asked of a match, and whether it may be trusted: its deviations against tolerance, noise and chord."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.stats import binomtest

from bladewright.fitting.assessment.coverage import (
    NORMAL_95,
    ShapeBands,
    foreign_edges,
    least_thickness,
    loose_ends,
    shape_bands,
    uncovered_edges,
)
from bladewright.fitting.assessment.estimates import ParameterEstimates
from bladewright.fitting.assessment.measurement import Measurement
from bladewright.fitting.assessment.result import with_unit
from bladewright.fitting.initial_guess.blade import AXES_HINT
from bladewright.fitting.matching.blade_ends import END_PARAMETERS
from bladewright.fitting.matching.footpoints import BETWEEN_EDGES, EDGE_PARAMETERS, Footpoints
from bladewright.fitting.matching.noise import (
    EXACT,
    LARGEST_GROUP,
    NEIGHBOURS,
    SIGNIFICANCE,
    crowded_at_edges,
    groups,
)
from bladewright.fitting.matching.search import Match
from bladewright.nurbs.basis import Reals

NEAR_EVERYWHERE = 5e-4
"""largest deviation, of the chord, up to which a match is trusted whatever the noise: 0.05 mm of 100 mm, to which
blades are milled."""
GROSS_DEVIATION = (1.5e-3, 5e-3)
"""mean and largest deviation, of the chord, beyond which no match is trusted without a tolerance. A mean of 0.15 % on
both sides of a turbine's throat of 0.3 chords changes it by 1 %; 0.5 % is half the radius of a usual leading edge.
So well are ends, and sides between the edges, to be known where nothing is asked, and edges, whose sharp tips move by
more than their sides: bands of sides that are met are 1.7e-3 at most, of those that are off between their points 3.4e-3
at least (design/matching.md)."""
SHARED_VARIANCE = 0.5
"""share of the variance that neighbours have in common from which more of a deviation is the shape's than noise."""
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
MIN_SIDE_SHARE = 0.1
"""share of the points between the edges below which a side is not shown"""


@dataclass(frozen=True, kw_only=True)
class MatchTarget:
    """What is asked of a match."""

    tolerance: float | None = None
    """largest distance of an inlier [m]"""
    parameters: int | None = None
    structured: bool = False
    """whether the structure is given"""

    @property
    def open(self) -> bool:
        """Whether nothing is asked for."""
        return self.tolerance is None and self.parameters is None and not self.structured


def trusted_distance(match: Match) -> float:
    """The largest distance [m] that a match of which nothing is asked may have: of exact points less."""
    return (EXACT if match.maximum <= EXACT * match.model.chord else NEAR_EVERYWHERE) * match.model.chord


def failures_of(
    measurement: Measurement, statistics: ParameterEstimates, match: Match, target: MatchTarget
) -> tuple[str, ...]:
    """Why a match does not pass, each a sentence."""
    inliers, distances, design = measurement.inliers, measurement.distances, match.design
    outliers = ~inliers & ~measurement.faced & (measurement.set_aside == "")
    off, open_ended = int(np.count_nonzero(outliers)), target.open and not match.interrupted
    failures = ["the search was interrupted: this is the best design so far"] if match.interrupted else []
    if off > LARGEST_OUTLIER_SHARE * len(distances):
        failures.append(f"{off} of {len(distances)} points lie off the blade: is it one blade, and of this family?")
    # points that are met as nearly as is asked are no part that is not found
    outliers &= distances > (target.tolerance or NEAR_EVERYWHERE * match.model.chord)
    together = _largest_group(measurement.footpoints, outliers)
    if len(together) > LARGEST_GROUP * len(distances):
        failures.append(
            f"{len(together)} of {len(distances)} points beside each other lie up to "
            f"{with_unit(design, np.max(distances[together]), 2)} off the blade: the shape is not found there, or they "
            "belong to something else; leave them out, or give a start"
        )
    crowded = crowded_at_edges(outliers, measurement.footpoints) if target.open else {}
    places = {f"at the {name}": rows for name, rows in crowded.items()}
    # points off a true surface lie to either side of it: the sign test (Dixon and Mood 1946)
    inside, far = outliers & (measurement.deviations < 0.0), int(np.count_nonzero(outliers))
    count = int(np.count_nonzero(inside))
    if target.open and not places and binomtest(count, max(far, 1), alternative="greater").pvalue < SIGNIFICANCE:
        places = {"inside the blade": inside}
    failures += [
        f"{np.count_nonzero(rows)} of {far} outliers lie {place}, up to "
        f"{with_unit(design, np.max(distances[rows]), 2)} from its sides, more than by chance: is the shape not found "
        "there, or the blade worn? Leave them out, give a start, or state a tolerance"
        for place, rows in places.items()
    ]
    worst = int(np.flatnonzero(inliers)[np.argmax(distances[inliers])])
    if target.tolerance is not None and distances[worst] > target.tolerance:
        failures.append(
            f"the largest deviation is {with_unit(design, distances[worst], 4)} ({measurement.regions[worst]}, point "
            f"{worst}), and {with_unit(design, target.tolerance, 4)} were asked for"
        )
    coarse = [] if target.tolerance is not None else _too_coarse(distances[inliers], match, target)
    failures += coarse
    # parameters of ends that no row of points shows are a note
    unknown = [each.path for each in statistics.estimates if not each.identified] if loose_ends(match) else []
    known = len(statistics.estimates) - sum(path.startswith(("channel.", "flow_path.")) for path in unknown)
    if open_ended and statistics.rank < known:
        failures.append(
            f"the points determine {statistics.rank} of the {len(statistics.estimates)} parameters: give more points, "
            "a number of parameters, or a tolerance"
        )
    # what a match that is not found misses widens its bands
    if open_ended and not coarse:
        failures += _not_shown(shape_bands(match, statistics), match)
    return (*failures, *_partly_shown(match))


def _largest_group(feet: Footpoints, outliers: NDArray[np.bool_]) -> NDArray[np.intp]:
    """The largest group of outliers (n,) beside each other, where there may be one that is too large.

    Outliers scatter; a part of the blade that is not found does not.
    """
    points, rows = feet.points + feet.miss, np.flatnonzero(outliers)
    if len(rows) <= LARGEST_GROUP * len(points):
        return rows[:0]
    _, index = cKDTree(points).query(points[rows], k=NEIGHBOURS[points.shape[1]] + 1)
    labels = groups(outliers[index], (np.cumsum(outliers) - 1)[index])
    return rows[labels == np.argmax(np.bincount(labels))]


def _limits(bands: ShapeBands, match: Match) -> tuple[Reals, NDArray[np.bool_]]:
    """How well the shape is to be known at places (n,) where nothing is asked [m], and where it is no failure if not.

    That is at an edge, and at an end, past all points there, where elsewhere along it the shape is known.
    """
    sides, edges = (each * match.model.chord for each in GROSS_DEVIATION)
    known = bands.half_widths <= edges
    at_edge, at_end = np.zeros_like(known), np.zeros_like(known)
    for end in EDGE_PARAMETERS.values():
        at_edge |= (np.abs(bands.u - end) < BETWEEN_EDGES) & np.any(known[bands.u == end])
        at_end |= (np.abs(bands.v - end) < 0.5) & np.any(known[bands.v == end])
    bare = (bands.past_edge & at_edge) | (bands.past_end & at_end & known)
    return np.where(np.minimum(bands.u, 1.0 - bands.u) < BETWEEN_EDGES, edges, sides), bare


def _not_shown(bands: ShapeBands, match: Match) -> list[str]:
    """Where a side, an edge or an end is known less well than is trusted, and than one point there would show it."""
    chord, one_point = match.model.chord, NORMAL_95 * match.noise_estimate.noise
    limits, bare = _limits(bands, match)
    limits = np.where(bare, np.inf, np.maximum(limits, one_point))
    worst = int(np.argmax(bands.half_widths / limits))
    found = []
    if bands.half_widths[worst] > limits[worst]:
        place = f"u = {bands.u[worst]:.2g}"
        place += "" if match.state.shape.exact is None else f", v = {bands.v[worst]:.2g}"
        found.append(
            f"the points do not show the {SIDES[bands.side[worst]]} side at {place}: it is known there to "
            f"{with_unit(match.design, bands.half_widths[worst], 2)} either way (95 %), and "
            f"{100 * limits[worst] / chord:.2g} % of the chord are allowed: is it a whole blade? Give more points "
            "there, a start, a number of parameters or a tolerance"
        )
    ends = max(GROSS_DEVIATION[0] * chord, one_point)
    unknown = {name: gap for name, gap in loose_ends(match).items() if gap > ends}
    if unknown:
        found.append(
            f"{_loose_ends_message(match, unknown)}, and {100 * ends / chord:.2g} % of the chord are allowed: give "
            "points there, hold hub and shroud, or state a tolerance"
        )
    return found


def _bare_notes(bands: ShapeBands, match: Match) -> list[str]:
    """Edges and ends without points on a part of the blade, where they are known less well than is trusted."""
    limits, bare = _limits(bands, match)
    near = np.minimum(bands.u, 1.0 - bands.u) < BETWEEN_EDGES
    edges = [(name, np.abs(bands.u - end) < BETWEEN_EDGES, "v") for name, end in EDGE_PARAMETERS.items()]
    ends = [(name, ~near & (np.abs(bands.v - end) < 0.5), "u") for name, end in END_PARAMETERS.items()]
    found = []
    for name, there, letter in edges + ends:
        rows = np.flatnonzero(bare & (bands.half_widths > limits) & there)
        if len(rows):
            along, known = getattr(bands, letter)[rows], with_unit(match.design, np.max(bands.half_widths[rows]), 2)
            found.append(
                f"no point shows the {name} from {letter} = {min(along):.2g} to {max(along):.2g}: it is known there to "
                f"{known} either way (95 %)"
            )
    return found


def _too_coarse(kept: Reals, match: Match, target: MatchTarget) -> list[str]:
    """Why a match without a tolerance is coarser than is trusted, if it is, by the inliers' distances (n,)."""
    chord = match.model.chord
    found = [
        f"the {word} deviation is {with_unit(match.design, float(value), 4)}, {100 * value / chord:.2g} % of the "
        f"chord, and {100 * limit:.2g} % are allowed where no tolerance is stated: give more parameters"
        for word, limit, value in zip(("mean", "largest"), GROSS_DEVIATION, (np.mean(kept), np.max(kept)), strict=True)
        if value > limit * chord
    ]
    if target.parameters is None and np.max(kept) > NEAR_EVERYWHERE * chord and _is_systematic(match):
        found.append(_not_found_message(match))
    return found


def _is_systematic(match: Match) -> bool:
    return match.noise_estimate.correlation > SHARED_VARIANCE and not match.interrupted


def _not_found_message(match: Match) -> str:
    rms, noise = (with_unit(match.design, each) for each in (match.rms * match.model.chord, match.noise_estimate.noise))
    return (
        f"the shape is not found: deviations go on from point to point, {rms} rms where the cloud's own noise "
        f"is {noise}; state the tolerance that is enough, a number of parameters, or a start"
    )


def _partly_shown(match: Match) -> list[str]:
    """Why the points must be those of a part of a blade only, if anything shows it."""
    feet, thin = match.state.footpoints, least_thickness(match)
    between = feet.side[match.rows & (np.minimum(feet.u, 1.0 - feet.u) > BETWEEN_EDGES)]
    shares = np.bincount(between, minlength=2) / max(len(between), 1)
    found = []
    if len(between) and np.min(shares) < MIN_SIDE_SHARE:
        found.append(
            f"hardly a point lies on the {SIDES[np.argmin(shares)]} side: is it one side of a blade alone? Give points "
            "of both"
        )
    elif thin < SHEET_THICKNESS * match.model.chord:
        found.append(
            f"the blade is a sheet, no more than {with_unit(match.design, thin)} thick at a place of its span: is it "
            "one side of a blade alone? Give points of both"
        )
    found += [
        f"no point lies around the {name}, where the blade is still {with_unit(match.design, wide)} wide, "
        f"{share:.0%} of its thickest: is it half a blade? Give the points of the whole"
        for name, (wide, share) in uncovered_edges(match).items()
        if share > HALF_BLADE_WIDTH
    ]
    return found


def _loose_ends_message(match: Match, ends: Mapping[str, float]) -> str:
    gaps = ", ".join(f"{with_unit(match.design, gap, 2)} at the {name}" for name, gap in ends.items())
    return f"no row of points shows where the blade ends: it is known to {gaps} (95 %)"


def notes_of(
    notes: tuple[str, ...],
    measurement: Measurement,
    statistics: ParameterEstimates,
    match: Match,
    target: MatchTarget,
) -> tuple[str, ...]:
    """What else there is to know, each a sentence."""
    kept, chord = measurement.distances[measurement.inliers], match.model.chord
    faced = int(np.count_nonzero(measurement.faced))
    sentences = list(notes)
    if faced:
        sentences.append(
            f"{faced} of {measurement.outliers} outliers lie on the end faces: the sides are met without them"
        )
    if target.open and EXACT * chord < np.max(kept) <= NEAR_EVERYWHERE * chord and _is_systematic(match):
        sentences.append(f"near enough to make, but {_not_found_message(match)}")
    if measurement.dimension == 3 and np.mean(kept) > GROSS_DEVIATION[0] * chord:
        sentences.append(f"a blade in other axes is met no nearer than this: {AXES_HINT}")
    sentences += [
        f"no point lies around the {name}: where it ends and how round it is are guessed"
        for name, (_, share) in uncovered_edges(match).items()
        if share <= HALF_BLADE_WIDTH
    ]
    sentences += [
        f"the {name} of the points is cut off, {with_unit(match.design, width, 2)} wide, and the edges of this family "
        "are round: it stays within half of that (--family profile has blunt and sharp edges)"
        for name, width in foreign_edges(match).items()
    ]
    if target.open and not match.interrupted:
        sentences += _bare_notes(shape_bands(match, statistics), match)
    loose = loose_ends(match)
    if loose:
        sentences.append(_loose_ends_message(match, loose))
    doubtful = {
        "the cloud does not determine": [each.path for each in statistics.estimates if not each.identified],
        "on a bound:": [each.path for each in statistics.estimates if each.at_bound],
    }
    for words, names in doubtful.items():
        more = f" and {len(names) - LISTED_NAMES} more" if len(names) > LISTED_NAMES else ""
        sentences += [f"{words} {', '.join(names[:LISTED_NAMES])}{more}"] if names else []
    return tuple(sentences)
