"""Whether the exact halves of a wall fold, sampled in their plane before anything is built."""

from collections.abc import Mapping

import numpy as np

from bladewright.domain.knots import PIECES
from bladewright.domain.wall import WallHalf
from bladewright.numerics.elementary import cross2
from bladewright.nurbs.basis import Reals

ROOMY = 0.05
"""least Jacobian, of its median, above which a patch is taken for far from folding"""
_EVEN = np.linspace(0.0, 1.0, 31)
_ALONG = np.unique(np.concatenate([np.linspace(0.0, 1.0, 61), 0.1 * _EVEN**2, 1.0 - 0.1 * _EVEN**2]))
_ACROSS = np.concatenate([np.linspace(0.0, 0.1, 8)[:-1], np.linspace(0.1, 1.0, 22)])


def least_share(walls: Mapping[str, WallHalf]) -> float:
    """The least Jacobian of the halves in (m', theta), of each piece's median, by differences between samples."""
    return min(_least(wall, piece) for wall in walls.values() for piece in PIECES)


def _least(wall: WallHalf, piece: str) -> float:
    t: Reals = _ALONG if piece == "blade" else _EVEN
    points = np.real(wall.plane(piece, t, _ACROSS))
    while points.ndim > 3:
        points = points[0]
    along = np.gradient(points, t, axis=0, edge_order=2)
    across = np.gradient(points, _ACROSS, axis=1, edge_order=2)
    jacobian = wall.sign * cross2(along, across)
    return float(np.min(jacobian) / np.median(jacobian))
