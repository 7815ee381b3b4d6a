"""From points in the plane to a design of a family that is one part: the best of its structures, and more of it."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.clouds.thinning import drawn
from bladewright.fitting.families.foreseen import promised
from bladewright.fitting.families.growing import sound, sufficient
from bladewright.fitting.families.kinds import Kind
from bladewright.fitting.families.sampled import Sampled, sampled
from bladewright.fitting.frame import Frame
from bladewright.fitting.freedom import Freedom
from bladewright.fitting.judgement.verdict import GROSS
from bladewright.fitting.matching.scales import check_bounds
from bladewright.fitting.matching.search import ROUNDS, Found, Task, searched
from bladewright.fitting.structures.aim import Aim, short_of
from bladewright.fitting.structures.growth import emphasis_of
from bladewright.fitting.unified import matched_unified
from bladewright.section.checks import UNITS
from bladewright.section.section import Section

FEWEST = 400
"""points by which structures are told apart"""
FEW, MANY = 1000, 12_000
"""points of a quick and of a thorough search"""
CLOSED = 32
"""parameters of the unified section that says where to begin"""
ROUGH, QUICK = 2, 4
"""rounds of a search that tells structures apart, and of one between two steps of growth"""
NEAR = 3.0
"""ratio of misfits within which a structure is searched on after the rough search"""
MOST = 4
"""structures that are searched on"""
EXACT = 1e-9
"""misfit at which a structure is known, of the chord"""
TOLERANCES = (0.0, 1e-8, 1e-6)
"""of the native sides, of the chord"""
OUTLINES = (24, 32, 44, 60, 80)
"""points of outlines that are tried in turn"""
FEWEST_POINTS, HELD_POINTS = 12, 2
"""fewest points of an outline of so many parameters as are asked for, and by how many it has more points than those:
one number is free of each point but two, and four place the section"""
TRIED = 2
"""laws that are given a control point more by a search, of those that promise most"""


def matched_section(task: Task, kind: Kind, start: Any, like: Any, frame: Frame, aim: Aim) -> tuple[Found, str]:
    """The match of points (n, 2) by a section of the family, and why it ends where no aim is met.

    `start` and `like` are sections of the family, or None. Raises FitError where no structure of the family has a shape
    near the points.
    """
    many = thinned(task, MANY)
    few = thinned(task, FEW)
    section = None
    if start is not None and like is None:
        check_bounds(start, task.free(start), task.bounds)
        found = searched(few, start)
    else:
        section = _closed(few, frame) if start is None else section_samples(start.build())
        rough = thinned(task, FEWEST)
        parts = kind.templates(section, aim.parameters) if like is None else [like.section]
        starts = [start for part in parts for start in started_of(kind, section, part)]
        found = best_of(rough, few, _maker(kind, section, frame, task), starts)
    reason = ""
    if not (aim.structured or found.interrupted):
        found, reason = sufficient(few, found, aim, partial(_wider, kind=kind), coarse=TOLERANCES[-1])
        if kind.outlined is not None and section is not None:
            found, reason = _outlined(
                few, found, aim, partial(kind.outlined, section), _maker(kind, section, frame, task)
            )
    return _coarsened(found if found.interrupted else _thorough(many, found)), reason


def _outlined(
    task: Task, found: Found, aim: Aim, outlined: Callable[[int], Any], made: Callable[[Any], Design]
) -> tuple[Found, str]:
    """A match by points of the outline where no other has what is asked for, as few as have it."""
    asked = 0 if aim.parameters is None else aim.parameters - HELD_POINTS
    for count in (asked,) if asked >= FEWEST_POINTS else OUTLINES:
        short, reason = short_of(found, aim, task)
        near = aim.open and found.maximum < GROSS[1] * found.model.chord
        if not short or near or found.interrupted:
            return found, reason
        try:
            fresh = searched(task, made(outlined(count)), rounds=QUICK)
        except (DesignError, FitError):
            continue
        fresh = replace(fresh, evaluations=fresh.evaluations + found.evaluations)
        within = aim.parameters is None or len(fresh.problem.paths) <= aim.parameters
        if within and fresh.rms < found.rms and _sound(fresh):
            found = fresh
    met = aim.parameters is not None or not short_of(found, aim, task)[0]
    return found, "" if met else "no outline of points comes nearer"


def section_samples(built: Section) -> Sampled:
    """The samples of a built section."""
    radii = built.edge_radii
    return sampled(built.curves["upper"], built.curves["lower"], radii)


def _closed(task: Task, frame: Frame) -> Sampled:
    """The section that points alone show, closed around both edges: that of the unified family."""
    task = Task(points=task.points, weights=task.weights, free=Freedom(), bounds={}, told=task.told)
    try:
        return section_samples(matched_unified(task, None, None, frame, Aim(parameters=CLOSED))[1])
    except FitError as error:
        raise FitError(f"no closed section was found near the points ({error}); give a start design") from error


def _maker(kind: Kind, section: Sampled, frame: Frame, task: Task) -> Callable[[Any], Design]:
    """The design that a part begins as."""
    metre = UNITS[frame.length_unit]

    def made(part: Any) -> Design:
        design: Design = kind.section(
            name=frame.name,
            length_unit=frame.length_unit,
            chord=section.chord / metre,
            pitch=None if frame.pitch is None else frame.pitch / metre,
            leading_edge_x=float(section.start[0]) / metre,
            leading_edge_y=float(section.start[1]) / metre,
            section=part,
        )
        design = task.free.applied(design) if isinstance(task.free, Freedom) else design
        check_bounds(design, task.free(design), task.bounds)
        return design

    return made


def started_of(kind: Kind, section: Sampled, part: Any) -> Sequence[Any]:
    """The parts of a structure near a section; none where it has no such shape."""
    try:
        return kind.started(section, part)
    except DesignError:
        return ()


def best_of(
    rough: Task, few: Task, made: Callable[[Any], Design], parts: Sequence[Any], *, rounds: int = ROUNDS
) -> Found:
    """The nearest match of several structures; raises the last refusal where none has a shape."""
    tried: list[Found] = []
    refusal = FitError("no structure of the family was tried")
    for part in parts:
        try:
            tried.append(searched(rough, made(part), rounds=ROUGH))
        except (DesignError, FitError) as error:
            refusal = FitError(str(error))
            continue
        if tried[-1].interrupted:
            break
    if not tried:
        raise FitError(f"no section of the family was found near the points ({refusal}); give a start design")
    least = min(each.rms for each in tried)
    found: Found | None = None
    for number, each in enumerate(sorted(tried, key=lambda one: one.rms)):
        if each.interrupted:
            return each
        if found is not None and _sound(found) and (each.rms > NEAR * least or number >= MOST):
            break
        fresh = searched(few, each.design, rounds=rounds)
        if (
            found is None
            or (fresh.rms < found.rms and sound(fresh, TOLERANCES[-1]))
            or not sound(found, TOLERANCES[-1])
        ):
            found = fresh
        if found.rms < EXACT or found.interrupted:
            break
    assert found is not None  # noqa: S101 - one was tried at least
    return found


def _sound(found: Found) -> bool:
    return sound(found, TOLERANCES[-1])


def _wider(task: Task, found: Found, aim: Aim, back: int, *, kind: Kind) -> Iterator[Found]:
    """Matches with a control point more, of the laws that promise most, or of the next where those were taken back."""
    design: Any = found.design
    try:
        # a section that crosses itself on the way has sides all the same
        sides: Any = found.state.shape.sides
        parts = kind.grown(design.section, sampled(sides[0], sides[1], (0.0, 0.0)))
    except DesignError:
        return
    designs = [replace(design, section=part) for part in parts]
    for _, _, wider in promised(task, found, designs, emphasis_of(found, aim))[back * TRIED :][:TRIED]:
        try:
            fresh = searched(task, wider, rounds=QUICK)
        except (DesignError, FitError):
            continue
        yield replace(fresh, evaluations=fresh.evaluations + found.evaluations)


def _thorough(task: Task, found: Found) -> Found:
    fresh = searched(task, found.design)
    better = fresh if np.isfinite(fresh.rms) else found
    return replace(better, evaluations=found.evaluations + fresh.evaluations)


def _coarsened(found: Found) -> Found:
    """The match with the finest tolerance of its native sides that it can be built with: edges may turn fast."""
    for tolerance in TOLERANCES:
        if sound(found, tolerance):
            design: Any = found.design
            return replace(found, design=replace(design, tolerance=max(design.tolerance, tolerance)))
    return found


def thinned(task: Task, count: int) -> Task:
    """A task with so many of its points at most."""
    rows = drawn(len(task.points), count)
    if len(rows) == len(task.points):
        return task
    precision = None if task.precision is None else task.precision[rows]
    return replace(task, points=task.points[rows], weights=task.weights[rows], precision=precision)
