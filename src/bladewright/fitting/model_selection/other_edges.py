"""Further starts of a section whose search may have ended with a nose that has slid along the outline."""

from collections.abc import Iterator

from bladewright.errors import DesignError, FitError
from bladewright.fitting.matching.search import Match, Task, searched
from bladewright.fitting.model_selection.reshaping import with_feasible_edges
from bladewright.section.unified_limits import ANGLES, RADII, TANGENTS

USUAL_TANGENT, USUAL_RADIUS = 0.3, 0.01
"""tangent proportions and edge radii of further starts: two of three sections drawn at random that had ended in other
minima are met from one of these (design/matching.md)."""


def from_other_edges(task: Task, match: Match, noise: float) -> Iterator[Match]:
    """Matches from sections whose edges lie elsewhere on the outline: a nose slid along it is a minimum of its own.

    `noise` is the first round's, of the chord.
    """
    known = match.design.parameters()
    usual = {**dict.fromkeys(TANGENTS, USUAL_TANGENT), **dict.fromkeys(RADII, USUAL_RADIUS)}
    straight = usual | {name: known.get("stagger", 0.0) for name in ANGLES}
    for values in (usual, straight):
        changes = {path: value for path, value in values.items() if path in match.problem.paths}
        if not changes:
            continue
        try:
            yield searched(task, with_feasible_edges(match.design.changed(changes)), noise=noise)
        except (DesignError, FitError):
            continue
