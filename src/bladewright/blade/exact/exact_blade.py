"""What every exact blade answers: the blade that the design defines, in metres and radians."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from bladewright.blade.exact.meridional_extent import MeridionalExtent
from bladewright.blade.exact.meridional_view import MeridionalView
from bladewright.blade.exact.section_stack import SectionStack
from bladewright.blade.flow_path.channel import ChannelLine
from bladewright.blade.flow_path.meridional_curve import MeridionalCurve, real_first
from bladewright.blade.flow_path.stream_surface_map import StreamSurfaceMap
from bladewright.blade.flow_path.streamlines import MeridionalChannel
from bladewright.errors import DesignError
from bladewright.numerics.elementary import concatenated
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.section.crossing import touching
from bladewright.section.section import Section
from bladewright.section.smoothness import Smoothness

if TYPE_CHECKING:
    from bladewright.blade.design.row_design import RowDesign

MIDDLE = 0.5
"""Mid-span: a blade that has a section here has one everywhere along the span."""


@dataclass(frozen=True, kw_only=True)
class ExactBlade(ABC):
    """The blade that the design defines: native surfaces interpolate it, and are measured against it."""

    design: "RowDesign"
    mapping: StreamSurfaceMap
    """the sections' plane and its way to space"""

    @property
    @abstractmethod
    def survey(self) -> SectionStack:
        """Sections from end to end on which the shape is judged."""

    @abstractmethod
    def sections(self, v: Reals) -> SectionStack:
        """Sections at v (m,)."""

    @abstractmethod
    def moved_to(self, design: Any) -> Self:
        """The exact blade of a design a small step away, with the choices that were made for this one's shape."""

    @abstractmethod
    def check(self) -> None:
        """Raise DesignError where the shape is impossible, or neighbouring blades intersect."""

    def check_neighbours(self) -> None:
        """Raise DesignError where neighbouring blades intersect."""
        sections, design = self.survey, self.design
        outlines = sections.outlines()
        if not self.mapping.keeps_ordinate:
            u, _, across = sections.on_lines(outlines)
            outlines = np.stack([real_first(u, 2), real_first(across, 2)], axis=-1)
        spacing = float(np.real(np.ravel(design.spacing))[0])
        found = touching(outlines, spacing)
        if found is None:
            return
        what = f"blade_count is {design.blade_count}" if design.blade_count else f"pitch is {spacing / design.metre:g}"
        much = f"{spacing / design.metre:.4g} {design.length_unit}"
        much = f"{np.degrees(spacing):.4g} deg" if design.blade_count else much
        cure = "fewer blades" if design.blade_count else "a larger pitch"
        raise DesignError(
            f"{what}: neighbouring blades intersect at v = {sections.v[found]:.3f}, where they stand {much} apart; "
            f"take {cure}, thinner sections or less stagger there"
        )

    @abstractmethod
    def breaks_along_u(self) -> Reals:
        """Inner knots that the sides need by s, each as often as derivatives are lost."""

    @abstractmethod
    def breaks_along_v(self) -> Reals:
        """Inner knots that the sides need along the span, each as often as derivatives are lost."""

    @abstractmethod
    def meridional_channel(self, noses: tuple[float, float], ends: tuple[float, float]) -> MeridionalChannel:
        """The channel, or the flow path, that the blade stands in; its `ends` and the blade's `noses` by u are held."""

    @abstractmethod
    def wall(self, name: str) -> ChannelLine | MeridionalCurve:
        """The meridian of the hub or the shroud, or of the clearance surface in its place."""

    @abstractmethod
    def end_wall(self, row: int) -> tuple[Curve, Reals]:
        """The meridian of the wall that the end at v = 0 (row 0) or v = 1 (row -1) lies on, and its inner knots.

        The knots are those at which it loses derivatives, each as often as it occurs.
        """

    @abstractmethod
    def wall_parameters(self, u: Reals) -> Reals:
        """Parameters (2, k) of both walls' meridians at u (2, k) on the first and the last stream line."""

    def end_places(self, s: Reals) -> tuple[Reals, Reals]:
        """Where the ends of the sides lie: parameters of both end walls' meridians, and theta or y, (2, 2 k) each.

        At s (k,) of the upper, then of the lower side; near enough to begin a search.
        """
        sections = self.survey
        plane = concatenated(sections.plane_points(s), axis=-2)[..., [0, -1], :, :]
        lines = sections.lines.rows([0, -1])
        u = lines.u_at(plane[..., 0])
        across = lines.mapping.tangential(plane[..., 1], lines.position(u)[..., 1], lines.lengths[..., None])
        first = (0,) * (u.ndim - 2)
        u, across = np.real(u)[first], np.real(across)[first]
        return self.wall_parameters(u), across

    @abstractmethod
    def wall_points(self, name: str, u: Reals) -> Reals:
        """Points (k, 2) of the hub or shroud by u, past the edges as far as there is a wall."""

    @property
    @abstractmethod
    def meridional_view(self) -> MeridionalView:
        """Walls, edges as the design gives them, and stream lines, in the meridional plane."""

    @property
    @abstractmethod
    def meridional_extent(self) -> MeridionalExtent:
        """Where the blade's edges lie in its channel, and how far from them other places do."""

    @abstractmethod
    def without_clearance(self) -> "ExactBlade":
        """The same from wall to wall of its channel."""

    @property
    def uncut(self) -> "ExactBlade":
        """The blade whose v is its laws' span fraction: itself, or that from wall to wall which a clearance cuts."""
        return self

    @property
    def clearance_range(self) -> tuple[float, float]:
        """Between which parameters of a clearance surface's meridian it keeps the stated distance."""
        return 0.0, 1.0

    def clearance_error(self, u: Reals, points: Reals) -> Reals | None:
        """How far (m,) [m] the distances of points (x, r) (m, 2) from the wall are off the clearance at u (m,).

        None where the blade has no clearance.
        """
        del u, points
        return None

    @property
    def given_spans(self) -> Reals:
        """Span fractions (n,) at which curves of constant v of the sides are to be the sections that are given."""
        return np.empty(0)

    @property
    def section_spans(self) -> tuple[float, ...]:
        """Span fractions of the sections that are shown."""
        return 0.0, MIDDLE, 1.0

    def shown_spans(self, among: Sequence[float]) -> tuple[float, ...]:
        """`among` where the blade has sections all along the span, else those at which it has any at all."""
        own = self.section_spans
        return tuple(among) if MIDDLE in own else own

    @property
    def tip_knots(self) -> Reals | None:
        """Knots of the meridian of a clearance surface, where there is one."""
        return None

    @property
    def bent_from(self) -> float | None:
        """Height from the uncut end at which curves of constant v begin to bend to a cut, where there is one."""
        return None

    def section(self, v: float) -> Section:
        """The exact section at v in [0, 1] as curves in its plane; raises DesignError outside."""
        if not 0.0 <= v <= 1.0:
            raise DesignError(
                f"a section was asked at v = {v:g}: v runs from 0 at the blade's hub end to 1 at its other"
            )
        return self._section(v)

    @abstractmethod
    def _section(self, v: float) -> Section:
        """The same inside 0 and 1."""

    @abstractmethod
    def smoothness(self, v: float) -> Smoothness:
        """Curvature, its slope and their jumps along the exact section at v in [0, 1], in chords of its plane."""
