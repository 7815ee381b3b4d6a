"""What is asked of a match, and whether it may be trusted: its deviations against tolerance, noise and chord."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.special import bdtrc

from bladewright.fitting.assessment import coverage
from bladewright.fitting.assessment.measurement import Measurement, ParameterEstimates
from bladewright.fitting.assessment.result import with_unit
from bladewright.fitting.clouds.thinning import groups
from bladewright.fitting.matching.footpoints import BETWEEN_EDGES, EDGE_PARAMETERS, Footpoints
from bladewright.fitting.matching.noise import EXACT, LARGEST_GROUP, NEIGHBOURS, SIGNIFICANCE, crowded_at_edges
from bladewright.fitting.matching.search import Match
from bladewright.nurbs.basis import Reals

NEAR_EVERYWHERE = 5e-4
"""largest deviation, of the chord, up to which a match is trusted whatever the noise: 0.05 mm of 100 mm. A choice:
searches with nothing asked end within it (design/matching.md)."""
AXES_HINT = "x must be the machine axis: say which column is which (--columns), or name the axis (--axis)"
"""what may be wrong with a cloud near which no blade is found"""
GROSS_DEVIATION = (1.5e-3, 5e-3)
"""mean and largest deviation, of the chord, beyond which no match is trusted without a tolerance; so well are ends, and
edges, to be known where nothing is asked (design/matching_constants.md)"""
SHOWN_SIDE = 2.4e-3
"""how well sides between the edges are to be known where nothing is asked, of the chord (design/matching.md)"""
SHARED_VARIANCE = 0.5
"""share of variance common to neighbours above which a deviation is the shape's (design/matching_constants.md)"""
LARGEST_OUTLIER_SHARE = 0.1
"""share of the points that may be outliers; more are not one blade of the family (design/matching_constants.md)"""
LISTED_NAMES = 5
"""parameters that a note lists by name"""
SIDES = ("upper", "lower")
"""names of the sides, by their number in footpoints"""
HALF_BLADE_WIDTH = 0.5
"""width where the points end, of the blade's thickest, from which it is half a blade (design/matching_constants.md)"""
SHEET_THICKNESS = 3e-3
"""thickness, of the chord, below which no blade is (design/matching_constants.md)"""
MIN_SIDE_SHARE = 0.1
"""share of the points between the edges below which a side is not shown (design/matching_constants.md)"""


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


@dataclass(frozen=True, kw_only=True, eq=False)
class Acceptance:
    """What is said of a match: why it does not pass, and what else there is to know."""

    match: Match
    measurement: Measurement
    statistics: ParameterEstimates
    target: MatchTarget

    def failures(self) -> Iterator[str]:
        """Why the match does not pass, each a sentence."""
        if self.match.interrupted:
            yield "the search was interrupted: this is the best design so far"
        yield from self._off_the_blade()
        coarse = list(self._too_coarse())
        yield from coarse
        if self._nothing_asked:
            yield from self._too_many_parameters()
            if not coarse:
                # what a match that is not found misses widens its bands
                yield from self._not_shown()
        if not self.target.structured:
            yield from (f"{each}: is it a whole blade? Give points there, or a start" for each in self._long_gaps())
        yield from self._partly_shown()

    def notes(self) -> Iterator[str]:
        """What else there is to know, each a sentence."""
        chord = self.match.model.chord
        if self.target.open and EXACT * chord < self._largest <= NEAR_EVERYWHERE * chord and self._is_systematic:
            yield f"near enough to make, but {self._not_found}"
        if self._in_space and self._mean > GROSS_DEVIATION[0] * chord:
            yield f"a blade in other axes is met no nearer than this: {AXES_HINT}"
        for name, (_, share) in self._uncovered_edges.items():
            if share <= HALF_BLADE_WIDTH:
                yield f"no point lies around the {name}: where it ends and how round it is are guessed"
        for name, width in coverage.foreign_edges(self.match).items():
            yield (
                f"the {name} of the points is cut off, {self._length(width)} wide, and the edges of this family are "
                "round: it stays within half of that (--family profile has blunt and sharp edges)"
            )
        if self._nothing_asked:
            yield from self._bare_parts()
        if self.target.structured:
            yield from self._long_gaps()
        if self._loose_ends:
            yield self._where_it_ends(self._loose_ends)
        estimates = self.statistics.estimates
        for words, names in (
            ("the cloud does not determine", [each.path for each in estimates if not each.identified]),
            ("on a bound:", [each.path for each in estimates if each.at_bound]),
        ):
            if names:
                more = f" and {len(names) - LISTED_NAMES} more" if len(names) > LISTED_NAMES else ""
                yield f"{words} {', '.join(names[:LISTED_NAMES])}{more}"

    @property
    def _nothing_asked(self) -> bool:
        return self.target.open and not self.match.interrupted

    @property
    def _in_space(self) -> bool:
        return self.measurement.footpoints.points.shape[1] == 3

    @property
    def _is_systematic(self) -> bool:
        return self.match.noise_estimate.correlation > SHARED_VARIANCE and not self.match.interrupted

    @cached_property
    def _loose_ends(self) -> dict[str, float]:
        return coverage.loose_ends(self.match, self.measurement.footpoints.part(self.measurement.inliers))

    @cached_property
    def _uncovered_edges(self) -> dict[str, tuple[float, float]]:
        return coverage.uncovered_edges(self.match)

    @cached_property
    def _bands(self) -> tuple[Footpoints, Reals]:
        return coverage.shape_bands(self.match)

    @property
    def _mean(self) -> float:
        return float(np.mean(self.measurement.distances[self.measurement.inliers]))

    @property
    def _largest(self) -> float:
        return float(np.max(self.measurement.distances[self.measurement.inliers]))

    def _length(self, metres: float, digits: int = 2) -> str:
        return with_unit(self.match.design, metres, digits)

    def _off_the_blade(self) -> Iterator[str]:
        """Outliers that are too many, too many beside each other, or where chance does not put them."""
        measurement, chord = self.measurement, self.match.model.chord
        distances, count = measurement.distances, len(measurement.distances)
        outliers = measurement.outliers
        off = int(np.count_nonzero(outliers))
        if off > LARGEST_OUTLIER_SHARE * count:
            yield f"{off} of {count} points lie off the blade: is it one blade, and of this family?"
        # points that are met as nearly as is asked are no part that is not found
        outliers &= distances > (self.target.tolerance or NEAR_EVERYWHERE * chord)
        together = _largest_group(measurement.footpoints, outliers)
        if len(together) > LARGEST_GROUP * count:
            yield (
                f"{len(together)} of {count} points beside each other lie up to "
                f"{self._length(np.max(distances[together]))} off the blade: the shape is not found there, or they "
                "belong to something else; leave them out, or give a start"
            )
        if not self.target.open:
            return
        crowded = crowded_at_edges(outliers, measurement.footpoints)
        places = {f"at the {name}": rows for name, rows in crowded.items()}
        # points off a true surface lie to either side of it: the sign test (Dixon and Mood 1946)
        inside, far = outliers & (measurement.deviations < 0.0), int(np.count_nonzero(outliers))
        by_chance = bdtrc(np.count_nonzero(inside) - 1, max(far, 1), 0.5)
        if not places and by_chance < SIGNIFICANCE:
            places = {"inside the blade": inside}
        for place, rows in places.items():
            yield (
                f"{np.count_nonzero(rows)} of {far} outliers lie {place}, up to "
                f"{self._length(np.max(distances[rows]))} from its sides, more than by chance: is the shape not found "
                "there, or the blade worn? Leave them out, give a start, or state a tolerance"
            )

    def _too_coarse(self) -> Iterator[str]:
        """Whether a match is coarser than was asked for, or without a tolerance than is trusted."""
        measurement, chord, tolerance = self.measurement, self.match.model.chord, self.target.tolerance
        if tolerance is not None:
            if self._largest > tolerance:
                worst = int(np.argmax(np.where(measurement.inliers, measurement.distances, 0.0)))
                yield (
                    f"the largest deviation is {self._length(self._largest, 4)} ({measurement.regions[worst]}, point "
                    f"{worst}), and {self._length(tolerance, 4)} were asked for"
                )
            return
        for word, value, limit in zip(("mean", "largest"), (self._mean, self._largest), GROSS_DEVIATION, strict=True):
            if value > limit * chord:
                yield (
                    f"the {word} deviation is {self._length(value, 4)}, {100 * value / chord:.2g} % of the chord, and "
                    f"{100 * limit:.2g} % are allowed where no tolerance is stated: give more parameters, or try "
                    "another family"
                )
        if self.target.parameters is None and self._largest > NEAR_EVERYWHERE * chord and self._is_systematic:
            yield self._not_found

    @property
    def _not_found(self) -> str:
        rms, noise = self.match.rms * self.match.model.chord, self.match.noise_estimate.noise
        return (
            f"the shape is not found: deviations go on from point to point, {self._length(rms, 3)} rms where the "
            f"cloud's own noise is {self._length(noise, 3)}; state the tolerance that is enough, a number of "
            "parameters, or a start"
        )

    def _too_many_parameters(self) -> Iterator[str]:
        """Whether the points determine fewer parameters than there are."""
        estimates, rank = self.statistics.estimates, self.statistics.rank
        # parameters of ends that no row of points shows are a note
        unknown = [each.path for each in estimates if not each.identified] if self._loose_ends else []
        if rank < len(estimates) - sum(path.startswith(("channel.", "flow_path.")) for path in unknown):
            yield (
                f"the points determine {rank} of the {len(estimates)} parameters: give more points, a number of "
                "parameters, or a tolerance"
            )

    @cached_property
    def _limits(self) -> Reals:
        """How well the shape is to be known at places (n,) where nothing is asked [m]."""
        at_edge = self._bands[0].from_edges < BETWEEN_EDGES
        return np.where(at_edge, GROSS_DEVIATION[1], SHOWN_SIDE) * self.match.model.chord

    @cached_property
    def _bare(self) -> dict[str, NDArray[np.bool_]]:
        """Which places (n,) are at an edge or an end past all points there, while it is known elsewhere along it."""
        places, half_widths = self._bands
        return coverage.bare_places(self.match, places, half_widths <= GROSS_DEVIATION[1] * self.match.model.chord)

    def _not_shown(self) -> Iterator[str]:
        """Where the shape is known less well than is trusted, and than one point there would show it."""
        (places, half_widths), chord = self._bands, self.match.model.chord
        one_point = coverage.NORMAL_95 * self.match.noise_estimate.noise
        limits = np.where(np.any(list(self._bare.values()), axis=0), np.inf, np.maximum(self._limits, one_point))
        worst = int(np.argmax(half_widths / limits))
        if half_widths[worst] > limits[worst]:
            at = f"u = {places.u[worst]:.2g}" + (f", v = {places.v[worst]:.2g}" if self._in_space else "")
            yield (
                f"the points do not show the {SIDES[places.side[worst]]} side at {at}: it is known there to "
                f"{self._length(half_widths[worst])} either way (95 %), and "
                f"{100 * limits[worst] / chord:.2g} % of the chord are allowed: is it a whole blade? Give more points "
                "there, a start, a number of parameters or a tolerance"
            )
        if self._largest <= NEAR_EVERYWHERE * chord:
            # ends that no row shows are a note, as the sides are met
            return
        allowed = max(GROSS_DEVIATION[0] * chord, one_point)
        unknown = {name: gap for name, gap in self._loose_ends.items() if gap > allowed}
        if unknown:
            yield (
                f"{self._where_it_ends(unknown)}, and {100 * allowed / chord:.2g} % of the chord are allowed: give "
                "points there, hold hub and shroud, or state a tolerance"
            )

    def _where_it_ends(self, ends: Mapping[str, float]) -> str:
        gaps = ", ".join(f"{self._length(gap)} at the {name}" for name, gap in ends.items())
        return f"no row of points shows where the blade ends: it is known to {gaps} (95 %)"

    def _bare_parts(self) -> Iterator[str]:
        """Edges and ends without points on a part of the blade, where they are known less well than is trusted."""
        places, half_widths = self._bands
        for name, bare in self._bare.items():
            rows = bare & (half_widths > self._limits)
            if np.any(rows):
                letter, along = ("v", places.v[rows]) if name in EDGE_PARAMETERS else ("u", places.u[rows])
                yield (
                    f"no point shows the {name} from {letter} = {min(along):.2g} to {max(along):.2g}: it is known "
                    f"there to {self._length(np.max(half_widths[rows]))} either way (95 %)"
                )

    def _long_gaps(self) -> Iterator[str]:
        """Long gaps between the points around the blade."""
        for way, place in coverage.bare_stretches(self.match):
            share = 100 * way / self.match.model.chord
            yield f"no point shows the {place}: {self._length(way, 3)} without one, {share:.2g} % of the chord"

    def _partly_shown(self) -> Iterator[str]:
        """Why the points must be those of a part of a blade only, if anything shows it."""
        feet, thickness = self.match.state.footpoints, coverage.least_thickness(self.match)
        between = feet.side[self.match.rows & (feet.from_edges > BETWEEN_EDGES)]
        shares = np.bincount(between, minlength=2) / max(len(between), 1)
        one_side = "is it one side of a blade alone? Give points of both"
        if len(between) and np.min(shares) < MIN_SIDE_SHARE:
            yield f"hardly a point lies on the {SIDES[np.argmin(shares)]} side: {one_side}"
        elif thickness < SHEET_THICKNESS * self.match.model.chord:
            thin = self._length(thickness, 3)
            yield f"the blade is a sheet, no more than {thin} thick at a place of its span: {one_side}"
        for name, (width, share) in self._uncovered_edges.items():
            if share > HALF_BLADE_WIDTH:
                yield (
                    f"no point lies around the {name}, where the blade is still {self._length(width, 3)} wide, "
                    f"{share:.0%} of its thickest: is it half a blade? Give the points of the whole"
                )


def _largest_group(feet: Footpoints, outliers: NDArray[np.bool_]) -> NDArray[np.intp]:
    """The largest group of outliers (n,) beside each other, if too large: a part that is not found does not scatter."""
    points, rows = feet.points + feet.miss, np.flatnonzero(outliers)
    if len(rows) <= LARGEST_GROUP * len(points):
        return rows[:0]
    _, index = cKDTree(points).query(points[rows], k=NEIGHBOURS[points.shape[1]] + 1)
    labels = groups(outliers[index], (np.cumsum(outliers) - 1)[index])
    return rows[labels == np.argmax(np.bincount(labels))]
