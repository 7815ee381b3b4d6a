"""From points in the plane to a design of a family that is one part: the best of its structures, and growth."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.assessment.acceptance import GROSS_DEVIATION
from bladewright.fitting.design_header import DesignHeader
from bladewright.fitting.families.growth import (
    can_be_built,
    grown_to_target,
    needs_more,
    predicted_gains,
    tolerance_weights,
)
from bladewright.fitting.families.kinds import FitFamily
from bladewright.fitting.families.section_samples import SampledSection, sampled_section
from bladewright.fitting.families.unified import matched_unified
from bladewright.fitting.free_parameters import FreeParameters
from bladewright.fitting.matching.scales import check_bounds
from bladewright.fitting.matching.search import MOST_ROUNDS, Match, Task, searched
from bladewright.fitting.model_selection.match_target import MatchTarget
from bladewright.section.checks import UNITS
from bladewright.section.section import Section

TRIAL_POINTS = 400
"""points by which structures are compared"""
QUICK_POINTS, THOROUGH_POINTS = 1000, 12_000
"""points of a quick and of a thorough search (`THOROUGH_POINTS`): more points take proportionally longer and determine
parameters better."""
CLOSED_PARAMETERS = 32
"""parameters of the unified section from which the family's first design is taken"""
TRIAL_ROUNDS, QUICK_ROUNDS = 2, 4
"""rounds of a search that compares structures, and of one between two steps of growth (`QUICK_ROUNDS`)"""
PROMISING_RATIO = 3.0
"""ratio of misfits to the best within which a structure is searched on after its trial, in order of their misfits;
`MOST_SEARCHED` at most."""
MOST_SEARCHED = 4
"""structures that are searched on after their trials, at most"""
IDENTIFIED_MISFIT = 1e-9
"""misfit at which the structure is known, of the chord: no noise is so small."""
TOLERANCES = (0.0, 1e-8, 1e-6)
"""tolerances of the native sides, of the chord, finest first: the first is taken that the design can be built with."""
OUTLINE_COUNTS = (24, 32, 44, 60, 80)
"""numbers of points of outlines that are tried in turn"""
FEWEST_OUTLINE_POINTS, OUTLINE_SURPLUS = 12, 2
"""fewest points of an outline where a number of parameters is asked for, and by how many (`OUTLINE_SURPLUS`) its points
are fewer than those: one coordinate is free of each point but two, and four numbers place the section."""
LAWS_TRIED = 2
"""laws that a search gives a control point more, of those that are predicted to gain most."""


def matched_section(
    task: Task, kind: FitFamily, start: Any, like: Any, header: DesignHeader, target: MatchTarget
) -> tuple[Match, str]:
    """The match of points (n, 2) by a section of the family, and why it ends where no target is met.

    `start` and `like` are sections of the family, or None. Raises FitError where no structure of the family has a shape
    near the points.
    """
    many = task.thinned(THOROUGH_POINTS)
    few = task.thinned(QUICK_POINTS)
    section = None
    if start is not None and like is None:
        check_bounds(start, task.free(start), task.bounds)
        found = searched(few, start)
    else:
        section = _closed_section(few, header) if start is None else section_samples(start.build())
        rough = task.thinned(TRIAL_POINTS)
        parts = kind.templates(section, target.parameters) if like is None else [like.section]
        starts = [start for part in parts for start in starts_of(kind, section, part)]
        found = best_trial(rough, few, _design_maker(kind, section, header, task), starts)
    reason = ""
    if not target.structured:
        found, reason = grown_to_target(few, found, target, partial(_wider, kind=kind), coarse=TOLERANCES[-1])
        if kind.through_points is not None and section is not None:
            found, reason = _through_points(
                few, found, target, partial(kind.through_points, section), _design_maker(kind, section, header, task)
            )
    return _buildable_tolerance(_searched_thoroughly(many, found)), reason


def _through_points(
    task: Task, match: Match, target: MatchTarget, through_points: Callable[[int], Any], made: Callable[[Any], Design]
) -> tuple[Match, str]:
    """A match by points of the outline where no other meets the target, by as few as do."""
    stated_count = 0 if target.parameters is None else target.parameters - OUTLINE_SURPLUS
    for count in (stated_count,) if stated_count >= FEWEST_OUTLINE_POINTS else OUTLINE_COUNTS:
        short, reason = needs_more(match, target, task)
        near = target.open and match.maximum < GROSS_DEVIATION[1] * match.model.chord
        if not short or near:
            return match, reason
        try:
            fresh = searched(task, made(through_points(count)), rounds=QUICK_ROUNDS)
        except (DesignError, FitError):
            continue
        fresh = replace(fresh, evaluations=fresh.evaluations + match.evaluations)
        within = target.parameters is None or len(fresh.problem.paths) <= target.parameters
        if within and fresh.rms < match.rms and _is_buildable(fresh):
            match = fresh
    met = target.parameters is not None or not needs_more(match, target, task)[0]
    return match, "" if met else "no outline of points comes nearer"


def section_samples(built: Section) -> SampledSection:
    """The samples of a built section."""
    radii = built.edge_radii
    return sampled_section(built.curves["upper"], built.curves["lower"], radii)


def _closed_section(task: Task, header: DesignHeader) -> SampledSection:
    """The section that points alone show, closed around both edges: that of the unified family."""
    task = Task(points=task.points, weights=task.weights, free=FreeParameters(), bounds={}, progress=task.progress)
    try:
        return section_samples(matched_unified(task, None, None, header, MatchTarget(parameters=CLOSED_PARAMETERS))[1])
    except FitError as error:
        raise FitError(f"no closed section was found near the points ({error}); give a start design") from error


def _design_maker(
    kind: FitFamily, section: SampledSection, header: DesignHeader, task: Task
) -> Callable[[Any], Design]:
    """The design that a part begins as."""
    metre = UNITS[header.length_unit]

    def made(part: Any) -> Design:
        design: Design = kind.section(
            name=header.name,
            length_unit=header.length_unit,
            chord=section.chord / metre,
            pitch=None if header.pitch is None else header.pitch / metre,
            leading_edge_x=float(section.start[0]) / metre,
            leading_edge_y=float(section.start[1]) / metre,
            section=part,
        )
        design = task.free.applied(design) if isinstance(task.free, FreeParameters) else design
        check_bounds(design, task.free(design), task.bounds)
        return design

    return made


def starts_of(kind: FitFamily, section: SampledSection, part: Any) -> Sequence[Any]:
    """The parts of a structure near a section; none where it has no such shape."""
    try:
        return kind.starts(section, part)
    except DesignError:
        return ()


def best_trial(
    rough: Task, few: Task, made: Callable[[Any], Design], parts: Sequence[Any], *, rounds: int = MOST_ROUNDS
) -> Match:
    """The nearest match of several structures; raises the last refusal where none has a shape."""
    tried: list[Match] = []
    refusal = FitError("no structure of the family was tried")
    for part in parts:
        try:
            tried.append(searched(rough, made(part), rounds=TRIAL_ROUNDS))
        except (DesignError, FitError) as error:
            refusal = FitError(str(error))
            continue
    if not tried:
        raise FitError(f"no section of the family was found near the points ({refusal}); give a start design")
    least = min(each.rms for each in tried)
    found: Match | None = None
    for number, each in enumerate(sorted(tried, key=lambda one: one.rms)):
        if (
            found is not None
            and _is_buildable(found)
            and (each.rms > PROMISING_RATIO * least or number >= MOST_SEARCHED)
        ):
            break
        fresh = searched(few, each.design, rounds=rounds)
        if (
            found is None
            or (fresh.rms < found.rms and can_be_built(fresh, TOLERANCES[-1]))
            or not can_be_built(found, TOLERANCES[-1])
        ):
            found = fresh
        if found.rms < IDENTIFIED_MISFIT:
            break
    assert found is not None  # noqa: S101 - one was tried at least
    return found


def _is_buildable(match: Match) -> bool:
    return can_be_built(match, TOLERANCES[-1])


def _wider(task: Task, match: Match, target: MatchTarget, back: int, *, kind: FitFamily) -> Iterator[Match]:
    """Matches with one control point more, of the laws predicted to gain most, or of the next ones after a failure."""
    design: Any = match.design
    try:
        # an intermediate section that crosses itself has sides all the same
        sides: Any = match.state.shape.sides
        parts = kind.extensions(design.section, sampled_section(sides[0], sides[1], (0.0, 0.0)))
    except DesignError:
        return
    designs = [replace(design, section=part) for part in parts]
    for _, _, wider in predicted_gains(task, match, designs, tolerance_weights(match, target))[back * LAWS_TRIED :][
        :LAWS_TRIED
    ]:
        try:
            fresh = searched(task, wider, rounds=QUICK_ROUNDS)
        except (DesignError, FitError):
            continue
        yield replace(fresh, evaluations=fresh.evaluations + match.evaluations)


def _searched_thoroughly(task: Task, match: Match) -> Match:
    fresh = searched(task, match.design)
    better = fresh if np.isfinite(fresh.rms) else match
    return replace(better, evaluations=match.evaluations + fresh.evaluations)


def _buildable_tolerance(match: Match) -> Match:
    """The match with the finest tolerance of its native sides with which it can be built: edges may turn fast."""
    for tolerance in TOLERANCES:
        if can_be_built(match, tolerance):
            design: Any = match.design
            return replace(match, design=replace(design, tolerance=max(design.tolerance, tolerance)))
    return match
