"""The meridional channel as native geometry: four curves in transfinite interpolation, and past its ends."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import lru_cache
from math import comb, factorial
from typing import ClassVar, Self

import numpy as np

from bladewright.blade.design.flow_path import Channel
from bladewright.designs import Points
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross2
from bladewright.nurbs.basis import Reals, basis, uniform_knots
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import extended
from bladewright.section.laws import stacked


class ChannelLine(ABC):
    """One of the four curves of a channel by the channel's u or v, which runs over [0, 1] between the corners."""

    given_by: ClassVar[str]
    """the part of the design that gives it"""

    @property
    @abstractmethod
    def degree(self) -> int:
        """Degree of the polynomials between its joints."""

    @property
    @abstractmethod
    def corners(self) -> tuple[Array, Array]:
        """Points (..., 2) at 0 and at 1."""

    @abstractmethod
    def values(self, at: Reals, order: int = 0) -> Array:
        """Points, or derivatives (..., m, 2), at real places (m,), also past 0 and 1."""

    @abstractmethod
    def joints(self) -> Reals:
        """Places at which the polynomials end."""

    @abstractmethod
    def smoothness(self) -> list[tuple[float, int]]:
        """Places between 0 and 1 at which derivatives are lost, and how many are kept there."""

    @abstractmethod
    def powers(self, centres: Reals, count: int) -> Array:
        """Coefficients (..., len(centres), count, 2) of the powers of u - centre."""

    @abstractmethod
    def real(self) -> Self:
        """The same without imaginary parts and batch."""

    @abstractmethod
    def curve(self) -> Curve:
        """The whole curve, as the design gives it, as a native one over its own parameter."""

    @abstractmethod
    def curve_over(self, low: float, high: float) -> Curve:
        """The same with what it is continued by from `low` to `high` in u."""

    @abstractmethod
    def own_parameters(self, u: Reals) -> Reals:
        """Parameters (k,) of it at u (k,), of the real design."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ChannelCurve(ChannelLine):
    """A B-spline in (x, r), taken from `start` to `end` of its own parameter."""

    given_by: ClassVar[str] = "channel"

    points: Array
    """(..., n, 2) control points in metres"""
    knots: Reals
    """(n + degree + 1,) clamped over [0, 1]"""
    start: Array | None = None
    """(...) own parameter where an edge of the channel starts, where the blade has a clearance there; none: 0"""
    end: Array | None = None
    """(...) own parameter where it ends; none: 1"""

    @property
    def degree(self) -> int:
        """Degree of the B-spline."""
        return len(self.knots) - self.points.shape[-2] - 1

    @property
    def corners(self) -> tuple[Array, Array]:
        """The first and the last control point (..., 2)."""
        return self.points[..., 0, :], self.points[..., -1, :]

    def values(self, at: Reals, order: int = 0) -> Array:
        """Points, or derivatives (..., m, 2), at real places (m,) of the piece, which runs over [0, 1]."""
        if self.start is None and self.end is None:
            return basis(self.knots, self.degree, at, order) @ self.points
        low, high = self._ends()
        own = low[..., None] + (high - low)[..., None] * at
        real = np.real(own[(0,) * (own.ndim - 1)])
        found = basis(self.knots, self.degree, real, order) @ self.points
        slope = basis(self.knots, self.degree, real, order + 1) @ self.points
        return (found + (own - real)[..., None] * slope) * ((high - low) ** order)[..., None, None]

    def joints(self) -> Reals:
        """Inner knots of the piece, as often as they occur; their real parts, where the ends are complex."""
        inner = self.knots
        if self.start is not None or self.end is not None:
            low, high = (float(np.real(np.ravel(end)[0])) for end in self._ends())
            inner = (inner - low) / (high - low)
        return inner[(inner > 0.0) & (inner < 1.0)]

    def smoothness(self) -> list[tuple[float, int]]:
        """Inner knots of the piece, which are single."""
        return [(float(joint), self.degree - 1) for joint in self.joints()]

    def cut(self, end: str, at: Array) -> "ChannelCurve":
        """The piece that has its `start` or its `end` at a place (...) of this one."""
        low, high = self._ends()
        return replace(self, **{end: low + (high - low) * at})

    def powers(self, centres: Reals, count: int) -> Array:
        """Coefficients (..., len(centres), count, 2) of the whole curve's powers of u - centre.

        Each row holds on the knot span that its centre lies in.
        """
        rows = _power_rows(self.knots.tobytes(), self.degree, tuple(centres), count)
        return rows @ self.points[..., None, :, :]

    def real(self) -> "ChannelCurve":
        def first(values: Array | None, axes: int) -> Array | None:
            return None if values is None else np.asarray(np.real(values[(0,) * (np.ndim(values) - axes)]))

        points = np.real(self.points[(0,) * (self.points.ndim - 2)])
        return ChannelCurve(points=points, knots=self.knots, start=first(self.start, 0), end=first(self.end, 0))

    def curve(self) -> Curve:
        return Curve(control_points=self.points, knots=self.knots, degree=self.degree)

    def curve_over(self, low: float, high: float) -> Curve:
        return extended(self.curve(), low, high)

    def own_parameters(self, u: Reals) -> Reals:
        low, high = (float(np.real(np.ravel(end)[0])) for end in self._ends())
        return low + (high - low) * u

    def _ends(self) -> tuple[Array, Array]:
        return np.asarray(0.0 if self.start is None else self.start), np.asarray(1.0 if self.end is None else self.end)


@dataclass(frozen=True, kw_only=True)
class TransfiniteChannel:
    """The channel's map (u, v) -> (x, r) in metres; outside 0 <= u <= 1 hub and shroud continue as they do.

    Control points are (..., n, 2): a leading batch axis is carried through. Hub and shroud end on the edges.
    Reference: Agromayor et al. 2021, eq. 16 (Gordon and Hall 1973).
    """

    leading_edge: ChannelCurve
    trailing_edge: ChannelCurve
    hub: ChannelLine
    shroud: ChannelLine

    def real(self) -> "TransfiniteChannel":
        """The same without imaginary parts and batch."""
        return TransfiniteChannel(
            leading_edge=self.leading_edge.real(),
            trailing_edge=self.trailing_edge.real(),
            hub=self.hub.real(),
            shroud=self.shroud.real(),
        )

    def line(self, name: str) -> ChannelLine:
        """One of the four curves by its name."""
        found: ChannelLine = getattr(self, name)
        return found

    def knots(self, name: str) -> Reals:
        """Knots of one of the four curves over its own parameter."""
        return self.curve(name).knots

    def curve(self, name: str) -> Curve:
        """One of the four curves as a native curve in (x, r), an edge whole where the channel has a piece of it."""
        return self.line(name).curve()

    def joints(self) -> Reals:
        """Joints of hub and shroud along u."""
        return np.unique(np.concatenate([self.hub.joints(), self.shroud.joints()]).round(14))

    def slopes(self, u: Reals, v: Reals) -> tuple[Array, Array]:
        """Derivatives (..., len(v), len(u), 2) of (x, r) by u and by v."""

        def walls(order: int) -> list[Array]:
            return [wall.values(u, order)[..., None, :, :] for wall in (self.hub, self.shroud)]

        def edges(order: int) -> list[Array]:
            return [edge.values(v, order)[..., :, None, :] for edge in (self.leading_edge, self.trailing_edge)]

        a, b = u[:, None], v[:, None, None]
        ends = [wall.corners[end][..., None, None, :] for end in (0, 1) for wall in (self.hub, self.shroud)]
        (hub, shroud), (start, end) = walls(0), edges(0)
        (hub_slope, shroud_slope), (start_slope, end_slope) = walls(1), edges(1)
        by_u = end - start + (1.0 - b) * hub_slope + b * shroud_slope
        by_u = by_u - ((1.0 - b) * (ends[2] - ends[0]) + b * (ends[3] - ends[1]))
        by_v = (1.0 - a) * start_slope + a * end_slope + shroud - hub
        by_v = by_v - ((1.0 - a) * (ends[1] - ends[0]) + a * (ends[3] - ends[2]))
        return by_u, by_v

    def at(self, u: Reals, v: Reals) -> tuple[Array, Array]:
        """(x, r) at pairs of u and v (m,), and its derivative by v, (..., m, 2) each."""
        a, b = u[:, None], v[:, None]
        hub, shroud = self.hub.values(u), self.shroud.values(u)
        corners = [wall.corners[end][..., None, :] for end in (0, 1) for wall in (self.hub, self.shroud)]
        ruled = [(1.0 - a) * corners[k] + a * corners[k + 2] for k in (0, 1)]
        start, end = self.leading_edge, self.trailing_edge
        point = (1.0 - a) * start.values(v) + a * end.values(v)
        point = point + (1.0 - b) * (hub - ruled[0]) + b * (shroud - ruled[1])
        across = (1.0 - a) * start.values(v, 1) + a * end.values(v, 1) + (shroud - ruled[1]) - (hub - ruled[0])
        return point, across

    def stream_polynomials(self, v: Reals, centres: Reals) -> Array:
        """Coefficients (..., len(v), len(centres), k, 2) of the stream lines' powers of u - centre.

        Each row holds on the knot span that its centre lies in.
        """
        powers = max(self.hub.degree, self.shroud.degree, 1) + 1
        hub, shroud = (wall.powers(centres, powers)[..., None, :, :, :] for wall in (self.hub, self.shroud))
        w = v[:, None, None, None]
        total = (1.0 - w) * hub + w * shroud
        start, end = (bow[..., None, :] for bow in self.bows(v))
        total = np.array(np.broadcast_to(total, np.broadcast_shapes(total.shape, (*start.shape[:-2], 1, powers, 2))))
        total[..., 0, :] += start + centres[:, None] * (end - start)
        total[..., 1, :] += end - start
        return total

    def bows(self, v: Reals) -> tuple[Array, Array]:
        """How far (..., m, 2) the edges at v (m,) are off the straight lines between their ends."""
        found = []
        for place, edge in enumerate((self.leading_edge, self.trailing_edge)):
            low, high = (wall.corners[place][..., None, :] for wall in (self.hub, self.shroud))
            found.append(edge.values(v) - ((1.0 - v)[:, None] * low + v[:, None] * high))
        return found[0], found[1]

    def check_folds(self, before: float = 0.0, after: float = 0.0) -> None:
        """Refuse a map (u, v) -> (x, r) that is not one to one.

        It is looked at from `before` the leading to `after` the trailing edge, in u.
        """
        u, v = np.linspace(-before, 1.0 + after, 41), np.linspace(0.0, 1.0, 21)
        along, across = (np.real(part) for part in self.slopes(u, v))
        jacobian = cross2(along, across)
        size = np.median(np.sqrt(np.sum(along**2, axis=-1) * np.sum(across**2, axis=-1)))
        share = jacobian / size
        if np.all(share < 0.0):
            raise DesignError(
                "channel: its ends are swapped: with u from leading to trailing edge and v from hub to shroud it must "
                "turn like x to r; exchange leading_edge with trailing_edge, or reverse the order from hub to shroud"
            )
        if np.min(share) <= 1e-4:
            i, j = np.unravel_index(int(np.argmin(share)), share.shape)
            raise DesignError(
                f"channel: it folds over at u = {u[j]:.3f}, v = {v[i]:.3f} (Jacobian {share[i, j]:.3g} of its median, "
                "it must be positive): move the control points of hub and shroud, or of the edges, apart there"
            )


@lru_cache(maxsize=64)
def _power_rows(knots: bytes, degree: int, centres: tuple[float, ...], powers: int) -> Reals:
    """Rows (len(centres), powers, n) that take control points to powers of u - centre on the centre's span."""
    on = np.frombuffer(knots)
    rows = np.zeros((len(centres), powers, len(on) - degree - 1))
    inner = np.unique(on)
    for i, centre in enumerate(centres):
        span = int(np.clip(np.searchsorted(inner, centre, side="right") - 1, 0, len(inner) - 2))
        middle = float(inner[span] + inner[span + 1]) / 2.0
        series = [basis(on, degree, [middle], k)[0] / factorial(k) for k in range(degree + 1)]
        for k in range(degree + 1):
            terms = [comb(j, k) * (centre - middle) ** (j - k) * series[j] for j in range(k, degree + 1)]
            rows[i, k] = np.sum(terms, axis=0)
    return rows


def transfinite_channel(channel: Channel, metre: float) -> TransfiniteChannel:
    """The native channel of a design whose length unit is `metre` metres."""
    edges = {name: control_points(getattr(channel, name), metre) for name in ("leading_edge", "trailing_edge")}
    lines = dict(edges)
    for name, end in (("hub", 0), ("shroud", -1)):
        corners = [edges[edge][..., end : end + 1 or None, :] for edge in ("leading_edge", "trailing_edge")]
        inner = [control_points(getattr(channel, name), metre)] if getattr(channel, name) else []
        rows = [corners[0], *inner, corners[1]]
        batch = np.broadcast_shapes(*[row.shape[:-2] for row in rows])
        lines[name] = np.concatenate([np.broadcast_to(row, (*batch, *row.shape[-2:])) for row in rows], axis=-2)
    return TransfiniteChannel(**{name: _uniform(points, channel.degree) for name, points in lines.items()})


def _uniform(points: Array, degree: int) -> ChannelCurve:
    count = points.shape[-2]
    return ChannelCurve(points=points, knots=uniform_knots(count, min(count - 1, degree)))


def control_points(points: Points, metre: float) -> Array:
    """Points (..., n, 2) of a design in metres."""
    flat = stacked([coordinate for point in points for coordinate in point])
    return metre * flat.reshape(*flat.shape[:-1], len(points), 2)
