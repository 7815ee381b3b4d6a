"""The flow path and the edge curves of a blade from sections, as a closed blade in a channel shows them."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from bladewright.blade.design.flow_path import FlowPath
from bladewright.blade.design.meridional_curve import ControlPolygon, Meridian, ThroughPoints
from bladewright.blade.flow_path.stream_surfaces import stream_surfaces
from bladewright.blade.native.blade import Blade
from bladewright.designs import Point
from bladewright.errors import DesignError, FitError
from bladewright.fitting.free_parameters import WALLS
from bladewright.numerics.elementary import cumulative_length, unit
from bladewright.nurbs.basis import Reals, basis, uniform_knots

WALL_COUNTS = (3, 4, 5, 7, 9)
"""points on each wall beside the blade; the fewest are taken that are near enough."""
WALL_DISTANCE = 0.01
"""distance of a wall from the one that was found that is near enough, of its length: walls found by points alone are no
better known, and they are parameters."""
WALL_MARGIN = 0.1
"""distance ahead of and behind the blade of the first and last of these points, of its length."""
CONTINUATIONS = (0.8, 0.4, 0.2)
"""lengths of the straight continuations at whose ends points stand, of the wall's: the first are taken that do not
fold"""
LEAST_RADIUS = 0.6
"""share of the radius at its end that the continuation may lose: it must not meet the axis."""
EDGE_POINTS = 4
"""points on an edge curve"""
EDGE_OVERREACH = 0.06
"""length by which an edge curve reaches past the walls, of its length; `EDGE_OVERREACH_LIKE` is how many times that
where points of another curve say how far it reaches."""
EDGE_OVERREACH_LIKE = 4.0
"""the same where the points of another curve say how far it reaches, in multiples"""
OPPOSITE_CURVE = {"leading_edge": "trailing_edge", "trailing_edge": "leading_edge", "hub": "shroud", "shroud": "hub"}
"""the curve in whose place each stands when the flow comes from the other side"""
CURVE_PLACES: Reals = np.linspace(0.0, 1.0, 201)
"""parameters at which curves are sampled"""


@dataclass(frozen=True, kw_only=True)
class ChannelCurves:
    """A closed blade's channel, for the flow that it was found for, or for flow from the other side."""

    blade: Blade
    backwards: bool = False

    def values(self, name: str, at: Reals) -> Reals:
        """Points (m, 2) of one of the four curves in (x, r) [m]: walls downstream, edges from hub to shroud."""
        channel: Any = self.blade.exact.channel  # type: ignore[attr-defined]
        if self.backwards:
            name, at = OPPOSITE_CURVE[name], 1.0 - at
        return np.asarray(np.real(channel.line(name).values(at)))

    def flow_path(self, metre: float, *, revolved: bool) -> FlowPath:
        """Hub and shroud, continued straight by equal parts of their lengths, so that the blade's ends match.

        How far they are continued says which points of them are joined, which is a parameter. Where these surfaces
        fold, fractions count from edge to edge.
        """
        lines = [self.values(name, CURVE_PLACES) for name in WALLS]
        for longest in CONTINUATIONS:
            shares = np.min([_shares_off_axis(line, longest) for line in lines], axis=0)
            hub, shroud = (ThroughPoints(points=_points(_wall(line, shares), metre)) for line in lines)
            path = FlowPath(hub=hub, shroud=shroud)
            with suppress(DesignError):
                stream_surfaces(path, metre, revolved=revolved)
                return path
        return replace(path, matched="edges")

    def edge(self, name: str, metre: float) -> ThroughPoints:
        """An edge as a curve through a few points that reaches past both walls."""
        line = _extended(self.values(name, CURVE_PLACES))
        at = np.linspace(0.0, len(line) - 1.0, EDGE_POINTS)
        return ThroughPoints(points=_points(_along(line, at), metre))

    def edge_like(self, name: str, curve: Any, metre: float) -> Meridian:
        """The edge with the points of another curve, in their places along the edge."""
        if isinstance(curve, ThroughPoints):
            own, field = curve.points, "points"
        elif isinstance(curve, ControlPolygon):
            own, field = curve.control_points, "control_points"
        else:
            raise FitError(
                f"the {name} of `like` is given by corners or by a stacking: only points or control points are "
                "fitted; give the design as start"
            )
        given = metre * np.array([[float(np.real(each.x)), float(np.real(each.r))] for each in own])
        line = _extended(self.values(name, CURVE_PLACES), EDGE_OVERREACH_LIKE)
        # the coordinate in which the edge has its extent is held, the other is the edge's there
        axis = 1 if np.ptp(given[:, 1]) >= np.ptp(given[:, 0]) else 0
        order = np.argsort(line[:, axis])
        if isinstance(curve, ThroughPoints):
            free = np.interp(given[:, axis], line[order, axis], line[order, 1 - axis])
        else:
            degree = min(len(given) - 1, curve.degree)
            rows = basis(uniform_knots(len(given), degree), degree, CURVE_PLACES)
            wanted = np.interp(rows @ given[:, axis], line[order, axis], line[order, 1 - axis])
            free = np.linalg.lstsq(rows, wanted, rcond=None)[0]
        found = given.copy()
        found[:, 1 - axis] = free
        return replace(curve, **{field: _points(found, metre)})


def _wall(line: Reals, shares: Reals) -> Reals:
    """Points of a wall, a line (n, 2) continued straight by shares (2,) of it: as few as follow it."""
    way = cumulative_length(line)
    size = float(way[-1])
    ends = shares[:, None] * size * _outward(line)
    longer = np.concatenate([[line[0] + ends[0]], line, [line[-1] + ends[1]]])
    along = cumulative_length(longer)
    low, high = along[1] - WALL_MARGIN * size, along[-2] + WALL_MARGIN * size
    rows = longer
    for count in WALL_COUNTS:
        at = np.concatenate([along[:1], np.linspace(max(low, 0.5 * along[1]), high, count), along[-1:]])
        at[-2] = min(at[-2], 0.5 * (along[-1] + along[-2]))
        rows = np.stack([np.interp(at, along, longer[:, i]) for i in (0, 1)], axis=-1)
        curve = np.real(ThroughPoints(points=_points(rows, 1.0)).line(1.0).values(np.linspace(0.0, 1.0, 801)))
        if np.max(cKDTree(curve).query(line)[0]) <= WALL_DISTANCE * size:
            break
    return rows


def _outward(line: Reals) -> Reals:
    """The directions (2, 2) in which a line leaves its ends."""
    return np.stack([unit(line[0] - line[1]), unit(line[-1] - line[-2])])


def _shares_off_axis(line: Reals, longest: float) -> Reals:
    """The shares (2,) of a line's length by which it may be continued at its ends, so as to keep off the axis."""
    fall = -float(cumulative_length(line)[-1]) * _outward(line)[:, 1]
    radius = np.maximum(line[[0, -1], 1], 0.0)
    return np.where(fall > 0.0, np.minimum(longest, LEAST_RADIUS * radius / np.where(fall > 0.0, fall, 1.0)), longest)


def _extended(line: Reals, times: float = 1.0) -> Reals:
    """A line (n, 2) that is continued straight past both ends."""
    size = float(cumulative_length(line)[-1])
    steps = times * EDGE_OVERREACH * size * np.linspace(0.0, 1.0, 13)[1:, None]
    first, last = unit(line[0] - line[1]), unit(line[-1] - line[-2])
    return np.concatenate([(line[0] + steps * first)[::-1], line, line[-1] + steps * last])


def _along(line: Reals, at: Reals) -> Reals:
    index = np.arange(len(line), dtype=np.float64)
    return np.stack([np.interp(at, index, line[:, i]) for i in (0, 1)], axis=-1)


def _points(rows: Reals | Sequence[Reals], metre: float) -> tuple[Point, ...]:
    return tuple(Point(float(x) / metre, float(r) / metre) for x, r in rows)
