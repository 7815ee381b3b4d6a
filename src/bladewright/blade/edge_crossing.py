"""Where stream lines meet an edge curve, and where they come nearest to a point."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from bladewright.blade.meridian_line import MeridianLine
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross2, dot, length
from bladewright.nurbs.basis import Reals

REACH = 0.05
"""share of an edge curve by which it is continued past its ends to meet a wall that it was drawn short of"""
SAMPLES = 161
"""places on a stream line, and on an edge curve, between which meetings are looked for"""
STEPS = 40
"""Newton's steps after which no meeting is expected any more; mostly four do"""
SAME = 1e-7
"""meetings nearer than this, in the edge curve's parameter, are one"""

Position = Callable[[Reals, int], Array]
"""points (..., m, k, 2) of m stream lines at t (m, k), or their derivatives of an order"""


class Meeting(NamedTuple):
    """Where stream lines meet an edge curve."""

    t: Array
    """(..., m) on the stream lines"""
    q: Array
    """(..., m) own parameter on the edge curve"""


def crossed(
    position: Position, extent: tuple[float, float], edge: MeridianLine, name: str, labels: list[str]
) -> Meeting:
    """The meetings of m stream lines, t from extent[0] to extent[1], with an edge curve, to rounding.

    `name` is the edge curve's in what is refused, and `labels` (m,) the stream lines'. Raises DesignError where they do
    not meet, the edge curve continued by REACH of itself at both ends, or meet more than once.
    """
    low, high = extent
    t, q = np.linspace(low, high, SAMPLES), np.linspace(-REACH, 1.0 + REACH, SAMPLES)
    rows = _first(position(np.broadcast_to(t, (len(labels), SAMPLES)), 0), 3)
    curve = _first(edge.values(q), 2)
    found = [_of_line(position, i, len(labels), row, t, q, curve, edge) for i, row in enumerate(rows)]
    found = [[each for each in places if -SAME <= each[1] <= 1.0 + SAME] or places for places in found]
    for i, places in enumerate(found):
        if not places:
            raise DesignError(_missed(name, labels[i], rows[i], curve))
        if len(places) > 1:
            both = ", ".join(f"({_shown(edge, each[1])})" for each in places[:3])
            raise DesignError(
                f"{name} meets the stream line {labels[i]} {len(places)} times, at (x, r) = {both} m: an edge curve "
                "must cross every stream line once; move its points so that it runs from hub to shroud and does not turn "
                "back"
            )
    at, own = (np.array([places[0][k] for places in found]) for k in (0, 1))
    point, slope = position(at[:, None], 0)[..., 0, :], position(at[:, None], 1)[..., 0, :]
    miss, along = point - edge.values(own), edge.values(own, 1)
    # one more of Newton's steps, in complex numbers, is the derivative of the meeting
    turn = cross2(slope, along)
    return Meeting(at - cross2(miss, along) / turn, own - cross2(miss, slope) / turn)


def nearest(position: Position, extent: tuple[float, float], targets: Array, labels: list[str]) -> Array:
    """t (..., m) of the points at least distance from targets (..., m, 2), one on each of m stream lines.

    t is sought from extent[0] to extent[1]. Raises DesignError where the nearest point is an end of the stream line.
    """
    low, high = extent
    t = np.linspace(low, high, SAMPLES)
    aims = _first(targets, 2)
    rows = _first(position(np.broadcast_to(t, (len(labels), SAMPLES)), 0), 3)
    gaps = length(rows - aims[:, None, :])
    at = t[np.argmin(gaps, axis=1)]
    step = (high - low) / (SAMPLES - 1)
    left, right = np.maximum(at - step, low), np.minimum(at + step, high)
    for _ in range(STEPS):
        miss, slope, bend = _around(position, at, aims)
        value, rate = dot(miss, slope), dot(slope, slope) + dot(miss, bend)
        left, right = np.where(value < 0.0, at, left), np.where(value < 0.0, right, at)
        with np.errstate(all="ignore"):
            newton = at - value / rate
        inside = (rate > 0.0) & (newton >= left) & (newton <= right)
        after = np.where(inside, newton, 0.5 * (left + right))
        moved = np.max(np.square(after - at))
        at = after
        if moved < 1e-30 * (high - low) ** 2:
            break
    miss, slope, bend = _around(position, at, aims)
    open_ = np.square(dot(miss, slope)) > 1e-16 * dot(slope, slope) * (dot(miss, miss) + 1e-12 * dot(slope, slope))
    if np.any(open_):
        i = int(np.argmax(open_))
        end = "upstream" if at[i] < 0.5 * (low + high) else "downstream"
        raise DesignError(
            f"the point (x, r) = ({aims[i, 0]:.6g}, {aims[i, 1]:.6g}) m has no nearest point on the stream line "
            f"{labels[i]}: it stands past the {end} end of the flow path; lengthen hub and shroud there, or move the "
            "point"
        )
    point, slope, bend = (position(at[:, None], order)[..., 0, :] for order in range(3))
    miss = point - targets
    return at - dot(miss, slope) / (dot(slope, slope) + dot(miss, bend))


def _around(position: Position, at: Reals, aims: Reals) -> tuple[Reals, Reals, Reals]:
    point, slope, bend = (_first(position(at[:, None], order), 3)[:, 0, :] for order in range(3))
    return point - aims, slope, bend


def _of_line(
    position: Position, i: int, count: int, row: Reals, t: Reals, q: Reals, curve: Reals, edge: MeridianLine
) -> list[tuple[float, float]]:
    """Meetings (t, q) of one stream line with the edge curve: of their polygons, then by Newton's method."""
    a, c = np.diff(row, axis=0)[:, None, :], np.diff(curve, axis=0)[None, :, :]
    gap = curve[None, :-1, :] - row[:-1, None, :]
    turn = cross2(a, c)
    with np.errstate(all="ignore"):
        first, second = cross2(gap, c) / turn, cross2(gap, a) / turn
    near = (first >= -0.1) & (first <= 1.1) & (second >= -0.1) & (second <= 1.1)
    starts = [(t[j] + first[j, k] * (t[1] - t[0]), q[k] + second[j, k] * (q[1] - q[0])) for j, k in np.argwhere(near)]
    # where the polygons pass each other by less than the curves bend, the nearest of their points is tried as well
    distance = length(row[:, None, :] - curve[None, :, :])
    j, k = np.unravel_index(int(np.argmin(distance)), distance.shape)
    if not starts and distance[j, k] < 0.2 * (length(row[-1] - row[0]) + length(curve[-1] - curve[0])):
        starts.append((t[j], q[k]))
    found: list[tuple[float, float]] = []
    for start in starts:
        root = _refined(position, i, count, edge, start, (float(t[0]), float(t[-1])))
        if root is not None and all((root[1] - other[1]) ** 2 > SAME**2 for other in found):
            found.append(root)
    return sorted(found)


def _refined(
    position: Position, i: int, count: int, edge: MeridianLine, start: tuple[float, float], extent: tuple[float, float]
) -> tuple[float, float] | None:
    at, own = start
    room = 1e-9 * (extent[1] - extent[0])
    for _ in range(STEPS):
        t = np.full((count, 1), at)
        point, slope = (_first(position(t, order), 3)[i, 0] for order in (0, 1))
        place = np.array([own])
        miss, along = point - _first(edge.values(place), 2)[0], _first(edge.values(place, 1), 2)[0]
        turn = cross2(slope, along)
        if turn == 0.0:
            return None
        steps = float(cross2(miss, along) / turn), float(cross2(miss, slope) / turn)
        at, own = at - steps[0], own - steps[1]
        if not (extent[0] - 1.0 < at < extent[1] + 1.0 and -0.5 < own < 1.5):
            return None
        if steps[0] ** 2 < 1e-18 * (extent[1] - extent[0]) ** 2 and steps[1] ** 2 < 1e-18:
            inside = extent[0] - room <= at <= extent[1] + room and -REACH - SAME <= own <= 1.0 + REACH + SAME
            return (at, own) if inside else None
    return None


def _missed(name: str, label: str, row: Reals, curve: Reals) -> str:
    distance = length(row[:, None, :] - curve[None, :, :])
    j, k = np.unravel_index(int(np.argmin(distance)), distance.shape)
    end = {0: "starts", len(row) - 1: "ends"}.get(int(j))
    where = f"the stream line {end} at (x, r) = ({row[j, 0]:.6g}, {row[j, 1]:.6g}) m"
    if end is None:
        where = (
            f"the curve, continued by {100.0 * REACH:g}% of itself, ends at ({curve[k, 0]:.6g}, {curve[k, 1]:.6g}) m"
        )
    cure = "lengthen hub and shroud there" if end else "lengthen the curve to hub and shroud"
    return (
        f"{name} does not meet the stream line {label}: they pass {distance[j, k]:.4g} m apart, where {where}; {cure}, "
        f"or move {name} into the flow path"
    )


def _shown(edge: MeridianLine, q: float) -> str:
    x, r = _first(edge.values(np.array([q])), 2)[0]
    return f"{x:.6g}, {r:.6g}"


def _first(values: Array, axes: int) -> Reals:
    return np.asarray(np.real(values[(0,) * (values.ndim - axes)]))
