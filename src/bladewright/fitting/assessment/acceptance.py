"""What is asked of a match, and whether it may be trusted: its deviations against tolerance, noise and chord."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.stats import binomtest

from bladewright.fitting.assessment.coverage import (
    CONFIDENCE,
    EDGE_PARAMETERS,
    NORMAL_95,
    bare_at_ends,
    bare_places,
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
from bladewright.fitting.matching.noise import EXACT, LARGEST_GROUP, NEIGHBOURS, groups
from bladewright.fitting.matching.search import Match
from bladewright.nurbs.basis import Reals

NEAR_EVERYWHERE = 5e-4
"""largest deviation, of the chord, up to which a match is trusted whatever the noise: 0.05 mm of 100 mm, to which
blades are milled."""
GROSS_DEVIATION = (1.5e-3, 5e-3)
"""mean and largest deviation, of the chord, beyond which no match is trusted without a tolerance. A mean of 0.15 % on
both sides of a turbine's throat of 0.3 chords changes it by 1 %; 0.5 % is half the radius of a usual leading edge.
So well are sides between the edges to be known where nothing is asked, and edges, whose sharp tips move by more than
their sides: bands of sides that are met are 1.7e-3 at most, of those that are off between their points 3.4e-3 at least
(design/matching.md)."""
KNOWN_END = 1e-3
"""how near, of the chord, ends are to be known where nothing is asked: 0.1 mm of 100 mm. Ends that are met are known to
6e-4, those that are off to 1.2e-3 (design/matching.md)."""
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
MIN_SIDE_SHARE, BETWEEN_EDGES = 0.1, 0.1
"""share of the points between the edges below which a side is not shown; `BETWEEN_EDGES` is where the edges end, in
u."""


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
    inliers, distances = measurement.inliers, measurement.distances
    failures = []
    if match.interrupted:
        failures.append("the search was interrupted: this is the best design so far")
    off = measurement.outliers - int(np.count_nonzero(measurement.faced))
    if off > LARGEST_OUTLIER_SHARE * len(distances):
        failures.append(f"{off} of {len(distances)} points lie off the blade: is it one blade, and of this family?")
    together, farthest = _outlying_group(measurement)
    if together > LARGEST_GROUP * len(distances):
        failures.append(
            f"{together} of {len(distances)} points beside each other lie up to {with_unit(match.design, farthest, 2)} "
            "off the blade: the shape is not found there, or they belong to something else; leave them out, or give a "
            "start"
        )
    inside, deepest = _inside(measurement)
    if target.open and binomtest(inside, max(off, 1), alternative="greater").pvalue < 1.0 - CONFIDENCE:
        failures.append(
            f"{inside} of {off} outliers lie inside the blade, up to {with_unit(match.design, deepest, 2)} from its "
            "sides: is the shape not found there, or the blade worn? Leave them out, give a start, or state a tolerance"
        )
    worst = int(np.flatnonzero(inliers)[np.argmax(distances[inliers])])
    if target.tolerance is not None and distances[worst] > target.tolerance:
        failures.append(
            f"the largest deviation is {with_unit(match.design, distances[worst], 4)} "
            f"({measurement.regions[worst]}, point {worst}), and {with_unit(match.design, target.tolerance, 4)} were "
            "asked for"
        )
    coarse = [] if target.tolerance is not None else _too_coarse(distances[inliers], match, target)
    failures += coarse
    known = len(statistics.estimates) - _unknown_ends(statistics, match)
    if target.open and not match.interrupted and statistics.rank < known:
        failures.append(
            f"the points determine {statistics.rank} of the {len(statistics.estimates)} parameters: give more points, "
            "a number of parameters, or a tolerance"
        )
    # what a match that is not found misses widens its bands
    if target.open and not match.interrupted and not coarse:
        failures += _not_shown(statistics, match)
    failures += _partly_shown(match)
    return tuple(failures)


def _outlying_group(measurement: Measurement) -> tuple[int, float]:
    """Number of points in the largest group of outliers beside each other, and its largest distance [m].

    Outliers scatter; a part of the blade that is not found does not.
    """
    feet, outlier = measurement.footpoints, ~measurement.inliers & ~measurement.faced & (measurement.set_aside == "")
    points, rows = feet.points + feet.miss, np.flatnonzero(outlier)
    if len(rows) <= LARGEST_GROUP * len(points):
        return 0, 0.0
    _, index = cKDTree(points).query(points[rows], k=NEIGHBOURS[points.shape[1]] + 1)
    labels = groups(outlier[index], (np.cumsum(outlier) - 1)[index])
    largest = rows[labels == np.argmax(np.bincount(labels))]
    return len(largest), float(np.max(measurement.distances[largest]))


def _inside(measurement: Measurement) -> tuple[int, float]:
    """Number of outliers inside the sides, and how far the deepest is [m].

    Points off a surface lie to either side of it, or in front of it; behind it only where it is not the true one. So
    many of them come by chance by the sign test (Dixon and Mood 1946).
    """
    behind = ~measurement.inliers & ~measurement.faced & (measurement.set_aside == "") & (measurement.deviations < 0.0)
    return int(np.count_nonzero(behind)), float(np.max(measurement.distances[behind], initial=0.0))


def _not_shown(statistics: ParameterEstimates, match: Match) -> list[str]:
    """Where a side, an edge or an end is known less well than is trusted, and than one point there would show it.

    Where an edge or an end that is known elsewhere has no points, that is a note (`_bare_notes`).
    """
    chord, one_point = match.model.chord, NORMAL_95 * match.noise_estimate.noise
    ends, sides, edges = (max(each * chord, one_point) for each in (KNOWN_END, *GROSS_DEVIATION))
    side, u, v, half_widths = shape_bands(match, statistics)
    limits = np.where(np.minimum(u, 1.0 - u) < BETWEEN_EDGES, edges, sides)
    limits[_bare(match, side, u, v, half_widths)] = np.inf
    worst = int(np.argmax(half_widths / limits))
    found = []
    if half_widths[worst] > limits[worst]:
        place = f"u = {u[worst]:.2g}" + ("" if match.state.shape.exact is None else f", v = {v[worst]:.2g}")
        known = f"known there to {with_unit(match.design, float(half_widths[worst]), 2)} either way (95 %)"
        found.append(
            f"the points do not show the {SIDES[side[worst]]} side at {place}: it is {known}, and "
            f"{100 * limits[worst] / chord:.2g} % of the chord are allowed: is it a whole blade? Give more points "
            "there, a start, a number of parameters or a tolerance"
        )
    unknown = {name: gap for name, gap in loose_ends(match).items() if gap > ends}
    if unknown:
        found.append(
            f"{_loose_ends_message(match, unknown)}, and {100 * ends / chord:.2g} % of the chord are allowed: give "
            "points there, hold hub and shroud, or state a tolerance"
        )
    return found


def _bare(match: Match, side: NDArray[np.intp], u: Reals, v: Reals, half_widths: Reals) -> NDArray[np.bool_]:
    """Whether places (n,) lie at an edge past all points there, which elsewhere along the span is known.

    Or at an end past all points there, which elsewhere along the chord is known; and they as well as an edge is to be.
    """
    known = half_widths <= GROSS_DEVIATION[1] * match.model.chord
    at_edge, at_end = np.zeros_like(known), np.zeros_like(known)
    for end in EDGE_PARAMETERS.values():
        at_edge |= (np.abs(u - end) < BETWEEN_EDGES) & np.any(known[u == end])
        at_end |= (np.abs(v - end) < 0.5) & np.any(known[v == end])
    return np.asarray((bare_places(match, side, u, v) & at_edge) | (bare_at_ends(match, side, u, v) & at_end & known))


def _bare_notes(statistics: ParameterEstimates, match: Match) -> list[str]:
    """Edges and ends without points on a part of the blade, where they are known less well than is trusted."""
    side, u, v, half_widths = shape_bands(match, statistics)
    near = np.minimum(u, 1.0 - u) < BETWEEN_EDGES
    limits = np.where(near, GROSS_DEVIATION[1], GROSS_DEVIATION[0]) * match.model.chord
    bare = _bare(match, side, u, v, half_widths) & (half_widths > limits)
    found = []
    edges = {name: (np.abs(u - end) < BETWEEN_EDGES, v, "v") for name, end in EDGE_PARAMETERS.items()}
    ends = {name: (~near & (np.abs(v - end) < 0.5), u, "u") for name, end in (("hub", 0.0), ("shroud", 1.0))}
    for name, (there, along, letter) in (edges | ends).items():
        rows = np.flatnonzero(bare & there)
        if len(rows):
            known = with_unit(match.design, float(np.max(half_widths[rows])), 2)
            found.append(
                f"no point shows the {name} from {letter} = {min(along[rows]):.2g} to {max(along[rows]):.2g}: it is "
                f"known there to {known} either way (95 %)"
            )
    return found


def _unknown_ends(statistics: ParameterEstimates, match: Match) -> int:
    """Number of parameters that are not determined because no row of points shows where the blade ends: a note."""
    if not loose_ends(match):
        return 0
    unknown = (each.path for each in statistics.estimates if not each.identified)
    return sum(path.startswith(("channel.", "flow_path.")) for path in unknown)


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
    found = []
    bare, thin = _bare_side(match), least_thickness(match)
    if bare:
        found.append(f"hardly a point lies on the {bare} side: is it one side of a blade alone? Give points of both")
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


def _bare_side(match: Match) -> str:
    """The side of a blade that has hardly a point between its edges, if one has."""
    footpoints = match.state.footpoints
    between = match.rows & (footpoints.u > BETWEEN_EDGES) & (footpoints.u < 1.0 - BETWEEN_EDGES)
    shares = {
        name: np.mean(footpoints.side[between] == side) if np.any(between) else 1.0 for side, name in enumerate(SIDES)
    }
    return next((name for name, share in shares.items() if share < MIN_SIDE_SHARE), "")


def _loose_ends_message(match: Match, ends: Mapping[str, float]) -> str:
    gaps = ", ".join(f"{with_unit(match.design, gap, 2)} at the {name}" for name, gap in ends.items())
    return f"no row of points shows where the blade ends: it is known to about {gaps}"


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
        sentences += _bare_notes(statistics, match)
    loose = loose_ends(match)
    if loose:
        sentences.append(_loose_ends_message(match, loose))
    unknown = [each.path for each in statistics.estimates if not each.identified]
    if unknown:
        sentences.append(f"the cloud does not determine {_listed(unknown)}")
    bound = [each.path for each in statistics.estimates if each.at_bound]
    if bound:
        sentences.append(f"on a bound: {_listed(bound)}")
    return tuple(sentences)


def _listed(names: list[str]) -> str:
    more = f" and {len(names) - LISTED_NAMES} more" if len(names) > LISTED_NAMES else ""
    return f"{', '.join(names[:LISTED_NAMES])}{more}"
