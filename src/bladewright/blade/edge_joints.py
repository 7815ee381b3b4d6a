"""Span fractions at which a curve across the stream lines loses derivatives."""

import numpy as np

from bladewright.blade.edge_crossing import Meeting
from bladewright.blade.meridian import Meridian, ThroughPoints
from bladewright.blade.meridian_line import MeridianLine, real_first
from bladewright.blade.stream_surfaces import StreamSurfaces
from bladewright.numerics.elementary import cross2
from bladewright.nurbs.basis import Reals

NEWTON = 6
"""Newton's steps from an interpolated place to the span fraction of a joint"""


def curve_joints(
    surfaces: StreamSurfaces, meridian: Meridian, line: MeridianLine, v: Reals, meeting: Meeting
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
