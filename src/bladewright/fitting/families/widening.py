"""Blades from sections with a control point more in one of their laws, along the span or along the chord."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np

from bladewright.blade.meridian import ThroughPoints
from bladewright.designs import Law, Point
from bladewright.errors import DesignError, FitError
from bladewright.fitting.families.foreseen import promised
from bladewright.fitting.families.kinds import Kind
from bladewright.fitting.families.planar import ALONE
from bladewright.fitting.families.sampled import Sampled
from bladewright.fitting.families.spanwise import along_span, counts_of
from bladewright.fitting.families.standing import EDGES
from bladewright.fitting.matching.search import EXACT, ROUGH, Found, Task, searched
from bladewright.fitting.structures.aim import Aim
from bladewright.fitting.structures.growth import emphasis_of
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span, law_basis, named_laws

MOST_SPAN = 10
"""control points of a law along the span, and of an edge curve"""
SPANS: Reals = np.linspace(0.0, 1.0, 21)
"""places along the span at which laws are taken for others"""
PLACED: Reals = np.linspace(0.0, 1.0, MOST_SPAN + 1)
"""places along the span at which sections grow along the chord one by one"""
PLACES: Reals = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 201))) / 2.0
WORTH = 0.4
"""gain for each parameter, of the best, from which a law grows too"""
AT_ONCE = 4
"""laws that grow together"""
ROUNDS = 2


@dataclass(frozen=True, kw_only=True)
class Widening:
    """A law with control points more."""

    law: str
    applied: Callable[[Any], Any]
    """the blade with it; may raise DesignError"""


def widenings(design: Any, kind: Kind) -> list[Widening]:
    """What may grow in a blade."""
    names = dict.fromkeys(path.partition("[")[0] for path, _ in named_laws(design.section))
    found = [Widening(law=f"section.{name}", applied=partial(_along_span, name=name)) for name in names]
    found += [
        Widening(law=name, applied=partial(_placed, name=name))
        for name in ("leading_edge_theta", "leading_edge_y")
        if getattr(design, name) is not None
    ]
    found += [
        Widening(law=name, applied=partial(_edged, name=name))
        for name in EDGES
        if isinstance(getattr(design, name), ThroughPoints)
    ]
    middle = _section_at(design.section, 0.5)
    count = len(kind.grown(middle, _samples(middle)))
    return found + [
        Widening(law=f"section along the chord ({i})", applied=partial(_along_chord, kind=kind, which=i))
        for i in range(count)
    ]


def wider_blade(task: Task, found: Found, aim: Aim, back: int, *, kind: Kind, enough: float = EXACT) -> Iterator[Found]:
    """The match with the laws widened that promise most, several at once; where that was taken back, one after another.

    Taken back `back` times, it is the one that comes after so many better ones, alone.
    """
    room = None if aim.parameters is None else aim.parameters - len(found.problem.paths)
    named: dict[str, tuple[Widening, Any]] = {}
    for widening in widenings(found.design, kind):
        try:
            named[widening.law] = widening, widening.applied(found.design)
        except DesignError:
            continue
    ranked = promised(task, found, [design for _, design in named.values()], emphasis_of(found, aim))
    of = {id(design): widening for widening, design in named.values()}
    design: Any = found.design
    taken = 0
    for gain, more, each in ranked[back:]:
        if taken and (back or gain < WORTH * ranked[0][0] or taken >= AT_ONCE):
            break
        if room is not None and more > room:
            continue
        try:
            design = of[id(each)].applied(design)
        except DesignError:
            continue
        taken += 1
        room = None if room is None else room - more
    if not taken:
        return
    try:
        fresh = searched(task, design, rounds=ROUNDS, noise=found.rms, slight=ROUGH, enough=enough)
    except FitError:
        return
    yield replace(fresh, evaluations=fresh.evaluations + found.evaluations)


def _along_span(design: Any, name: str) -> Any:
    laws = {path: law for path, law in named_laws(design.section) if path.partition("[")[0] == name}
    wider = {path: _wider(law) for path, law in laws.items()}
    return replace(design, section=design.section.changed(wider))


def _placed(design: Any, name: str) -> Any:
    return replace(design, **{name: _wider(getattr(design, name))})


def _edged(design: Any, name: str) -> Any:
    """The blade with one point more on an edge curve, in equal steps of its parameter."""
    curve = getattr(design, name)
    count = len(curve.points) + 1
    if count > MOST_SPAN:
        raise DesignError(f"{name} has {count - 1} points, and no more are added")
    rows = np.real(curve.line(1.0).values(np.linspace(0.0, 1.0, count)))
    return replace(design, **{name: replace(curve, points=tuple(Point(float(x), float(r)) for x, r in rows))})


def _wider(law: Law) -> Law:
    """The law with one control point more, nearest to what it is."""
    old = np.atleast_1d(np.asarray(law, dtype=np.float64))
    if len(old) >= MOST_SPAN:
        raise DesignError(f"a law has {len(old)} control points along the span, and no more are added")
    rows = law_basis(len(old) + 1, SPANS)
    return tuple(np.linalg.lstsq(rows, law_basis(len(old), SPANS) @ old, rcond=None)[0].tolist())


def _along_chord(design: Any, kind: Kind, which: int) -> Any:
    """The blade with a control point more along the chord, as its sections have it one by one.

    Raises DesignError where some of its sections cannot grow so.
    """
    ways = _ways(kind, design.section)
    parts = [each[which] for each in ways if which < len(each)]
    if len(parts) < len(ways) or len({tuple(part.parameters()) for part in parts}) > 1:
        raise DesignError("sections along the span do not grow alike: the section stays as it is")
    known = counts_of(design.section)
    most: dict[str, int] = {}
    for path, count in known.items():
        most[path.partition("[")[0]] = max(count, most.get(path.partition("[")[0], 1))
    # what is new has as many control points along the span as the law that it stands in
    counts = {path: known.get(path, most.get(path.partition("[")[0], 1)) for path in parts[0].parameters()}
    changed = along_span(parts, PLACED, counts)
    laws = [(path, law) for path, law in named_laws(design.section) if path in counts]
    kept = {path: law for path, law in laws if _same(parts, path, design.section)}
    return replace(design, section=changed.changed(kept))


@lru_cache(maxsize=4)
def _ways(kind: Kind, part: Any) -> list[Sequence[Any]]:
    """The ways in which the sections of a part at PLACED may grow along the chord."""
    sections = [_section_at(part, float(v)) for v in PLACED]
    return [kind.grown(section, _samples(section)) for section in sections]


def _same(parts: list[Any], path: str, section: Any) -> bool:
    """Whether growth has left a law as it was."""
    now = [part.parameters()[path] for part in parts]
    was = [_section_at(section, float(v)).parameters()[path] for v in PLACED[[0, -1]]]
    return now[0] == was[0] and now[-1] == was[-1]


def _section_at(part: Any, v: float) -> Any:
    """The part of numbers at a place along the span."""
    span = Span(np.array([v]))
    return part.changed({path: float(np.real(span.values(law))[..., 0]) for path, law in named_laws(part)})


def _samples(part: Any) -> Sampled:
    """The samples of a part of numbers."""
    upper, lower = (np.real(side[0]) for side in part.outline(ALONE).points(PLACES))
    turn = float(np.real(part.stagger(ALONE))[0])
    return Sampled(chord=1.0, stagger=turn, start=np.zeros(2), upper=upper, lower=lower, radii=(0.0, 0.0))
