"""What designs with more control points are foreseen to leave of a match's misfit, without a search."""

from collections.abc import Iterable

import numpy as np

from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.feet import placed
from bladewright.fitting.problem import State
from bladewright.fitting.scales import scales_of
from bladewright.fitting.search import Found, Task
from bladewright.nurbs.basis import Reals


def promising(task: Task, found: Found, designs: Iterable[Design], roots: Reals | None = None) -> list[Design]:
    """Designs that have more control points than a match's, best gain for each parameter first.

    `roots` (n,) are square roots of further weights of the points. Designs without a shape, or that gain nothing, are
    left out.
    """
    count = len(found.problem.paths)
    before = left(found, found.design, found.problem.paths, roots)
    ranked: list[tuple[float, int, Design]] = []
    for design in designs:
        try:
            paths = task.free(design)
            gain = before - left(found, design, paths, roots)
        except (DesignError, FitError):
            continue
        if gain > 0.0 and len(paths) > count:
            ranked.append((gain / (len(paths) - count), len(ranked), design))
    return [design for _, _, design in sorted(ranked, key=lambda each: (-each[0], each[1]))]


def left(found: Found, design: Design, paths: tuple[str, ...], roots: Reals | None = None) -> float:
    """The sum of squares that a design near a match leaves after the linear step that makes it least.

    Parameters are held by the prior's spread. Raises DesignError where the design has no shape.
    """
    measures, on = found.problem.measures, found.state.feet
    shape = measures.model.shape(design)
    if not shape.finite:
        raise DesignError("a law with another number of control points left no shape: take another one")
    state = State(shape=shape, feet=placed(measures.points, shape.sides, on.side, on.u, on.v))
    rows = measures.residuals(state)
    slopes = measures.slopes(state, paths) * scales_of(design, paths, found.model.chord).size
    whole = np.column_stack([slopes, rows])
    if roots is not None:
        whole[: len(roots)] *= roots[:, None]
    held = found.problem.noise * np.eye(len(paths), len(paths) + 1)
    # the last diagonal entry is what no step takes away
    return float(np.asarray(np.linalg.qr(np.concatenate([whole, held]), mode="r"))[-1, -1] ** 2)
