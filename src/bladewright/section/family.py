"""What the parameters of every family of sections are: a part of a design that gives sections along the span."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

from bladewright.designs import Part
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import Span
from bladewright.section.meanline import Meanline
from bladewright.section.outline import Outline

MeridionalFraction = Callable[[Reals], Array]
"""Fractions (..., m, k) of the meridional length at fractions (k,) of m', of each of the m stream surfaces"""


@dataclass(frozen=True, kw_only=True)
class SectionFamily(Part, ABC):
    """Base of the families: their parameters, each a law of evolution along the span.

    A family does not depend on the blade: the same part is a 2D design, a prismatic blade and a blade in a flow path.
    """

    depends_on_stream_surface: ClassVar[bool] = False
    """whether the sections in the plane (m', theta) depend on how the meridional length grows along m'"""

    @abstractmethod
    def outline(self, span: Span) -> Outline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered."""

    @abstractmethod
    def stagger(self, span: Span) -> Array:
        """Angles (..., m) of the chord lines [rad]."""

    def on_stream_surfaces(self, span: Span, meridional: MeridionalFraction) -> tuple[Outline, Array]:  # noqa: ARG002
        """`outline` and `stagger` on stream surfaces whose meridional length grows along m' as given."""
        return self.outline(span), self.stagger(span)

    def meanline(self, span: Span) -> Meanline | None:  # noqa: ARG002 - only some families have one
        """The meanlines (..., m) on which the sections are built; None where the family has none in closed form."""
        return None
