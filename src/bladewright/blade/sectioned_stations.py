"""Sections of a family laid where a design puts them: between edge curves or by their reference points, and shifted."""

from collections.abc import Callable
from typing import Any

import numpy as np

from bladewright.blade.bladed_lines import Bladed, BladedLines
from bladewright.blade.mapping import Mapping
from bladewright.blade.outline_stations import OutlineStations, StaggeredSections
from bladewright.blade.sectioned import SectionedBlade
from bladewright.blade.stacking_chord import chord_ruler
from bladewright.blade.stacking_place import StackingPlace
from bladewright.blade.stacking_reference import reference_points
from bladewright.blade.stacking_shift import shift_of, shifted_lines
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, radians
from bladewright.nurbs.basis import Reals
from bladewright.section.camber_angle import CamberAngle
from bladewright.section.checks import UNITS
from bladewright.section.laws import Span
from bladewright.section.outline import Outline

STEEP = np.radians(89.0)
"""largest angle of a chord line: beyond it its extent along the flow says nothing of the chord"""
ROUNDS = 60
"""tries in which a chord line's angle and its place, where each depends on the other, settle; mostly five do"""

Place = Bladed | StackingPlace
"""what puts sections on their stream lines: edge curves, or reference points"""
Found = tuple[BladedLines, Outline, Array, Array]
"""stream lines between the sections' edges, sections, their stagger and reference points"""


def placed_sections(design: SectionedBlade, place: Place, mapping: Mapping, v: Reals) -> OutlineStations:
    """Sections at v (m,); raises DesignError where there are none, or they do not fit in the flow path."""
    span = Span(v)
    if isinstance(place, Bladed):
        lines = place.lines(v, mapping)
        outline, stagger = family_sections(design, span, lines)
        _check_stagger(stagger, v)
        reference = reference_points(design.stacking, outline, span)
    else:
        lines, outline, stagger, reference = _stacked(design, place, mapping, span)
    chord = lines.extents() / np.cos(stagger)
    turned = np.cos(stagger), np.sin(stagger)
    along = chord * (reference[..., 0] * turned[0] - reference[..., 1] * turned[1])
    across = chord * (reference[..., 0] * turned[1] + reference[..., 1] * turned[0])
    shift = shift_of(design, span, stagger)
    lines = shifted_lines(place.surfaces, lines, along, shift)
    radius = lines.position(lines.u_at(along[..., None]))[..., 0, 1]
    around = shift.tangential / radius if mapping.revolved else shift.tangential
    start = mapping.start(_tangential(design, span) + around, radius, lines.lengths) - across
    plane = StaggeredSections(outline=outline, stagger=stagger, chord=chord, start=start)
    return OutlineStations(v=v, lines=lines, plane=plane)


def family_sections(design: SectionedBlade, span: Span, lines: BladedLines) -> tuple[Outline, Array]:
    """The family's sections in chords and their stagger (..., m) [rad] on stream lines."""
    part = design.section
    if not (isinstance(part, CamberAngle) and lines.mapping.plane == "m'-theta"):
        return part.outline(span), part.stagger(span)

    def meridional(fractions: Reals) -> Array:
        u = lines.u_at(lines.extents()[..., None] * fractions)
        return lines.meridional(u) / lines.lengths[..., None]

    return part.outline(span, meridional), part.stagger(span, meridional)


def _stacked(design: SectionedBlade, place: StackingPlace, mapping: Mapping, span: Span) -> Found:
    stacking, v = place.stacking, span.v
    chord = place.metre * span.values(0.0 if stacking.chord is None else stacking.chord)
    ruler = chord_ruler(place.surfaces, v, mapping, place.t(v), chord)

    def laid(outline: Outline, stagger: Array) -> Found:
        _check_stagger(stagger, v)
        reference = reference_points(stacking, outline, span)
        share = reference[..., 0] - reference[..., 1] * np.tan(stagger)
        lines = ruler.between(share, chord * np.cos(stagger))
        return lines, outline, stagger, reference

    part = design.section
    outline, stagger = part.outline(span), part.stagger(span)
    if not (isinstance(part, CamberAngle) and mapping.plane == "m'-theta"):
        return laid(outline, stagger)

    def again(lines: BladedLines) -> tuple[Outline, Array]:
        return family_sections(design, span, lines)

    return _settled(laid, again, outline, stagger)


def _settled(
    laid: Callable[[Outline, Array], Found],
    again: Callable[[BladedLines], tuple[Outline, Array]],
    outline: Outline,
    stagger: Array,
) -> Found:
    """Sections whose stagger follows from the stream lines that they are laid on, by the secant method."""
    weight: Any = -1.0
    before: tuple[Reals, Reals] | None = None
    for _ in range(ROUNDS):
        outline, found = again(laid(outline, stagger)[0])
        off = found - stagger
        real, carried = np.real(off), np.max(np.square(np.imag(found)), initial=0.0)
        if np.max(np.square(real)) < 1e-26 and np.max(np.square(np.imag(off)), initial=0.0) <= 1e-24 * carried:
            return laid(outline, found)
        if before is not None:
            moved, turned = np.real(stagger) - before[0], real - before[1]
            with np.errstate(all="ignore"):
                weight = np.where(np.square(turned) > 1e-16, moved / turned, weight)
        before = np.real(stagger), real
        stagger = stagger - weight * off
    raise DesignError(
        "stacking: the sections' chord lines turn with the place that their chord gives them, and do not settle: "
        "give leading_edge and trailing_edge, which say where the sections begin and end"
    )


def _tangential(design: SectionedBlade, span: Span) -> Array:
    """theta [rad], or y [m] in a cascade, (..., m) of the reference points."""
    stacking, annular = design.stacking, design.arrangement == "annular"
    if stacking is None:
        law = design.leading_edge_theta if annular else design.leading_edge_y
    else:
        law = stacking.theta if annular else stacking.y
    values = span.values(0.0 if law is None else law)
    return radians(values) if annular else UNITS[design.length_unit] * values


def _check_stagger(stagger: Array, v: Reals) -> None:
    real = np.real(stagger).reshape(-1, len(v))
    steep = np.argwhere(real**2 >= STEEP**2)
    if len(steep):
        row, at = steep[0]
        raise DesignError(
            f"section: its chord line stands at {np.degrees(real[row, at]):.4g} deg at v = {v[at]:.3f}: it must keep "
            "below 89 deg to both sides, for beyond it the extent along the flow says nothing of the chord; lower the "
            "stagger angle there"
        )
