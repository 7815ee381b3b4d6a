"""Curves near points in the least-squares sense."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import cho_solve_banded, cholesky_banded

from bladewright.errors import GeometryError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals, basis, checked_knots
from bladewright.nurbs.curve import Curve


def approximated(
    points: ArrayLike,
    sites: ArrayLike,
    *,
    degree: int,
    knots: Reals,
    weights: ArrayLike | None = None,
    ends: bool = False,
) -> Curve:
    """The B-spline curve on fixed knots nearest to points (m, d) at real sites (m,): least sum of weighted squares.

    `weights` (m,) are real and positive, of the squares; with `ends` the first and last point are interpolated. Sites
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
        if not (diagonal > 1e-14 * diagonal.max(initial=0.0)).all():
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
    # the normal equations square the condition number; one step of refinement takes that back
    solved = solved + cho_solve_banded((factor, True), weighted @ (columns - matrix @ solved))
    if np.iscomplexobj(flat):
        solved = solved[:, : flat.shape[1]] + 1j * solved[:, flat.shape[1] :]
    return np.asarray(solved.reshape(count, *values.shape[1:]))
