"""The ring of the duct between inlet and outlet, by quadrature over its meridional outline."""

from itertools import pairwise

import numpy as np
from numpy.polynomial import legendre

from bladewright.domain.duct import Duct
from bladewright.numerics.elementary import Array
from bladewright.numerics.quadrature import gauss, panels
from bladewright.nurbs.basis import Reals

POINTS = 16
"""Gauss points on a polynomial piece of an outline"""


def annulus_volume(duct: Duct, span_joints: Reals) -> Array:
    """Volume () [m^3] of the ring between hub, shroud, inlet and outlet; of a strip one metre wide in a cascade.

    Pappus and Green: the integral of pi r^2 dx around the meridional outline. `span_joints` are the places along v
    where inlet and outlet lose derivatives.
    """
    ends = np.array([duct.low, duct.high])
    u, along = panels(np.unique([*ends, *duct.edges, *duct.joints_within()]), POINTS)
    walls = duct.lines(np.array([0.0, 1.0]))
    point, slope = walls.position(u), walls.position(u, 1)
    flux = np.sum(along * _height(duct, point[..., 1]) * slope[..., 0], axis=-1)
    total: Array = flux[..., 0] - flux[..., 1]
    pieces = np.unique([0.0, *span_joints, 1.0])
    for low, high in pairwise(pieces):
        lines = duct.lines(np.concatenate([[0.0], low + (high - low) * NODES, [1.0]])).position(ends)[..., 1:-1, :, :]
        passed = np.sum(_WEIGHTS[:, None] * _height(duct, lines[..., 1]) * (_DERIVATIVE @ lines[..., 0]), axis=-2)
        total = total + passed[..., 1] - passed[..., 0]
    return -total


def _by_values(nodes: Reals) -> Reals:
    """The matrix that takes a polynomial's values at nodes to its derivative's there."""
    powers = legendre.legvander(2.0 * nodes - 1.0, len(nodes) - 1)
    slopes = [2.0 * legendre.legval(2.0 * nodes - 1.0, legendre.legder(row)) for row in np.eye(len(nodes))]
    return np.asarray(np.stack(slopes, axis=-1) @ np.linalg.inv(powers))


def _height(duct: Duct, radius: Array) -> Array:
    return np.pi * radius**2 if duct.revolved else radius


NODES, _WEIGHTS = gauss(POINTS)
_DERIVATIVE = _by_values(NODES)
