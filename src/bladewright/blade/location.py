"""The way back: from points in space to the stream surface that they lie on, and to its plane."""

from typing import NamedTuple

import numpy as np

from bladewright.blade.mapping import Mapping
from bladewright.blade.meridian_line import real_first
from bladewright.blade.stream_surfaces import StreamSurfaces
from bladewright.blade.streamlines import stream_lines
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


def in_plane(surfaces: StreamSurfaces, mapping: Mapping, points: Array) -> InPlane:
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
