"""A first blade from points in space.

The outline of the points in the meridional plane falls into hub, shroud and two edges: the channel. Slices on its
stream surfaces give camber and thickness, whose laws make a blade with few control points; a short search of the real
blade then brings it to the points.
"""

from typing import Any

import numpy as np

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Point
from bladewright.errors import BladewrightError, FitError
from bladewright.fitting.clouds.thinning import even_subset, random_subset, without_isolated_points
from bladewright.fitting.design_header import Arrangement, Unit
from bladewright.fitting.free_parameters import FreeParameters
from bladewright.fitting.initial_guess.arrangement import arranged_channels
from bladewright.fitting.initial_guess.hypotheses import SlicedChannel
from bladewright.fitting.initial_guess.laws import fitted_law, plain_law, unified_numbers
from bladewright.fitting.initial_guess.slices import PLACES
from bladewright.fitting.matching.search import Match, Task, searched
from bladewright.fitting.model_selection.reshaping import reshaped, with_feasible_edges
from bladewright.fitting.model_selection.structure import INITIAL_BLADES, Structure
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS

AXES_HINT = "x must be the machine axis: say which column is which (--columns), or name the axis (--axis)"
"""what may be wrong with a cloud near which no blade is found"""
DRAWN_POINTS, SEARCHED_POINTS = 1200, 500
"""points that show the outline and the slices, and points of the search (`SEARCHED_POINTS`); they bound the time."""
FEW = INITIAL_BLADES[1]
"""numbers of control points of the blade that is searched"""
NOISE, ROUNDS = 0.03, 3
"""noise assumed of a first blade, of the chord, and rounds of its search"""
NEAR = 2e-3
"""mean distance, of the chord, with which no other outline is tried"""
INLIER_SHARE = 0.94
"""share of the points that are surely no outliers"""
MOST_OUTLINES = 3
"""outlines that are tried"""


def first_blade(
    points: Reals,
    *,
    arrangement: Arrangement | None = None,
    structure: Structure | None = None,
    blade_count: int | None = None,
    pitch: float | None = None,
    name: str = "blade",
    length_unit: Unit = "mm",
) -> UnifiedBlade:
    """A blade of the unified family near points (n, 3) [m] in the machine's axes, found from them alone.

    `pitch` [m] of a linear cascade. Where blade_count or pitch is not given, one is taken at which neighbours stand
    apart. Raises FitError where no blade that can be built lies near the points.
    """
    points = without_isolated_points(np.unique(np.asarray(points, dtype=np.float64), axis=0))
    points = points[even_subset(points, DRAWN_POINTS)]
    arrangement, channels = arranged_channels(points, arrangement)
    some = points[random_subset(len(points), SEARCHED_POINTS)]
    task = Task(points=some, weights=np.ones(len(some)), free=FreeParameters(), bounds={})
    header: dict[str, Any] = {"name": name, "length_unit": length_unit, "arrangement": arrangement}
    if arrangement == "linear":
        header["pitch"] = (2.0 * float(np.ptp(points[:, 1])) if pitch is None else pitch) / UNITS[length_unit]
    else:
        header["blade_count"] = blade_count
    best: Match | None = None
    refusal: BladewrightError | None = None
    for sliced in channels[:MOST_OUTLINES]:
        try:
            found = searched(task, with_feasible_edges(_blade_of(sliced, header)), noise=NOISE, rounds=ROUNDS)
        except BladewrightError as error:
            refusal = error
            continue
        best = found if best is None or typical_distance(found) < typical_distance(best) else best
        if typical_distance(best) < NEAR:
            break
    if best is None:
        raise FitError(f"no blade that can be built was found near the points ({refusal}); {AXES_HINT}")
    return with_feasible_edges(reshaped(best.design, structure or FEW))  # type: ignore[return-value]


def typical_distance(match: Match) -> float:
    """Mean distance of the nearest points, in chords: outliers do not tell one first design from another."""
    distances = np.sort(match.state.footpoints.distances)
    return float(np.mean(distances[: int(INLIER_SHARE * len(distances))])) / match.model.chord


def _blade_of(sliced: SlicedChannel, header: dict[str, Any]) -> UnifiedBlade:
    """The blade with few control points whose sections are those of slices."""
    slices, channel, metre = sliced.slices, sliced.channel, UNITS[header["length_unit"]]
    extents, lengths = channel.extents(slices.v)
    place = slices.camber[:, 0, 1] * extents
    if channel.revolved:
        place = np.degrees(place)
        wide = float(np.ptp(sliced.plane.points[:, 1] * channel.extents(sliced.plane.v)[0]))
        header = {**header, "blade_count": header["blade_count"] or int(np.clip(np.pi / max(wide, 1e-3), 1, 10_000))}
    else:
        place = place / metre
    law = plain_law(fitted_law(place, slices.v, FEW.span["place"]))
    # a meridional length at the places of the slices, in extents of the plane
    scale = lengths[:, None] / (channel.radius(np.tile(PLACES, (len(slices.v), 1)), slices.v) * extents[:, None])
    numbers = unified_numbers(slices, FEW.chordwise, FEW.span, scale)
    numbers["leading_edge_theta" if channel.revolved else "leading_edge_y"] = law
    return UnifiedBlade(**header, **numbers, channel=_in_unit(channel.part, metre))


def _in_unit(channel: Channel, metre: float) -> Channel:
    """A channel in metres in another unit of length."""

    def points(name: str) -> tuple[Point, ...]:
        return tuple(Point(each.x / metre, each.r / metre) for each in getattr(channel, name))

    return Channel(
        leading_edge=points("leading_edge"),
        trailing_edge=points("trailing_edge"),
        hub=points("hub"),
        shroud=points("shroud"),
    )
