"""Native sides that interpolate the exact blade, with the edges' two derivatives built into their control points."""

from typing import NamedTuple

import numpy as np

from bladewright.blade.knots import DEGREE, Knots
from bladewright.blade.stations import EdgeRow, Stations
from bladewright.numerics.elementary import Array, joined
from bladewright.numerics.solving import solved
from bladewright.nurbs.basis import Reals, basis, greville


def native_sides(stations: Stations, knots: Knots) -> tuple[Array, Array]:
    """Control nets (..., n_u, n_v, 3) of the upper and the lower side from stations at `knots.sites_v`.

    Across each edge the sides share the row P0, the rows P0 + D and P0 - D and the row of second derivatives E, so
    that curvature is continuous there for every v.
    """
    return sides_through(skeleton_of(stations, knots), knots)


class Skeleton(NamedTuple):
    """What the native sides interpolate at their sites along the span (m,): the nets are linear in it."""

    leading_edge: EdgeRow
    trailing_edge: EdgeRow
    upper: Array
    """points (..., m, n_u - 6, 3)"""
    lower: Array
    """points (..., m, n_u - 6, 3)"""


def skeleton_of(stations: Stations, knots: Knots) -> Skeleton:
    """The skeleton of stations at `knots.sites_v`."""
    return Skeleton(stations.leading_edge(), stations.trailing_edge(), *stations.points(knots.sites_u))


def sides_through(skeleton: Skeleton, knots: Knots) -> tuple[Array, Array]:
    """Control nets (..., n_u, n_v, 3) of the upper and the lower side that interpolate a skeleton."""
    matrix = basis(knots.v, DEGREE, knots.sites_v)
    ends = solved(matrix, joined([*skeleton.leading_edge, *skeleton.trailing_edge], axis=-1))
    parts = np.split(ends, 6, axis=-1)
    edges = EdgeRow(*parts[:3]), EdgeRow(*parts[3:])
    sides = []
    for points, sign in ((skeleton.upper, 1.0), (skeleton.lower, -1.0)):
        rows = solved(matrix, points.reshape(*points.shape[:-2], -1)).reshape(points.shape)
        sides.append(interpolated_along_u(np.swapaxes(rows, -3, -2), *edges, sign, knots.u))
    return sides[0], sides[1]


def interpolated_along_u(lines: Array, start: EdgeRow, end: EdgeRow, sign: float, knots_u: Reals) -> Array:
    """Control points (..., n_u, m, 3) through points (..., n_u - 6, m, 3), with two end derivatives (..., m, 3).

    `sign` is +1 for the upper side and -1 for the lower, whose first derivatives are opposite.
    """
    sites = greville(knots_u, DEGREE)[3:-3]
    first = _end_rows(start, sign, knots_u[DEGREE + 1], knots_u[DEGREE + 2])
    last = _end_rows(end, -sign, 1.0 - knots_u[-DEGREE - 2], 1.0 - knots_u[-DEGREE - 3])[::-1]
    known = np.stack([*first, *last], axis=-3)
    matrix = basis(knots_u, DEGREE, sites)
    outer = np.concatenate([matrix[:, :3], matrix[:, -3:]], axis=1)
    right = lines - (outer @ known.reshape(*known.shape[:-2], -1)).reshape(*known.shape[:-3], *lines.shape[-3:])
    shape = right.shape
    inner = solved(matrix[:, 3:-3], right.reshape(*shape[:-2], -1)).reshape(shape)
    return joined([known[..., :3, :, :], inner, known[..., 3:, :, :]], axis=-3)


def _end_rows(row: EdgeRow, sign: float, near: float, far: float) -> list[Array]:
    """The three control points at a clamped end, whose first two inner knots stand near and far from it."""
    step = sign * row.first * (near / DEGREE)
    second = row.point + step
    third = second + far * (row.second * (near / (DEGREE * (DEGREE - 1))) + step / near)
    return [row.point, second, third]
