"""One part of laws along the span from parts of numbers, those of sections at several places."""

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any

import numpy as np

from bladewright.designs import Law
from bladewright.errors import DesignError, FitError
from bladewright.fitting.models.sectioned import infeasibility
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span, law_basis, law_points, named_laws

SECTION_SPANS: Reals = np.linspace(0.0, 1.0, 7)
"""places along the span of the sections that laws are taken from"""
MIDDLE = len(SECTION_SPANS) // 2
"""number of the section in the middle, by which structures are compared"""
FEASIBILITY_SPANS = Span(np.linspace(0.0, 1.0, 13))
"""places along the span at which laws must leave sections a shape"""
LAW_COUNT = 3
"""control points of each law along the span of a first blade (design/matching_constants.md)"""


def with_mean_laws(part: Any) -> Any:
    """The part with each law replaced by its mean, a number."""
    return part.changed({path: float(np.mean(law_points(law))) for path, law in named_laws(part)})


def part_of_laws(parts: Sequence[Any], count: int = LAW_COUNT) -> Any:
    """One part of laws of so many control points from those of sections.

    Laws are constants where one, alone or together with those before it, leaves sections no shape. Raises FitError
    where even constants do.
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
