"""A cloud in the machine's axes without what cuts, fillets and walls hide, and the motion there, found anew.

A match is of the blade before the cuts and fillets of a given design, which the design that is found has again. Where
a ball of radius r rolls along a wall and a side that meet at the angle a, it touches the side r (1 + cos a) above the
wall: no higher than 2 r. Edges and ends that are cut off, and walls that fillets hide, are held as they are given.

A start that is off the true shape is laid on the cloud with a tilt that no parameter of a blade around an axis takes
away, and that the shape follows. So the motion takes steps of Gauss and Newton on the residuals that no change of the
shape takes away (variable projection: Golub and Pereyra 1973, Kaufman 1975), and a match follows each.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import orth

from bladewright.blade.design.row_design import RowDesign
from bladewright.designs import Design, unit_at
from bladewright.domain.row import turn_matrix
from bladewright.errors import DesignError, FitError
from bladewright.fitting.assessment.measurement import off_walls
from bladewright.fitting.assessment.result import Motion
from bladewright.fitting.clouds.thinning import random_subset
from bladewright.fitting.clouds.walls import Walls
from bladewright.fitting.free_parameters import EDGES, WALLS, FreeParameters
from bladewright.fitting.matching.noise import EXACT
from bladewright.fitting.matching.residuals import MERIDIANS
from bladewright.fitting.matching.search import QUICK_ROUNDS, ROUGH_REDUCTION, Match, Task, searched
from bladewright.fitting.model_selection.selection import QUICK_POINTS
from bladewright.fitting.registration import OTHER_BLADE_NOTE, WEAKEST_FREEDOM, motion_by, motion_rates

MOST_REALIGNMENTS = 4
"""realignments at most: a match follows each, and they bound the time to five matches (design/matching_constants.md)"""
GAIN = 0.9
"""ratio of misfits after and before a realignment from which it is not worth a match (design/matching_constants.md)"""
ON_CUT = 1e-3
"""distance from a cut, of the cloud's extent, within which points may lie on its face (design/matching_constants.md)"""
CUT_PLACES = {"hub": "hub", "tip": "shroud", **{edge: edge for edge in EDGES}}
"""the edge or wall in whose place a cut is"""


def finished(design: Design, given: RowDesign) -> Design:
    """A design with the cuts and fillets of a given one, their lengths in its own unit."""
    names = ("cut", "hub_fillet", "shroud_fillet", "hub_clearance", "tip_clearance")
    own = {n: getattr(given, n) for n in names if getattr(given, n) is not None and getattr(given.plain, n) is None}
    found = design.changed(own)
    scale = given.metre / found.metre  # type: ignore[attr-defined]
    lengths = {
        path: value * scale
        for path, value in given.parameters().items()
        if path.replace("[", ".").partition(".")[0] in own and unit_at(given, path) == "length"
    }
    return found if scale == 1.0 else found.changed(lengths)


def without_finishing(
    start: Design | None, like: Design | None, name: str
) -> tuple[RowDesign | None, Design | None, Design | None]:
    """The design with cuts and fillets, and start and `like` without them; where none is given `like` is the start."""
    given = next((each for each in (start, like) if isinstance(each, RowDesign) and each.plain is not each), None)
    if given is None:
        return None, start, like
    first = given.changed("name", name) if start is None else start
    return given, first.plain, None if like is None else like.plain


@dataclass(frozen=True, kw_only=True, eq=False)
class PlacedTask:
    """What is sought in the machine's axes."""

    motion: Motion | None
    """that brought the cloud there"""
    notes: tuple[str, ...]
    """on the motion, each a sentence"""
    start: Design | None
    every: Task
    """with all points"""
    shown: Task
    """with those that may lie on the sides"""
    hidden: NDArray[np.str_] | None
    """(n,) what the others may lie on, empty for those on the sides"""


TURNED_NOTE = (
    "sections in the plane m-r*theta depend on where theta is counted from, and the points are turned about x by "
    "{:.6g} deg: the leading edge is near theta = 0 where they are those of the family"
)
"""note where a match turns the points"""
UPRIGHT_NOTE = (
    "the blade of the linear cascade has its span along y, and is turned about x so that it lies along z: "
    "where x is not the axial direction, name it (--axis)"
)
"""note where a cascade's blade is turned upright"""


def turned_with(here: PlacedTask, match: Match) -> PlacedTask:
    """What was sought, with the points turned about x as a match of them is."""
    if not match.turn:
        return here
    step = Motion(rotation=turn_matrix(match.turn), translation=np.zeros(3))
    linear = getattr(match.design, "arrangement", None) == "linear"
    return replace(
        here,
        motion=step.after(here.motion),
        notes=(*here.notes, UPRIGHT_NOTE if linear else TURNED_NOTE.format(np.degrees(match.turn))),
        every=here.every.turned(match.turn),
    )


Ways = Sequence[tuple[Motion | None, tuple[str, ...]]]
"""motions into the machine's axes, the nearest first, and notes on each"""
Place = Callable[[Motion | None, Design | None, tuple[str, ...]], PlacedTask]
"""what is sought after a motion, from a start, with notes on the motion"""


def placed_nearest(ways: Ways, start: Design | None, place: Place) -> PlacedTask:
    """What is sought after the motion from which a short search of the start's structure comes nearest."""
    found = list[tuple[float, PlacedTask]]()
    if start is not None and len(ways) > 1:
        for motion, notes in ways:
            with suppress(FitError):
                here = place(motion, start, notes)
                # rows at the ends of a blade that lies wrong would draw its walls to others
                free = here.shown.free(start)
                curves = [path for path in free if path.startswith(MERIDIANS)]
                few = here.shown.thinned(QUICK_POINTS).without(curves if len(curves) < len(free) else ())
                match = searched(few, start, rounds=QUICK_ROUNDS, min_reduction=ROUGH_REDUCTION)
                found.append((match.mean_distance, here))
    motion, notes = ways[0]
    return min(found, key=lambda each: each[0])[1] if found else place(motion, start, notes)


Matched = tuple[Match, Any, str]
"""a match, what its design builds, and why it ends where no target is met"""


def shown_of(
    every: Task, start: Design | None, given: RowDesign | None, free: FreeParameters, walls: Walls
) -> tuple[Task, NDArray[np.str_] | None]:
    """The task without what walls, cuts and fillets hide, whose own edges and walls are held, and (n,) what that is."""
    if given is None or start is None:
        if not walls.places:
            return every, None
        return replace(every.part(np.flatnonzero(walls.kinds == "")), walls=walls.places), walls.kinds
    cut = frozenset(place for name, place in CUT_PLACES.items() if getattr(given.cut, name, None) is not None)
    reach, unseen = {}, {*cut}
    for wall, end in zip(WALLS, given.ends, strict=True):
        sizes = [size for path, size in given.parameters().items() if path.startswith(f"{wall}_fillet.")]
        if sizes:
            reach[end] = 2.0 * given.metre * max(sizes)
            unseen.add(wall)
    on_cut = ON_CUT * float(np.max(np.ptp(every.points, axis=0)))
    off = off_walls(every.points, finished(start, given).build())
    hidden = np.any([far < reach.get(name, on_cut) for name, far in off.items()], axis=0)
    shown = replace(every.part(np.flatnonzero(~hidden)), free=replace(free, unseen=frozenset(unseen)))
    return replace(shown, cut_edges=cut & {*EDGES}), np.where(hidden, "face", "")


def realigned(turns: list[PlacedTask], found: Matched, place: Place, match: Callable[[PlacedTask], Matched]) -> Matched:
    """The nearest of matches that follow steps of the motion, while misfits fall; `turns` holds the tasks so far."""
    for _ in range(MOST_REALIGNMENTS):
        here, before = turns[-1], found[0]
        step = _step_beside(before)
        if step is None:
            break
        here.every.progress("axes")
        notes = tuple(each for each in here.notes if not each.startswith(OTHER_BLADE_NOTE))
        try:
            turns.append(place(step.after(here.motion), before.design, notes))
            nearer = match(turns[-1])
        except (DesignError, FitError):
            nearer = found
        if nearer[0].mean_distance >= before.mean_distance:
            del turns[turns.index(here) + 1 :]
            break
        found = nearer
    return found


def _step_beside(found: Match) -> Motion | None:
    """The motion's step while the shape follows, parameters on a bound held; None where it is not worth a match."""
    problem, cloud = found.problem, found.problem.cloud_residuals
    z = problem.vector(found.design)
    values, derivatives = problem.values(z), problem.derivatives(z)
    if not found.has_systematic_misfit or values is None or derivatives is None:
        return None
    shape = orth(derivatives[0][:, problem.scales.inside(problem.values_of(found.design))])
    moving = cloud.motion_slopes(found.state, motion_rates(cloud.points))
    moving = np.pad(moving, ((0, len(shape) - len(moving)), (0, 0)))
    # of residuals and their slopes, what no change of the shape takes away
    left, slopes = (each - shape @ (shape.T @ each) for each in (values[0], moving))
    change = np.linalg.lstsq(slopes, -left, rcond=WEAKEST_FREEDOM)[0]
    after = left + slopes @ change
    return None if np.sqrt(after @ after / (values[0] @ values[0])) > GAIN else motion_by(change, cloud.points)


def nearest_of(turns: list[PlacedTask], most: int) -> tuple[PlacedTask, Match, Any] | None:
    """The last task whose search has found a design, with `most` points to measure, the match, and what it builds."""
    for here in reversed(turns):
        # nobody who interrupts waits for finer blades than searches build
        nearest = here.shown.best_so_far.built(EXACT)
        if nearest is not None:
            match, built = nearest
            rows = random_subset(len(here.every.points), most)
            hidden = None if here.hidden is None else here.hidden[rows]
            return replace(here, every=here.every.part(rows), hidden=hidden), replace(match, interrupted=True), built
    return None
