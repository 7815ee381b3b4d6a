"""One direction of a curve or surface: its knots and degree, and a linear change of the control points along it."""

from typing import Literal, TypeVar

import numpy as np

from bladewright.errors import GeometryError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.rational import projected
from bladewright.nurbs.surface import Surface

Direction = Literal["u", "v"]
Shape = TypeVar("Shape", Curve, Surface)


def direction_of(shape: Curve | Surface, direction: Direction) -> tuple[Reals, int]:
    """Knots and degree along u or v; a curve has only u. Raises GeometryError for another direction."""
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
