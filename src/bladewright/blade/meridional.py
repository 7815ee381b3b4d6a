"""The meridional channel as native geometry: four curves in transfinite interpolation, and past its ends."""

from dataclasses import dataclass
from functools import lru_cache
from math import comb, factorial

import numpy as np

from bladewright.blade.channel import Channel
from bladewright.designs import Points
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.nurbs.curve import Curve
from bladewright.section.laws import stacked

_EDGES = ("leading_edge", "trailing_edge")


@dataclass(frozen=True, kw_only=True)
class Meridional:
    """The channel's map (u, v) -> (x, r) in metres; outside 0 <= u <= 1 hub and shroud continue their own polynomials.

    Control points are (..., n, 2): a leading batch axis is carried through.
    Reference: Agromayor et al. 2021, eq. 16 (Gordon and Hall 1973).
    """

    leading_edge: Array
    trailing_edge: Array
    hub: Array
    shroud: Array
    degree: int

    def knots(self, wall: str) -> Reals:
        """Clamped uniform knots of one of the four curves."""
        count = getattr(self, wall).shape[-2]
        return uniform_knots(count, min(count - 1, self.degree))

    def degree_of(self, wall: str) -> int:
        """Degree of one of the four curves."""
        return min(getattr(self, wall).shape[-2] - 1, self.degree)

    def curve(self, wall: str) -> Curve:
        """One of the four curves as a native curve in (x, r)."""
        return Curve(control_points=getattr(self, wall), knots=self.knots(wall), degree=self.degree_of(wall))

    def joints(self) -> Reals:
        """Inner knots of hub and shroud along u."""
        inner = np.concatenate([self.knots("hub"), self.knots("shroud")])
        return np.unique(inner[(inner > 0.0) & (inner < 1.0)].round(14))

    def slopes(self, u: Reals, v: Reals) -> tuple[Array, Array]:
        """Derivatives (..., len(v), len(u), 2) of (x, r) by u and by v."""

        def walls(order: int) -> list[Array]:
            return [self._values(wall, u, order)[..., None, :, :] for wall in ("hub", "shroud")]

        def edges(order: int) -> list[Array]:
            return [self._values(edge, v, order)[..., :, None, :] for edge in ("leading_edge", "trailing_edge")]

        a, b = u[:, None], v[:, None, None]
        ends = [getattr(self, edge)[..., end, :][..., None, None, :] for edge in _EDGES for end in (0, -1)]
        (hub, shroud), (start, end) = walls(0), edges(0)
        (hub_slope, shroud_slope), (start_slope, end_slope) = walls(1), edges(1)
        by_u = end - start + (1.0 - b) * hub_slope + b * shroud_slope
        by_u = by_u - ((1.0 - b) * (ends[2] - ends[0]) + b * (ends[3] - ends[1]))
        by_v = (1.0 - a) * start_slope + a * end_slope + shroud - hub
        by_v = by_v - ((1.0 - a) * (ends[1] - ends[0]) + a * (ends[3] - ends[2]))
        return by_u, by_v

    def _values(self, wall: str, at: Reals, order: int) -> Array:
        return basis(self.knots(wall), self.degree_of(wall), at, order) @ getattr(self, wall)

    def stream_polynomials(self, v: Reals, centres: Reals) -> Array:
        """Coefficients (..., len(v), len(centres), k, 2) of the stream lines' powers of u - centre.

        Each row holds on the knot span that its centre lies in.
        """
        powers = max(self.degree_of("hub"), self.degree_of("shroud"), 1) + 1
        hub, shroud = (self._powers(wall, centres, powers)[..., None, :, :, :] for wall in ("hub", "shroud"))
        w = v[:, None, None, None]
        total = (1.0 - w) * hub + w * shroud
        edges = []
        for name in _EDGES:
            points = getattr(self, name)
            values = basis(self.knots(name), self.degree_of(name), v) @ points
            ruled = (1.0 - v)[:, None] * points[..., :1, :] + v[:, None] * points[..., -1:, :]
            edges.append((values - ruled)[..., None, :])
        start, end = edges
        total = np.array(np.broadcast_to(total, np.broadcast_shapes(total.shape, (*start.shape[:-2], 1, powers, 2))))
        total[..., 0, :] += start + centres[:, None] * (end - start)
        total[..., 1, :] += end - start
        return total

    def _powers(self, wall: str, centres: Reals, powers: int) -> Array:
        points = getattr(self, wall)
        return _power_rows(points.shape[-2], self.degree_of(wall), tuple(centres), powers) @ points[..., None, :, :]


@lru_cache(maxsize=64)
def _power_rows(count: int, degree: int, centres: tuple[float, ...], powers: int) -> Reals:
    """Rows (len(centres), powers, count) that take control points to powers of u - centre on the centre's span."""
    knots = uniform_knots(count, degree)
    rows = np.zeros((len(centres), powers, count))
    inner = np.unique(knots)
    for i, centre in enumerate(centres):
        span = int(np.clip(np.searchsorted(inner, centre, side="right") - 1, 0, len(inner) - 2))
        middle = float(inner[span] + inner[span + 1]) / 2.0
        series = [basis(knots, degree, [middle], k)[0] / factorial(k) for k in range(degree + 1)]
        for k in range(degree + 1):
            terms = [comb(j, k) * (centre - middle) ** (j - k) * series[j] for j in range(k, degree + 1)]
            rows[i, k] = np.sum(terms, axis=0)
    return rows


def meridional(channel: Channel, metre: float) -> Meridional:
    """The native channel of a design whose length unit is `metre` metres."""
    edges = {name: _array(getattr(channel, name), metre) for name in ("leading_edge", "trailing_edge")}
    walls = {}
    for name, end in (("hub", 0), ("shroud", -1)):
        corners = [edges[edge][..., end : end + 1 or None, :] for edge in ("leading_edge", "trailing_edge")]
        inner = [_array(getattr(channel, name), metre)] if getattr(channel, name) else []
        rows = [corners[0], *inner, corners[1]]
        batch = np.broadcast_shapes(*[row.shape[:-2] for row in rows])
        walls[name] = np.concatenate([np.broadcast_to(row, (*batch, *row.shape[-2:])) for row in rows], axis=-2)
    return Meridional(**edges, **walls, degree=channel.degree)


def _array(points: Points, metre: float) -> Array:
    flat = stacked([coordinate for point in points for coordinate in point])
    return metre * flat.reshape(*flat.shape[:-1], len(points), 2)
