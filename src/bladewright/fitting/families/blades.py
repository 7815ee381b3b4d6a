"""From points in space to a blade from sections of a family."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from bladewright.blade.blade import Blade
from bladewright.designs import Design
from bladewright.errors import DesignError, FitError
from bladewright.fitting.families.flow import Channelled
from bladewright.fitting.families.growing import sufficient
from bladewright.fitting.families.kinds import Kind
from bladewright.fitting.families.room import crowding
from bladewright.fitting.families.sampled import Sampled, reversed_flow, sampled
from bladewright.fitting.families.sections import best_of, started_of, thinned
from bladewright.fitting.families.spanwise import along_span, counts_of, nearest_law, plain
from bladewright.fitting.families.standing import EDGES, standing
from bladewright.fitting.families.widening import wider_blade
from bladewright.fitting.first.blade import first_blade
from bladewright.fitting.frame import Frame
from bladewright.fitting.freedom import Freedom
from bladewright.fitting.matching.descent import SLIGHT
from bladewright.fitting.matching.scales import check_bounds
from bladewright.fitting.matching.search import EXACT, ROUGH, Found, Task, searched, stood
from bladewright.fitting.structures.aim import Aim
from bladewright.fitting.structures.lean import rich
from bladewright.nurbs.basis import Reals
from bladewright.section.checks import UNITS
from bladewright.section.laws import Span
from bladewright.section.section import Section

FEW, MANY = 1000, 12_000
"""points of a quick and of a thorough search"""
ENOUGH = 2.0
"""misfit below which a blade of a structure that is not given is found, of the tolerance of its native sides"""
COARSE = 1e-3
"""tolerance of the native sides of blades that are on the way, of the chord"""
HELD = "hub and shroud are held as they are given"
NOSE, ROUNDER = 0.04, 1.3
"""chord fraction from an edge at which it is seen how round it is, and ratio from which one is rounder"""
QUICK = 4
"""rounds of the search for the closed blade that says where to begin"""
SPANS: Reals = np.linspace(0.0, 1.0, 7)
"""places of the sections that a start is taken from"""
ALONG = Span(np.linspace(0.0, 1.0, 13))
"""places along the span at which laws must leave sections a shape"""
LAW = 3
"""control points of each law along the span, where none is given"""
CHOSEN = 3
"""number of the section by which structures are told apart"""
EVERY = 4
"""part, one in so many, of a section's samples that structures are told apart by"""


def matched_blade(task: Task, kind: Kind, start: Any, like: Any, frame: Frame, aim: Aim) -> tuple[Found, str]:
    """The match of points (n, 3) by a blade of the family, and why it ends where no aim is met.

    `start` and `like` are blades of the family, or None. Raises FitError where no blade of the family has a shape near
    the points.
    """
    many, few = thinned(task, MANY), thinned(task, FEW)
    first, own = start, start is None and like is None
    if own and isinstance(task.free, Freedom):
        many, few = (replace(each, free=replace(task.free, walls=True)) for each in (many, few))
        task = many
    if start is None or like is not None:
        closed = _closed(few, many.points, frame, like) if start is None else start.build()
        task.told("first design of the family")
        first = _first(closed, kind, like, frame)
    first = task.free.applied(first) if isinstance(task.free, Freedom) else first
    check_bounds(first, task.free(first), task.bounds)
    enough = _enough(first, aim)
    grown = partial(wider_blade, kind=kind, enough=enough)
    # what is only on the way need not come to its end
    found, reason = searched(few, first, enough=enough, slight=SLIGHT if aim.structured else ROUGH), ""
    for some in (few, many)[: 1 + (len(few.points) < len(many.points))]:
        if some is not few:
            found = _better(some, found, searched(some, found.design, noise=found.rms, enough=enough))
        if aim.structured or found.interrupted:
            continue
        found, reason = sufficient(some, found, aim, grown, coarse=COARSE)
    return found, "; ".join(filter(None, (reason, "" if own else HELD)))


def _enough(design: Any, aim: Aim) -> float:
    """The misfit below which nothing is sought any more, of the chord: what native sides may miss themselves."""
    return EXACT if aim.structured else ENOUGH * float(design.tolerance)


def _better(task: Task, before: Found, after: Found) -> Found:
    """The one of two matches that is nearer to all points, the first measured as the second is."""
    same = stood(task, before.design, noise=after.rms)
    nearest = after if after.off <= same.off else same
    return replace(nearest, evaluations=before.evaluations + after.evaluations)


def _closed(task: Task, points: Reals, frame: Frame, like: Any) -> Blade:
    """The closed blade in a channel that points (n, 3) alone show, matched to those of a task."""
    row = frame.row(like)
    first = first_blade(points, structure=rich(None), name=frame.name, length_unit=frame.length_unit, **row)
    plain_task = Task(points=task.points, weights=task.weights, free=Freedom(), bounds={}, told=task.told)
    for design in (searched(plain_task, first, noise=3e-3, rounds=QUICK).design, first):
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


def _first(closed: Blade, kind: Kind, like: Any, frame: Frame) -> Design:
    """The blade of the family whose sections are those of a closed blade."""
    design = closed.design
    metre = UNITS[frame.length_unit]
    sections = [_samples(closed.section(float(v))) for v in SPANS]
    found = Channelled(blade=closed, backwards=_backwards(Channelled(blade=closed), kind, like, sections[CHOSEN]))
    if found.backwards:
        sections = [reversed_flow(each) for each in sections[::-1]]
    templates = kind.templates(sections[CHOSEN], None) if like is None else [plain(like.section)]
    middle = sections[CHOSEN]
    chosen = _matched(kind, middle, [start for each in templates for start in started_of(kind, middle, each)])
    parts = _beside(kind, sections[CHOSEN::-1], chosen)[::-1] + _beside(kind, sections[CHOSEN:], chosen)[1:]
    counts = dict.fromkeys(counts_of(chosen), LAW) if like is None else counts_of(like.section)
    linear = design.arrangement == "linear"
    place = [float(each.start[1]) / metre if linear else float(np.degrees(each.start[1])) for each in sections]
    fields: dict[str, Any] = {
        "name": frame.name,
        "length_unit": frame.length_unit,
        "arrangement": design.arrangement,
        "blade_count": design.blade_count,
        "pitch": None if design.pitch is None else design.pitch * UNITS[design.length_unit] / metre,
        "section": _laws(parts, counts),
    }
    name = "leading_edge_y" if linear else "leading_edge_theta"
    given = LAW if like is None else _count(getattr(like, name))
    fields[name] = nearest_law(place, SPANS, given)
    if like is None:
        fields |= {edge: found.edge(edge, metre) for edge in EDGES}
        return kind.blade(**fields, flow_path=found.flow_path(metre))
    fields |= {edge: found.edge_like(edge, getattr(like, edge), metre) for edge in EDGES}
    changed: Design = replace(like, **fields)
    return changed


def _backwards(found: Channelled, kind: Kind, like: Any, section: Sampled) -> bool:
    """Whether the flow comes from the other side than the one that the closed blade was found with.

    Points do not tell it: `like` does. Without it flow goes downstream along x; where blades stand radially it meets
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
    return section.half_at(1.0 - NOSE) > ROUNDER * section.half_at(NOSE)


def _laws(parts: list[Any], counts: Mapping[str, int]) -> Any:
    """One part of laws: constants where a law, or that together with those before it, leaves sections no shape."""
    whole = _shaped(parts, counts)
    if whole is not None:
        return whole
    taken = dict.fromkeys(counts, 1)
    found = _shaped(parts, taken) or _shaped([parts[CHOSEN]] * len(SPANS), taken)
    for path, count in counts.items():
        wider = _shaped(parts, taken | {path: count})
        if wider is not None:
            taken[path], found = count, wider
    return found


def _shaped(parts: list[Any], counts: Mapping[str, int]) -> Any:
    """One part of laws of so many control points each, or None where it has sections without a shape."""
    try:
        part = along_span(parts, SPANS, counts)
        part.outline(ALONG).points(SPANS)
        crowding(part, ALONG)
    except DesignError:
        return None
    return part


def _count(law: Any) -> int:
    return len(law) if isinstance(law, tuple) else 1


def _samples(section: Section) -> Sampled:
    """The samples of a section in the plane of its stream surface."""
    upper, lower = section.curves["upper"], section.curves["lower"]
    ends = np.real(section.camber.control_points[[0, -1], 0])
    scale = np.real(section.scale(ends))
    return sampled(upper, lower, (section.edge_radii[0] / scale[0], section.edge_radii[1] / scale[1]))


def _beside(kind: Kind, sections: list[Sampled], first: Any) -> list[Any]:
    """Parts of sections in a row, of which the first is known: each begins as the one before, or as its samples say."""
    found = [first]
    for section in sections[1:]:
        found.append(_matched(kind, section, [found[-1], *started_of(kind, section, found[-1])[:1]]))
    return found


def _matched(kind: Kind, section: Sampled, starts: list[Any]) -> Any:
    """The best part that is found from several, matched to a section's samples."""
    cosine, sine = np.cos(section.stagger), np.sin(section.stagger)
    turn = np.array([[cosine, sine], [-sine, cosine]])
    points = np.concatenate([section.upper[::EVERY], section.lower[EVERY // 2 :: EVERY]]) @ turn
    task = Task(points=points, weights=np.ones(len(points)), free=_of_section, bounds={})

    def made(part: Any) -> Design:
        return kind.section(name="section", length_unit="m", chord=1.0, section=part)

    found: Any = best_of(task, task, made, starts, rounds=QUICK).design
    return found.section


def _of_section(design: Design) -> tuple[str, ...]:
    held = standing(design)
    return tuple(path for path in design.parameters() if path.startswith("section.") and path not in held)
