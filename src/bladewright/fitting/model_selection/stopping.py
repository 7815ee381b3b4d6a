"""What is asked of a match, and when no more control points are added."""

from dataclasses import dataclass

from bladewright.fitting.matching.search import Match, Task

ENOUGH_DEVIATION = {2: 5e-7, 3: 5e-5}
"""largest deviation at which nothing is added where no target is stated, of the chord, by dimension."""
MOST_PARAMETERS = {2: 80, 3: 340}
"""parameters above which nothing is added, by dimension; it bounds the time."""
NOISE_CORRELATION = 0.15
"""share of the misfit that neighbours have in common below which the misfit is noise."""
POINTS_PER_PARAMETER = {2: 2, 3: 3}
"""points for each parameter at least, by dimension: published profiles have few points, and exact ones."""


@dataclass(frozen=True, kw_only=True)
class MatchTarget:
    """What is asked of a match."""

    tolerance: float | None = None
    """largest distance of an inlier [m]"""
    parameters: int | None = None
    structured: bool = False
    """whether the structure is given"""
    registered: bool = False
    """whether the axes were found first, from a start that need not be this blade"""

    @property
    def open(self) -> bool:
        """Whether nothing is asked for."""
        return self.tolerance is None and self.parameters is None and not self.structured


def needs_more(match: Match, target: MatchTarget, task: Task) -> tuple[bool, str]:
    """Whether more control points are wanted; if not and the target is not met, why."""
    count = len(match.problem.paths)
    dimension = task.dimension
    if target.parameters is not None:
        return count < target.parameters, ""
    limit = target.tolerance if target.tolerance is not None else ENOUGH_DEVIATION[dimension] * match.model.chord
    if match.maximum <= limit:
        return False, ""
    noise = match.noise_estimate.noise
    if match.noise_estimate.correlation < NOISE_CORRELATION:
        return (
            False,
            f"what is left is the cloud's own noise, {1e3 * noise:.2g} mm: more control points would follow it",
        )
    if count >= min(MOST_PARAMETERS[dimension], len(task.points) // POINTS_PER_PARAMETER[dimension]):
        return False, f"the design has {count} parameters, and more are not added"
    return True, ""
