"""From points to a design of the unified family."""

from dataclasses import replace
from typing import Any

from bladewright.blade.unified import UnifiedBlade
from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.adaptation import FINE, MANY, adapted
from bladewright.fitting.aim import Aim
from bladewright.fitting.descent import SLIGHT
from bladewright.fitting.first.blade import first_blade
from bladewright.fitting.first.designed import AXES
from bladewright.fitting.first.profile import first_section
from bladewright.fitting.frame import Frame
from bladewright.fitting.freedom import Freedom
from bladewright.fitting.identification import EXACT
from bladewright.fitting.lean import lean, rich
from bladewright.fitting.opening import opened
from bladewright.fitting.reshaping import reshaped
from bladewright.fitting.scales import check_bounds
from bladewright.fitting.search import Found, Task, searched
from bladewright.fitting.structure import Structure, structure_of
from bladewright.fitting.thinning import drawn


def matched_unified(
    task: Task, start: Design | None, like: Design | None, frame: Frame, aim: Aim
) -> tuple[Found, Any, str]:
    """The match of points (n, 2) or (n, 3), what it builds, and why it ends where no aim is met.

    Raises FitError where no design is found near the points, or the nearest one cannot be built.
    """
    solid, wanted = task.points.shape[1] == 3, None if like is None else structure_of(like)
    task.told("first design")
    if start is not None:
        guessed = start if wanted is None else reshaped(start, wanted)
    else:
        guessed = _guess(task, rich(aim.parameters) if solid else wanted, like, frame)
    first = task.free.applied(guessed) if isinstance(task.free, Freedom) else guessed
    if start is None and first is not guessed:
        first = opened(first)
    check_bounds(first, task.free(first), task.bounds)
    base = None
    if start is None and (solid or wanted is None):
        base = wanted or lean(task.points.shape[1], aim.parameters)
    try:
        found, reason = adapted(task, first, aim, base=base, guessed=start is None)
        found, built = _built(task, found)
    except FitError as error:
        if frame.blade_count is None and isinstance(guessed, UnifiedBlade) and guessed.blade_count == 1:
            raise FitError(f"{error}; the points go far around x: {AXES}") from error
        raise
    return found, built, reason


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


def _built(task: Task, found: Found) -> tuple[Found, Any]:
    """What the found design builds; where it is refused, of a design that keeps further from what is refused."""
    refusal = ""
    for slack in (0.0, 1.0, 30.0, 1000.0):
        if slack:
            slight = FINE if found.rms > EXACT else SLIGHT
            found = searched(replace(task, slack=slack), found.design, rounds=2, slight=slight)
        try:
            return found, found.design.build()
        except DesignError as error:
            refusal = str(error)
    raise FitError(
        f"the nearest design cannot be built ({refusal}); give a start design, or other numbers of parameters"
    )
