"""From points to a design of the unified family."""

from contextlib import suppress
from dataclasses import replace
from typing import Any

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.assessment.acceptance import AXES_HINT, MatchTarget
from bladewright.fitting.families.kinds import DesignHeader
from bladewright.fitting.free_parameters import FreeParameters
from bladewright.fitting.initial_guess.blade import first_blade
from bladewright.fitting.initial_guess.section import first_section
from bladewright.fitting.matching.scales import check_bounds
from bladewright.fitting.matching.search import Match, Task, searched
from bladewright.fitting.model_selection.selection import FINAL_REDUCTION, THOROUGH_POINTS, selected_match
from bladewright.fitting.model_selection.structure import FIRST_SECTION, reshaped, structure_of, with_feasible_edges


def matched_unified(
    task: Task, start: Design | None, like: Design | None, header: DesignHeader, target: MatchTarget
) -> tuple[Match, Any, str]:
    """The match of points (n, 2) or (n, 3), what it builds, and why it ends where no target is met.

    Raises FitError where no design is found near the points, or the nearest one cannot be built.
    """
    wanted = None if like is None else structure_of(like)
    task.progress("first design")
    if start is not None:
        guessed = start if wanted is None else reshaped(start, wanted)
    elif task.dimension == 2:
        points, structure = task.thinned(THOROUGH_POINTS).points, wanted or FIRST_SECTION
        guessed = first_section(
            points, structure=structure, name=header.name, length_unit=header.length_unit, pitch=header.pitch
        )
    else:
        begun = first_blade(task.thinned(THOROUGH_POINTS).points, **header.known(like))
        guessed, task = begun.design, replace(task.turned(begun.turn), outline=begun.walls)
    first = task.free.applied(guessed) if isinstance(task.free, FreeParameters) else guessed
    if start is None and first is not guessed:
        # held values may leave a guess no shape
        first = with_feasible_edges(first)
    check_bounds(first, task.free(first), task.bounds)
    try:
        found, reason = selected_match(task, first, target, like=wanted, guessed=start is None)
        found, built, note = _buildable(task, found, structured=target.structured)
    except FitError as error:
        if start is not None or not isinstance(guessed, UnifiedBlade):
            raise
        around = "the points go far around x: " if header.blade_count is None and guessed.blade_count == 1 else ""
        raise FitError(f"{error}; {around}{AXES_HINT}") from error
    return found, built, note or reason


def _buildable(task: Task, match: Match, *, structured: bool) -> tuple[Match, Any, str]:
    """The match and what it builds; where it is refused, one that keeps further from what is, or another and a note."""
    refusal, paths = DesignError(), match.problem.paths
    for margin_factor in (0.0, 1.0, 30.0, 1000.0):
        if margin_factor:
            # what a match holds stays held
            fresh = replace(task, margin_factor=margin_factor, free=lambda _: paths)
            with suppress(FitError):
                match = searched(fresh, match.design, rounds=2, min_reduction=FINAL_REDUCTION)
        try:
            return match, match.design.build(), ""
        except DesignError as error:
            refusal = error
    return task.best_so_far.instead_of(match, refusal, structured=structured)
