"""Surfaces from curves: ruled, Coons, skinned."""

from collections.abc import Sequence

import numpy as np

from bladewright.errors import GeometryError
from bladewright.numerics.elementary import Array, length
from bladewright.nurbs.basis import Reals, greville
from bladewright.nurbs.compatible import SAME_POINT, compatible, weighted
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.fit import averaged_knots, interpolation_net
from bladewright.nurbs.rational import projected
from bladewright.nurbs.surface import Surface


def ruled(first: Curve, second: Curve) -> Surface:
    """The surface of straight lines between equal parameters of two curves: u along them, v from first to second.

    Piegl and Tiller 1997, section 8.4.
    """
    first, second = compatible((first, second))
    net = np.stack([first.homogeneous, second.homogeneous], axis=1)
    return _surface(net, first, np.array([0.0, 0.0, 1.0, 1.0]), 1)


def coons(south: Curve, north: Curve, west: Curve, east: Curve) -> Surface:
    """The bilinearly blended surface with edges south = S(u, 0), north = S(u, 1), west = S(0, v), east = S(1, v).

    Raises GeometryError where the edges do not meet at a corner, or meet there with different weights. Coons 1967;
    Farin 2002, section 22.2, on homogeneous coordinates; a blend that is linear has its values at Greville abscissae as
    control points.
    """
    if any(curve.weights is not None for curve in (south, north, west, east)):
        south, north, west, east = (weighted(curve) for curve in (south, north, west, east))
    south, north = compatible((south, north))
    west, east = compatible((west, east))
    _meet_at_corners(south, north, west, east)
    u = greville(south.knots, south.degree)[:, None, None]
    v = greville(west.knots, west.degree)[None, :, None]
    s, n = south.homogeneous[:, None], north.homogeneous[:, None]
    w, e = west.homogeneous[None, :], east.homogeneous[None, :]
    corners = (1.0 - v) * ((1.0 - u) * s[0] + u * s[-1]) + v * ((1.0 - u) * n[0] + u * n[-1])
    net = (1.0 - v) * s + v * n + (1.0 - u) * w + u * e - corners
    return _surface(net, south, west.knots, west.degree)


def skinned(curves: Sequence[Curve], sites: Reals, *, degree: int = 3, knots: Reals | None = None) -> Surface:
    """The surface through section curves at increasing sites v (m,): S(u, sites[k]) is curve k, over [0, 1] in u.

    `degree` and `knots` are those along v; knots default to `averaged_knots`. Rational sections are skinned in
    homogeneous coordinates. Raises GeometryError where a weight between sections is not positive, and as `interpolated`
    does. Piegl and Tiller 1997, section 10.3.
    """
    sections = compatible(curves)
    target = averaged_knots(sites, degree) if knots is None else knots
    net = interpolation_net(np.stack([curve.homogeneous for curve in sections]), sites, degree=degree, knots=target)
    return _surface(np.swapaxes(net, 0, 1), sections[0], target, degree)


def _surface(net: Array, along_u: Curve, knots_v: Reals, degree_v: int) -> Surface:
    points, weights = projected(net, rational=along_u.weights is not None)
    return Surface(
        control_points=points,
        weights=weights,
        knots_u=along_u.knots,
        knots_v=knots_v,
        degree_u=along_u.degree,
        degree_v=degree_v,
    )


def _meet_at_corners(south: Curve, north: Curve, west: Curve, east: Curve) -> None:
    s, n, w, e = (curve.homogeneous.real for curve in (south, north, west, east))
    extent = float(np.ptp(np.concatenate([s, n, w, e]), axis=0).max())
    corners = {
        "south-west": s[0] - w[0],
        "south-east": s[-1] - e[0],
        "north-west": n[0] - w[-1],
        "north-east": n[-1] - e[-1],
    }
    for name, offset in corners.items():
        gap = float(length(offset))
        if gap > SAME_POINT * extent:
            raise GeometryError(
                f"the edges of a Coons surface miss each other by {gap:g} at the {name} corner (weights count): "
                f"at most {SAME_POINT * extent:g} is allowed; reverse or reorder them, or scale their weights"
            )
