"""Camber lines by the angle along them: an exact integral in the conformal plane."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.numerics.elementary import Array, angle
from bladewright.numerics.quadrature import gauss
from bladewright.numerics.roots import bracketed_root
from bladewright.nurbs.basis import Reals
from bladewright.section.profiles.analytic import composed, waves
from bladewright.section.spline_pieces import SplinePieces
from bladewright.section.thickness.series import Series, variable

Meridional = Callable[[Reals], Array]
"""Fractions (..., m, k) of the meridional length at fractions (k,) of m', of each of the m stream surfaces"""

ORDER = 16
"""Gauss points on each panel"""
CUTS = 6
"""panels between two knots of the angle"""
NODES, CELLS = 12, 16
"""Chebyshev points in each of the equal cells on which fractions of the meridional length are interpolated"""


class Fraction:
    """Fractions of the meridional length by fractions of m', at places that differ from section to section."""

    def __init__(self, meridional: Meridional) -> None:
        nodes = 0.5 * (1.0 - np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES))
        places = (np.arange(CELLS)[:, None] + nodes) / CELLS
        found = meridional(places.ravel())
        values = found.reshape(*found.shape[:-1], CELLS, NODES)
        self._powers = values @ np.linalg.inv(np.polynomial.chebyshev.chebvander(2.0 * nodes - 1.0, NODES - 1)).T

    def at(self, place: Series) -> Series:
        """Fractions of the length at fractions of m' (..., k)."""
        cell = np.clip(np.floor(np.real(place.value) * CELLS).astype(int), 0, CELLS - 1)
        shape = np.broadcast_shapes(cell.shape[:-1], self._powers.shape[:-2])
        index = np.broadcast_to(cell, (*shape, cell.shape[-1]))
        table = np.broadcast_to(self._powers, (*shape, *self._powers.shape[-2:]))
        rows = np.take_along_axis(table, index[..., None], axis=-2)
        twice = (place * float(CELLS) - cell - 0.5) * 4.0
        later, value = place * 0.0, place * 0.0 + rows[..., -1]
        for k in range(NODES - 2, 0, -1):
            value, later = twice * value - later + rows[..., k], value
        return twice * 0.5 * value - later + rows[..., 0]


@dataclass(frozen=True, kw_only=True, eq=False)
class AngleLine:
    """Camber lines theta(x) of sections (...), x the fraction of m', in units of its extent: theta' = tan(beta)."""

    angle: SplinePieces
    """beta by the fraction of the meridional length [rad]"""
    fraction: Fraction | None
    """None: the fraction of m' is that of the length"""

    def turning(self, x: Series) -> Series:
        """beta at x (..., k)."""
        length = x if self.fraction is None else self.fraction.at(x)
        return self.angle.values(length, self.angle.piece(length.value))

    def rise(self, x: Series) -> Series:
        """theta at x (..., k)."""
        start = self._integral(x.value)
        if x.order == 0:
            return Series([start])
        sine, cosine = waves(self.turning(variable(x.value, x.order)))
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
        if self.fraction is None:
            return np.broadcast_to(inner, (*self.angle.controls.shape[:-1], len(inner)))
        fraction = self.fraction

        def off(x: Array) -> tuple[Array, Array]:
            found = fraction.at(variable(x, 1))
            return np.real(found.value) - inner, np.real(found.coefficients[1])

        count = fraction.at(Series([np.zeros(1)])).value.shape[:-1]
        ends = [np.full((*count, len(inner)), end) for end in (0.0, 1.0)]
        return bracketed_root(off, *ends)

    @cached_property
    def _ends(self) -> Reals:
        """Ends (..., p + 1) of the panels of the integral."""
        knots = self.knots
        edges = [np.full((*knots.shape[:-1], 1), end) for end in (0.0, 1.0)]
        marks = np.concatenate([edges[0], knots, edges[1]], axis=-1)
        share = np.arange(CUTS) / CUTS
        panels = marks[..., :-1, None] + np.diff(marks, axis=-1)[..., None] * share
        ends = np.concatenate([panels.reshape(*panels.shape[:-2], -1), edges[1]], axis=-1)
        if self.fraction is None:
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
