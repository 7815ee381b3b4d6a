"""Developable blades: the hub's section moved along parallel straight lines, from stream surface to stream surface."""

from dataclasses import dataclass
from functools import cached_property, partial
from typing import Literal, NamedTuple

import numpy as np

from bladewright.blade.exact.family_sections import FamilySections, FlowPathSections
from bladewright.blade.flow_path.blade_streamlines import blade_streamlines
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.flow_path.stream_surface_map import StreamSurfaceMap
from bladewright.blade.flow_path.stream_surfaces import StreamSurfaces
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, angle, concatenated, dot
from bladewright.nurbs.basis import Reals
from bladewright.section.crossing import FINE
from bladewright.section.outline import EdgeDerivatives

STEPS = 60
"""Newton steps after which no crossing is expected any more; mostly five suffice."""
LONGEST_STEP = 0.5
"""Largest Newton step, as a share of the flow path in t and of the straight line: longer ones leave the flow path."""


ENDS = np.array([0.0, 1.0])


class Rate(NamedTuple):
    """Derivative of a crossing of a straight line with a stream surface, as the line's start moves."""

    point: Array
    """(..., m, 3)"""
    t: Array
    """(..., m)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class RulingCrossings:
    """Where lines start + share * direction cross the stream surfaces at v (m,)."""

    surfaces: StreamSurfaces
    v: Reals
    direction: Array
    """(..., 3)"""
    point: Array
    """(..., m, k, 3)"""
    t: Array
    """(..., m, k) along the stream surface"""
    revolved: bool

    def carried(self, first: Array, second: Array) -> tuple[Rate, Rate]:
        """First and second derivatives of the first of the lines' crossings, from those of its start (..., 1, 3).

        By differentiating W(t) = start + share * direction, W on the stream surface, twice.
        """
        point, direction = self.point[..., 0, :], self.direction[..., None, :]
        t = self.t[..., :1]
        place, slope, bend = (at_complex(partial(self.surfaces.position, self.v), t, k)[..., 0, :] for k in range(3))
        matrix = _matrix(place, slope, point, direction, revolved=self.revolved)
        share, rate = _solved(matrix, _height(point, first, revolved=self.revolved))
        step = first + share[..., None] * direction
        right = _height(point, second, revolved=self.revolved) - np.stack(
            [bend[..., 0] * rate**2, _lifted(place, slope, bend, revolved=self.revolved) * rate**2], axis=-1
        )
        if self.revolved:
            right = right + np.stack([np.zeros_like(rate), dot(step[..., 1:], step[..., 1:])], axis=-1)
        again, rate_again = _solved(matrix, right)
        return Rate(step, rate), Rate(second + again[..., None] * direction, rate_again)


def ruling_crossings(
    surfaces: StreamSurfaces, v: Reals, start: Array, direction: Array, near: Reals, *, revolved: bool
) -> RulingCrossings:
    """Where lines from points (..., k, 3) of the hub, near t (k,), in a direction (..., 3) cross the stream surfaces.

    Raises DesignError where one leaves the flow path before.
    """
    position = partial(surfaces.position, v)
    begin, along = real_first(start, 2), real_first(direction, 1)
    share = np.broadcast_to(v[:, None], (len(v), len(near))).copy()
    t = np.broadcast_to(near, share.shape).copy()
    low, high = surfaces.extent
    for _ in range(STEPS):
        point = begin + share[..., None] * along
        place, slope = (real_first(position(t, k), 3) for k in (0, 1))
        miss = _miss(place, point, revolved=revolved)
        share_step, t_step = _solved(_matrix(place, slope, point, along, revolved=revolved), miss)
        share = share + np.clip(share_step, -LONGEST_STEP, LONGEST_STEP)
        t = np.clip(t + np.clip(t_step, -LONGEST_STEP * (high - low), LONGEST_STEP * (high - low)), low, high)
        if np.max(np.square(share_step)) < 1e-28:
            break
    _check(v, begin, along, share_step, t, (low, high))
    if not (np.iscomplexobj(start) or np.iscomplexobj(direction) or np.iscomplexobj(position(t, 0))):
        return RulingCrossings(surfaces=surfaces, v=v, direction=direction, point=point, t=t, revolved=revolved)
    point = start[..., None, :, :] + share[..., None] * direction[..., None, None, :]
    place, slope = position(t, 0), position(t, 1)
    miss = _miss(place, point, revolved=revolved)
    share_step, t_step = _solved(_matrix(place, slope, point, direction[..., None, None, :], revolved=revolved), miss)
    moved = share + share_step
    point = start[..., None, :, :] + moved[..., None] * direction[..., None, None, :]
    return RulingCrossings(surfaces=surfaces, v=v, direction=direction, point=point, t=t + t_step, revolved=revolved)


def at_complex(position: partial[Array], t: Array, order: int) -> Array:
    """Points or derivatives (..., m, k, 2) at t (..., m, k) that may carry an imaginary step."""
    real = real_first(t, 2)
    found: Array = position(real, order)
    if not np.iscomplexobj(t):
        return found
    return found + (t - real)[..., None] * position(real, order + 1)


def _height(point: Array, vector: Array, *, revolved: bool) -> Array:
    """What a vector (..., 3) at a point adds to (x, r^2 / 2), or (x, z) in a cascade (..., 2)."""
    rise = dot(point[..., 1:], vector[..., 1:]) if revolved else vector[..., 2] + 0.0 * point[..., 2]
    return np.stack(np.broadcast_arrays(vector[..., 0], rise), axis=-1)


def _miss(place: Array, point: Array, *, revolved: bool) -> Array:
    rise = (
        (dot(point[..., 1:], point[..., 1:]) - place[..., 1] ** 2) / 2.0 if revolved else point[..., 2] - place[..., 1]
    )
    return np.stack(np.broadcast_arrays(point[..., 0] - place[..., 0], rise), axis=-1)


def _matrix(place: Array, slope: Array, point: Array, direction: Array, *, revolved: bool) -> tuple[Array, Array]:
    """Derivatives (..., 2) of x and r^2 / 2, or z, by the share of the line and by t."""
    lift = slope[..., 1] * (place[..., 1] if revolved else 1.0)
    return _height(point, direction, revolved=revolved), np.stack([slope[..., 0], lift], axis=-1)


def _lifted(place: Array, slope: Array, bend: Array, *, revolved: bool) -> Array:
    """The second derivative of r^2 / 2, or z, by t."""
    return slope[..., 1] ** 2 + place[..., 1] * bend[..., 1] if revolved else bend[..., 1]


def _solved(matrix: tuple[Array, Array], miss: Array) -> tuple[Array, Array]:
    """Steps of share and t for which share * first - t * second = -miss."""
    first, second = matrix
    turn = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
    with np.errstate(all="ignore"):
        share = (miss[..., 1] * second[..., 0] - miss[..., 0] * second[..., 1]) / turn
        t = (first[..., 0] * miss[..., 1] - first[..., 1] * miss[..., 0]) / turn
    return share, t


def _check(v: Reals, begin: Reals, along: Reals, steps: Reals, t: Reals, extent: tuple[float, float]) -> None:
    not_met = ~(np.square(steps) < 1e-18)
    if not np.any(not_met):
        return
    row, at = np.argwhere(not_met)[0]
    where = ", ".join(f"{each:.5g}" for each in begin[at])
    run = ", ".join(f"{each:.4g}" for each in along)
    past = "past the end of the flow path" if t[row, at] in extent else "nowhere"
    raise DesignError(
        f"skinning is 'developable', and the straight line from the hub's section at ({where}) m in the direction "
        f"({run}) m meets the stream surface at v = {v[row]:.3f} {past}: all its lines run parallel to that from the "
        "hub's to the shroud's reference point; let them stand steeper on the walls by lean, sweep or stacking, "
        "lengthen hub and shroud, or take skinning = 'ruled'"
    )


def radius(mapping: StreamSurfaceMap, point: Array) -> Array:
    """r of points (..., 3), z in a cascade."""
    return np.sqrt(point[..., 1] ** 2 + point[..., 2] ** 2) if mapping.revolved else point[..., 2]


def tangential(mapping: StreamSurfaceMap, point: Array) -> Array:
    """theta of points (..., 3), y in a cascade."""
    return angle(point[..., 1], point[..., 2]) if mapping.revolved else point[..., 1]


@dataclass(frozen=True, kw_only=True, eq=False)
class DevelopableSections(FlowPathSections):
    """Sections at v (m,) of a generalised cylinder: the hub's section, moved along parallel straight lines.

    The lines run as the one from the hub's to the shroud's reference point does. The surface is developable: the
    tangent plane is the same all along a line, so that a flank cutter touches along the whole of it; native sides
    interpolate the distance along a fixed direction, and are cylinders to rounding. Curves of constant v lie on the
    stream surfaces. What is given up: every section but the hub's follows from that, and so do chord, stagger, angles
    and thickness; of the shroud nothing is the design's but the place of its reference point.
    """

    surfaces: StreamSurfaces
    hub: FamilySections
    """the section at the hub, of v (1,)"""
    direction: Array
    """(..., 3) of the straight lines, from the hub's reference point to the shroud's [m]"""

    def plane_points(self, s: Reals) -> tuple[Array, Array]:
        upper, lower = self.hub.plane_points(s)
        both = self._plane_points_of(concatenated([upper, lower], axis=-2))
        return both[..., : len(s), :], both[..., len(s) :, :]

    def _plane_points_of(self, hub_points: Array) -> Array:
        """Points (..., m, k, 2) of the planes where the rulings through plane points (..., 1, k, 2) of the hub go."""
        crossed, lines, mapping = self._crossing(hub_points), self.lines, self.mapping
        u = (crossed.t - lines.leading[..., None]) / (lines.trailing - lines.leading)[..., None]
        ordinate = mapping.start(tangential(mapping, crossed.point), radius(mapping, crossed.point), lines.lengths)
        return np.stack(np.broadcast_arrays(lines.abscissa(u), ordinate), axis=-1)

    @property
    def skinning(self) -> Literal["sections", "ruled", "developable"]:
        return "developable"

    @property
    def edge_kinds(self) -> tuple[str, str]:
        return self.hub.edge_kinds

    @property
    def back(self) -> float | None:
        return self.hub.back

    def outlines(self) -> Reals:
        upper, lower = (real_first(side, 3) for side in self.plane_points(FINE))
        return concatenated([upper, lower[:, ::-1]], axis=-2)

    def camber(self, share: Reals) -> Array:
        return self._plane_points_of(self.hub.camber(share))

    def camber_ends(self) -> tuple[Array, Array]:
        first, last = (self._direction(end, along) for end, along in enumerate(self.hub.camber_ends()))
        return first, last

    def points(self, s: Reals) -> tuple[Array, Array]:
        upper, lower = (self._crossing(side).point for side in self.hub.plane_points(s))
        return upper, lower

    def leading_edge(self) -> EdgeDerivatives:
        return self._row(self.hub.leading_edge(), self._edges[0])

    def trailing_edge(self) -> EdgeDerivatives:
        return self._row(self.hub.trailing_edge(), self._edges[1])

    def lower_edges(self) -> tuple[EdgeDerivatives | None, EdgeDerivatives | None]:
        first, last = (
            None if row is None else self._row(row, place)
            for row, place in zip(self.hub.lower_edges(), self._edges[2:], strict=True)
        )
        return first, last

    def faces(self, w: Reals) -> dict[str, Array]:
        upper, lower = self.hub.plane_points(ENDS)
        found = {}
        for name in self.hub.faces(w):
            at = 0 if name == "leading_edge" else 1
            ends = upper[..., at, None, :], lower[..., at, None, :]
            found[name] = self._crossing(ends[0] + w[:, None] * (ends[1] - ends[0])).point
        return found

    @cached_property
    def _edges(self) -> list[RulingCrossings]:
        """Crossings of the rulings at the upper side's edges, then at the lower side's."""
        upper, lower = self.hub.plane_points(ENDS)
        return [self._crossing(side[..., [end], :]) for side in (upper, lower) for end in (0, 1)]

    def _crossing(self, plane: Array) -> RulingCrossings:
        return _hub_crossings(self.surfaces, self.hub, self.direction, plane, self.v)

    def _row(self, row: EdgeDerivatives, crossed: RulingCrossings) -> EdgeDerivatives:
        first, second = crossed.carried(row.first, row.second)
        return EdgeDerivatives(crossed.point[..., 0, :], first.point, second.point)

    def _direction(self, end: int, along: Array) -> Array:
        """Directions (..., m, 2) in the planes of one (..., 1, 2) of the hub's plane at an end of the camber line."""
        hub, lines, mapping = self.hub, self.lines, self.mapping
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


def developable_sections(
    surfaces: StreamSurfaces, hub: FamilySections, references: Array, v: Reals
) -> DevelopableSections:
    """The developable blade at v (m,), from the section at the hub and reference points (..., 2, 3) of hub and shroud.

    Raises DesignError where a ruling misses a stream surface.
    """
    direction = references[..., 1, :] - references[..., 0, :]
    chord = hub.placed(np.array([[[0.0, 0.0], [1.0, 0.0]]]))
    t = _hub_crossings(surfaces, hub, direction, chord, v).t
    mapping = hub.mapping
    lines = blade_streamlines(surfaces, v, mapping, t[..., 0], t[..., 1])
    return DevelopableSections(v=v, lines=lines, surfaces=surfaces, hub=hub, direction=direction)


def _hub_crossings(
    surfaces: StreamSurfaces, hub: FamilySections, direction: Array, plane: Array, v: Reals
) -> RulingCrossings:
    """Where the rulings through plane points (..., 1, k, 2) of the hub cross the stream surfaces at v (m,)."""
    u, _, _ = hub.on_lines(plane)
    start = hub.in_space(plane)[..., 0, :, :]
    near = real_first(hub.lines.t(u), 2)[0]
    return ruling_crossings(surfaces, v, start, direction, near, revolved=hub.mapping.revolved)
