"""The station table of a blade: measured on its native sides, and on where its chord lines lie in the meridional plane.

At a station v the curves of constant v of both sides are points (x, r, theta), or (x, z, y) in a cascade. The
meridional length L and the extent Delta m' between the edges are integrals along the chord line in (x, r).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.native.chord_lines import ChordLines
from bladewright.blade.native.moving_points import components, directions, lean_angle, middle, motion, sweep_angle
from bladewright.blade.native.throat import throat, throat_ends
from bladewright.numerics.elementary import Array, angle, cross2, dot, length, magnitude, unit
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import Reals, breaks
from bladewright.nurbs.surface import Surface
from bladewright.section.double_normal import Motion, distance, wrapped
from bladewright.section.station_table import StationTable, checked_stations
from bladewright.section.thickest import thickest

if TYPE_CHECKING:
    from bladewright.blade.exact.section_stack import SectionStack
    from bladewright.blade.native.blade import Blade

STATIONS = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Places along the span where none are asked for."""
UNWRAPPED = np.linspace(0.0, 1.0, 65)
"""Places along a side at which its theta is followed: between two of them no blade turns by half a revolution."""
PER_SPAN = 6
"""Gauss points in a knot span along v for the areas at the edges."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class BladeStations(StationTable):
    """The station table of a blade; complex where the blade carries a step."""

    blade: Blade
    """where a clearance cuts a blade from sections off, the uncut one: sections keep their span"""
    built: Blade
    """the same with its clearance, whose areas are measured"""
    finished: Blade
    """the same with its cuts and fillets, whose mass is stated"""

    @property
    def in_space(self) -> bool:
        return True

    @property
    def in_a_row(self) -> bool:
        return True

    @cached_property
    def edge_kinds(self) -> tuple[str, str]:
        """How the sides meet at both edges; a straight back face is as good as a blunt edge."""
        first, last = self._stack.edge_kinds
        return first, "blunt" if self._stack.back is not None else last

    @cached_property
    def _stack(self) -> SectionStack:
        return self.blade.exact.sections(self.span)

    @cached_property
    def _chord_lines(self) -> ChordLines:
        return ChordLines(stack=self._stack, annular=self.annular)

    @property
    def leading_edge_x(self) -> Array:
        """x of the leading edge [m]."""
        return self._edges[0].x[0]

    @property
    def leading_edge_r(self) -> Array:
        """Radius of the leading edge, z in a cascade [m]."""
        return self._edges[0].height[0]

    @property
    def trailing_edge_x(self) -> Array:
        """x of the trailing edge [m]."""
        return self._edges[1].x[0]

    @property
    def trailing_edge_r(self) -> Array:
        """Radius of the trailing edge, z in a cascade [m]."""
        return self._edges[1].height[0]

    @cached_property
    def metal_angle_in(self) -> Array:
        return self._metal_angle(0)

    @cached_property
    def metal_angle_out(self) -> Array:
        return self._metal_angle(1)

    @cached_property
    def stagger(self) -> Array:
        """Angle of the chord line, atan(Delta theta / Delta m') [rad]."""
        return np.arctan(self.wrap / self._chord_lines.extents)

    @cached_property
    def chord(self) -> Array:
        return self.meridional_chord / np.cos(self.stagger)

    @cached_property
    def meridional_chord(self) -> Array:
        """Meridional length from the leading to the trailing edge [m]."""
        return self._chord_lines.lengths

    @property
    def axial_chord(self) -> Array:
        """x of the trailing less that of the leading edge [m]."""
        return self.trailing_edge_x - self.leading_edge_x

    @cached_property
    def wrap(self) -> Array:
        """theta, or y, of the trailing less that of the leading edge [rad], or [m]."""
        change = self._edges[1].across[0] - self._edges[0].across[0]
        if not self.annular:
            return change
        followed = np.unwrap(np.real(self._motion(0, UNWRAPPED[:, None], self.span).across[0]), axis=0)
        return change + 2.0 * np.pi * np.round((followed[-1] - followed[0] - np.real(change)) / (2.0 * np.pi))

    @property
    def maximum_thickness(self) -> Array:
        return distance(*self._thickest)

    @cached_property
    def maximum_thickness_at(self) -> Array:
        """Where it is: along the chord line, of the chord [-]."""
        upper, lower = self._thickest
        turn = wrapped(lower.across[0] - upper.across[0], lower.period) / 2.0
        turn = turn + upper.across[0] - self._edges[0].across[0]
        turn = wrapped(turn - self.wrap / 2.0, lower.period) + self.wrap / 2.0
        place = np.stack([(upper.x[0] + lower.x[0]) / 2.0, (upper.height[0] + lower.height[0]) / 2.0], axis=-1)
        along = self._chord_lines.length_to(self._chord_lines.nearest(place), conformal=True)
        return (along * self._chord_lines.extents + turn * self.wrap) / (self._chord_lines.extents**2 + self.wrap**2)

    @cached_property
    def leading_edge_radius(self) -> Array:
        """Radius of curvature of a round leading edge in the stream surface, 0 of another [m]."""
        return self._edge_radius(0)

    @cached_property
    def trailing_edge_radius(self) -> Array:
        """The same of the trailing edge [m]."""
        return self._edge_radius(1)

    @property
    def leading_edge_thickness(self) -> Array:
        """Width of the face of a blunt leading edge, 0 of another [m]."""
        return self._face_width(0)

    @property
    def trailing_edge_thickness(self) -> Array:
        """The same of the trailing edge, or of a straight back face [m]."""
        return self._face_width(1)

    @property
    def pitch_in(self) -> Array:
        """Pitch at the leading edge [m]."""
        return self._pitch(self.leading_edge_r)

    @cached_property
    def pitch_mid(self) -> Array:
        return self._pitch(self._stack.chord_line(self._chord_lines.halfway[:, None])[..., 0, 1])

    @property
    def pitch_out(self) -> Array:
        """Pitch at the trailing edge [m]."""
        return self._pitch(self.trailing_edge_r)

    @cached_property
    def _throat_ends(self) -> tuple[Array, Array]:
        return throat_ends(self.blade, self.span)

    @property
    def throat(self) -> Array:
        return length(self._throat_ends[1] - self._throat_ends[0])

    @property
    def _throat_pitch(self) -> Array:
        middle = (self._throat_ends[0] + self._throat_ends[1]) / 2.0
        place = np.stack([middle[..., 0], length(middle[..., 1:]) if self.annular else middle[..., 2]], axis=-1)
        edges = [np.stack([edge.x[0], edge.height[0]], axis=-1) for edge in self._edges]
        away = [length(np.real(place - edge)) for edge in edges]
        return np.where(away[0] < away[1], self.pitch_in, self.pitch_out)

    @property
    def blockage(self) -> Array:
        """Share of the pitch that the blade takes where it is thickest, tangentially [-]."""
        upper, lower = self._thickest
        turn = magnitude(wrapped(upper.across[0] - lower.across[0], upper.period))
        radius = np.sqrt(upper.radius[0] * lower.radius[0])
        # at one place along the flow a section whose sides rise at beta is t / cos(beta) thick
        tangential = distance(upper, lower) ** 2 / (radius * turn)
        return tangential / self._pitch((upper.height[0] + lower.height[0]) / 2.0)

    @cached_property
    def lean(self) -> Array:
        """Lean of the line of points halfway between the edges, towards larger theta, or y [rad]."""
        rates = [(a + b) / 2.0 for a, b in zip(*self._edge_rates, strict=True)]
        radius = (self._edges[0].radius[0] + self._edges[1].radius[0]) / 2.0
        return lean_angle(rates, self._chord_lines.slope(self._chord_lines.halfway), radius)

    @cached_property
    def trailing_edge_lean(self) -> Array:
        """Lean of the trailing edge [rad]."""
        return lean_angle(self._edge_rates[1], self._edge_slopes[1], self._edges[1].radius[0])

    @cached_property
    def leading_edge_sweep(self) -> Array:
        """Angle of the leading edge from the normal of the stream line, downstream towards the shroud [rad]."""
        return sweep_angle(self._edge_rates[0], self._edge_slopes[0])

    @cached_property
    def trailing_edge_sweep(self) -> Array:
        """The same of the trailing edge [rad]."""
        return sweep_angle(self._edge_rates[1], self._edge_slopes[1])

    @property
    def scalars(self) -> Mapping[str, tuple[str, Array]]:
        """Areas of one passage at the edges, normal to the meridional flow, and of the throat; the blade's mass."""
        area = f"{self.length_unit}2"
        found = {"inlet_area": (area, self.inlet_area)}
        if self._has_throat:
            found["throat_area"] = area, self.throat_area
        found["outlet_area"] = area, self.outlet_area
        return found if self.finished.design.density is None else {**found, "mass": ("kg", self.finished.mass)}

    @property
    def remarks(self) -> tuple[str, ...]:
        sense = self.built.flow_sense.sentence
        if self.built is self.blade:
            return (sense,)
        name = "hub_clearance" if self.built.design.tip_clearance is None else "tip_clearance"
        return f"stations count from hub to shroud, and are those of the blade before {name} cuts it off", sense

    @cached_property
    def inlet_area(self) -> Array:
        """Area () of one passage at the leading edge, from end to end of the blade [m^2]."""
        return self._area(0)

    @cached_property
    def throat_area(self) -> Array:
        """Area () of the throat of one passage [m^2]."""
        return throat(self.built).area

    @cached_property
    def outlet_area(self) -> Array:
        """Area () of one passage at the trailing edge, from end to end of the blade [m^2]."""
        return self._area(1)

    def to_dict(self) -> dict[str, object]:
        """Columns with their units, areas, rotation and suction side, for JSON."""
        sense = self.blade.flow_sense
        return {**super().to_dict(), "rotation": self.blade.design.rotation, "suction_side": sense.suction_side}

    def _motion(self, side: int, u: Array, v: Reals) -> Motion:
        surface: Surface = self.blade.sides[side]
        return motion(*(surface.derivative(u, v, order, 0) for order in range(3)), revolved=self.annular)

    @cached_property
    def _edges(self) -> tuple[Motion, Motion]:
        """The middle of both edges; of derivatives nothing."""
        first, last = (
            middle(*(self._motion(side, np.full(len(self.span), end), self.span) for side in (0, 1)))
            for end in (0.0, 1.0)
        )
        return first, last

    @cached_property
    def _edge_rates(self) -> tuple[list[Array], list[Array]]:
        """Derivatives by v of x, r and theta of the middle of both edges."""
        first, last = (self._rates_at(self.blade, end, self.span) for end in (0.0, 1.0))
        return first, last

    def _rates_at(self, blade: Blade, end: float, v: Reals) -> list[Array]:
        along = [
            motion(side(end, v), side.derivative(end, v, 0, 1), side.derivative(end, v, 0, 1), revolved=self.annular)
            for side in blade.sides
        ]
        return [(a[1] + b[1]) / 2.0 for a, b in zip(along[0][:3], along[1][:3], strict=True)]

    def _pitch(self, radius: Array) -> Array:
        spacing = self.blade.design.spacing
        return spacing * radius if self.annular else spacing + 0.0 * radius

    def _metal_angle(self, end: int) -> Array:
        """Angles (m,) of the camber line at an edge; of a blade that has no sections between its ends, of the nose."""
        stack, at = self._stack, np.array([float(end)])
        tangents = stack.camber_tangents()
        if tangents is None:
            return self._nose_angle(end)
        along = tangents[end]
        row = stack.row(at, stack.camber(at)[..., 0, :], along, np.zeros_like(along))
        meridional, tangential = components(motion(*row, revolved=self.annular), self._edge_slopes[end])
        return angle(tangential, meridional)

    def _nose_angle(self, end: int) -> Array:
        """Angles (m,) of the normal to a round nose, or of the line midway between the sides at another edge."""
        at, slope = np.full(len(self.span), float(end)), self._edge_slopes[end]
        upper, lower = (np.stack(components(self._motion(side, at, self.span), slope), axis=-1) for side in (0, 1))
        if self._stack.edge_kinds[end] == "round":
            sign = -1.0 if end else 1.0
            return angle(-sign * upper[:, 0], sign * upper[:, 1])
        middle = unit(upper) + unit(lower)
        return angle(middle[:, 1], middle[:, 0])

    @cached_property
    def _edge_slopes(self) -> tuple[Array, Array]:
        """Unit vectors (m, 2) downstream along the chord lines in (x, r) at both edges."""
        start, end = (np.full(len(self.span), at) for at in (0.0, 1.0))
        return self._chord_lines.slope(start), self._chord_lines.slope(end)

    def _edge_radius(self, end: int) -> Array:
        if self.edge_kinds[end] != "round":
            return np.zeros(len(self.span))
        side, at = self.blade.sides[0], float(end)
        first, second = (side.derivative(at, self.span, order, 0) for order in (1, 2))
        along = directions(side(at, self.span), self._edge_slopes[end], revolved=self.annular)
        flat = [np.stack([dot(each, direction) for direction in along], axis=-1) for each in (first, second)]
        with np.errstate(divide="ignore"):
            return length(flat[0]) ** 3 / magnitude(cross2(flat[0], flat[1]))

    def _face_width(self, end: int) -> Array:
        if self.edge_kinds[end] != "blunt":
            return np.zeros(len(self.span))
        back = self._stack.back
        at = np.full(len(self.span), float(end) if end == 0 or back is None else back)
        return distance(*(self._motion(side, at, self.span) for side in (0, 1)))

    @cached_property
    def _thickest(self) -> tuple[Motion, Motion]:
        """The points of both sides at which the largest circle inside touches them."""
        back = self._stack.back
        end = 1.0 if back is None else back
        return thickest(lambda side, u: self._motion(side, u, self.span), end)

    def _area(self, end: int) -> Array:
        v, weight = panels(breaks(self.built.knots.v), PER_SPAN)
        rates = self._rates_at(self.built, float(end), v)
        slope = unit(self.built.exact.sections(v).chord_line(np.array([float(end)]), 1)[..., 0, :])
        point = [side(float(end), v) for side in self.built.sides]
        middle = (point[0] + point[1]) / 2.0
        radius = length(middle[:, 1:]) if self.annular else middle[:, 2]
        return np.asarray(np.sum(weight * self._pitch(radius) * (slope[:, 0] * rates[1] - slope[:, 1] * rates[0])))


def station_table(finished: Blade, stations: Sequence[float] | None = None) -> BladeStations:
    """The table of a blade at stations, increasing or not; DesignError where one is outside [0, 1] or no number.

    But for the mass it is that of the blade before cuts and fillets.
    """
    blade, design = finished.plain, finished.plain.design
    return BladeStations(
        name=design.name,
        length_unit=design.length_unit,
        span=checked_stations(STATIONS if stations is None else stations),
        annular=blade.exact.mapping.revolved,
        blade=blade.uncut,
        built=blade,
        finished=finished,
    )
