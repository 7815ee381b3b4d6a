"""The fillet between a blade and a wall, as a design."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from bladewright.designs import ByShape, Limits, Part, parameter
from bladewright.errors import DesignError
from bladewright.section import checks

SIZE = Limits(0.0, float("inf"), "a fillet's size must be positive; leave the fillet out where there is none")
KINDS = ("radius", "ellipse", "curvature")
ELLIPSE = ("on_blade", "on_wall")


@dataclass(frozen=True, kw_only=True)
class FilletRadii(Part):
    """The radius at the edges and in the middle of the sides of a section, joined smoothly around it."""

    inline: ClassVar[bool] = True

    leading_edge: float = parameter("length", limits=SIZE)
    """radius at the leading edge [length]"""
    trailing_edge: float = parameter("length", limits=SIZE)
    """radius at the trailing edge [length]"""
    upper: float | None = parameter("length", limits=SIZE, default=None)
    """radius in the middle of the upper side [length]"""
    lower: float | None = parameter("length", limits=SIZE, default=None)
    """radius in the middle of the lower side [length]"""
    suction_side: float | None = parameter("length", limits=SIZE, default=None)
    """instead of upper or lower, where the design says which is the suction side [length]"""
    pressure_side: float | None = parameter("length", limits=SIZE, default=None)
    """instead of the other [length]"""

    def __post_init__(self) -> None:
        checks.parameters(self)
        sides = ("upper", "lower"), ("suction_side", "pressure_side")
        named = tuple(name for pair in sides for name in pair if getattr(self, name) is not None)
        if named not in sides:
            raise DesignError(
                f"radius gives {' and '.join(named) or 'neither side'} beside leading_edge and trailing_edge: give "
                "upper and lower, or suction_side and pressure_side"
            )


Radius = Annotated[float | tuple[float, ...] | FilletRadii, ByShape(FilletRadii)]
"""A radius everywhere, a law along the section, or the values at both edges and on both sides."""


@dataclass(frozen=True, kw_only=True)
class Fillet(Part):
    """The fillet between a blade and the wall that it stands on.

    `radius`: the surface that a ball rolling along blade and wall touches. `ellipse`: a quarter of an ellipse between
    the same planes, wider on one of the two. `curvature`: from the contacts of the ball, with the curvature of blade
    and wall at its ends, so that no jump of curvature is left.
    """

    kind: Literal["radius", "ellipse", "curvature"] = "radius"
    """the cross-section: an arc, an ellipse, or a curve with continuous curvature"""
    radius: Radius | None = parameter("length", limits=SIZE, default=None)
    """radius of the rolling ball: a number, control points of a law from leading to trailing edge, alike on both sides,
    or a table of the radii at leading_edge, upper, trailing_edge and lower [length]"""
    on_blade: float | None = parameter("length", limits=SIZE, default=None)
    """height of an ellipse on the blade, where the two stand at a right angle [length]"""
    on_wall: float | None = parameter("length", limits=SIZE, default=None)
    """width of an ellipse on the wall, where the two stand at a right angle [length]"""

    def __post_init__(self) -> None:
        checks.choice("kind", self.kind, KINDS)
        own, other = (ELLIPSE, ("radius",)) if self.kind == "ellipse" else (("radius",), ELLIPSE)
        for name in other:
            if getattr(self, name) is not None:
                raise DesignError(f"{name} is given, but kind is '{self.kind}': give {' and '.join(own)}")
        for name in own:
            if getattr(self, name) is None:
                raise DesignError(f"{name} is missing: a fillet of kind '{self.kind}' needs {' and '.join(own)}")
        if not isinstance(self.radius, FilletRadii):
            for name in own:
                _positive(self, name)


def _positive(part: Part, name: str) -> None:
    """Bring a number or a list of numbers to its kind, and refuse what is not above zero."""
    value = getattr(part, name)
    if value is None:
        return
    if checks.is_sequence(value) and len(value) == 0:
        raise DesignError(
            f"{name} is an empty list: give a number, or one radius or more from leading to trailing edge"
        )
    value = checks.control_points(name, value)
    checks.between(name, value, SIZE.low, SIZE.high, SIZE.cure)
    object.__setattr__(part, name, value)
