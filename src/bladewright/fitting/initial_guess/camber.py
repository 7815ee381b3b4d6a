"""A first camber: the middle between the two sides in a frame along the chord, and which points are on which side."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from bladewright.fitting.initial_guess.restraints import LONGEST_TANGENT, SHORTEST_TANGENT, STEEPEST_ANGLE
from bladewright.fitting.initial_guess.section_shape import (
    ANGLE_IN,
    ANGLE_OUT,
    EXTENT,
    PLACE,
    ROOT_IN,
    ROOT_OUT,
    STAGGER,
    START,
    TANGENT_IN,
    TANGENT_OUT,
    SectionShape,
    UnwrappedPoints,
)
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import law_basis

SPAN_COUNT = 4
"""control points along the span of the camber that separates the sides"""
SURE_DISTANCE = 0.3
"""distance from the middle, of the half thickness, from which a point's side is certain."""


class SideAssignment(NamedTuple):
    """Points in a frame along the chord, assigned to the two sides by the middle between them."""

    upper: NDArray[np.bool_]
    """(n,) whether a point belongs to the upper side"""
    sure: NDArray[np.bool_]
    """(n,) whether that is certain: the point is clear of the middle"""
    ends: Reals
    """(2, k) control points along the span of where sections begin and end along the chord"""
    middle: Reals
    """(4 k,) coefficients of the middle across the chord, a Chebyshev series along it"""
    half: Reals
    """(4 k,) coefficients of the half thickness, likewise"""


def assigned_sides(
    shape: SectionShape,
    unwrapped: UnwrappedPoints,
    turn: Callable[[Reals], Reals],
    stacking: Reals,
    count: int = SPAN_COUNT,
) -> SideAssignment:
    """The sides of points whose chord lies along the angle `turn` [rad] by place along the span.

    `stacking` (k,) is a law of the ordinate along which the sections are stacked, `count` the control points along the
    span.
    """
    direction, unit = turn(unwrapped.v), shape.extent(unwrapped.v)
    cosine, sine = np.cos(direction), np.sin(direction)
    a = unwrapped.points[:, 0] / unit
    b = (unwrapped.points[:, 1] - law_basis(len(stacking), unwrapped.v) @ stacking) / unit
    along, across = cosine * a + sine * b, -sine * a + cosine * b
    rows = law_basis(count, unwrapped.v)
    low, high = (
        _envelope(rows, along, unwrapped.v, -1.0, unwrapped.flat),
        _envelope(rows, along, unwrapped.v, 1.0, unwrapped.flat),
    )
    start, end = rows @ low, rows @ high
    t = np.clip((along - start) / np.maximum(end - start, 1e-9), 0.0, 1.0)
    even = _even(t, unwrapped)
    vander = (chebyshev.chebvander(2.0 * t - 1.0, 3)[:, :, None] * rows[:, None, :]).reshape(len(t), -1)
    upper = across > vander @ _ridge_regression(vander, across, even)
    middle, half = np.zeros(vander.shape[1]), np.zeros(vander.shape[1])
    for _ in range(6):
        both = [_ridge_regression(vander[mask], across[mask], even[mask]) for mask in (upper, ~upper) if np.any(mask)]
        if len(both) < 2:
            break
        middle, half = (both[0] + both[1]) / 2.0, (both[0] - both[1]) / 2.0
        now = across > vander @ middle
        if np.array_equal(now, upper):
            break
        upper = now
    off = across - vander @ middle
    sure = off**2 > (SURE_DISTANCE * (vander @ half)) ** 2
    return SideAssignment(upper=upper, sure=sure, ends=np.stack([low, high]), middle=middle, half=half)


def first_laws(
    shape: SectionShape, unwrapped: UnwrappedPoints, turn: Callable[[Reals], Reals], stacking: Reals, count: int
) -> Reals:
    """Laws (count, q) of sections through the middle between the sides, as `assigned_sides` finds them."""
    found = assigned_sides(shape, unwrapped, turn, stacking, count)
    return _as_laws(shape, unwrapped, turn, stacking, found.ends, np.stack([found.middle, found.half]))


def _as_laws(
    shape: SectionShape,
    unwrapped: UnwrappedPoints,
    turn: Callable[[Reals], Reals],
    stacking: Reals,
    ends: Reals,
    fields: Reals,
) -> Reals:
    """The laws of sections by the ends, the middle and the half thickness of their points."""
    count = ends.shape[1]
    at = np.zeros(1) if unwrapped.flat else np.linspace(0.0, 1.0, max(9, 2 * count + 1))
    rows = law_basis(count, at)
    direction = turn(at)
    cosine, sine = np.cos(direction)[:, None], np.sin(direction)[:, None]
    start, end = rows @ ends[0], rows @ ends[1]
    to_bezier = np.linalg.inv(np.array([_bernstein(t) for t in (0.0, 1 / 3, 2 / 3, 1.0)]))
    even = chebyshev.chebvander(np.array([-1.0, -1 / 3, 1 / 3, 1.0]), 3)
    middle, half = (even @ field.reshape(4, count) @ rows.T for field in fields)
    ordinates = (to_bezier @ middle).T
    places = start[:, None] + np.array([0.0, 1 / 3, 2 / 3, 1.0]) * (end - start)[:, None]
    line = np.stack([cosine * places - sine * ordinates, sine * places + cosine * ordinates], axis=-1)
    first, last = line[:, 1] - line[:, 0], line[:, 3] - line[:, 2]
    chord = line[:, 3] - line[:, 0]
    extent = np.maximum(chord[:, 0], 0.02)
    numbers = np.zeros((len(at), shape.columns))
    numbers[:, START], numbers[:, EXTENT] = line[:, 0, 0], extent
    numbers[:, PLACE] = line[:, 0, 1] * shape.extent(at) + law_basis(len(stacking), at) @ stacking
    numbers[:, STAGGER] = np.clip(np.arctan2(chord[:, 1], extent), -STEEPEST_ANGLE, STEEPEST_ANGLE)
    for angle, tangent, vector in ((ANGLE_IN, TANGENT_IN, first), (ANGLE_OUT, TANGENT_OUT, last)):
        numbers[:, angle] = np.clip(
            np.arctan2(vector[:, 1], np.maximum(vector[:, 0], 1e-9)), -STEEPEST_ANGLE, STEEPEST_ANGLE
        )
        numbers[:, tangent] = np.clip(np.sqrt(np.sum(vector**2, axis=-1)) / extent, SHORTEST_TANGENT, LONGEST_TANGENT)
    size = shape.scale((shape.extent(at) * (line[:, 0, 0] + extent / 2.0))[:, None], at)[:, 0]
    thickness = np.maximum(np.mean(half[1:3], axis=0) * shape.extent(at) / size, 2e-3 * unwrapped.ratio)
    for side in (shape.upper, shape.lower):
        shares = np.ones(side.stop - side.start)
        shares[[0, -1]] = 0.6
        numbers[:, side] = thickness[:, None] * shares
    numbers[:, [ROOT_IN, ROOT_OUT]] = np.sqrt(0.3 * thickness)[:, None]
    return np.asarray(np.linalg.lstsq(rows, numbers, rcond=None)[0])


def _bernstein(t: float) -> list[float]:
    w = 1.0 - t
    return [w**3, 3 * w**2 * t, 3 * w * t**2, t**3]


def _envelope(rows: Reals, along: Reals, v: Reals, sign: float, flat: bool) -> Reals:
    """Control points of the law that bounds the places along the chord."""
    if flat:
        return np.full(1, sign * np.max(sign * along))
    parts = np.clip((v * 7.999).astype(int), 0, 7)
    index = []
    for part in range(8):
        mask = np.flatnonzero(parts == part)
        if len(mask):
            index.append(mask[np.argsort(-sign * along[mask])[: max(1, len(mask) // 60)]])
    chosen = np.concatenate(index)
    ridge = 1e-3 * np.eye(rows.shape[1])
    middle = float(np.mean(along[chosen]))
    matrix = np.concatenate([rows[chosen], ridge])
    rhs = np.concatenate([along[chosen] - middle, np.zeros(rows.shape[1])])
    return np.linalg.lstsq(matrix, rhs, rcond=None)[0] + middle


def _even(t: Reals, unwrapped: UnwrappedPoints) -> Reals:
    """Weights (n,) by which each part of the blade counts alike, however many points it has."""
    bins = (t * 9.999).astype(int) + 10 * (np.clip(unwrapped.v, 0.0, 1.0) * 3.999).astype(int) * (not unwrapped.flat)
    return np.asarray(1.0 / np.sqrt(np.bincount(bins)[bins]))


def _ridge_regression(matrix: Reals, rhs: Reals, weight: Reals) -> Reals:
    """Weighted least squares with a weak pull of all coefficients towards the mean."""
    ridge = 1e-3 * np.sqrt(np.sum(weight**2)) * np.eye(matrix.shape[1])
    middle = float(np.mean(rhs))
    rows = np.concatenate([matrix * weight[:, None], ridge])
    found = np.linalg.lstsq(rows, np.concatenate([(rhs - middle) * weight, np.zeros(len(ridge))]), rcond=None)[0]
    # the basis along the span sums to one: a constant is the same coefficient everywhere
    found[: matrix.shape[1] // 4] += middle
    return found
