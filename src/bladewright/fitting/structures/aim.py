"""What is asked of a match, and whether it has it."""

from dataclasses import dataclass

from bladewright.fitting.matching.search import Found, Task

LEAST = {2: 5e-7, 3: 5e-5}
"""largest deviation at which nothing more is added where no aim is stated, of the chord, by dimension"""
MOST = {2: 80, 3: 340}
"""parameters above which nothing is added"""
NOISY = 0.15
"""part of the misfit that neighbours share below which it is noise"""
POINTS = {2: 2, 3: 3}
"""points for each parameter at least, by dimension: published profiles have few and exact ones"""


@dataclass(frozen=True, kw_only=True)
class Aim:
    """What is asked of a match."""

    tolerance: float | None = None
    """largest distance of an inlier [m]"""
    parameters: int | None = None
    structured: bool = False
    """whether the structure is given"""
    moved: bool = False
    """whether the axes were found first, by a start that need not be the blade"""

    @property
    def open(self) -> bool:
        """Whether nothing is asked for."""
        return self.tolerance is None and self.parameters is None and not self.structured


def short_of(found: Found, aim: Aim, task: Task) -> tuple[bool, str]:
    """Whether more control points are wanted, and if not though the aim is not met, why."""
    count = len(found.problem.paths)
    dimension = task.points.shape[1]
    if aim.parameters is not None:
        return count < aim.parameters, ""
    limit = aim.tolerance if aim.tolerance is not None else LEAST[dimension] * found.model.chord
    if found.maximum <= limit:
        return False, ""
    noise = found.scatter.noise
    if found.scatter.shared < NOISY:
        return (
            False,
            f"what is left is the cloud's own noise, {1e3 * noise:.2g} mm: more control points would follow it",
        )
    if count >= min(MOST[dimension], len(task.points) // POINTS[dimension]):
        return False, f"the design has {count} parameters, and more are not added"
    return True, ""
