"""Designs with other numbers of control points that have a shape, and structures with more of them."""

from collections.abc import Collection

import numpy as np

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Design
from bladewright.errors import DesignError
from bladewright.fitting.matching.noise import EXACT
from bladewright.fitting.model_selection.laws import MOST_SPAN
from bladewright.fitting.model_selection.structure import (
    SPARE_SAMPLES,
    Structure,
    reshaped,
    resizable_laws,
    richest,
    structure_of,
    within_rows,
)
from bladewright.fitting.models.model import model_of
from bladewright.section.unified import UnifiedSection
from bladewright.section.unified_limits import THICKNESSES

THINNER_EDGES, MOST_THINNINGS = 0.7, 12
"""ratio by which the thickness beside the edges is reduced at a time, `MOST_THINNINGS` times at most."""


def with_feasible_edges(design: Design) -> Design:
    """The design, or one with thinner edges where given values leave it no shape; the last where none has.

    A camber that is turned away from the points may leave the third control points of the sides outside the edges.
    """
    if not isinstance(design, UnifiedSection | UnifiedBlade):
        return design
    for _ in range(MOST_THINNINGS):
        if _has_shape(design):
            break
        values = design.parameters()
        ends = tuple(f"{name}[{place}]" for name in THICKNESSES for place in (0, len(getattr(design, name)) - 1))
        design = design.changed(
            {path: THINNER_EDGES * value for path, value in values.items() if path.startswith(ends)}
        )
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
"""shares of the further control points of a rich structure that are tried where points are few
(design/matching_constants.md)."""
POINTS_PER_PARAMETER = 2
"""points for each parameter of a rich structure at least: published profiles have few points. Half and twice change
nothing measured (design/matching_constants.md)."""


def rich_structure(
    design: Design, free: Collection[str], points: int, rows: int = MOST_SPAN, *, sampled: bool = False
) -> Structure:
    """A structure with more control points in every law than a match of so many points is likely to need.

    Along the span it has no more of them than `rows` of points, and where it is to be `sampled`, along the chord no
    more than a design's own samples determine: further ones lie closer to the edges, where the thickness then has to
    bend like a nose (design/matching.md). Laws of which nothing is `free` keep theirs.
    """
    whole = richest(design)
    if sampled and whole.samples:
        own, determined = structure_of(design), whole.samples - SPARE_SAMPLES
        for name in THICKNESSES:
            along, across = whole.counts[name]
            whole = whole.resized(name, (max(own.counts[name][0], min(along, determined)), across))
    return _towards(whole, design, free, points, rows)


def wider_structure(
    design: Design, free: Collection[str], points: int, rows: int = MOST_SPAN, *, slim: bool = False
) -> Structure:
    """A structure with a third as many control points again in every law of a design, and a rich one at least.

    Along the span it has no more of them than `rows` of points, and along the chord no more than the design's samples
    determine, unless it has as many: with four samples more the same laws are another shape, 1e-3 to 3e-3 of the chord
    off (design/matching.md). Of a structure that is `slim`, which has lost what it does not need, half as many again
    and no more.
    """
    own = structure_of(design)
    wide, share = (own, 2) if slim else (richest(design), 3)
    for law in resizable_laws(design):
        counts = zip(own.counts[law.name], wide.counts[law.name], law.limits()[1], strict=True)
        more = [max(few, min(count + max(1, count // share), most)) for count, few, most in counts]
        if own.samples and law.name in THICKNESSES and own.counts[law.name][0] < own.samples - SPARE_SAMPLES:
            more[0] = min(more[0], own.samples - SPARE_SAMPLES)
        wide = wide.resized(law.name, tuple(more))
    return _towards(wide, design, free, points, rows)


def _towards(whole: Structure, design: Design, free: Collection[str], points: int, rows: int) -> Structure:
    """A structure with more control points than a design's own, or as large a share of them as the points allow."""
    whole, own = (within_rows(each, design, rows) for each in (whole, structure_of(design)))
    laws = [law for law in resizable_laws(design) if not set(free).isdisjoint(law.paths(design) or free)]
    for share in SHARES:
        rich = own
        for law in laws:
            counts = zip(own.counts[law.name], whole.counts[law.name], strict=True)
            rich = rich.resized(law.name, tuple(count + round(share * (most - count)) for count, most in counts))
        rich = rich.with_samples(own.samples)
        if len(reshaped(design, rich).parameters()) * POINTS_PER_PARAMETER <= points:
            break
    return rich
