"""The first blade of a family from sections: those of a closed blade, in the planes in which they may be.

Kinds of section are chosen in the middle, by points beside it; planes by short searches of whole blades, where the
sections in the middle hardly tell them apart.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.designs import Design, unit_at
from bladewright.errors import DesignError, FitError
from bladewright.fitting.families.closed_blade import QUICK_ROUNDS, closed_blades
from bladewright.fitting.families.first_parts import first_part
from bladewright.fitting.families.flow_path import ClosedChannel
from bladewright.fitting.families.kinds import DesignHeader, FitFamily
from bladewright.fitting.families.laws import MIDDLE, SECTION_SPANS, nearest_law, part_of_laws, with_mean_laws
from bladewright.fitting.families.section_shape import SectionShape, section_shape, unrolled
from bladewright.fitting.families.sections import (
    CONSIDERED,
    TRIAL_POINTS,
    TRIAL_ROUNDS,
    compared,
    first_designs,
    misfits,
)
from bladewright.fitting.free_parameters import EDGES, FreeParameters
from bladewright.fitting.initial_guess.blade import FirstBlade
from bladewright.fitting.matching.footpoints import nearest_footpoints
from bladewright.fitting.matching.scales import part_range
from bladewright.fitting.matching.search import Match, Task, searched
from bladewright.fitting.model_selection.selection import QUICK_POINTS, SEVERAL_POINTS
from bladewright.fitting.models.model import ModelShape, model_of
from bladewright.numerics.elementary import turned_left, unit
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.laws import Span, law_points

ROUNDNESS_PLACE, ROUNDER_RATIO = 0.04, 1.3
"""chord fraction from an edge at which its roundness is compared, and the ratio of half thicknesses (`ROUNDER_RATIO`)
from which one edge is the rounder one (design/matching_constants.md)"""
PLANES_ALIKE, IN_DOUBT = 1.5, 1.25
"""ratio of misfits in the middle up to which a plane may be the right one, and of those of whole blades up to which the
plane is kept that designs have by default (design/matching.md)"""
CONFORMAL, UNROLLED = "m'-theta", "m-r*theta"
"""planes of stream surfaces in which sections are tried: the first is that of designs that name none"""
SAME_RADIUS = 1.02
"""ratio of the edges' radii below which both planes show the same sections but for their size, within 1 %"""
BAND = 0.15
"""half the width, in v, of the band of points that are taken for points of the section in its middle, and share of the
points that the nearest of others are where the band has fewer (design/matching_constants.md)"""


def first_of_family(
    task: Task, begun: FirstBlade, kind: FitFamily, like: Any, header: DesignHeader
) -> tuple[float, Design, Match]:
    """The turn of a frame about x [rad], and the family's first blade in it, from the sections of a closed unified one.

    The short search that it was taken from comes with it. Raises the first refusal where no closed blade leads to one.
    """
    task.progress("first design of the family")
    refusals = list[Exception]()
    for blade, count in closed_blades(task, begun):
        try:
            shape = model_of(blade).shape(blade)
            turn, first, trial = _first(task.turned(begun.turn), shape, kind, like, header, count)
            return begun.turn + turn, first, trial
        except (DesignError, FitError) as error:
            refusals.append(error)
    raise refusals[0]


def _first(
    task: Task, closed: ModelShape, kind: FitFamily, like: Any, header: DesignHeader, count: int
) -> tuple[float, Design, Match]:
    """The turn of a frame, the blade of the family in it whose sections are a closed blade's, and its short search.

    Its laws have `count` control points along the span.
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
            frame = _Frame(plane=plane, turn=turn, shapes=shapes, points=beside)
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
            design = _blade_of(found, frame, kind.blade, section, like, header, count)
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
    theta = float(np.real(Span(np.array([0.5])).values(nearest.leading_edge_theta)[0]))
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
    off = misfits([blade for blade, _ in blades])
    doubt = [IN_DOUBT if frame.plane == CONFORMAL else 1.0 for _, frame in blades]
    return blades[int(np.argmin(np.divide(off, doubt)))]


def _band(task: Task, closed: ModelShape, v: float) -> Reals:
    """Points (n, 2) of the section at v of a closed blade, with the deviations of the points of the cloud beside it.

    A cloud of few sections may have none so near: then the nearest points are.
    """
    few = task.thinned(SEVERAL_POINTS)
    feet = nearest_footpoints(few.points, closed.sides)
    away = np.abs(feet.v - v)
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


def _matched(kind: FitFamily, shape: SectionShape, points: Reals, like: Any) -> Match:
    """The match of points (n, 2) of a section by the best kind of section, or by the structure of a given part."""
    task = Task(points=points, weights=np.ones(len(points)), free=FreeParameters(), bounds={})
    header = DesignHeader(name="section", length_unit="m")
    tried = compared(task.thinned(TRIAL_POINTS), first_designs(kind, shape, like, header, task))[:CONSIDERED]
    found = [searched(task, each.design, rounds=QUICK_ROUNDS, fading=True) for each in tried]
    return found[int(np.argmin(misfits(found)))]


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
