"""Control points of a spline on other knots, by the blossom (polar form) of its polynomial pieces."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bladewright.nurbs.basis import Reals, multiplicities, spans

NARROW = 1e-3
"""Length of a knot span, of the longest one beside it, below which its polynomial is not continued to the others: five
times across one a thousandth as long loses four digits."""


def blossom_matrix(knots: Reals, degree: int, span: NDArray[np.intp], arguments: Reals) -> Reals:
    """Rows (m, n) that map control points to values of the blossom of the piece over knots[span], knots[span + 1].

    `arguments` (m, degree) are those of the blossom: where all equal u, its value is the point at u; where they are
    `degree` consecutive knots, it is a control point. De Boor's algorithm with a new argument at each level (Ramshaw
    1989, section 6).
    """
    rows, count = len(span), len(knots) - degree - 1
    local = np.broadcast_to(np.eye(degree + 1), (rows, degree + 1, degree + 1)).copy()
    for level in range(1, degree + 1):
        for j in range(degree, level - 1, -1):
            left, right = knots[span - degree + j], knots[span + j + 1 - level]
            fraction = ((arguments[:, level - 1] - left) / (right - left))[:, None]
            local[:, j] = (1.0 - fraction) * local[:, j - 1] + fraction * local[:, j]
    matrix = np.zeros((rows, count))
    columns = span[:, None] - degree + np.arange(degree + 1)
    matrix[np.arange(rows)[:, None], columns] = local[:, degree]
    matrix.setflags(write=False)
    return matrix


def knot_change(knots: Reals, degree: int, target: Reals) -> Reals:
    """Matrix (n_target, n) from control points on `knots` to those of the same spline on `target`, of the same degree.

    The target's inner knots include those of the source within the target's range, at least as often; past the
    source's ends the end polynomials are continued. Each target control point is the blossom, at its own knots, of the
    piece in the middle of its support, so that knot insertion only takes convex combinations (Goldman and Lyche 1993,
    chapter 1).
    """
    return _knot_change(knots.tobytes(), degree, target.tobytes())


@lru_cache(maxsize=128)
def _knot_change(knots: bytes, degree: int, target: bytes) -> Reals:
    on = np.frombuffer(target)
    return _blossoms(np.frombuffer(knots), degree, on, degree, _windows(on, degree))


def elevation(knots: Reals, degree: int) -> tuple[Reals, Reals]:
    """The knots on which the same splines have degree + 1, and the matrix (n_target, n) to their control points.

    A control point of the higher degree is the mean of the blossoms that each leave out one of its knots (Ramshaw 1989,
    section 8).
    """
    values, repeats = multiplicities(knots)
    target = np.repeat(values, repeats + 1)
    windows = _windows(target, degree + 1)
    matrices = [_blossoms(knots, degree, target, degree + 1, np.delete(windows, j, axis=1)) for j in range(degree + 1)]
    return target, np.mean(matrices, axis=0)


def _windows(knots: Reals, degree: int) -> Reals:
    """The `degree` consecutive knots (n, degree) whose blossom is each control point."""
    return np.lib.stride_tricks.sliding_window_view(knots[1:-1], degree)


def _blossoms(knots: Reals, degree: int, target: Reals, target_degree: int, arguments: Reals) -> Reals:
    """Rows to the blossoms at `arguments`, of the piece in the middle of each target control point's support.

    Or of the longest one there, where the one in the middle is beside it so short that rounding would grow.
    """
    starts = np.flatnonzero(np.diff(target) > 0.0)
    first = np.arange(len(arguments))
    low, high = np.searchsorted(starts, first), np.searchsorted(starts, first + target_degree, side="right") - 1
    lengths = np.diff(target)[starts]
    middle, all_there = (low + high) // 2, np.minimum(low[:, None] + np.arange(target_degree + 1), high[:, None])
    longest = all_there[first, np.argmax(lengths[all_there], axis=1)]
    start = starts[np.where(lengths[middle] < NARROW * lengths[longest], longest, middle)]
    return blossom_matrix(knots, degree, spans(knots, degree, 0.5 * (target[start] + target[start + 1])), arguments)
