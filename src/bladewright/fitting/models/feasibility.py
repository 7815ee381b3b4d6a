"""How near sections come to what their family refuses: a search that sees it slides along it.

Without it, the steps of a search are refused one after the other where a side leaves an edge on too short a tangent.
"""

from typing import Any

import numpy as np

from bladewright.numerics.elementary import Array, radians
from bladewright.section.laws import Span
from bladewright.section.suction_pressure.edges import MAX_OPENING, opening
from bladewright.section.suction_pressure.limits import CHECKED_AT
from bladewright.section.suction_pressure.part import SuctionPressure, characteristic, sides
from bladewright.section.suction_pressure.side import pace

SLOWEST_PACE = 0.003
"""smallest pace of a side, of what it has further on"""
OPENING_MARGIN = 0.003
"""smallest distance from the largest opening of an edge"""


def infeasibility(part: Any, span: Span) -> Array:
    """By how much sections at places along the span are nearer to a refusal than they may be (..., c), where positive.

    Raises DesignError where they are refused already.
    """
    if not isinstance(part, SuctionPressure):
        return np.zeros(0)
    edges = characteristic(part, span)
    rows = [_opening_excess(part, edge, span) for edge in ("leading_edge", "trailing_edge")]
    for side in sides(part, span, *edges):
        rows += [SLOWEST_PACE - pace(end, CHECKED_AT, 1) for end in (side.start, side.end)]
    shape = np.broadcast_shapes(*[each.shape[:-2] for each in rows])
    return np.concatenate([np.broadcast_to(each, (*shape, *each.shape[-2:])).reshape(*shape, -1) for each in rows], -1)


def _opening_excess(part: SuctionPressure, edge: str, span: Span) -> Array:
    """The same of an edge's two ellipses (..., m, 2), by their opening."""
    stretch, skew, wedge = (span.values(getattr(part, f"{edge}_{each}")) for each in ("stretch", "skew", "wedge"))
    ratios = [opening(stretch * (1.0 + sign * skew), radians(wedge)) for sign in (1.0, -1.0)]
    return np.stack(np.broadcast_arrays(*ratios), axis=-1) - (MAX_OPENING[part.edges] - OPENING_MARGIN)
