"""Thickness laws of the unified family whose sides come nearest to those of other sections with the same camber."""

import numpy as np

from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.section.camber import camber_tangents, turned_left
from bladewright.section.laws import law_basis
from bladewright.section.sides import DEGREE, advances, edge_height, side

LEAST = 1e-5
"""smallest thickness control point"""
START = 0.05
"""thickness that the rounds begin with"""
ROUNDS = 5
ROOM = 1.3
"""thickness control point next to an edge over the height that the edge's radius needs, as the law falls off from it"""
_DENSE = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 1201))) / 2.0


def matched_thickness(
    camber: Reals, radii: tuple[Reals, Reals], target: Reals, least: Reals, v: Reals, places: Reals, *, upper: bool
) -> Reals:
    """Control points (chordwise, spanwise) of a thickness law, by bounded least squares of the normal distances.

    `camber` (m, 4, 2), `radii` (m,) and `target` points (m, k, 2) at v (m,); `least` (chordwise, spanwise) the
    smallest control points; `places` the camber parameters of a side's control points.
    """
    from scipy.optimize import lsq_linear

    inner = places[2:-2]
    along, across = law_basis(least.shape[0], inner), law_basis(least.shape[1], v)
    normals = turned_left(camber_tangents(camber, inner)) * (1.0 if upper else -1.0)
    knots = uniform_knots(len(places), DEGREE)
    dense = basis(knots, DEGREE, _DENSE)
    law = np.maximum(START, least)
    for _ in range(ROUNDS):
        controls, rates = _side(camber, radii, across @ law.T @ along.T, places, normals, upper)
        curves = dense @ controls
        normal_matrix, right = np.zeros((law.size, law.size)), np.zeros(law.size)
        for i in range(len(v)):
            s = _nearest(curves[i], target[i])
            rows, slopes = basis(knots, DEGREE, s), basis(knots, DEGREE, s, 1) @ controls[i]
            normal = turned_left(slopes) / np.sqrt(np.sum(slopes**2, axis=-1, keepdims=True))
            directed = np.einsum("cpd,kd->kcp", rates[i], normal)
            by_law = np.einsum("kc,kcp->kp", rows, directed) @ along
            rest = np.sum(normal * (target[i] - rows @ controls[i]), axis=-1)
            normal_matrix += np.kron(by_law.T @ by_law, np.outer(across[i], across[i]))
            right += np.kron(by_law.T @ rest, across[i])
        # a triangle of the normal equations stands for all rows; the ridge is far below what the points tell
        triangle = np.linalg.cholesky(normal_matrix + 1e-12 * np.trace(normal_matrix) * np.eye(law.size)).T
        low = (least - law).ravel() - 1e-12
        wanted = np.linalg.solve(triangle.T, right)
        step = lsq_linear(triangle, wanted, bounds=(low, np.full(law.size, 10.0)), method="bvls")
        law = np.maximum(law + step.x.reshape(law.shape), least)
    return law


def least_thickness(count: int, spanwise: int, radii: tuple[Reals, Reals], v: Reals, places: Reals) -> Reals:
    """Smallest control points (count, spanwise) of a thickness law, so that its ends can hold radii (m,) at v (m,)."""
    least = np.full((count, spanwise), LEAST)
    shares = law_basis(spanwise, v)
    for row, values in ((0, radii[0]), (-1, radii[1])):
        # the advance of the first sample is about its place
        height = edge_height(places[2] * np.ones(len(v)), 1.0 / values)
        least[row] = ROOM * np.max(np.where(shares > 0.3, height[:, None], 0.0), axis=0)
    return np.maximum(least, LEAST)


def held_radii(camber: Reals, thickness: tuple[Reals, Reals], places: Reals) -> tuple[Reals, Reals]:
    """Largest radii (m,) of both edges that thicknesses (m, k) at the inner places can hold on both sides."""
    found = []
    for end in (0, 1):
        most = []
        for values, upper in zip(thickness, (True, False), strict=True):
            advance = advances(camber, places, values, upper)[end]
            unit_height = edge_height(np.maximum(advance, 0.0), np.ones(len(camber)))
            beside = values[:, 0 if end == 0 else -1]
            most.append(np.where(advance > 0.0, (beside / np.maximum(unit_height, 1e-12)) ** 2, 0.0))
        found.append(np.minimum(*most))
    return found[0], found[1]


def _side(
    camber: Reals, radii: tuple[Reals, Reals], values: Reals, places: Reals, normals: Reals, upper: bool
) -> tuple[Reals, Reals]:
    """Control points (m, n, 2) of sides, and their derivatives (m, n, p, 2) by the thicknesses at the p samples."""
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


def _nearest(curve: Reals, points: Reals) -> Reals:
    """Parameters (k,) of the places of a dense polyline nearest to points (k, 2)."""
    from scipy.spatial import cKDTree

    index = cKDTree(curve).query(points)[1]
    index = np.clip(index, 1, len(curve) - 2)
    before, after = curve[index] - curve[index - 1], curve[index + 1] - curve[index]
    offset = points - curve[index]
    forward = np.sum(offset * after, axis=-1) / np.sum(after**2, axis=-1)
    backward = np.sum(offset * before, axis=-1) / np.sum(before**2, axis=-1)
    s = _DENSE[index] + np.where(
        forward > 0.0,
        np.clip(forward, 0.0, 1.0) * (_DENSE[index + 1] - _DENSE[index]),
        np.clip(backward, -1.0, 0.0) * (_DENSE[index] - _DENSE[index - 1]),
    )
    return np.clip(s, 0.0, 1.0)
