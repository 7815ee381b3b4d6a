"""T-Blade3's leading edges that are splines, as those of the family with the same contacts and the same tip."""

from typing import NamedTuple

import numpy as np

from bladewright.nurbs.basis import Reals
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.edge_spline import NARROW, EdgeSpline
from bladewright.section.laws import Span

LEAST, LARGEST = 0.021, 0.49
"""nearest and farthest contact that the family has"""
STEPS = 60
"""bisections of a contact's place"""


class Moved(NamedTuple):
    """Edges (m,) of the sections as the family has them."""

    contact: float
    elongation: Reals
    droop: Reals


def moved_edges(parts: list[CurvatureMeanline], table: Reals) -> Moved:
    """The edges of sections that have none yet, from T-Blade3's 13 numbers (m, 13) of each.

    The contact stands where the thickness, without its multiplier, reaches the edge's; all sections share the mean of
    their places s. Ahead of the contact by (1 + ee) half thicknesses is T-Blade3's tip, s (1 + ee) of them to the side.
    """
    contact = float(np.mean([_contact(part, 0.5 * row[0]) for part, row in zip(parts, table, strict=True)]))
    # joints close behind it would hide what the sides do there
    for joint in sorted({each.s for part in parts for each in part.unsplined(Span(np.zeros(1))).joints}):
        contact = joint if contact < joint < contact + NARROW else contact
    elongation = []
    for part, row in zip(parts, table, strict=True):
        edge = EdgeSpline(contact=contact).applied(part.unsplined(Span(np.zeros(1))), Span(np.zeros(1)))
        upper, lower = (np.real(side)[0, 0] for side in edge.outline.points(np.array([contact])))
        half = 0.5 * float(np.sqrt(np.sum((upper - lower) ** 2)))
        reach = float(np.sqrt(np.sum((0.5 * (upper + lower)) ** 2)))
        elongation.append(1.0 + row[3] - reach / half)
    # droop is counted towards the lower side, T-Blade3's deflection towards the upper
    return Moved(contact, np.array(elongation), -table[:, 2] * (1.0 + table[:, 3]))


def _contact(part: CurvatureMeanline, half: float) -> float:
    """The s at which the half thickness without multiplier first reaches a value."""
    thickness = part.thickness.at(Span(np.zeros(1)))
    s = np.linspace(0.0, LARGEST, 257)
    reached = np.flatnonzero(np.real(thickness.half(s))[0] >= half)
    if len(reached) == 0 or reached[0] == 0:
        return LARGEST if len(reached) == 0 else LEAST
    low, high = s[reached[0] - 1], s[reached[0]]
    for _ in range(STEPS):
        middle = 0.5 * (low + high)
        below = np.real(thickness.half(np.array([middle])))[0, 0] < half
        low, high = (middle, high) if below else (low, middle)
    return float(np.clip(high, LEAST, LARGEST))
