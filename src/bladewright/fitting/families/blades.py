"""From points in space to a blade from sections of a family."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.designs import Design, unit_at
from bladewright.errors import DesignError, FitError
from bladewright.fitting.assessment.acceptance import NEAR_EVERYWHERE, SHARED_VARIANCE, MatchTarget
from bladewright.fitting.families.closed_blade import QUICK_ROUNDS, closed_blades
from bladewright.fitting.families.first_parts import first_part, through_points
from bladewright.fitting.families.flow_path import ClosedChannel
from bladewright.fitting.families.kinds import DesignHeader, FitFamily
from bladewright.fitting.families.laws import MIDDLE, SECTION_SPANS, nearest_law, part_of_laws, with_mean_laws
from bladewright.fitting.families.section_shape import PLACES, SectionShape, section_shape, unrolled
from bladewright.fitting.families.sections import (
    CONSIDERED,
    PROMISING,
    TRIAL_POINTS,
    TRIAL_ROUNDS,
    compared,
    criterion,
    first_designs,
    inliers_of,
    is_far,
    misfits,
)
from bladewright.fitting.free_parameters import EDGES, FreeParameters
from bladewright.fitting.initial_guess.blade import UPRIGHT, spans_along_y
from bladewright.fitting.matching.footpoints import nearest_footpoints
from bladewright.fitting.matching.scales import check_bounds, part_range
from bladewright.fitting.matching.search import ROUGH_REDUCTION, Match, Task, can_be_built, searched
from bladewright.fitting.model_selection.selection import (
    QUICK_POINTS,
    SEVERAL_POINTS,
    determined,
    selected_match,
)
from bladewright.fitting.model_selection.structure import reshaped, structure_of
from bladewright.fitting.model_selection.structure_search import SETTLED_RICH
from bladewright.fitting.models.model import ModelShape, model_of
from bladewright.numerics.elementary import turned_left, unit
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.laws import Span, law_points

WALLS_HELD_NOTE = "hub and shroud are held as they are given"
"""note where the flow path is given"""
ROUNDNESS_PLACE, ROUNDER_RATIO = 0.04, 1.3
"""chord fraction from an edge at which its roundness is compared, and the ratio of half thicknesses (`ROUNDER_RATIO`)
from which one edge is the rounder one (design/matching_constants.md)"""
CONTOUR_POINTS = 32
"""points of contours along the chord where no profile is near enough (design/matching.md)"""
ALIKE = 1.1
"""ratio of the misfits of two kinds of section in the middle, such as with a round and with a blunt edge, up to which
short searches of whole blades tell them apart: the closed blade has round edges (design/matching.md)"""
PLANES_ALIKE, BLADES_ALIKE = 1.5, 1.25
"""ratio of misfits in the middle up to which a plane may be the right one, and of those of whole blades up to which the
one nearest in the middle is kept (design/matching.md)"""
CONFORMAL, UNROLLED = "m'-theta", "m-r*theta"
"""planes of stream surfaces in which sections are tried"""
SAME_RADIUS = 1.02
"""ratio of the edges' radii below which both planes show the same sections but for their size, within 1 %"""
BAND = 0.15
"""half the width, in v, of the band of points that are taken for points of the section in its middle
(design/matching_constants.md)"""


def matched_blade(
    task: Task, kind: FitFamily, start: Any, like: Any, header: DesignHeader, target: MatchTarget
) -> tuple[Match, str]:
    """The match of points (n, 3) by a blade of the family, and why it ends where no target is met.

    `start` and `like` are blades of the family, or None. Raises FitError where no blade of the family has a shape near
    the points.
    """
    own = start is None and like is None
    if own and isinstance(task.free, FreeParameters):
        task = replace(task, free=replace(task.free, walls=True))
    tried, refusals, trials = list[tuple[Task, Match, str]](), list[Exception](), list[Match]()
    for turned, row in _arranged(task, header, own=own):
        there, first = turned, start
        try:
            if start is None:
                turn, first, trial = _first_blade(turned, kind, like, row)
                there, trials = turned.turned(turn), [*trials, trial]
                # short searches tell what is so much further off
                off = misfits(trials)
                if tried and off[-1] > PROMISING * off[0]:
                    break
            tried.append((there, *_selected(there, first, like, target, guessed=start is None)))
        except (DesignError, FitError) as error:
            refusals.append(error)
            continue
        design: Any = tried[-1][1].design
        if not is_far(tried[-1][1], target) or design.arrangement == "linear":
            break
    if not tried:
        raise refusals[0]
    task, found, reason = min(tried, key=lambda each: criterion(each[1], target))
    misfit = is_far(found, target, NEAR_EVERYWHERE) and found.noise_estimate.correlation > SHARED_VARIANCE
    if kind.has_contours and own and misfit and target.parameters is None:
        outlined = _through_points(task, found, target)
        found, reason = min(filter(None, ((found, reason), outlined)), key=lambda each: criterion(each[0], target))
    return found, "; ".join(filter(None, (reason, "" if own else WALLS_HELD_NOTE)))


def _arranged(task: Task, header: DesignHeader, *, own: bool) -> Iterator[tuple[Task, DesignHeader]]:
    """What is sought in the arrangements in which it may be: first as the points seem to show it, or as is given.

    Where nothing is given, the blade of a cascade, with its span along z or y, may be taken for one around the axis.
    """
    yield task, header
    if own and header.arrangement is None:
        yield task.turned(UPRIGHT if spans_along_y(task.points) else 0.0), replace(header, arrangement="linear")


def _selected(task: Task, first: Any, like: Any, target: MatchTarget, *, guessed: bool) -> tuple[Match, str]:
    """The match that begins with a blade, of the structure of `like` if any, and why it ends where no target is met."""
    structure = None if like is None else structure_of(like)
    first = first if structure is None else reshaped(first, structure)
    first = task.free.applied(first) if isinstance(task.free, FreeParameters) else first
    check_bounds(first, task.free(first), task.bounds)
    return selected_match(task, first, target, like=structure, guessed=guessed)


def _through_points(task: Task, match: Match, target: MatchTarget) -> tuple[Match, str] | None:
    """The match by contours that begin as the sections of another match, and why it ends where no target is met.

    None where it has no shape, or cannot be built.
    """
    design: Any = match.design
    some = inliers_of(task, match, SEVERAL_POINTS)
    try:
        parts = [through_points(each, CONTOUR_POINTS) for each in _shapes_of(design.section)]
        first = replace(design, section=part_of_laws(parts))
        found = searched(some, first, min_reduction=ROUGH_REDUCTION, settled=SETTLED_RICH, fading=True)
        outlined = determined(some, found) if target.open else (found, "")
    except (DesignError, FitError):
        return None
    return outlined if can_be_built(outlined[0].design) else None


def _shapes_of(part: Any) -> list[SectionShape]:
    """The shapes of a part's sections at SECTION_SPANS, apart from where they stand."""
    span = Span(SECTION_SPANS)
    upper, lower = (np.real(side) for side in part.outline(span).points(PLACES))
    turns = np.broadcast_to(np.real(part.stagger(span)), len(SECTION_SPANS))
    return [
        SectionShape(chord=1.0, stagger=float(turn), start=np.zeros(2), upper=u, lower=v, edge_radii=(0.0, 0.0))
        for turn, u, v in zip(turns, upper, lower, strict=True)
    ]


def _first_blade(task: Task, kind: FitFamily, like: Any, header: DesignHeader) -> tuple[float, Design, Match]:
    """The turn of a frame, and the family's first blade in it, from the sections of a closed one of the unified family.

    The short search that it was taken from comes with it.
    """
    begun, blades = closed_blades(task, like, header)
    task.progress("first design of the family")
    refusals = list[Exception]()
    for blade, count in blades:
        try:
            turn, first, trial = _first(task.turned(begun), model_of(blade).shape(blade), kind, like, header, count)
            return begun + turn, first, trial
        except (DesignError, FitError) as error:
            refusals.append(error)
    raise refusals[0]


def _band(task: Task, closed: ModelShape, v: float) -> Reals:
    """Points (n, 2) of the section at v of a closed blade, with the deviations of the points of the cloud beside it."""
    few = task.thinned(SEVERAL_POINTS)
    feet = nearest_footpoints(few.points, closed.sides)
    section = closed.exact.section(v)
    found = []
    for number, name in enumerate(("upper", "lower")):
        rows = np.flatnonzero((feet.side == number) & (np.abs(feet.v - v) < BAND))
        curve = section.curves[name]
        places, along = np.real(curve(feet.u[rows])), np.real(curve.derivative(feet.u[rows]))
        scale = np.real(section.scale(places[:, 0]))
        left = unit(turned_left(along))
        found.append(places + (feet.heights[rows] / scale)[:, None] * (left if number == 0 else -left))
    return np.concatenate(found)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Frame:
    """The sections of a closed blade in a plane, of the machine turned about x."""

    plane: Any
    turn: float
    """[rad]"""
    shapes: list[SectionShape]
    """at SECTION_SPANS"""
    points: Reals
    """(n, 2) beside the one in the middle"""


def _first(
    task: Task, closed: ModelShape, kind: FitFamily, like: Any, header: DesignHeader, count: int
) -> tuple[float, Design, Match]:
    """The turn of a frame, the blade of the family in it whose sections are a closed blade's, and its short search.

    Its laws have `count` control points along the span.
    Planes and kinds of section that those in the middle hardly tell apart are told apart by a short search of whole
    blades, of each plane with theta counted from where these meet it best.
    """
    built = [closed.exact.section(float(v)) for v in SECTION_SPANS]
    found, middle = ClosedChannel(exact=closed.exact), section_shape(built[MIDDLE])
    found = replace(found, backwards=_backwards(found, kind, like, middle))
    band = _band(task, closed, float(SECTION_SPANS[MIDDLE]))
    part = None if like is None else with_mean_laws(like.section)
    tried = list[tuple[Match, _Frame]]()
    refusal: Exception = FitError("no plane of sections was tried")
    for plane, turn in _planes(task, found, like, middle):
        shapes = [section_shape(each, unroll=plane == UNROLLED, turn=turn) for each in built]
        beside = unrolled(built[MIDDLE], band, turn) if plane == UNROLLED else band
        if found.backwards:
            shapes, beside = [each.reversed() for each in shapes[::-1]], beside * [-1.0, 1.0]
        try:
            matches = _matched(kind, shapes[MIDDLE], beside, part)
            frame = _Frame(plane=plane, turn=turn, shapes=shapes, points=beside)
            tried += [(match, frame) for match in matches]
        except (DesignError, FitError) as error:
            refusal = error
    few, blades = task.thinned(QUICK_POINTS), list[tuple[Match, _Frame]]()
    off = misfits([match for match, _ in tried]) if tried else []
    nearest_first = np.argsort(off, kind="stable")[:CONSIDERED]
    promising = [number for number in nearest_first if off[number] <= PLANES_ALIKE * min(off)]
    # of one nothing is to be decided
    rounds = TRIAL_ROUNDS if len(promising) > 1 else 1
    for number in promising:
        chosen, frame = tried[number]
        if any(frame.plane == each.plane and frame is not each for _, each in blades):
            continue
        try:
            section = part_of_laws(_along_span(frame.shapes, _in_place(kind, frame, chosen.design)), count)
            design = _blade_of(found, frame, kind.blade, section, like, header, count)
            blades.append((compared(few.turned(frame.turn), [design], rounds=rounds)[0], frame))
        except (DesignError, FitError) as error:
            refusal = error
    if not blades:
        raise refusal
    best, frame = blades[_alike([match for match, _ in blades], BLADES_ALIKE)[0]]
    nearest: Any = best.design
    if not frame.turn:
        return 0.0, nearest, best
    # the leading edge is better known than by the closed blade
    theta = float(np.real(Span(np.array([0.5])).values(nearest.leading_edge_theta)[0]))
    law = np.array(law_points(nearest.leading_edge_theta)) - theta
    return float(frame.turn - np.radians(theta)), replace(nearest, leading_edge_theta=tuple(law.tolist())), best


def _blade_of(
    found: ClosedChannel,
    frame: _Frame,
    blade: type[SectionedBlade],
    section: Any,
    like: Any,
    header: DesignHeader,
    count: int,
) -> Any:
    """The blade of sections that stand where those of a closed blade do."""
    design = found.exact.design
    metre = UNITS[header.length_unit]
    linear = design.arrangement == "linear"
    place = [float(each.start[1]) / metre if linear else float(np.degrees(each.start[1])) for each in frame.shapes]
    if frame.plane == UNROLLED:
        place = [each / r for each, r in zip(place, found.values("leading_edge", SECTION_SPANS)[:, 1], strict=True)]
    fields: dict[str, Any] = {
        "name": header.name,
        "length_unit": header.length_unit,
        "arrangement": design.arrangement,
        "blade_count": design.blade_count,
        "pitch": None if design.pitch is None else design.pitch * UNITS[design.length_unit] / metre,
        "section": section,
    }
    name = "leading_edge_y" if linear else "leading_edge_theta"
    fields[name] = nearest_law(place, count)
    if like is None:
        fields |= {edge: found.edge(edge, metre) for edge in EDGES}
        return blade(**fields, flow_path=found.flow_path(metre, revolved=not linear), plane=frame.plane)
    fields |= {edge: found.edge_like(edge, getattr(like, edge), metre) for edge in EDGES}
    return replace(like, **fields)


def _backwards(found: ClosedChannel, kind: FitFamily, like: Any, section: SectionShape) -> bool:
    """Whether the flow comes from the other side than the closed blade was found for.

    Points do not show it: `like` does. Without it wedges open downstream, other blades lead along x, and where they
    stand radially the flow meets the rounder edge first.
    """
    middle = np.array([0.5])
    first, last = (found.values(edge, middle)[0] for edge in EDGES)
    if like is not None and like.leading_edge is not None:
        metre = UNITS[like.length_unit]
        own = [np.real(getattr(like, edge).line(metre).values(middle))[0] for edge in EDGES]
        return float((last - first) @ (own[1] - own[0])) < 0.0
    if kind.name == "wedge-diffuser":
        first, last = section.half(np.array([0.2, 0.8]))
        return bool(last < first)
    if abs(last[1] - first[1]) <= abs(last[0] - first[0]):
        return False
    first, last = section.half(np.array([ROUNDNESS_PLACE, 1.0 - ROUNDNESS_PLACE]))
    return bool(last > ROUNDER_RATIO * first)


def _planes(task: Task, found: ClosedChannel, like: Any, middle: SectionShape) -> list[tuple[str, float]]:
    """The planes in which sections may be those of the family, and the turns about x of the machine there [rad].

    Where radii differ, planes do not show the same shapes, and that of r theta neither wherever theta is counted from:
    nobody says, and where the leading edge stands its angles are true.
    """
    if found.exact.design.arrangement == "linear":
        return [(CONFORMAL, 0.0)]
    if like is not None:
        return [(UNROLLED if like.plane == UNROLLED else CONFORMAL, 0.0)]
    radii = [found.values(edge, np.array([0.5]))[0, 1] for edge in EDGES]
    if max(radii) < SAME_RADIUS * min(radii):
        return [(CONFORMAL, 0.0)]
    turn = -float((middle.reversed() if found.backwards else middle).start[1])
    own = [(CONFORMAL, 0.0), (UNROLLED, 0.0)]
    return own if task.bounds else [*own, (UNROLLED, turn)]


def _along_span(shapes: Sequence[SectionShape], part: Any) -> list[Any]:
    """Parts at places along the span: that of the middle, which was searched, changed as the shapes say.

    Angles change by what the first parts of the shapes there and in the middle differ, and lengths by their ratio.
    """
    firsts = [first_part(part, shape).parameters() for shape in shapes]

    def changed(path: str, value: float, first: float, there: float) -> float:
        unit = unit_at(part, path)
        by_ratio = unit != "deg" and min(value, first, there) > 0.0
        allowed = part_range(part, path, value, abs(value))
        found = value * there / first if by_ratio else value + there - first
        return float(np.clip(found, min(value, allowed.low), max(value, allowed.high)))

    values = part.parameters()
    return [
        part.changed({path: changed(path, value, firsts[MIDDLE][path], there[path]) for path, value in values.items()})
        for there in firsts
    ]


def _matched(kind: FitFamily, shape: SectionShape, points: Reals, like: Any) -> list[Match]:
    """The best match of points (n, 2) of a section, of the structure of a given part, and those hardly worse."""
    task = Task(points=points, weights=np.ones(len(points)), free=FreeParameters(), bounds={})
    header = DesignHeader(name="section", length_unit="m")
    tried = compared(task.thinned(TRIAL_POINTS), first_designs(kind, shape, like, header, task))[:CONSIDERED]
    found = [searched(task, each.design, rounds=QUICK_ROUNDS, fading=True) for each in tried]
    return [found[number] for number in _alike(found)]


def _in_place(kind: FitFamily, frame: _Frame, middle: Any) -> Any:
    """The part of a section in the middle, searched again with the edges where the closed blade's section has them.

    Its chord and place were free when kinds of section were compared; those of the blade are the closed blade's.
    """
    task = Task(
        points=frame.points,
        weights=np.ones(len(frame.points)),
        free=FreeParameters(fixed=("chord", "leading_edge_x", "leading_edge_y")),
        bounds={},
    )
    header = DesignHeader(name="section", length_unit="m")
    first = next(iter(first_designs(kind, frame.shapes[MIDDLE], middle.section, header, task)))
    found: Any = searched(task, first, rounds=QUICK_ROUNDS, fading=True).design
    return found.section


def _alike(matches: Sequence[Match], ratio: float = ALIKE) -> list[int]:
    """The numbers of those that are hardly worse than the best, in their order."""
    off = misfits(matches)
    return [number for number, each in enumerate(off) if each <= ratio * min(off)]
