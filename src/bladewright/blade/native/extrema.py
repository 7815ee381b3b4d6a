"""Extrema of the curvature of the sides, of a section or of a blade's sections: many of them mean that sides wave."""

from collections.abc import Sequence

from bladewright.blade.native.blade import Blade
from bladewright.section.curvature_extrema import curvature_extrema
from bladewright.section.section import Section

SPANS = (0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0)
"""Span fractions of the sections of a blade on which extrema are counted."""


def extrema_of(built: Blade | Section, spans: Sequence[float] = SPANS) -> dict[str, int]:
    """The number of extrema of the curvature of each side, {"upper": n, "lower": n}.

    Of a blade it is the most that any of its sections has; `spans` are their v. What counts as an extremum follows from
    `curvature_extrema`.
    """
    sections = built.sections_at(spans)
    return {name: max(curvature_extrema(each, name) for each in sections) for name in ("upper", "lower")}
