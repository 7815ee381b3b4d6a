"""Knot insertion and degree elevation along one direction: more control points, the same shape."""

from typing import Literal, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from bladewright.errors import GeometryError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals, multiplicities
from bladewright.nurbs.blossom import elevation, knot_change
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.rational import projected
from bladewright.nurbs.surface import Surface

Direction = Literal["u", "v"]
Shape = TypeVar("Shape", Curve, Surface)


def direction_of(shape: Curve | Surface, direction: Direction) -> tuple[Reals, int]:
    """Knots and degree along u or v; a curve has only u. Raises GeometryError for any other direction."""
    if isinstance(shape, Surface) and direction in ("u", "v"):
        return (shape.knots_u, shape.degree_u) if direction == "u" else (shape.knots_v, shape.degree_v)
    if isinstance(shape, Curve) and direction == "u":
        return shape.knots, shape.degree
    raise GeometryError(
        f"direction {direction!r} was asked of a {type(shape).__name__}: a surface has u and v, a curve u"
    )


def changed_along(shape: Shape, direction: Direction, matrix: Reals, knots: Reals, degree: int) -> Shape:
    """The shape whose homogeneous control points are `matrix` (n_new, n) times the old ones along u or v."""
    axis = 0 if direction == "u" else 1
    coordinates = np.moveaxis(np.tensordot(matrix, shape.homogeneous, axes=(1, axis)), 0, axis)
    return with_coordinates(shape, coordinates, direction, knots, degree)


def with_coordinates(shape: Shape, coordinates: Array, direction: Direction, knots: Reals, degree: int) -> Shape:
    """The shape with other homogeneous control points, and other knots and degree along u or v."""
    points, weights = projected(coordinates, rational=shape.weights is not None)
    if isinstance(shape, Curve):
        return Curve(control_points=points, knots=knots, degree=degree, weights=weights)
    return Surface(
        control_points=points,
        knots_u=knots if direction == "u" else shape.knots_u,
        knots_v=knots if direction == "v" else shape.knots_v,
        degree_u=degree if direction == "u" else shape.degree_u,
        degree_v=degree if direction == "v" else shape.degree_v,
        weights=weights,
    )


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
    """The same curve or surface with its degree raised by `times`, and so the multiplicity of every knot.

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
