"""Whether the exact halves of a wall fold, sampled in their plane before anything is built."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from bladewright.domain.knots import BLADE_AT, PIECES
from bladewright.domain.wall import WallHalf
from bladewright.numerics.elementary import cross2
from bladewright.nurbs.basis import Reals

ROOMY = 0.06
"""least Jacobian, of its median, above which a patch is taken for far from folding"""
_EVEN = np.linspace(0.0, 1.0, 31)
_ALONG = np.unique(np.concatenate([np.linspace(0.0, 1.0, 61), 0.1 * _EVEN**2, 1.0 - 0.1 * _EVEN**2]))
_ACROSS = np.concatenate([np.linspace(0.0, 0.1, 8)[:-1], np.linspace(0.1, 1.0, 22)])


class Least(NamedTuple):
    """Where a wall's half is the nearest to folding."""

    share: float
    """its Jacobian there in (m', theta), of the piece's median"""
    name: str
    u: float
    v: float


def least_share(walls: Mapping[str, WallHalf]) -> Least:
    """The least Jacobian of the halves, by differences between samples."""
    return min(_least(name, wall, place) for name, wall in walls.items() for place in range(len(PIECES)))


def _least(name: str, wall: WallHalf, place: int) -> Least:
    piece = PIECES[place]
    t: Reals = _ALONG if piece == "blade" else _EVEN
    points = np.real(wall.plane(piece, t, _ACROSS))
    while points.ndim > 3:
        points = points[0]
    along = np.gradient(points, t, axis=0, edge_order=2)
    across = np.gradient(points, _ACROSS, axis=1, edge_order=2)
    jacobian = wall.sign * cross2(along, across)
    i, j = np.unravel_index(int(np.argmin(jacobian)), jacobian.shape)
    low, high = (0.0, *BLADE_AT, 1.0)[place : place + 2]
    u = float(low + (high - low) * t[i])
    return Least(float(jacobian[i, j] / np.median(jacobian)), name, u, float(_ACROSS[j]))
