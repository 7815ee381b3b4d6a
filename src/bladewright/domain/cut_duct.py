"""The middle surface between walls that cuts have made: its lines across the duct end where they meet the cuts."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from bladewright.blade.native.cut_lines import Crossing, Lines, crossing, in_meridian, real_curve, searched
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import basis, breaks, greville
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface

OUTLINE_POINTS = 16
"""Gauss points in each knot span of the outline."""


def between_walls(middle: Surface, meridians: Mapping[str, Curve], *, revolved: bool) -> Surface:
    """The middle surface, u along the flow, v from hub to shroud, between the meridians that cut it off.

    At its own knots, its lines of constant u parted evenly. Raises DesignError where a meridian does not cross them
    all once, from inlet to outlet.
    """
    sites = greville(middle.knots_u, middle.degree_u)
    lines = Lines(face=middle, along="v", at=sites, revolved=revolved)
    low, high = (
        _met(lines, meridians[wall], wall) if wall in meridians else np.full(len(sites), end)
        for wall, end in (("hub", 0.0), ("shroud", 1.0))
    )
    w = greville(middle.knots_v, middle.degree_v)
    points = middle(sites[:, None], low[:, None] + (high - low)[:, None] * w)
    along = np.linalg.solve(basis(middle.knots_u, middle.degree_u, sites), points.reshape(len(sites), -1))
    rows = np.moveaxis(along.reshape(points.shape), 1, 0)
    across = np.linalg.solve(basis(middle.knots_v, middle.degree_v, w), rows.reshape(len(w), -1))
    return replace(middle, control_points=np.moveaxis(across.reshape(rows.shape), 0, 1))


def _met(lines: Lines, meridian: Curve, wall: str) -> Array:
    found = searched(lines.real(), real_curve(meridian))
    counts = [len(each) for each in found]
    if min(counts) == max(counts) == 1:
        place, t = np.transpose([each[0] for each in found])
        crossed = crossing(lines, meridian, Crossing(place, t))
        if crossed is not None:
            return crossed.place
    end = "tip" if wall == "shroud" else wall
    raise DesignError(
        f"cut.{end}: it is the {wall} of the passage, and does not run between hub and shroud from the inlet to the "
        "outlet: let the curve reach as far inside them, or give a shorter upstream and downstream"
    )


def outline_volume(middle: Surface, *, revolved: bool) -> Array:
    """Volume () [m^3] of the ring that the meridional outline of a middle surface bounds; in a cascade, its area [m^2].

    The integral of pi r^2 dx, or z dx, around the outline (Pappus and Green).
    """
    net = middle.control_points
    rows = [(net[:, 0], middle.knots_u, middle.degree_u, -1.0), (net[:, -1], middle.knots_u, middle.degree_u, 1.0)]
    rows += [(net[0], middle.knots_v, middle.degree_v, 1.0), (net[-1], middle.knots_v, middle.degree_v, -1.0)]
    total: Array = np.zeros(())
    for points, knots, degree, sign in rows:
        curve = Curve(control_points=points, knots=knots, degree=degree)
        s, weight = panels(breaks(knots), OUTLINE_POINTS)
        r = in_meridian(curve(s), revolved)[:, 1]
        flux = np.pi * r**2 if revolved else r
        total = total + sign * np.sum(weight * flux * curve.derivative(s)[:, 0])
    return total
