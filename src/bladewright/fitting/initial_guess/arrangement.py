"""Whether a cloud is a blade around the machine axis or one of a linear cascade."""

import numpy as np

from bladewright.fitting.clouds.isolated import without_isolated_points
from bladewright.fitting.clouds.thinning import even_subset
from bladewright.fitting.design_header import Arrangement
from bladewright.fitting.initial_guess.hypotheses import machine_coordinates, ranked_channels
from bladewright.nurbs.basis import Reals

DECIDING_POINTS = 600
"""points by which the two arrangements are compared; it bounds the time."""
ANNULAR_AT_ONCE = 3e-3
"""mean distance, of the chord, with which a blade around the axis is accepted without comparing the other
arrangement."""
ROW_BINS, ROW_HEIGHT = 16, 0.03
"""parts of x in each of which the lowest point is sought; points up to `ROW_HEIGHT` of the span above it belong to the
same row."""
ROW_DEGREE, ROW_TURNS, ROW_OUTLIER = 5, 5, 6.7
"""degree of the row's line, iterations in which it is found (`ROW_TURNS`), and the distance, in medians, beyond which a
point does not belong to it (`ROW_OUTLIER`)."""
CLEARER_ROW, CLEAR_ROW = 0.5, 1e-3
"""ratio of the scatter of rows about the axis to that on planes which decides; rows on planes must also scatter by less
than `CLEAR_ROW` of the span. Rows of Aachen's stator with noise scatter by 1.7e-4 of the span about the axis, and by
1.4e-3 on planes (design/fit_clouds.md)."""


def found_arrangement(points: Reals) -> Arrangement:
    """The arrangement of the blade of points (n, 3) [m], by which sections are the closer ones.

    Sections lie on surfaces of revolution or on planes. A blade that reaches the machine axis, or surrounds it, belongs
    to a cascade.
    """
    points = np.asarray(points, dtype=np.float64)
    y, z = points[:, 1], points[:, 2]
    radius = np.sqrt(y**2 + z**2)
    around = np.sort(np.arctan2(y, z))
    gaps = np.diff(np.concatenate([around, around[:1] + 2.0 * np.pi]))
    if np.min(radius) < 0.02 * np.max(radius) or np.max(gaps) < np.pi:
        return "linear"
    if np.ptp(z) < 0.05 * np.ptp(radius):
        return "annular"
    rows = _arrangement_by_rows(points)
    if rows is not None:
        return rows
    some = without_isolated_points(np.unique(points, axis=0))
    some = some[even_subset(some, DECIDING_POINTS)]
    away: list[float] = []
    for name in ("annular", "linear"):
        found = ranked_channels(machine_coordinates(some, name), revolved=name == "annular")
        away.append(found[0].mean_distance)
        if away[0] < ANNULAR_AT_ONCE:
            return "annular"
    return "linear" if away[1] < 0.5 * away[0] else "annular"


def _arrangement_by_rows(points: Reals) -> Arrangement | None:
    """The arrangement by the rows of points (n, 3) at both ends: around the axis, or on planes; None without rows.

    Sections of a blade far from the axis are matched alike on both.
    """
    x, radius, z = points[:, 0], np.sqrt(points[:, 1] ** 2 + points[:, 2] ** 2), points[:, 2]
    around, level = (np.sqrt(_row_scatter(x, span) * _row_scatter(x, -span)) for span in (radius, z))
    if around < CLEARER_ROW * level:
        return "annular"
    # in a radial machine neither end is a row over x
    return "linear" if level < min(CLEARER_ROW * around, CLEAR_ROW * float(np.ptp(z))) else None


def _row_scatter(x: Reals, span: Reals) -> float:
    """By how much the lowest points (n,) are off a smooth line over x."""
    place = np.clip((x - np.min(x)) / np.ptp(x), 0.0, 1.0)
    bins = np.minimum((ROW_BINS * place).astype(int), ROW_BINS - 1)
    lowest = np.full(ROW_BINS, np.inf)
    np.minimum.at(lowest, bins, span)
    rows = span <= lowest[bins] + ROW_HEIGHT * np.ptp(span)
    terms, low = np.polynomial.chebyshev.chebvander(2.0 * place[rows] - 1.0, ROW_DEGREE), span[rows]
    kept, left = np.ones(len(low), dtype=bool), low
    for _ in range(ROW_TURNS):
        left = low - terms @ np.linalg.lstsq(terms[kept], low[kept], rcond=None)[0]
        kept = np.abs(left) <= ROW_OUTLIER * np.median(np.abs(left[kept]))
    return float(np.median(np.abs(left[kept])))
