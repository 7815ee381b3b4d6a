"""How near sections are to what their family refuses, so that a search can slide along the limit.

Without it, steps of a search are refused one after the other where a side leaves an edge on too short a tangent.
"""

from typing import Any

import numpy as np

from bladewright.numerics.elementary import Array, radians
from bladewright.section.laws import Span
from bladewright.section.segmented.outline import SegmentedOutline
from bladewright.section.segmented.part import Segmented
from bladewright.section.suction_pressure.edges import MAX_OPENING, opening
from bladewright.section.suction_pressure.limits import CHECKED_AT
from bladewright.section.suction_pressure.part import SuctionPressure, edge_points, sides

SLOWEST_PACE = 0.003
"""smallest speed of a side's own parameter by s beside an edge, of its mean speed; at 0 the family refuses the side."""
OPENING_MARGIN = 0.003
"""smallest distance of an edge's opening from the largest one that the family allows."""


def infeasibility(part: Any, span: Span) -> Array:
    """By how much sections at places along the span are nearer to a refusal than they may be (..., c).

    Values above 0 violate the margin. Raises DesignError where the sections are refused already.
    """
    if isinstance(part, Segmented):
        return _turning_back(part.outline(span))
    if not isinstance(part, SuctionPressure):
        return np.zeros(0)
    edges = edge_points(part, span)
    rows = [_opening_excess(part, edge, span) for edge in ("leading_edge", "trailing_edge")]
    for side in sides(part, span, *edges):
        rows += [SLOWEST_PACE - side.own_parameter(end, CHECKED_AT, 1) for end in (0, 1)]
    shape = np.broadcast_shapes(*[each.shape[:-2] for each in rows])
    return np.concatenate([np.broadcast_to(each, (*shape, *each.shape[-2:])).reshape(*shape, -1) for each in rows], -1)


def _turning_back(outline: SegmentedOutline) -> Array:
    """By how much control points of segments lie ahead of the ones before them; those at the nose may (..., c)."""
    rows = []
    for side in outline.sides:
        for number, controls in enumerate(side.controls):
            x = controls[..., 2 if number == 0 else 0 :, 0]
            rows.append(x[..., :-1] - x[..., 1:])
    shape = np.broadcast_shapes(*[each.shape[:-1] for each in rows])
    return np.concatenate(
        [np.broadcast_to(each, (*shape, each.shape[-1])).reshape(*shape[:-1], -1) for each in rows], -1
    )


def _opening_excess(part: SuctionPressure, edge: str, span: Span) -> Array:
    """The same for the two ellipses of an edge (..., m, 2), by their opening."""
    stretch, skew, wedge = (span.values(getattr(part, f"{edge}_{each}")) for each in ("stretch", "skew", "wedge"))
    ratios = [opening(stretch * (1.0 + sign * skew), radians(wedge)) for sign in (1.0, -1.0)]
    return np.stack(np.broadcast_arrays(*ratios), axis=-1) - (MAX_OPENING[part.edges] - OPENING_MARGIN)
