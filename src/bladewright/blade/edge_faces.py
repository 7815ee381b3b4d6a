"""Faces of blunt edges: between the ends of both sides, straight in the plane of each section."""

import numpy as np

from bladewright.blade.knots import DEGREE, Knots
from bladewright.blade.laid import Laid
from bladewright.numerics.elementary import joined
from bladewright.numerics.solving import solved
from bladewright.nurbs.basis import basis
from bladewright.nurbs.surface import Surface


def edge_faces(stations: Laid, upper: Surface, lower: Surface, knots: Knots) -> dict[str, Surface]:
    """The faces by name, from stations at `knots.sites_v`; u from the upper to the lower side, v along the span.

    They have the control points of both sides' edges. A face is one polynomial of degree 5 along u: it is as short as
    the edge is thick, so its arc about the axis is below rounding from that.
    """
    matrix = basis(knots.v, DEGREE, knots.sites_v)
    clamped = np.repeat([0.0, 1.0], DEGREE + 1)
    w = np.arange(1, DEGREE) / DEGREE
    along = basis(clamped, DEGREE, w)
    found = {}
    for name, points in stations.faces(w).items():
        at = 0 if name == "leading_edge" else -1
        rows = solved(matrix, points.reshape(*points.shape[:-2], -1)).reshape(points.shape)
        ends = np.stack([side.control_points[at] for side in (upper, lower)])
        outer = np.tensordot(along[:, [0, -1]], ends, axes=1)
        right = np.swapaxes(rows, -3, -2) - outer
        inner = solved(along[:, 1:-1], right.reshape(len(w), -1)).reshape(right.shape)
        found[name] = Surface(
            control_points=joined([ends[:1], inner, ends[1:]], axis=0),
            knots_u=clamped,
            knots_v=knots.v,
            degree_u=DEGREE,
            degree_v=DEGREE,
        )
    return found
