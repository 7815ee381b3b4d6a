"""Curves and surfaces through points, and curves near points in the least-squares sense."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import make_interp_spline
from scipy.linalg import cho_solve_banded, cholesky_banded

from bladewright.errors import GeometryError
from bladewright.numerics.elementary import Array, length
from bladewright.nurbs.basis import Reals, basis, checked_knots
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface

SINGULAR = 1e-14
"""Diagonal of the normal equations, in units of the largest, below which no site determines a control point: such a
small one is rounding."""


def interpolated(
    points: ArrayLike,
    sites: ArrayLike,
    *,
    degree: int,
    knots: Reals | None = None,
    start: Sequence[ArrayLike] = (),
    end: Sequence[ArrayLike] = (),
) -> Curve:
    """The B-spline curve of the given degree through points (m, d) at increasing real sites (m,).

    `start` and `end` hold the first, second... derivatives (d,) at the first and last site; each takes one more control
    point, so that n = m + len(start) + len(end). `knots` (n + degree + 1,) default to `averaged_knots`. Points and
    derivatives may be complex. Raises GeometryError where sites do not increase, shapes do not fit, or a basis function
    has no site in its support (Schoenberg and Whitney 1953). Piegl and Tiller 1997, sections 9.2.1 and 9.2.2.
    """
    values, at = np.asarray(points), _increasing(sites)
    if knots is None:
        knots = averaged_knots(at, degree, len(start), len(end))
    net = interpolation_net(values, at, degree=degree, knots=knots, start=start, end=end)
    return Curve(control_points=net, knots=knots, degree=degree)


def interpolation_net(
    points: ArrayLike,
    sites: ArrayLike,
    *,
    degree: int,
    knots: Reals,
    start: Sequence[ArrayLike] = (),
    end: Sequence[ArrayLike] = (),
) -> Array:
    """Control points (n, ...) of `interpolated` for points (m, ...) of any trailing shape: many curves in one solve."""
    values, at = np.asarray(points), _increasing(sites)
    if len(values) != len(at):
        raise GeometryError(f"{len(values)} points were given at {len(at)} sites: give one site a point")
    count = len(at) + len(start) + len(end)
    target = checked_knots(knots, degree, count, "interpolation knots")
    if target[0] != at[0] or target[-1] != at[-1]:
        raise GeometryError(
            f"knots over [{target[0]:g}, {target[-1]:g}] were given for sites over [{at[0]:g}, {at[-1]:g}]: "
            "both must share their ends"
        )
    kind = np.result_type(values, *(np.asarray(value) for value in (*start, *end)), np.float64)
    conditions = tuple(
        [(order, np.broadcast_to(value, values.shape[1:]).astype(kind)) for order, value in enumerate(side, 1)] or None
        for side in (start, end)
    )
    try:
        net: Array = make_interp_spline(at, values.astype(kind), degree, t=target, bc_type=conditions).c
    except (ValueError, np.linalg.LinAlgError) as error:
        raise GeometryError(
            f"{len(at)} points with {len(start)} and {len(end)} end derivatives do not determine a curve of degree "
            f"{degree} on these knots ({error}); each control point needs a site within its {degree + 1} knot spans"
        ) from error
    return net


def averaged_knots(sites: ArrayLike, degree: int, start: int = 0, end: int = 0) -> Reals:
    """Clamped knots for interpolation at sites (m,) with `start` and `end` derivatives at the ends.

    Each inner knot is the mean of `degree` consecutive sites, an end counted once more for each of its derivatives:
    the collocation matrix is then never singular (Piegl and Tiller 1997, eq. 9.8). Raises GeometryError where there are
    fewer than degree + 1 conditions, or `degree` derivatives at an end.
    """
    at = _increasing(sites)
    if max(start, end) >= max(degree, 1):
        raise GeometryError(
            f"{max(start, end)} derivatives at an end were given for degree {degree} without knots: at most "
            f"{degree - 1}; raise the degree or give knots"
        )
    padded = np.concatenate([np.full(start, at[0]), at, np.full(end, at[-1])])
    if len(padded) < degree + 1:
        raise GeometryError(
            f"{len(padded)} conditions were given for degree {degree}: {degree + 1} are needed; lower the degree"
        )
    inner = [padded[i : i + degree].mean() for i in range(1, len(padded) - degree)]
    return np.concatenate([np.full(degree + 1, at[0]), inner, np.full(degree + 1, at[-1])])


def chord_sites(points: ArrayLike, power: float = 1.0) -> Reals:
    """Sites (m,) in [0, 1] with steps in proportion to a power of the distances between points (m, d).

    Power 1 is chord length, 0.5 is centripetal (Lee 1989). Real parts only: sites are held fixed while differentiating.
    Raises GeometryError where two consecutive points coincide.
    """
    steps = length(np.diff(np.real(np.asarray(points)), axis=0)) ** power
    if len(steps) == 0 or not (steps > 0.0).all():
        raise GeometryError("sites were asked for points of which two in a row coincide; drop one of them")
    total = np.concatenate([[0.0], np.cumsum(steps)])
    return np.asarray(total / total[-1])


def interpolated_surface(
    points: ArrayLike,
    sites_u: ArrayLike,
    sites_v: ArrayLike,
    *,
    degree_u: int,
    degree_v: int,
    knots_u: Reals | None = None,
    knots_v: Reals | None = None,
) -> Surface:
    """The B-spline surface through a grid of points (m_u, m_v, d) at increasing sites (m_u,) and (m_v,).

    Knots default to `averaged_knots`. Piegl and Tiller 1997, section 9.2.5; raises as `interpolated` does.
    """
    knots_u = averaged_knots(sites_u, degree_u) if knots_u is None else knots_u
    knots_v = averaged_knots(sites_v, degree_v) if knots_v is None else knots_v
    rows = interpolation_net(points, sites_u, degree=degree_u, knots=knots_u)
    net = interpolation_net(np.swapaxes(rows, 0, 1), sites_v, degree=degree_v, knots=knots_v)
    return Surface(
        control_points=np.swapaxes(net, 0, 1), knots_u=knots_u, knots_v=knots_v, degree_u=degree_u, degree_v=degree_v
    )


def _increasing(sites: ArrayLike) -> Reals:
    at = np.asarray(sites, dtype=np.float64)
    if at.ndim != 1 or len(at) < 2 or not (np.diff(at) > 0.0).all():
        raise GeometryError(f"sites {at.tolist()} were given: at least two are needed, each above the one before")
    return at


def approximated(
    points: ArrayLike,
    sites: ArrayLike,
    *,
    degree: int,
    knots: Reals,
    weights: ArrayLike | None = None,
    ends: bool = False,
) -> Curve:
    """The B-spline curve on fixed knots that fits points (m, d) at real sites (m,) by weighted least squares.

    `weights` (m,) of the squares are real and positive; with `ends` the first and last point are interpolated. Sites
    need not increase. Points may be complex: the curve is linear in them. Raises GeometryError where a control point is
    not determined by the sites. Piegl and Tiller 1997, section 9.4.1, by the normal equations.
    """
    values, at = np.asarray(points), np.asarray(sites, dtype=np.float64)
    count = len(knots) - degree - 1
    target = checked_knots(knots, degree, count, "approximation knots")
    if at.ndim != 1 or len(values) != len(at):
        raise GeometryError(f"{len(values)} points were given at sites of shape {at.shape}: give one site a point")
    matrix = basis(target, degree, at)
    scale = np.ones(len(at)) if weights is None else np.asarray(weights, dtype=np.float64)
    net = np.zeros((count, *values.shape[1:]), dtype=np.result_type(values, np.float64))
    free = slice(None)
    if ends:
        net[0], net[-1] = values[np.argmin(at)], values[np.argmax(at)]
        values = values - np.tensordot(matrix[:, [0, -1]], net[[0, -1]], axes=1)
        free = slice(1, -1)
    net[free] = _least_squares(matrix[:, free], scale, values, degree)
    return Curve(control_points=net, knots=target, degree=degree)


def _least_squares(matrix: Reals, scale: Reals, values: Array, degree: int) -> Array:
    count = matrix.shape[1]
    weighted = matrix.T * scale
    normal = weighted @ matrix
    diagonal = np.diagonal(normal)
    banded = np.zeros((min(degree, count - 1) + 1, count))
    for k in range(len(banded)):
        banded[k, : count - k] = np.diagonal(normal, k)
    try:
        if not (diagonal > SINGULAR * diagonal.max(initial=0.0)).all():
            raise np.linalg.LinAlgError("no site lies in the support of a control point")  # noqa: TRY301
        factor = cholesky_banded(banded, lower=True)
    except np.linalg.LinAlgError as error:
        raise GeometryError(
            f"{len(matrix)} sites do not determine {count} control points of degree {degree} ({error}); "
            "take fewer knots or more points"
        ) from error
    flat = values.reshape(len(values), -1)
    columns = np.concatenate([flat.real, flat.imag], axis=1) if np.iscomplexobj(flat) else flat
    solved = cho_solve_banded((factor, True), weighted @ columns)
    # the normal equations square the condition number; one step of iterative refinement makes up for that
    solved = solved + cho_solve_banded((factor, True), weighted @ (columns - matrix @ solved))
    if np.iscomplexobj(flat):
        solved = solved[:, : flat.shape[1]] + 1j * solved[:, flat.shape[1] :]
    return np.asarray(solved.reshape(count, *values.shape[1:]))
