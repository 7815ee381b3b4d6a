"""What all standard profiles have: a stagger, and sections that a kind's own parameters decide."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from bladewright.designs import Law, Part, parameter
from bladewright.numerics.elementary import Array, radians
from bladewright.section import checks
from bladewright.section.laws import Span
from bladewright.section.outline import Outline


@dataclass(frozen=True, kw_only=True)
class Profile(Part, ABC):
    """Base of the kinds of profiles: each is one final class with a `kind` by which design files choose it."""

    LIMITS: ClassVar[dict[str, tuple[float, float, str]]] = {}
    """lowest and highest value of each law, both excluded, and what to say of one that is not between"""

    stagger_angle: Law = parameter("deg", default=0.0)
    """angle of the chord line [deg]"""

    def __post_init__(self) -> None:
        limits = {"stagger_angle": (-90.0, 90.0, "an angle must lie between -90 and 90 deg"), **self.LIMITS}
        for name, (low, high, what) in limits.items():
            object.__setattr__(self, name, checks.law(name, getattr(self, name)))
            checks.between(name, getattr(self, name), low, high, what)

    @abstractmethod
    def outline(self, span: Span) -> Outline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered."""

    def stagger(self, span: Span) -> Array:
        """Angles (..., m) of the chord lines [rad]."""
        return radians(span.values(self.stagger_angle))
