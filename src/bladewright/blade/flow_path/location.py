"""Where points lie in a flow path: their stream surface, their place along it, and their point in its plane."""

from typing import NamedTuple

import numpy as np

from bladewright.blade.design.meridional_curve import Meridian, ThroughPoints
from bladewright.blade.flow_path.intersections import Intersection
from bladewright.blade.flow_path.meridional_curve import MeridionalCurve, real_first
from bladewright.blade.flow_path.stream_surface_map import StreamSurfaceMap
from bladewright.blade.flow_path.stream_surfaces import StreamSurfaces
from bladewright.blade.flow_path.streamlines import stream_lines
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, angle, cross2, length
from bladewright.nurbs.basis import Reals

STEPS = 40
"""Newton's steps after which a place is not expected any more"""
OUTSIDE = 1e-9
"""how far past the flow path, in t and v, a point may lie: rounding"""
TINY = 1e-30
"""an imaginary step: its derivative has no error"""


class Location(NamedTuple):
    """Where points lie in a flow path."""

    t: Array
    """(..., k) along the stream surfaces"""
    v: Array
    """(..., k) span fraction"""


class InPlane(NamedTuple):
    """Where points lie in the planes of their stream surfaces."""

    v: Array
    """(..., k) span fraction"""
    abscissa: Array
    """(..., k) 0 where t is 0"""
    ordinate: Array
    """(..., k)"""


def located(surfaces: StreamSurfaces, points: Array) -> Location:
    """t and v of points (x, r) (..., k, 2), to rounding; DesignError where one lies outside the flow path."""
    aims, real = real_first(points, 2), surfaces.real()
    t, v = _started(real, aims)
    low, high = surfaces.low, surfaces.high
    for _ in range(STEPS):
        point, along, across = real.at(t, v)
        miss = aims - point
        turn = cross2(along, across)
        by_t, by_v = cross2(miss, across) / turn, cross2(along, miss) / turn
        t_next, v_next = np.clip(t + by_t, low, high), np.clip(v + by_v, 0.0, 1.0)
        size = float(np.max(np.square(t_next - t) + np.square(v_next - v), initial=0.0))
        t, v = t_next, v_next
        # a step this small leaves an error of its square
        if size < 1e-24:
            break
    point, along, across = surfaces.at(t, v)
    turn = cross2(along, across)
    miss = points - point
    by_t, by_v = cross2(miss, across) / turn, cross2(along, miss) / turn
    past = np.square(np.real(by_t) / (high - low)) + np.square(np.real(by_v))
    if np.max(past, initial=0.0) > OUTSIDE**2:
        worst = int(np.argmax(past.reshape(-1, past.shape[-1])[0]))
        x, r = aims[worst]
        away = float(length(real_first(miss, 2)[worst]))
        raise DesignError(
            f"the point (x, r) = ({x:.6g}, {r:.6g}) m lies {away:.4g} m outside the flow path: it has a stream surface "
            "only between hub and shroud, from the start of both to their ends; move it, or lengthen hub and shroud"
        )
    return Location(t + by_t, v + by_v)


def in_plane(surfaces: StreamSurfaces, mapping: StreamSurfaceMap, points: Array) -> InPlane:
    """v, abscissa and ordinate of points (..., k, 3) in metres, in the plane of each one's own stream surface.

    Raises DesignError where one lies outside the flow path. Source: the inverse of `Mapping.in_space`.
    """
    if mapping.revolved:
        radius = length(points[..., 1:])
        tangential = angle(points[..., 1], points[..., 2])
    else:
        radius, tangential = points[..., 2], points[..., 1]
    place = located(surfaces, np.stack([points[..., 0], radius], axis=-1))
    t, v = real_first(place.t, 1), real_first(place.v, 1)
    lines = stream_lines(surfaces, mapping, v, -surfaces.low, surfaces.high - 1.0)
    abscissa = lines.abscissa(t[:, None])[..., 0]
    if np.iscomplexobj(place.t):
        real, held = lines.real(), surfaces.real()
        slope = mapping.density(real.position(t[:, None]), real.position(t[:, None], 1))[..., 0]
        nudged = stream_lines(held, mapping, v + 1j * TINY, -held.low, held.high - 1.0)
        by_v = np.imag(nudged.abscissa(t[:, None])[..., 0]) / TINY
        abscissa = abscissa + 1j * (slope * np.imag(place.t) + by_v * np.imag(place.v))
    ordinate = mapping.start(tangential, radius, lines.lengths)
    return InPlane(place.v, abscissa, ordinate)


def _started(surfaces: StreamSurfaces, aims: Reals) -> tuple[Reals, Reals]:
    """t and v of the nearest of a grid of points."""
    t, v = np.linspace(surfaces.low, surfaces.high, 61), np.linspace(0.0, 1.0, 17)
    grid_t, grid_v = (each.ravel() for each in np.meshgrid(t, v, indexing="ij"))
    grid = surfaces.grid(t, v)[0].reshape(-1, 2)
    found = np.array([int(np.argmin(np.sum(np.square(grid - aim), axis=-1))) for aim in aims])
    return grid_t[found], grid_v[found]


NEWTON = 6
"""Newton's steps from an interpolated place to the span fraction of a joint"""


def curve_joints(
    surfaces: StreamSurfaces, meridian: Meridian, line: MeridionalCurve, v: Reals, meeting: Intersection
) -> list[tuple[float, int]]:
    """v at which an edge curve or stacking line loses derivatives, and how many it keeps there.

    `meeting` is where the stream lines at increasing v (m,), from 0 to 1, meet it.
    """
    levels, counts = np.unique(line.knots[line.degree + 1 : -line.degree - 1], return_counts=True)
    if isinstance(meridian, ThroughPoints) and meridian.ends == "smooth":
        # one cubic goes over the first two intervals, and one over the last two
        levels, counts = levels[1:-1], counts[1:-1]
    if len(levels) == 0:
        return []
    # a spline through points keeps two derivatives, though its knots would let it lose one
    smooth = [2 if isinstance(meridian, ThroughPoints) else line.degree - int(count) for count in counts]
    t, q = real_first(meeting.t, 1), real_first(meeting.q, 1)
    if q[0] > q[-1]:
        t, q, v = t[::-1], q[::-1], v[::-1]
    met = (levels > q[0]) & (levels < q[-1])
    at = np.interp(levels[met], q, v)
    own = np.interp(levels[met], q, t)
    target = real_first(line.values(levels[met]), 2)
    for _ in range(NEWTON):
        point, along, across = (real_first(each, 2) for each in surfaces.at(own, at))
        turn, miss = cross2(along, across), target - point
        own = np.clip(own + cross2(miss, across) / turn, surfaces.low, surfaces.high)
        at = np.clip(at + cross2(along, miss) / turn, 0.0, 1.0)
    return list(zip(at.tolist(), np.array(smooth)[met].tolist(), strict=True))
