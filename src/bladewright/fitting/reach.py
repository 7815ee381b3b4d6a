"""How far the edges of a design may stand out of its cloud: no further than the points there are apart.

Without it an edge that sticks out as a thin fin costs nothing, as it is nobody's nearest place.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.fitting.feet import Feet, placed
from bladewright.fitting.model import Shape
from bladewright.nurbs.basis import Reals

WINDOWS = 12
"""parts of the span in which the outermost point is sought"""
FEWEST = 6
"""points that a window needs"""
NEAR = 0.5
"""how far from an edge, in u, a point may be the outermost"""
APART = 1.5
"""allowed distance, of that between neighbours"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Reach:
    """Points near both edges, each the outermost of its part of the span."""

    points: Reals
    """(m, d) [m]"""
    u: Reals
    """(m,) of the edge: 0 or 1"""
    v: Reals
    """(m,)"""
    allowed: Reals
    """(m,) [m]"""

    def edges(self, shape: Shape) -> Feet:
        """The places of the edges beside the points."""
        return placed(self.points, shape.sides, np.zeros(len(self.u), dtype=np.intp), self.u, self.v)

    def excess(self, edges: Feet) -> Reals:
        """By how much edges stand out further than allowed (m,) [m]; negative where they do not."""
        return np.asarray(-np.sum(edges.miss * edges.normals, axis=-1) - self.allowed)


def reach_of(points: Reals, on: Feet, rows: NDArray[np.bool_]) -> Reach:
    """The outermost points at each edge, of those in `rows` (n,)."""
    chosen: list[int] = []
    ends: list[float] = []
    allowed: list[float] = []
    solid = points.shape[1] == 3
    windows = WINDOWS if solid else 1
    for end in (0.0, 1.0):
        inward = np.abs(on.u - end)
        for window in range(windows):
            inside = np.flatnonzero(
                rows & (inward < NEAR) & (on.v >= window / windows) & (on.v <= (window + 1) / windows)
            )
            if len(inside) < FEWEST:
                continue
            order = inside[np.argsort(inward[inside])]
            near = points[order[: 2 * FEWEST]]
            apart = cKDTree(points[inside]).query(near, k=3)[0][:, 1:]
            chosen.append(int(order[0]))
            ends.append(end)
            allowed.append(APART * float(np.median(apart[:, -1])))
    at = np.array(chosen, dtype=np.intp)
    return Reach(points=points[at], u=np.array(ends), v=on.v[at], allowed=np.array(allowed))
