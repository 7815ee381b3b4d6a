"""From a cloud of points to a design: `fit` and what it accepts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bladewright.blade.design.row_design import LengthUnit, RowDesign
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.blade.native.extrema import extrema_of
from bladewright.derivatives.patterns import Patterns
from bladewright.designs import Design
from bladewright.domain.row import turn_matrix
from bladewright.errors import DesignError, FitError
from bladewright.fitting.assessment.acceptance import Acceptance, MatchTarget, trusted_distance
from bladewright.fitting.assessment.measurement import Measurement, PlacesOfPoints, measured, parameter_estimates
from bladewright.fitting.assessment.result import Fit, Motion
from bladewright.fitting.checks import check_positive, check_progress, reals, refusing
from bladewright.fitting.clouds.cloud import checked_cloud, different_points, refuse_hidden_blade, refuse_several_blades
from bladewright.fitting.clouds.thinning import MOST_POINTS, isolated_points, random_subset, without_copies
from bladewright.fitting.clouds.walls import walls_of
from bladewright.fitting.families.blades import matched_blade
from bladewright.fitting.families.kinds import FAMILIES, DesignHeader, FitFamily, family_of
from bladewright.fitting.families.sections import matched_section
from bladewright.fitting.families.unified import matched_unified
from bladewright.fitting.free_parameters import free_parameters_of, given_bounds
from bladewright.fitting.initial_guess.blade import UPRIGHT, spans_along_y
from bladewright.fitting.matching.footpoints import Footpoints
from bladewright.fitting.matching.noise import EXACT
from bladewright.fitting.matching.search import Match, Progress, Task
from bladewright.fitting.model_selection.selection import THOROUGH_POINTS, searched_with_more
from bladewright.fitting.model_selection.structure_search import NEAR_RICH
from bladewright.fitting.placing import (
    UPRIGHT_NOTE,
    Matched,
    PlacedTask,
    Ways,
    finished,
    nearest_of,
    placed_nearest,
    realigned,
    shown_of,
    turned_with,
    without_finishing,
)
from bladewright.fitting.registration import axis_motion, found_axes, registrations
from bladewright.numerics.single_thread import single_threaded
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import choice
from bladewright.section.unified import UnifiedSection

CASCADE_NOTE = (
    "nothing said how the blade stands, and it is taken for one of a linear cascade, with its span along z: one that "
    "stands around x needs the arrangement annular, one with its span along y the arrangement linear"
)
INTERRUPTED_NOTE = (
    f"the search was interrupted, so the design's tolerance is at least {EXACT:g} of the chord, which "
    "builds in a moment: lower it for finer surfaces"
)
WHOLE_BLADE_HINT = "is it one whole blade, with both sides and both edges? If so, give a start design or bounds"


@single_threaded
def fit(
    cloud: ArrayLike,
    start: Design | None = None,
    family: str = "unified",
    *,
    like: Design | None = None,
    tolerance: float | None = None,
    parameters: int | None = None,
    free: Patterns = None,
    fixed: Patterns | Mapping[str, float] = None,
    bounds: Mapping[str, tuple[float | None, float | None]] | None = None,
    weights: ArrayLike | None = None,
    align: bool = False,
    axis: str | Sequence[float] | None = None,
    arrangement: Literal["annular", "linear"] | None = None,
    blade_count: int | None = None,
    pitch: float | None = None,
    name: str | None = None,
    length_unit: LengthUnit | None = None,
    progress: Progress | None = None,
) -> Fit:
    """The design of a family that matches a cloud of points (n, 2) or (n, 3) [m], and how well it does.

    Points are in the machine's axes, in any order: (n, 2) of a section give a `UnifiedSection`, (n, 3) a
    `UnifiedBlade`, or the section or blade of the `family` that is named, or that `start` or `like` is of. `axis` names
    another axis of rotation, through the origin: "y", "-z", or three numbers; the smallest turn brings it to x. With
    `align` they may lie anywhere: they are registered onto `start`, or taken for a prismatic blade of a linear cascade.
    No guess is needed; `start` is one, whose structure is kept unless `tolerance` [m] or `parameters` ask for
    another. `like` is a design whose structure is taken, not its values; the flow path of a blade from sections is part
    of it. Either's cuts and fillets are kept: the blade before them is matched, and points on them are `set_aside`; a
    `like` that has some is the start. Without any of these, control points are added as long as the cloud shows that
    more are needed; with `tolerance`, until no inlier lies further away; with `parameters`, up to that number of free
    ones.

    `free` are patterns of the parameters that may change, `fixed` of those that are held at the start's values, or
    values by pattern; `bounds` are lowest and highest values by pattern, in the units of the fields, or None.
    `weights` (n,) of the points. `start` keeps its own row, `pitch` [m] and `length_unit`, which may not be stated
    otherwise; without it the unit is mm. Sections have no `arrangement` and `blade_count`. `progress` is handed a few
    words on what is done. Ctrl-C ends the search with the best design so far, `interrupted`.

    Distances are true ones; points that lie off the rest are not weighed (`outliers`). Raises FitError where the cloud
    or the call is wrong, and where no design is found. Reference: Agromayor et al. 2021, section 6.
    """
    points, notes = checked_cloud(cloud), tuple[str, ...]()
    kind = named_family(family, points.shape[1], like if start is None else start)
    given = start is not None or like is not None
    target = MatchTarget(tolerance=tolerance, parameters=parameters, structured=parameters is None and given)
    _check_call(points, kind, start, like, target)
    check_progress(progress)
    precision = None if weights is None else _weights(weights, points)
    with refusing():
        start = start if start is None or name is None else start.changed("name", name)
    finishing, start, like = without_finishing(start, like, name or "blade")
    header = DesignHeader(
        name=name or "blade",
        length_unit=getattr(start, "length_unit", "mm") if length_unit is None else length_unit,
        pitch=pitch,
        arrangement=arrangement,
        blade_count=blade_count,
    )
    header.check_place(points.shape[1], start)
    limits = given_bounds(bounds)
    free_parameters = free_parameters_of(free, fixed, started=start is not None)
    tell: Progress = progress or (lambda _: None)
    if align:
        tell("axes")
    ways = _ways_of(points, start, axis, header, align=align, given=given)
    if align and start is None:
        header = replace(header, arrangement="linear")

    def place(motion: Motion | None, start: Design | None, notes: tuple[str, ...]) -> PlacedTask:
        every = Task(
            points=points if motion is None else motion(points),
            weights=np.ones(len(points)) if precision is None else precision,
            free=free_parameters,
            bounds=limits,
            progress=tell,
            precision=precision,
        )
        walls = walls_of(every.points, header.arrangement or getattr(start or like, "arrangement", None))
        shown, hidden = shown_of(every, start, finishing, free_parameters, walls)
        refuse_hidden_blade(shown.points, len(points))
        refuse_several_blades(every.points[walls.kinds != "wall"])
        return PlacedTask(motion=motion, notes=notes, start=start, every=every, shown=shown, hidden=hidden)

    matched = partial(_matched, kind=kind, like=like, header=header, target=target)
    turns = list[PlacedTask]()
    try:
        turns.append(placed_nearest(ways, start, place))
        found, built, reason = matched(turns[0])
        if align and start is not None:
            found, built, reason = realigned(turns, (found, built, reason), place, matched)
        outcome = _outcome(turned_with(turns[-1], found), found, built, finishing)
        outcome = _with_points_left_out(outcome, target)
    except KeyboardInterrupt:
        nearest = nearest_of(turns, MOST_POINTS)
        if nearest is None:
            raise
        here, found, built = nearest
        outcome = _outcome(turned_with(here, found), found, built, finishing)
        reason = INTERRUPTED_NOTE if points.shape[1] == 3 else ""
        if len(outcome.here.every.points) < len(points):
            notes = (*notes, f"measured by {MOST_POINTS} of {len(points)} points, drawn at random")
    except DesignError as error:
        raise FitError(f"no design of the family was found near the points ({error}): {WHOLE_BLADE_HINT}") from error
    if not given and header.arrangement is None and getattr(outcome.design, "arrangement", "") == "linear":
        notes = (*notes, CASCADE_NOTE)
    return _reported(outcome, target, (*notes, *outcome.here.notes, *filter(None, [reason])))


def _ways_of(
    points: Reals,
    start: Design | None,
    axis: str | Sequence[float] | None,
    header: DesignHeader,
    *,
    align: bool,
    given: bool,
) -> Ways:
    """The motions into the machine's axes, and notes; without a `given` design they turn a cascade's span to z."""
    if axis is not None and align:
        raise FitError(
            "axis and align are both given: axis says where the machine's axis is, align finds it; leave one out"
        )
    if align:
        return [found_axes(points, arrangement=header.arrangement)] if start is None else registrations(points, start)
    motion = None if axis is None else axis_motion(axis, points.shape[1])
    cascade = header.arrangement == "linear" and points.shape[1] == 3 and not given
    if cascade and spans_along_y(points if motion is None else motion(points)):
        turn = Motion(rotation=turn_matrix(UPRIGHT), translation=np.zeros(3))
        return [(turn.after(motion), (UPRIGHT_NOTE,))]
    return [(motion, ())]


def named_family(family: str, dimension: int, given: Design | None) -> FitFamily | None:
    """The named family, or a given design's where none is named; None is the unified one. Refuses unknown names."""
    known = ["unified", "unified-section", *FAMILIES, *(f"{name}-section" for name in FAMILIES)]
    with refusing():
        choice("family", family, known)
    if family.endswith("-section") and dimension == 3:
        raise FitError(f"family is '{family}', and the points have three coordinates: give x and y alone")
    named = FAMILIES.get(family.removesuffix("-section"))
    own = None if given is None else family_of(given)
    return own if named is None and own is not None else named


def _check_call(
    points: Reals, family: FitFamily | None, start: Design | None, like: Design | None, target: MatchTarget
) -> None:
    """Refuse what does not go together; growth knows the curves of a unified blade's own channel alone."""
    if family is None:
        kinds, of_family = {2: UnifiedSection, 3: UnifiedBlade}, ""
        other, least = "points of the other kind", 14
    else:
        kinds, of_family = {2: family.section, 3: family.blade}, f" of the family {family.name}"
        other, least = "another family", 4
    kind, tolerance, count = kinds[points.shape[1]], target.tolerance, target.parameters
    for label, design in (("start", start), ("like", like)):
        if design is not None and not isinstance(design, kind):
            raise FitError(
                f"{label} is a {type(design).__name__}, and points with {points.shape[1]} coordinates need a "
                f"{kind.__name__}{of_family}: give such a design, or {other}"
            )
    if isinstance(like, UnifiedBlade) and like.flow_path is not None:
        raise FitError(
            "like is a unified blade in a flow path, of which only the numbers change: give it as start, or a design "
            "with channel.hub and channel.shroud"
        )
    resized = tolerance is not None or count is not None
    if resized and isinstance(start, UnifiedBlade) and start.flow_path is not None:
        raise FitError(
            "start is a unified blade in a flow path, whose numbers of control points are kept: leave tolerance and "
            "parameters out, or give a start with channel.hub and channel.shroud"
        )
    if tolerance is not None:
        check_positive("tolerance", tolerance, "a positive length in metres is needed, such as 5e-5")
    if tolerance is not None and count is not None:
        raise FitError("tolerance and parameters are both given: the one decides the other; leave one out")
    if count is not None and not (np.issubdtype(type(count), np.integer) and least <= count <= 2000):
        raise FitError(f"parameters is {count!r}: a whole number from {least} to 2000 is needed")


def _rows_searched(points: Reals) -> NDArray[np.intp]:
    """Which of points (n, d) searches use: no more than they need, without those that stand alone."""
    # the noise that copies share would seem to be a misfit
    some = without_copies(points)
    some = some[random_subset(len(some), MOST_POINTS)]
    places, back = np.unique(points[some], axis=0, return_inverse=True)
    return some[~isolated_points(places)[np.ravel(back)]]


def _matched(
    here: PlacedTask, *, kind: FitFamily | None, like: Design | None, header: DesignHeader, target: MatchTarget
) -> Matched:
    """The match of a family, what it builds, and why it ends where no target is met."""
    task, start = here.shown.part(_rows_searched(here.shown.points)), here.start
    if kind is None:
        found, reason = matched_unified(task, start, like, header, target)
    else:
        first = None if start is None else task.free.applied(start)
        matched = matched_section if task.dimension == 2 else matched_blade
        found, reason = matched(task, kind, first, like, header, target)
    try:
        return found, found.design.build(), reason
    except DesignError as error:
        return task.best_so_far.instead_of(found, error, structured=target.structured)


def _weights(weights: ArrayLike, points: Reals) -> Reals:
    """The given weights, of a mean of one."""
    needed, count = f"one number of 0 or more is needed for each of the {len(points)} points", len(points)
    found = reals("weights", weights, needed)
    if found.shape != (count,) or not np.all(np.isfinite(found)) or np.any(found < 0.0):
        raise FitError(f"weights have shape {found.shape}: {needed}")
    different_points(points[found > 0.0], " of a weight above 0")
    return found * (count / np.sum(found))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Outcome:
    """A match, what it builds with cuts and fillets, and all points measured against it."""

    here: PlacedTask
    match: Match
    plain: Any
    design: Design
    built: Any
    finishing: RowDesign | None
    failures: tuple[str, ...]
    measurement: Measurement

    @property
    def largest(self) -> float:
        """Largest distance of an inlier [m]."""
        return float(np.max(self.measurement.distances[self.measurement.inliers]))


def _outcome(
    here: PlacedTask, match: Match, plain: Any, finishing: RowDesign | None, hint: Footpoints | None = None
) -> _Outcome:
    every, failures = here.every, tuple[str, ...]()
    every.progress("measuring")
    design, built = match.design, plain
    if finishing is not None:
        try:
            whole = finished(match.design, finishing)
            built, design = whole.build(), whole
        except DesignError as error:
            failures = (f"what is found cannot be cut or filleted as is given, and is left without: {error}",)
    return _Outcome(
        here=here,
        match=match,
        plain=plain,
        design=design,
        built=built,
        finishing=finishing,
        failures=failures,
        measurement=measured(every.points, plain, every.precision, hidden=here.hidden, finished=built, hint=hint),
    )


def _with_points_left_out(outcome: _Outcome, target: MatchTarget) -> _Outcome:
    """The outcome with those points searched too that were not drawn and lie further off than is trusted or asked.

    Corners and ends may be beside them alone.
    """
    here, match, measurement = outcome.here, outcome.match, outcome.measurement
    limit = target.tolerance or max(trusted_distance(match), NEAR_RICH * match.maximum)
    far = measurement.inliers & (measurement.distances > limit)
    shown = np.flatnonzero(here.hidden == "") if here.hidden is not None else np.arange(len(far))
    task, missed = here.shown.turned(match.turn), np.flatnonzero(far[shown])
    if match.interrupted or len(missed) == 0 or len(shown) <= THOROUGH_POINTS:
        return outcome
    rows = _rows_searched(here.shown.points)
    drawn = rows[random_subset(len(rows), THOROUGH_POINTS)]
    trusted = np.isin(np.arange(len(shown)), missed)
    more = replace(task, trusted=trusted).part(np.union1d(drawn, missed))
    found = searched_with_more(more, match, target)
    if found is match:
        return outcome
    again = _outcome(here, found, found.design.build(), outcome.finishing, measurement.footpoints)
    return min(outcome, again, key=lambda each: each.largest)


def _reported(outcome: _Outcome, target: MatchTarget, notes: tuple[str, ...]) -> Fit:
    match, measurement = outcome.match, outcome.measurement
    statistics = parameter_estimates(match)
    acceptance = Acceptance(match=match, measurement=measurement, statistics=statistics, target=target)
    try:
        extrema = extrema_of(outcome.plain)
    except DesignError:
        # sections that end a search on the way cannot be drawn
        extrema = {}
    return Fit(
        design=outcome.design,
        built=outcome.built,
        cloud=outcome.here.every.points,
        **{each.name: getattr(measurement, each.name) for each in fields(PlacesOfPoints)},
        **vars(statistics),
        extrema=extrema,
        tolerance=target.tolerance,
        failures=(*acceptance.failures(), *outcome.failures),
        notes=(*notes, *acceptance.notes()),
        evaluations=match.evaluations,
        motion=outcome.here.motion,
        interrupted=match.interrupted,
    )
