"""Thickness laws of the unified family, fitted to the sides of sections that have the same camber line."""

import numpy as np

from bladewright.errors import DesignError
from bladewright.numerics.elementary import turned_left
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.section.camber import camber_tangents
from bladewright.section.laws import law_basis
from bladewright.section.unified_sides import DEGREE, advances, edge_height, side

LEAST_THICKNESS = 1e-5
"""Smallest control point of a thickness law, as a fraction of the meridional length: a blade must not have thickness
0."""
START_THICKNESS = 0.05
"""Thickness, as a fraction of the meridional length, with which the fit starts: that of a usual blade."""
ROUNDS = 5
"""Gauss-Newton steps of the fit, each with new footpoints. More cost time for every import; whether they were enough
shows in the distance that is left, which is reported."""
LARGEST_STEP = 0.02
"""Largest step of a side's parameter towards a footpoint, 15 points of the global search at mid-chord: a footpoint near
an edge must not jump to beyond it."""
EDGE_MARGIN = 1.3
"""Ratio of the control point next to an edge to the height that the edge radius needs there: between its control points
the law may be lower."""
_DENSE = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 1201))) / 2.0


def fitted_thickness(
    camber: Reals,
    radii: tuple[Reals, Reals],
    target: Reals,
    least: Reals,
    v: Reals,
    places: Reals,
    *,
    upper: bool,
) -> tuple[Reals, float]:
    """Control points (chordwise, spanwise) of a thickness law, and the largest distance that is left.

    They minimise the squares of the normal distances from the `target` points (m, k, 2) of the side, with `least`
    (chordwise, spanwise) as lower bounds. `camber` (m, 4, 2) and `radii` (m,) are those of the sections at v (m,);
    `places` are the camber parameters of a side's control points. Raises DesignError where the camber turns too fast
    for the sides.
    """
    from scipy.optimize import lsq_linear

    inner = places[2:-2]
    along, across = law_basis(least.shape[0], inner), law_basis(least.shape[1], v)
    normals = turned_left(camber_tangents(camber, inner)) * (1.0 if upper else -1.0)
    law, footpoints = np.maximum(START_THICKNESS, least), np.zeros(0)
    for turn in range(ROUNDS + 1):
        controls, rates = _side(camber, radii, across @ law.T @ along.T, places, normals, upper)
        # footpoints that follow from earlier ones may end beyond an edge: the first and the last search is global
        near = _closest_sampled(controls, target) if turn in (0, ROUNDS) else footpoints
        footpoints = _closest_refined(controls, target, near)
        (rows, points), (_, slopes) = (_evaluated(controls, footpoints, order) for order in (0, 1))
        normal = turned_left(slopes) / np.sqrt(np.sum(slopes**2, axis=-1, keepdims=True))
        residuals = np.sum(normal * (target - points), axis=-1)
        if turn == ROUNDS:
            break
        directed = np.einsum("mcpd,mkd->mkcp", rates, normal, optimize=True)
        by_law = np.einsum("mkc,mkcp->mkp", rows, directed) @ along
        normal_matrix = sum(np.kron(each.T @ each, np.outer(a, a)) for each, a in zip(by_law, across, strict=True))
        right = sum(np.kron(each.T @ r, a) for each, r, a in zip(by_law, residuals, across, strict=True))
        # the Cholesky factor replaces all rows of the problem; the ridge only keeps it positive definite
        triangle = np.linalg.cholesky(normal_matrix + 1e-12 * np.trace(normal_matrix) * np.eye(law.size)).T
        low = (least - law).ravel() - 1e-12
        wanted = np.linalg.solve(triangle.T, right)
        step = lsq_linear(triangle, wanted, bounds=(low, np.full(law.size, 10.0)), method="bvls")
        law = np.maximum(law + step.x.reshape(law.shape), least)
    return law, float(np.sqrt(np.max(np.sum((target - points) ** 2, axis=-1))))


def least_thickness(count: int, spanwise: int, radii: tuple[Reals, Reals], v: Reals, places: Reals) -> Reals:
    """Least control points (count, spanwise) of a thickness law with which its ends can hold radii (m,) at v (m,)."""
    least = np.full((count, spanwise), LEAST_THICKNESS)
    shares = law_basis(spanwise, v)
    for row, values in ((0, radii[0]), (-1, radii[1])):
        # the advance of the first sample along the camber is about its camber parameter
        height = edge_height(places[2] * np.ones(len(v)), 1.0 / values)
        least[row] = EDGE_MARGIN * np.max(np.where(shares > 0.3, height[:, None], 0.0), axis=0)
    return np.maximum(least, LEAST_THICKNESS)


def largest_edge_radii(camber: Reals, thickness: tuple[Reals, Reals], places: Reals) -> tuple[Reals, Reals]:
    """Largest radii (m,) of both edges that the thicknesses (m, k) of both sides at the inner places can hold."""
    found = []
    for end in (0, 1):
        most = []
        for values, upper in zip(thickness, (True, False), strict=True):
            advance = advances(camber, places, values, upper)[end]
            unit_height = edge_height(np.maximum(advance, 0.0), np.ones(len(camber)))
            next_thickness = values[:, 0 if end == 0 else -1]
            most.append(np.where(advance > 0.0, (next_thickness / np.maximum(unit_height, 1e-12)) ** 2, 0.0))
        found.append(np.minimum(*most))
    return found[0], found[1]


def _side(
    camber: Reals, radii: tuple[Reals, Reals], values: Reals, places: Reals, normals: Reals, upper: bool
) -> tuple[Reals, Reals]:
    """Control points (m, n, 2) of a side, and their derivatives (m, n, p, 2) by the thicknesses at the p samples."""
    if min(float(np.min(each)) for each in advances(camber, places, values, upper)) <= 0.0:
        name = "upper" if upper else "lower"
        raise DesignError(f"next to an edge the {name} side leaves the blade outwards: the camber turns too fast there")
    controls = side(camber, places, values, 1.0 / radii[0], 1.0 / radii[1], upper=upper)
    m, p = values.shape
    rates = np.zeros((m, len(places), p, 2))
    for j in range(p):
        rates[:, j + 2, j] = normals[:, j]
    tangents = camber_tangents(camber, np.array([0.0, 1.0]))
    sign = 1.0 if upper else -1.0
    reached = advances(camber, places, values, upper)
    for end, row, j in ((0, 1, 0), (1, -2, -1)):
        turn = np.sum(normals[:, j] * tangents[:, end], axis=-1) * (1.0 if end == 0 else -1.0)
        height = edge_height(reached[end], 1.0 / radii[end])
        outward = sign * turned_left(tangents[:, end])
        rates[:, row, j] = (0.5 * height / reached[end] * turn)[:, None] * outward
    return controls, rates


def _evaluated(controls: Reals, s: Reals, order: int) -> tuple[Reals, Reals]:
    """Basis functions (m, k, n) at s (m, k) or their derivatives, and the sums with control points (m, n, 2)."""
    count = controls.shape[1]
    rows = basis(uniform_knots(count, DEGREE), DEGREE, s.ravel(), order).reshape(*s.shape, count)
    return rows, rows @ controls


def _closest_sampled(controls: Reals, points: Reals) -> Reals:
    """Parameters (m, k) of the footpoints of points (m, k, 2), the nearest of 1201 points of each side."""
    from scipy.spatial import cKDTree

    curves = basis(uniform_knots(controls.shape[1], DEGREE), DEGREE, _DENSE) @ controls
    return np.stack([_DENSE[cKDTree(curve).query(each)[1]] for curve, each in zip(curves, points, strict=True)])


def _closest_refined(controls: Reals, points: Reals, footpoints: Reals) -> Reals:
    """Parameters (m, k) of the footpoints, by two Gauss-Newton steps from `footpoints` (m, k)."""
    for _ in range(2):
        (_, at), (_, slope) = (_evaluated(controls, footpoints, order) for order in (0, 1))
        step = np.sum((points - at) * slope, axis=-1) / np.sum(slope**2, axis=-1)
        footpoints = np.clip(footpoints + np.clip(step, -LARGEST_STEP, LARGEST_STEP), 0.0, 1.0)
    return footpoints
