"""A first blade from points in space.

The outline of the points in the meridional plane falls into hub, shroud and two edges: the channel. Slices on its
stream surfaces give camber and thickness, whose laws make a blade with few control points; a short search of the real
blade then brings it to the points.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.domain.row import turn_matrix
from bladewright.errors import BladewrightError, FitError
from bladewright.fitting.assessment.acceptance import AXES_HINT
from bladewright.fitting.clouds.thinning import even_subset, random_subset, without_isolated_points
from bladewright.fitting.initial_guess.channel import SlicedChannel, ranked_channels
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
CLEARLY_LINEAR = 0.5
"""ratio of distances, linear to annular, below which a blade is of a cascade (design/matching_constants.md)"""
CLEARER_ROW, CLEAR_ROW = 0.5, 4e-4
"""ratio of rows' scatters that decides, and scatter below which no other is looked for, of the chord
(design/matching.md)"""
UPRIGHT = -0.5 * np.pi
"""angle about x that brings y to z [rad]"""
SPAN_POINTS = 600
"""points by which the span's axis is told; it bounds the time (design/matching_constants.md)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class FirstBlade:
    """A blade of the unified family near points."""

    design: UnifiedBlade
    walls: tuple[Reals, ...]
    """(m, 2) hub and shroud on the outline of the points, in (x, r) or (x, z) [m]"""
    turn: float = 0.0
    """angle about x by which the points are turned, as the span of a cascade lies along y [rad]"""


def first_blades(points: Reals, header: Mapping[str, Any]) -> Iterator[FirstBlade]:
    """Blades of the unified family near points (n, 3) [m], in each arrangement in which they may stand, likelier first.

    `header` is that of their design; where blade_count, or pitch [m] of a linear cascade, is None, one is taken at
    which neighbours stand apart. An arrangement that is None is shown by rows of points at both ends: they lie on
    surfaces of revolution, or in a cascade, whose span is z or y, on cylinders along y. Where they tell nothing, there
    are both, and that around the axis is likelier unless slices of the other are clearly nearer. Raises FitError where
    no blade that can be built lies near the points.
    """
    points = without_isolated_points(np.unique(np.asarray(points, dtype=np.float64), axis=0))
    found, refusals = list[FirstBlade](), list[FitError]()
    for arranged in likely_arrangements(points, header):
        try:
            found.append(arranged.first_blade())
        except FitError as error:
            refusals.append(error)
            continue
        yield found[-1]
    if not found:
        raise refusals[0]


@dataclass(frozen=True, kw_only=True, eq=False)
class ArrangedPoints:
    """Points in an arrangement, and their likely channels with slices."""

    header: Mapping[str, Any]
    """of the design"""
    points: Reals
    """(n, 3) turned so that the span of a cascade lies along z [m]"""
    turn: float
    """angle about x by which they are [rad]"""
    channels: list[SlicedChannel]

    def row_spread(self) -> float:
        """Scatter of points at both ends of the likeliest blade about rows beside its walls, in chords; or infinite."""
        task = Task(points=self.points, weights=np.ones(len(self.points)))
        try:
            found = evaluated(task, _blade_of(self.channels[0], self.header), noise=NOISE)
        except BladewrightError:
            return np.inf
        if len(found.ends.walls) < 2:
            return np.inf
        # the sides themselves are no nearer to the walls
        spreads = (max(wall.spread / found.model.chord, ROW_LEAST_WIDTH) for wall in found.ends.walls.values())
        return float(np.sqrt(np.prod(list(spreads))))

    def first_blade(self) -> FirstBlade:
        """The blade that a short search finds from the likeliest channel from which there is one."""
        points = self.points[even_subset(self.points, DRAWN_POINTS)]
        some = points[random_subset(len(points), SEARCHED_POINTS)]
        task = Task(points=some, weights=np.ones(len(some)), preliminary=True)
        refusal: BladewrightError | None = None
        for sliced in self.channels:
            try:
                start = _blade_of(sliced, self.header)
                found = searched(replace(task, outline=sliced.walls), start, noise=NOISE, rounds=ROUNDS)
            except BladewrightError as error:
                refusal = refusal or error
                continue
            first: Any = widened_where_feasible(found.design, FIRST_BLADE)
            return FirstBlade(design=first, walls=sliced.walls, turn=self.turn)
        raise FitError(f"no blade that can be built was found near the points ({refusal}); {AXES_HINT}")


def likely_arrangements(points: Reals, header: Mapping[str, Any]) -> list[ArrangedPoints]:
    """The arrangements in which points (n, 3) [m] may stand, the likelier first: one alone where rows show it."""
    if header["arrangement"] is not None:
        return [_arranged(points, header, header["arrangement"])]
    around = _arranged(points, header, "annular")
    spread = around.row_spread()
    if spread < CLEAR_ROW:
        return [around]
    try:
        level = _arranged(points, header, "linear", UPRIGHT if spans_along_y(points) else 0.0)
    except BladewrightError:
        # what cannot be sliced as a cascade is none
        return [around]
    other = level.row_spread()
    if min(spread, other) < min(ROW_SPREAD, CLEARER_ROW * max(spread, other)):
        return [around if spread < other else level]
    nearer = level.channels[0].mean_distance < CLEARLY_LINEAR * around.channels[0].mean_distance
    return [level, around] if nearer else [around, level]


def _arranged(points: Reals, header: Mapping[str, Any], arrangement: str, turn: float = 0.0) -> ArrangedPoints:
    points = points @ turn_matrix(turn).T
    channels = ranked_channels(points, even_subset(points, DRAWN_POINTS), arrangement)
    return ArrangedPoints(header={**header, "arrangement": arrangement}, points=points, turn=turn, channels=channels)


def _blade_of(sliced: SlicedChannel, header: Mapping[str, Any]) -> Any:
    """The blade with few control points whose sections are those of slices, edges that have a shape among them."""
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
    return with_feasible_edges(UnifiedBlade(**{**header, **row, **numbers}, channel=channel.part(metre)))


def spans_along_y(points: Reals) -> bool:
    """Whether the span of a linear cascade's blade (n, 3) [m] is y, not z: slices across it meet the points better."""
    some = without_isolated_points(np.unique(points, axis=0))
    some = some[even_subset(some, SPAN_POINTS)]
    off, off_turned = (
        ranked_channels(each, np.arange(len(each)), "linear")[0].mean_distance for each in (some, some[:, [0, 2, 1]])
    )
    return off_turned < CLEARLY_LINEAR * off
