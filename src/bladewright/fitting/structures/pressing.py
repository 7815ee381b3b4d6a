"""Growth whose gain is not foreseen: a section that is far is tried with more, a match that is near with no more."""

from dataclasses import replace

from bladewright.errors import FitError
from bladewright.fitting.matching.search import ROUGH, Found, Task, searched
from bladewright.fitting.structures.aim import Aim
from bladewright.fitting.structures.growth import joined, steps_from
from bladewright.fitting.structures.opening import opened
from bladewright.fitting.structures.reshaping import reshaped
from bladewright.fitting.structures.structure import structure_of
from bladewright.section.limits import THICKNESSES

FAR = 5e-5
"""root mean square distance, of the chord, above which a section is tried with more"""
TIMES = 3
"""times that both thicknesses grow before it is given up"""
NEARER = 0.9
"""ratio of the distances from which a try is taken"""
ENOUGH = {2: FAR, 3: 1e-3}
"""root mean square distance, of the chord, below which a section, or a blade, is near enough"""
LITTLE = {2: 0.75, 3: 0.9}
"""ratio of the distances above which one that is near enough grows no more"""


def pressed(task: Task, found: Found, aim: Aim) -> tuple[Found, bool]:
    """A section with more control points of both thicknesses, and whether it is nearer.

    Where thicknesses stand on their bounds, as at a sharp edge, what growth gains cannot be foreseen linearly: the
    step that is foreseen for the fewer ones leads out of the bounds.
    """
    structure = structure_of(found.design) if task.points.shape[1] == 2 else None
    if structure is None or not aim.open or found.rms < FAR:
        return found, False
    evaluations = found.evaluations
    for _ in range(TIMES):
        steps = [step for step in steps_from(structure) if set(step.fields) <= set(THICKNESSES)]
        if not steps or not any(path.startswith(THICKNESSES) for path in found.problem.paths):
            break
        structure = joined(structure, steps)
        try:
            fresh = searched(task, opened(reshaped(found.design, structure)), rounds=2, noise=found.rms, slight=ROUGH)
        except FitError:
            break
        evaluations += fresh.evaluations
        if fresh.interrupted or fresh.rms < NEARER * found.rms:
            return replace(fresh, evaluations=evaluations), True
    return replace(found, evaluations=evaluations), False


def little(task: Task, found: Found, aim: Aim, before: float) -> bool:
    """Whether a match is near enough, and growth from a distance `before`, of the chord, brought it little nearer."""
    dimension = task.points.shape[1]
    return aim.open and LITTLE[dimension] * before < found.rms < ENOUGH[dimension]
