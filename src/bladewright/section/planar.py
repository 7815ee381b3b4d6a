"""2D designs of the families that are one part: the part's section laid in the plane (x, y)."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import Any, Literal, Protocol, get_args, get_type_hints

import numpy as np

from bladewright.designs import Design, Part, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, angle, frozen
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.transform import transformed
from bladewright.section import checks
from bladewright.section.crossing import check_outline, closed_outlines, touching
from bladewright.section.laws import Span
from bladewright.section.limits import check_labels
from bladewright.section.meanline import Meanline
from bladewright.section.native import SectionKnots, knots_for, native_curves
from bladewright.section.outline import Outline
from bladewright.section.section import Section


class Family(Protocol):
    """A family's part: its sections along a span, each number of it a law."""

    def outline(self, span: Span) -> Outline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered."""
        ...

    def stagger(self, span: Span) -> Array:
        """Angles (..., m) of the chord lines [rad]."""
        ...


@dataclass(frozen=True, kw_only=True)
class PlanarSection(Design):
    """Base of the 2D designs that hold a family's part; each has a final subclass that says of which family."""

    name: str
    """the part's name, used in files"""
    length_unit: Literal["m", "cm", "mm", "um", "in", "ft"]
    """unit of every length in the design"""
    chord: float = parameter("length")
    """distance from the leading to the trailing edge [length]"""
    pitch: float | None = parameter("length", default=None)
    """tangential distance of neighbours; none: a single section [length]"""
    leading_edge_x: float = parameter("length", default=0.0)
    """axial position of the leading edge [length]"""
    leading_edge_y: float = parameter("length", default=0.0)
    """tangential position of the leading edge [length]"""
    section: Any
    """the family's parameters, each a number"""
    span: float | None = parameter("length", default=None)
    """height of the prismatic blade that the section becomes as a solid; none: a section only [length]"""
    tolerance: float = 1e-10
    """distance of the native curves from the exact section, of the chord [-]"""
    description: str = ""
    """one line for the header of CAD files"""
    author: str = ""
    """for the header of CAD files"""
    organisation: str = ""
    """for the header of CAD files"""

    def __post_init__(self) -> None:
        check_labels(self)
        for name in ("chord", "pitch", "leading_edge_x", "leading_edge_y", "span"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, checks.number(name, getattr(self, name)))
        for name in ("chord", "pitch", "span"):
            if getattr(self, name) is not None:
                checks.between(name, getattr(self, name), 0.0, float("inf"), "it must be positive")
        checks.between("tolerance", self.tolerance, 1e-13, 1e-2, "it must lie above 1e-13 and below 0.01")
        if not isinstance(self.section, Part):
            raise DesignError(f"section is {self.section!r}: the family's parameters are needed")
        _check_plain(self.section, "section")

    def build(self, knots: SectionKnots | None = None) -> Section:
        """The section in metres and radians; raises DesignError where the shape is impossible.

        `knots` are those to hold, a section's own `knots`.
        """
        family: Family = self.section
        span, metre = Span(np.zeros(1)), checks.UNITS[self.length_unit]
        outline = family.outline(span)
        turn = family.stagger(span)[..., 0]
        check_outline(outline, [""])
        chord = self.chord * metre
        rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        if self.pitch is not None:
            self._check_pitch(closed_outlines(outline) @ np.real(rotation).T, self.pitch)
        knots = knots_for(outline, self.tolerance) if knots is None else knots
        upper, lower, camber = native_curves(outline, knots=knots)
        shift = np.array([self.leading_edge_x * metre, self.leading_edge_y * metre])
        sides = {"upper": upper, "lower": lower, **_faces(outline, upper, lower)}
        curves = {name: transformed(curve, chord * rotation, shift) for name, curve in sides.items()}
        line = transformed(camber, chord * rotation, shift)
        slope = line.derivative(np.array([0.0, 1.0]))
        metal = np.real(angle(slope[:, 1], slope[:, 0]))
        meanline = getattr(family, "meanline", None)
        return Section(
            span=0.0,
            plane="x-y",
            curves=MappingProxyType(curves),
            camber=line,
            stagger=float(np.real(turn)),
            metal_angle_in=float(metal[0]),
            metal_angle_out=float(metal[1]),
            scale=np.ones_like,
            edges=(outline.leading_edge.kind, outline.trailing_edge.kind),
            knots=knots,
            meanline=None if meanline is None else _single_meanline(meanline(span)),
        )

    def _check_pitch(self, outlines: Reals, pitch: float) -> None:
        """Refuse a pitch at which neighbours (m, n, 2) in chords meet."""
        if touching(outlines, float(np.real(pitch)) / float(np.real(self.chord))) is not None:
            raise DesignError(f"pitch is {pitch:g}: neighbouring sections intersect; take a larger pitch")


def _single_meanline(line: Meanline) -> Callable[[Array], tuple[Array, Array, Array]]:
    """v and its first two derivatives (k,) by u (k,) of the first of meanlines (m,)."""

    def derivatives(u: Array) -> tuple[Array, Array, Array]:
        value, slope, bend, _ = line.derivatives(u)
        return value[..., 0, :], slope[..., 0, :], bend[..., 0, :]

    return derivatives


def _check_plain(part: Part, path: str) -> None:
    """Refuse laws along the span, which a single section has no use for."""
    hints = get_type_hints(type(part))
    for each in fields(part):
        name, value = each.name, getattr(part, each.name)
        if isinstance(value, Part):
            _check_plain(value, f"{path}.{name}")
        if not isinstance(value, tuple) or "unit" not in each.metadata:
            continue
        single = float in get_args(hints[name])
        for where, item in [(name, value)] if single else [(f"{name}[{i}]", item) for i, item in enumerate(value)]:
            if isinstance(item, tuple):
                raise DesignError(f"{path}.{where} is a list: a law along the span; a single section takes a number")


def _faces(outline: Outline, upper: Curve, lower: Curve) -> dict[str, Curve]:
    """The straight faces of blunt edges, each from the upper to the lower side."""
    faces = {}
    for i, edge in enumerate((outline.leading_edge, outline.trailing_edge)):
        if edge.kind == "blunt":
            ends = frozen(np.stack([upper.control_points[-i], lower.control_points[-i]]))
            knots = np.array([0.0, 0.0, 1.0, 1.0])
            faces[("leading_edge", "trailing_edge")[i]] = Curve(control_points=ends, knots=knots, degree=1)
    return faces
