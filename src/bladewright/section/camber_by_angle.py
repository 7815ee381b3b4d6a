"""Camber lines of given angle along the meridional length: exact integrals, whose imaginary parts are carried along."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import factorial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from bladewright.numerics.elementary import Array, angle
from bladewright.numerics.quadrature import gauss
from bladewright.numerics.roots import bracketed_root
from bladewright.nurbs.basis import Reals, basis, breaks, uniform_knots
from bladewright.section.family import MeridionalFraction
from bladewright.section.power_series import Series, composed, polynomial, sine_and_cosine, variable

Number = TypeVar("Number", Array, Series)

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

    def piece(self, at: Array) -> NDArray[np.intp]:
        """Which piece (...) real parts belong to; those past an end to the end's."""
        return np.clip(np.searchsorted(self.ends, np.real(at), side="right") - 1, 0, len(self.ends) - 2)

    def values(self, at: Series, piece: NDArray[np.intp]) -> Series:
        """Values at parameters (..., k) that belong to given pieces, (k,) or (..., k)."""
        return polynomial(self.powers_of(piece), at - self.ends[piece])

    def powers_of(self, piece: NDArray[np.intp]) -> list[Array]:
        """Coefficients (..., k) of the powers of the distance from the start of pieces (k,) or (..., k)."""
        if piece.ndim == 1:
            return [each[..., piece] for each in self._powers]
        return [_chosen(each[..., None], piece)[..., 0] for each in self._powers]


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
    cell = _cell_of(place.value)
    rows = _chosen(coefficients, cell)
    return _chebyshev_sum([rows[..., k] for k in range(NODES)], _in_cell(place, cell))


def _cell_of(place: Array) -> NDArray[np.intp]:
    """The cells (...) in which fractions of m' lie."""
    return np.clip(np.floor(np.real(place) * CELLS).astype(int), 0, CELLS - 1)


def _in_cell(place: Number, cell: NDArray[np.intp]) -> Number:
    """Twice the argument, from -1 to 1, of the Chebyshev polynomials of a cell."""
    return (place * float(CELLS) - cell - 0.5) * 4.0


def _chebyshev_sum(rows: Sequence[Array], doubled: Number) -> Number:
    """Sum of Chebyshev polynomials at half an argument by Clenshaw's recurrence, in their order (NODES,)."""
    later, value = doubled * 0.0, doubled * 0.0 + rows[-1]
    for k in range(NODES - 2, 0, -1):
        value, later = doubled * value - later + rows[k], value
    return doubled * 0.5 * value - later + rows[0]


def _chosen(table: Array, index: NDArray[np.intp]) -> Array:
    """Rows (..., m, k, c) of tables (..., m, q, c), each section's at its own places (..., m, k)."""
    if index.ndim == 2 and len(index) == table.shape[-3]:
        return table[..., np.arange(len(index))[:, None], index, :]
    shape = np.broadcast_shapes(index.shape[:-1], table.shape[:-2])
    at = np.broadcast_to(index, (*shape, index.shape[-1]))
    return np.take_along_axis(np.broadcast_to(table, (*shape, *table.shape[-2:])), at[..., None], axis=-2)


def _without_batch(values: Array, axes: int) -> Reals:
    """Real parts of values without the leading axes, before so many last ones, along which they do not change."""
    real = np.real(values)
    first = real[(0,) * (real.ndim - axes)]
    return first if np.array_equal(real, np.broadcast_to(first, real.shape)) else real


@dataclass(frozen=True, kw_only=True, eq=False)
class CamberByAngle:
    """Camber lines theta(x) of sections (...), x the fraction of m', in units of its extent: theta' = tan(beta).

    Imaginary parts are carried to first order: what is integrated is evaluated once, for the real sections.
    """

    angle: SplinePieces
    """beta by the fraction of the meridional length [rad]"""
    length_fractions: Array | None
    """of the meridional length by the fraction of m', as the function of that name gives them; None: they are equal"""

    def turning(self, x: Series) -> Series:
        """beta at x (..., k)."""
        if x.order == 0 and (self._real is not self or np.iscomplexobj(x.value)):
            at = _without_batch(x.value, 2)
            found, slope = self._real.turning(variable(at, 1)).coefficients
            carried = slope * np.imag(x.value) + _Rows(line=self._real, places=at[..., None]).carried(
                self, np.ones((*at.shape, 1))
            )
            return Series([found + 1j * carried])
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
        coefficients = _without_batch(self.length_fractions, 3)

        def residual(x: Array) -> tuple[Array, Array]:
            found = _length_fraction(coefficients, variable(x, 1))
            return found.value - inner, found.coefficients[1]

        ends = [np.full((*coefficients.shape[:-2], len(inner)), end) for end in (0.0, 1.0)]
        return bracketed_root(residual, *ends)

    @cached_property
    def _real(self) -> "CamberByAngle":
        """The real sections; the same where nothing is complex."""
        fractions = self.length_fractions
        if not any(np.iscomplexobj(each) for each in (self.angle.controls, fractions) if each is not None):
            return self
        return CamberByAngle(
            angle=SplinePieces(controls=_without_batch(self.angle.controls, 2)),
            length_fractions=None if fractions is None else _without_batch(fractions, 3),
        )

    @cached_property
    def _ends(self) -> Reals:
        """Ends (..., p + 1) of the panels of the integral, each within one piece of beta and one cell."""
        knots = self._real.knots
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
        ends, place = self._ends, _without_batch(x, 2) if np.iscomplexobj(x) else x
        shape = np.broadcast_shapes(place.shape[:-1], ends.shape[:-1])
        place = np.broadcast_to(place, (*shape, x.shape[-1]))
        ends = np.broadcast_to(ends, (*shape, ends.shape[-1]))
        panel = np.sum(place[..., None] >= ends[..., None, 1:-1], axis=-1)
        start = np.take_along_axis(ends, panel, axis=-1)
        found = _chosen(self._known[..., None], panel)[..., 0] + self._panel(start, place)
        if not np.iscomplexobj(x):
            return found
        return found + 1j * np.tan(self._real.turning(Series([place])).value) * np.imag(x)

    def _panel(self, start: Reals, end: Reals) -> Array:
        """Integral (..., k) of tan(beta) from start to end (..., k), between which it is smooth."""
        share, weight = gauss(ORDER)
        start, width = np.broadcast_arrays(start, end - start)
        at = _Rows(line=self._real, places=start[..., None] + width[..., None] * share)
        rates = np.tan(at.beta)
        found: Array = (rates @ weight) * width
        if self._real is self:
            return found
        return found + 1j * at.carried(self, (1.0 + rates**2) * weight * width[..., None])


@dataclass(frozen=True, kw_only=True, eq=False)
class _Rows:
    """Places (..., k, g) on camber lines, g beside each other within one piece of beta and one cell."""

    line: CamberByAngle
    """real"""
    places: Reals

    @cached_property
    def beta(self) -> Reals:
        """beta (..., k, g) [rad]."""
        return self._by_length(0)

    def carried(self, line: CamberByAngle, factor: Reals) -> Reals:
        """Imaginary part (..., k) of the sum over g of factors (..., k, g) times beta of a line with this real part."""
        found: Array = np.zeros(())
        if np.iscomplexobj(line.angle.controls):
            power = factor
            for each in SplinePieces(controls=np.imag(line.angle.controls)).powers_of(self._piece):
                found = found + each * np.sum(power, axis=-1)
                power = power * self._beyond
        if line.length_fractions is not None and np.iscomplexobj(line.length_fractions):
            factor, doubled = factor * self._by_length(1), self._doubled
            before, now = 0.5 * doubled, np.ones_like(doubled)
            sums = []
            for _ in range(NODES):
                sums.append(np.sum(factor * now, axis=-1))
                before, now = now, doubled * now - before
            rows = _chosen(np.imag(line.length_fractions), self._cell)
            found = found + np.einsum("...c,...c->...", rows, np.stack(sums, axis=-1))
        return found

    def _by_length(self, order: int) -> Reals:
        """beta, or its derivative by the fraction of the length, (..., k, g)."""
        powers = [each[..., None] for each in self.line.angle.powers_of(self._piece)]
        for _ in range(order):
            powers = [i * each for i, each in enumerate(powers)][1:] or [np.zeros_like(powers[0])]
        found = powers[-1] + np.zeros_like(self._beyond) if len(powers) == 1 else powers[-1]
        for each in reversed(powers[:-1]):
            found = found * self._beyond + each
        return found

    @cached_property
    def _cell(self) -> NDArray[np.intp]:
        return _cell_of(self.places[..., self.places.shape[-1] // 2])

    @cached_property
    def _doubled(self) -> Reals:
        return _in_cell(self.places, self._cell[..., None])

    @cached_property
    def _lengths(self) -> Reals:
        if self.line.length_fractions is None:
            return self.places
        rows = _chosen(self.line.length_fractions, self._cell)
        return _chebyshev_sum([rows[..., k, None] for k in range(NODES)], self._doubled)

    @cached_property
    def _piece(self) -> NDArray[np.intp]:
        return self.line.angle.piece(self._lengths[..., self.places.shape[-1] // 2])

    @cached_property
    def _beyond(self) -> Reals:
        """Fraction of the length beyond the start of the piece."""
        return self._lengths - self.line.angle.ends[self._piece][..., None]
