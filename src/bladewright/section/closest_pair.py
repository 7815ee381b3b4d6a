"""The closest pair of points of two closed outlines, such as those of neighbouring blades, at many places at once.

An outline is run through by s in [0, 2), which wraps: the lower side from leading to trailing edge, then the upper side
back. Points are functions of s and the order of the derivative by it, (..., m) to (..., m, d).
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, dot, length
from bladewright.nurbs.basis import Reals

Outline = Callable[[Array, int], Array]
SAMPLES = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 97))) / 2.0
"""Parameters along a side among which the closest pair of points is first looked for, denser towards the edges."""
NEARBY = np.linspace(-1.0, 1.0, 9)
"""Candidates about the closest pair so far, in units of a window that shrinks."""
WINDOW, SHRINKING, WINDOWS = 0.05, 0.4, 14
"""Half width of the first window in s, the factor from one window to the next, and how many there are: the last is
3e-7 wide, from where Newton's method converges."""
ROUNDING = 1e-12
"""Relative rounding of a distance."""
STEPS = 8
"""Newton steps after the last window."""
AT_CORNER = 1e-4
"""Distance in s from a corner, a sharp or a blunt edge, below which a point lies on it: far above the width of the last
window, far below the radius of a round edge."""
Held = tuple[NDArray[np.bool_], NDArray[np.bool_]]
"""whether each point (m,) of the pair is held, as on a corner, where their connection is not normal to the outline"""


def closest_pair(own: Outline, other: Outline, count: int) -> tuple[Reals, Reals, Held]:
    """s (m,) on both real outlines of their closest pair at each of m = `count` places, and which of them are held.

    Raises DesignError where no pair is the closest.
    """
    first, second = _rough(own, other, count)
    for window in WINDOW * SHRINKING ** np.arange(WINDOWS):
        first, second = _closest_of(own, other, first + window * NEARBY[:, None], second + window * NEARBY[:, None])
    least = _distance(own, other, first, second)
    free, every = np.zeros(count, dtype=bool), np.ones(count, dtype=bool)
    corners = [np.square(s - np.round(s)) < AT_CORNER**2 for s in (first, second)]
    on_corners = [np.where(at, np.round(s), s) for s, at in zip((first, second), corners, strict=True)]
    ends, held, missing = (first, second), (free, free), every
    # a double normal; a corner; or, where the outlines run side by side, the pair that was found
    for starts, still in (
        ((first, second), (free, free)),
        (on_corners, corners),
        ((first, second), (every, free)),
    ):
        found = _converged(own, other, starts[0], starts[1], (still[0], still[1]))
        reached = missing & (_distance(own, other, *found) <= (1.0 + ROUNDING) * least)
        ends = np.where(reached, found[0], ends[0]), np.where(reached, found[1], ends[1])
        held = np.where(reached, still[0], held[0]), np.where(reached, still[1], held[1])
        missing = missing & ~reached
        if not missing.any():
            return ends[0], ends[1], held
    raise DesignError(
        f"the throat cannot be located at place {int(np.argmax(missing)) + 1} of {count} along the span: no pair "
        "of points of neighbouring blades is the closest; change the turning or the thickness there a little"
    )


def newton_step(own: Outline, other: Outline, pair: tuple[Array, Array], held: Held) -> tuple[Array, Array]:
    """Newton steps, to be subtracted from s (m,) on both outlines, towards the least distance; none where held."""
    (point, first, bend), (neighbour, second, turn) = (
        [outline(s, order) for order in range(3)] for outline, s in zip((own, other), pair, strict=True)
    )
    across = neighbour - point
    slope = np.where(held[0], 0.0, -dot(across, first)), np.where(held[1], 0.0, dot(across, second))
    bend_own = dot(first, first) - dot(across, bend)
    bend_other = dot(second, second) + dot(across, turn)
    mixed = np.where(held[0] | held[1], 0.0, -dot(first, second))
    whole = bend_own * bend_other - mixed * mixed
    return (bend_other * slope[0] - mixed * slope[1]) / whole, (bend_own * slope[1] - mixed * slope[0]) / whole


def _converged(own: Outline, other: Outline, first: Reals, second: Reals, held: Held) -> tuple[Reals, Reals]:
    """The closest pair's s (m,) by Newton's method; where it does not converge, anything."""
    with np.errstate(all="ignore"):
        for _ in range(STEPS):
            steps = newton_step(own, other, (first, second), held)
            first, second = (
                s - np.clip(np.nan_to_num(step), -0.5, 0.5) for s, step in zip((first, second), steps, strict=True)
            )
    return first, second


def _distance(own: Outline, other: Outline, first: Reals, second: Reals) -> Reals:
    return np.asarray(length(other(second, 0) - own(first, 0)))


def _rough(own: Outline, other: Outline, count: int) -> tuple[Reals, Reals]:
    """The closest pair's s (m,) among samples of the outlines."""
    s = np.concatenate([SAMPLES, 2.0 - SAMPLES[-2:0:-1]])
    along = np.broadcast_to(s[:, None], (len(s), count))
    return _closest_of(own, other, along, along)


def _closest_of(own: Outline, other: Outline, first: Reals, second: Reals) -> tuple[Reals, Reals]:
    """The closest pair's s (m,) among candidates (k, m) on both outlines."""
    starts, stops = own(first, 0), other(second, 0)
    found = np.empty((2, first.shape[1]))
    for place in range(first.shape[1]):
        gaps = cdist(starts[:, place], stops[:, place], "sqeuclidean")
        i, j = np.unravel_index(int(np.argmin(gaps)), gaps.shape)
        found[:, place] = first[i, place], second[j, place]
    return found[0], found[1]
