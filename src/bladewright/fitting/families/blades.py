"""From points in space to a blade from sections of a family."""

from dataclasses import replace
from typing import Any

import numpy as np

from bladewright.errors import DesignError, FitError
from bladewright.fitting.assessment.acceptance import NEAR_EVERYWHERE, SHARED_VARIANCE, MatchTarget
from bladewright.fitting.families.closed_blade import PLACES, SectionShape
from bladewright.fitting.families.first_blades import SECTION_SPANS, first_of_family, part_of_laws
from bladewright.fitting.families.first_parts import through_points
from bladewright.fitting.families.kinds import DesignHeader, FitFamily
from bladewright.fitting.families.sections import (
    CONTOUR_POINTS,
    PROMISING,
    contour_match,
    criterion,
    is_far,
    misfits,
)
from bladewright.fitting.free_parameters import check_bounds
from bladewright.fitting.initial_guess.blade import first_blades
from bladewright.fitting.matching.search import Match, Task
from bladewright.fitting.model_selection.selection import THOROUGH_POINTS, RichMatch, reduced_match, rich_match
from bladewright.fitting.model_selection.structure import reshaped, structure_of
from bladewright.section.laws import Span


def matched_blade(
    task: Task, kind: FitFamily, start: Any, like: Any, header: DesignHeader, target: MatchTarget
) -> tuple[Match, str]:
    """The match of points (n, 3) by a blade of the family, which `start` and `like` are of, and why it ends."""
    own = start is None and like is None
    if own:
        task = replace(task, free=replace(task.free, walls=True))
    tried, refusals, trials = list[tuple[Task, RichMatch]](), list[Exception](), list[Match]()
    # how near a number of parameters comes does not tell arrangements apart, a rich match does
    asked = replace(target, parameters=None)
    few = task.thinned(THOROUGH_POINTS).points
    begun_with = [None] if start is not None else first_blades(few, header.known(like))
    for begun in begun_with:
        there, first = task, start
        try:
            if begun is not None:
                turn, first, trial = first_of_family(task, begun, kind, like, header)
                there, trials = task.turned(turn), [*trials, trial]
                # short searches tell what is so much further off
                off = misfits(trials)
                if tried and off[-1] > PROMISING * off[0]:
                    break
            tried.append((there, _rich(there, first, like, target, guessed=start is None)))
        except (DesignError, FitError) as error:
            refusals.append(error)
            continue
        if not is_far(tried[-1][1].match, asked):
            break
    if not tried:
        raise refusals[0]
    task, rich = min(tried, key=lambda each: criterion(each[1].match, asked))
    found, reason = reduced_match(rich, target)
    misfit = is_far(found, target, NEAR_EVERYWHERE) and found.noise_estimate.correlation > SHARED_VARIANCE
    if kind.has_contours and own and misfit and target.parameters is None:
        design: Any = found.design
        outlined = contour_match(task, found, target, lambda: replace(design, section=contours_along(design.section)))
        found, reason = min(filter(None, ((found, reason), outlined)), key=lambda each: criterion(each[0], target))
    return found, "; ".join(filter(None, (reason, "" if own else "hub and shroud are held as they are given")))


def _rich(task: Task, first: Any, like: Any, target: MatchTarget, *, guessed: bool) -> RichMatch:
    """The rich match that begins with a blade, or that of the structure of `like` if any."""
    structure = None if like is None else structure_of(like)
    first = first if structure is None else reshaped(first, structure)
    first = task.free.applied(first)
    check_bounds(first, task.free(first), task.bounds)
    return rich_match(task, first, target, like=structure, guessed=guessed)


def contours_along(part: Any) -> Any:
    """Contours through points of a part's sections along the span, apart from where they stand."""
    span = Span(SECTION_SPANS)
    upper, lower = (np.real(side) for side in part.outline(span).points(PLACES))
    turns = np.broadcast_to(np.real(part.stagger(span)), len(SECTION_SPANS))
    shapes = [
        SectionShape(chord=1.0, stagger=float(turn), start=np.zeros(2), upper=u, lower=w, edge_radii=(0.0, 0.0))
        for turn, u, w in zip(turns, upper, lower, strict=True)
    ]
    return part_of_laws([through_points(each, CONTOUR_POINTS[3]) for each in shapes])
