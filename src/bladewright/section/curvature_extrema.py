"""The extrema of the curvature along a section's sides, which show whether a side waves."""

import numpy as np

from bladewright.numerics.elementary import length
from bladewright.nurbs.basis import Reals, breaks
from bladewright.section.section import Section

PROMINENCE = 0.05
"""prominence that an extremum of the curvature must have, as a fraction of the curvature there, or of the
side's median where that is larger: what a designer would see in a plot, and far above rounding [-]"""
FLAT = 0.02
"""curvature times the side's length below which a side counts as straight: it turns by about a degree over its length
[-]"""
EDGE = np.pi / 3.0
"""turning from an edge within which the largest curvature belongs to the edge: two thirds of the quarter turn that a
side makes around a round edge [rad]"""
NEAR = 0.2
"""part of the side's length within which the largest curvature belongs to the edge, where the side turns by less [-]"""
PER_SPAN = 16
"""samples of the curvature in a knot span: the polynomials there are of degree four or five, and ten already give the
same count"""


def curvature_extrema(section: Section, name: str, *, per_span: int = PER_SPAN) -> int:
    """The number of extrema of the curvature of a side, `upper` or `lower`, between its two edges.

    The curvature is the signed one, geodesic on a stream surface. Counting starts at the leading edge's own maximum,
    the largest curvature until the side has turned by 60 deg from the edge or a fifth of it is passed, and ends at the
    trailing edge's; neither of them counts. The extrema between alternate, minimum first and last, so the number is
    odd: 1 for a side whose curvature falls from one edge and rises to the other, 3 for one with a hump between, 5 and
    more for one that waves.

    Only what stands out counts: the curvature must turn back by at least 5 % of itself, or of its median along the
    side where it is smaller than that, before the next extremum (on the scale asinh(curvature / median), which rounding
    does not reach). The number does not change with the size of the section, nor with `per_span`, the number of samples
    in a knot span, once that is ten or so: unless an extremum stands out by just the limit.
    """
    return len(turning_places(section, name, per_span=per_span))


def turning_places(section: Section, name: str, *, per_span: int = PER_SPAN) -> Reals:
    """The parameters u (n,) of those extrema, from the leading to the trailing edge."""
    u = _samples(section, name, per_span)
    curvature = (-1.0 if name == "upper" else 1.0) * section.curvature(name, u)
    step = _steps(section, name, u)
    median = _median(np.sqrt((curvature[1:] + curvature[:-1]) ** 2) / 2.0, step)
    height = np.arcsinh(curvature / max(median, FLAT / float(np.sum(step))))
    turned = np.concatenate([[0.0], np.cumsum((curvature[1:] + curvature[:-1]) / 2.0 * step)])
    first = _peak(curvature, turned, step)
    last = len(u) - 1 - _peak(curvature[::-1], (turned[-1] - turned)[::-1], step[::-1])
    return u[first : last + 1][turning_points(height[first : last + 1], PROMINENCE)]


def turning_points(height: Reals, prominence: float) -> list[int]:
    """Indices of the interior extrema of a sequence (n,) that starts downwards, each `prominence` off its neighbours.

    An extremum counts where the sequence has come to it by at least `prominence` since the extremum before, and
    leaves it by as much before passing it again.
    """
    found: list[int] = []
    best, sign = 0, 1.0
    # in turns a maximum (the first is the start) and a minimum are sought
    for i in range(1, len(height)):
        if sign * height[i] > sign * height[best]:
            best = i
        elif sign * (height[best] - height[i]) >= prominence:
            found.append(best)
            best, sign = i, -sign
    return found[1:]


def _samples(section: Section, name: str, per_span: int) -> Reals:
    """Parameters along a side, four times as dense in the knot spans at the edges."""
    ends = breaks(section.curves[name].knots).tolist()
    count = np.full(len(ends) - 1, per_span)
    count[[0, -1]] = 4 * per_span
    parts = [np.linspace(ends[i], ends[i + 1], int(count[i]), endpoint=False) for i in range(len(count))]
    return np.append(np.concatenate(parts), ends[-1])


def _steps(section: Section, name: str, u: Reals) -> Reals:
    """Lengths (n - 1,) of the side between parameters u (n,) [m]."""
    point = np.real(section.curves[name](u))
    abscissa = point[:, 0]
    # it changes along the stream line alone, slowly
    few = np.linspace(np.min(abscissa), np.max(abscissa), 33)
    scale = np.interp(abscissa, few, np.real(section.scale(few)))
    return length(np.diff(point, axis=0)) * (scale[1:] + scale[:-1]) / 2.0


def _median(values: Reals, weights: Reals) -> float:
    """The value that half of the total weight lies below."""
    order = np.argsort(values)
    return float(values[order][np.searchsorted(np.cumsum(weights[order]), 0.5 * np.sum(weights))])


def _peak(curvature: Reals, turned: Reals, step: Reals) -> int:
    """Index of the largest curvature near the start."""
    beyond = (turned[1:] > EDGE) | (np.cumsum(step) > NEAR * np.sum(step))
    return int(np.argmax(curvature[: 1 + int(np.argmax(beyond))]))
