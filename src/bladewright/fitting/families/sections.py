"""From points in the plane to a design of a family that is one part."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from scipy.spatial import cKDTree
from scipy.special import chdtri

from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.assessment.acceptance import NEAR_EVERYWHERE, MatchTarget, trusted_distance
from bladewright.fitting.families.closed_blade import SectionShape, section_shape
from bladewright.fitting.families.first_parts import through_points
from bladewright.fitting.families.kinds import DesignHeader, FitFamily
from bladewright.fitting.families.unified import first_section, matched_unified
from bladewright.fitting.free_parameters import FreeParameters, check_bounds
from bladewright.fitting.matching.noise import OUTLYING_MISFIT
from bladewright.fitting.matching.search import ROUGH_REDUCTION, Match, Task, can_be_built, searched
from bladewright.fitting.model_selection.selection import SEVERAL_POINTS, determined, selected_match
from bladewright.fitting.model_selection.structure import structure_of
from bladewright.fitting.model_selection.structure_search import NEAR, SETTLED_RICH
from bladewright.fitting.models.designs import SINGLE_SECTION
from bladewright.section.checks import UNITS

TRIAL_POINTS, TRIAL_ROUNDS = 400, 2
"""points and rounds of the search by which first designs are compared (design/matching_constants.md)"""
CONSIDERED, PROMISING = 3, 3.0
"""first designs that are searched on at most, and largest ratio of their misfits to the least (design/matching.md)"""
EXACT = 1e-9
"""misfit below which matches are alike, of the chord: as near as native curves are (design/matching_constants.md)"""
CONTOUR_POINTS = {2: 44, 3: 32}
"""points of contours along the chord where no profile is near enough, by dimension (design/matching.md)"""
OUTLINE_DEVIATION = 1e-4
"""largest distance with which exact points need no contour, of the chord (design/matching_constants.md)"""
BESIDE, BY_CHANCE = 16, 1e-3
"""points beside each other that tell a misfit at an edge, which seldom has more, and probability that noise looks like
one, by the chi-squared test (Pearson 1900) [-]"""
TOLERANCES = (0.0, 1e-8, 1e-6)
"""tolerances of the native sides that are tried in turn, of the chord (design/matching_constants.md)"""


def matched_section(
    task: Task, kind: FitFamily, start: Any, like: Any, header: DesignHeader, target: MatchTarget
) -> tuple[Match, str]:
    """The match of points (n, 2) by a section of the family, which `start` and `like` are of, and why it ends."""
    if start is not None and like is None:
        check_bounds(start, task.free(start), task.bounds)
        found, reason = selected_match(task, start, target, like=None, guessed=False)
        return buildable_tolerance(found), reason
    if start is not None or kind.contour_shape is None:
        closed = start or first_section(task.points, replace(header, pitch=None))
        shape = section_shape(closed.build())
    elif (contour := kind.contour_shape(task.points)) is not None:
        # a smooth contour through all points in order has no outliers, and shows both ends of its chord line
        shape, task = contour, replace(task, allow_outliers=False)
        if task.free.free is None:
            task = replace(task, free=replace(task.free, fixed=(*task.free.fixed, "chord", "leading_edge_x")))
    else:
        # its segments are laid on the section one by one, which must be as near as a match
        free = replace(task, free=FreeParameters(), bounds={})
        shape = section_shape(matched_unified(free, None, None, header, MatchTarget())[0].design.build())
    part = None if like is None else like.section
    tried = compared(task.thinned(TRIAL_POINTS), first_designs(kind, shape, part, header, task))
    structure = None if like is None else structure_of(like)
    off = misfits(tried[:CONSIDERED])
    promising = [each.design for each, miss in zip(tried, off, strict=False) if miss <= PROMISING * off[0]]
    found, reason = nearest(task, promising, target, structure)
    if kind.has_contours and like is None and is_far(found, target):
        # one coordinate is free of each point but two, and four numbers place the section
        count = CONTOUR_POINTS[2] if target.parameters is None else target.parameters - 2

        def outlined(closed: Any) -> Design:
            own = section_shape(closed.build())
            return _design_of(kind, own, through_points(own, count), header, task)

        # a round edge needs more points to be none of several corners than that of a profile
        begun = [partial(outlined, each) for each in (closed, found.design)]
        contours = [contour_match(task, found, target, first) for first in begun]
        tried_on = filter(None, ((found, reason), *contours))
        found, reason = min(tried_on, key=lambda each: (not _is_built(each[0]), criterion(each[0], target)))
    return buildable_tolerance(found), reason


def nearest(task: Task, designs: Sequence[Design], target: MatchTarget, like: Any) -> tuple[Match, str]:
    """The best of the matches that begin with several designs, one that can be built first, and why it ends."""
    found, built = list[tuple[Match, str]](), list[tuple[Match, str]]()
    refusal: Exception = FitError("no design of the family was tried")
    for design in designs:
        check_bounds(design, task.free(design), task.bounds)
        try:
            found.append(selected_match(task, design, target, like=like, guessed=True))
        except (DesignError, FitError) as error:
            refusal = error
            continue
        match, _ = found[-1]
        if _is_built(match):
            built.append(found[-1])
            if match.maximum < NEAR * match.model.chord:
                break
    if not found:
        raise FitError(str(refusal)) from refusal
    return min(built or found, key=lambda each: criterion(each[0], target))


def _is_built(match: Match) -> bool:
    """Whether a match can be built at one of the tolerances."""
    return can_be_built(_within(match.design, TOLERANCES[-1]))


def criterion(match: Match, target: MatchTarget) -> tuple[int, float]:
    """What the best of several matches has least of: parameters where a tolerance is kept, else Schwarz's criterion.

    A match that has no misfit beyond the noise anywhere comes before one that has, as few points show an edge, and of
    two that have one the match that is nowhere farther than is trusted. Reference: Schwarz 1978, Estimating the
    dimension of a model.
    """
    count, points = len(match.problem.paths), np.count_nonzero(match.rows)
    if target.tolerance is not None and match.maximum <= target.tolerance:
        return 0, float(count)
    if target.parameters is not None and count > target.parameters:
        return 4, np.inf
    misfit = _has_misfit(match)
    schwarz = float(points * np.log(max(match.rms, EXACT) ** 2) + count * np.log(points))
    return 1 + misfit + (misfit and match.maximum > trusted_distance(match)), schwarz


def _worst_neighbourhood(match: Match) -> float:
    """The largest mean square distance of points beside each other [m^2]."""
    feet = match.state.footpoints.part(match.rows)
    beside = cKDTree(feet.points).query(feet.points, k=min(BESIDE, len(feet.u)))[1]
    return float(np.max(np.mean(feet.distances[beside] ** 2, axis=-1)))


def _has_misfit(match: Match) -> bool:
    """Whether points lie further off than their noise, as a whole or anywhere beside each other."""
    allowed = chdtri(BESIDE, BY_CHANCE / np.count_nonzero(match.rows)) / BESIDE
    return match.has_systematic_misfit or _worst_neighbourhood(match) > allowed * match.noise_estimate.noise**2


def is_far(match: Match, target: MatchTarget, open_limit: float | None = None) -> bool:
    """Whether a match is not what is asked for, or where nothing is, farther than a limit, of the chord, or trusted."""
    share = open_limit or (OUTLINE_DEVIATION if match.is_exact else NEAR_EVERYWHERE)
    limit = share * match.model.chord if target.tolerance is None else target.tolerance
    short = target.parameters is not None and len(match.problem.paths) < target.parameters
    return (short or (target.parameters is None and match.maximum > limit)) and _has_misfit(match)


def contour_match(
    task: Task, match: Match, target: MatchTarget, first: Callable[[], Design]
) -> tuple[Match, str] | None:
    """The match that begins as a design by contours, to another's inliers, and its reason; None where none is built."""
    # a contour that has not found an edge would leave it out
    inliers = task.thinned(len(match.rows)).part(np.flatnonzero(match.rows))
    some = replace(inliers.thinned(SEVERAL_POINTS), allow_outliers=False)
    try:
        found = searched(some, first(), min_reduction=ROUGH_REDUCTION, settled=SETTLED_RICH, fading=True)
        outlined = determined(some, found) if target.open else (found, "")
    except (DesignError, FitError):
        return None
    return outlined if _is_built(outlined[0]) else None


def first_designs(
    kind: FitFamily, shape: SectionShape, like: Any, header: DesignHeader, task: Task
) -> Iterator[Design]:
    """The designs that the kinds of a family begin as near a section, or those of the structure of a given part."""
    for part in kind.first_parts(shape, like):
        inside = shape
        # what has no outline is refused where it is searched
        with suppress(DesignError):
            outline = part.outline(SINGLE_SECTION)
            edges = zip((outline.leading_edge, outline.trailing_edge), shape.radii, strict=True)
            # a blunt edge that stands out of the points is nearest to none, and stays
            inside = shape.within(*(radius * (edge.kind == "blunt") for edge, radius in edges))
        yield _design_of(kind, inside, part, header, task)


def _design_of(kind: FitFamily, shape: SectionShape, part: Any, header: DesignHeader, task: Task) -> Design:
    """The design that a part begins as, where a section stands."""
    metre = UNITS[header.length_unit]
    design: Design = kind.section(
        name=header.name,
        length_unit=header.length_unit,
        chord=shape.chord / metre,
        pitch=None if header.pitch is None else header.pitch / metre,
        leading_edge_x=float(shape.start[0]) / metre,
        leading_edge_y=float(shape.start[1]) / metre,
        section=part,
    )
    return task.free.applied(design)


def compared(task: Task, designs: Iterable[Design], *, rounds: int = TRIAL_ROUNDS) -> list[Match]:
    """Searches from several designs, nearest first; raises the last refusal where none has a shape."""
    found, refusal = [], FitError("no structure of the family was tried")
    for design in designs:
        try:
            found.append(searched(task, design, rounds=rounds, fading=True))
        except (DesignError, FitError) as error:
            refusal = FitError(str(error))
    if not found:
        raise FitError(f"no section of the family was found near the points ({refusal}); give a start design")
    return [found[number] for number in np.argsort(misfits(found), kind="stable")]


def misfits(matches: Sequence[Match]) -> list[float]:
    """Root mean square distances by which matches to the same points are compared, each of its chord.

    Outliers count, as those of an edge that is not found are its own, by no more than one of the nearest match.
    """
    bound = OUTLYING_MISFIT * min(each.rms for each in matches)
    distances = (each.state.footpoints.distances[~each.ends.on_end_face] / each.model.chord for each in matches)
    return [float(np.sqrt(np.mean(np.minimum(each, bound) ** 2))) for each in distances]


def _within(design: Any, tolerance: float) -> Any:
    """The design with a tolerance of its native sides at least: its sections may cross themselves by less."""
    return replace(design, tolerance=max(design.tolerance, tolerance))


def buildable_tolerance(match: Match) -> Match:
    """The match with the finest tolerance of its native sides with which it can be built: edges may turn fast."""
    designs = (_within(match.design, tolerance) for tolerance in TOLERANCES)
    return replace(match, design=next(filter(can_be_built, designs), match.design))
