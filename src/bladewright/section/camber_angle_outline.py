"""Sections on camber lines of given angle: the camber line is an exact integral, the half thickness a NURBS."""

from dataclasses import dataclass
from functools import cached_property
from math import factorial
from typing import Literal

import numpy as np

from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, angle
from bladewright.numerics.quadrature import gauss
from bladewright.numerics.roots import bracketed_root
from bladewright.nurbs.basis import Reals, basis, breaks, uniform_knots
from bladewright.section.family import MeridionalFraction
from bladewright.section.offset import merged_joints
from bladewright.section.outline import Edge, EdgeDerivatives, Joint, Outline
from bladewright.section.power_series import Series, composed, point_derivatives, polynomial, sine_and_cosine, variable

ORDER = 16
"""Gauss points on each panel of the integral of tan(beta): the angle of the chord line is then exact to rounding for
beta from -80 to 80 deg, with 12 points within 3e-12 (design/section_constants.py)"""
CUTS = 6
"""panels between two knots of beta: as many keep 16 points exact to rounding, 4 leave 2e-13
(design/section_constants.py)"""
NODES = 12
"""Chebyshev points in each cell on which fractions of the meridional length are interpolated: 8 are within 2e-15 for a
radius that grows smoothly, and 12 leave room for channels that bend (design/section_constants.py)"""
CELLS = 16
"""equal cells along m' for that interpolation, so that a bend of the channel spoils one of them only"""
SAME_PLACE = 1e-9
"""difference by s below which a joint is at the same place in all sections: above rounding of a root, below any
movement that a design shows [-]"""
STEEPEST = 6.0
"""largest h'' / (2 h') times the width of a piece beside a round edge, h the half thickness, for which s is bent the
other way: the bent parameter is monotone up to 7.3, and at this limit its slope stays above 0.18 [-]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class SplinePieces:
    """Clamped uniform B-splines over [0, 1] of degree 3, or one less than their number of control points."""

    controls: Array
    """(..., n): each section's control points"""

    @cached_property
    def ends(self) -> Reals:
        """Ends (k + 1,) of the k pieces."""
        return breaks(self._knots)

    @cached_property
    def _degree(self) -> int:
        return min(self.controls.shape[-1] - 1, 3)

    @cached_property
    def _knots(self) -> Reals:
        count = self.controls.shape[-1]
        return uniform_knots(count, self._degree) if count > 1 else np.array([0.0, 1.0])

    @cached_property
    def _powers(self) -> list[Array]:
        """Coefficients (..., k) of the powers of the distance from each piece's start."""
        starts, orders = self.ends[:-1], range(self._degree + 1)
        rows = [basis(self._knots, self._degree, starts, order) / factorial(order) for order in orders]
        return [self.controls @ row.T for row in rows]

    def piece(self, at: Array) -> Array:
        """Which piece (...) real parts belong to; those past an end to the end's."""
        return np.clip(np.searchsorted(self.ends, np.real(at), side="right") - 1, 0, len(self.ends) - 2)

    def values(self, at: Series, piece: Array) -> Series:
        """Values at parameters (..., k) that belong to given pieces, (k,) or (..., k)."""
        if piece.ndim == 1:
            taken = [each[..., piece] for each in self._powers]
        else:
            shape = np.broadcast_shapes(piece.shape[:-1], self.controls.shape[:-1])
            index = np.broadcast_to(piece, (*shape, piece.shape[-1]))
            wide = [np.broadcast_to(each, (*shape, each.shape[-1])) for each in self._powers]
            taken = [np.take_along_axis(each, index, axis=-1) for each in wide]
        return polynomial(taken, at - self.ends[piece])


def length_fractions(meridional: MeridionalFraction) -> Array:
    """Chebyshev coefficients (..., CELLS, NODES) of the fraction of the meridional length by that of m', cell by cell.

    The cells are those of the fraction of m'; places may differ from section to section.
    """
    nodes = 0.5 * (1.0 - np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES))
    places = (np.arange(CELLS)[:, None] + nodes) / CELLS
    found = meridional(places.ravel())
    values = found.reshape(*found.shape[:-1], CELLS, NODES)
    return np.asarray(values @ np.linalg.inv(np.polynomial.chebyshev.chebvander(2.0 * nodes - 1.0, NODES - 1)).T)


def _length_fraction(coefficients: Array, place: Series) -> Series:
    """Fractions of the meridional length at fractions of m' (..., k)."""
    cell = np.clip(np.floor(np.real(place.value) * CELLS).astype(int), 0, CELLS - 1)
    shape = np.broadcast_shapes(cell.shape[:-1], coefficients.shape[:-2])
    index = np.broadcast_to(cell, (*shape, cell.shape[-1]))
    table = np.broadcast_to(coefficients, (*shape, *coefficients.shape[-2:]))
    rows = np.take_along_axis(table, index[..., None], axis=-2)
    doubled = (place * float(CELLS) - cell - 0.5) * 4.0
    later, value = place * 0.0, place * 0.0 + rows[..., -1]
    for k in range(NODES - 2, 0, -1):
        value, later = doubled * value - later + rows[..., k], value
    return doubled * 0.5 * value - later + rows[..., 0]


@dataclass(frozen=True, kw_only=True, eq=False)
class CamberByAngle:
    """Camber lines theta(x) of sections (...), x the fraction of m', in units of its extent: theta' = tan(beta)."""

    angle: SplinePieces
    """beta by the fraction of the meridional length [rad]"""
    length_fractions: Array | None
    """of the meridional length by the fraction of m', as the function of that name gives them; None: they are equal"""

    def turning(self, x: Series) -> Series:
        """beta at x (..., k)."""
        length = x if self.length_fractions is None else _length_fraction(self.length_fractions, x)
        return self.angle.values(length, self.angle.piece(length.value))

    def rise(self, x: Series) -> Series:
        """theta at x (..., k)."""
        start = self._integral(x.value)
        if x.order == 0:
            return Series([start])
        sine, cosine = sine_and_cosine(self.turning(variable(x.value, x.order)))
        rate = (sine / cosine).coefficients
        return composed(Series([start, *(each / (k + 1) for k, each in enumerate(rate[: x.order]))]), x)

    @cached_property
    def total(self) -> Array:
        """theta (...) at the trailing edge."""
        return self._known[..., -1]

    @cached_property
    def stagger(self) -> Array:
        """Angle (...) of the chord line [rad]."""
        return angle(self.total, np.ones_like(self.total))

    @cached_property
    def knots(self) -> Reals:
        """x (..., j) of the inner knots of beta."""
        inner = self.angle.ends[1:-1]
        if self.length_fractions is None:
            return np.broadcast_to(inner, (*self.angle.controls.shape[:-1], len(inner)))
        coefficients = self.length_fractions

        def residual(x: Array) -> tuple[Array, Array]:
            found = _length_fraction(coefficients, variable(x, 1))
            return np.real(found.value) - inner, np.real(found.coefficients[1])

        ends = [np.full((*coefficients.shape[:-2], len(inner)), end) for end in (0.0, 1.0)]
        return bracketed_root(residual, *ends)

    @cached_property
    def _ends(self) -> Reals:
        """Ends (..., p + 1) of the panels of the integral."""
        knots = self.knots
        edges = [np.full((*knots.shape[:-1], 1), end) for end in (0.0, 1.0)]
        marks = np.concatenate([edges[0], knots, edges[1]], axis=-1)
        share = np.arange(CUTS) / CUTS
        panels = marks[..., :-1, None] + np.diff(marks, axis=-1)[..., None] * share
        ends = np.concatenate([panels.reshape(*panels.shape[:-2], -1), edges[1]], axis=-1)
        if self.length_fractions is None:
            return ends
        cells = np.broadcast_to(np.arange(1, CELLS) / CELLS, (*ends.shape[:-1], CELLS - 1))
        return np.sort(np.concatenate([ends, cells], axis=-1), axis=-1)

    @cached_property
    def _known(self) -> Array:
        """theta (..., p + 1) at the ends of the panels."""
        steps = self._panel(self._ends[..., :-1], self._ends[..., 1:])
        return np.concatenate([np.zeros_like(steps[..., :1]), np.cumsum(steps, axis=-1)], axis=-1)

    def _integral(self, x: Array) -> Array:
        ends = self._ends
        shape = np.broadcast_shapes(x.shape[:-1], ends.shape[:-1])
        place = np.broadcast_to(np.real(x), (*shape, x.shape[-1]))
        ends = np.broadcast_to(ends, (*shape, ends.shape[-1]))
        panel = np.sum(place[..., None] >= ends[..., None, 1:-1], axis=-1)
        known = self._known
        wide = np.broadcast_shapes(shape, known.shape[:-1])
        index = np.broadcast_to(panel, (*wide, panel.shape[-1]))
        before = np.take_along_axis(np.broadcast_to(known, (*wide, known.shape[-1])), index, axis=-1)
        start = np.take_along_axis(ends, panel, axis=-1)
        return before + self._panel(start, x)

    def _panel(self, start: Array, end: Array) -> Array:
        """Integral (..., k) of tan(beta) from start to end (..., k), between which it is smooth."""
        share, weight = gauss(ORDER)
        start, width = np.broadcast_arrays(start, end - start)
        places = start[..., None] + width[..., None] * share
        turning = self.turning(Series([places.reshape(*places.shape[:-2], -1)])).value
        rates = np.tan(turning)
        parts: Array = rates.reshape(*rates.shape[:-1], -1, ORDER) @ weight
        return parts * width


@dataclass(frozen=True, kw_only=True, eq=False)
class CamberAngleOutline(Outline):
    """Sections (...) whose sides follow the thickness NURBS by its own parameter t.

    Beside a round edge s is bent into t, so that the thickness has no second derivative by s there: then the sides'
    second derivatives are equal.
    """

    line: CamberByAngle
    places: SplinePieces
    """w x of the thickness, x the fraction of m'"""
    heights: SplinePieces
    """w h of the thickness, h the half thickness in chords"""
    weights: SplinePieces
    """w of the thickness"""
    end: Literal["sharp", "blunt", "round"]

    @property
    def leading_edge(self) -> Edge:
        """Round."""
        return self._edge(0.0, "round")

    @property
    def trailing_edge(self) -> Edge:
        """Sharp, blunt or round."""
        return self._edge(1.0, self.end)

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """Knots of the thickness, and those of the camber angle that are at the same s in all sections."""
        found = [Joint(float(each), 2) for each in self.places.ends[1:-1]]
        knots = self.line.knots
        count = knots.shape[-1]
        for j in range(count):
            s = self._where(knots[..., j])
            if np.ptp(s) <= SAME_PLACE:
                found.append(Joint(float(np.mean(s)), 2))
        return merged_joints(found)

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., len(s), 2) of the upper and the lower side."""
        upper, lower = self._sides(s, 0)
        return upper[..., 0], lower[..., 0]

    def camber(self, s: Reals) -> Array:
        """Points (..., len(s), 2) of the camber line."""
        x, _ = self._thickness(s, 0)
        return np.stack(np.broadcast_arrays(*(each.value for each in self._in_chords(x))), axis=-1)

    @property
    def has_exact_derivatives(self) -> bool:
        return True

    def derivatives(self, s: Reals, order: int) -> tuple[Array, Array]:
        """Points and derivatives by s (..., k, 2, order + 1) of both sides, exact."""
        upper, lower = self._sides(s, order)
        return upper, lower

    @property
    def camber_breaks(self) -> Reals:
        """Knots of the camber angle, by the fraction of m'."""
        rows = np.real(self.line.knots)
        return rows[(0,) * (rows.ndim - 1)]

    def camber_derivatives(self, t: Reals, order: int) -> Array:
        """Points and derivatives by the fraction of m' (..., k, 2, order + 1) of the camber line, exact."""
        return point_derivatives(*self._in_chords(variable(t, order)))

    def _sides(self, s: Reals, order: int) -> list[Array]:
        """Points and their derivatives by s, (..., k, 2, order + 1), of both sides."""
        x, height = self._thickness(s, order)
        along, across = self._in_chords(x)
        # beta is smooth by x, but not at a knot that an edge touches: composed there from its own side
        turning = composed(self.line.turning(variable(x.value, order)), x) - self.line.stagger[..., None]
        sine, cosine = sine_and_cosine(turning)
        offset = sine * height, cosine * height
        return [point_derivatives(along - offset[0] * sign, across + offset[1] * sign) for sign in (1.0, -1.0)]

    def _in_chords(self, x: Series) -> tuple[Series, Series]:
        """Camber points at x, turned and scaled so that the chord line runs from (0, 0) to (1, 0)."""
        total = self.line.total[..., None]
        rise = self.line.rise(x)
        square = 1.0 + total * total
        return (x + rise * total) / square, (rise - x * total) / square

    def _thickness(self, s: Reals, order: int) -> tuple[Series, Series]:
        """Fraction x of m' and half thickness [chords] at s (k,), (..., k) each."""
        piece = self.places.piece(s)
        t = self._parameter(s, piece, order)
        weight = self.weights.values(t, piece)
        return self.places.values(t, piece) / weight, self.heights.values(t, piece) / weight

    def _parameter(self, s: Reals, piece: Array, order: int) -> Series:
        """The NURBS's parameter: s, bent in the pieces beside round edges."""
        at = variable(s, order)
        first, last = self._bends
        width = float(self.places.ends[1])
        near = at * (1.0 / width)
        rest = 1.0 - near
        found = at - near * near * rest * rest * rest * (first[..., None] * width) * np.where(piece == 0, 1.0, 0.0)
        if last is None:
            return found
        near = (1.0 - at) * (1.0 / width)
        rest = 1.0 - near
        in_last_piece = np.where(piece == len(self.places.ends) - 2, 1.0, 0.0)
        return found + near * near * rest * rest * rest * (last[..., None] * width) * in_last_piece

    @cached_property
    def _bends(self) -> tuple[Array, Array | None]:
        """h'' / (2 h') times the width of a piece, at the leading and at a round trailing edge (...)."""
        width = float(self.places.ends[1])
        last = self._bend(1.0, -width, "trailing") if self.end == "round" else None
        return self._bend(0.0, width, "leading"), last

    def _bend(self, place: float, width: float, name: str) -> Array:
        at, piece = variable(np.array([place]), 2), self.places.piece(np.array([place]))
        height = self.heights.values(at, piece) / self.weights.values(at, piece)
        bend: Array = (height.coefficients[2] / height.coefficients[1])[..., 0] * width
        if np.any(np.real(bend) > STEEPEST):
            raise DesignError(
                f"half_thickness rises beside the {name} edge to {2.0 * np.max(np.real(bend)) + 3.0:.3g} times its "
                f"value at the edge: at most {2.0 * STEEPEST + 3.0:g} times; raise the value at the edge"
            )
        return bend

    def _where(self, x: Reals) -> Reals:
        """s (...) of real fractions (...) of m'."""
        shape = np.broadcast_shapes(x.shape, self.places.controls.shape[:-1], self._bends[0].shape)
        own = np.arange(int(np.prod(shape)))

        def residual(s: Array) -> tuple[Array, Array]:
            found, _ = self._thickness(s, 1)
            rows = [np.broadcast_to(np.real(each), (*shape, len(s))).reshape(-1, len(s)) for each in found.coefficients]
            # each section at its own s
            return rows[0][own, own] - np.broadcast_to(x, shape).ravel(), rows[1][own, own]

        return bracketed_root(residual, np.zeros(len(own)), np.ones(len(own))).reshape(shape)

    def _edge(self, s: float, kind: Literal["sharp", "blunt", "round"]) -> Edge:
        upper, lower = (EdgeDerivatives.of_side(side) for side in self._sides(np.array([s]), 2))
        return Edge(kind=kind, upper=upper, lower=lower)
