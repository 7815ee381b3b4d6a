"""A first meridional channel through the four pieces of an outline, and the places of points on its stream surfaces."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.flow_path.channel import TransfiniteChannel, transfinite_channel
from bladewright.designs import Point
from bladewright.numerics.elementary import cross2, cumulative_length
from bladewright.nurbs.basis import Reals, basis, uniform_knots

CONTINUED = 0.5
"""how far, in u, stream lines are continued past the edges (design/first_guesses.md)"""
SPAN: Reals = np.linspace(0.0, 1.0, 25)
"""v at which stream lines are tabulated"""
ALONG: Reals = np.linspace(-CONTINUED, 1.0 + CONTINUED, 129)
"""u at which they are tabulated"""
LEAST_RADIUS = 1e-3
"""smallest radius at which m' is counted, of the largest: blades may reach the axis, where m' is infinite
(design/first_guesses.md)"""
LEAST_JACOBIAN = 0.02
"""least Jacobian of a channel, of its median; below it its curves get fewer control points (design/first_guesses.md)"""
FOLD_MARGIN = 0.03
"""how far past the edges, in u, it may not fold: noses reach so far (design/first_guesses.md)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class FirstChannel:
    """A channel as a part of a design, in metres, and its stream lines."""

    part: Channel
    revolved: bool

    @cached_property
    def exact(self) -> TransfiniteChannel:
        """Its map (u, v) -> (x, r)."""
        return transfinite_channel(self.part, 1.0)

    def position(self, u: Reals, v: Reals) -> Reals:
        """(x, r) (..., 2) at u and v (...)."""
        u, v = np.broadcast_arrays(u, v)
        return np.real(self.exact.at(u.ravel(), v.ravel())[0]).reshape(*u.shape, 2)

    def places(self, points: Reals) -> tuple[Reals, Reals]:
        """u and v (n,) of points (n, 2), past the ends where they lie outside, by Newton's method from a grid."""
        u, v = np.meshgrid(np.linspace(-0.3, 1.3, 81), np.linspace(-0.15, 1.15, 66), indexing="ij")
        _, index = cKDTree(self.position(u, v).reshape(-1, 2)).query(points)
        u, v, h = u.ravel()[index], v.ravel()[index], 1e-5
        for _ in range(5):
            miss = points - self.position(u, v)
            by_u = (self.position(u + h, v) - self.position(u - h, v)) / (2.0 * h)
            by_v = (self.position(u, v + h) - self.position(u, v - h)) / (2.0 * h)
            turn = cross2(by_u, by_v)
            turn = np.where(turn**2 > 0.0, turn, 1e-30)
            u = np.clip(u + np.clip(cross2(miss, by_v) / turn, -0.05, 0.05), -CONTINUED, 1.0 + CONTINUED)
            v = np.clip(v + np.clip(cross2(by_u, miss) / turn, -0.05, 0.05), -0.2, 1.2)
        return u, v

    @cached_property
    def _table(self) -> tuple[Reals, Reals, Reals]:
        """Radii, or ones of a cascade, abscissae in the plane and lengths [m] (25, 129), both 0 at u = 0."""
        position = self.position(ALONG[None], SPAN[:, None])
        radius = position[..., 1] if self.revolved else np.ones(position.shape[:2])
        radius = np.maximum(radius, LEAST_RADIUS * float(np.max(radius)))
        step = np.sqrt(np.sum(np.diff(position, axis=1) ** 2, axis=-1))
        found = [radius]
        for density in (2.0 / (radius[:, 1:] + radius[:, :-1]), np.ones_like(step)):
            way = np.concatenate([np.zeros((len(SPAN), 1)), np.cumsum(step * density, axis=1)], axis=1)
            found.append(way - np.array([np.interp(0.0, ALONG, row) for row in way])[:, None])
        return found[0], found[1], found[2]

    def extents(self, v: Reals) -> tuple[Reals, Reals]:
        """Extents in the plane and meridional lengths [m] (n,) of the stream lines at v (n,)."""
        first, second = (np.interp(v, SPAN, [np.interp(1.0, ALONG, row) for row in table]) for table in self._table[1:])
        return first, second

    def abscissa(self, u: Reals, v: Reals) -> Reals:
        """Abscissa (n,) in the plane of the section at v."""
        column = (u + CONTINUED) / (1.0 + 2.0 * CONTINUED) * (len(ALONG) - 1)
        row = np.clip(v, 0.0, 1.0) * (len(SPAN) - 1)
        return np.asarray(map_coordinates(self._table[1], [row, column], order=3, mode="nearest"))

    def u_at(self, abscissa: Reals, v: Reals) -> Reals:
        """u (m, k) at abscissae (m, k) in the planes of the sections at v (m,)."""
        rows = np.stack([np.interp(v, SPAN, column) for column in self._table[1].T], axis=-1)
        return np.stack([np.interp(at, row, ALONG) for at, row in zip(abscissa, rows, strict=True)])

    def radius(self, u: Reals, v: Reals) -> Reals:
        """Radius (m, k) [m], or 1 of a cascade, at u (m, k) and v (m,)."""
        rows = np.stack([np.interp(v, SPAN, column) for column in self._table[0].T], axis=-1)
        return np.stack([np.interp(at, ALONG, row) for at, row in zip(u, rows, strict=True)])

    def least_jacobian(self) -> float:
        """The least Jacobian of the map, of its median; negative where it folds."""
        along, across = self.exact.slopes(np.linspace(-FOLD_MARGIN, 1.0 + FOLD_MARGIN, 41), np.linspace(0.0, 1.0, 21))
        size = np.sqrt(np.sum(along**2, axis=-1) * np.sum(across**2, axis=-1))
        return float(np.min(cross2(along, across)) / np.median(size))


def channel_through(pieces: Mapping[str, Reals], counts: Mapping[str, int], *, revolved: bool) -> FirstChannel:
    """The channel along four polylines by name, whose corners are the ends of leading and trailing edge.

    Its curves have so many control points, or as many fewer as keep it from folding over.
    """
    corners = {edge: pieces[edge][[0, -1]] for edge in ("leading_edge", "trailing_edge")}
    for wall, end in (("hub", 0), ("shroud", 1)):
        corners[wall] = np.stack([corners["leading_edge"][end], corners["trailing_edge"][end]])
    found: list[FirstChannel] = []
    for most in range(max(counts.values()), 2, -1):
        curves = {
            name: elevated(through(piece, min(counts[name], most), *corners[name]), counts[name])
            for name, piece in pieces.items()
        }
        found.append(FirstChannel(part=_part(curves), revolved=revolved))
        if found[-1].least_jacobian() > LEAST_JACOBIAN:
            return found[-1]
    return max(found, key=FirstChannel.least_jacobian)


def _part(curves: Mapping[str, Reals]) -> Channel:
    def points(rows: Reals) -> tuple[Point, ...]:
        return tuple(Point(float(x), float(r)) for x, r in rows)

    return Channel(
        leading_edge=points(curves["leading_edge"]),
        trailing_edge=points(curves["trailing_edge"]),
        hub=points(curves["hub"][1:-1]),
        shroud=points(curves["shroud"][1:-1]),
    )


def through(line: Reals, count: int, first: Reals, last: Reals) -> Reals:
    """Control points (count, 2) of the curve between two points nearest to a polyline, by its length."""
    line = np.concatenate([first[None], line[1:-1], last[None]])
    way = cumulative_length(line)
    t = np.linspace(0.0, 1.0, 61)
    places = np.stack([np.interp(t * way[-1], way, line[:, i]) for i in (0, 1)], axis=-1)
    degree = min(count - 1, 5)
    rows, ends = np.asarray(basis(uniform_knots(count, degree), degree, t)), np.stack([first, last])
    inner = np.linalg.lstsq(rows[:, 1:-1], places - rows[:, [0, -1]] @ ends, rcond=None)[0]
    return np.concatenate([ends[:1], inner, ends[1:]])


def elevated(points: Reals, count: int) -> Reals:
    """The same curve, or the nearest one, with more control points."""
    if len(points) == count:
        return points
    degree = min(len(points) - 1, 5)
    line = np.asarray(basis(uniform_knots(len(points), degree), degree, np.linspace(0.0, 1.0, 61)) @ points)
    return through(line, count, points[0], points[-1])
