"""Where a section is thickest: the widest double normal between its sides, found in real numbers, then carried."""

from collections.abc import Callable

import numpy as np

from bladewright.numerics.elementary import Array
from bladewright.section.double_normal import Motion, distance, newton_step

SAMPLES = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 129))) / 2.0
"""Parameters of both sides among which the thickest place is first looked for: points of equal ones lie across the
camber line from each other, nearly."""
PLATEAU = 1e-9
"""Share by which thicknesses differ that count as equal: of a plate the middle is taken."""
STEPS = 12
"""Newton steps from the thickest sample, which converge quadratically."""
NEAR = 0.08
"""Largest change of a parameter by these steps: beyond, there is no double normal at the thickest sample, as on a
wedge, which is thickest at its end."""
CONVERGED = 1e-9
"""Last step of a parameter by which Newton's method has converged: its square is below rounding."""


def thickest(motion: Callable[[int, Array], Motion], end: float = 1.0) -> tuple[Motion, Motion]:
    """The points (m,) of the upper and the lower side between which sections are thickest.

    `motion` gives points of the upper (0) or lower (1) side at parameters (m,) or (k, 1), which may be complex; the
    sides count up to `end`, where a back face begins. Where the thickest place is no double normal, as at the end of a
    wedge, its parameters are held.
    """
    samples = SAMPLES * end
    across = distance(*(_real(motion(side, samples[:, None])) for side in (0, 1)))
    equal = across >= np.max(across, axis=0) * (1.0 - PLATEAU)
    middle = [np.flatnonzero(each)[np.sum(each) // 2] for each in equal.T]
    start = samples[middle]
    u: list[Array] = [start, start]
    steps: tuple[Array, Array] = u[0], u[1]
    for _ in range(STEPS):
        steps = newton_step(*(_real(motion(side, u[side])) for side in (0, 1)))
        u = [np.clip(np.nan_to_num(each - step), 0.0, end) for each, step in zip(u, steps, strict=True)]
    found = np.all([np.square(each - start) < NEAR**2 for each in u], axis=0)
    found &= np.all([np.square(step) < CONVERGED**2 for step in steps], axis=0)
    u = [np.where(found, each, start) for each in u]
    ends = [motion(side, u[side]) for side in (0, 1)]
    if any(np.iscomplexobj(part) for point in ends for part in point[:4]):
        steps = newton_step(ends[0], ends[1])
        u = [np.where(found, each - step, each) for each, step in zip(u, steps, strict=True)]
        ends = [motion(side, u[side]) for side in (0, 1)]
    return ends[0], ends[1]


def _real(motion: Motion) -> Motion:
    x, height, across, radius = (np.real(each) for each in motion[:4])
    return Motion(x, height, across, radius, motion.period)
