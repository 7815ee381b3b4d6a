"""From points to a design of the unified family, and its first section from points in the plane."""

from dataclasses import replace

import numpy as np

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Design
from bladewright.errors import BladewrightError, FitError
from bladewright.fitting.assessment.acceptance import AXES_HINT, MatchTarget
from bladewright.fitting.clouds.thinning import even_subset, without_isolated_points
from bladewright.fitting.families.kinds import DesignHeader
from bladewright.fitting.free_parameters import check_bounds
from bladewright.fitting.initial_guess.blade import first_blades
from bladewright.fitting.initial_guess.slices import STEEPEST, PlanePoints, longest_chord, slices_of, unified_numbers
from bladewright.fitting.matching.search import Match, Task, searched
from bladewright.fitting.model_selection.selection import THOROUGH_POINTS, selected_match
from bladewright.fitting.model_selection.structure import (
    FIRST_SECTION,
    Structure,
    reshaped,
    structure_of,
    with_feasible_edges,
)
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.unified import UnifiedSection

DRAWN_POINTS = 600
"""points that a first section is drawn through; it bounds the time (design/matching_constants.md)"""
TURNS: tuple[float, ...] = (0.0, 0.2, -0.2, 0.5, -0.5)
"""directions of the chord that are tried, from the longest distance [rad]: a thick section may lie across it"""
NEAR = 2e-3
"""mean distance, of the chord, with which no other direction is tried (design/matching_constants.md)"""
NOISE, ROUNDS = 0.01, 5
"""noise assumed of a first section, of the chord, and rounds of its search (design/matching_constants.md)"""


def first_section(points: Reals, header: DesignHeader, structure: Structure = FIRST_SECTION) -> UnifiedSection:
    """A section of the unified family near points (n, 2) [m], x axial, y tangential; refused if none can be built."""
    points = without_isolated_points(np.unique(np.asarray(points, dtype=np.float64), axis=0))
    points = points[even_subset(points, DRAWN_POINTS)]
    start, extent = np.array([np.min(points[:, 0]), np.mean(points[:, 1])]), np.ptp(points[:, 0])
    metre, longest = UNITS[header.length_unit], longest_chord(points)
    plane = PlanePoints(points=(points - start) / extent, v=np.zeros(len(points)))
    task = Task(points=points, weights=np.ones(len(points)))
    best: Match | None = None
    refusal: BladewrightError | None = None
    for turn in TURNS:
        if abs(longest + turn) > STEEPEST:
            continue
        slices = slices_of(plane, np.array([longest + turn]), np.zeros(1), 1)
        first = start + extent * slices.camber[0, 0]
        size = float(slices.camber[0, 3, 0] - slices.camber[0, 0, 0])
        try:
            guess = UnifiedSection(
                name=header.name,
                length_unit=header.length_unit,
                pitch=None if header.pitch is None else header.pitch / metre,
                leading_edge_x=float(first[0]) / metre,
                leading_edge_y=float(first[1]) / metre,
                axial_chord=extent * size / metre,
                samples=structure.samples,
                clustering=structure.clustering,
                **unified_numbers(slices, structure.counts, 1.0),
            )
            found = searched(task, with_feasible_edges(guess), noise=NOISE, rounds=ROUNDS)
            found.design.build()
        except BladewrightError as error:
            refusal = error
            continue
        best = found if best is None or found.mean_distance < best.mean_distance else best
        if best.mean_distance < NEAR * best.model.chord:
            break
    if best is None:
        raise FitError(f"no section that can be built was found near the points: {refusal}")
    return best.design  # type: ignore[return-value]


def matched_unified(
    task: Task, start: Design | None, like: Design | None, header: DesignHeader, target: MatchTarget
) -> tuple[Match, str]:
    """The match of points (n, 2) or (n, 3), and why it ends; refused where none is found."""
    wanted = None if like is None else structure_of(like)
    task.progress("first design")
    if start is not None:
        guessed = start if wanted is None else reshaped(start, wanted)
    elif task.dimension == 2:
        guessed = first_section(task.thinned(THOROUGH_POINTS).points, header, wanted or FIRST_SECTION)
    else:
        begun = next(first_blades(task.thinned(THOROUGH_POINTS).points, header.known(like)))
        guessed, task = begun.design, replace(task.turned(begun.turn), outline=begun.walls)
    first = task.free.applied(guessed)
    if start is None and first is not guessed:
        # held values may leave a guess no shape
        first = with_feasible_edges(first)
    check_bounds(first, task.free(first), task.bounds)
    try:
        return selected_match(task, first, target, like=wanted, guessed=start is None)
    except FitError as error:
        if start is not None or not isinstance(guessed, UnifiedBlade):
            raise
        around = "the points go far around x: " if header.blade_count is None and guessed.blade_count == 1 else ""
        raise FitError(f"{error}; {around}{AXES_HINT}") from error
