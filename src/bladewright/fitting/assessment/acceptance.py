"""What is asked of a match, and whether it may be trusted: its deviations against tolerance, noise and chord."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.special import bdtrc

from bladewright.fitting.assessment import coverage
from bladewright.fitting.assessment.coverage import SIDES
from bladewright.fitting.assessment.measurement import Measurement, ParameterEstimates
from bladewright.fitting.assessment.result import with_unit
from bladewright.fitting.clouds.thinning import groups
from bladewright.fitting.matching.footpoints import BETWEEN_EDGES, EDGE_PARAMETERS, Footpoints
from bladewright.fitting.matching.noise import EXACT, LARGEST_GROUP, NEIGHBOURS, SIGNIFICANCE, crowded_at_edges
from bladewright.fitting.matching.search import Match

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


class Finding(NamedTuple):
    """What is said of a match."""

    sentence: str
    fails: bool = True
    """whether the match does not pass for it"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Acceptance:
    """What is said of a match: why it does not pass, and what else there is to know."""

    match: Match
    measurement: Measurement
    statistics: ParameterEstimates
    target: MatchTarget

    def failures(self) -> list[str]:
        """Why the match does not pass, each a sentence."""
        return [each.sentence for each in self._findings if each.fails]

    def notes(self) -> list[str]:
        """What else there is to know, each a sentence."""
        return [each.sentence for each in self._findings if not each.fails]

    @cached_property
    def _findings(self) -> tuple[Finding, ...]:
        deviations = tuple(self._deviations())
        # what a match that is not found misses widens its bands
        known = self._nothing_asked and not any(each.fails for each in deviations)
        parts = self._outliers(), deviations, self._bands(known), self._parts(), self._ends(known), self._parameters()
        return tuple(chain.from_iterable(parts))

    @property
    def _nothing_asked(self) -> bool:
        return self.target.open and not self.match.interrupted

    @property
    def _in_space(self) -> bool:
        return self.measurement.footpoints.points.shape[1] == 3

    @cached_property
    def _loose_ends(self) -> dict[str, float]:
        return coverage.loose_ends(self.match, self.measurement.footpoints.part(self.measurement.inliers))

    @property
    def _one_point(self) -> float:
        """How well one point shows the shape [m] (95 %)."""
        return coverage.NORMAL_95 * self.match.noise_estimate.noise

    def _length(self, metres: float, digits: int = 2) -> str:
        return with_unit(self.match.design, metres, digits)

    def _outliers(self) -> Iterator[Finding]:
        """Outliers that are too many, too many beside each other, or where chance does not put them."""
        measurement, chord = self.measurement, self.match.model.chord
        distances, count, off = measurement.distances, len(measurement.distances), len(measurement.outliers)
        if off > LARGEST_OUTLIER_SHARE * count:
            yield Finding(f"{off} of {count} points lie off the blade: is it one blade, and of this family?")
        # points that are met as nearly as is asked are no part that is not found
        outliers = np.zeros(count, dtype=bool)
        outliers[measurement.outliers] = True
        outliers &= distances > (self.target.tolerance or NEAR_EVERYWHERE * chord)
        together = _largest_group(measurement.footpoints, outliers)
        if len(together) > LARGEST_GROUP * count:
            yield Finding(
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
            yield Finding(
                f"{np.count_nonzero(rows)} of {far} outliers lie {place}, up to "
                f"{self._length(np.max(distances[rows]))} from its sides, more than by chance: is the shape not found "
                "there, or the blade worn? Leave them out, give a start, or state a tolerance"
            )

    def _deviations(self) -> Iterator[Finding]:
        """How far off the match is, against what was asked for, or without a tolerance what is trusted."""
        measurement, chord, tolerance = self.measurement, self.match.model.chord, self.target.tolerance
        mean, largest, worst = measurement.mean, measurement.maximum, measurement.worst
        if self.match.interrupted:
            yield Finding("the search was interrupted: this is the best design so far")
        if self._in_space and mean > GROSS_DEVIATION[0] * chord:
            yield Finding(f"a blade in other axes is met no nearer than this: {AXES_HINT}", fails=False)
        if tolerance is not None:
            if largest > tolerance:
                yield Finding(
                    f"the largest deviation is {self._length(largest, 4)} ({measurement.regions[worst]}, point "
                    f"{worst}), and {self._length(tolerance, 4)} were asked for"
                )
            return
        for word, value, limit in zip(("mean", "largest"), (mean, largest), GROSS_DEVIATION, strict=True):
            if value > limit * chord:
                yield Finding(
                    f"the {word} deviation is {self._length(value, 4)}, {100 * value / chord:.2g} % of the chord, and "
                    f"{100 * limit:.2g} % are allowed where no tolerance is stated: give more parameters, or try "
                    "another family"
                )
        systematic = self.match.noise_estimate.correlation > SHARED_VARIANCE and not self.match.interrupted
        near = largest <= NEAR_EVERYWHERE * chord
        if systematic and self.target.parameters is None and not near:
            yield Finding(self._not_found)
        elif systematic and self.target.open and largest > EXACT * chord:
            yield Finding(f"near enough to make, but {self._not_found}", fails=False)

    @property
    def _not_found(self) -> str:
        rms, noise = self.match.rms * self.match.model.chord, self.match.noise_estimate.noise
        return (
            f"the shape is not found: deviations go on from point to point, {self._length(rms, 3)} rms where the "
            f"cloud's own noise is {self._length(noise, 3)}; state the tolerance that is enough, a number of "
            "parameters, or a start"
        )

    def _bands(self, known: bool) -> Iterator[Finding]:
        """Where the shape is known less well than is trusted, and than one point there would show it."""
        if not self._nothing_asked:
            return
        chord, (places, half_widths) = self.match.model.chord, coverage.shape_bands(self.match)
        limits = chord * np.where(places.from_edges < BETWEEN_EDGES, GROSS_DEVIATION[1], SHOWN_SIDE)
        bare = coverage.bare_places(self.match, places, half_widths <= GROSS_DEVIATION[1] * chord)
        for name, at in bare.items():
            rows = at & (half_widths > limits)
            if np.any(rows):
                letter, along = ("v", places.v[rows]) if name in EDGE_PARAMETERS else ("u", places.u[rows])
                yield Finding(
                    f"no point shows the {name} from {letter} = {min(along):.2g} to {max(along):.2g}: it is known "
                    f"there to {self._length(np.max(half_widths[rows]))} either way (95 %)",
                    fails=False,
                )
        limits = np.where(np.any([*bare.values()], axis=0), np.inf, np.maximum(limits, self._one_point))
        worst = int(np.argmax(half_widths / limits))
        if known and half_widths[worst] > limits[worst]:
            place = f"u = {places.u[worst]:.2g}" + (f", v = {places.v[worst]:.2g}" if self._in_space else "")
            yield Finding(
                f"the points do not show the {SIDES[places.side[worst]]} side at {place}: it is known there to "
                f"{self._length(half_widths[worst])} either way (95 %), and "
                f"{100 * limits[worst] / chord:.2g} % of the chord are allowed: is it a whole blade? Give more points "
                "there, a start, a number of parameters or a tolerance"
            )

    def _parts(self) -> Iterator[Finding]:
        """Parts of the blade without points, long gaps, edges, a side; and edges of another form."""
        given, chord = self.target.structured, self.match.model.chord
        for gap, place in coverage.bare_stretches(self.match):
            cure = "" if given else ": is it a whole blade? Give points there, or a start"
            yield Finding(
                f"no point shows the {place}: {self._length(gap, 3)} without one, {100 * gap / chord:.2g} % of the "
                f"chord{cure}",
                fails=not given,
            )
        for name, (width, share) in coverage.uncovered_edges(self.match).items():
            if share <= HALF_BLADE_WIDTH:
                yield Finding(
                    f"no point lies around the {name}: where it ends and how round it is are guessed", fails=False
                )
                continue
            yield Finding(
                f"no point lies around the {name}, where the blade is still {self._length(width, 3)} wide, "
                f"{share:.0%} of its thickest: is it half a blade? Give the points of the whole"
            )
        for name, width in coverage.foreign_edges(self.match).items():
            yield Finding(
                f"the {name} of the points is cut off, {self._length(width)} wide, and the edges of this family are "
                "round: it stays within half of that (--family profile has blunt and sharp edges)",
                fails=False,
            )
        feet, thickness = self.match.state.footpoints, coverage.least_thickness(self.match)
        between = feet.side[self.match.rows & (feet.from_edges > BETWEEN_EDGES)]
        shares = np.bincount(between, minlength=2) / max(len(between), 1)
        one_side = "is it one side of a blade alone? Give points of both"
        if len(between) and np.min(shares) < MIN_SIDE_SHARE:
            yield Finding(f"hardly a point lies on the {SIDES[np.argmin(shares)]} side: {one_side}")
        elif thickness < SHEET_THICKNESS * chord:
            thin = self._length(thickness, 3)
            yield Finding(f"the blade is a sheet, no more than {thin} thick at a place of its span: {one_side}")

    def _ends(self, known: bool) -> Iterator[Finding]:
        """How well it is known where the blade ends, where no row of points shows it."""
        ends, chord = self._loose_ends, self.match.model.chord
        if not ends:
            return
        allowed = max(GROSS_DEVIATION[0] * chord, self._one_point)
        # where the sides are met everywhere it is a note
        fails = known and self.measurement.maximum > NEAR_EVERYWHERE * chord and max(ends.values()) > allowed
        gaps = ", ".join(f"{self._length(gap)} at the {name}" for name, gap in ends.items())
        cure = (
            f", and {100 * allowed / chord:.2g} % of the chord are allowed: give points there, hold hub and shroud, or "
        )
        cure = f"{cure}state a tolerance" if fails else ""
        yield Finding(f"no row of points shows where the blade ends: it is known to {gaps} (95 %){cure}", fails=fails)

    def _parameters(self) -> Iterator[Finding]:
        """Parameters that the points do not determine, and those on a bound."""
        estimates, rank = self.statistics.estimates, self.statistics.rank
        unknown = self.statistics.unidentified
        # those of ends that no row of points shows are a note
        of_ends = [path for path in unknown if self._loose_ends and path.startswith(("channel.", "flow_path."))]
        if self._nothing_asked and rank < len(estimates) - len(of_ends):
            yield Finding(
                f"the points determine {rank} of the {len(estimates)} parameters: give more points, a number of "
                "parameters, or a tolerance"
            )
        listed = ("the cloud does not determine", unknown), ("on a bound:", self.statistics.at_bounds)
        for words, names in listed:
            if names:
                more = f" and {len(names) - LISTED_NAMES} more" if len(names) > LISTED_NAMES else ""
                yield Finding(f"{words} {', '.join(names[:LISTED_NAMES])}{more}", fails=False)


def _largest_group(feet: Footpoints, outliers: NDArray[np.bool_]) -> NDArray[np.intp]:
    """The largest group of outliers (n,) beside each other, if too large: a part that is not found does not scatter."""
    points, rows = feet.points + feet.miss, np.flatnonzero(outliers)
    if len(rows) <= LARGEST_GROUP * len(points):
        return rows[:0]
    _, index = cKDTree(points).query(points[rows], k=NEIGHBOURS[points.shape[1]] + 1)
    labels = groups(outliers[index], (np.cumsum(outliers) - 1)[index])
    return rows[labels == np.argmax(np.bincount(labels))]
