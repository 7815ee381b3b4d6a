"""The quartic B-spline thickness of 18 control points, closed around both edges.

One uniform quartic B-spline of 14 segments runs from the trailing edge along one side to the leading edge and back
along the other. The sides mirror each other, so eleven control points a side suffice, the first two mirrored. The
segments are the natural parameter, s = segment / 7, and three derivatives are continuous everywhere.
Reference: Nemnem et al. 2014, ASAT-16-142-PP, "Airfoil thickness distributions"; the conditions as in T-Blade3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bladewright.designs import Law, Limits, parameter
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, radians
from bladewright.numerics.roots import bracketed_root
from bladewright.numerics.solving import solved
from bladewright.nurbs.basis import Reals
from bladewright.section import checks
from bladewright.section.chord_map import Breakpoint
from bladewright.section.chord_spline import QUARTIC, segments
from bladewright.section.laws import Span
from bladewright.section.outline import Joint
from bladewright.section.power_series import Series, joined_series, polynomial, variable
from bladewright.section.thickness.law import EDGE, MAXIMUM, MAXIMUM_AT, POSITIVE, EdgeKind, Thickness, ThicknessLaw
from bladewright.section.thickness.piecewise import check_positive

SEGMENTS = 7
"""segments of the spline from the leading to the trailing edge (Nemnem et al. 2014)"""
CONTROLS = SEGMENTS + 4
"""control points of one side, the first two mirrored"""
CURVATURE = 0.04
"""second derivative of u by segments at the leading edge where the design gives none: that of T-Blade3 [chords]"""
WEDGE = 2.5
"""angle of a side from the chord line at a sharp trailing edge where the design gives none: that of T-Blade3 [deg]"""


def value_at(coefficients: Array, tau: Array) -> tuple[Array, Array]:
    """Values and slopes (..., k) at tau (..., k), counted in segments, of polynomials (..., n, 5)."""
    shape = np.broadcast_shapes(coefficients.shape[:-2], tau.shape[:-1])
    index = np.clip(np.floor(np.real(tau)), 0, coefficients.shape[-2] - 1).astype(np.intp)
    index = np.broadcast_to(index, (*shape, tau.shape[-1]))
    spread = np.broadcast_to(coefficients, (*shape, *coefficients.shape[-2:]))
    chosen = np.take_along_axis(spread, index[..., None], axis=-2)
    local, value, slope = tau - index, chosen[..., 4], 4.0 * chosen[..., 4]
    for power in (3, 2, 1, 0):
        value = value * local + chosen[..., power]
        slope = slope * local + power * chosen[..., power] if power else slope
    return value, slope


def parameter_of(coefficients: Array, values: Array, low: float, high: float) -> Array:
    """The tau (..., k) between low and high where rising polynomials (..., n, 5) have values (..., k)."""
    shape = np.broadcast_shapes((*coefficients.shape[:-2], 1), values.shape)

    def function(tau: Array) -> tuple[Array, Array]:
        value, slope = value_at(coefficients, tau)
        return value - values, slope

    return bracketed_root(function, np.full(shape, low), np.full(shape, high))


class UniformThickness(Thickness):
    """Control points (..., m, n) of chord fraction and half thickness from the leading to the trailing edge."""

    def __init__(self, u: Array, half: Array, *, leading: EdgeKind, trailing: EdgeKind) -> None:
        self._u, self._half = segments(u), segments(half)
        self._leading, self._trailing = leading, trailing
        if leading == "round":
            # even and odd about the edge to the bit, so that nothing cancels near it
            self._u[..., 0, [0, 1, 3]] = 0.0
            self._half[..., 0, [0, 2]] = 0.0

    @property
    def joints(self) -> tuple[Joint, ...]:
        count = self._count
        return tuple(Joint(k / count, 3) for k in range(1, count))

    @property
    def leading(self) -> EdgeKind:
        return self._leading

    @property
    def trailing(self) -> EdgeKind:
        return self._trailing

    @property
    def _count(self) -> int:
        return int(self._u.shape[-2])

    def series(self, s: Reals, order: int) -> tuple[Series, Series]:
        tau = s * self._count
        owner = np.clip(np.floor(tau), 0, self._count - 1).astype(np.intp)
        u: list[Series] = []
        half: list[Series] = []
        for k in np.unique(owner):
            local = variable(tau[owner == k] - k, order, float(self._count))
            for parts, all_segments in ((u, self._u), (half, self._half)):
                parts.append(polynomial([all_segments[..., k, power, None] for power in range(5)], local))
        return joined_series(u), joined_series(half)

    def with_breakpoints(self, further: Sequence[Breakpoint]) -> Thickness:  # noqa: ARG002 - always refused
        raise DesignError(
            "camber is mixed, thickness.law is quartic-spline: the kinks of a mixed camber line need a thickness in "
            "pieces; set camber to curvature, or take another thickness law"
        )

    def half_at(self, u: Reals) -> Array:
        return value_at(self._half, parameter_of(self._u, u, 0.0, float(self._count)))[0]

    def check(self, path: str, span: Span) -> None:
        """Refuse a chord fraction that falls and a thickness that is not positive; raises DesignError."""
        s = np.linspace(0.0, 1.0, 20 * self._count + 1)[1:-1]
        u, slope = (np.real(each) for each in self.series(s, 1)[0].coefficients)
        if not np.all(slope > 0.0):
            worst = np.unravel_index(np.argmin(slope), slope.shape)
            place = span.v[worst[-2]] if slope.shape[-2] == len(span.v) else span.v[0]
            raise DesignError(
                f"{path} folds back at u = {u[worst]:.3g}, span fraction {place:.4g}: its spline must run forwards; "
                f"put the maximum near 0.3 of the chord, where this law works, or take another law"
            )
        check_positive(self, path, span)


NOT_NEGATIVE = Limits(0.0, float("inf"), "it must not be negative", closed=True)
WEDGE_ANGLE = Limits(0.0, 90.0, "it must be between 0 and 90 deg")


@dataclass(frozen=True, kw_only=True)
class QuarticSpline(ThicknessLaw):
    """Quartic B-spline thickness through leading edge, maximum and trailing edge; thicknesses are full ones, in chords.

    Three derivatives by s are continuous all along and around the leading edge. A closed trailing edge has the ordinate
    growing first, almost a blunt one; a sharp one is a wedge.
    """

    law: Literal["quartic-spline"] = "quartic-spline"
    """which thickness law this is"""
    maximum_thickness: Law = parameter("-", limits=MAXIMUM)
    """thickness at its maximum, of the chord [-]"""
    maximum_thickness_at: Law = parameter("-", limits=MAXIMUM_AT)
    """place of the maximum, of the chord [-]"""
    leading_edge_thickness: Law = parameter("-", limits=EDGE)
    """thickness at the end of the first segment from the leading edge, of the chord [-]"""
    trailing_edge_thickness: Law = parameter("-", limits=EDGE)
    """thickness at the start of the last segment before the trailing edge, of the chord [-]"""
    leading_edge_curvature: Law = parameter("-", limits=POSITIVE, default=CURVATURE)
    """second derivative of u by segments at the leading edge: the larger, the rounder [-]"""
    trailing_edge_curvature: Law | None = parameter("-", limits=NOT_NEGATIVE, default=None)
    """the same at a closed trailing edge, forwards; none: 0, a flat end [-]"""
    trailing_edge_wedge_angle: Law | None = parameter("deg", limits=WEDGE_ANGLE, default=None)
    """angle of each side from the chord line at a sharp trailing edge; none: 2.5 [deg]"""
    trailing_edge: Literal["closed", "sharp"] = "closed"
    """shape of the trailing edge"""

    def __post_init__(self) -> None:
        checks.choice(f"{self.path}.law", self.law, ["quartic-spline"])
        checks.choice(f"{self.path}.trailing_edge", self.trailing_edge, ["closed", "sharp"])
        checks.parameters(self, f"{self.path}.")
        closed = self.trailing_edge == "closed"
        name, other = ("trailing_edge_curvature", "trailing_edge_wedge_angle")[:: 1 if closed else -1]
        if getattr(self, other) is not None:
            raise DesignError(
                f"{self.path}.{other} is given, but the trailing edge is {self.trailing_edge}: leave it out"
            )
        if getattr(self, name) is None:
            object.__setattr__(self, name, 0.0 if closed else WEDGE)

    def control_points(self, span: Span) -> tuple[Array, Array]:
        """Control points (..., m, 11) of one side, chord fractions and half thicknesses, leading to trailing edge."""
        maximum, at = 0.5 * span.values(self.maximum_thickness), span.values(self.maximum_thickness_at)
        leading, trailing = (
            0.5 * span.values(getattr(self, f"{end}_edge_thickness")) for end in ("leading", "trailing")
        )
        for name, value in (("leading", leading), ("trailing", trailing)):
            cure = "it must be below the maximum thickness; lower it or raise maximum_thickness"
            met = np.real(value) < np.real(maximum)
            self._require(met, span, f"{name}_edge_thickness", 2.0 * value, cure)
        zero, one = np.zeros(1), np.ones(1)
        curvature = span.values(self.leading_edge_curvature)
        if self.trailing_edge_wedge_angle is not None:
            last = 1.0 - trailing / np.tan(radians(span.values(self.trailing_edge_wedge_angle)))
            cure = "the wedge must begin behind the maximum; widen trailing_edge_wedge_angle or thin the trailing edge"
            self._require(np.real(last) > np.real(at), span, "trailing_edge_thickness", 2.0 * trailing, cure)
            edge = [zero, last]
        else:
            edge = [zero, -span.values(0.0 if self.trailing_edge_curvature is None else self.trailing_edge_curvature)]
        closed = self.trailing_edge == "closed"
        across = _solution(_conditions_u(closed=closed), [zero, at, one, curvature, *edge, zero, zero, zero], 1.0)
        conditions = _conditions_half(closed=closed)
        up = _solution(conditions, [leading, maximum, trailing, zero, zero, zero, zero, zero, zero], -1.0)
        return across, up

    def at(self, span: Span) -> Thickness:
        kind: Literal["round", "sharp"] = "round" if self.trailing_edge == "closed" else "sharp"
        thickness = UniformThickness(*self.control_points(span), leading="round", trailing=kind)
        thickness.check(self.path, span)
        return thickness


def _row(derivative: int, segment: int, mirror: float) -> Reals:
    """Coefficients (9,) of the unknown control points in a derivative at the start of a segment, 7 being the end."""
    row = np.zeros(CONTROLS)
    if segment == SEGMENTS:
        powers = np.array([_falling(power, derivative) for power in range(5)])
        row[SEGMENTS - 1 :] = powers @ QUARTIC
    else:
        row[segment : segment + 5] = _falling(derivative, derivative) * QUARTIC[derivative]
    row[3] += mirror * row[0]
    row[2] += mirror * row[1]
    return row[2:]


def _falling(power: int, derivative: int) -> float:
    """The derivative of x^power at 1."""
    return float(np.prod(np.arange(power - derivative + 1, power + 1))) if power >= derivative else 0.0


def _conditions_u(*, closed: bool) -> Reals:
    """Matrix (9, 9) of the conditions on the control points' chord fractions."""
    edge = [(1, SEGMENTS), (2, SEGMENTS)] if closed else [(2, 6), (0, 6)]
    rows = [(0, 0), (0, 3), (0, SEGMENTS), (2, 0), *edge, (3, 2), (4, 3), (4, 4)]
    return np.array([_row(derivative, segment, 1.0) for derivative, segment in rows])


def _conditions_half(*, closed: bool) -> Reals:
    """Matrix (9, 9) of the conditions on the control points' half thicknesses."""
    edge = (2, SEGMENTS) if closed else (2, 6)
    rows = [(0, 1), (0, 3), (0, 6), (0, SEGMENTS), edge, (3, SEGMENTS), (4, 1), (1, 3), (3, 5)]
    return np.array([_row(derivative, segment, -1.0) for derivative, segment in rows])


def _solution(matrix: Reals, values: list[Array], mirror: float) -> Array:
    """Control points (..., m, 11), the mirrored ones in front."""
    right = np.stack(np.broadcast_arrays(*values), axis=-1)[..., None]
    found = solved(matrix, right)[..., 0]
    return np.concatenate([mirror * found[..., 1::-1], found], axis=-1)
