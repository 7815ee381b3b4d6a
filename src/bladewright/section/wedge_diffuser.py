"""Vanes of wedge diffusers: triangles with rounded corners (Voss et al. 2025, section 3.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bladewright.designs import Law, Limits, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, degrees, radians
from bladewright.nurbs.basis import Reals
from bladewright.section import checks
from bladewright.section.family import SectionFamily
from bladewright.section.laws import Span
from bladewright.section.outline import Edge, EdgeDerivatives, Joint, Outline, by_parts
from bladewright.section.planar import PlanarSection

EDGE = 0.1
"""s that the leading edge's arc takes on each side: its curvature asks for more than its share of the parameter [-]"""
CORNER = 0.85
"""s at which the straight side ends and the trailing edge's arc begins [-]"""
FACE = 0.95
"""s at which that arc ends, where there is a back face [-]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class WedgeOutline(Outline):
    """Arc, straight line, arc and, where the wedge is wider than both circles make it, half the back face.

    The tangent is continuous by s everywhere; straight lines and circles are exact.
    """

    leading_radius: Array
    """(...) in chords"""
    trailing_radius: Array
    half_angle: Array
    """(...) between a side and the chord line [rad]"""
    face: Array | None
    """(...) half the length of the back face; None: the trailing edge is one arc"""

    @property
    def leading_edge(self) -> Edge:
        """The circle's point at the chord line."""
        return _round(0.0, self.leading_radius, (np.pi / 2.0 - self.half_angle) / EDGE, 1.0)

    @property
    def trailing_edge(self) -> Edge:
        """The circle's point at the chord line, or the middle of the back face, which is straight."""
        if self.face is None:
            turn = (np.pi / 2.0 + self.half_angle) / (1.0 - CORNER)
            return _round(1.0, self.trailing_radius, turn, -1.0)
        speed = self.face / (1.0 - FACE)
        zero = 0.0 * speed
        point, second = np.stack([1.0 + zero, zero], axis=-1), np.stack([zero, zero], axis=-1)
        upper, lower = (EdgeDerivatives(point, np.stack([zero, sign * speed], axis=-1), second) for sign in (-1.0, 1.0))
        return Edge(kind="round", upper=upper, lower=lower)

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Where straight lines and circles touch."""
        return tuple(Joint(s, 1) for s in (EDGE, CORNER, *(() if self.face is None else (FACE,))))

    @property
    def back(self) -> float | None:
        return None if self.face is None else FACE

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., len(s), 2) of both sides, each the other's mirror image."""
        upper = self._upper(s)
        return upper, upper * np.array([1.0, -1.0])

    def camber(self, s: Reals) -> Array:
        """The chord line."""
        at = 0.0 * self.half_angle[..., None] + s
        return np.stack([at, 0.0 * at], axis=-1)

    def _upper(self, s: Reals) -> Array:
        first, last = s < EDGE, s > (1.0 if self.face is None else FACE)
        line, arc = ~first & (s <= CORNER), (s > CORNER) & ~last
        parts: list[tuple[NDArray[np.bool_], Array]] = [
            (first, self._leading(s[first] / EDGE)),
            (line, self._side((s[line] - EDGE) / (CORNER - EDGE))),
            (arc, self._trailing(s[arc])),
        ]
        if self.face is not None:
            height = self.face[..., None] * ((1.0 - s[last]) / (1.0 - FACE))
            parts.append((last, np.stack([1.0 + 0.0 * height, height], axis=-1)))
        return by_parts(parts, len(s))

    def _leading(self, t: Reals) -> Array:
        turn = (np.pi / 2.0 - self.half_angle)[..., None] * t
        radius = self.leading_radius[..., None]
        return np.stack([2.0 * radius * np.sin(0.5 * turn) ** 2, radius * np.sin(turn)], axis=-1)

    def _arc_end(self) -> float:
        return 1.0 if self.face is None else FACE

    def _trailing(self, s: Reals) -> Array:
        """The arc, by the angle between its normal and the chord line."""
        width, whole = self._arc_end() - CORNER, np.pi / 2.0 + self.half_angle
        t = (self._arc_end() - s) / width
        face = 0.0 * self.half_angle if self.face is None else self.face
        if self.face is None:
            share = t + 0.0 * whole[..., None]
        else:
            slope = (self.face / (1.0 - FACE)) * width / (self.trailing_radius * whole)
            share = monotone(t, slope, 1.0 + 0.0 * slope)
        turn, radius = whole[..., None] * share, self.trailing_radius[..., None]
        along = 1.0 - 2.0 * radius * np.sin(0.5 * turn) ** 2
        return np.stack([along, face[..., None] + radius * np.sin(turn)], axis=-1)

    def _side(self, t: Reals) -> Array:
        start, end = self._leading(np.ones(1)), self._trailing(np.array([CORNER]))
        along = end - start
        distance = np.sqrt(np.sum(along**2, axis=-1))[..., 0]
        width = CORNER - EDGE
        slope_in = self.leading_radius * (np.pi / 2.0 - self.half_angle) / EDGE * width / distance
        arc = (np.pi / 2.0 + self.half_angle) / (self._arc_end() - CORNER)
        slope_out = self.trailing_radius * arc * width / distance
        return start + monotone(t, slope_in, slope_out)[..., None] * along


def monotone(t: Reals, slope_in: Array, slope_out: Array) -> Array:
    """Rising fraction (..., len(t)) from 0 to 1 with positive slopes (...) at the ends (Gregory and Delbourgo 1982)."""
    across = t * (1.0 - t)
    below = 1.0 + (slope_in + slope_out - 2.0)[..., None] * across
    return (t**2 + slope_in[..., None] * across) / below


ANGLE = Limits(-90.0, 90.0, "an angle must lie between -90 and 90 deg")
RADIUS = Limits(0.0, 0.5, "an edge radius must lie above 0 and below half the chord")
WEDGE = Limits(0.0, 90.0, "a wedge angle must lie from 0 to 90 deg", closed=True)


@dataclass(frozen=True, kw_only=True)
class WedgeDiffuser(SectionFamily):
    """A vane with straight sides, a circular leading edge and circular trailing-edge corners, all in touch.

    With a wedge angle the vane is a triangle with three rounded corners: a back face lies across the chord line at
    the trailing edge. Without one it is what both circles make it: the sides touch the circles of both edges, and the
    wedge angle follows. Reference: Voss et al. 2025, section 3.2.
    """

    stagger_angle: Law = parameter("deg", limits=ANGLE)
    """angle of the chord line from the axis [deg]"""
    leading_edge_radius: Law = parameter("-", limits=RADIUS)
    """radius of the leading edge, of the chord [-]"""
    trailing_edge_radius: Law = parameter("-", limits=RADIUS)
    """radius of the trailing edge, or of its two corners, of the chord [-]"""
    wedge_angle: Law | None = parameter("deg", limits=WEDGE, default=None)
    """angle between the sides; none: as both radii make it, with a trailing edge of one arc [deg]"""

    def __post_init__(self) -> None:
        checks.parameters(self)

    def outline(self, span: Span) -> WedgeOutline:
        """The exact sections (..., m), in chords; raises DesignError where the corners leave no back face."""
        first, last = span.values(self.leading_edge_radius), span.values(self.trailing_edge_radius)
        touching = np.arcsin((last - first) / (1.0 - first - last))
        if self.wedge_angle is None:
            first, last, touching = np.broadcast_arrays(first, last, touching)
            return WedgeOutline(leading_radius=first, trailing_radius=last, half_angle=touching, face=None)
        half = 0.5 * radians(span.values(self.wedge_angle))
        face = (first - last + np.sin(half) * (1.0 - first - last)) / np.cos(half)
        first, last, half, face = np.broadcast_arrays(first, last, half, face)
        if np.any(np.real(face) <= 0.0):
            at = np.unravel_index(int(np.argmin(np.real(face))), face.shape)
            least = 2.0 * float(np.real(degrees(np.broadcast_to(touching, face.shape)[at])))
            where = f" at span v = {span.v[at[-1]]:.3g}" if len(span.v) > 1 else ""
            raise DesignError(
                f"wedge_angle is {float(2.0 * np.real(degrees(half[at]))):g} deg{where}: two corners with the "
                f"trailing_edge_radius need more than {least:.4g} deg, at which they are one arc; raise wedge_angle, "
                "lower trailing_edge_radius, or leave wedge_angle out"
            )
        return WedgeOutline(leading_radius=first, trailing_radius=last, half_angle=half, face=face)

    def stagger(self, span: Span) -> Array:
        """Angles (..., m) of the chord line [rad]."""
        return radians(span.values(self.stagger_angle))


@dataclass(frozen=True, kw_only=True)
class WedgeDiffuserSection(PlanarSection):
    """A vane of a wedge diffuser in the plane (x, y)."""

    section: WedgeDiffuser
    """the section's parameters"""


def _round(abscissa: float, radius: Array, turn: Array, inward: float) -> Edge:
    """A circle's point on the chord line, the circle to the right of it (1) or to the left (-1), turned by s."""
    zero = 0.0 * (radius + turn)
    point = np.stack([abscissa + zero, zero], axis=-1)
    second = np.stack([inward * radius * turn**2, zero], axis=-1)
    upper, lower = (
        EdgeDerivatives(point, np.stack([zero, sign * inward * radius * turn], axis=-1), second) for sign in (1.0, -1.0)
    )
    return Edge(kind="round", upper=upper, lower=lower)
