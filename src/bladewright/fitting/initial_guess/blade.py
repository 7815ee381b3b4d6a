"""A first blade from points in space.

The outline of the points in the meridional plane falls into hub, shroud and two edges: the channel. Slices on its
stream surfaces give camber and thickness, whose laws make a blade with few control points; a short search of the real
blade then brings it to the points.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bladewright.blade.design.row_design import Arrangement
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.domain.row import turn_matrix
from bladewright.errors import BladewrightError, FitError
from bladewright.fitting.assessment.acceptance import AXES_HINT, GROSS_DEVIATION
from bladewright.fitting.clouds.thinning import even_subset, random_subset, without_isolated_points
from bladewright.fitting.initial_guess.channel import SlicedChannel, machine_coordinates, ranked_channels
from bladewright.fitting.initial_guess.slices import PLACES, fitted_law, unified_numbers
from bladewright.fitting.matching.blade_ends import ROW_LEAST_WIDTH, ROW_SPREAD
from bladewright.fitting.matching.search import Task, evaluated, searched
from bladewright.fitting.model_selection.structure import FIRST_BLADE, widened_where_feasible, with_feasible_edges
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.laws import plain_law

DRAWN_POINTS, SEARCHED_POINTS = 1200, 500
"""points that show the slices, and those of the search; they bound the time (design/matching_constants.md)"""
NOISE, ROUNDS = 0.03, 3
"""noise assumed of a first blade, of the chord, and rounds of its search (design/matching_constants.md)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class FirstBlade:
    """A blade of the unified family near points."""

    design: UnifiedBlade
    walls: tuple[Reals, ...]
    """(m, 2) hub and shroud on the outline of the points, in (x, r) or (x, z) [m]"""
    turn: float = 0.0
    """angle about x by which the points are turned, as the span of a cascade lies along y [rad]"""


def first_blade(points: Reals, header: Mapping[str, Any]) -> FirstBlade:
    """A blade of the unified family near points (n, 3) [m] in the machine's axes; `header` is that of its design.

    Where blade_count, or pitch [m] of a linear cascade, is None, one is taken at which neighbours stand apart. Where
    the arrangement is None, and a blade around the axis is far off, one in a cascade is sought as well, with its span
    along z or y. Raises FitError where no blade that can be built lies near the points.
    """
    points = without_isolated_points(np.unique(np.asarray(points, dtype=np.float64), axis=0))
    tried, refusals = list[tuple[float, FirstBlade]](), list[FitError]()
    for turn, seen, channels in likely_arrangements(points, header["arrangement"]):
        try:
            begun = {**header, "arrangement": seen}
            tried.append(_searched_blade(points @ turn_matrix(turn).T, channels, begun, turn))
        except FitError as error:
            refusals.append(error)
            continue
        # further off on average than any point of a match may be, it may stand otherwise
        if tried[0][0] <= GROSS_DEVIATION[1]:
            break
    if not tried:
        raise refusals[0]
    return tried[-1][1] if tried[-1][0] < CLEARLY_LINEAR * tried[0][0] else tried[0][1]


def arranged_blades(points: Reals, header: Mapping[str, Any]) -> list[FirstBlade]:
    """First blades near points (n, 3) [m] in the arrangements in which they may stand, the likelier one first.

    There is one alone where the arrangement is given or where the rows of points at both ends show it: they lie on
    surfaces of revolution, or in a cascade on cylinders along y. Arguments and errors are those of `first_blade`.
    """
    first = first_blade(points, header)
    if header["arrangement"] is not None or first.design.arrangement == "linear":
        return [first]
    try:
        turn = UPRIGHT if spans_along_y(points) else 0.0
        linear = {**header, "arrangement": "linear"}
        other = replace(first_blade(points @ turn_matrix(turn).T, linear), turn=turn)
    except BladewrightError:
        # what cannot be sliced as a cascade is none
        return [first]
    around, level = _row_spread(points, first), _row_spread(points, other)
    if min(around, level) < ROW_SPREAD and not CLEARER_ROW < around / level < 1.0 / CLEARER_ROW:
        return [first if around < level else other]
    return [first, other]


def _row_spread(points: Reals, begun: FirstBlade) -> float:
    """Scatter of points (n, 3) [m] at both ends of a first blade about rows beside its walls, of its chord; or inf."""
    task = Task(points=points @ turn_matrix(begun.turn).T, weights=np.ones(len(points)))
    try:
        found = evaluated(task, begun.design, noise=NOISE)
    except FitError:
        return np.inf
    if len(found.ends.walls) < 2:
        return np.inf
    # the sides themselves are no nearer to the walls
    spreads = (max(wall.spread / found.model.chord, ROW_LEAST_WIDTH) for wall in found.ends.walls.values())
    return float(np.sqrt(np.prod(list(spreads))))


def likely_arrangements(
    points: Reals, arrangement: Arrangement | None
) -> Iterator[tuple[float, Arrangement, list[SlicedChannel]]]:
    """The arrangements in which a blade may stand, the likelier first: a turn about x [rad], and likely channels."""
    seen, channels = arranged_channels(points, arrangement)
    yield 0.0, seen, channels
    # what cannot be sliced as a cascade is none
    with suppress(BladewrightError):
        if arrangement is None and seen == "annular":
            turn = UPRIGHT if spans_along_y(points) else 0.0
            yield turn, *arranged_channels(points @ turn_matrix(turn).T, "linear")


def _searched_blade(
    points: Reals, channels: Sequence[SlicedChannel], header: dict[str, Any], turn: float
) -> tuple[float, FirstBlade]:
    """The mean distance, in chords, of points (n, 3) from the blade that a short search finds, and this blade."""
    points = points[even_subset(points, DRAWN_POINTS)]
    some = points[random_subset(len(points), SEARCHED_POINTS)]
    task = Task(points=some, weights=np.ones(len(some)), preliminary=True)
    refusal: BladewrightError | None = None
    for sliced in channels:
        try:
            outlined = replace(task, outline=sliced.walls)
            start = with_feasible_edges(_blade_of(sliced, header))
            found = searched(outlined, start, noise=NOISE, rounds=ROUNDS)
        except BladewrightError as error:
            refusal = refusal or error
            continue
        first: Any = widened_where_feasible(found.design, FIRST_BLADE)
        return found.mean_distance / found.model.chord, FirstBlade(design=first, walls=sliced.walls, turn=turn)
    raise FitError(f"no blade that can be built was found near the points ({refusal}); {AXES_HINT}")


def _blade_of(sliced: SlicedChannel, header: dict[str, Any]) -> UnifiedBlade:
    """The blade with few control points whose sections are those of slices."""
    slices, channel, metre = sliced.slices, sliced.channel, UNITS[header["length_unit"]]
    extents, lengths = channel.extents(slices.v)
    place = slices.camber[:, 0, 1] * extents
    wide = float(np.ptp(sliced.plane.points[:, 1] * channel.extents(sliced.plane.v)[0]))
    if channel.revolved:
        place = np.degrees(place)
        count = int(np.clip(np.pi / max(wide, 1e-3), 1, 10_000))
        row = {"blade_count": header["blade_count"] or count, "pitch": None}
    else:
        place = place / metre
        pitch = 2.0 * wide if header["pitch"] is None else header["pitch"]
        row = {"blade_count": None, "pitch": pitch / metre}
    law = plain_law(fitted_law(place, slices.v, FIRST_BLADE.counts["leading_edge_theta"][1]))
    # a meridional length at the places of the slices, in extents of the plane
    scale = lengths[:, None] / (channel.radius(PLACES, slices.v) * extents[:, None])
    numbers = unified_numbers(slices, FIRST_BLADE.counts, scale)
    numbers["leading_edge_theta" if channel.revolved else "leading_edge_y"] = law
    return UnifiedBlade(**header | row | numbers, channel=channel.part(metre))


ANNULAR_AT_ONCE = 3e-3
"""mean distance of slices that shows a blade around the axis at once, in chords (design/matching_constants.md)"""
CLEARLY_LINEAR = 0.5
"""ratio of distances, linear to annular, below which a blade is of a cascade (design/matching_constants.md)"""
ROW_BINS, ROW_HEIGHT = 16, 0.03
"""parts of x whose lowest point is sought, and height of a row above it, of the span (design/matching_constants.md)"""
ROW_DEGREE, ROW_TURNS, ROW_OUTLIER = 5, 5, 6.7
"""degree of a row's line, iterations in which it is found, and distance from it, in medians, beyond which a point does
not belong to the row (design/matching_constants.md)"""
CLEARER_ROW, CLEAR_ROW = 0.5, 1e-3
"""ratio of rows' scatters that decides, and largest scatter of one on a plane, of the span (design/matching.md)"""

UPRIGHT = -0.5 * np.pi
"""angle about x that brings y to z [rad]"""
SPAN_POINTS = 600
"""points by which the span's axis is told; it bounds the time (design/matching_constants.md)"""


def arranged_channels(points: Reals, arrangement: Arrangement | None) -> tuple[Arrangement, list[SlicedChannel]]:
    """The arrangement of the blade of points (n, 3) [m], unless it is given, and its likely channels with slices."""
    rows = even_subset(points, DRAWN_POINTS)
    known = arrangement or _arrangement_shown(points[rows])
    annular = [] if known == "linear" else ranked_channels(machine_coordinates(points, "annular"), rows, revolved=True)
    if known == "annular" or (annular and annular[0].mean_distance < ANNULAR_AT_ONCE):
        return "annular", annular
    linear = ranked_channels(machine_coordinates(points, "linear"), rows, revolved=False)
    if known == "linear" or linear[0].mean_distance < CLEARLY_LINEAR * annular[0].mean_distance:
        return "linear", linear
    return "annular", annular


def spans_along_y(points: Reals) -> bool:
    """Whether the span of a linear cascade's blade (n, 3) [m] is y, not z: slices across it meet the points better."""
    some = without_isolated_points(np.unique(points, axis=0))
    some = some[even_subset(some, SPAN_POINTS)]
    off, off_turned = (
        ranked_channels(machine_coordinates(each, "linear"), revolved=False)[0].mean_distance
        for each in (some, some[:, [0, 2, 1]])
    )
    return off_turned < CLEARLY_LINEAR * off


def _arrangement_shown(points: Reals) -> Arrangement | None:
    """The arrangement, if any, that radii of points (n, 3) or rows at both ends show: around the axis or on planes."""
    x, radius, z = points[:, 0], np.sqrt(points[:, 1] ** 2 + points[:, 2] ** 2), points[:, 2]
    # a blade that reaches the machine axis belongs to a cascade; one along theta does not
    if np.min(radius) < 0.02 * np.max(radius):
        return "linear"
    if np.ptp(z) < 0.05 * np.ptp(radius):
        return "annular"
    # sections of a blade far from the axis are matched alike on both
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
