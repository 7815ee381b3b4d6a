"""Span fractions at which a blade's sections are shown."""

from collections.abc import Sequence

from bladewright.blade.meant import Meant

MIDDLE = 0.5


def shown_spans(exact: Meant, among: Sequence[float]) -> tuple[float, ...]:
    """`among` where the blade has sections all along the span, else those at which it has any at all."""
    own = exact.section_spans
    return tuple(among) if MIDDLE in own else own
