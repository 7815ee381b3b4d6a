"""How smooth a section is: curvature and its slope along sides and camber line, and their jumps at every joint.

The slope is the derivative of the curvature by arc length. All is taken from exact derivatives, in the section's plane
and in chords; values on both sides of a joint are those of the two pieces that meet there.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bladewright.numerics.elementary import Array, cross2, cumulative_length, dot, length
from bladewright.nurbs.basis import Reals, breaks
from bladewright.nurbs.curve import Curve
from bladewright.section.outline import Outline
from bladewright.section.section import Section

JOINT_OFFSET = 1e-9
"""distance by the parameter of the first place of a piece from its joint: above what joints may be off by [-]"""
PER_PIECE = 48
"""places on a piece besides those close to its ends: enough for the largest curvature and for plots"""
SAME = 1e-6
"""jump of the curvature, of the larger value beside the joint, below which it counts as continuous: a hundred times the
1e-8 that rounding leaves (design/section_constants.py) [-]"""
STEADY = 1e-4
"""jump of the slope, of the square of the curvature beside the joint or of one chord's, below which it counts as
continuous: above the rounding of third derivatives on arcs a hundredth of a chord long [-]"""


@dataclass(frozen=True, kw_only=True)
class Jump:
    """A joint of a line with what it has on both sides."""

    place: str
    """"joint", "leading_edge" or "trailing_edge" """
    at: float
    """part of the line's arc from the leading edge [-]"""
    curvature: tuple[float, float]
    """before and behind, by arc, positive where the line turns to the left [1 / chord]"""
    slope: tuple[float, float]
    """d curvature / d arc, before and behind [1 / chord^2]"""

    @property
    def of_curvature(self) -> float:
        """Size of the curvature's jump [1 / chord]."""
        return float(np.max(np.ptp(self.curvature)))

    @property
    def of_slope(self) -> float:
        """Size of the slope's jump [1 / chord^2]."""
        return float(np.max(np.ptp(self.slope)))

    @property
    def discontinuous(self) -> tuple[bool, bool]:
        """Whether curvature and slope differ on both sides by more than rounding."""
        bend = _largest(np.array([1.0, *self.curvature]))
        rounding = max(SAME * _largest(np.array(self.slope)), STEADY * bend * bend)
        return self.of_curvature > SAME * bend, self.of_slope > rounding

    @property
    def continuous(self) -> tuple[bool, bool]:
        """Whether curvature and slope are continuous; where the curvature jumps there is no slope either."""
        bend, slope = self.discontinuous
        return not bend, not (bend or slope)


@dataclass(frozen=True, kw_only=True, eq=False)
class SmoothLine:
    """A side or the camber line, from the leading to the trailing edge."""

    name: str
    """"upper", "lower" or "camber" """
    arc: Reals
    """(n,) part of the arc; each joint occurs twice [-]"""
    curvature: Reals
    """(n,) positive where the line turns to the left [1 / chord]"""
    slope: Reals
    """(n,) d curvature / d arc [1 / chord^2]"""
    jumps: tuple[Jump, ...]
    """at every joint; at round edges too, from the lower side to the upper one, both listed with the upper side"""

    @property
    def curvature_jump(self) -> float:
        """Largest jump of the curvature, of its largest value on the line; those within rounding are none [-]."""
        return _share([jump.of_curvature for jump in self.jumps if jump.discontinuous[0]], self.curvature)

    @property
    def slope_jump(self) -> float:
        """Largest jump of the slope, of its largest value on the line; those within rounding are none [-]."""
        return _share([jump.of_slope for jump in self.jumps if jump.discontinuous[1]], self.slope)

    @property
    def continuous(self) -> tuple[bool, bool]:
        """Whether curvature and slope are continuous at every joint."""
        return all(jump.continuous[0] for jump in self.jumps), all(jump.continuous[1] for jump in self.jumps)


@dataclass(frozen=True, kw_only=True, eq=False)
class Smoothness:
    """Curvature, its slope, and the jumps of both along a section's lines."""

    upper: SmoothLine
    lower: SmoothLine
    camber: SmoothLine

    @property
    def lines(self) -> tuple[SmoothLine, ...]:
        """Upper side, lower side, camber line."""
        return self.upper, self.lower, self.camber

    def to_dict(self) -> dict[str, object]:
        """The figures, for JSON; curvature in 1 / chord, its slope in 1 / chord^2."""
        return {
            line.name: {
                "curvature_continuous": line.continuous[0],
                "slope_continuous": line.continuous[1],
                "largest_curvature": _largest(line.curvature),
                "largest_slope": _largest(line.slope),
                "curvature_jump_of_largest": line.curvature_jump,
                "slope_jump_of_largest": line.slope_jump,
                "joints": [
                    {
                        "place": jump.place,
                        "at": jump.at,
                        "curvature": list(jump.curvature),
                        "slope": list(jump.slope),
                    }
                    for jump in line.jumps
                ],
            }
            for line in self.lines
        }


def smoothness(section: Section) -> Smoothness:
    """The smoothness of a native section, on its exact outline where it has one, else on its own curves.

    Lengths are in chords of its plane.
    """
    return _of_curves(section) if section.outline is None else outline_smoothness(section.outline)


def outline_smoothness(outline: Outline) -> Smoothness:
    """The smoothness of one section, an outline of shape () or (1,)."""
    at = _places(outline.breaks)
    sides = outline.derivatives(at, 3)
    upper, lower = (
        _line(name, side, len(outline.breaks)) for name, side in zip(("upper", "lower"), sides, strict=True)
    )
    breaks_of_camber = outline.camber_breaks
    camber = _line("camber", outline.camber_derivatives(_places(breaks_of_camber), 3), len(breaks_of_camber))
    return _meeting(upper, lower, camber, (outline.leading_edge.kind, outline.trailing_edge.kind))


def _of_curves(section: Section) -> Smoothness:
    chord = length(np.real(section.camber.control_points[-1] - section.camber.control_points[0]))

    def line(name: str, curve: Curve) -> SmoothLine:
        inner = breaks(curve.knots)[1:-1]
        at = _places(inner)
        rows = [np.real(curve.derivative(at, order)) / chord for order in range(4)]
        return _line(name, np.stack(rows, axis=-1), len(inner))

    return _meeting(
        line("upper", section.curves["upper"]),
        line("lower", section.curves["lower"]),
        line("camber", section.camber),
        section.edges,
    )


def _places(joints: Reals) -> Reals:
    """Parameters on the pieces between joints (j,) in [0, 1], `PER_PIECE` of each and two close to either end."""
    inner = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, PER_PIECE + 2)[1:-1])) / 2.0
    close = JOINT_OFFSET * np.array([1.0, 2.0])
    found = [
        np.concatenate([low + close, low + (high - low) * inner, high - close[::-1]])
        for low, high in pairwise([0.0, *joints, 1.0])
    ]
    found[0][0], found[-1][-1] = 0.0, 1.0
    return np.concatenate(found)


def _line(name: str, derivatives: Array, joints: int) -> SmoothLine:
    """The line of points with three derivatives (k, 2, 4), or (1, k, 2, 4), at `_places`."""
    rows = np.real(derivatives[0] if derivatives.ndim == 4 else derivatives)
    point, speed, bend, twist = (rows[..., order] for order in range(4))
    size = length(speed)
    turning = cross2(speed, bend)
    curvature = turning / size**3
    slope = (cross2(speed, twist) / size**3 - 3.0 * turning * dot(speed, bend) / size**5) / size
    arc = cumulative_length(point)
    arc = arc / arc[-1]

    def one_sided(values: Reals, behind: int) -> tuple[float, float]:
        """Values of both pieces at a joint, in front of the place `behind`, in line with those close to it."""
        before = 2.0 * values[behind - 1] - values[behind - 2]
        return float(before), float(2.0 * values[behind] - values[behind + 1])

    jumps = tuple(
        Jump(place="joint", at=float(arc[k]), curvature=one_sided(curvature, k), slope=one_sided(slope, k))
        for k in range(PER_PIECE + 4, (joints + 1) * (PER_PIECE + 4), PER_PIECE + 4)
    )
    return SmoothLine(name=name, arc=arc, curvature=curvature, slope=slope, jumps=jumps)


def _meeting(upper: SmoothLine, lower: SmoothLine, camber: SmoothLine, kinds: tuple[str, str]) -> Smoothness:
    """The lines with the round edges among the joints of the upper side."""
    found = list(upper.jumps)
    for end, (kind, place) in enumerate(zip(kinds, ("leading_edge", "trailing_edge"), strict=True)):
        if kind != "round":
            continue
        # by the arc around the edge the lower side is passed backwards: its curvature changes sign, its slope does not
        i = -end
        below = (-float(lower.curvature[i]), float(lower.slope[i]))
        above = (float(upper.curvature[i]), float(upper.slope[i]))
        before, behind = (above, below) if end else (below, above)
        found.append(Jump(place=place, at=float(end), curvature=(before[0], behind[0]), slope=(before[1], behind[1])))
    ordered = tuple(sorted(found, key=lambda jump: jump.at))
    whole = SmoothLine(name="upper", arc=upper.arc, curvature=upper.curvature, slope=upper.slope, jumps=ordered)
    return Smoothness(upper=whole, lower=lower, camber=camber)


def _largest(values: Reals) -> float:
    return float(np.max(np.sqrt(values * values)))


def _share(jumps: list[float], values: Reals) -> float:
    largest = _largest(values)
    return max(jumps, default=0.0) / largest if largest > 0.0 else 0.0
