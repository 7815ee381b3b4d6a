"""How far the edges of a design may stand out of its cloud: no further than the points there are apart.

Without it an edge that sticks out as a thin fin costs nothing, as it is nobody's nearest place.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.fitting.matching.feet import Feet, Side, placed
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface

STATIONS: Reals = np.concatenate([[0.0], np.linspace(1.0 / 32.0, 31.0 / 32.0, 16), [1.0]])
"""places along the span at which each edge is looked at"""
COVERED = 0.05
"""how far, in v, the nearest point may be from an end of the span: a cloud may show a part of the span only"""
BESIDE = 0.2
"""what a distance along the edge counts while the nearest point is sought: a cloud may have few rows"""
AROUND = 6
"""points whose distances from each other are looked at"""
APART, FAR = 1.5, 15.0
"""allowed distance, of that between neighbours, and the same in a cloud that is exact"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Reach:
    """Places along both edges, and beside each the nearest point."""

    points: Reals
    """(m, d) [m]"""
    u: Reals
    """(m,) of the edge: 0 or 1"""
    v: Reals
    """(m,)"""
    allowed: Reals
    """(m,) [m]; infinite where the cloud does not tell"""

    def edges(self, sides: Sequence[Side]) -> Feet:
        """The places on the edges beside the points."""
        return placed(self.points, sides, np.zeros(len(self.u), dtype=np.intp), self.u, self.v)

    def excess(self, edges: Feet) -> Reals:
        """By how much edges stand out further than allowed (m,) [m]; negative where they do not."""
        return np.asarray(-np.sum(edges.miss * edges.normals, axis=-1) - self.allowed)


def reach_of(points: Reals, sides: Sequence[Side], rows: NDArray[np.bool_], *, exact: bool = False) -> Reach:
    """The points beside each edge, of those in `rows` (n,); of an `exact` cloud an edge is only kept from running off.

    By chance a point may be further from an edge than others from each other, and the true edge must cost nothing.
    """
    upper, cloud = sides[0], points[rows]
    stations: Reals = STATIONS if isinstance(upper, Surface) else np.zeros(1)
    u, v = np.repeat([0.0, 1.0], len(stations)), np.tile(stations, 2)
    side = np.zeros(len(u), dtype=np.intp)
    edges = placed(np.zeros((len(u), points.shape[1])), sides, side, u, v)
    chosen, shown = [], np.ones(len(u), dtype=bool)
    for i, at in enumerate(edges.points):
        off = cloud - at
        away = np.sum(off**2, axis=-1)
        if isinstance(upper, Surface):
            along = np.asarray(upper.derivative(u[i : i + 1], v[i : i + 1], 0, 1))[0]
            way = off @ along / (along @ along)
            away -= (1.0 - BESIDE**2) * way**2 * (along @ along)
            shown[i] = 0.0 < v[i] < 1.0 or abs(way[np.argmin(away)]) < COVERED
        chosen.append(int(np.argmin(away)))
    beside = cloud[chosen]
    tree = cKDTree(cloud)
    _, around = tree.query(beside, k=AROUND)
    apart = tree.query(cloud[around.ravel()], k=3)[0][:, -1]
    most = FAR if exact else APART
    allowed = np.where(shown, most * np.median(apart.reshape(len(chosen), AROUND), axis=1), np.inf)
    return Reach(points=beside, u=u, v=v, allowed=allowed)
