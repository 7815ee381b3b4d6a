"""Edges around which a cloud has no points: a blade that is open there, or half of one."""

import numpy as np
from numpy.typing import NDArray

from bladewright.blade.unified import UnifiedBlade
from bladewright.fitting.matching.feet import Feet, Side, placed
from bladewright.fitting.matching.search import Found
from bladewright.nurbs.basis import Reals
from bladewright.section.unified import UnifiedSection

EDGES = {"leading edge": 0.0, "trailing edge": 1.0}
PARTS = 5
"""of the span, in each of which both sides are looked at"""
SEEN = 0.5
"""part of these that must have a point on the edge's arc"""
ALONG = 25
"""places along a section among which the blade is thickest"""


def unseen_edges(found: Found) -> dict[str, tuple[float, float]]:
    """The rounded edges on whose arc no point lies: width of the blade where its points end [m], and of its thickest.

    A point on the arc is nearer to its middle than the other side is, which no point before it is.
    """
    if not isinstance(found.design, UnifiedSection | UnifiedBlade):
        return {}
    on, sides = found.state.feet, found.state.shape.sides
    unseen = {}
    for name, end in EDGES.items():
        nearest = _nearest(on, found.rows, end)
        if len(nearest) == 0:
            continue
        side, u, v = on.side[nearest], on.u[nearest], on.v[nearest]
        here, tip, across = (
            _places(sides, *at) for at in ((side, u, v), (side, np.full(len(u), end), v), (1 - side, u, v))
        )
        width = np.sqrt(np.sum((here - across) ** 2, axis=-1))
        if np.mean(np.sqrt(np.sum((here - tip) ** 2, axis=-1)) <= width) < SEEN:
            wide = float(np.median(width))
            unseen[name] = wide, wide / _thickness(sides, float(np.median(v)))
    return unseen


def thinnest(found: Found) -> float:
    """The least thickness along the span, where sections are thickest [m]; infinite of other families."""
    if not isinstance(found.design, UnifiedSection | UnifiedBlade):
        return np.inf
    return min(_thickness(found.state.shape.sides, v) for v in (0.1, 0.3, 0.5, 0.7, 0.9))


def _nearest(on: Feet, rows: NDArray[np.bool_], end: float) -> NDArray[np.intp]:
    """Of each side and part of the span the point that is nearest to an edge."""
    away = np.where(rows, np.abs(on.u - end), np.inf)
    part = np.minimum((PARTS * on.v).astype(int), PARTS - 1) + PARTS * on.side
    found = [np.flatnonzero(part == each)[np.argmin(away[part == each])] for each in np.unique(part)]
    return np.array([each for each in found if np.isfinite(away[each])], dtype=np.intp)


def _thickness(sides: tuple[Side, ...], v: float) -> float:
    u = np.linspace(0.0, 1.0, ALONG)
    upper, lower = (_places(sides, np.full(ALONG, side), u, np.full(ALONG, v)) for side in (0, 1))
    return float(np.sqrt(np.max(np.sum((upper - lower) ** 2, axis=-1))))


def _places(sides: tuple[Side, ...], side: NDArray[np.intp], u: Reals, v: Reals) -> Reals:
    none = np.zeros((len(u), np.real(sides[0].control_points).shape[-1]))
    return placed(none, sides, side, u, v).points
