"""More control points along the span for the laws of an edge, where deviations beyond a tolerance gather beside it.

The rows of a cloud may differ from each other at their edges: no single law is foreseen to gain much there, and all of
an edge together do.
"""

from dataclasses import replace

import numpy as np

from bladewright.fitting.matching.search import Found
from bladewright.fitting.structures.growth import MOST_CURVE, MOST_SPAN, Step
from bladewright.fitting.structures.structure import structure_of

BESIDE = 0.05
"""how near to an edge, in u, a deviation is one of it"""
FEW = 0.1
"""part of the points beyond the tolerance from which it is the whole blade that is not matched yet"""
GATHERED = 0.25
"""part of those that lie beside an edge from which its laws grow"""
LAWS = {
    "leading_edge": ("place", "leading_edge_radius", "metal_angle_in"),
    "trailing_edge": ("stagger", "trailing_edge_radius", "metal_angle_out"),
}
"""laws along the span that place an edge and round it, besides its curve in the channel"""


def edge_steps(found: Found, tolerance: float) -> list[Step]:
    """The steps, by half as many control points each, of the edges that stay beyond a tolerance [m]."""
    on, rows = found.state.feet, found.rows
    beyond = rows & (on.distances > tolerance)
    structure = structure_of(found.design)
    if not structure.channel or not np.any(beyond) or np.mean(beyond[rows]) > FEW:
        return []
    steps = []
    for edge, beside in (("leading_edge", on.u < BESIDE), ("trailing_edge", on.u > 1.0 - BESIDE)):
        if np.mean(beside[beyond]) < GATHERED:
            continue
        counts = {name: _more(structure.span[name], MOST_SPAN) for name in LAWS[edge]}
        curve = _more(structure.channel[edge], MOST_CURVE)
        added = sum(count - structure.span[name] for name, count in counts.items())
        added += 2 * (curve - structure.channel[edge])
        if added:
            wider = replace(structure, span={**structure.span, **counts}, channel={**structure.channel, edge: curve})
            steps.append(Step(fields=(*LAWS[edge], f"channel.{edge}"), structure=wider, parameters=added))
    return steps


def _more(count: int, most: int) -> int:
    return max(count, min(most, count + max(1, count // 2)))
