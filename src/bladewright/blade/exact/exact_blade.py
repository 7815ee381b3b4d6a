"""What every exact blade answers: the blade that the design defines, in metres and radians."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numpy as np

from bladewright.blade.exact.meridional_extent import MeridionalExtent
from bladewright.blade.exact.meridional_view import MeridionalView
from bladewright.blade.exact.section_stack import SectionStack
from bladewright.blade.flow_path.stream_surface_map import StreamSurfaceMap
from bladewright.blade.flow_path.streamlines import MeridionalChannel
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve


class WallMeridian(NamedTuple):
    """The wall that an end of a blade lies on."""

    meridian: Curve
    """(x, r), or (x, z) in a cascade"""
    inner: Reals
    """its inner knots where it loses derivatives, each as often as it occurs"""


@dataclass(frozen=True, kw_only=True)
class ExactBlade(ABC):
    """The blade that is meant: what the native surfaces interpolate and are measured against."""

    design: Any
    """it has `ends`, `tolerance` and `length_unit`"""
    mapping: StreamSurfaceMap
    """the sections' plane and its way to space"""

    @property
    @abstractmethod
    def survey(self) -> SectionStack:
        """Sections from end to end on which the shape is judged."""

    @abstractmethod
    def stations(self, v: Reals) -> SectionStack:
        """Sections at v (m,)."""

    @abstractmethod
    def moved_to(self, design: Any) -> Self:
        """That of a design that is a small step away; what is chosen for the shape stays."""

    @abstractmethod
    def breaks_along_u(self) -> Reals:
        """Inner knots that the sides need by s, each as often as derivatives are lost."""

    @abstractmethod
    def breaks_along_v(self) -> Reals:
        """Inner knots that the sides need along the span, each as often as derivatives are lost."""

    @abstractmethod
    def end_wall(self, row: int) -> WallMeridian:
        """The wall of the end at v = 0 (row 0) or v = 1 (row -1)."""

    @abstractmethod
    def wall_places(self, u: Reals) -> Reals:
        """Parameters (2, k) of both walls' meridians at u (2, k) on the first and the last stream line."""

    @property
    @abstractmethod
    def plan(self) -> MeridionalView:
        """Walls, edges as asked for and stream lines in the meridional plane."""

    @abstractmethod
    def wall_line(self, name: str, u: Reals) -> Reals:
        """Points (k, 2) of the hub or shroud by u, past the edges as far as there is a wall."""

    @property
    @abstractmethod
    def meridians(self) -> MeridionalChannel:
        """The channel, or the flow path, that it stands in."""

    @property
    @abstractmethod
    def meridional_extent(self) -> MeridionalExtent:
        """The same, with the places of its edges, which a survey finds."""

    @abstractmethod
    def whole(self) -> Self:
        """The same without gaps, from wall to wall of the channel."""

    @property
    def given_spans(self) -> Reals:
        """Span fractions (n,) at which curves of constant v of the sides are to be the sections that are given."""
        return np.empty(0)

    @property
    def section_spans(self) -> tuple[float, ...]:
        """Span fractions of the sections that are shown."""
        return 0.0, 0.5, 1.0

    @property
    def tip_knots(self) -> Reals | None:
        """Knots of the meridian of a clearance surface, where there is one."""
        return None


MIDDLE = 0.5


def shown_spans(exact: ExactBlade, among: Sequence[float]) -> tuple[float, ...]:
    """`among` where the blade has sections all along the span, else those at which it has any at all."""
    own = exact.section_spans
    return tuple(among) if MIDDLE in own else own
