"""Wennerstrom's thickness: two cubics that meet at the maximum, between elliptic edges.

In the body, 0 <= z <= 1, the half thickness is y = M + k d^2 / 2 + e d^3 with d = z - z_max, one e in front and one
behind; k is such that the second derivative vanishes at one end of the body. Where an edge is elliptic, an ellipse
tangent to the body is added outside it, and the chord counts from tip to tip.
Reference: Wennerstrom 2000, Design of Highly Loaded Axial-Flow Fans and Compressors; the edges as in T-Blade3.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Literal, NamedTuple

import numpy as np

from bladewright.designs import Law, Limits, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.section import checks
from bladewright.section.chord_map import Breakpoint, ChordMap
from bladewright.section.laws import Span, bounds_of
from bladewright.section.thickness.law import EDGE, MAXIMUM, MAXIMUM_AT, EdgeKind, Thickness, ThicknessLaw, same_law
from bladewright.section.thickness.piecewise import (
    Formula,
    PiecewiseThickness,
    check_positive,
    ellipse,
    polynomial_from,
)

AT_LEADING_EDGE = 0.02
"""sigma of the end of the leading edge's ellipse in the map u(s): its chord fraction in a usual blade, where the map is
then the identity"""
AT_MAXIMUM = 0.4
"""sigma of the place of the maximum: its chord fraction in a usual blade"""
AT_TRAILING_EDGE = 0.99
"""sigma of the start of the trailing edge's ellipse: its chord fraction in a usual blade"""
RATIOS = {"leading_edge": 2.5, "trailing_edge": 1.0}
"""axis along the chord over axis across of elliptic edges where the design gives none: those of T-Blade3 [-]"""

RATIO = Limits(0.0, 100.0, "it must be positive, and below 100; 1 is a circle")

EdgeShape = Literal["elliptic", "blunt", "sharp"]


class _End(NamedTuple):
    """What is added outside an end of the body, in chords of the body (..., m)."""

    length: Array
    """how far the tip lies outside"""
    semi_axis: Array
    height: Array


@dataclass(frozen=True, kw_only=True)
class Wennerstrom(ThicknessLaw):
    """Wennerstrom's cubic thickness with elliptic, circular, blunt or sharp edges; thicknesses are full ones.

    The place of the maximum is measured in the body, between the ellipses.
    """

    law: Literal["wennerstrom"] = "wennerstrom"
    """which thickness law this is"""
    maximum_thickness: Law = parameter("-", limits=MAXIMUM)
    """thickness at its maximum, of the chord [-]"""
    maximum_thickness_at: Law = parameter("-", limits=MAXIMUM_AT)
    """place of the maximum, of the chord without the elliptic edges [-]"""
    leading_edge_thickness: Law | None = parameter("-", limits=EDGE, default=None)
    """thickness where the leading edge begins, of the chord; none: a sharp edge [-]"""
    trailing_edge_thickness: Law | None = parameter("-", limits=EDGE, default=None)
    """thickness where the trailing edge begins, of the chord; none: a sharp edge [-]"""
    leading_edge_ratio: Law | None = parameter("-", limits=RATIO, default=None)
    """axis along the chord over axis across of an elliptic leading edge; none: 2.5; 1 is a circle [-]"""
    trailing_edge_ratio: Law | None = parameter("-", limits=RATIO, default=None)
    """axis along the chord over axis across of an elliptic trailing edge; none: 1, a circle [-]"""
    leading_edge: EdgeShape = "elliptic"
    """shape of the leading edge"""
    trailing_edge: EdgeShape = "elliptic"
    """shape of the trailing edge"""
    straight_end: Literal["farther", "leading", "trailing"] = "farther"
    """the end of the body without curvature: the one farther from the maximum, or always the same"""

    def __post_init__(self) -> None:
        checks.choice(f"{self.path}.law", self.law, ["wennerstrom"])
        checks.choice(f"{self.path}.straight_end", self.straight_end, ["farther", "leading", "trailing"])
        checks.parameters(self, f"{self.path}.")
        for name in ("leading_edge", "trailing_edge"):
            self._check_edge(name)
        if self.straight_end == "farther" and not same_law(self.leading_edge_thickness, self.trailing_edge_thickness):
            before = [bool(np.any(np.real(each) < 0.5)) for each in bounds_of(self.maximum_thickness_at)]
            behind = [bool(np.any(np.real(each) >= 0.5)) for each in bounds_of(self.maximum_thickness_at)]
            if any(before) and any(behind):
                raise DesignError(
                    f"{self.path}.maximum_thickness_at lies on both sides of 0.5: with edges of different thickness "
                    f"the shape would jump where it passes 0.5; set straight_end to leading or trailing"
                )

    def _check_edge(self, name: str) -> None:
        shape, thickness, ratio = (f"{self.path}.{name}{part}" for part in ("", "_thickness", "_ratio"))
        kind = checks.choice(shape, getattr(self, name), ["elliptic", "blunt", "sharp"])
        given = getattr(self, f"{name}_thickness") is not None
        if given == (kind == "sharp"):
            cure = "leave it out" if given else f"give it, or set {name} to sharp"
            raise DesignError(f"{thickness} is {'given' if given else 'not given'}, but {shape} is {kind}: {cure}")
        if getattr(self, f"{name}_ratio") is None:
            if kind == "elliptic":
                object.__setattr__(self, f"{name}_ratio", RATIOS[name])
        elif kind != "elliptic":
            raise DesignError(f"{ratio} is given, but {shape} is {kind}: leave it out, or set {name} to elliptic")

    def at(self, span: Span) -> Thickness:
        maximum, at = 0.5 * span.values(self.maximum_thickness), span.values(self.maximum_thickness_at)
        ends = [self._half(name, span) for name in ("leading_edge", "trailing_edge")]
        drops, lengths = [maximum - end for end in ends], [at, 1.0 - at]
        bend = [-3.0 * drop / length**2 for drop, length in zip(drops, lengths, strict=True)]
        leading = np.real(at) >= 0.5 if self.straight_end == "farther" else np.array(self.straight_end == "leading")
        curvature = np.where(leading, bend[0], bend[1])
        thirds = [(d + 0.5 * curvature * n**2) / n**3 for d, n in zip(drops, lengths, strict=True)]
        slopes = [3.0 * d / n + 0.5 * curvature * n for d, n in zip(drops, lengths, strict=True)]
        names = ("leading_edge", "trailing_edge")
        for name, drop, slope, end in zip(names, drops, slopes, ends, strict=True):
            cure = "the thickness must grow from there to the maximum; lower it or raise maximum_thickness"
            self._require(np.real(drop) > 0.0, span, f"{name}_thickness", 2.0 * end, cure)
            cure = f"the thickness would not grow from the {name} to the maximum; set straight_end to farther"
            self._require(np.real(slope) > 0.0, span, "maximum_thickness_at", at, cure)
        front, rear = (self._end(name, span, e, slope) for name, e, slope in zip(names, ends, slopes, strict=True))
        chord = 1.0 + front.length + rear.length
        middle = (front.length + at) / chord
        breaks = [Breakpoint(middle, (1.0 - at + rear.length) / chord, 2, AT_MAXIMUM)]
        pieces = [
            _cubic(maximum, curvature, thirds[0], middle, chord),
            _cubic(maximum, curvature, -thirds[1], middle, chord),
        ]
        return self._with_edges(span, breaks, pieces, front, rear, chord)

    def _with_edges(
        self, span: Span, breaks: list[Breakpoint], pieces: list[Formula], front: _End, rear: _End, chord: Array
    ) -> Thickness:
        if self.leading_edge == "elliptic":
            first = front.length / chord
            breaks = [Breakpoint(first, 1.0 - first, 1, AT_LEADING_EDGE), *breaks]
            pieces = [ellipse(front.semi_axis / chord, front.height, leading=True), *pieces]
        if self.trailing_edge == "elliptic":
            last = rear.length / chord
            breaks = [*breaks, Breakpoint(1.0 - last, last, 1, AT_TRAILING_EDGE)]
            pieces = [*pieces, ellipse(rear.semi_axis / chord, rear.height, leading=False)]
        leading, trailing = (_kind(shape) for shape in (self.leading_edge, self.trailing_edge))
        chord_map = ChordMap(breaks, leading_round=leading == "round", trailing_round=trailing == "round")
        thickness = PiecewiseThickness(chord_map, pieces, leading=leading, trailing=trailing)
        check_positive(thickness, self.path, span)
        return thickness

    def _half(self, name: str, span: Span) -> Array:
        law: Law | None = getattr(self, f"{name}_thickness")
        return np.zeros(1) if law is None else 0.5 * span.values(law)

    def _end(self, name: str, span: Span, height: Array, slope: Array) -> _End:
        """The ellipse that is tangent to a body of a half thickness and a slope at its end."""
        law: Law | None = getattr(self, f"{name}_ratio")
        if law is None:
            return _End(np.zeros(1), np.zeros(1), np.zeros(1))
        ratio = span.values(law)
        inside = height * slope * ratio**2
        length = np.sqrt(inside**2 + (ratio * height) ** 2) - inside
        return _End(length, inside + length, (inside + length) / ratio)


def _kind(shape: EdgeShape) -> EdgeKind:
    return "round" if shape == "elliptic" else shape


def _cubic(maximum: Array, curvature: Array, third: Array, middle: Array, chord: Array) -> Formula:
    """A cubic of the distance from the maximum, in chords of the body."""
    scaled = (maximum, np.zeros(1), 0.5 * curvature * chord**2, third * chord**3)
    coefficients = [each[..., None] for each in scaled]
    return partial(polynomial_from, coefficients, middle[..., None])
