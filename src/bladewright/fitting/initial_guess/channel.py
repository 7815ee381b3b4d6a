"""A rough meridional channel: four curves with shared corners, and the places of points in it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

from bladewright.errors import FitError
from bladewright.numerics.elementary import cumulative_length
from bladewright.nurbs.basis import Reals, basis, uniform_knots

CHANNEL_CURVES = ("hub", "shroud", "leading_edge", "trailing_edge")
"""the curves of the channel"""
CONTINUED = 0.5
"""how far, in u, stream lines are continued past the edges"""
SPAN = np.linspace(0.0, 1.0, 25)
"""v at which stream lines are tabulated"""
ALONG = np.linspace(-CONTINUED, 1.0 + CONTINUED, 129)
"""u at which stream lines are tabulated"""


@dataclass(frozen=True, kw_only=True, eq=False)
class RoughChannel:
    """Control points (n, 2) in (x, r) of the four curves; hub and shroud with their corners."""

    curves: dict[str, Reals]
    revolved: bool

    def position(self, u: Reals, v: Reals) -> Reals:
        """(x, r) of the transfinite interpolation at u and v of the same shape."""
        hub, shroud, leading, trailing = (
            _curve(self.curves[name], along.ravel()).reshape(*along.shape, 2)
            for name, along in zip(CHANNEL_CURVES, (u, u, v, v), strict=True)
        )
        a, b = self.curves["leading_edge"][[0, -1]]
        c, d = self.curves["trailing_edge"][[0, -1]]
        u, v = u[..., None], v[..., None]
        ruled = (1 - u) * (1 - v) * a + (1 - u) * v * b + u * (1 - v) * c + u * v * d
        return np.asarray((1 - v) * hub + v * shroud + (1 - u) * leading + u * trailing - ruled)

    def places(self, points: Reals) -> tuple[Reals, Reals]:
        """u and v (n,) of points (n, 2), beyond the ends where they lie outside."""
        u, v = np.meshgrid(np.linspace(-0.3, 1.3, 81), np.linspace(-0.15, 1.15, 66), indexing="ij")
        _, index = cKDTree(self.position(u, v).reshape(-1, 2)).query(points)
        u, v = u.ravel()[index], v.ravel()[index]
        for _ in range(5):
            h = 1e-5
            miss = points - self.position(u, v)
            du = (self.position(u + h, v) - self.position(u - h, v)) / (2 * h)
            dv = (self.position(u, v + h) - self.position(u, v - h)) / (2 * h)
            turn = du[:, 0] * dv[:, 1] - du[:, 1] * dv[:, 0]
            turn = np.where(np.abs(turn) > 1e-30, turn, 1e-30)
            step_u = (miss[:, 0] * dv[:, 1] - miss[:, 1] * dv[:, 0]) / turn
            step_v = (du[:, 0] * miss[:, 1] - du[:, 1] * miss[:, 0]) / turn
            u = np.clip(u + np.clip(step_u, -0.05, 0.05), -CONTINUED, 1.0 + CONTINUED)
            v = np.clip(v + np.clip(step_v, -0.05, 0.05), -0.2, 1.2)
        return u, v

    @cached_property
    def _grid(self) -> tuple[Reals, Reals, Reals]:
        """Positions (25, 129, 2), abscissae in the plane and metres along stream lines (25, 129), 0 at u = 0."""
        v, u = np.meshgrid(SPAN, ALONG, indexing="ij")
        position = self.position(u, v)
        step = np.sqrt(np.sum(np.diff(position, axis=1) ** 2, axis=-1))
        metres = np.concatenate([np.zeros((len(SPAN), 1)), np.cumsum(step, axis=1)], axis=1)
        radius = np.maximum(position[..., 1], 1e-3 * float(np.max(position[..., 1])))
        middle = (radius[:, 1:] + radius[:, :-1]) / 2.0 if self.revolved else np.ones_like(step)
        abscissa = np.concatenate([np.zeros((len(SPAN), 1)), np.cumsum(step / middle, axis=1)], axis=1)
        return position, *(a - np.array([np.interp(0.0, ALONG, row) for row in a])[:, None] for a in (abscissa, metres))

    def abscissa(self, u: Reals, v: Reals) -> Reals:
        """Abscissa (n,) in the plane of the section at v."""
        return _interpolated(self._grid[1], u, v)

    def folding(self, past: float) -> float:
        """The least Jacobian of the map, of its median, up to `past` beyond the edges in u; negative where it folds."""
        v, u = np.meshgrid(np.linspace(0.0, 1.0, 21), np.linspace(-past, 1.0 + past, 49), indexing="ij")
        position = self.position(u, v)
        along, across = position[:, 1:] - position[:, :-1], position[1:] - position[:-1]
        along, across = (along[1:] + along[:-1]) / 2.0, (across[:, 1:] + across[:, :-1]) / 2.0
        turn = along[..., 0] * across[..., 1] - along[..., 1] * across[..., 0]
        size = np.sqrt(np.sum(along**2, axis=-1) * np.sum(across**2, axis=-1))
        return float(np.min(turn) / np.median(size))

    def extents(self) -> tuple[Reals, Reals]:
        """Extent in the plane and meridional length [m] of the stream lines at SPAN."""
        return tuple(np.array([np.interp(1.0, ALONG, row) for row in a]) for a in self._grid[1:])  # type: ignore[return-value]

    def u_at(self, abscissa: Reals) -> Reals:
        """u (25,) of an abscissa on each of the stream lines at SPAN."""
        rows = self._grid[1]
        return np.array([np.interp(a, row, ALONG) for a, row in zip(abscissa, rows, strict=True)])

    @cached_property
    def _sizes(self) -> tuple[Reals, float, float]:
        position, abscissa, _ = self._grid
        low, high = float(np.min(abscissa)), float(np.max(abscissa))
        at = np.linspace(low, high, 200)
        radius = np.array([np.interp(at, row, r) for row, r in zip(abscissa, position[..., 1], strict=True)])
        if not self.revolved:
            radius = np.ones_like(radius)
        floor = 1e-3 * float(np.max(radius))
        return self.extents()[1][:, None] / np.maximum(radius, floor), low, high

    def size(self, abscissa: Reals, v: Reals) -> Reals:
        """Size in the plane of one meridional length, by abscissa (n, k) and v (n,)."""
        table, low, high = self._sizes
        column = (abscissa - low) / (high - low) * 199.0
        row = np.broadcast_to((np.clip(v, 0.0, 1.0) * (len(SPAN) - 1))[:, None], abscissa.shape)
        return np.asarray(map_coordinates(table, [row, column], order=1, mode="nearest"))

    def extent(self, v: Reals) -> Reals:
        """Extent (n,) of the stream lines in the plane at v."""
        return np.interp(v, SPAN, self._extents)

    @cached_property
    def _extents(self) -> Reals:
        return self.extents()[0]


SIMPLIFIED_DISTANCE = 3e-3
"""distance, of its length, by which a curve may move for fewer control points."""
BOUNDARY_RAGGEDNESS = 0.9
"""distance of a boundary of points from its curve, of the distance between points."""
PLAIN_DISTANCE = 0.03
"""distance, of its length, by which a curve that is simplified so that the channel does not fold may leave its
polyline."""
LEAST_JACOBIAN = 0.02
"""least Jacobian of a channel, of its median; below it the channel counts as folded."""


def rough_channel(
    pieces: dict[str, Reals], counts: dict[str, int], *, revolved: bool, past: float = 0.03
) -> RoughChannel:
    """A channel along four polylines by name; its corners are the ends of leading and trailing edge.

    The curves get as few control points as they need so that the channel does not fold.
    """
    plain, found, best = counts, None, -np.inf
    for most in (9, 5, 4, 3, 2) if past > 0.1 else (9, 5, 4, 3):
        tried = {name: min(count, most) for name, count in counts.items()}
        if found is not None and any(
            _relative_distance(pieces[name], count) > PLAIN_DISTANCE for name, count in tried.items()
        ):
            break
        channel = _along(pieces, tried, revolved=revolved)
        least = channel.folding(past)
        if found is None or least > best:
            plain, found, best = tried, channel, least
        if best > LEAST_JACOBIAN:
            break
    if found is None:
        raise FitError("no channel was found around the points")
    if plain != counts:
        t = np.linspace(0.0, 1.0, 41)
        found = _along({name: _curve(found.curves[name], t) for name in CHANNEL_CURVES}, counts, revolved=revolved)
    return found


def curve_counts(channel: RoughChannel) -> dict[str, int]:
    """Control points, from 2 to 6, that the curves of a channel need to move by no more than `SIMPLIFIED_DISTANCE`."""
    t = np.linspace(0.0, 1.0, 41)
    counts = {}
    for name in CHANNEL_CURVES:
        line = _curve(channel.curves[name], t)
        size = float(np.sum(np.sqrt(np.sum(np.diff(line, axis=0) ** 2, axis=-1))))
        for count in range(2, 7):
            near = _curve(_through(line, count, line[0], line[-1]), t)
            counts[name] = count
            if np.max(np.sqrt(np.sum((near - line) ** 2, axis=-1))) < SIMPLIFIED_DISTANCE * size:
                break
    return counts


def needed_counts(pieces: dict[str, Reals], most: int, count: int) -> dict[str, int]:
    """Control points, from 2 to `most`, that the boundary of `count` points needs to be met as well as it is known.

    Where points are few a boundary is ragged, by about their distance from each other.
    """
    loop = np.concatenate(
        [pieces["hub"], pieces["trailing_edge"], pieces["shroud"][::-1], pieces["leading_edge"][::-1]]
    )
    x, r = loop.T
    area = abs(float(np.sum(x * np.roll(r, -1) - r * np.roll(x, -1)))) / 2.0
    ragged = BOUNDARY_RAGGEDNESS * float(np.sqrt(area / count))
    counts = {}
    for name, line in pieces.items():
        left = (_distance_left(line, each) for each in range(2, most + 1))
        counts[name] = next((each for each, miss in enumerate(left, 2) if miss <= ragged), most)
    return counts


def _relative_distance(line: Reals, count: int) -> float:
    """The distance that a curve of so many control points leaves to a polyline, of its length."""
    return _distance_left(line, count) / float(np.sum(np.sqrt(np.sum(np.diff(line, axis=0) ** 2, axis=-1))))


def _distance_left(line: Reals, count: int) -> float:
    """Root mean square distance that a curve of so many control points leaves to a polyline."""
    way = cumulative_length(line)
    t = np.linspace(0.0, 1.0, 61)
    places = np.stack([np.interp(t * way[-1], way, line[:, i]) for i in (0, 1)], axis=-1)
    return float(np.sqrt(np.mean(np.sum((_curve(_through(line, count, line[0], line[-1]), t) - places) ** 2, axis=-1))))


def _along(pieces: dict[str, Reals], counts: dict[str, int], *, revolved: bool) -> RoughChannel:
    corners = {
        "leading_edge": (pieces["leading_edge"][0], pieces["leading_edge"][-1]),
        "trailing_edge": (pieces["trailing_edge"][0], pieces["trailing_edge"][-1]),
    }
    corners["hub"] = (corners["leading_edge"][0], corners["trailing_edge"][0])
    corners["shroud"] = (corners["leading_edge"][1], corners["trailing_edge"][1])
    curves = {name: _through(pieces[name], counts[name], *corners[name]) for name in CHANNEL_CURVES}
    return RoughChannel(curves=curves, revolved=revolved)


def _through(line: Reals, count: int, first: Reals, last: Reals) -> Reals:
    """Control points of a curve along a polyline, by its arc length, between given ends."""
    if count == 2:
        return np.stack([first, last])
    line = np.concatenate([first[None], line[1:-1], last[None]])
    way = cumulative_length(line)
    t = np.linspace(0.0, 1.0, 61)
    places = np.stack([np.interp(t * way[-1], way, line[:, i]) for i in (0, 1)], axis=-1)
    degree = min(count - 1, 5)
    rows = basis(uniform_knots(count, degree), degree, t)
    even = np.linspace(first, last, count)
    bending = 1e-2 * np.diff(np.eye(count), n=2, axis=0)
    matrix = np.concatenate([rows[:, 1:-1] / np.sqrt(len(t)), bending[:, 1:-1]])
    ends = np.stack([first, last])
    rhs = np.concatenate([(places - rows[:, [0, -1]] @ ends) / np.sqrt(len(t)), -bending[:, [0, -1]] @ ends])
    inner = np.linalg.lstsq(matrix, rhs, rcond=None)[0]
    return np.concatenate([even[:1], inner, even[-1:]])


def _curve(points: Reals, t: Reals) -> Reals:
    degree = min(len(points) - 1, 5)
    return np.asarray(basis(uniform_knots(len(points), degree), degree, t) @ points)


def _interpolated(table: Reals, u: Reals, v: Reals) -> Reals:
    column = (u + CONTINUED) / (1.0 + 2.0 * CONTINUED) * (len(ALONG) - 1)
    row = np.clip(v, 0.0, 1.0) * (len(SPAN) - 1)
    return np.asarray(map_coordinates(table, [row, column], order=3, mode="nearest"))
