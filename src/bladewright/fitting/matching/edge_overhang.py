"""How far the edges of a design may stand out of its cloud: no further than the points there are apart.

Without this limit an edge that sticks out as a thin fin costs nothing, as it is nobody's nearest place.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.fitting.matching.footpoints import Footpoints, Side, footpoints_at
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.surface import Surface

STATIONS: Reals = np.concatenate([[0.0], np.linspace(1.0 / 32.0, 31.0 / 32.0, 16), [1.0]])
"""places along the span, v, at which each edge is looked at; more add rows that say the same."""
COVERED_SPAN = 0.05
"""distance of the nearest point from an end of the span, in v, up to which the cloud shows that end: it may show a part
of the span only."""
SPANWISE_WEIGHT = 0.2
"""factor of distances along the edge while the nearest point is sought: a cloud may have few rows along the span."""
NEIGHBOURS = 6
"""points beside an edge whose distances from each other are looked at."""
ALLOWED_SPACINGS, ALLOWED_SPACINGS_EXACT = 1.5, 15.0
"""allowed overhang in spacings of the points beside the edge, and in a cloud that is exact (`ALLOWED_SPACINGS_EXACT`),
where the true edge must cost nothing even by chance: it had cost 2.4e-3 of the chord on an impeller and on Rotor 67
(design/matching.md)."""

EDGE_ENDS = {"leading_edge": 0.0, "trailing_edge": 1.0}
"""u of both edges"""


@dataclass(frozen=True, kw_only=True, eq=False)
class EdgeOverhang:
    """Places along both edges, and beside each the nearest point of the cloud."""

    points: Reals
    """(m, d) the nearest points of the cloud [m]"""
    u: Reals
    """(m,) of the edge: 0 or 1"""
    v: Reals
    """(m,) of the places along the edges"""
    allowed: Reals
    """(m,) overhang that costs nothing [m]; infinite where the cloud does not show the edge"""
    normals: Reals
    """(m, d) out of the blade, held: a nose turns them as it moves, where the points beside it may lie far along it"""

    def looks_at(self, u: float) -> bool:
        """Whether the cloud shows the edge at u."""
        return bool(np.any(np.isfinite(self.allowed[self.u == u])))

    def edges(self, sides: Sequence[Side]) -> Footpoints:
        """The places on the edges beside the points, as footpoints with the held normals."""
        found = footpoints_at(self.points, sides, np.zeros(len(self.u), dtype=np.intp), self.u, self.v)
        return replace(found, normals=self.normals)

    def excess(self, edges: Footpoints) -> Reals:
        """By how much edges stand out further than allowed (m,) [m]; negative where they do not."""
        return np.asarray(-np.sum(edges.miss * edges.normals, axis=-1) - self.allowed)


def edge_overhang_of(
    points: Reals,
    sides: Sequence[Side],
    rows: NDArray[np.bool_],
    *,
    exact: bool = False,
    cut_edges: Collection[str] = (),
) -> EdgeOverhang:
    """The overhang of both edges over the points in `rows` (n,); loose limits for an `exact` cloud, none at cut edges.

    By chance a point may be further from an edge than others from each other, and the true edge must cost nothing.
    """
    upper, cloud = sides[0], points[rows]
    stations: Reals = STATIONS if isinstance(upper, Surface) else np.zeros(1)
    u, v = np.repeat([0.0, 1.0], len(stations)), np.tile(stations, 2)
    side = np.zeros(len(u), dtype=np.intp)
    edges = footpoints_at(np.zeros((len(u), points.shape[1])), sides, side, u, v)
    chosen, shown = [], ~np.isin(u, [end for name, end in EDGE_ENDS.items() if name in cut_edges])
    for i, at in enumerate(edges.points):
        offset = cloud - at
        away = np.sum(offset**2, axis=-1)
        if isinstance(upper, Surface):
            along = np.asarray(upper.derivative(u[i : i + 1], v[i : i + 1], 0, 1))[0]
            way = offset @ along / (along @ along)
            away -= (1.0 - SPANWISE_WEIGHT**2) * way**2 * (along @ along)
            shown[i] &= 0.0 < v[i] < 1.0 or abs(way[np.argmin(away)]) < COVERED_SPAN
        chosen.append(int(np.argmin(away)))
    nearest = cloud[chosen]
    tree = cKDTree(cloud)
    _, around = tree.query(nearest, k=NEIGHBOURS)
    spacings = tree.query(cloud[around.ravel()], k=3)[0][:, -1]
    most = ALLOWED_SPACINGS_EXACT if exact else ALLOWED_SPACINGS
    allowed = np.where(shown, most * np.median(spacings.reshape(len(chosen), NEIGHBOURS), axis=1), np.inf)
    return EdgeOverhang(points=nearest, u=u, v=v, allowed=allowed, normals=edges.normals)
