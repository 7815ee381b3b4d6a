"""Native sides that interpolate the exact blade, with the edges' two derivatives built into their control points."""

import numpy as np

from bladewright.blade.knots import DEGREE, Knots
from bladewright.blade.stations import EdgeRow, Stations
from bladewright.numerics.elementary import Array, joined
from bladewright.nurbs.basis import Reals, basis, greville


def native_sides(stations: Stations, knots: Knots) -> tuple[Array, Array]:
    """Control nets (..., n_u, n_v, 3) of the upper and the lower side from stations at `knots.sites_v`.

    Across each edge the sides share the row P0, the rows P0 + D and P0 - D and the row of second derivatives E, so
    that curvature is continuous there for every v.
    """
    matrix = basis(knots.v, DEGREE, stations.v)

    def along_v(values: Array) -> Array:
        return np.linalg.solve(matrix, values)

    rows = stations.leading_edge(), stations.trailing_edge()
    parts = np.split(along_v(joined([*rows[0], *rows[1]], axis=-1)), 6, axis=-1)
    edges = EdgeRow(*parts[:3]), EdgeRow(*parts[3:])
    sides = []
    for points, sign in zip(stations.points(knots.sites_u), (1.0, -1.0), strict=True):
        flat = np.swapaxes(points, -3, -2)
        lines = along_v(flat.reshape(*flat.shape[:-3], *flat.shape[-3:]))
        sides.append(interpolated_along_u(lines, edges[0], edges[1], sign, knots.u))
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
    right = lines - np.einsum("ik,...kmd->...imd", outer, known)
    shape = right.shape
    inner = np.linalg.solve(matrix[:, 3:-3], right.reshape(*shape[:-2], -1)).reshape(shape)
    return joined([known[..., :3, :, :], inner, known[..., 3:, :, :]], axis=-3)


def _end_rows(row: EdgeRow, sign: float, near: float, far: float) -> list[Array]:
    """The three control points at a clamped end, whose first two inner knots stand near and far from it."""
    step = sign * row.first * (near / DEGREE)
    second = row.point + step
    third = second + far * (row.second * (near / (DEGREE * (DEGREE - 1))) + step / near)
    return [row.point, second, third]
