"""Where a blade's edges lie along its channel or flow path, and how far upstream or downstream other places are."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.blade.exact.family_sections import FlowPathSections
from bladewright.blade.flow_path.channel import TransfiniteChannel
from bladewright.blade.flow_path.cut_channel import FlowPathWall
from bladewright.blade.flow_path.followed_channel import FollowedChannel, followed_channel, path_ends
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.flow_path.stream_surface_map import Cascade
from bladewright.blade.flow_path.stream_surfaces import StreamSurfaces
from bladewright.blade.flow_path.streamlines import MeridionalChannel, StreamLines, stream_lines
from bladewright.numerics.elementary import Array
from bladewright.numerics.roots import bracketed_root
from bladewright.nurbs.basis import Reals

SIDE_PLACES = np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, 65)) ** 2
"""Parameters along the sides among which a blade's least and greatest t are looked for, denser at the edges."""
SAME = 1e-9
"""Extent, in mean meridional lengths, by which a place and an end of the flow path may differ by rounding."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MeridionalExtent(ABC):
    """Where a blade lies along its channel, by the channel's parameter u: its edges need not be at 0 and 1."""

    channel: MeridionalChannel
    start: float
    """u at which the channel starts: upstream of it, stream lines are continued straight"""
    end: float
    """u at which it ends"""
    blade_range: tuple[float, float]
    """least and greatest u of the blade"""
    edges: tuple[float, float]
    """mean u of the leading and of the trailing edge"""
    length: float
    """mean meridional length of the blade [m]"""
    unit: float
    """increase of u over that length"""

    @abstractmethod
    def extent(self, past: int, u: float) -> float:
        """How far u is upstream of the leading (0), or downstream of the trailing edge (1), in mean lengths."""

    @abstractmethod
    def path_end(self, past: int) -> float | None:
        """The extent at which the flow path ends, upstream (0) or downstream (1); None where the blade has none."""

    @abstractmethod
    def place(self, past: int, extent: float) -> float:
        """The inverse of `extent`: u at an extent upstream of the leading, or downstream of the trailing edge."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ChannelExtent(MeridionalExtent):
    """In the channel of the unified family: u is 0 on the leading and 1 on the trailing edge, and measures extents."""

    def extent(self, past: int, u: float) -> float:
        return u - 1.0 if past else -u

    def path_end(self, past: int) -> float | None:
        del past
        return None

    def place(self, past: int, extent: float) -> float:
        return 1.0 + extent if past else -extent


@dataclass(frozen=True, kw_only=True, eq=False)
class FlowPathExtent(MeridionalExtent):
    """A flow path, by t, or u of the channel that is cut out of it; extents are mean lengths along its stream lines."""

    channel: StreamSurfaces | FollowedChannel
    v: Reals
    """(m,) span fractions of the stream lines that the mean is taken of"""
    edges_at: tuple[Reals, Reals]
    """t (m,) on them at the leading and at the trailing edge"""

    def extent(self, past: int, u: float) -> float:
        own = min(max(u, self.start), self.end)
        lengths = np.mean(self._lines.abscissa(np.array([own]))[:, 0] - self._edge_lengths[past])
        return float((lengths / self.length + (u - own) / self.unit) * (1.0 if past else -1.0))

    def path_end(self, past: int) -> float | None:
        return self.extent(past, self.end if past else self.start)

    def place(self, past: int, extent: float) -> float:
        sign, end, edge = (1.0, self.end, self.edges[1]) if past else (-1.0, self.start, self.edges[0])
        short = extent - self.extent(past, end)
        if short**2 < SAME**2:
            return end
        if short >= 0.0:
            return end + sign * short * self.unit

        def over(u: Reals) -> tuple[Reals, Reals]:
            away = self.extent(past, float(u)) - extent
            return np.asarray(away), np.asarray(sign / self.unit)

        return float(bracketed_root(over, edge - sign * 0.5 * self.unit, end))

    @cached_property
    def _lines(self) -> StreamLines:
        surfaces = self.channel.along(self.v).real()
        return stream_lines(surfaces, Cascade(), self.v, max(-self.start, 0.0), max(self.end - 1.0, 0.0))

    @cached_property
    def _edge_lengths(self) -> list[Reals]:
        return [self._lines.abscissa(at[:, None])[:, 0] for at in self.edges_at]


def channel_extent(
    channel: TransfiniteChannel,
    walls: tuple[FlowPathWall, FlowPathWall] | None,
    noses: tuple[float, float],
    v: Reals,
    lengths: Array,
) -> MeridionalExtent:
    """The extent of a blade in a channel between its noses, or between the ends of the flow path whose the walls are.

    `lengths` (..., m) are those of its stream lines at v (m,).
    """
    length = float(np.mean(real_first(lengths, 1)))
    edges, unit = (0.0, 1.0), 1.0
    if walls is None:
        start, end = noses
        return ChannelExtent(
            channel=channel, start=start, end=end, blade_range=noses, edges=edges, length=length, unit=unit
        )
    start, end = path_ends(walls, noses)
    return FlowPathExtent(
        channel=followed_channel(channel, walls, noses, (start, end)),
        start=start,
        end=end,
        blade_range=noses,
        edges=edges,
        length=length,
        unit=unit,
        v=v,
        edges_at=(np.zeros_like(v), np.ones_like(v)),
    )


def flow_path_extent(surfaces: StreamSurfaces, survey: FlowPathSections) -> FlowPathExtent:
    """The extent of a blade in a flow path, by its sections from hub to shroud."""
    lines = survey.lines
    leading, trailing = (real_first(each, 1) for each in (lines.leading, lines.trailing))
    abscissae = np.stack([real_first(side[..., 0], 2) for side in survey.plane_points(SIDE_PLACES)])
    u = np.stack([np.min(abscissae, axis=(0, 2)), np.max(abscissae, axis=(0, 2))], axis=-1)
    blade_range = real_first(lines.t(lines.u_at(u)), 2)
    edges = float(np.mean(leading)), float(np.mean(trailing))
    return FlowPathExtent(
        channel=surfaces,
        start=surfaces.low,
        end=surfaces.high,
        blade_range=(min(float(np.min(blade_range)), edges[0]), max(float(np.max(blade_range)), edges[1])),
        edges=edges,
        length=float(np.mean(real_first(lines.lengths, 1))),
        unit=edges[1] - edges[0],
        v=survey.v,
        edges_at=(leading, trailing),
    )
