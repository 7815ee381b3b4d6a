"""The edges of a section that the points tell from no sharp one, and further starts with other edges.

A round edge of unknown radius and an end of the blade further in make up for each other, so that least squares alone
leave the tip of a wedge short by several radii. A nose slid along the outline is a minimum of its own.
"""

from collections.abc import Iterator
from contextlib import suppress
from functools import partial

import numpy as np
from scipy.special import chdtri

from bladewright.errors import DesignError, FitError
from bladewright.fitting.assessment.acceptance import GROSS_DEVIATION
from bladewright.fitting.matching.footpoints import Side
from bladewright.fitting.matching.search import QUICK_ROUNDS, ROUGH_REDUCTION, Match, Task, searched
from bladewright.fitting.model_selection.reshaping import with_feasible_edges
from bladewright.section.unified_limits import ANGLES, RADII, TANGENTS

SHARP_RADIUS = 5e-6
"""radius of such an edge, of the axial chord: a wedge of 15 deg ends 3.3e-5 before its tip, by r / sin(7.5 deg) - r, a
third of what exact points are met within. Half and twice change nothing measured (design/matching_constants.md)."""
SHARPER_BY_CHANCE = 0.05
"""probability that a round edge leaves so much less than a sharp one by chance, where it is sharp (Wilks 1938)."""
SHARP_NOTE = (
    "the points tell the {} from no sharp one, and the edges of this family are round: the radius is held "
    f"at {SHARP_RADIUS:g} (--family profile has sharp edges)"
)
"""note of such edges"""
EDGES = {
    "leading edge": ("leading_edge_radius", slice(None, 3)),
    "trailing edge": ("trailing_edge_radius", slice(-1, -4, -1)),
}
"""the radius of each edge, and the control points of a side from there"""


def with_sharp_edges(task: Task, match: Match) -> tuple[Task, Match, str]:
    """The match of a section with the radii of such edges held, its task, and a note of them."""
    sharp, again = list[str](), partial(searched, rounds=QUICK_ROUNDS + 1, min_reduction=ROUGH_REDUCTION)
    for name, (radius, ends) in EDGES.items() if task.dimension == 2 else ():
        if radius not in match.problem.paths or not all(_pointed(side, ends) for side in match.state.shape.sides):
            continue
        held = task.without((radius,))
        try:
            match = again(task, match.design, noise=match.rms)
            found = again(held, match.design.changed({radius: SHARP_RADIUS}), noise=match.rms)
            found.design.build()
        except (DesignError, FitError):
            continue
        before, after = (np.sum(each.state.footpoints.distances[match.rows] ** 2) for each in (match, found))
        count = np.count_nonzero(match.rows) * match.noise_estimate.independent_share(len(match.problem.paths))
        if count * np.log(after / before) < chdtri(1, SHARPER_BY_CHANCE):
            task, match, sharp = held, found, [*sharp, name]
    return task, match, SHARP_NOTE.format(" and the ".join(sharp)) if sharp else ""


def _pointed(side: Side, ends: slice) -> bool:
    """Whether the third control point of a side lies further from its edge than from its camber line."""
    edge, second, third = side.control_points[ends]
    across = (second - edge) / np.sqrt(np.sum((second - edge) ** 2))
    rise = float((third - edge) @ across)
    return 2.0 * rise**2 < float(np.sum((third - edge) ** 2))


USUAL_TANGENT, USUAL_RADIUS = 0.3, 0.01
"""tangent proportions and edge radii of further starts: two of three sections drawn at random that had ended in other
minima are met from one of these, and first matches of blades from radii of 0.05 are as near, within 14 %
(design/matching.md)."""


def from_other_edges(task: Task, match: Match, noise: float) -> Iterator[Match]:
    """Matches from designs whose edges lie elsewhere on the outline: a nose slid along it is a minimum of its own.

    `noise` is the first round's, of the chord. Of sections the camber line is made straight as well.
    """
    known, names = match.design.parameters(), {path: path.partition("[")[0] for path in match.problem.paths}
    usual = {**dict.fromkeys(TANGENTS, USUAL_TANGENT), **dict.fromkeys(RADII, USUAL_RADIUS)}
    straight = [usual | dict.fromkeys(ANGLES, known["stagger"])] if "stagger" in known else []
    for values in (usual, *straight):
        changes = {path: values[name] for path, name in names.items() if name in values}
        with suppress(DesignError, FitError):
            if changes:
                start = with_feasible_edges(match.design.changed(changes))
                yield searched(task, start, noise=noise, min_reduction=ROUGH_REDUCTION)


def nearest_from_other_edges(task: Task, match: Match, noise: float) -> Match:
    """The nearest of a match and those from other edges; one as near as is trusted is not searched again.

    All points count, as those of an edge that is not found are left out: of LS89 as a blade 44 of 1,000, so that with
    other edges it is 2.4e-4 off on rms, 6.1e-4 without (design/matching.md).
    """
    if np.max(match.state.footpoints.distances) <= GROSS_DEVIATION[1] * match.model.chord:
        return match
    return min((match, *from_other_edges(task, match, noise)), key=lambda each: each.mean_distance)
