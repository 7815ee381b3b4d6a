"""Developable blades: the hub's section moved along parallel straight lines, from stream surface to stream surface."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.blade.bladed_lines import BladedLines, bladed_lines
from bladewright.blade.developable_crossing import Crossed, crossed_surfaces
from bladewright.blade.laid import EdgeRow
from bladewright.blade.mapping import Mapping
from bladewright.blade.meridian_line import real_first
from bladewright.blade.outline_stations import OutlineStations
from bladewright.blade.path_stations import PathStations
from bladewright.blade.planes import Counted
from bladewright.blade.stream_surfaces import StreamSurfaces
from bladewright.numerics.elementary import Array, angle, joined
from bladewright.nurbs.basis import Reals
from bladewright.section.crossing import FINE

ENDS = np.array([0.0, 1.0])


@dataclass(frozen=True, kw_only=True, eq=False)
class Rulings:
    """Parallel straight lines through the points of the hub's section."""

    surfaces: StreamSurfaces
    hub: OutlineStations
    """the section at the hub, of v (1,)"""
    direction: Array
    """(..., 3) from the hub's reference point to the shroud's [m]"""

    def crossing(self, plane: Array, v: Reals) -> Crossed:
        """Where those through the plane points (..., 1, k, 2) of the hub cross the stream surfaces at v (m,)."""
        u, _, _ = self.hub.on_lines(plane)
        start = self.hub.in_space(plane)[..., 0, :, :]
        near = real_first(self.hub.lines.t(u), 2)[0]
        return crossed_surfaces(self.surfaces, v, start, self.direction, near, revolved=self.hub.mapping.revolved)


@dataclass(frozen=True, kw_only=True, eq=False)
class DevelopedPlane:
    """Sections (..., m) in their planes, as the rulings cut them out of their stream surfaces."""

    rulings: Rulings
    lines: BladedLines

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., m, len(s), 2) of the upper and the lower side."""
        upper, lower = self.rulings.hub.plane.points(s)
        both = self.of_hub(joined([upper, lower], axis=-2))
        return both[..., : len(s), :], both[..., len(s) :, :]

    def of_hub(self, plane: Array) -> Array:
        """Points (..., m, k, 2) on the rulings of plane points (..., 1, k, 2) of the hub."""
        return self.placed(self.rulings.crossing(plane, self.lines.v))

    def placed(self, crossed: Crossed) -> Array:
        """Points (..., m, k, 2) of the planes."""
        lines, mapping = self.lines, self.lines.mapping
        u = (crossed.t - lines.leading[..., None]) / (lines.trailing - lines.leading)[..., None]
        ordinate = mapping.start(tangential(mapping, crossed.point), radius(mapping, crossed.point), lines.lengths)
        return np.stack(np.broadcast_arrays(lines.abscissa(u), ordinate), axis=-1)


def radius(mapping: Mapping, point: Array) -> Array:
    """r of points (..., 3), z in a cascade."""
    return np.sqrt(point[..., 1] ** 2 + point[..., 2] ** 2) if mapping.revolved else point[..., 2]


def tangential(mapping: Mapping, point: Array) -> Array:
    """theta of points (..., 3), y in a cascade."""
    return angle(point[..., 1], point[..., 2]) if mapping.revolved else point[..., 1]


@dataclass(frozen=True, kw_only=True, eq=False)
class DevelopedStations(PathStations):
    """Sections at v (m,) of a generalised cylinder: the hub's section, moved along parallel straight lines.

    The lines run as the one from the hub's to the shroud's reference point does. The surface is developable: the
    tangent plane is the same all along a line, so that a flank cutter touches along the whole of it; native sides
    interpolate the distance along a fixed direction, and are cylinders to rounding. Curves of constant v lie on the
    stream surfaces. What is given up: every section but the hub's follows from that, and so do chord, stagger, angles
    and thickness; of the shroud nothing is the design's but the place of its reference point.
    """

    plane: DevelopedPlane

    @property
    def kinds(self) -> tuple[str, str]:
        return self._hub.kinds

    @property
    def back(self) -> float | None:
        return self._hub.back

    @property
    def _hub(self) -> OutlineStations:
        return self.plane.rulings.hub

    def outlines(self) -> Reals:
        upper, lower = (real_first(side, 3) for side in self.plane.points(FINE))
        return joined([upper, lower[:, ::-1]], axis=-2)

    def camber(self, share: Reals) -> Array:
        return self.plane.of_hub(self._hub.camber(share))

    def camber_ends(self) -> tuple[Array, Array]:
        first, last = (self._direction(end, along) for end, along in enumerate(self._hub.camber_ends()))
        return first, last

    def points(self, s: Reals) -> tuple[Array, Array]:
        upper, lower = (self._crossing(side).point for side in self._hub.plane.points(s))
        return upper, lower

    def leading_edge(self) -> EdgeRow:
        return self._row(self._hub.leading_edge(), self._edges[0])

    def trailing_edge(self) -> EdgeRow:
        return self._row(self._hub.trailing_edge(), self._edges[1])

    def lower_edges(self) -> tuple[EdgeRow | None, EdgeRow | None]:
        first, last = (
            None if row is None else self._row(row, place)
            for row, place in zip(self._hub.lower_edges(), self._edges[2:], strict=True)
        )
        return first, last

    def faces(self, w: Reals) -> dict[str, Array]:
        upper, lower = self._hub.plane.points(ENDS)
        found = {}
        for name in self._hub.faces(w):
            at = 0 if name == "leading_edge" else 1
            ends = upper[..., at, None, :], lower[..., at, None, :]
            found[name] = self._crossing(ends[0] + w[:, None] * (ends[1] - ends[0])).point
        return found

    @cached_property
    def _edges(self) -> list[Crossed]:
        """Crossings of the rulings at the upper side's edges, then at the lower side's."""
        upper, lower = self._hub.plane.points(ENDS)
        return [self._crossing(side[..., [end], :]) for side in (upper, lower) for end in (0, 1)]

    def _crossing(self, plane: Array) -> Crossed:
        return self.plane.rulings.crossing(plane, self.v)

    def _row(self, row: EdgeRow, crossed: Crossed) -> EdgeRow:
        first, second = crossed.carried(row.first, row.second)
        return EdgeRow(crossed.point[..., 0, :], first.point, second.point)

    def _direction(self, end: int, along: Array) -> Array:
        """Directions (..., m, 2) in the planes of one (..., 1, 2) of the hub's plane at an end of the camber line."""
        hub, lines, mapping = self._hub, self.lines, self.mapping
        place = hub.camber(ENDS[[end]])
        none = np.zeros_like(along)
        u, _, _ = hub.on_lines(place)
        first = hub.row(u[..., 0], place[..., 0, :], along, none).first
        crossed = self._crossing(place)
        rate, _ = crossed.carried(first, np.zeros_like(first))
        point, step = crossed.point[..., 0, :], rate.point
        own = (crossed.t[..., 0] - lines.leading) / (lines.trailing - lines.leading)
        abscissa = lines.densities(own[..., None])[0][..., 0] * rate.t / (lines.trailing - lines.leading)
        if not mapping.revolved:
            return np.stack(np.broadcast_arrays(abscissa, step[..., 1]), axis=-1)
        r = radius(mapping, point)
        turn = (step[..., 1] * point[..., 2] - step[..., 2] * point[..., 1]) / r**2
        grown = (step[..., 1] * point[..., 1] + step[..., 2] * point[..., 2]) / r
        ordinate = turn if mapping.keeps_ordinate else turn * r + tangential(mapping, point) * grown
        return np.stack(np.broadcast_arrays(abscissa, ordinate), axis=-1)


def developed_stations(
    surfaces: StreamSurfaces, hub: OutlineStations, references: Array, v: Reals
) -> DevelopedStations:
    """The developable blade at v (m,), from the section at the hub and reference points (..., 2, 3) of hub and shroud.

    Raises DesignError where a ruling misses a stream surface.
    """
    rulings = Rulings(surfaces=surfaces, hub=hub, direction=references[..., 1, :] - references[..., 0, :])
    chord = hub.plane.placed(np.array([[[0.0, 0.0], [1.0, 0.0]]]))
    t = rulings.crossing(chord, v).t
    mapping = hub.mapping
    lines = bladed_lines(surfaces, v, mapping, t[..., 0], t[..., 1], counted=isinstance(mapping, Counted))
    return DevelopedStations(v=v, lines=lines, plane=DevelopedPlane(rulings=rulings, lines=lines))
