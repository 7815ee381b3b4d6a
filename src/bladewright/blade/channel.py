"""The meridional channel of a design: four curves that share their corners."""

from dataclasses import dataclass
from typing import Literal

from bladewright.designs import Part, Points, parameter
from bladewright.section import checks


@dataclass(frozen=True, kw_only=True)
class Channel(Part):
    """Control points of the four meridional curves, in the (x, r) plane of the machine, or (x, z) of a cascade.

    Hub and shroud take their end points from the leading and trailing edge, so a corner is one parameter.
    """

    leading_edge: Points = parameter("length")
    """control points from hub to shroud, two or more [length]"""
    trailing_edge: Points = parameter("length")
    """control points from hub to shroud, two or more [length]"""
    hub: Points = parameter("length", default=())
    """inner control points from leading to trailing edge, none or more [length]"""
    shroud: Points = parameter("length", default=())
    """inner control points from leading to trailing edge, none or more [length]"""
    degree: Literal[1, 2, 3, 4, 5] = 5
    """highest degree of the four B-splines; each has min(n - 1, degree) for n control points"""

    def __post_init__(self) -> None:
        for name, least in (("leading_edge", 2), ("trailing_edge", 2), ("hub", 0), ("shroud", 0)):
            object.__setattr__(self, name, checks.points(f"channel.{name}", getattr(self, name), least))
        checks.integer("channel.degree", self.degree, 1, 5, "a whole number is needed")
