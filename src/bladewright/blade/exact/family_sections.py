"""Sections of a family at places along the span: staggered in their planes, and mapped on their stream surfaces."""

from abc import ABC
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.blade.exact.section_stack import SectionStack
from bladewright.blade.flow_path.blade_streamlines import BladeStreamlines
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.flow_path.stream_surface_map import Taylor
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.crossing import closed_outlines
from bladewright.section.outline import EdgeDerivatives, Outline
from bladewright.section.smooth_camber import SmoothCamber, smooth_camber


@dataclass(frozen=True, kw_only=True, eq=False)
class FlowPathSections(SectionStack, ABC):
    """Sections at places v (m,) along the span of a flow path."""

    lines: BladeStreamlines

    def check(self) -> None:
        """Raise DesignError where the sides cannot be those of a blade."""

    @property
    def clustered(self) -> bool:
        return True

    def channel_parameter(self, u: Array) -> Array:
        return self.lines.t(u)


@dataclass(frozen=True, kw_only=True, eq=False)
class FamilySections(FlowPathSections):
    """The exact sections (..., m) of a family at places v (m,) along the span.

    In its plane a section's chord line begins at the abscissa 0.
    """

    outline: Outline
    """the sections in chords, unstaggered"""
    stagger: Array
    """(..., m) [rad]"""
    chord: Array
    """(..., m) length of the chord line in the plane"""
    start: Array
    """(..., m) ordinate of the leading edge"""

    def plane_points(self, s: Reals) -> tuple[Array, Array]:
        upper, lower = self.outline.points(s)
        return self.placed(upper), self.placed(lower)

    def placed(self, points: Array) -> Array:
        """Points (..., m, k, 2) of the plane from points in chords."""
        turned = self.turned(points)
        return np.stack(np.broadcast_arrays(turned[..., 0], turned[..., 1] + self.start[..., None]), axis=-1)

    def chord_lines_in_space(self, share: Array) -> tuple[Array, Array]:
        """Points [m] of the chord lines, and derivatives by the share, (..., m, k, 3) at shares (..., m, k) or (k,)."""
        lines, mapping = self.lines, self.mapping
        rate = np.stack([self.chord * np.cos(self.stagger), self.chord * np.sin(self.stagger)], axis=-1)[..., None, :]
        abscissa, across = share * rate[..., 0], share * rate[..., 1] + self.start[..., None]
        u = lines.u_at(abscissa)
        speed = rate[..., 0] / lines.densities(u)[0]
        position, slope = lines.position(u), lines.position(u, 1) * speed[..., None]
        none = np.zeros_like(speed)
        x, radius = (Taylor(position[..., i], slope[..., i], none) for i in (0, 1))
        ordinate = Taylor(across, rate[..., 1] + none, none)
        tangential = mapping.tangential_series(ordinate, radius, lines.lengths[..., None])
        point, first, _ = mapping.series_in_space(x, radius, tangential)
        return point, first

    def turned(self, vectors: Array) -> Array:
        """Vectors (..., m, k, 2) of the plane from vectors in chords."""
        along, across = ((self.chord * part)[..., None] for part in (np.cos(self.stagger), np.sin(self.stagger)))
        a, b = vectors[..., 0], vectors[..., 1]
        return np.stack([a * along - b * across, a * across + b * along], axis=-1)

    @cached_property
    def edge_kinds(self) -> tuple[str, str]:
        """How the sides meet at the leading and at the trailing edge: "round", "sharp" or "blunt"."""
        return self.outline.leading_edge.kind, self.outline.trailing_edge.kind

    @property
    def back(self) -> float | None:
        return self.outline.back

    def camber(self, share: Reals) -> Array:
        return self.placed(self._camber_line.points(share))

    def camber_ends(self) -> tuple[Array, Array]:
        line = self._camber_line
        first, last = (self.turned(each[..., None, :])[..., 0, :] for each in (line.first, line.last))
        return first, last

    def camber_tangents(self) -> tuple[Array, Array] | None:
        first, last = (
            self.turned(np.stack([np.ones_like(slope), slope], axis=-1)[..., None, :])[..., 0, :]
            for slope in self.outline.camber_slopes()
        )
        return first, last

    @cached_property
    def _camber_line(self) -> SmoothCamber:
        return smooth_camber(self.outline)

    def outlines(self) -> Reals:
        return real_first(self.placed(closed_outlines(self.outline)), 3)

    def leading_edge(self) -> EdgeDerivatives:
        return self._row(0, self.outline.leading_edge.upper)

    def trailing_edge(self) -> EdgeDerivatives:
        return self._row(1, self.outline.trailing_edge.upper)

    def lower_edges(self) -> tuple[EdgeDerivatives | None, EdgeDerivatives | None]:
        outline = self.outline
        first, last = (
            None if edge.kind == "round" else self._row(end, edge.lower)
            for end, edge in enumerate((outline.leading_edge, outline.trailing_edge))
        )
        return first, last

    def faces(self, w: Reals) -> dict[str, Array]:
        """The faces of blunt edges; they are straight in the plane."""
        outline, found = self.outline, {}
        for name, edge in (("leading_edge", outline.leading_edge), ("trailing_edge", outline.trailing_edge)):
            if edge.kind == "blunt":
                upper, lower = (side.point[..., None, :] for side in (edge.upper, edge.lower))
                found[name] = self.in_space(self.placed(upper + w[:, None] * (lower - upper)))
        return found

    def _row(self, end: int, start: EdgeDerivatives) -> EdgeDerivatives:
        point = self.placed(start.point[..., None, :])
        first, second = (self.turned(each[..., None, :])[..., 0, :] for each in (start.first, start.second))
        u: Array = np.array([float(end)])
        if self.edge_kinds[end] == "blunt" or not self.outline.on_chord_line:
            u = self.lines.u_at(point[..., 0])
        return self.row(u, point[..., 0, :], first, second)
