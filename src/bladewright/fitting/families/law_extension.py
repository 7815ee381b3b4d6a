"""Blades from sections with a control point more in one of their laws, along the span or along the chord."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np

from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.designs import Law, Point
from bladewright.errors import DesignError, FitError
from bladewright.fitting.families.growth import predicted_gains, tolerance_weights
from bladewright.fitting.families.kinds import FitFamily
from bladewright.fitting.families.laws import counts_of, part_along_span, with_stations_of
from bladewright.fitting.families.section_samples import SampledSection
from bladewright.fitting.free_parameters import EDGES
from bladewright.fitting.matching.search import EXACT_MISFIT, ROUGH_REDUCTION, Match, Task, searched
from bladewright.fitting.model_selection.match_target import MatchTarget
from bladewright.fitting.models.planar import SINGLE_SECTION
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span, law_basis, law_points, named_laws, stations_of

MOST_SPAN = 10
"""control points of a law along the span, and of an edge curve, at most; it bounds the time of growth."""
SPANS: Reals = np.linspace(0.0, 1.0, 21)
"""places along the span at which laws are compared"""
GROWN_SPANS: Reals = np.linspace(0.0, 1.0, MOST_SPAN + 1)
"""places along the span at which sections are extended along the chord one by one"""
PLACES: Reals = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 201))) / 2.0
"""chord fractions of the samples of a section"""
MIN_GAIN_OF_BEST = 0.4
"""gain for each parameter, of the best, from which a law is extended together with it."""
MOST_TOGETHER = 4
"""laws that are extended together at most"""
EXTENSION_ROUNDS = 2
"""rounds of the search after an extension"""


@dataclass(frozen=True, kw_only=True)
class LawExtension:
    """A law with more control points."""

    law: str
    applied: Callable[[Any], Any]
    """the blade with the extension; may raise DesignError"""


def law_extensions(design: Any, kind: FitFamily) -> list[LawExtension]:
    """The laws of a blade that may be extended."""
    names = dict.fromkeys(path.partition("[")[0] for path, _ in named_laws(design.section))
    found = [LawExtension(law=f"section.{name}", applied=partial(_along_span, name=name)) for name in names]
    found += [
        LawExtension(law=name, applied=partial(_position_extended, name=name))
        for name in ("leading_edge_theta", "leading_edge_y")
        if getattr(design, name) is not None
    ]
    found += [
        LawExtension(law=name, applied=partial(_edge_extended, name=name))
        for name in EDGES
        if isinstance(getattr(design, name), ThroughPoints)
    ]
    middle = _section_at(design.section, 0.5)
    count = len(kind.extensions(middle, _samples(middle)))
    return found + [
        LawExtension(law=f"section along the chord ({i})", applied=partial(_along_chord, kind=kind, which=i))
        for i in range(count)
    ]


def extended_blade(
    task: Task, match: Match, target: MatchTarget, back: int, *, kind: FitFamily, enough: float = EXACT_MISFIT
) -> Iterator[Match]:
    """The match with those laws extended that are predicted to gain most, several at once.

    Where that was taken back `back` times, the law that comes after so many better ones is extended, alone.
    """
    available = None if target.parameters is None else target.parameters - len(match.problem.paths)
    named: dict[str, tuple[LawExtension, Any]] = {}
    for widening in law_extensions(match.design, kind):
        try:
            named[widening.law] = widening, widening.applied(match.design)
        except DesignError:
            continue
    ranked = predicted_gains(task, match, [design for _, design in named.values()], tolerance_weights(match, target))
    of = {id(design): widening for widening, design in named.values()}
    design: Any = match.design
    taken = 0
    for gain, more, each in ranked[back:]:
        if taken and (back or gain < MIN_GAIN_OF_BEST * ranked[0][0] or taken >= MOST_TOGETHER):
            break
        if available is not None and more > available:
            continue
        try:
            design = of[id(each)].applied(design)
        except DesignError:
            continue
        taken += 1
        available = None if available is None else available - more
    if not taken:
        return
    try:
        fresh = searched(
            task, design, rounds=EXTENSION_ROUNDS, noise=match.rms, min_reduction=ROUGH_REDUCTION, enough=enough
        )
    except FitError:
        return
    yield replace(fresh, evaluations=fresh.evaluations + match.evaluations)


def _along_span(design: Any, name: str) -> Any:
    laws = {path: law for path, law in named_laws(design.section) if path.partition("[")[0] == name}
    wider = {path: _extended_law(law) for path, law in laws.items()}
    return replace(design, section=design.section.changed(wider))


def _position_extended(design: Any, name: str) -> Any:
    return replace(design, **{name: _extended_law(getattr(design, name))})


def _edge_extended(design: Any, name: str) -> Any:
    """The blade with one point more on an edge curve, in equal steps of its parameter."""
    curve = getattr(design, name)
    count = len(curve.points) + 1
    if count > MOST_SPAN:
        raise DesignError(f"{name} has {count - 1} points, and no more are added")
    rows = np.real(curve.line(1.0).values(np.linspace(0.0, 1.0, count)))
    return replace(design, **{name: replace(curve, points=tuple(Point(float(x), float(r)) for x, r in rows))})


def _extended_law(law: Law) -> Law:
    """The law with one control point more, nearest to what it is."""
    if stations_of(law) is not None:
        raise DesignError("a law is given at stations, and none is added")
    old = np.array(law_points(law), dtype=np.float64)
    if len(old) >= MOST_SPAN:
        raise DesignError(f"a law has {len(old)} control points along the span, and no more are added")
    rows = law_basis(len(old) + 1, SPANS)
    return tuple(np.linalg.lstsq(rows, law_basis(len(old), SPANS) @ old, rcond=None)[0].tolist())


def _along_chord(design: Any, kind: FitFamily, which: int) -> Any:
    """The blade with a control point more along the chord, as its sections have it one by one.

    Raises DesignError where some of its sections cannot be extended in this way.
    """
    ways = _extensions_along_chord(kind, design.section)
    parts = [each[which] for each in ways if which < len(each)]
    if len(parts) < len(ways) or len({tuple(part.parameters()) for part in parts}) > 1:
        raise DesignError("sections along the span do not grow alike: the section stays as it is")
    known = counts_of(design.section)
    most: dict[str, int] = {}
    for path, count in known.items():
        most[path.partition("[")[0]] = max(count, most.get(path.partition("[")[0], 1))
    # a new control point has as many values along the span as the law that it belongs to
    counts = {path: known.get(path, most.get(path.partition("[")[0], 1)) for path in parts[0].parameters()}
    changed = part_along_span(parts, GROWN_SPANS, counts)
    laws = [(path, law) for path, law in named_laws(design.section) if path in counts]
    kept = {path: law for path, law in laws if _is_unchanged(parts, path, design.section)}
    return replace(design, section=with_stations_of(changed.changed(kept), design.section))


@lru_cache(maxsize=4)
def _extensions_along_chord(kind: FitFamily, part: Any) -> list[Sequence[Any]]:
    """The ways in which the sections of a part at `GROWN_SPANS` may be extended along the chord."""
    sections = [_section_at(part, float(v)) for v in GROWN_SPANS]
    return [kind.extensions(section, _samples(section)) for section in sections]


def _is_unchanged(parts: list[Any], path: str, section: Any) -> bool:
    """Whether an extension has left a law as it was."""
    now = [part.parameters()[path] for part in parts]
    was = [_section_at(section, float(v)).parameters()[path] for v in GROWN_SPANS[[0, -1]]]
    return now[0] == was[0] and now[-1] == was[-1]


def _section_at(part: Any, v: float) -> Any:
    """The part of numbers at a place along the span."""
    span = Span(np.array([v]))
    return part.changed({path: float(np.real(span.values(law))[..., 0]) for path, law in named_laws(part)})


def _samples(part: Any) -> SampledSection:
    """The samples of a part of numbers."""
    upper, lower = (np.real(side[0]) for side in part.outline(SINGLE_SECTION).points(PLACES))
    turn = float(np.real(part.stagger(SINGLE_SECTION))[0])
    return SampledSection(chord=1.0, stagger=turn, start=np.zeros(2), upper=upper, lower=lower, radii=(0.0, 0.0))
