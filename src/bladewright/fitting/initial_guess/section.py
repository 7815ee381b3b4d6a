"""A first section from points in the plane."""

import numpy as np

from bladewright.blade.design.row_design import LengthUnit
from bladewright.errors import BladewrightError, FitError
from bladewright.fitting.clouds.thinning import even_subset, without_isolated_points
from bladewright.fitting.initial_guess.slices import STEEPEST, PlanePoints, longest_chord, slices_of, unified_numbers
from bladewright.fitting.matching.search import Match, Task, searched
from bladewright.fitting.model_selection.structure import FIRST_SECTION, Structure, with_feasible_edges
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


def first_section(
    points: Reals,
    *,
    structure: Structure = FIRST_SECTION,
    name: str = "blade",
    length_unit: LengthUnit = "mm",
    pitch: float | None = None,
) -> UnifiedSection:
    """A section of the unified family near points (n, 2) [m], x axial and y tangential, found from them alone.

    The `pitch` [m], which they do not show, is stated in it. Raises FitError where no section that can be built lies
    near the points.
    """
    points = without_isolated_points(np.unique(np.asarray(points, dtype=np.float64), axis=0))
    points = points[even_subset(points, DRAWN_POINTS)]
    start, extent = np.array([np.min(points[:, 0]), np.mean(points[:, 1])]), np.ptp(points[:, 0])
    metre, longest = UNITS[length_unit], longest_chord(points)
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
                name=name,
                length_unit=length_unit,
                pitch=None if pitch is None else pitch / metre,
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
