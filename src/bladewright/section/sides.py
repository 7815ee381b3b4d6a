"""The two sides of a section: B-splines of degree four around the camber line, with edge radii by construction."""

import numpy as np

from bladewright.numerics.elementary import Array, dot, joined
from bladewright.nurbs.basis import Reals
from bladewright.section.camber import camber_points, camber_tangents, turned_left

DEGREE = 4


def advances(line: Array, places: Reals, thickness: Array, upper: bool) -> tuple[Array, Array]:
    """How far the third control point from each edge stands inside the blade, along the edge's camber tangent (...).

    Both must be positive, or no edge radius can be set: the side would leave the edge outwards.
    """
    inner = _thickened(line, places, thickness, upper)
    tangents = camber_tangents(line, np.array([0.0, 1.0]))
    at_start = dot(inner[..., 0, :] - line[..., 0, :], tangents[..., 0, :])
    at_end = dot(line[..., 3, :] - inner[..., -1, :], tangents[..., 1, :])
    return at_start, at_end


def edge_height(advance: Array, curvature: Array, ratio: float | Array = 1.0) -> Array:
    """Distance of the second control point from the edge that gives the side the curvature at its end.

    `ratio` is w0 w2 / w1^2 of the weights. Uniform knots: the end's two knot spans are equal.
    Reference: Agromayor et al. 2021, eq. A.7.
    """
    return np.sqrt((DEGREE - 1) / DEGREE * 0.5 * ratio * advance / curvature)


def side(
    line: Array,
    places: Reals,
    thickness: Array,
    curvature_in: Array,
    curvature_out: Array,
    *,
    upper: bool,
    weights: Array | None = None,
) -> Array:
    """Control points (..., n, 2) of a side, or (..., n, 3) homogeneous (w x, w y, w) where weights are given.

    `line` (..., 4, 2) camber line; `places` (n,) camber parameters; `thickness` (..., n - 4) half thicknesses at the
    inner places; curvatures (...) at the edges; `weights` (..., n). Reference: Agromayor et al. 2021, eqs. 12, 13.
    """
    inner = _thickened(line, places, thickness, upper)
    ends = line[..., [0, 3], :]
    normals = turned_left(camber_tangents(line, np.array([0.0, 1.0]))) * (1.0 if upper else -1.0)
    at_start, at_end = advances(line, places, thickness, upper)
    ratio_in: float | Array = 1.0
    ratio_out: float | Array = 1.0
    if weights is not None:
        ratio_in = weights[..., 0] * weights[..., 2] / weights[..., 1] ** 2
        ratio_out = weights[..., -1] * weights[..., -3] / weights[..., -2] ** 2
    second = ends[..., 0, :] + edge_height(at_start, curvature_in, ratio_in)[..., None] * normals[..., 0, :]
    before_last = ends[..., 1, :] + edge_height(at_end, curvature_out, ratio_out)[..., None] * normals[..., 1, :]
    rows = [ends[..., :1, :], second[..., None, :], inner, before_last[..., None, :], ends[..., 1:, :]]
    points = joined(rows, axis=-2)
    if weights is None:
        return points
    return joined([points * weights[..., None], weights[..., None]], axis=-1)


def _thickened(line: Array, places: Reals, thickness: Array, upper: bool) -> Array:
    inner = places[2:-2]
    normals = turned_left(camber_tangents(line, inner)) * (1.0 if upper else -1.0)
    return camber_points(line, inner) + thickness[..., None] * normals
