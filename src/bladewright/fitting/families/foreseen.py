"""What designs with more control points are foreseen to leave of a match's misfit, without a search."""

from collections.abc import Iterable

import numpy as np

from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.matching.feet import placed
from bladewright.fitting.matching.problem import State
from bladewright.fitting.matching.scales import scales_of
from bladewright.fitting.matching.search import Found, Task
from bladewright.fitting.structures.growth import left_after, roots_of
from bladewright.nurbs.basis import Reals

Promise = tuple[float, int, Design]
"""gain for each parameter, number of parameters more, and the design"""


def promised(task: Task, found: Found, designs: Iterable[Design], emphasis: Reals | None = None) -> list[Promise]:
    """Designs that have more control points than a match's, best gain for each parameter first.

    `emphasis` (n,) are further weights of the points. Designs without a shape, or that gain nothing, are left out.
    """
    measures, paths = found.problem.measures, found.problem.paths
    values = found.design.parameters()
    rows = measures.residuals(found.state)
    slopes = measures.slopes(found.state, paths) * found.problem.scales.size
    roots = roots_of(emphasis, len(rows))
    before = left_after(slopes, rows, roots, found.problem.noise)
    ranked: list[Promise] = []
    for design in designs:
        try:
            free = task.free(design)
            fresh = design.parameters()
            own = tuple(path for path in free if values.get(path) != fresh[path])
            kept = [i for i, path in enumerate(paths) if path in fresh and path not in own]
            rows, columns = _at(found, design, own)
        except (DesignError, FitError):
            continue
        wider = np.concatenate([slopes[:, kept], columns], axis=1)
        gain = before - left_after(wider, rows, roots, found.problem.noise)
        more = len(free) - len(paths)
        if gain > 0.0 and more > 0:
            ranked.append((gain / more, more, design))
    return sorted(ranked, key=lambda each: -each[0])


def _at(found: Found, design: Design, paths: tuple[str, ...]) -> tuple[Reals, Reals]:
    """Residuals of a design where the cloud stands on a match's, and their derivatives by scaled parameters."""
    measures, on = found.problem.measures, found.state.feet
    shape = measures.model.shape(design)
    if not shape.finite:
        raise DesignError("a law with another number of control points left no shape: take another one")
    state = State(shape=shape, feet=placed(measures.points, shape.sides, on.side, on.u, on.v))
    slopes = measures.slopes(state, paths) * scales_of(design, paths, found.model.chord).size
    return measures.residuals(state), slopes
