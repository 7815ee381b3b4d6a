"""The modified NACA four-digit thickness with a circular trailing edge.

Front: t = a0 sqrt(u) + a1 u + a2 u^2 + a3 u^3 up to the maximum, with its radius at the leading edge; rear: a cubic
from the maximum to the trailing edge with a given slope there, second derivative continuous at the maximum.
Reference: Stack and von Doenhoff 1934, NACA report 492; the circle and the slope as in T-Blade3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from bladewright.designs import Law, Limits, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.section import checks
from bladewright.section.chord_map import Breakpoint, ChordMap, ChordPlace
from bladewright.section.laws import Span
from bladewright.section.power_series import Series, polynomial
from bladewright.section.thickness.law import EDGE, MAXIMUM, MAXIMUM_AT, POSITIVE, EdgeKind, Thickness, ThicknessLaw
from bladewright.section.thickness.piecewise import (
    Formula,
    PiecewiseThickness,
    check_positive,
    ellipse,
    polynomial_from,
)

RADIUS = 2.2038
"""twice the leading edge radius of index 6 over the square of the maximum thickness, 2 x 1.1019 (Stack and von Doenhoff
1934) [1/chord]"""
SLOPES = (0.775, 2.51666667, -13.625, 35.83333333, -12.5)
"""slope at the trailing edge, downwards, of the maximum thickness: the polynomial in the place of the maximum through
1, 1.17, 1.575, 2.325, 3.5 of the NACA series at 0.2, 0.3 ... 0.6, in T-Blade3's decimals (151/60 and 215/6)"""
AT_MAXIMUM = 0.4
"""sigma of the place of the maximum in the map u(s): its chord fraction in a usual blade, where the map is then the
identity"""
AT_TRAILING_EDGE = 0.99
"""sigma of the place where the trailing edge's circle begins: its chord fraction in a usual blade [-]"""

INDEX = Limits(0.0, 12.0, "it must be between 0 and 12; 6 is the radius of the NACA series")
SLOPE = Limits(-float("inf"), 0.0, "the blade must not grow thicker towards the edge: negative, or 0", closed=True)


@dataclass(frozen=True, kw_only=True)
class ModifiedNaca(ThicknessLaw):
    """Modified NACA four-digit thickness: thicknesses are full ones, in chords."""

    law: Literal["modified-naca"] = "modified-naca"
    """which thickness law this is"""
    leading_edge_index: Law = parameter("-", limits=INDEX, default=6.0)
    """radius of the leading edge: 1.1019 (maximum_thickness index / 6)^2 chords [-]"""
    maximum_thickness: Law = parameter("-", limits=MAXIMUM)
    """thickness at its maximum, of the chord [-]"""
    maximum_thickness_at: Law = parameter("-", limits=MAXIMUM_AT)
    """place of the maximum, of the chord [-]"""
    trailing_edge_thickness: Law | None = parameter("-", limits=EDGE, default=None)
    """thickness where the trailing edge's circle begins, or of the blunt edge, of the chord; none: a sharp edge [-]"""
    trailing_edge_slope: Law | None = parameter("-", limits=SLOPE, default=None)
    """slope d(half thickness)/du at the trailing edge, negative or 0; none: that of the NACA series [-]"""
    trailing_edge_slope_factor: Law | None = parameter("-", limits=POSITIVE, default=None)
    """slope at the trailing edge in place of the former, downwards, of the maximum thickness [-]"""
    trailing_edge: Literal["circular", "blunt", "sharp"] = "circular"
    """shape of the trailing edge"""

    def __post_init__(self) -> None:
        checks.choice(f"{self.path}.law", self.law, ["modified-naca"])
        checks.choice(f"{self.path}.trailing_edge", self.trailing_edge, ["circular", "blunt", "sharp"])
        checks.parameters(self, f"{self.path}.")
        sharp = self.trailing_edge == "sharp"
        if (self.trailing_edge_thickness is None) != sharp:
            cure = "leave it out" if sharp else "give it, or set trailing_edge to sharp"
            given = "given" if sharp else "not given"
            message = f"{self.path}.trailing_edge_thickness is {given} for a {self.trailing_edge} trailing edge: {cure}"
            raise DesignError(message)
        if self.trailing_edge_slope is not None and self.trailing_edge_slope_factor is not None:
            names = f"{self.path}.trailing_edge_slope and trailing_edge_slope_factor"
            raise DesignError(f"{names} are both given: they say the same; leave one out")

    def slope(self, span: Span) -> Array:
        """d(half thickness)/du (..., m) at the trailing edge."""
        if self.trailing_edge_slope is not None:
            return span.values(self.trailing_edge_slope)
        maximum, at = span.values(self.maximum_thickness), span.values(self.maximum_thickness_at)
        if self.trailing_edge_slope_factor is not None:
            return -maximum * span.values(self.trailing_edge_slope_factor)
        factor = SLOPES[0] + at * (SLOPES[1] + at * (SLOPES[2] + at * (SLOPES[3] + at * SLOPES[4])))
        return -maximum * factor

    def at(self, span: Span) -> Thickness:
        maximum, at = 0.5 * span.values(self.maximum_thickness), span.values(self.maximum_thickness_at)
        slope = self.slope(span)
        end, edge = np.zeros(1), np.zeros(1)
        if self.trailing_edge_thickness is not None:
            end = 0.5 * span.values(self.trailing_edge_thickness)
            cure = "it must be below the maximum thickness; lower it or raise maximum_thickness"
            self._require(np.real(end) < np.real(maximum), span, "trailing_edge_thickness", 2.0 * end, cure)
        breaks = [Breakpoint(at, 1.0 - at, 2, AT_MAXIMUM)]
        pieces: list[Formula] = []
        if self.trailing_edge == "circular":
            steepness = np.sqrt(1.0 + slope**2)
            edge, radius = end / (steepness - slope), end * steepness
            cure = "the maximum must stand before the trailing edge's circle; move it forward or thin the trailing edge"
            self._require(np.real(at + edge) < 1.0, span, "maximum_thickness_at", at, cure)
            breaks.append(Breakpoint(1.0 - edge, edge, 1, AT_TRAILING_EDGE))
            pieces.append(ellipse(radius, radius, leading=False))
        rear, curvature = _rear(maximum, at, end, edge, slope)
        cure = "the rear would bulge instead; move it forward, thin the trailing edge or give it a flatter slope"
        self._require(np.real(curvature) < 0.0, span, "maximum_thickness_at", at, cure)
        front, bend = _front(maximum, at, curvature, span.values(self.leading_edge_index))
        kind: EdgeKind = "round" if self.trailing_edge == "circular" else self.trailing_edge
        chord_map = ChordMap(breaks, leading_round=True, trailing_round=kind == "round", bend=bend)
        thickness = PiecewiseThickness(chord_map, [front, rear, *pieces], leading="round", trailing=kind)
        check_positive(thickness, self.path, span)
        return thickness


def _rear(maximum: Array, at: Array, end: Array, edge: Array, slope: Array) -> tuple[Formula, Array]:
    """The cubic from the maximum to the trailing edge, level at first, and its second derivative at the maximum."""
    length = 1.0 - at - edge
    secant = (end - maximum) / length
    second, third = (3.0 * secant - slope) / length, (slope - 2.0 * secant) / length**2
    coefficients = [each[..., None] for each in (maximum, np.zeros(1), second, third)]
    return partial(polynomial_from, coefficients, at[..., None]), 2.0 * second


def _front(maximum: Array, at: Array, curvature: Array, index: Array) -> tuple[Formula, Array]:
    """The radius and the cubic up to the maximum, with value, slope 0 and second derivative there; and a1 / a0."""
    root = np.sqrt(RADIUS) * 2.0 * maximum * index / 6.0
    # what the polynomial must be at the maximum: value / at, slope and at * second derivative
    value = (maximum - root * np.sqrt(at)) / at
    slope = -0.5 * root / np.sqrt(at)
    bend = (curvature + 0.25 * root / at**1.5) * at
    first, second, third = (
        3.0 * value - 2.0 * slope + 0.5 * bend,
        -3.0 * value + 3.0 * slope - bend,
        value - slope + 0.5 * bend,
    )
    coefficients = [each[..., None] for each in (first, second / at, third / at**2)]
    return partial(_root_and_polynomial, root[..., None], coefficients), first / root


def _root_and_polynomial(root: Array, coefficients: Sequence[Array], place: ChordPlace) -> Series:
    return root * place.leading_root() + place.u * polynomial(coefficients, place.u)
