"""The station table of a 2D section: one station, in the plane (x, y)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, angle, cross2, length, magnitude
from bladewright.section.closest_pair import Outline, closest_pair, newton_step
from bladewright.section.double_normal import Motion, distance
from bladewright.section.station_table import StationTable
from bladewright.section.thickest import thickest

if TYPE_CHECKING:
    from bladewright.section.section import Section

SIDES = ("upper", "lower")


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SectionStation(StationTable):
    """The station table of a 2D section; complex where the section carries a step."""

    section: Section

    @property
    def in_space(self) -> bool:
        return False

    @property
    def in_a_row(self) -> bool:
        return self.section.pitch is not None

    @property
    def edge_kinds(self) -> tuple[str, str]:
        """How the sides meet at both edges; a straight back face is as good as a blunt edge."""
        first, last = self.section.edges
        return first, "blunt" if self._back is not None else last

    @property
    def _back(self) -> float | None:
        return None if self.section.outline is None else self.section.outline.back

    @property
    def leading_edge_x(self) -> Array:
        """x of the leading edge [m]."""
        return self.section.camber.control_points[:1, 0]

    @property
    def trailing_edge_x(self) -> Array:
        """x of the trailing edge [m]."""
        return self.section.camber.control_points[-1:, 0]

    @property
    def metal_angle_in(self) -> Array:
        points = self.section.camber.control_points
        return np.atleast_1d(angle(*(points[1] - points[0])[::-1]))

    @property
    def metal_angle_out(self) -> Array:
        points = self.section.camber.control_points
        return np.atleast_1d(angle(*(points[-1] - points[-2])[::-1]))

    @property
    def _chord_line(self) -> Array:
        points = self.section.camber.control_points
        return np.asarray(points[-1] - points[0])

    @property
    def stagger(self) -> Array:
        """Angle of the chord line [rad]."""
        return np.atleast_1d(angle(*self._chord_line[::-1]))

    @property
    def chord(self) -> Array:
        return np.atleast_1d(length(self._chord_line))

    @property
    def axial_chord(self) -> Array:
        """x of the trailing less that of the leading edge [m]."""
        return self._chord_line[:1]

    @property
    def wrap(self) -> Array:
        """y of the trailing less that of the leading edge [m]."""
        return self._chord_line[1:]

    @property
    def maximum_thickness(self) -> Array:
        return distance(*self._thickest)

    @property
    def maximum_thickness_at(self) -> Array:
        """Where it is: along the chord line, of the chord [-]."""
        upper, lower = self._thickest
        start, along = self.section.camber.control_points[0], self._chord_line
        place = (upper.x[0] + lower.x[0]) / 2.0 - start[0], (upper.across[0] + lower.across[0]) / 2.0 - start[1]
        return np.asarray((place[0] * along[0] + place[1] * along[1]) / self.chord**2)

    @property
    def leading_edge_radius(self) -> Array:
        """Radius of curvature of a round leading edge, 0 of another [m]."""
        return self._edge_radius(0)

    @property
    def trailing_edge_radius(self) -> Array:
        """The same of the trailing edge [m]."""
        return self._edge_radius(1)

    @property
    def leading_edge_thickness(self) -> Array:
        """Width of the face of a blunt leading edge, 0 of another [m]."""
        return self._face_width(0, 0.0)

    @property
    def trailing_edge_thickness(self) -> Array:
        """The same of the trailing edge, or of a straight back face [m]."""
        return self._face_width(1, 1.0 if self._back is None else self._back)

    @property
    def pitch_in(self) -> Array:
        """Pitch at the leading edge, as everywhere [m]."""
        return self.pitch_mid

    @property
    def pitch_mid(self) -> Array:
        if self.section.pitch is None:
            raise DesignError("pitch is missing: a single section has no pitch, throat or solidity; set pitch")
        return np.atleast_1d(self.section.pitch)

    @property
    def pitch_out(self) -> Array:
        """Pitch at the trailing edge, as everywhere [m]."""
        return self.pitch_mid

    @property
    def _throat_pitch(self) -> Array:
        return self.pitch_mid

    @cached_property
    def throat(self) -> Array:
        """Smallest distance to the neighbouring section [m]."""
        up = np.array([0.0, 1.0]) * self.pitch_mid
        real = [_outline(self.section, real=True, shift=shift) for shift in (np.zeros(2), np.real(up))]
        first, second, held = closest_pair(real[0], real[1], 1)
        own, other = (_outline(self.section, real=False, shift=shift) for shift in (np.zeros(2), up))
        steps = newton_step(own, other, (first, second), held)
        carried = any(np.iscomplexobj(step) for step in steps)
        ends = (first - steps[0], second - steps[1]) if carried else (first, second)
        return length(other(ends[1], 0) - own(ends[0], 0))

    @property
    def blockage(self) -> Array:
        """Share of the pitch that the section takes where it is thickest, tangentially [-]."""
        upper, lower = self._thickest
        return distance(upper, lower) ** 2 / magnitude(upper.across[0] - lower.across[0]) / self.pitch_mid

    @cached_property
    def _thickest(self) -> tuple[Motion, Motion]:
        return thickest(self._motion, 1.0 if self._back is None else self._back)

    def _motion(self, side: int, u: Array) -> Motion:
        curve = self.section.curves[SIDES[side]]
        x, y = np.moveaxis(
            np.stack([curve(u) if order == 0 else curve.derivative(u, order) for order in range(3)]), -1, 0
        )
        return Motion(x, np.zeros_like(x), y, np.stack([np.ones_like(x[0]), *np.zeros_like(x[1:])]))

    def _edge_radius(self, end: int) -> Array:
        if self.edge_kinds[end] != "round":
            return np.zeros(1)
        curve, at = self.section.curves["upper"], np.array([float(end)])
        first, second = curve.derivative(at), curve.derivative(at, 2)
        with np.errstate(divide="ignore"):
            return length(first) ** 3 / magnitude(cross2(first, second))

    def _face_width(self, end: int, u: float) -> Array:
        if self.edge_kinds[end] != "blunt":
            return np.zeros(1)
        upper, lower = (self.section.curves[name](np.array([u])) for name in SIDES)
        return length(upper - lower)


def _outline(section: Section, *, real: bool, shift: Array) -> Outline:
    """The closed outline by s: the lower side from the leading to the trailing edge, then the upper side back."""

    def points(s: Array, order: int) -> Array:
        flat = np.real(s) % 2.0
        own = s - np.real(s) + flat
        on_lower = flat <= 1.0
        u = np.where(on_lower, own, 2.0 - own)
        lower, upper = (
            section.curves[name](u) if order == 0 else section.curves[name].derivative(u, order)
            for name in ("lower", "upper")
        )
        found = np.where(on_lower[..., None], lower, (-1.0) ** order * upper)
        found = np.real(found) if real else found
        return found + shift if order == 0 else found

    return points


def section_station(section: Section) -> SectionStation:
    """The table of a 2D section; DesignError for a section of a blade."""
    if section.plane != "x-y" or section.span != 0.0:
        raise DesignError(
            f"a report was asked of a section of a blade, at span {section.span:g} in the plane {section.plane}: ask "
            f"the blade, blade.report([{section.span:g}])"
        )
    return SectionStation(
        name=section.name, length_unit=section.length_unit, span=np.zeros(1), annular=False, section=section
    )
