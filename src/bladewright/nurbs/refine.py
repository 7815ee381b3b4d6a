"""Knot insertion and degree elevation: more control points, the same shape."""

import numpy as np
from numpy.typing import ArrayLike

from bladewright.errors import GeometryError
from bladewright.nurbs.along import Direction, Shape, changed_along, direction_of
from bladewright.nurbs.basis import multiplicities
from bladewright.nurbs.blossom import elevation, knot_change


def inserted(shape: Shape, knots: ArrayLike, direction: Direction = "u") -> Shape:
    """The same curve or surface with further knots (m,), each repeated as often as it is to be inserted.

    Raises GeometryError where a knot lies outside the open domain or would occur more than `degree` times.
    """
    old, degree = direction_of(shape, direction)
    new = np.atleast_1d(np.asarray(knots, dtype=np.float64))
    if not ((new > old[0]) & (new < old[-1])).all():
        raise GeometryError(
            f"knots {new.tolist()} were to be inserted: each must lie inside ({old[0]:g}, {old[-1]:g}); "
            "`extended` goes past the ends"
        )
    target = np.sort(np.concatenate([old, new]))
    values, repeats = multiplicities(target[degree + 1 : -degree - 1])
    if len(repeats) and repeats.max() > degree:
        raise GeometryError(
            f"knot {values[repeats.argmax()]:g} would occur {repeats.max()} times: at most {degree}; "
            "insert it less often or elevate the degree"
        )
    return changed_along(shape, direction, knot_change(old, degree, target), target, degree)


def elevated(shape: Shape, times: int = 1, direction: Direction = "u") -> Shape:
    """The same curve or surface with its degree raised `times` times; every knot occurs as much more often.

    Raises GeometryError where `times` is negative.
    """
    if times < 0:
        raise GeometryError(
            f"a degree was to be raised {times} times: it cannot be lowered exactly; `approximated` comes near"
        )
    for _ in range(times):
        old, degree = direction_of(shape, direction)
        knots, matrix = elevation(old, degree)
        shape = changed_along(shape, direction, matrix, knots, degree + 1)
    return shape
