"""Double- and multiple-circular-arc profiles (Johnsen and Bullock 1965, NASA SP-36, chapter VI; Crouse et al. 1969)."""

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from bladewright.designs import Law, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, length, radians
from bladewright.section import checks
from bladewright.section.camber import turned_left
from bladewright.section.laws import Span
from bladewright.section.outline import Outline
from bladewright.section.profiles.arcs import Arc, ArcOutline
from bladewright.section.profiles.closing import THICKNESS
from bladewright.section.profiles.profile import Profile

RADIUS = (0.0, 0.1, "an edge radius must be above 0 and below 0.1 chords; leave it out for a sharp edge")
CAMBER = (-120.0, 120.0, "the camber angle must lie between -120 and 120 deg")


@dataclass(frozen=True, kw_only=True)
class Arcs(Profile):
    """Base of the profiles whose mean line and sides are circular arcs."""

    LIMITS: ClassVar = {"thickness": THICKNESS, "camber_angle": CAMBER}

    thickness: Law = parameter("-")
    """maximum thickness, of the chord, at the transition [-]"""
    camber_angle: Law = parameter("deg", default=0.0)
    """turning of the mean line [deg]"""
    leading_edge_radius: Law | None = parameter("-", default=None)
    """of the chord; none: a sharp edge [-]"""
    trailing_edge_radius: Law | None = parameter("-", default=None)
    """of the chord; none: a sharp edge [-]"""

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("leading_edge_radius", "trailing_edge_radius"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, checks.law(name, value))
                checks.between(name, getattr(self, name), *RADIUS)

    def _outline(self, span: Span, transition: Array, front_camber: Array) -> Outline:
        thickness = span.values(self.thickness)
        radii: list[Array | None] = []
        for name in ("leading_edge_radius", "trailing_edge_radius"):
            law: Law | None = getattr(self, name)
            radii.append(None if law is None else span.values(law))
            self._check_radius(name, radii[-1], thickness)
        turning = -radians(span.values(self.camber_angle))
        front, rear = mean_line(turning * front_camber, turning * (1.0 - front_camber), transition)
        return ArcOutline(front=front, rear=rear, thickness=thickness, radii=(radii[0], radii[1]))

    def _check_radius(self, name: str, radius: Array | None, thickness: Array) -> None:
        if radius is None or np.all(np.real(radius) < 0.45 * np.real(thickness)):
            return
        raise DesignError(
            f"{name} is {np.max(np.real(radius)):g}: it must be below 0.45 of the thickness, "
            f"{np.min(np.real(thickness)):g}; lower it or raise thickness"
        )


@dataclass(frozen=True, kw_only=True)
class DoubleCircularArc(Arcs):
    """A double-circular-arc profile: mean line, upper and lower side are circular arcs, thickest at mid-chord.

    With edges of equal radius each side is one arc that touches both edges' circles.
    """

    kind: Literal["double-circular-arc"] = "double-circular-arc"
    """which kind of profile this is"""

    def outline(self, span: Span) -> Outline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered."""
        half = np.full(len(span.v), 0.5)
        return self._outline(span, half, half)


@dataclass(frozen=True, kw_only=True)
class MultipleCircularArc(Arcs):
    """A multiple-circular-arc profile: mean line and both sides are each two arcs, tangent at the transition.

    The profile is thickest at the transition, where both sides are parallel to the mean line.
    """

    LIMITS: ClassVar = {
        **Arcs.LIMITS,
        "transition": (0.1, 0.9, "the transition must lie above 0.1 and below 0.9 of the mean line"),
        "front_camber": (-2.0, 3.0, "the front's share of the camber must lie between -2 and 3"),
    }

    kind: Literal["multiple-circular-arc"] = "multiple-circular-arc"
    """which kind of profile this is"""
    transition: Law = parameter("-")
    """where the arcs meet, of the mean line's length [-]"""
    front_camber: Law = parameter("-")
    """the front arc's share of the camber angle [-]"""

    def outline(self, span: Span) -> Outline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered."""
        return self._outline(span, span.values(self.transition), span.values(self.front_camber))


def mean_line(front_turning: Array, rear_turning: Array, transition: Array) -> tuple[Arc, Arc]:
    """Two tangent arcs from (0, 0) to (1, 0) that turn by given angles (...) [rad], their lengths split as asked."""
    share, front_turning, rear_turning = np.broadcast_arrays(transition, front_turning, rear_turning)
    ahead = np.stack([np.ones_like(share), np.zeros_like(share)], axis=-1)
    first = Arc(start=0.0 * ahead, direction=ahead, length=share, turning=front_turning)
    second = Arc(start=first.end, direction=first.end_direction, length=1.0 - share, turning=rear_turning)
    chord = length(second.end)
    # the way to the end, mirrored: it turns the chord line onto the axis
    cosine, sine = (second.end[..., k] / chord for k in (0, 1))

    def laid(arc: Arc) -> Arc:
        start, direction = (
            cosine[..., None] * each - sine[..., None] * turned_left(each) for each in (arc.start, arc.direction)
        )
        return Arc(start=start / chord[..., None], direction=direction, length=arc.length / chord, turning=arc.turning)

    return laid(first), laid(second)
