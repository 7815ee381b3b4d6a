"""Structures that a match begins with, and ones with more control points; designs of them that have a shape."""

from collections.abc import Callable, Collection, Iterable
from dataclasses import replace

import numpy as np

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Design
from bladewright.errors import DesignError
from bladewright.fitting.matching.footpoints import Footpoints, part_of
from bladewright.fitting.matching.noise import EXACT
from bladewright.fitting.model_selection.laws import MOST_SPAN, ResizableLaw
from bladewright.fitting.model_selection.structure import (
    POSITIONS,
    SPARE_SAMPLES,
    Structure,
    reshaped,
    resizable_laws,
    structure_of,
)
from bladewright.fitting.models.model import model_of
from bladewright.nurbs.basis import Reals
from bladewright.section.unified import UnifiedSection
from bladewright.section.unified_limits import ANGLES, RADII, TANGENTS, THICKNESSES

FIRST_ANGLES, FIRST_TANGENTS, FIRST_RADII = 4, 3, 2
"""control points along the span of a first blade's angles and position, tangents and radii: free enough to find its
edges (design/matching_constants.md)"""
FIRST_SECTION = Structure(counts=dict.fromkeys(THICKNESSES, (6, 1)), samples=16)
"""of a section with which a match begins"""
FIRST_BLADE = Structure(
    counts={
        **dict.fromkeys((*ANGLES, *POSITIONS), (1, FIRST_ANGLES)),
        **dict.fromkeys(TANGENTS, (1, FIRST_TANGENTS)),
        **dict.fromkeys(RADII, (1, FIRST_RADII)),
        **dict.fromkeys(THICKNESSES, (6, 3)),
        "channel": (4, 5, 4, 4),
    },
    samples=16,
)
"""of a twisted and swept blade, with which a match begins (design/matching_constants.md)"""


def _with_each(structure: Structure, laws: Iterable[ResizableLaw], count: Callable[..., int]) -> Structure:
    """The structure with `count` control points of laws, by the law, which of its numbers it is, and that number."""
    counts = {law.name: tuple(count(law, i, n) for i, n in enumerate(structure.counts[law.name])) for law in laws}
    return replace(structure, counts={**structure.counts, **counts})


def richest(design: Design, *, sampled: bool = False) -> Structure:
    """The structure with all the control points that a match may begin with.

    Where it is to be `sampled`, it adds none along the chord that the design's samples do not determine
    (design/matching.md).
    """
    own = structure_of(design)

    def rich(law: ResizableLaw, place: int, count: int) -> int:
        most = _determined(own, law, place) if sampled else law.most[place]
        return max(count, min(law.rich[place], most))

    return _with_each(own, resizable_laws(design), rich)


def _determined(own: Structure, law: ResizableLaw, place: int) -> int:
    """The most control points of a law that a structure's samples determine, where it is sampled."""
    sampled = own.samples and law.name in THICKNESSES and place == 0
    return own.samples - SPARE_SAMPLES if sampled else law.most[place]


ROWS_PER_KNOT = 3
"""rows of points for each inner knot of a law along the span, where Ruppert 2002 has four (design/matching.md)"""
CHORD_PARTS = 10
"""parts of each side, along the chord, in each of which rows are counted (design/matching_constants.md)"""


def rows_shown(feet: Footpoints) -> int:
    """How many control points along the span points show, by their footpoints (n,).

    A spline's control points are determined where each basis function has a place of its own (Schoenberg and Whitney
    1953), but between so few it swings: a cubic one has an inner knot for every few rows, and fewer control points than
    rows, by the median of parts of the chord. Rows that lead across the design's lines show more of the span: knots go
    by the most equal parts of it that all have points.
    """
    order = 4
    most = ROWS_PER_KNOT * (MOST_SPAN - order)
    part = feet.side * CHORD_PARTS + part_of(feet.u, CHORD_PARTS)
    rows = int(np.median([_apart(feet.v[part == number], 1.0 / most) for number in np.unique(part)]))
    filled = next((n for n in range(most, 1, -1) if len(np.unique(part_of(feet.v, n))) == n), 1)
    return min(rows - (rows > order), order + filled // ROWS_PER_KNOT)


def _apart(places: Reals, distance: float) -> int:
    """How many of some places (n,) are at least a distance apart, taken from the lowest on."""
    ordered, count, row = np.sort(places), 0, 0
    while row < len(ordered):
        count, row = count + 1, int(np.searchsorted(ordered, ordered[row] + distance))
    return count


THINNER_EDGES, MOST_THINNINGS = 0.7, 12
"""ratio by which the thickness beside the edges is reduced, and how often at most (design/matching_constants.md)"""


def with_feasible_edges(design: Design) -> Design:
    """The design, or one with thinner edges where given values leave it no shape; the last where none has.

    A camber that is turned away from the points may leave the third control points of the sides outside the edges.
    """
    if not isinstance(design, UnifiedSection | UnifiedBlade):
        return design
    for _ in range(MOST_THINNINGS):
        if _has_shape(design):
            break
        ends = tuple(f"{name}[{place}]" for name in THICKNESSES for place in (0, len(getattr(design, name)) - 1))
        values = design.parameters().items()
        design = design.changed({path: THINNER_EDGES * value for path, value in values if path.startswith(ends)})
    return design


def widened_where_feasible(design: Design, structure: Structure) -> Design:
    """The design of a wider structure, or where that has no shape, with those laws wider that leave it one.

    The nearest laws of other control points may fold stream surfaces, or part an edge from a wall; each is tried alone.
    """
    whole = with_feasible_edges(reshaped(design, structure))
    if _has_shape(whole):
        return whole
    own = structure_of(design)
    for law in resizable_laws(design):
        wider = own.resized(law.name, structure.counts[law.name]).with_samples(structure.samples)
        own = wider if _has_shape(reshaped(design, wider)) else own
    return reshaped(design, own)


def _has_shape(design: Design) -> bool:
    try:
        with np.errstate(all="ignore"):
            return model_of(design, EXACT).shape(design).finite
    except DesignError:
        return False


SHARES = (1.0, 0.8, 0.6, 0.4, 0.2, 0.0)
"""shares of a rich structure's further control points tried where points are few (design/matching_constants.md)"""
POINTS_PER_PARAMETER = 2
"""points for each parameter of a rich structure at least, also of published profiles (design/matching_constants.md)"""


def rich_structure(
    design: Design, free: Collection[str], points: int, rows: int = MOST_SPAN, *, sampled: bool = False
) -> Structure:
    """A structure with more control points in every law than a match of so many points is likely to need.

    Along the span it has no more of them than `rows` of points. Laws of which nothing is `free` keep theirs.
    """
    return _towards(richest(design, sampled=sampled), design, free, points, rows)


def wider_structure(
    design: Design, free: Collection[str], points: int, rows: int = MOST_SPAN, *, slim: bool = False
) -> Structure:
    """A structure with a third as many control points again in every law of a design, and a rich one at least.

    Along the span it has no more of them than `rows` of points, and along the chord no more than the design's samples
    determine, unless it has as many (design/matching.md). Of a structure that is `slim`, which has lost what it does
    not need, half as many again and no more.
    """
    own = structure_of(design)
    least, share = (own, 2) if slim else (richest(design), 3)

    def wider(law: ResizableLaw, place: int, count: int) -> int:
        determined = _determined(own, law, place)
        most = determined if count < determined else law.most[place]
        return max(least.counts[law.name][place], min(count + max(1, count // share), most))

    return _towards(_with_each(own, resizable_laws(design), wider), design, free, points, rows)


def _towards(whole: Structure, design: Design, free: Collection[str], points: int, rows: int) -> Structure:
    """A whole structure, or as large a share of what it has more than a design as points, and rows, allow."""

    def within_rows(law: ResizableLaw, place: int, count: int) -> int:
        return max(min(count, rows), law.fewest[place]) if place in law.along_span else count

    laws = resizable_laws(design)
    whole, own = (_with_each(each, laws, within_rows) for each in (whole, structure_of(design)))
    freed = [law for law in laws if not set(free).isdisjoint(law.paths(design) or free)]
    for share in SHARES:

        def towards(law: ResizableLaw, place: int, count: int, share: float = share) -> int:
            return count + round(share * (whole.counts[law.name][place] - count))

        rich = _with_each(own, freed, towards).with_samples(own.samples)
        if len(reshaped(design, rich).parameters()) * POINTS_PER_PARAMETER <= points:
            break
    return rich
