"""What holds sections while they are drawn through points: limits, regularisation, and ends among the points."""

import numpy as np

from bladewright.fitting.initial_guess.section_shape import (
    ANGLE_IN,
    ANGLE_OUT,
    EXTENT,
    FIRST_THICKNESS,
    PLACE,
    ROOT_IN,
    ROOT_OUT,
    STAGGER,
    START,
    TANGENT_IN,
    TANGENT_OUT,
    SectionShape,
    UnwrappedPoints,
    section_stations,
)
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import law_basis

STEEPEST_ANGLE = np.radians(87.0)
"""steepest angle of a first camber [rad]"""
SHORTEST_TANGENT, LONGEST_TANGENT = 0.03, 0.97
"""shortest and longest (`LONGEST_TANGENT`) tangent of a first camber, of the extent."""
THINNEST_SECTION = 5e-4
"""smallest half thickness of a first section, of the chord."""
BEND_WEIGHT = 0.7
"""weight of the laws' second differences along the span, relative to that of the other rows."""
SPAN_BAND, SPAN_BAND_POINTS = 0.06, 12
"""half width, of the span, of the band whose outermost points show where a section ends, and the points that it needs
(`SPAN_BAND_POINTS`)"""
ALLOWED_GAPS, OVERHANG_WEIGHT = 4.0, 0.3
"""allowed overhang of a section, in even distances between so many points along the stream line, and the weight of what
exceeds it (`OVERHANG_WEIGHT`). Without it the fan rotor's first sections overhung its points by 16 and 30 mm
(design/fit_made.md)."""


def regularisation_rows(
    shape: SectionShape, unwrapped: UnwrappedPoints, laws: Reals, smooth: float
) -> tuple[Reals, Reals]:
    """Rows that keep what the points leave open: equal sides, even thickness, tangents of a third, even laws."""
    count, k = shape.columns, len(laws)
    rows: list[tuple[Reals, float]] = []

    def add(parts: dict[int, float], rhs: float, weight: float) -> None:
        row = np.zeros(count)
        for column, value in parts.items():
            row[column] = weight * value
        rows.append((row, weight * rhs))

    nu, nl = shape.chordwise
    up, low, unit = shape.upper.start, shape.lower.start, 1.0 / unwrapped.ratio
    if nu == nl:
        for i in range(nu):
            add({up + i: unit, low + i: -unit}, 0.0, 0.3 * smooth)
    for first, n in ((up, nu), (low, nl)):
        for i in range(n - 2):
            add({first + i: unit, first + i + 1: -2.0 * unit, first + i + 2: unit}, 0.0, smooth)
    for column in (TANGENT_IN, TANGENT_OUT):
        add({column: 1.0}, 0.35, 0.03 * smooth)
    for column in (ROOT_IN, ROOT_OUT):
        add({column: 1.0 / np.sqrt(unwrapped.ratio)}, 0.05, 0.03 * smooth)
    matrix = np.array([np.kron(row, np.eye(k)) for row, _ in rows]).reshape(-1, count * k)
    rhs_rows = np.repeat([rhs for _, rhs in rows], k)
    if k > 2:
        units = limits(shape, unwrapped, ends=False)[2]
        bend = np.diff(np.eye(k), n=2, axis=0)
        extra = np.kron(np.diag(BEND_WEIGHT * smooth / units), bend)
        matrix, rhs_rows = np.concatenate([matrix, extra]), np.concatenate([rhs_rows, np.zeros(len(extra))])
    flat = laws.T.reshape(-1)
    return matrix, rhs_rows - matrix @ flat


def overhang_rows(shape: SectionShape, unwrapped: UnwrappedPoints, laws: Reals) -> tuple[Reals, Reals]:
    """Rows that draw in what overhangs the points: thin fins are nobody's nearest place and would cost nothing."""
    count, rows, rhs_rows = shape.columns * len(laws), [], []
    for v in section_stations(unwrapped):
        beside = np.abs(unwrapped.v - v) < SPAN_BAND
        number = np.count_nonzero(beside)
        if number < SPAN_BAND_POINTS:
            continue
        room = ALLOWED_GAPS / number
        at = unwrapped.points[beside, 0] / shape.extent(unwrapped.v[beside])
        values = law_basis(len(laws), np.array([v]))[0]
        start = float(values @ laws[:, START])
        end = start + float(values @ laws[:, EXTENT])
        first, last = float(np.min(at) - room - start), float(np.max(at) + room - end)
        for excess, past, columns in ((first, first > 0.0, [START]), (last, last < 0.0, [START, EXTENT])):
            if past:
                row = np.zeros((shape.columns, len(laws)))
                row[columns] = OVERHANG_WEIGHT * values
                rows.append(row.ravel())
                rhs_rows.append(OVERHANG_WEIGHT * excess)
    return np.array(rows).reshape(-1, count), np.array(rhs_rows)


def limits(shape: SectionShape, unwrapped: UnwrappedPoints, *, ends: bool) -> tuple[Reals, Reals, Reals]:
    """Lowest and highest values of the columns, and the most that one step may change them."""
    low, high = np.full(shape.columns, -np.inf), np.full(shape.columns, np.inf)
    most = np.full(shape.columns, 0.1 * unwrapped.ratio)
    for columns, least, largest, step in (
        ([START], -2.0 if unwrapped.flat else -0.4, 0.6, 0.1),
        ([EXTENT], 0.03 if unwrapped.flat else 0.2, 1.5, 0.15),
        ([STAGGER, ANGLE_IN, ANGLE_OUT], -STEEPEST_ANGLE, STEEPEST_ANGLE, 0.35),
        ([TANGENT_IN, TANGENT_OUT], SHORTEST_TANGENT, LONGEST_TANGENT, 0.3),
        ([ROOT_IN, ROOT_OUT], np.sqrt(2e-4 * unwrapped.ratio), 0.95, 0.15 * np.sqrt(unwrapped.ratio)),
    ):
        low[columns], high[columns], most[columns] = least, largest, step
    low[FIRST_THICKNESS:] = THINNEST_SECTION * unwrapped.ratio
    most[PLACE] = 0.15 * unwrapped.chord * float(np.median(unwrapped.size))
    if ends:
        low[START], high[START], low[EXTENT], high[EXTENT] = 0.0, 0.0, 1.0, 1.0
    return low, high, most
