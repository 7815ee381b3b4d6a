"""Clamped knot vectors and the B-spline basis functions on them."""

from collections.abc import Iterable
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BSpline

from bladewright.errors import GeometryError
from bladewright.numerics.elementary import Reals as Reals  # noqa: PLC0414 - exported for the rooms above

MAX_CACHED = 400
"""Parameters up to which a matrix of basis functions is cached. Builds at held knots ask for the same matrices again,
and larger ones would fill the memory. A build of Rotor 67 gains less than can be measured beside other work
(design/nurbs_constants.md)."""
JOINT_TOLERANCE = 1e-9
"""Distance from a joint, in units of the knots' range, below which a knot is moved onto the joint: joints are computed,
and a knot so near is the same one but for rounding."""


@lru_cache(maxsize=256)
def uniform_knots(count: int, degree: int) -> Reals:
    """Clamped uniform knots (count + degree + 1,) over [0, 1] for `count` control points, read-only.

    Raises GeometryError where there are fewer control points than degree + 1.
    """
    if count < degree + 1:
        raise GeometryError(
            f"{count} control points were asked to carry degree {degree}: at least {degree + 1} are needed; "
            "lower the degree or give more control points"
        )
    inner = np.linspace(0.0, 1.0, count - degree + 1)
    knots = np.concatenate([np.zeros(degree), inner, np.ones(degree)])
    knots.setflags(write=False)
    return knots


def greville(knots: Reals, degree: int) -> Reals:
    """Greville abscissae (n,): the means of `degree` consecutive knots, one for each control point.

    At ends of full multiplicity they are the ends, to the bit.
    """
    count = len(knots) - degree - 1
    found = np.zeros(count)
    for first in range(1, degree + 1):
        found += knots[first : first + count]
    found /= degree
    # the mean of equal numbers may be another one by rounding
    for end, few in ((0, knots[1 : degree + 1]), (-1, knots[-degree - 1 : -1])):
        found[end] = min(max(found[end], few[0]), few[-1])
    return found


def breaks(knots: Reals) -> Reals:
    """The distinct knots (k + 1,), between which lie the k knot spans; each span carries one polynomial."""
    return np.unique(knots)


def multiplicities(knots: Reals) -> tuple[Reals, NDArray[np.intp]]:
    """The distinct knots and how often each occurs."""
    return np.unique(knots, return_counts=True)


def corners(knots: Reals, degree: int) -> Reals:
    """Parameters (m,) at which a spline may have a corner: its ends, and knots as many times there as its degree."""
    places, counts = multiplicities(knots)
    return places[counts >= degree]


def spans(knots: Reals, degree: int, u: ArrayLike) -> NDArray[np.intp]:
    """Indices j (...) of the spans knots[j] <= u < knots[j + 1]; parameters past an end belong to the end's span."""
    found = np.searchsorted(knots, np.asarray(u, dtype=np.float64), side="right") - 1
    return np.clip(found, degree, len(knots) - degree - 2)


def basis(knots: Reals, degree: int, u: ArrayLike, order: int = 0) -> Reals:
    """Dense matrix (len(u), n) of all basis functions' `order`-th derivatives at real parameters u (m,), read-only.

    Outside the knots' range the end polynomials are continued. Matrices of up to MAX_CACHED parameters are cached.
    """
    at, on = np.asarray(u, dtype=np.float64), np.asarray(knots, dtype=np.float64)
    if at.ndim == 1 and len(at) <= MAX_CACHED:
        return _cached_matrix(on.tobytes(), degree, at.tobytes(), order)
    return _matrix(on, degree, at, order)


@lru_cache(maxsize=128)
def _cached_matrix(knots: bytes, degree: int, u: bytes, order: int) -> Reals:
    return _matrix(np.frombuffer(knots), degree, np.frombuffer(u), order)


def _matrix(knots: Reals, degree: int, u: Reals, order: int) -> Reals:
    matrix: Reals = _functions(knots.tobytes(), degree)(u, nu=order)
    matrix.setflags(write=False)
    return matrix


@lru_cache(maxsize=64)
def _functions(knots: bytes, degree: int) -> BSpline:
    """All basis functions as one spline: to make one takes longer than to evaluate it at a few parameters."""
    on = np.frombuffer(knots)
    return BSpline(on, np.eye(len(on) - degree - 1), degree)


def checked_knots(knots: ArrayLike, degree: int, count: int, name: str) -> Reals:
    """The knots (count + degree + 1,) as a read-only array, when they can carry `count` control points.

    Raises GeometryError where they are complex, not finite, decreasing, of the wrong number, not clamped, or where an
    inner knot is repeated more than `degree` times.
    """
    if np.iscomplexobj(knots):
        raise GeometryError(f"{name} are complex: knots must be real; hold them fixed while differentiating")
    values = np.asarray(knots, dtype=np.float64)
    return _checked(values.tobytes(), values.shape, degree, count, name)


@lru_cache(maxsize=128)
def _checked(knots: bytes, shape: tuple[int, ...], degree: int, count: int, name: str) -> Reals:
    """The same, for knots that many shapes have."""
    values = np.frombuffer(knots).reshape(shape)
    if degree < 1:
        raise GeometryError(f"degree {degree} was asked for with {name}: it must be at least 1")
    if count < degree + 1:
        raise GeometryError(
            f"{count} control points were given with {name} of degree {degree}: at least {degree + 1} are needed; "
            "lower the degree or give more control points"
        )
    if values.shape != (count + degree + 1,):
        raise GeometryError(
            f"{name} has shape {values.shape}: {count} control points of degree {degree} need ({count + degree + 1},)"
        )
    if not np.isfinite(values).all() or (np.diff(values) < 0.0).any():
        raise GeometryError(f"{name} must be finite and non-decreasing, got {values.tolist()}; sort them")
    if values[0] != values[degree] or values[-1] != values[-degree - 1] or values[0] >= values[-1]:
        raise GeometryError(
            f"{name} = {values.tolist()} are not clamped: the first and the last knot must each occur "
            f"{degree + 1} times"
        )
    inner = values[degree + 1 : count]
    too_often = bool(np.any(inner[degree:] == inner[:-degree])) if len(inner) > degree else False
    if len(inner) and (too_often or inner[0] == values[0] or inner[-1] == values[-1]):
        raise GeometryError(
            f"{name} = {values.tolist()} repeat a knot too often: at most {degree} times inside, "
            f"{degree + 1} times at the ends"
        )
    return values


def knots_with_joints(knots: Reals, degree: int, joints: Iterable[tuple[float, int]]) -> Reals:
    """Knots with the multiplicity that joints need: parameters inside, each with its number of continuous derivatives.

    A curve of `degree` on these knots can follow one whose next derivative jumps at each joint.
    """
    start, end = knots[0], knots[-1]
    near = JOINT_TOLERANCE * (end - start)
    for place, smooth in joints:
        if not start + near < place < end - near:
            continue
        at_joint = np.square(knots - place) < near**2
        times = max(int(np.sum(at_joint)), degree - smooth)
        knots = np.sort(np.concatenate([knots[~at_joint], np.full(min(times, degree), place)]))
    return knots
