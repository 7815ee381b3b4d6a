"""Quality of linear tetrahedra, from their nodes alone."""

from typing import cast

import numpy as np
from numpy.typing import NDArray

from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals

Indices = NDArray[np.intp]
"""(k, 3) or (k, 4) indices of the nodes of triangles or tetrahedra."""

_REGULAR = np.array([[1.0, 0.5, 0.5], [0.0, np.sqrt(3.0) / 2.0, np.sqrt(3.0) / 6.0], [0.0, 0.0, np.sqrt(2.0 / 3.0)]])
"""Edges of the regular tetrahedron from its first node, as columns."""
FACETS = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
"""Nodes of the four facets of a tetrahedron, counter-clockwise as seen from outside."""


def volumes(nodes: Reals, tetrahedra: Indices) -> Reals:
    """Signed volumes (k,): negative where a tetrahedron is inverted."""
    edges = nodes[tetrahedra[:, 1:]] - nodes[tetrahedra[:, :1]]
    return np.asarray(np.linalg.det(edges) / 6.0)


def condition_numbers(nodes: Reals, tetrahedra: Indices) -> Reals:
    """Signed inverse condition numbers (k,) of the maps from the regular tetrahedron, gmsh's minSICN.

    1 for a regular tetrahedron, 0 for a flat one, negative for an inverted one: 3 / (|J| |J^-1|) in Frobenius norms,
    with the sign of det J. Knupp 2001, SIAM J. Sci. Comput. 23, 193.
    """
    edges = np.swapaxes(nodes[tetrahedra[:, 1:]] - nodes[tetrahedra[:, :1]], 1, 2)
    jacobian = edges @ np.linalg.inv(_REGULAR)
    columns = [jacobian[:, :, i] for i in range(3)]
    # |J^-1| = |adj J| / |det J|, and the rows of the adjugate are cross products of the columns: no division by zero.
    adjugate = np.stack([np.cross(columns[i - 2], columns[i - 1]) for i in range(3)], axis=1)
    norms = length(jacobian.reshape(-1, 9)) * length(adjugate.reshape(-1, 9))
    determinant = np.sum(columns[0] * adjugate[:, 0], axis=1)
    return np.asarray(3.0 * determinant / np.where(norms > 0.0, norms, 1.0))


def radius_ratios(nodes: Reals, tetrahedra: Indices) -> Reals:
    """Three times the inscribed over the circumscribed radius (k,), gmsh's gamma: 1 regular, 0 flat."""
    points = nodes[tetrahedra]
    areas = sum(
        0.5 * length(np.cross(points[:, b] - points[:, a], points[:, c] - points[:, a])) for a, b, c in FACETS.tolist()
    )
    opposite = [
        length(points[:, a] - points[:, b]) * length(points[:, c] - points[:, d])
        for a, b, c, d in ((0, 1, 2, 3), (0, 2, 1, 3), (0, 3, 1, 2))
    ]
    # Crelle: 6 V R is the area of the triangle whose sides are the three products of opposite edges.
    p, q, r = opposite
    heron = np.maximum(0.0, (p + q + r) * (q + r - p) * (p + r - q) * (p + q - r))
    crelle = 0.25 * np.sqrt(heron)
    size = volumes(nodes, tetrahedra)
    return cast(Reals, np.where(crelle > 0.0, 54.0 * size**2 / np.where(crelle > 0.0, areas * crelle, 1.0), 0.0))
