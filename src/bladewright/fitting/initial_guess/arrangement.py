"""Whether a cloud is a blade around the machine axis or one of a linear cascade."""

import numpy as np

from bladewright.fitting.clouds.thinning import even_subset, without_isolated_points
from bladewright.fitting.design_header import Arrangement
from bladewright.fitting.initial_guess.hypotheses import SlicedChannel, machine_coordinates, ranked_channels
from bladewright.nurbs.basis import Reals

ANNULAR_AT_ONCE = 3e-3
"""mean distance, in chords, with which slices around the axis are accepted without comparing the other arrangement."""
CLEARLY_LINEAR = 0.5
"""ratio of mean distances, linear to annular, below which a blade belongs to a cascade."""
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

SPAN_POINTS = 600
"""points by which the span's axis is told; it bounds the time."""


def arranged_channels(points: Reals, arrangement: Arrangement | None) -> tuple[Arrangement, list[SlicedChannel]]:
    """The arrangement of the blade of points (n, 3) [m], unless it is given, and its likely channels with slices."""
    known = arrangement or _arrangement_by_axis(points) or _arrangement_by_rows(points)
    annular = [] if known == "linear" else ranked_channels(machine_coordinates(points, "annular"), revolved=True)
    if known == "annular" or (annular and annular[0].mean_distance < ANNULAR_AT_ONCE):
        return "annular", annular
    linear = ranked_channels(machine_coordinates(points, "linear"), revolved=False)
    if known == "linear" or linear[0].mean_distance < CLEARLY_LINEAR * annular[0].mean_distance:
        return "linear", linear
    return "annular", annular


def spans_along_y(points: Reals) -> bool:
    """Whether the span of a linear cascade's blade of points (n, 3) [m] is y, not z: slices across it meet them better.

    A span along x needs no such question: the channel may lead along z.
    """
    some = without_isolated_points(np.unique(points, axis=0))
    some = some[even_subset(some, SPAN_POINTS)]
    off, off_turned = (
        ranked_channels(machine_coordinates(each, "linear"), revolved=False)[0].mean_distance
        for each in (some, some[:, [0, 2, 1]])
    )
    return off_turned < CLEARLY_LINEAR * off


def _arrangement_by_axis(points: Reals) -> Arrangement | None:
    """A blade that reaches the machine axis, or surrounds it, belongs to a cascade; one along theta does not."""
    y, z = points[:, 1], points[:, 2]
    radius = np.sqrt(y**2 + z**2)
    around = np.sort(np.arctan2(y, z))
    gaps = np.diff(np.concatenate([around, around[:1] + 2.0 * np.pi]))
    if np.min(radius) < 0.02 * np.max(radius) or np.max(gaps) < np.pi:
        return "linear"
    return "annular" if np.ptp(z) < 0.05 * np.ptp(radius) else None


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
