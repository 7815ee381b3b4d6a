"""Where stream lines meet an edge curve, and where along the span that curve loses derivatives."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.flow_path.meridional_curve import MeridionalCurve, real_first
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, cross2, length
from bladewright.nurbs.basis import Reals

if TYPE_CHECKING:
    from bladewright.blade.flow_path.stream_surfaces import StreamSurfaces

EXTENSION = 0.05
"""How far an edge curve is continued past each end, as a share of its parameter, to meet a wall that it was drawn
short of. A longer one would let curves meet walls that they were not meant for."""
SAMPLES = 65
"""Points on a stream line, and on an edge curve, from whose polygons the intersections start: two intersections
between neighbouring points may be missed."""
STEPS = 40
"""Newton steps after which no intersection is expected any more; mostly four suffice."""
JOINT_STEPS = 6
"""Newton steps from an interpolated point to the span fraction of a joint."""
SAME = 1e-7
"""Intersections nearer than this in the edge curve's parameter are one: far above rounding, far below any two."""

Position = Callable[[Reals, int], Array]
"""points (..., m, k, 2) of m stream lines at t (m, k), or their derivatives of an order"""


def intersections(
    position: Position,
    extent: tuple[float, float],
    edge: MeridionalCurve,
    name: str,
    labels: list[str],
    *,
    real: Position | None = None,
) -> tuple[Array, Array]:
    """Where m stream lines, t from extent[0] to extent[1], meet an edge curve, to rounding.

    Returns t (..., m) on the stream lines, and the edge curve's own parameter (..., m).
    `name` is what the edge curve is called in what is refused, and `labels` (m,) what the stream lines are; `real` are
    their points without imaginary parts and batch, by which the search is faster. Raises DesignError where they do not
    meet, the edge curve continued by EXTENSION of itself at both ends, or meet more than once.
    """
    t, q = np.linspace(*extent, SAMPLES), np.linspace(-EXTENSION, 1.0 + EXTENSION, SAMPLES)
    real = position if real is None else real
    rows = real_first(real(np.broadcast_to(t, (len(labels), SAMPLES)), 0), 3)
    curve = real_first(edge.values(q), 2)
    at, own, met = _refined(real, edge.real(), *_starts(rows, curve, t, q), extent)
    chosen = []
    for i, label in enumerate(labels):
        places = _apart(at[i][met[i]], own[i][met[i]])
        if not places:
            raise DesignError(_missed(name, label, rows[i], curve))
        if len(places) > 1:
            both = " and ".join(_shown(edge, each[1]) for each in places[:2])
            raise DesignError(
                f"{name} meets {label} {len(places)} times, at (x, r) = {both} m: an edge curve must "
                "cross every stream line once; move its points so that it runs from hub to shroud without turning back"
            )
        chosen.append(places[0])
    at, own = (np.array([place[k] for place in chosen]) for k in (0, 1))
    point, slope = position(at[:, None], 0)[..., 0, :], position(at[:, None], 1)[..., 0, :]
    miss, along = point - edge.values(own), edge.values(own, 1)
    # one more of Newton's steps, in complex numbers, is the derivative of the meeting
    turn = cross2(slope, along)
    return at - cross2(miss, along) / turn, own - cross2(miss, slope) / turn


def meeting(curve: MeridionalCurve, edge: MeridionalCurve, name: str, label: str) -> tuple[Array, Array]:
    """Where an edge curve crosses one other curve: parameters (..., 1) of that, and of the edge curve."""

    def along(line: MeridionalCurve) -> Position:
        return lambda t, order: line.values(t[0], order)[..., None, :, :]

    return intersections(along(curve), (0.0, 1.0), edge, name, [label], real=along(curve.real()))


def curve_joints(
    surfaces: "StreamSurfaces", curve: MeridionalCurve, v: Reals, met: tuple[Array, Array]
) -> list[tuple[float, int]]:
    """v at which an edge curve or stacking line loses derivatives, and how many it keeps there.

    `met` is where the stream lines at increasing v (m,), from 0 to 1, meet it: t, and its own parameter.
    """
    levels, smooth = curve.smoothness()
    if len(levels) == 0:
        return []
    t, q = (real_first(each, 1) for each in met)
    if q[0] > q[-1]:
        t, q, v = t[::-1], q[::-1], v[::-1]
    inside = (levels > q[0]) & (levels < q[-1])
    at = np.interp(levels[inside], q, v)
    own = np.interp(levels[inside], q, t)
    target = real_first(curve.values(levels[inside]), 2)
    for _ in range(JOINT_STEPS):
        point, along, across = (real_first(each, 2) for each in surfaces.at(own, at))
        turn, miss = cross2(along, across), target - point
        own = np.clip(own + cross2(miss, across) / turn, surfaces.low, surfaces.high)
        at = np.clip(at + cross2(along, miss) / turn, 0.0, 1.0)
    return list(zip(at.tolist(), smooth[inside].tolist(), strict=True))


def _starts(rows: Reals, curve: Reals, t: Reals, q: Reals) -> tuple[Reals, Reals]:
    """t and q (m, c) where the lines' polygons meet the curve's, the nearest of their points among them."""
    found: list[list[tuple[float, float]]] = []
    c = np.diff(curve, axis=0)[None, :, :]
    for row in rows:
        a, gap = np.diff(row, axis=0)[:, None, :], curve[None, :-1, :] - row[:-1, None, :]
        turn = cross2(a, c)
        with np.errstate(all="ignore"):
            first, second = cross2(gap, c) / turn, cross2(gap, a) / turn
        # curves bend away from their polygons
        near = np.argwhere((first >= -0.1) & (first <= 1.1) & (second >= -0.1) & (second <= 1.1))
        distance = np.sum(np.square(row[:, None, :] - curve[None, :, :]), axis=-1)
        j, k = np.unravel_index(int(np.argmin(distance)), distance.shape)
        met = [(t[j] + first[j, k] * (t[1] - t[0]), q[k] + second[j, k] * (q[1] - q[0])) for j, k in near]
        found.append([(t[j], q[k]), *met])
    most = max(len(each) for each in found)
    padded = np.array([each + [each[0]] * (most - len(each)) for each in found])
    return padded[..., 0], padded[..., 1]


def _refined(
    position: Position, edge: MeridionalCurve, at: Reals, own: Reals, extent: tuple[float, float]
) -> tuple[Reals, Reals, Reals]:
    """Meetings t and q (m, c) by Newton's method, and whether each is one."""
    low, high = extent
    for _ in range(STEPS):
        point, slope = (real_first(position(at, order), 3) for order in (0, 1))
        flat = own.ravel()
        miss = point - real_first(edge.values(flat), 2).reshape(point.shape)
        along = real_first(edge.values(flat, 1), 2).reshape(point.shape)
        turn = cross2(slope, along)
        with np.errstate(all="ignore"):
            steps = cross2(miss, along) / turn, cross2(miss, slope) / turn
        # what runs far past the ends meets nothing: it is held there
        at_next = np.clip(np.where(turn == 0.0, at, at - steps[0]), low - 0.1 * (high - low), high + 0.1 * (high - low))
        own_next = np.clip(np.where(turn == 0.0, own, own - steps[1]), -0.5, 1.5)
        moved = np.square((at_next - at) / (high - low)) + np.square(own_next - own)
        at, own = at_next, own_next
        if np.max(moved) < 1e-26:
            break
    met = (moved < 1e-18) & (turn != 0.0) & (own >= -EXTENSION - SAME) & (own <= 1.0 + EXTENSION + SAME)
    margin = 1e-9 * (high - low)
    return (
        at,
        own,
        met & (at >= low - margin) & (at <= high + margin) & (np.square(steps[0]) < 1e-16 * (high - low) ** 2),
    )


def _apart(at: Reals, own: Reals) -> list[tuple[float, float]]:
    """Different meetings, those on the edge curve itself where there are any, before those past its ends."""
    found: list[tuple[float, float]] = []
    for place in zip(at.tolist(), own.tolist(), strict=True):
        if all((place[1] - other[1]) ** 2 > SAME**2 for other in found):
            found.append(place)
    return sorted([each for each in found if -SAME <= each[1] <= 1.0 + SAME] or found)


def _missed(name: str, label: str, row: Reals, curve: Reals) -> str:
    distance = length(row[:, None, :] - curve[None, :, :])
    j, k = np.unravel_index(int(np.argmin(distance)), distance.shape)
    end = {0: "starts", len(row) - 1: "ends"}.get(int(j))
    where, cure = f"the stream line {end} at (x, r) = {_pair(row[j])} m", "lengthen hub and shroud there"
    if end is None:
        where = f"the curve, continued by {100.0 * EXTENSION:g}% of itself, ends at {_pair(curve[k])} m"
        cure = "lengthen the curve to hub and shroud"
    return (
        f"{name} does not meet {label}: they pass {distance[j, k]:.4g} m apart, where {where}; {cure}, "
        f"or move {name} into the flow path"
    )


def _shown(edge: MeridionalCurve, q: float) -> str:
    return _pair(real_first(edge.values(np.array([q])), 2)[0])


def _pair(point: Reals) -> str:
    return f"({point[0]:.6g}, {point[1]:.6g})"
