"""The camber-angle family: the camber's angle along the meridional distance, half thickness by a NURBS.

References: M. Casey, A computational geometry for the blades and internal flow channels of centrifugal compressors,
1983; freeform blading with NURBS: a camber angle and a thickness curve of six control points each.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from bladewright.designs import ChordwiseLaw, Limits, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, concatenated, radians
from bladewright.section import checks
from bladewright.section.camber_angle_outline import CamberAngleOutline
from bladewright.section.camber_by_angle import CamberByAngle, SplinePieces, length_fractions
from bladewright.section.family import MeridionalFraction, SectionFamily
from bladewright.section.laws import Span
from bladewright.section.outline import Outline
from bladewright.section.planar import PlanarSection

NEAR = 0.0625
"""fraction of the section's m' between an edge and the control point next to it, where a design gives no places: it
decides the shape near the edge only, and a design may give other places [-]"""


ANGLE = Limits(-89.0, 89.0, "an angle must lie between -89 and 89 deg")
HALF_THICKNESS = Limits(0.0, 0.4, "a half thickness must be above 0 and below 0.4 chords")
PLACE = Limits(0.0, 1.0, "a place must lie between the edges")
WEIGHT = Limits(1e-3, 1e3, "a weight must be from 0.001 to 1000")


@dataclass(frozen=True, kw_only=True)
class CamberAngle(SectionFamily):
    """A section whose camber line has a given angle along the meridional distance.

    beta(m) is a B-spline of degree 3, or one less than its number of control points, on uniform knots over the
    meridional length; theta = integral of tan(beta) / r dm. The half thickness is a NURBS of degree 3 on uniform knots
    in the plane of place (fraction of the section's m') and height, normal to the camber line. It begins on the camber
    at the leading edge, where the first value is at the same place: the nose is round, and the sides join with
    equal curvature.
    """

    depends_on_stream_surface: ClassVar[bool] = True

    camber_angle: ChordwiseLaw = parameter("deg", limits=ANGLE)
    """angle of the camber line from the meridional direction: control points along the meridional distance [deg]"""
    half_thickness: ChordwiseLaw = parameter("-", limits=HALF_THICKNESS)
    """control points of the half thickness, leading to trailing edge, of the chord [-]"""
    thickness_places: ChordwiseLaw = parameter("-", limits=PLACE, default=())
    """places of those control points that are not at an edge, of the section's m'; none: 1/16, then equal [-]"""
    thickness_weights: ChordwiseLaw = parameter("-", limits=WEIGHT, default=())
    """weights of the control points of the half thickness; none: 1 each [-]"""
    trailing_edge: Literal["round", "blunt", "sharp"] = "round"
    """round: the last half thickness is at the edge and closes as at the nose; blunt: it is cut off there;
    sharp: the thickness runs out to nothing behind it"""

    def __post_init__(self) -> None:
        checks.choice("trailing_edge", self.trailing_edge, ("round", "blunt", "sharp"))
        checks.parameters(self)
        least = 3 if self.trailing_edge == "blunt" else 2
        if len(self.half_thickness) < least:
            raise DesignError(
                f"half_thickness has {len(self.half_thickness)} control points: a {self.trailing_edge} trailing edge "
                f"needs at least {least}"
            )
        for name, count in (("thickness_places", self._inner), ("thickness_weights", len(self.half_thickness))):
            given = len(getattr(self, name))
            if given not in (0, count):
                raise DesignError(
                    f"{name} has {given} entries for {len(self.half_thickness)} of half_thickness: give {count} or none"
                )

    @property
    def _inner(self) -> int:
        """How many values of the half thickness are not at an edge."""
        return len(self.half_thickness) - (1 if self.trailing_edge == "sharp" else 2)

    def control_places(self, row: str) -> Sequence[float] | None:
        """The half thickness stands at given places."""
        if row not in ("half_thickness", "thickness_weights"):
            return None
        inner = [float(np.real(each[0])) for each in self._places(Span(np.array([0.5])))]
        return [0.0, *inner, *([1.0] if self.trailing_edge != "sharp" else [])]

    def outline(self, span: Span, meridional: MeridionalFraction | None = None) -> CamberAngleOutline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered.

        `meridional` gives the fraction of the meridional length at a fraction of m' of their stream surfaces; None: the
        two are equal. Raises DesignError where places do not increase.
        """
        heights = [span.values(law) for law in self.half_thickness]
        zero = np.zeros(len(span.v))
        closed = self.trailing_edge != "blunt"
        places = [zero, zero, *self._places(span), zero + 1.0]
        if self.trailing_edge == "round":
            places.append(zero + 1.0)
        weights = [span.values(law) for law in self.thickness_weights] or [zero + 1.0] * len(heights)
        weights = [zero + 1.0, *weights, *([zero + 1.0] if closed else [])]
        heights = [zero, *heights, *([zero] if closed else [])]
        rows = [_stacked(row) for row in (places, heights, weights)]
        return CamberAngleOutline(
            line=self._line(span, meridional),
            places=SplinePieces(controls=rows[0] * rows[2]),
            heights=SplinePieces(controls=rows[1] * rows[2]),
            weights=SplinePieces(controls=rows[2]),
            end=self.trailing_edge,
        )

    def stagger(self, span: Span, meridional: MeridionalFraction | None = None) -> Array:
        """Angles (..., m) of the chord lines [rad], which follow from the camber angle."""
        return self._line(span, meridional).stagger

    def on_stream_surfaces(self, span: Span, meridional: MeridionalFraction) -> tuple[Outline, Array]:
        outline = self.outline(span, meridional)
        return outline, outline.line.stagger

    def _line(self, span: Span, meridional: MeridionalFraction | None) -> CamberByAngle:
        angles = _stacked([radians(span.values(law)) for law in self.camber_angle])
        return CamberByAngle(
            angle=SplinePieces(controls=angles),
            length_fractions=None if meridional is None else length_fractions(meridional),
        )

    def _places(self, span: Span) -> list[Array]:
        if self.thickness_places:
            places = [span.values(law) for law in self.thickness_places]
            steps = np.diff(np.real(_stacked(places)), axis=-1)
            if np.any(steps <= 0.0):
                raise DesignError("thickness_places do not increase everywhere along the span: put them in order")
            return places
        last = 1.0 - NEAR if self.trailing_edge == "round" else 1.0
        count = self._inner
        if self.trailing_edge != "round":
            # the edge itself is the next of the equal steps
            inner = np.linspace(NEAR, last, count + 1)[:-1]
        else:
            inner = np.linspace(NEAR, last, count) if count > 1 else np.full(count, 0.5)
        return [np.full(len(span.v), each) for each in inner]


def _stacked(rows: list[Array]) -> Array:
    """Arrays (..., m) as (..., m, n)."""
    return concatenated([row[..., None] for row in rows], axis=-1)


@dataclass(frozen=True, kw_only=True)
class CamberAngleSection(PlanarSection):
    """A section by its camber angle in the plane (x, y)."""

    section: CamberAngle
    """the family's parameters, each a number"""
