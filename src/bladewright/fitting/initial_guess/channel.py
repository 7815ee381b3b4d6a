"""The likely meridional channels of a cloud: which pieces of its outline are walls, which edges; and slices between."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RectBivariateSpline
from scipy.spatial import cKDTree

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.flow_path.channel import TransfiniteChannel, transfinite_channel
from bladewright.designs import Point
from bladewright.fitting.free_parameters import EDGES
from bladewright.fitting.initial_guess.meridional_outline import alpha_boundary, corner_sets
from bladewright.fitting.initial_guess.slices import PlanePoints, Slices, chord_direction, slices_of
from bladewright.fitting.model_selection.laws import CHANNEL_CURVES
from bladewright.numerics.elementary import cross2, cumulative_length, length
from bladewright.nurbs.basis import Reals, uniform_knots
from bladewright.nurbs.fit import approximated
from bladewright.section.laws import law_basis

CONTINUED = 0.5
"""how far, in u, stream lines are continued past the edges (design/first_guesses.md)"""
SPAN: Reals = np.linspace(0.0, 1.0, 25)
"""v at which stream lines are tabulated"""
ALONG: Reals = np.linspace(-CONTINUED, 1.0 + CONTINUED, 129)
"""u at which they are tabulated"""
LEAST_RADIUS = 1e-3
"""smallest radius, of the largest, by which m' is counted: on the axis it is infinite (design/first_guesses.md)"""
LEAST_JACOBIAN = 0.02
"""least Jacobian of a channel, of its median; below it its curves get fewer control points (design/first_guesses.md)"""
FOLD_MARGIN = 0.03
"""how far past the edges, in u, it may not fold: noses reach so far (design/first_guesses.md)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class FirstChannel:
    """A channel by the control points of its four curves, and its stream lines."""

    curves: Mapping[str, Reals]
    """(n, 2) of each curve [m], corners among them"""
    revolved: bool

    def part(self, metre: float) -> Channel:
        """The channel as a part of a design whose length unit is `metre` metres."""
        # walls have no corners of their own
        own = {name: rows if name in EDGES else rows[1:-1] for name, rows in self.curves.items()}
        points: Any = {name: tuple(Point(*row) for row in (rows / metre).tolist()) for name, rows in own.items()}
        return Channel(**points)

    @cached_property
    def exact(self) -> TransfiniteChannel:
        """Its map (u, v) -> (x, r)."""
        return transfinite_channel(self.part(1.0), 1.0)

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
    def _ways(self) -> tuple[RectBivariateSpline, RectBivariateSpline]:
        """Abscissa in the plane and length [m] by v and u, both 0 at u = 0."""
        position = self.position(ALONG[None], SPAN[:, None])
        step, radius = length(np.diff(position, axis=1)), self._radii(position)
        found = []
        for density in (2.0 / (radius[:, 1:] + radius[:, :-1]), np.ones_like(step)):
            way = np.concatenate([np.zeros((len(SPAN), 1)), np.cumsum(step * density, axis=1)], axis=1)
            way -= np.array([np.interp(0.0, ALONG, row) for row in way])[:, None]
            found.append(RectBivariateSpline(SPAN, ALONG, way))
        return found[0], found[1]

    def _radii(self, position: Reals) -> Reals:
        """Radius (...) [m] at places (..., 2), or 1 of a cascade."""
        radius = position[..., 1] if self.revolved else np.ones(position.shape[:-1])
        return np.asarray(np.maximum(radius, LEAST_RADIUS * float(np.max(radius))))

    def extents(self, v: Reals, u: Reals | float = 1.0) -> tuple[Reals, Reals]:
        """Extents in the plane and meridional lengths [m] (n,) of the stream lines at v (n,), up to u."""
        return self._ways[0].ev(v, u), self._ways[1].ev(v, u)

    def radius(self, u: Reals, v: Reals) -> Reals:
        """Radius (m, k) [m], or 1 of a cascade, at u (k,) and v (m,)."""
        return self._radii(self.position(u, v[:, None]))

    def largest_distance(self, outline: Reals) -> float:
        """Largest distance [m] of points (n, 2) of an outline from the channel's four curves."""
        t, ends = np.tile(np.linspace(0.0, 1.0, 101), 2), np.repeat([0.0, 1.0], 101)
        own = np.concatenate([self.position(t, ends), self.position(ends, t)])
        return float(np.max(cKDTree(own).query(outline)[0]))

    def least_jacobian(self) -> float:
        """The least Jacobian of the map, of its median; negative where it folds."""
        along, across = self.exact.slopes(np.linspace(-FOLD_MARGIN, 1.0 + FOLD_MARGIN, 41), np.linspace(0.0, 1.0, 21))
        size = np.sqrt(np.sum(along**2, axis=-1) * np.sum(across**2, axis=-1))
        return float(np.min(cross2(along, across)) / np.median(size))


def channel_through(pieces: Mapping[str, Reals], counts: Mapping[str, int], *, revolved: bool) -> FirstChannel:
    """The channel along four polylines by name, of so many control points, or of fewer where it folds over."""
    ends = {edge: pieces[edge][[0, -1]] for edge in EDGES}
    ends |= {wall: np.stack([ends[edge][end] for edge in EDGES]) for end, wall in enumerate(("hub", "shroud"))}
    found: list[FirstChannel] = []
    for most in range(max(counts.values()), 2, -1):
        curves = {name: _through(piece, min(counts[name], most), ends[name]) for name, piece in pieces.items()}
        found.append(FirstChannel(curves=curves, revolved=revolved))
        if found[-1].least_jacobian() > LEAST_JACOBIAN:
            return found[-1]
    return max(found, key=FirstChannel.least_jacobian)


def _through(line: Reals, count: int, ends: Reals) -> Reals:
    """Control points (count, 2) of the curve between two points (2, 2) nearest to a polyline, by its length."""
    line = np.concatenate([ends[:1], line[1:-1], ends[1:]])
    way = cumulative_length(line)
    t, degree = np.linspace(0.0, 1.0, 61), min(count - 1, 5)
    places = np.stack([np.interp(t * way[-1], way, axis) for axis in line.T], axis=-1)
    return np.asarray(
        approximated(places, t, degree=degree, knots=uniform_knots(count, degree), ends=True).control_points
    )


STATIONS: Reals = np.linspace(0.0, 1.0, 9)
"""v of the slices"""
CHANNEL = dict(zip(CHANNEL_CURVES, (3, 3, 4, 4), strict=True))
"""control points of the channel's curves"""
LAW_COUNT = 4
"""control points of their laws along the span (design/first_guesses.md)"""
BORDER_SHARE, BORDER_POINTS, CORNER_MARGIN = 0.06, 24, 0.12
"""share and least number of points beside a piece of the outline that show whether the sides meet there, and share of
it at its ends that shows nothing (design/first_guesses.md)"""
WALL_OPENING_RATIO = 1.4
"""ratio of the openings from which two opposite pieces are the walls (design/first_guesses.md)"""
RADIAL_SHARE = 0.05
"""axial share of the way from edge to edge below which the rounder edge leads (design/first_guesses.md)"""
ROUNDER_RATIO = 1.2
"""ratio of radii from which one edge is the rounder one (design/first_guesses.md)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class SlicedChannel:
    """A channel, the points on its stream surfaces, and slices of them."""

    channel: FirstChannel
    plane: PlanePoints
    slices: Slices
    mean_distance: float
    """mean distance of the points from the slices, and from the channel past its walls, in chords"""
    walls: tuple[Reals, ...]
    """(m, 2) places of hub and shroud on the outline of the points [m]"""


def machine_coordinates(points: Reals, arrangement: str) -> Reals:
    """Coordinates (n, 3): x, r and theta [rad] without a jump, or x, z and y of a cascade."""
    x, y, z = points.T
    if arrangement == "linear":
        return np.stack([x, z, y], axis=-1)
    theta = np.sort(np.arctan2(y, z))
    gaps = np.diff(np.concatenate([theta, theta[:1] + 2.0 * np.pi]))
    i = int(np.argmax(gaps))
    cut = theta[i] + gaps[i] / 2.0
    wrapped = (np.arctan2(y, z) - cut) % (2.0 * np.pi) + cut
    wrapped -= 2.0 * np.pi * np.round(np.median(wrapped) / (2.0 * np.pi))
    return np.stack([x, np.sqrt(y**2 + z**2), wrapped], axis=-1)


def ranked_channels(points: Reals, rows: NDArray[np.intp], arrangement: str) -> list[SlicedChannel]:
    """The channel and slices of points (n, 3) [m] for each likely choice of walls and edges, the likeliest first.

    All points show the outline, and which of its pieces are walls; `rows` of them the slices. The likeliest leaves the
    least product of the slices' distance from the points and the channel's from the outline (design/first_guesses.md).
    """
    machine, revolved = machine_coordinates(points, arrangement), arrangement == "annular"
    found: list[tuple[float, SlicedChannel]] = []
    boundary = alpha_boundary(machine[:, :2])
    for pieces in corner_sets(boundary):
        middles = [np.mean(piece, axis=0) for piece in pieces]
        for turn in pairings(machine, pieces, revolved=revolved):
            # the flow leads towards larger x, or where that hardly shows, away from the rounder edge
            ahead = middles[(1 + turn) % 4] - middles[(3 + turn) % 4]
            forward = turn if ahead[0] >= 0.0 else turn + 2
            sliced = sliced_channel(machine[rows], _named(pieces, forward), revolved=revolved)
            first, last = (float(np.mean(radii)) for radii in sliced.slices.radii)
            if abs(ahead[0]) < RADIAL_SHARE * float(length(ahead)) and last > ROUNDER_RATIO * first:
                sliced = sliced_channel(machine[rows], _named(pieces, forward + 2), revolved=revolved)
            found.append((sliced.mean_distance * sliced.channel.largest_distance(boundary), sliced))
    return [sliced for _, sliced in sorted(found, key=lambda each: each[0])]


def sliced_channel(machine: Reals, named: dict[str, Reals], *, revolved: bool) -> SlicedChannel:
    """The points in the planes of the stream surfaces of one outline's channel, and slices from edge to edge."""
    channel = channel_through(named, CHANNEL, revolved=revolved)
    u, v = channel.places(machine[:, :2])
    v = np.clip(v, 0.0, 1.0)
    past = machine[:, :2] - channel.position(u, v)
    extent, lengths = channel.extents(v)
    # the place around the axis is smooth along the span; in extents, which may differ tenfold, it is not
    rows, around = law_basis(LAW_COUNT, v), machine[:, 2]
    place = np.linalg.lstsq(rows, around, rcond=None)[0]
    own = np.stack([channel.extents(v, u)[0], around - rows @ place], axis=-1)
    plane = PlanePoints(points=own / extent[:, None], v=v)
    slices = slices_of(plane, chord_direction(plane), STATIONS, LAW_COUNT)
    camber = slices.camber.copy()
    camber[..., 1] += (law_basis(LAW_COUNT, STATIONS) @ place / channel.extents(STATIONS)[0])[:, None]
    outside = float(np.mean(length(past) / lengths)) / float(np.mean(slices.chords))
    first, last = camber[:, :1, 0], camber[:, 3:, 0]
    camber[..., 0] = (camber[..., 0] - first) / np.maximum(last - first, 0.2)
    return SlicedChannel(
        channel=channel,
        plane=plane,
        slices=replace(slices, camber=camber),
        mean_distance=slices.mean_distance + outside,
        walls=(named["hub"], named["shroud"]),
    )


def pairings(machine: Reals, pieces: list[Reals], *, revolved: bool) -> tuple[int, ...]:
    """Which of the two ways to pair the pieces to try: at walls the sides stand apart, at edges they meet."""
    openings = [_opening(machine, piece, revolved=revolved) for piece in pieces]
    pairs = [[opening for opening in openings[start::2] if opening is not None] for start in (0, 1)]
    if not all(pairs):
        return (0, 1)
    even, odd = (float(np.mean(pair)) for pair in pairs)
    if even > WALL_OPENING_RATIO * odd:
        return (0,)
    return (1,) if odd > WALL_OPENING_RATIO * even else (0, 1)


def _opening(machine: Reals, piece: Reals, *, revolved: bool) -> float | None:
    """Tangential distance rms [m] of points beside a piece of the outline from one surface; None where they are few."""
    way = cumulative_length(piece)
    t = np.linspace(0.0, 1.0, 400)
    line = np.stack([np.interp(t * way[-1], way, piece[:, i]) for i in (0, 1)], axis=-1)
    away, index = cKDTree(line).query(machine[:, :2])
    along = t[index]
    beside = np.flatnonzero((along > CORNER_MARGIN) & (along < 1.0 - CORNER_MARGIN))
    beside = beside[np.argsort(away[beside])[: max(BORDER_POINTS, int(BORDER_SHARE * len(machine)))]]
    if len(beside) < BORDER_POINTS:
        return None
    across = machine[beside, 2] * (machine[beside, 1] if revolved else 1.0)
    depth = away[beside] / max(float(np.max(away[beside])), 1e-300)
    sheet = np.column_stack([np.vander(along[beside], 4), depth, depth * along[beside]])
    left = across - sheet @ np.linalg.lstsq(sheet, across, rcond=None)[0]
    return float(np.sqrt(np.mean(left**2)))


def _named(pieces: list[Reals], turn: int) -> dict[str, Reals]:
    """Four pieces of an anticlockwise boundary by their names: hub, trailing edge, shroud, leading edge in (x, r)."""
    hub, trailing, shroud, leading = (pieces[(i + turn) % 4] for i in range(4))
    return {"hub": hub, "trailing_edge": trailing, "shroud": shroud[::-1], "leading_edge": leading[::-1]}
