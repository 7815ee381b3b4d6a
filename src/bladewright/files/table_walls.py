"""Meridional curves through the rows of a table: edges, and straight walls."""

import numpy as np

from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.designs import Point
from bladewright.nurbs.basis import Reals

EXTENSION = 1.5
"""How far hub and shroud continue before and behind the blade, in its largest chord [-]"""


def edge_lines(x: list[Reals], r: list[Reals]) -> list[ThroughPoints]:
    """The leading and the trailing edge through all rows."""
    return [
        ThroughPoints(points=tuple(Point(*map(float, pair)) for pair in zip(*each, strict=True)))
        for each in zip(x, r, strict=True)
    ]


def straight_walls(x: list[Reals], r: list[Reals], chord: Reals) -> list[ThroughPoints]:
    """Hub and shroud, straight through both edges of the first and of the last row."""
    reach, ends = EXTENSION * float(np.max(chord)), []
    for row in (0, -1):
        start, end = (np.array([x[i][row], r[i][row]]) for i in (0, 1))
        step = (end - start) / np.hypot(*(end - start))
        # both walls reach as far, and stay at half their least radius from the axis
        reach = min(reach, *(0.5 * at[1] / max(abs(step[1]), 1e-12) for at in (start, end)))
        ends.append((start, end, step))
    level = all(np.isclose(start[1], end[1], rtol=1e-9) for start, end, _ in ends)
    found = []
    for start, end, step in ends:
        points = [start - reach * step, start, end, end + reach * step]
        if level:
            points = [np.array([at, start[1]]) for at in (np.min(x[0]) - reach, np.max(x[1]) + reach)]
        found.append(ThroughPoints(points=tuple(Point(*(float(f"{c:.10g}") for c in each)) for each in points)))
    return found
