"""What a segmented airfoil is given by: its nose, the joints at its cuts, its segments, and its morph."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from bladewright.designs import ChordwiseLaw, Law, Limits, Part, parameter
from bladewright.errors import DesignError
from bladewright.section import checks

ANGLE = Limits(-90.0, 90.0, "an angle must lie between -90 and 90 deg")
RADIUS = Limits(0.0, 10.0, "a radius must lie above 0 and below 10 chords")
CURVATURE = Limits(-1e4, 1e4, "a curvature must lie between -1e4 and 1e4 over the chord")
POSITION = Limits(-10.0, 10.0, "it must lie between -10 and 10 chords")
OFFSET = Limits(0.0, 0.5, "an offset must lie from 0 to half the chord", closed=True)
CHANGE = Limits(-20.0, 20.0, "a change of a scale factor must lie between -20 and 20")
SCALE = Limits(0.0, 20.0, "a scale factor must lie above 0 and below 20")


@dataclass(frozen=True, kw_only=True)
class Nose(Part):
    """How both sides meet at the leading edge, as continuous as what is given: angle and radius C2, an angle C1."""

    inline: ClassVar[bool] = True

    angle: Law | None = parameter("deg", limits=ANGLE, default=None)
    """direction of the camber line at the leading edge, square to the outline there, from the chord line; none: a
    corner [deg]"""
    radius: Law | None = parameter("-", limits=RADIUS, default=None)
    """radius of the leading edge, of the chord; none: the curvature jumps there [-]"""

    def __post_init__(self) -> None:
        checks.parameters(self)
        _check_continuity("radius", self.radius, self.angle)

    @property
    def continuity(self) -> int:
        """How many derivatives of the outline are continuous."""
        return (self.angle is not None) + (self.radius is not None)


@dataclass(frozen=True, kw_only=True)
class SegmentJoint(Part):
    """A side where two of its segments meet, as continuous as what is given: angle and curvature C2, an angle C1."""

    inline: ClassVar[bool] = True

    height: Law = parameter("-", limits=POSITION)
    """ordinate of the joint, of the chord [-]"""
    angle: Law | None = parameter("deg", limits=ANGLE, default=None)
    """angle of the side from the chord line, towards the trailing edge; none: a corner [deg]"""
    curvature: Law | None = parameter("-", limits=CURVATURE, default=None)
    """curvature times the chord, positive where the side turns to the left on its way to the trailing edge; none: it
    jumps there [-]"""

    def __post_init__(self) -> None:
        checks.parameters(self)
        _check_continuity("curvature", self.curvature, self.angle)

    @property
    def continuity(self) -> int:
        """How many derivatives of the side are continuous."""
        return (self.angle is not None) + (self.curvature is not None)


@dataclass(frozen=True, kw_only=True)
class Skin(Part):
    """Changes of a segment's scale factors and inner control points, within a band about the segment without them.

    Tangent and curvature at the joints stay as they are.
    """

    inline: ClassVar[bool] = True

    inner: Law = parameter("-", limits=OFFSET)
    """how far the skin may lie inside that of the segment without its changes, of the chord [-]"""
    outer: Law = parameter("-", limits=OFFSET)
    """how far it may lie outside, of the chord [-]"""
    abscissas: ChordwiseLaw = parameter("-", limits=POSITION, default=())
    """what is added to those of the inner control points; none: nothing [-]"""
    ordinates: ChordwiseLaw = parameter("-", limits=POSITION, default=())
    """what is added to those of the inner control points; none: nothing [-]"""
    front_scale: Law | None = parameter("-", limits=CHANGE, default=None)
    """what is added to the scale factor towards the leading edge; none: nothing [-]"""
    rear_scale: Law | None = parameter("-", limits=CHANGE, default=None)
    """what is added to the scale factor towards the trailing edge; none: nothing [-]"""

    def __post_init__(self) -> None:
        checks.parameters(self)


@dataclass(frozen=True, kw_only=True)
class Segment(Part):
    """A uniform cubic B-spline by its inner control points; those at its ends follow from its joints."""

    inline: ClassVar[bool] = True

    abscissas: ChordwiseLaw = parameter("-", limits=POSITION)
    """of the inner control points, from the leading to the trailing edge, of the chord [-]"""
    ordinates: ChordwiseLaw = parameter("-", limits=POSITION)
    """of the inner control points, of the chord [-]"""
    front_scale: Law | None = parameter("-", limits=SCALE, default=None)
    """scale factor SF of the tangent vector at the end towards the leading edge, SF^2 that of the curvature vector: the
    curve's speed there over its joints' distance; none: 1 [-]"""
    rear_scale: Law | None = parameter("-", limits=SCALE, default=None)
    """the same at the end towards the trailing edge; none: 1 [-]"""
    skin: Skin | None = None
    """how the skin morphs within its band; none: not at all"""

    def __post_init__(self) -> None:
        checks.parameters(self)
        if len(self.abscissas) != len(self.ordinates):
            raise DesignError(
                f"abscissas has {len(self.abscissas)} entries and ordinates {len(self.ordinates)}: give each inner "
                "control point both"
            )
        if self.skin is not None:
            for name in ("abscissas", "ordinates"):
                given = len(getattr(self.skin, name))
                if given not in (0, len(self.abscissas)):
                    raise DesignError(
                        f"skin.{name} has {given} entries for {len(self.abscissas)} inner control points: give one for "
                        "each, or none"
                    )


@dataclass(frozen=True, kw_only=True)
class AirfoilSide(Part):
    """The upper or the lower side: its joints at the two cuts, and the segments before, between and behind them."""

    front_joint: SegmentJoint
    """where the leading edge's segment meets the central box's"""
    rear_joint: SegmentJoint
    """where the central box's segment meets the trailing edge's"""
    leading_edge: Segment
    """from the nose to the front joint"""
    central_box: Segment
    """from the front to the rear joint"""
    trailing_edge: Segment
    """from the rear joint to the end of the side"""


@dataclass(frozen=True, kw_only=True)
class Morph(Part):
    """Turns of leading and trailing edge about the middles of their cuts; the central box stays where it is.

    The three control points at a cut that keep its curvature (two that keep its tangent, one at a corner) stay as well,
    the others turn.
    """

    inline: ClassVar[bool] = True

    leading_edge: Law = parameter("deg", limits=ANGLE, default=0.0)
    """angle of the leading edge, counter-clockwise with the nose at the left: positive droops [deg]"""
    trailing_edge: Law = parameter("deg", limits=ANGLE, default=0.0)
    """angle of the trailing edge, counter-clockwise: negative is a flap down [deg]"""

    def __post_init__(self) -> None:
        checks.parameters(self)


def _check_continuity(name: str, bend: Law | None, angle: Law | None) -> None:
    if bend is not None and angle is None:
        raise DesignError(f"{name} is given without angle: a curvature needs a tangent; give angle")
