"""The parameter's domain: pieces of a curve or surface, its continuation, its direction and its scale."""

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from bladewright.errors import GeometryError
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.blossom import knot_change
from bladewright.nurbs.refine import Direction, Shape, changed_along, direction_of, with_coordinates
from bladewright.nurbs.surface import Surface


def extended(shape: Shape, start: float, end: float, direction: Direction = "u") -> Shape:
    """The same curve or surface over [start, end], continued past the old ends by its own end polynomials.

    Its parametrisation stays: extended(c, -0.1, 1.2)(u) is c(u); `reparametrised` can map it to [0, 1] afterwards.
    Where start or end lie inside the old domain it is cut there. A rational one is continued by its quotient of
    polynomials. Raises GeometryError where start is not below end, or a weight of the continuation is not positive.
    """
    knots, degree = direction_of(shape, direction)
    if not (np.isfinite([start, end]).all() and start < end):
        raise GeometryError(f"[{start:g}, {end:g}] was asked for as a domain: the start must lie below the end")
    inner = knots[(knots > max(start, knots[0])) & (knots < min(end, knots[-1]))]
    target = np.concatenate([np.full(degree + 1, start), inner, np.full(degree + 1, end)])
    try:
        return changed_along(shape, direction, knot_change(knots, degree, target), target, degree)
    except GeometryError as error:
        raise GeometryError(
            f"the {type(shape).__name__.lower()} over [{knots[0]:g}, {knots[-1]:g}] cannot be continued to "
            f"[{start:g}, {end:g}]: {error}; extend it less far"
        ) from error


def piece(shape: Shape, start: float, end: float, direction: Direction = "u") -> Shape:
    """The part of a curve or surface over [start, end], with its parameter unchanged.

    Raises GeometryError where [start, end] is not inside the domain.
    """
    knots, _ = direction_of(shape, direction)
    if not knots[0] <= start < end <= knots[-1]:
        raise GeometryError(
            f"the piece over [{start:g}, {end:g}] was asked for: it must lie inside [{knots[0]:g}, {knots[-1]:g}]; "
            "`extended` goes past the ends"
        )
    return extended(shape, start, end, direction)


def split(shape: Shape, at: ArrayLike, direction: Direction = "u") -> tuple[Shape, ...]:
    """The pieces of a curve or surface between parameters `at` (m,), in order, with the parameter unchanged.

    Raises GeometryError where a parameter is not strictly inside the domain.
    """
    knots, _ = direction_of(shape, direction)
    cuts: Reals = np.unique(np.asarray(at, dtype=np.float64))
    if len(cuts) == 0 or not (knots[0] < cuts[0] and cuts[-1] < knots[-1]):
        raise GeometryError(
            f"a split at {cuts.tolist()} was asked for: each cut must lie inside ({knots[0]:g}, {knots[-1]:g})"
        )
    ends = [float(knots[0]), *cuts.tolist(), float(knots[-1])]
    return tuple(piece(shape, a, b, direction) for a, b in pairwise(ends))


def reparametrised(shape: Shape, start: float = 0.0, end: float = 1.0, direction: Direction = "u") -> Shape:
    """The same curve or surface with its parameter mapped linearly to [start, end], start < end, else GeometryError."""
    knots, degree = direction_of(shape, direction)
    if not start < end:
        raise GeometryError(f"[{start:g}, {end:g}] was asked for as a domain: the start must lie below the end")
    fraction = (knots - knots[0]) / (knots[-1] - knots[0])
    mapped = np.where(fraction < 1.0, start + (end - start) * fraction, end)
    return with_coordinates(shape, shape.homogeneous, direction, mapped, degree)


def reversed(shape: Shape, direction: Direction = "u") -> Shape:  # noqa: A001 - the field's word
    """The same curve or surface in the opposite direction over the same domain: u becomes first + last - u."""
    knots, degree = direction_of(shape, direction)
    axis = 0 if direction == "u" else 1
    backwards = (knots[0] + knots[-1] - knots)[::-1]
    backwards[: degree + 1], backwards[-degree - 1 :] = knots[0], knots[-1]
    return with_coordinates(shape, np.flip(shape.homogeneous, axis), direction, backwards, degree)


def swapped(surface: Surface) -> Surface:
    """The same surface with u and v exchanged; its normal points to the other side."""
    weights = surface.weights
    return Surface(
        control_points=np.swapaxes(surface.control_points, 0, 1),
        knots_u=surface.knots_v,
        knots_v=surface.knots_u,
        degree_u=surface.degree_v,
        degree_v=surface.degree_u,
        weights=None if weights is None else weights.T,
    )
