"""The first blade of a family from sections: those of a closed blade, in the planes in which they may be.

Kinds of section are chosen in the middle, by points beside it; planes by short searches of whole blades, where the
sections in the middle hardly tell them apart. Laws along the span are taken from sections at several places.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np

from bladewright.designs import Design, Law, unit_at
from bladewright.errors import DesignError, FitError
from bladewright.fitting.assessment.acceptance import NEAR_EVERYWHERE, MatchTarget
from bladewright.fitting.families.closed_blade import ClosedChannel, SectionShape, section_shape, unrolled
from bladewright.fitting.families.first_parts import first_part
from bladewright.fitting.families.kinds import DesignHeader, FitFamily
from bladewright.fitting.families.sections import (
    CONSIDERED,
    TRIAL_POINTS,
    TRIAL_ROUNDS,
    compared,
    first_designs,
    misfits,
)
from bladewright.fitting.free_parameters import EDGES, FreeParameters, parameter_range
from bladewright.fitting.initial_guess.blade import FirstBlade
from bladewright.fitting.matching.footpoints import nearest_footpoints
from bladewright.fitting.matching.search import Match, Task, searched
from bladewright.fitting.model_selection.selection import GUESS_NOISE, QUICK_POINTS, SEVERAL_POINTS
from bladewright.fitting.model_selection.structure import structure_of
from bladewright.fitting.model_selection.structure_search import StructureSearch
from bladewright.fitting.models.designs import infeasibility
from bladewright.fitting.models.model import ModelShape, model_of
from bladewright.numerics.elementary import turned_left, unit
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.laws import Span, law_basis, law_points, named_laws

SECTION_SPANS: Reals = np.linspace(0.0, 1.0, 7)
"""places along the span of the sections that laws are taken from"""
MIDDLE = len(SECTION_SPANS) // 2
"""number of the section in the middle, by which structures are compared"""
FEASIBILITY_SPANS = Span(np.linspace(0.0, 1.0, 13))
"""places along the span at which laws must leave sections a shape"""
LAW_COUNT = 3
"""control points of each law along the span of a first blade (design/matching_constants.md)"""
QUICK_ROUNDS = 4
"""rounds of short searches for what a first design is taken from (design/matching_constants.md)"""
RICH_LAW_COUNT = 6
"""control points of each law of a first blade whose closed one needed a rich structure (design/matching.md)"""
ROUNDNESS_PLACE, ROUNDER_RATIO = 0.04, 1.3
"""chord fraction from edges whose half thickness tells the rounder one, and ratio (design/matching_constants.md)"""
PLANES_ALIKE, IN_DOUBT = 1.5, 1.25
"""ratio of misfits in the middle up to which a plane may be the right one, and of those of whole blades up to which the
plane is kept that designs have by default (design/matching.md)"""
CONFORMAL, UNROLLED = "m'-theta", "m-r*theta"
"""planes of stream surfaces in which sections are tried: the first is that of designs that name none"""
HALF_SPAN: Reals = np.array([0.5])
"""v at which edges are compared"""
SAME_RADIUS, SAME_TURN = 1.02, 0.01
"""ratio of the edges' radii below which both planes show the same sections but for their size, within 1 %, and angle
from which theta is counted below which their angles are the same within half a degree [rad]"""
SECTION_HEADER = DesignHeader(name="section", length_unit="m")
"""of the section in the middle, which is matched on its own"""
BAND = 0.15
"""half width, in v, of the band of points of the middle section, and its least share (design/matching_constants.md)"""


def first_of_family(
    task: Task, begun: FirstBlade, kind: FitFamily, like: Any, header: DesignHeader
) -> tuple[float, Design, Match]:
    """The turn of a frame about x [rad], the family's first blade in it, from a closed one, and its short search."""
    task.progress("first design of the family")
    refusals = list[Exception]()
    for blade, count in closed_blades(task, begun):
        try:
            closed = model_of(blade).shape(blade)
            turn, first, trial = _first(task.turned(begun.turn), closed, kind, like, header, count)
            return begun.turn + turn, first, trial
        except (DesignError, FitError) as error:
            refusals.append(error)
    raise refusals[0]


def closed_blades(task: Task, begun: FirstBlade) -> Iterator[tuple[Design, int]]:
    """Closed blades from a first one, in the order to be tried, and the control points of laws that begin with them.

    They are searched, richly where few control points are not near everywhere; the last is the first one, whose edges
    miss no wall. They need not be fit to be built, as sections and channel are all that is taken from them.
    """
    task = replace(task.turned(begun.turn), free=FreeParameters(), bounds={}, walls=task.walls or begun.walls)
    found = searched(task.thinned(QUICK_POINTS), begun.design, noise=GUESS_NOISE, rounds=QUICK_ROUNDS)
    if found.maximum > NEAR_EVERYWHERE * found.model.chord:
        # few control points do not follow sections that change much along the span
        samples = structure_of(found.design).samples
        search = StructureSearch(task=task.thinned(SEVERAL_POINTS), samples=samples, first=found.design)
        yield search.rich(found, MatchTarget(structured=True)).design, RICH_LAW_COUNT
    yield found.design, LAW_COUNT
    yield begun.design, LAW_COUNT


def _first(
    task: Task, closed: ModelShape, kind: FitFamily, like: Any, header: DesignHeader, count: int
) -> tuple[float, Design, Match]:
    """The turn of a frame, the blade in it with a closed blade's sections and laws of `count`, and its short search."""
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
        frame = _Frame(plane=plane, turn=turn, shapes=shapes, points=beside)
        try:
            tried.append((_matched(kind, shapes[MIDDLE], beside, part), frame))
        except (DesignError, FitError) as error:
            refusal = error
    off = misfits([chosen for chosen, _ in tried]) if tried else []
    promising = [each for each, miss in zip(tried, off, strict=True) if miss <= PLANES_ALIKE * min(off)]
    # of one alone nothing is to be decided
    rounds, few, blades = TRIAL_ROUNDS if len(promising) > 1 else 1, task.thinned(QUICK_POINTS), []
    for chosen, frame in promising:
        try:
            section = part_of_laws(_along_span(frame.shapes, _in_place(kind, frame, chosen.design)), count)
            design = _blade_of(found, frame, kind, section, like, header, count)
            blades.append((compared(few.turned(frame.turn), [design], rounds=rounds)[0], frame))
        except (DesignError, FitError) as error:
            refusal = error
    if not blades:
        raise refusal
    best, frame = _nearest(blades)
    nearest: Any = best.design
    if not frame.turn:
        return 0.0, nearest, best
    # the leading edge is better known than by the closed blade
    theta = float(np.real(Span(HALF_SPAN).values(nearest.leading_edge_theta)[0]))
    law = np.array(law_points(nearest.leading_edge_theta)) - theta
    return float(frame.turn - np.radians(theta)), replace(nearest, leading_edge_theta=tuple(law.tolist())), best


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


def _nearest(blades: Sequence[tuple[Match, _Frame]]) -> tuple[Match, _Frame]:
    """The blade that is nearest to the points; in doubt the one in the plane that designs have by default."""
    doubt = [IN_DOUBT if frame.plane == CONFORMAL else 1.0 for _, frame in blades]
    return blades[int(np.argmin(np.divide(misfits([blade for blade, _ in blades]), doubt)))]


def _band(task: Task, closed: ModelShape, v: float) -> Reals:
    """Points (n, 2) of the section at v of a closed blade, with the deviations of the points of the cloud beside it."""
    few = task.thinned(SEVERAL_POINTS)
    feet = nearest_footpoints(few.points, closed.sides)
    away = np.abs(feet.v - v)
    # a cloud of few sections may have none in the band
    beside = away <= max(BAND, float(np.quantile(away, BAND)))
    section = closed.exact.section(v)
    found = []
    for number, name in enumerate(("upper", "lower")):
        rows = np.flatnonzero((feet.side == number) & beside)
        curve = section.curves[name]
        places, along = np.real(curve(feet.u[rows])), np.real(curve.derivative(feet.u[rows]))
        scale = np.real(section.scale(places[:, 0]))
        left = unit(turned_left(along))
        found.append(places + (feet.heights[rows] / scale)[:, None] * (left if number == 0 else -left))
    return np.concatenate(found)


def _blade_of(
    found: ClosedChannel, frame: _Frame, kind: FitFamily, section: Any, like: Any, header: DesignHeader, count: int
) -> Any:
    """The blade of sections that stand where those of a closed blade do."""
    design, metre = found.exact.design, UNITS[header.length_unit]
    linear = design.arrangement == "linear"
    place = [float(each.start[1]) / metre if linear else float(np.degrees(each.start[1])) for each in frame.shapes]
    if frame.plane == UNROLLED:
        place = [each / r for each, r in zip(place, found.values("leading_edge", SECTION_SPANS)[:, 1], strict=True)]
    fields: dict[str, Any] = {
        "name": header.name,
        "length_unit": header.length_unit,
        "arrangement": design.arrangement,
        "blade_count": design.blade_count,
        "pitch": None if design.pitch is None else design.pitch * design.metre / metre,
        "section": section,
        "leading_edge_y" if linear else "leading_edge_theta": nearest_law(place, count),
    }
    if like is None:
        fields |= {edge: found.edge(edge, metre) for edge in EDGES}
        return kind.blade(**fields, flow_path=found.flow_path(metre, revolved=not linear), plane=frame.plane)
    fields |= {edge: found.edge_like(edge, getattr(like, edge), metre) for edge in EDGES}
    return replace(like, **fields)


def _backwards(found: ClosedChannel, kind: FitFamily, like: Any, section: SectionShape) -> bool:
    """Whether the flow comes from the other side than the closed blade was found for: `like` shows it, points do not.

    Else wedges open downstream, other blades lead along x, and the flow meets the rounder edge of radial ones first.
    """
    first, last = (found.values(edge, HALF_SPAN)[0] for edge in EDGES)
    if like is not None and like.leading_edge is not None:
        own = [np.real(getattr(like, edge).line(like.metre).values(HALF_SPAN))[0] for edge in EDGES]
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
    radii = [found.values(edge, HALF_SPAN)[0, 1] for edge in EDGES]
    if max(radii) < SAME_RADIUS * min(radii):
        return [(CONFORMAL, 0.0)]
    turn = -float((middle.reversed() if found.backwards else middle).start[1])
    own = [(CONFORMAL, 0.0), (UNROLLED, 0.0)]
    return own if task.bounds or abs(turn) < SAME_TURN else [*own, (UNROLLED, turn)]


def _along_span(shapes: Sequence[SectionShape], part: Any) -> list[Any]:
    """Parts along the span: that of the middle, its angles changed by first parts' differences, lengths by ratios."""
    firsts = [first_part(part, shape).parameters() for shape in shapes]

    def changed(path: str, value: float, first: float, there: float) -> float:
        unit = unit_at(part, path)
        by_ratio = unit != "deg" and min(value, first, there) > 0.0
        allowed = parameter_range(part, path, value, abs(value))
        found = value * there / first if by_ratio else value + there - first
        return float(np.clip(found, min(value, allowed.low), max(value, allowed.high)))

    values = part.parameters()
    return [
        part.changed({path: changed(path, value, firsts[MIDDLE][path], there[path]) for path, value in values.items()})
        for there in firsts
    ]


def _matched(kind: FitFamily, shape: SectionShape, points: Reals, like: Any) -> Match:
    """The match of points (n, 2) of a section by the best kind of section, or by the structure of a given part."""
    task = Task(points=points, weights=np.ones(len(points)))
    tried = compared(task.thinned(TRIAL_POINTS), first_designs(kind, shape, like, SECTION_HEADER, task))[:CONSIDERED]
    found = [searched(task, each.design, rounds=QUICK_ROUNDS, fading=True) for each in tried]
    return found[int(np.argmin(misfits(found)))]


def _in_place(kind: FitFamily, frame: _Frame, middle: Any) -> Any:
    """The part of a section in the middle, searched again with the edges where the closed blade's section has them."""
    free = FreeParameters(fixed=("chord", "leading_edge_x", "leading_edge_y"))
    task = Task(points=frame.points, weights=np.ones(len(frame.points)), free=free)
    first = next(first_designs(kind, frame.shapes[MIDDLE], middle.section, SECTION_HEADER, task))
    found: Any = searched(task, first, rounds=QUICK_ROUNDS, fading=True).design
    return found.section


def with_mean_laws(part: Any) -> Any:
    """The part with each law replaced by its mean, a number."""
    return part.changed({path: float(np.mean(law_points(law))) for path, law in named_laws(part)})


def part_of_laws(parts: Sequence[Any], count: int = LAW_COUNT) -> Any:
    """One part of laws of so many control points from those of sections; FitError where even constants have no shape.

    Laws are constants where one, alone or together with those before it, leaves sections no shape.
    """
    paths = parts[MIDDLE].parameters()
    whole = _with_shape(parts, dict.fromkeys(paths, count))
    if whole is not None:
        return whole
    taken = dict.fromkeys(paths, 1)
    found = _with_shape(parts, taken) or _with_shape([parts[MIDDLE]] * len(parts), taken)
    # those of one row along the chord together: their numbers of control points change together too
    for _, row in groupby(paths, key=lambda path: path.partition("[")[0]):
        more = taken | dict.fromkeys(row, count)
        wider = _with_shape(parts, more)
        if wider is not None:
            taken, found = more, wider
    if found is None:
        raise FitError("no laws along the span leave all sections a shape")
    return found


def _with_shape(parts: Sequence[Any], counts: Mapping[str, int]) -> Any:
    """One part of laws of so many control points each, or None where it has sections without a shape."""
    try:
        part = part_along_span(parts, counts)
        outline = part.outline(FEASIBILITY_SPANS)
        outline.points(SECTION_SPANS)
        outline.check_limits([""] * len(FEASIBILITY_SPANS.v))
        infeasibility(part, FEASIBILITY_SPANS)
    except DesignError:
        return None
    return part


def part_along_span(parts: Sequence[Any], counts: Mapping[str, int]) -> Any:
    """One part of laws of so many control points each, by least squares of the numbers of those of sections."""
    values = [_with_unit_curvature(part).parameters() for part in parts]
    return parts[MIDDLE].changed({path: nearest_law([each[path] for each in values], counts[path]) for path in counts})


def nearest_law(values: Sequence[float], count: int) -> Law:
    """The law of so many control points nearest to values (m,) of the sections, kept inside their range."""
    if count == 1:
        return float(np.median(values))
    found = np.linalg.lstsq(law_basis(count, SECTION_SPANS), np.asarray(values), rcond=None)[0]
    low, high = min(values), max(values)
    margin = 0.5 * (high - low)
    # a law that runs past its values by much may leave the range in which there is a shape
    low, high = (low - margin, high + margin) if low < 0.0 else (max(low - margin, 0.5 * low), high + margin)
    return tuple(np.clip(found, low, high).tolist())


def _with_unit_curvature(part: Any) -> Any:
    """The part with control points of a second derivative scaled to a sum of magnitudes of one: ratios count."""
    values = {path: value for path, value in part.parameters().items() if path.startswith("curvature[")}
    total = float(np.sum(np.abs(list(values.values()))))
    return part.changed({path: value / total for path, value in values.items()}) if total > 0.0 else part
