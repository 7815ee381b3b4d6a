"""Sections between prescribed leading- and trailing-edge curves."""

from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.exact.placement import Placed, Placement, check_stagger, family_sections, reference_points
from bladewright.blade.flow_path.blade_streamlines import BladeStreamlines, blade_streamlines, labels
from bladewright.blade.flow_path.intersections import curve_joints, intersections
from bladewright.blade.flow_path.meridional_curve import MeridionalCurve
from bladewright.blade.flow_path.stream_surface_map import StreamSurfaceMap
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span

if TYPE_CHECKING:
    from bladewright.blade.design.sectioned import SectionedBlade

JOINT_PLACES = np.linspace(0.0, 1.0, 17)
"""Span fractions between which the joints of edge curves are first interpolated, before Newton's method."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PrescribedEdges(Placement):
    """A flow path with the leading- and trailing-edge curves of a blade in it."""

    leading_edge: MeridionalCurve
    trailing_edge: MeridionalCurve

    @property
    def edge_curves(self) -> tuple[MeridionalCurve, MeridionalCurve]:
        return self.leading_edge, self.trailing_edge

    def placed(self, design: "SectionedBlade", mapping: StreamSurfaceMap, span: Span) -> Placed:
        lines = self.lines(span.v, mapping)
        outline, stagger = family_sections(design, span, lines)
        check_stagger(stagger, span.v)
        return lines, outline, stagger, reference_points(design.stacking, outline, span)

    def span_joints(self) -> list[tuple[float, int]]:
        met = self.intersections(JOINT_PLACES)
        return [
            joint
            for curve, own in zip(self.edge_curves, met, strict=True)
            for joint in curve_joints(self.surfaces, curve, JOINT_PLACES, own)
        ]

    def lines(self, v: Reals, mapping: StreamSurfaceMap) -> BladeStreamlines:
        """Stream lines at v (m,) by u between the edges."""
        key = mapping.plane, v.tobytes()
        if key not in self._lines:
            self._lines[key] = blade_streamlines(self.surfaces, v, mapping, *self.edges(v))
        return self._lines[key]

    def edges(self, v: Reals) -> tuple[Array, Array]:
        """t (..., m) where the stream lines at v (m,) meet the leading and the trailing edge.

        Raises DesignError where they do not meet.
        """
        leading, trailing = (t for t, _ in self.intersections(v))
        return leading, trailing

    def intersections(self, v: Reals) -> list[tuple[Array, Array]]:
        """Where the stream lines at v (m,) meet the leading and the trailing edge: t, and the curve's parameter."""
        new = np.array([each for each in np.unique(v) if each not in self._met])
        if len(new):
            position, real = (partial(each.position, new) for each in (self.surfaces, self.surfaces.real()))
            found = [
                intersections(position, self.surfaces.extent, curve, name, labels(new), real=real)
                for curve, name in zip(self.edge_curves, ("leading_edge", "trailing_edge"), strict=True)
            ]
            self._met.update(
                {each: [(t[..., i], own[..., i]) for t, own in found] for i, each in enumerate(new.tolist())}
            )
        rows = [self._met[each] for each in v.tolist()]
        return [
            (np.stack([row[edge][0] for row in rows], axis=-1), np.stack([row[edge][1] for row in rows], axis=-1))
            for edge in (0, 1)
        ]

    @cached_property
    def _met(self) -> dict[float, list[tuple[Array, Array]]]:
        """Intersections with both edges by v: sections, edges and joints need them at many of the same v."""
        return {}

    @cached_property
    def _lines(self) -> dict[tuple[str, bytes], BladeStreamlines]:
        """Stream lines by plane and v: derivatives by the sections' laws need the same ones a few times."""
        return {}
