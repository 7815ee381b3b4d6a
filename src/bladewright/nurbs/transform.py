"""Affine maps of curves, surfaces and trimmed surfaces: they move control points and leave knots and weights."""

from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from bladewright.errors import GeometryError
from bladewright.numerics.elementary import unit
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

Mapped = TypeVar("Mapped", Curve, Surface, TrimmedSurface)


def transformed(shape: Mapped, matrix: ArrayLike, offset: ArrayLike = 0.0) -> Mapped:
    """The shape of the points `matrix` (d_new, d) x + `offset` (d_new,); both may be complex.

    A matrix with a negative determinant turns the normals of a surface to its other side. Raises GeometryError where
    the matrix does not fit the dimension.
    """
    if isinstance(shape, TrimmedSurface):
        # it need not be a surface of revolution about the machine axis any more
        return replace(shape, surface=transformed(shape.surface, matrix, offset), revolution=None)
    linear, points = np.asarray(matrix), shape.control_points
    if linear.ndim != 2 or linear.shape[1] != points.shape[-1]:
        raise GeometryError(
            f"a matrix of shape {linear.shape} was to map control points of shape {points.shape}: "
            f"it must be (d_new, {points.shape[-1]})"
        )
    return replace(shape, control_points=points @ linear.T + np.asarray(offset))


def translated(shape: Mapped, offset: ArrayLike) -> Mapped:
    """The shape moved by `offset` (d,)."""
    return transformed(shape, np.eye(len(np.asarray(offset))), offset)


def scaled(shape: Mapped, factor: complex, centre: ArrayLike) -> Mapped:
    """The shape enlarged about a fixed point (d,); a negative factor reflects in it."""
    fixed = np.asarray(centre)
    return transformed(shape, factor * np.eye(len(fixed)), (1.0 - factor) * fixed)


def rotated(
    shape: Mapped, angle: complex, *, origin: ArrayLike = (0.0, 0.0, 0.0), axis: ArrayLike = (1.0, 0.0, 0.0)
) -> Mapped:
    """The shape in space turned right-handed by `angle` [rad] about an axis (3,) through `origin` (Rodrigues 1840)."""
    direction = unit(np.asarray(axis, dtype=np.result_type(np.asarray(axis), np.float64)))
    cross = np.cross(np.eye(3), direction)
    matrix = np.cos(angle) * np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * np.outer(direction, direction)
    fixed = np.asarray(origin)
    return transformed(shape, matrix, fixed - matrix @ fixed)


def mirrored(shape: Mapped, *, origin: ArrayLike, normal: ArrayLike) -> Mapped:
    """The shape reflected in the plane (or line) through `origin` (d,) with a normal (d,); surface normals flip."""
    direction = unit(np.asarray(normal, dtype=np.result_type(np.asarray(normal), np.float64)))
    matrix = np.eye(len(direction)) - 2.0 * np.outer(direction, direction)
    fixed = np.asarray(origin)
    return transformed(shape, matrix, fixed - matrix @ fixed)
