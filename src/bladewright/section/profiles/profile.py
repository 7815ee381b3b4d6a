"""What all standard profiles have: a stagger, and for published forms a thickness and a trailing edge of choice."""

from __future__ import annotations

from abc import ABC
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bladewright.designs import Law, Limits, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, radians
from bladewright.section import checks
from bladewright.section.family import SectionFamily
from bladewright.section.laws import Span
from bladewright.section.profiles.mean_line import Opening, TrailingEdge

POWERS: dict[Opening, int] = {"quartic": 8, "linear": 2}
"""power of sqrt(x) whose coefficient opens the trailing edge: x^4, which hardly touches the front half, or x"""
ANGLE = Limits(-90.0, 90.0, "an angle must lie between -90 and 90 deg")
THICKNESS = Limits(0.0, 0.4, "thickness must be above 0 and below 0.4 chords")
TRAILING_EDGE = Limits(
    0.002, 0.5, "the trailing edge must be thicker than 0.002 and thinner than 0.5 of the maximum thickness"
)


@dataclass(frozen=True, kw_only=True)
class Profile(SectionFamily, ABC):
    """Base of the kinds of profiles: each is one final class with a `kind` by which design files choose it."""

    stagger_angle: Law = parameter("deg", limits=ANGLE, default=0.0)
    """angle of the chord line [deg]"""

    def __post_init__(self) -> None:
        checks.parameters(self)

    def stagger(self, span: Span) -> Array:
        """Angles (..., m) of the chord lines [rad]."""
        return radians(span.values(self.stagger_angle))


@dataclass(frozen=True, kw_only=True)
class PublishedProfile(Profile):
    """Base of the profiles whose thickness is a published form with a trailing edge of choice."""

    thickness: Law = parameter("-", limits=THICKNESS)
    """maximum thickness, of the chord [-]"""
    trailing_edge: TrailingEdge = "sharp"
    """how the trailing edge ends: sharp, blunt (cut off) or round (a cap within the same chord)"""
    trailing_edge_thickness: Law | None = parameter("-", limits=TRAILING_EDGE, default=None)
    """thickness at a blunt or round trailing edge, of the maximum thickness; none: the published one [-]"""
    trailing_edge_opening: Opening = "quartic"
    """how a blunt or round trailing edge is opened: in proportion to x^4, as published (quartic), or to x, by a wedge
    that makes the profile thicker everywhere (linear)"""

    def __post_init__(self) -> None:
        super().__post_init__()
        checks.choice("trailing_edge", self.trailing_edge, ("sharp", "blunt", "round"))
        if self.trailing_edge_thickness is not None and self.trailing_edge == "sharp":
            raise DesignError(
                "trailing_edge_thickness is given and trailing_edge is 'sharp', which has none: leave it out, or make "
                "the trailing edge 'blunt' or 'round'"
            )
        checks.choice("trailing_edge_opening", self.trailing_edge_opening, tuple(POWERS))
        if self.trailing_edge_opening != "quartic" and self.trailing_edge == "sharp":
            raise DesignError(
                f"trailing_edge_opening is '{self.trailing_edge_opening}' and trailing_edge is 'sharp', which is "
                "closed: leave it out, or make the trailing edge 'blunt' or 'round'"
            )

    def form_coefficients(self, span: Span, form: Mapping[int, float | Array], published: float) -> list[Array]:
        """Coefficients (..., m, 1) of the powers of sqrt(x), from the first on, of the half thickness.

        `form` holds those over the thickness. That of x^4 closes it at x = 1, and that of the opening makes the
        thickness there the one asked for; `published` is that of the published form, of the maximum thickness.
        """
        coefficients = dict(form)
        opening, closing = POWERS[self.trailing_edge_opening], POWERS["quartic"]
        coefficients[opening] = coefficients.get(opening, 0.0) + 0.5 * self.trailing_edge_share(span, published)
        coefficients[closing] = coefficients.get(closing, 0.0) - sum(form.values())
        thickness = span.values(self.thickness)[..., None]
        return [thickness * coefficients.get(k, 0.0) for k in range(1, max(coefficients) + 1)]

    def trailing_edge_share(self, span: Span, published: float) -> Array:
        """Thickness at the trailing edge (..., m, 1), of the maximum thickness."""
        if self.trailing_edge == "sharp":
            return np.zeros((len(span.v), 1))
        given = self.trailing_edge_thickness
        return np.full((len(span.v), 1), published) if given is None else span.values(given)[..., None]
