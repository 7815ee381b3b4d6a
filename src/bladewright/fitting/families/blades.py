"""From points in space to a blade from sections of a family."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.design_header import DesignHeader
from bladewright.fitting.families.flow_path import ChannelCurves
from bladewright.fitting.families.growth import grown_to_target
from bladewright.fitting.families.kinds import FitFamily
from bladewright.fitting.families.law_extension import extended_blade
from bladewright.fitting.families.laws import counts_of, nearest_law, part_along_span, with_mean_laws, with_stations_of
from bladewright.fitting.families.section_samples import SampledSection, reversed_flow, sampled_section
from bladewright.fitting.families.sections import best_trial, starts_of
from bladewright.fitting.free_parameters import EDGES, FreeParameters, gauge_parameters
from bladewright.fitting.initial_guess.blade import first_blade
from bladewright.fitting.matching.scales import check_bounds
from bladewright.fitting.matching.search import EXACT_MISFIT, ROUGH_REDUCTION, Match, Task, evaluated, searched
from bladewright.fitting.model_selection.match_target import MatchTarget
from bladewright.fitting.model_selection.structure import INITIAL_BLADES
from bladewright.fitting.models.feasibility import infeasibility
from bladewright.numerics.least_squares import MIN_REDUCTION
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.laws import Span, law_points
from bladewright.section.section import Section

QUICK_POINTS, THOROUGH_POINTS = 1000, 12_000
"""points of a quick and of a thorough search (`THOROUGH_POINTS`): more points take proportionally longer and determine
parameters better."""
ENOUGH_MISFIT = 2.0
"""misfit below which a blade whose structure is not given is found, of the tolerance of its native sides: these miss
the design about so much themselves (design/fit_families.md)."""
COARSE_TOLERANCE = 1e-3
"""tolerance of the native sides of intermediate blades, of the chord."""
WALLS_HELD_NOTE = "hub and shroud are held as they are given"
"""note where the flow path is given"""
ROUNDNESS_PLACE, ROUNDER_RATIO = 0.04, 1.3
"""chord fraction from an edge at which its roundness is compared, and the ratio of half thicknesses (`ROUNDER_RATIO`)
from which one edge is the rounder one."""
QUICK_ROUNDS = 4
"""rounds of the search for the closed blade from which the family's first design is taken"""
START_SPANS: Reals = np.linspace(0.0, 1.0, 7)
"""places along the span of the sections that a start is taken from"""
FEASIBILITY_SPANS = Span(np.linspace(0.0, 1.0, 13))
"""places along the span at which laws must leave sections a shape"""
LAW_COUNT = 3
"""control points of each law along the span where no structure is given"""
TRIAL_SECTION = 3
"""number of the section, among those of the start, by which structures are compared"""
TRIAL_STRIDE = 4
"""structures are compared by every so many-th sample of that section"""


def matched_blade(
    task: Task, kind: FitFamily, start: Any, like: Any, header: DesignHeader, target: MatchTarget
) -> tuple[Match, str]:
    """The match of points (n, 3) by a blade of the family, and why it ends where no target is met.

    `start` and `like` are blades of the family, or None. Raises FitError where no blade of the family has a shape near
    the points.
    """
    many, few = task.thinned(THOROUGH_POINTS), task.thinned(QUICK_POINTS)
    first, own = start, start is None and like is None
    if own and isinstance(task.free, FreeParameters):
        many, few = (replace(each, free=replace(task.free, walls=True)) for each in (many, few))
        task = many
    if start is None or like is not None:
        closed = _closed_blade(few, many.points, header, like) if start is None else start.build()
        task.progress("first design of the family")
        first = _first(closed, kind, like, header)
    first = task.free.applied(first) if isinstance(task.free, FreeParameters) else first
    check_bounds(first, task.free(first), task.bounds)
    enough = _enough(first, target)
    grown = partial(extended_blade, kind=kind, enough=enough)
    # an intermediate match need not converge
    found, reason = (
        searched(few, first, enough=enough, min_reduction=MIN_REDUCTION if target.structured else ROUGH_REDUCTION),
        "",
    )
    for some in (few, many)[: 1 + (len(few.points) < len(many.points))]:
        if some is not few:
            found = _better(some, found, searched(some, found.design, noise=found.rms, enough=enough))
        if target.structured:
            continue
        found, reason = grown_to_target(some, found, target, grown, coarse=COARSE_TOLERANCE)
    return found, "; ".join(filter(None, (reason, "" if own else WALLS_HELD_NOTE)))


def _enough(design: Any, target: MatchTarget) -> float:
    """The misfit below which nothing is sought any more, of the chord: what native sides may miss themselves."""
    return EXACT_MISFIT if target.structured else ENOUGH_MISFIT * float(design.tolerance)


def _better(task: Task, before: Match, after: Match) -> Match:
    """The one of two matches that is nearer to all points, the first measured as the second is."""
    same = evaluated(task, before.design, noise=after.rms)
    nearest = after if after.mean_distance <= same.mean_distance else same
    return replace(nearest, evaluations=before.evaluations + after.evaluations)


def _closed_blade(task: Task, points: Reals, header: DesignHeader, like: Any) -> Blade:
    """The closed blade of the unified family that points (n, 3) show, matched to those of a task."""
    row = header.row(like)
    first = first_blade(points, structure=INITIAL_BLADES[-1], name=header.name, length_unit=header.length_unit, **row)
    plain_task = Task(
        points=task.points, weights=task.weights, free=FreeParameters(), bounds={}, progress=task.progress
    )
    for design in (searched(plain_task, first, noise=3e-3, rounds=QUICK_ROUNDS).design, first):
        built = _built(design)
        if built is not None:
            return built
    raise FitError("no closed blade was found near the points: give a start design")


def _built(design: Any) -> Blade | None:
    try:
        blade: Blade = design.build()
    except DesignError:
        return None
    return blade


def _first(closed: Blade, kind: FitFamily, like: Any, header: DesignHeader) -> Design:
    """The blade of the family whose sections are those of a closed blade."""
    design = closed.design
    metre = UNITS[header.length_unit]
    sections = [_samples(closed.section(float(v))) for v in START_SPANS]
    found = ChannelCurves(
        blade=closed, backwards=_backwards(ChannelCurves(blade=closed), kind, like, sections[TRIAL_SECTION])
    )
    if found.backwards:
        sections = [reversed_flow(each) for each in sections[::-1]]
    templates = kind.templates(sections[TRIAL_SECTION], None) if like is None else [with_mean_laws(like.section)]
    middle = sections[TRIAL_SECTION]
    chosen = _matched(kind, middle, [start for each in templates for start in starts_of(kind, middle, each)])
    parts = (
        _parts_along_span(kind, sections[TRIAL_SECTION::-1], chosen)[::-1]
        + _parts_along_span(kind, sections[TRIAL_SECTION:], chosen)[1:]
    )
    counts = dict.fromkeys(counts_of(chosen), LAW_COUNT) if like is None else counts_of(like.section)
    linear = design.arrangement == "linear"
    place = [float(each.start[1]) / metre if linear else float(np.degrees(each.start[1])) for each in sections]
    fields: dict[str, Any] = {
        "name": header.name,
        "length_unit": header.length_unit,
        "arrangement": design.arrangement,
        "blade_count": design.blade_count,
        "pitch": None if design.pitch is None else design.pitch * UNITS[design.length_unit] / metre,
        "section": _laws(parts, counts),
    }
    name = "leading_edge_y" if linear else "leading_edge_theta"
    given = LAW_COUNT if like is None else _count(getattr(like, name))
    fields[name] = nearest_law(place, START_SPANS, given)
    if like is None:
        fields |= {edge: found.edge(edge, metre) for edge in EDGES}
        return kind.blade(**fields, flow_path=found.flow_path(metre))
    fields |= {edge: found.edge_like(edge, getattr(like, edge), metre) for edge in EDGES}
    changed: Design = with_stations_of(replace(like, **fields), like)
    return changed


def _backwards(found: ChannelCurves, kind: FitFamily, like: Any, section: SampledSection) -> bool:
    """Whether the flow comes from the other side than the closed blade was found for.

    Points do not show it: `like` does. Without it flow goes downstream along x; where blades stand radially it meets
    the rounder edge first, and leads outwards through the passages of a diffuser of vanes.
    """
    middle = np.array([0.5])
    first, last = (found.values(edge, middle)[0] for edge in EDGES)
    if like is not None and like.leading_edge is not None:
        metre = UNITS[like.length_unit]
        own = [np.real(getattr(like, edge).line(metre).values(middle))[0] for edge in EDGES]
        return float((last - first) @ (own[1] - own[0])) < 0.0
    if abs(last[1] - first[1]) <= abs(last[0] - first[0]):
        return False
    if kind.name == "wedge-diffuser":
        return bool(last[1] < first[1])
    return section.half_at(1.0 - ROUNDNESS_PLACE) > ROUNDER_RATIO * section.half_at(ROUNDNESS_PLACE)


def _laws(parts: list[Any], counts: Mapping[str, int]) -> Any:
    """One part of laws: constants where a law, alone or together with those before it, leaves sections no shape."""
    whole = _part_with_shape(parts, counts)
    if whole is not None:
        return whole
    taken = dict.fromkeys(counts, 1)
    found = _part_with_shape(parts, taken) or _part_with_shape([parts[TRIAL_SECTION]] * len(START_SPANS), taken)
    for path, count in counts.items():
        wider = _part_with_shape(parts, taken | {path: count})
        if wider is not None:
            taken[path], found = count, wider
    return found


def _part_with_shape(parts: list[Any], counts: Mapping[str, int]) -> Any:
    """One part of laws of so many control points each, or None where it has sections without a shape."""
    try:
        part = part_along_span(parts, START_SPANS, counts)
        part.outline(FEASIBILITY_SPANS).points(START_SPANS)
        infeasibility(part, FEASIBILITY_SPANS)
    except DesignError:
        return None
    return part


def _count(law: Any) -> int:
    return len(law_points(law))


def _samples(section: Section) -> SampledSection:
    """The samples of a section in the plane of its stream surface."""
    upper, lower = section.curves["upper"], section.curves["lower"]
    ends = np.real(section.camber.control_points[[0, -1], 0])
    scale = np.real(section.scale(ends))
    return sampled_section(upper, lower, (section.edge_radii[0] / scale[0], section.edge_radii[1] / scale[1]))


def _parts_along_span(kind: FitFamily, sections: list[SampledSection], first: Any) -> list[Any]:
    """Parts of sections in a row, the first known: each begins as the one before, or as its samples say."""
    found = [first]
    for section in sections[1:]:
        found.append(_matched(kind, section, [found[-1], *starts_of(kind, section, found[-1])[:1]]))
    return found


def _matched(kind: FitFamily, section: SampledSection, starts: list[Any]) -> Any:
    """The best part from several starts, matched to a section's samples."""
    cosine, sine = np.cos(section.stagger), np.sin(section.stagger)
    turn = np.array([[cosine, sine], [-sine, cosine]])
    points = np.concatenate([section.upper[::TRIAL_STRIDE], section.lower[TRIAL_STRIDE // 2 :: TRIAL_STRIDE]]) @ turn
    task = Task(points=points, weights=np.ones(len(points)), free=_section_parameters, bounds={})

    def made(part: Any) -> Design:
        return kind.section(name="section", length_unit="m", chord=1.0, section=part)

    found: Any = best_trial(task, task, made, starts, rounds=QUICK_ROUNDS).design
    return found.section


def _section_parameters(design: Design) -> tuple[str, ...]:
    held = gauge_parameters(design)
    return tuple(path for path in design.parameters() if path.startswith("section.") and path not in held)
