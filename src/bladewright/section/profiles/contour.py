"""What a closed contour of points is like: its sense, its corners, and the kinds of its edges."""

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bladewright.errors import DesignError
from bladewright.numerics.elementary import cross2, dot
from bladewright.nurbs.basis import Reals

MIN_CORNER_TURNING = 30.0
"""turning of a contour's polygon from which a point may be a corner: a smooth nose of six points or more turns by less
at each [deg]"""
MAX_NEIGHBOUR_TURNING = 0.1
"""largest turning at the neighbours of a corner, of the corner's own: on a round nose neighbours turn alike [-]"""
Indices = NDArray[np.intp]
Kind = Literal["round", "sharp", "blunt"]


class Contour(NamedTuple):
    """Indices of a contour's points, counter-clockwise, and where its edges are among them."""

    order: Indices
    """indices of the points as given, from the trailing edge, or from the leading edge where only that is broken"""
    leading: tuple[int, ...]
    """places in `order` of the leading edge's corners, or of the point farthest from the trailing edge"""
    trailing: tuple[int, ...]
    """places in `order` of the trailing edge's corners, or of the point farthest from the leading edge"""
    kinds: tuple[Kind, Kind]
    """of the leading and the trailing edge"""


def contour(points: Reals) -> Contour:
    """The contour of points (n, 2) in order along it, in either sense; the leading edge has the smaller abscissa.

    A corner is a point where the polygon turns by 30 deg or more and ten times as much as beside it. Raises
    DesignError for corners that are not at the edges.
    """
    order = np.arange(len(points))
    ahead = np.roll(points, -1, axis=0)
    if np.sum(cross2(points, ahead)) < 0.0:
        order = order[::-1]
    placed = points[order]
    apart = placed[:, None] - placed
    first, second = np.unravel_index(np.argmax(dot(apart, apart)), apart.shape[:2])
    le, te = (int(first), int(second)) if placed[first, 0] < placed[second, 0] else (int(second), int(first))
    corners = [int(i) for i in _corners(placed)]
    chord = placed[te] - placed[le]
    along = (placed - placed[le]) @ chord / dot(chord, chord)
    ends: list[tuple[int, ...]] = []
    for tip, there in ((le, along < 0.1), (te, along > 0.9)):
        own = tuple(i for i in corners if there[i])
        if len(own) > 2 or (len(own) == 2 and (own[1] - own[0]) % len(placed) not in (1, len(placed) - 1)):
            raise _misplaced(order[own[0]], placed[own[0]])
        ends.append(own or (tip,))
    for i in corners:
        if all(i not in end for end in ends):
            raise _misplaced(order[i], placed[i])
    kinds: list[Kind] = ["round" if end[0] not in corners else "sharp" if len(end) == 1 else "blunt" for end in ends]
    leading, trailing = (_ordered(end, len(placed)) for end in ends)
    start = leading[-1] if kinds[1] == "round" and kinds[0] != "round" else trailing[-1]
    turned = (np.arange(len(placed)) + start) % len(placed)
    where = {int(i): k for k, i in enumerate(turned)}
    return Contour(
        order=order[turned],
        leading=tuple(where[i] for i in leading),
        trailing=tuple(where[i] for i in trailing),
        kinds=(kinds[0], kinds[1]),
    )


def _ordered(end: tuple[int, ...], count: int) -> tuple[int, ...]:
    """The corners of an edge in the sense of the contour."""
    return end if len(end) == 1 or (end[1] - end[0]) % count == 1 else end[::-1]


def _corners(points: Reals) -> Indices:
    """Indices of the points of a closed polygon (n, 2) that are corners."""
    ahead = np.roll(points, -1, axis=0) - points
    behind = np.roll(ahead, 1, axis=0)
    turning = np.degrees(np.arctan2(cross2(behind, ahead), dot(behind, ahead)))  # real: points to judge by
    size = np.abs(turning)  # real: angles
    before, after = np.roll(size, 1), np.roll(size, -1)
    # at a blunt edge the other corner is no smooth neighbour: both are judged together, by the neighbours outside
    paired = (size >= MIN_CORNER_TURNING) & (np.maximum(before, after) >= MIN_CORNER_TURNING)
    whole = np.where(paired, size + np.maximum(before, after), size)
    beside = np.where(paired, np.minimum(before, after), np.maximum(before, after))
    return np.flatnonzero((size >= MIN_CORNER_TURNING) & (beside <= MAX_NEIGHBOUR_TURNING * whole))


def _misplaced(index: int, point: Reals) -> DesignError:
    return DesignError(
        f"the contour has a corner at point {int(index)}, ({point[0]:g}, {point[1]:g}), that is not one of an edge: "
        "profiles are smooth but for sharp edges, one point each, and blunt ones, two points each; give more points "
        "there, or take the corner away"
    )
