"""From points to a design of the unified family."""

from dataclasses import replace
from typing import Any

from bladewright.blade.unified import UnifiedBlade
from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.clouds.thinning import drawn
from bladewright.fitting.first.blade import first_blade
from bladewright.fitting.first.designed import AXES
from bladewright.fitting.first.profile import first_section
from bladewright.fitting.frame import Frame
from bladewright.fitting.freedom import Freedom
from bladewright.fitting.matching.descent import SLIGHT
from bladewright.fitting.matching.scales import check_bounds
from bladewright.fitting.matching.search import ROUGH, Found, Task, searched
from bladewright.fitting.structures.adaptation import FINE, MANY, adapted
from bladewright.fitting.structures.aim import Aim
from bladewright.fitting.structures.cambers import STRAIGHT
from bladewright.fitting.structures.given import CLEAR, misses
from bladewright.fitting.structures.identification import EXACT, FEWEST
from bladewright.fitting.structures.lean import lean, rich
from bladewright.fitting.structures.opening import opened
from bladewright.fitting.structures.reshaping import reshaped
from bladewright.fitting.structures.structure import Structure, structure_of

LEANER = (1.0, 0.5)
"""parts of the control points along the chord that are tried where a nearest design cannot be built"""
NEARLY, SOME = 3e-3, 2500
"""noise of the first round with those, of the chord, and points"""
LESS = "the nearest design cannot be built: this one's camber bends less at the edges, with {} parameters for {}"


def matched_unified(
    task: Task, start: Design | None, like: Design | None, frame: Frame, aim: Aim
) -> tuple[Found, Any, str]:
    """The match of points (n, 2) or (n, 3), what it builds, and why it ends where no aim is met.

    Raises FitError where no design is found near the points, or the nearest one cannot be built.
    """
    solid, wanted = task.points.shape[1] == 3, None if like is None else structure_of(like)
    told = solid and wanted is not None and start is None and aim.structured and aim.tolerance is None
    task.told("first design")
    if start is not None:
        guessed = start if wanted is None else reshaped(start, wanted)
    else:
        free = rich(aim.parameters) if solid else wanted
        try:
            guessed = _guess(task, wanted if told else free, like, frame)
        except FitError:
            if not told:
                raise
            guessed = _guess(task, free, like, frame)
    first = _freed(task, guessed, started=start is not None)
    check_bounds(first, task.free(first), task.bounds)
    base = None
    if start is None and (solid or wanted is None):
        base = wanted or lean(task.points.shape[1], aim.parameters)
    try:
        found, reason = adapted(task, first, aim, base=base, guessed=start is None)
        if told and found.rms > EXACT and misses(found, CLEAR):
            # from a first design with freer laws the same structure is met elsewhere
            freer = _freed(task, _guess(task, rich(None), like, frame), started=False)
            other, _ = adapted(task, freer, aim, base=base, guessed=True)
            evaluations = found.evaluations + other.evaluations
            found = replace(min((found, other), key=lambda each: each.rms), evaluations=evaluations)
        found, built, leaner = _built(task, found, fewer=start is None and like is None and aim.parameters is None)
    except FitError as error:
        if frame.blade_count is None and isinstance(guessed, UnifiedBlade) and guessed.blade_count == 1:
            raise FitError(f"{error}; the points go far around x: {AXES}") from error
        raise
    return found, built, leaner or reason


def _freed(task: Task, guessed: Design, *, started: bool) -> Design:
    """A first design with the values that are held, opened where it is a guess that they leave no shape."""
    first = task.free.applied(guessed) if isinstance(task.free, Freedom) else guessed
    return first if started or first is guessed else opened(first)


def _guess(task: Task, structure: Structure | None, like: Design | None, frame: Frame) -> Design:
    """The first design, from the points alone; what `like` says of the row where nothing else does."""
    some = task.points[drawn(len(task.points), MANY)]
    if task.points.shape[1] == 2:
        lengths: dict[str, Any] = {}
        if structure is not None:
            lengths = {name: getattr(structure, name) for name in ("chordwise", "samples", "clustering")}
        return first_section(some, name=frame.name, length_unit=frame.length_unit, **lengths)
    row = frame.row(like)
    return first_blade(some, structure=structure, name=frame.name, length_unit=frame.length_unit, **row)


def _built(task: Task, found: Found, *, fewer: bool) -> tuple[Found, Any, str]:
    """What the found design builds, and in words where it is not the nearest one.

    Where that is refused, of a design that keeps further from what is refused; with `fewer`, at last of one whose
    camber has no hooks at the edges, or of one with fewer control points along the chord besides.
    """
    refusal = ""
    for slack in (0.0, 1.0, 30.0, 1000.0):
        if slack:
            slight = FINE if found.rms > EXACT else SLIGHT
            found = searched(replace(task, slack=slack), found.design, rounds=2, slight=slight)
        try:
            return found, found.design.build(), ""
        except DesignError as error:
            refusal = str(error)
    structure = structure_of(found.design)
    few = task.part(drawn(len(task.points), SOME))
    straight = replace(few, bounds={**STRAIGHT, **task.bounds})
    for share in LEANER if fewer and not found.interrupted else ():
        upper, lower = (max(FEWEST, round(share * count)) for count in structure.chordwise)
        design = opened(reshaped(found.design, replace(structure, chordwise=(upper, lower))))
        try:
            other = searched(straight, design, noise=NEARLY, slight=ROUGH)
            built = other.design.build()
        except (DesignError, FitError):
            continue
        return other, built, LESS.format(len(other.problem.paths), len(found.problem.paths))
    raise FitError(
        f"the nearest design cannot be built ({refusal}); give a start design, or other numbers of parameters"
    )
