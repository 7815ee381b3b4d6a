"""Stream lines as polynomials on panels of u: position, length or m' along them, and the inverse of these."""

from dataclasses import dataclass, replace
from functools import cached_property
from math import perm
from typing import Protocol

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from bladewright.blade.flow_path.stream_surface_map import StreamSurfaceMap
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, length
from bladewright.nurbs.basis import Reals

NODES = 24
"""Chebyshev nodes of the density da/du on a panel. Panels are halved until the series ends in rounding, so more
nodes mean fewer and dearer panels."""
ROUNDING = 3e-16
"""Share of the largest term of a density's series, below which its last terms are left out: where curves with many
knots make many panels, the series end early."""
PIECES = 16
"""About how many pieces a stream line has, whose cubics give Newton's method its start: so many that two steps do."""
CONVERGED = 3e-8
"""Newton step in u at which the iteration ends: the error left is its square, which is rounding."""


class MeridionalChannel(Protocol):
    """A channel or flow path whose stream lines are piecewise polynomials of one parameter u."""

    def joints(self) -> Reals:
        """Where a stream line loses derivatives."""

    def stream_polynomials(self, v: Reals, centres: Reals) -> Array:
        """Coefficients (..., len(v), len(centres), k, 2) of (x, r) in powers of u - centre, around each centre."""


Panel = int | NDArray[np.intp]
"""the panel of all points by its number, or that of each point (..., m, k)"""


@dataclass(frozen=True, kw_only=True)
class StreamLines:
    """Stream lines (..., m) at m places along the span, as polynomials on panels of u."""

    mapping: StreamSurfaceMap
    panels: Reals
    """(p + 1,) ends of the panels in u; 0 and 1 are among them"""
    powers: Array
    """(..., m, p, k, 2) coefficients of (x, r) in powers of u - panel centre"""
    density: Array
    """(..., m, p, NODES) Chebyshev series of the density da/du on each panel"""
    series: Array
    """(..., m, p, NODES + 1) Chebyshev series of the abscissa a(u) on each panel, 0 at its start"""
    starts: Array
    """(..., m, p + 1) the abscissa at the ends of the panels, 0 at u = 0"""
    lengths: Array
    """(..., m) meridional length between u = 0 and u = 1 [m]"""

    def position(self, u: Array, order: int = 0) -> Array:
        """(x, r) or derivatives by u (..., m, k, 2) at u (..., m, k) or (k,)."""
        return _points(*self._polynomials(u), order)

    @cached_property
    def ends(self) -> tuple[Array, Array]:
        """(x, r) and its derivative by u (..., m, 2, 2) at u = 0 and u = 1."""
        both = np.array([0.0, 1.0])
        return self.position(both), self.position(both, 1)

    def densities(self, u: Array) -> tuple[Array, Array]:
        """da/du and d2a/du2 (..., m, k) at u (..., m, k) or (k,)."""
        polynomials = self._polynomials(u)
        position, slope, bend = (_points(*polynomials, order) for order in range(3))
        return self.mapping.density(position, slope), self.mapping.density_slope(position, slope, bend)

    def _polynomials(self, u: Array) -> tuple[Array, Array]:
        """Coefficients (n, 2, ..., m, k) of (x, r) at u (..., m, k) or (k,), and the powers' base (..., m, k) there."""
        panel = self._panel(u)
        u = np.broadcast_to(u, np.broadcast_shapes((*self.starts.shape[:-1], 1), np.shape(u)))
        rows = _rows_of(self.powers.reshape(*self.powers.shape[:-2], -1), panel)
        batch = (1,) * (u.ndim + 1 - rows.ndim)
        return rows.reshape(-1, 2, *batch, *rows.shape[1:]), u - (self.panels[panel] + self.panels[panel + 1]) / 2.0

    def rows(self, which: list[int]) -> "StreamLines":
        """Some of the stream lines, by their number along the span."""
        return StreamLines(
            mapping=self.mapping,
            panels=self.panels,
            powers=self.powers[..., which, :, :, :],
            density=self.density[..., which, :, :],
            series=self.series[..., which, :, :],
            starts=self.starts[..., which, :],
            lengths=self.lengths[..., which],
        )

    def extents(self) -> Array:
        """(..., m) extent of the stream lines in their plane: the abscissa at u = 1."""
        return self.starts[..., int(np.searchsorted(self.panels, 1.0))]

    def abscissa(self, u: Array) -> Array:
        """The abscissa (..., m, k) in the plane at u (..., m, k) or (k,)."""
        panel = self._panel(u)
        u = np.broadcast_to(u, np.broadcast_shapes((*self.starts.shape[:-1], 1), np.shape(u)))
        return _clenshaw(_rows_of(self.series, panel), self._local(panel, u)) + _of(self.starts, panel)

    def u_at(self, abscissa: Array) -> Array:
        """u (..., m, k) at an abscissa (..., m, k): Newton in real numbers, its derivative by one more complex step."""
        real = np.real(abscissa)
        if not (np.iscomplexobj(abscissa) or np.iscomplexobj(self.series)):
            return self._inverse(real)
        lines = self.real()
        u = lines.u_at(real[(0,) * (real.ndim - 2)])
        moved = -np.imag(abscissa)
        if np.iscomplexobj(self.series):
            moved = moved + lines.batched_abscissa(u, np.imag(self.series), np.imag(self.starts))
        return u - 1j * moved / lines.rate(u)

    def rate(self, u: Array) -> Array:
        """da/du (..., m, k) at u (..., m, k), by its series."""
        panel = self._panel(u)
        return _clenshaw(_rows_of(self.density, panel), self._local(panel, u))

    def batched_abscissa(self, u: Reals, series: Reals, starts: Reals) -> Reals:
        """The abscissa (..., m, k) at u (m, k) that a batch of series (..., m, p, n) and starts (..., m, p + 1) gives.

        All are evaluated at the same u, so that each stream line is one product with Chebyshev polynomials.
        """
        index, count = self._panels_of(u), series.shape[-1]
        own = chebyshev.chebvander(self._local(index, u), count - 1)
        polynomials = np.zeros((*u.shape, len(self.panels) - 1, count))
        np.put_along_axis(polynomials, index[..., None, None], own[..., None, :], axis=-2)
        batch = np.moveaxis(series.reshape(-1, len(u), polynomials.shape[-2] * count), 0, -1)
        found = np.moveaxis(polynomials.reshape(*u.shape, -1) @ batch, -1, 0)
        return found.reshape(*series.shape[:-3], *u.shape) + _of(starts, index)

    def _inverse(self, abscissa: Reals) -> Reals:
        # far outside the panels the series' rounding grows beyond their values
        beside = 0.5 * np.diff(self.panels)
        low, high = self.panels[0] - beside[0], self.panels[-1] + beside[-1]
        u = np.clip(self._guess(abscissa), low, high)
        for _ in range(30):
            panel = self._panel(u)
            local = self._local(panel, u)
            with np.errstate(all="ignore"):  # where it diverges
                miss = _clenshaw(_rows_of(self.series, panel), local) + _of(self.starts, panel) - abscissa
                step = miss / _clenshaw(_rows_of(self.density, panel), local)
                u = np.clip(u - step, low, high)
            if np.max(np.abs(step), initial=0.0) < CONVERGED:  # real: a stopping rule
                return u
        raise DesignError(
            "channel: the meridional length along a stream line cannot be inverted, so its control points "
            "make it turn back; spread the inner control points of hub and shroud"
        )

    def _guess(self, abscissa: Reals) -> Reals:
        """u (m, k) by cubics that have the abscissa and its slope at the ends of pieces of the panels."""
        x = np.linspace(-1.0, 1.0, 1 + max(1, PIECES // (len(self.panels) - 1)))
        places = _clenshaw(_first(self.series)[..., None], x) + self.starts[..., :-1, None]
        rates = _clenshaw(_first(self.density)[..., None], x)
        of_pieces = places[..., :-1], np.diff(places), rates[..., :-1], rates[..., 1:]
        starts, extents, firsts, lasts = (each.reshape(*each.shape[:-2], -1) for each in of_pieces)
        widths = np.repeat(np.diff(self.panels), len(x) - 1) / (len(x) - 1)
        piece = _shared(np.sum(abscissa[..., None] >= starts[..., None, 1:], axis=-1))
        start, extent, first, last = (_of(each, piece) for each in (starts, extents, firsts, lasts))
        low, width = (self.panels[0] + np.cumsum(widths) - widths)[piece], widths[piece]
        t = (abscissa - start) / extent
        return low + width * t + t * (1.0 - t) * ((1.0 - t) * (extent / first - width) - t * (extent / last - width))

    def trimmed(self) -> "StreamLines":
        """The same without the last terms of the series that are rounding, also in the derivatives that are carried."""
        sizes = [np.max(np.abs(part), axis=(-3, -2)) for part in (self.density.real, self.density.imag)]  # real: parts
        count = max(_significant(size) for size in sizes)
        return replace(self, density=self.density[..., :count], series=self.series[..., : count + 1])

    def real(self) -> "StreamLines":
        """The same without imaginary parts and batch."""
        first = (0,) * (self.series.ndim - 3)
        return StreamLines(
            mapping=self.mapping,
            panels=self.panels,
            powers=np.real(self.powers[(0,) * (self.powers.ndim - 4)]),
            density=np.real(self.density[first]),
            series=np.real(self.series[first]),
            starts=np.real(self.starts[first]),
            lengths=np.real(self.lengths[first]),
        )

    def _local(self, panel: Panel, u: Array) -> Array:
        low, high = self.panels[panel], self.panels[panel + 1]
        return (2.0 * u - low - high) / (high - low)

    def _panels_of(self, u: Array) -> NDArray[np.intp]:
        """The panels of points (..., m, k)."""
        return _shared(np.searchsorted(self.panels[1:-1], np.real(u), side="right"))

    def _panel(self, u: Array) -> Panel:
        """The panels of points (..., m, k) or (k,)."""
        index = self._panels_of(u)
        first = int(index.flat[0]) if index.size else 0
        if not np.any(index != first):
            return first
        return index if index.ndim > 1 else np.broadcast_to(index, (self.starts.shape[-2], len(index)))


def stream_lines(
    channel: MeridionalChannel, mapping: StreamSurfaceMap, v: Array, before: float, after: float
) -> StreamLines:
    """Stream lines at v (m,), continued by `before` and `after` in u.

    The densities' Chebyshev series are carried to rounding: panels are halved until their last terms vanish.
    Raises DesignError where the channel cannot be continued: r or the speed along a stream line vanishes.
    """
    joints = channel.joints()
    joints = joints[(joints > -before) & (joints < 1.0 + after)]
    ends = np.unique(np.concatenate([[-before, 0.0], joints, [1.0, 1.0 + after]]))
    for _ in range(6):
        lines, tail = _on_panels(channel, mapping, v, ends)
        poor = tail > 1e-13
        if not np.any(poor):
            break
        middles = ((ends[:-1] + ends[1:]) / 2.0)[poor]
        ends = np.sort(np.concatenate([ends, middles]))
    return lines.trimmed()


def _on_panels(
    channel: MeridionalChannel, mapping: StreamSurfaceMap, v: Array, ends: Reals
) -> tuple[StreamLines, Reals]:
    centres, halves = (ends[:-1] + ends[1:]) / 2.0, (ends[1:] - ends[:-1]) / 2.0
    powers = channel.stream_polynomials(v, centres)
    t = halves[:, None] * _NODE_PLACES
    vander = t[..., None] ** np.arange(powers.shape[-2])
    position = vander @ powers
    slope_powers = powers[..., 1:, :] * np.arange(1, powers.shape[-2])[:, None]
    slope = vander[..., :-1] @ slope_powers
    if mapping.revolved and np.min(position[..., 1].real) <= 0.0:
        where = np.argwhere(position[..., 1].real <= 0.0)[0]
        u = float(centres[where[-2]] + t[where[-2], where[-1]])
        raise DesignError(
            f"channel: radius {position[..., 1].real[tuple(where)]:.4g} m at u = {u:.3f}, v = {v[where[-3]]:.3f}: "
            "the channel, continued past its edges over the nose, must keep clear of the axis; move its control points"
        )
    speeds = length(slope)
    density = mapping.density(position, slope)
    coefficients = np.einsum("jk,...k->...j", _TO_SERIES, density)
    axes = tuple(range(coefficients.ndim - 2))
    shares = np.max(np.abs(coefficients.real), axis=axes) / np.max(np.abs(density.real))  # real: a stopping rule
    tail = np.max(shares[:, -2:], axis=-1)
    series = np.einsum("jk,...k->...j", _INTEGRATED, coefficients) * halves[:, None]
    increments = np.sum(series, axis=-1)
    starts = np.concatenate([np.zeros_like(increments[..., :1]), np.cumsum(increments, axis=-1)], axis=-1)
    zero, one = (int(np.searchsorted(ends, place)) for place in (0.0, 1.0))
    starts = starts - starts[..., zero : zero + 1]
    by_length = np.einsum("jk,...k->...j", _INTEGRATED @ _TO_SERIES, speeds) * halves[:, None]
    lengths = np.sum(np.sum(by_length, axis=-1)[..., zero:one], axis=-1)
    lines = StreamLines(
        mapping=mapping,
        panels=ends,
        powers=powers,
        density=coefficients,
        series=series,
        starts=starts,
        lengths=lengths,
    )
    return lines, tail


def _significant(sizes: Reals) -> int:
    """Number of terms up to the last that is more than rounding in any of the series of sizes (..., n)."""
    return 1 + int(np.max(np.nonzero(sizes > ROUNDING * np.max(sizes, axis=-1, keepdims=True))[-1], initial=0))


def _of(values: Array, panel: Panel) -> Array:
    """Values (..., m, p) of a panel as (..., m, 1), or of each point's panel as (..., m, k)."""
    return _rows_of(values[..., None], panel)[0]


def _rows_of(coefficients: Array, panel: Panel) -> Array:
    """Coefficients (..., m, p, n) of a panel as (n, ..., m, 1), or of each point's panel as (n, ..., m, k)."""
    first = _first(coefficients)
    if isinstance(panel, int):
        return first[..., panel, None]
    if panel.ndim > 2:
        batch = np.broadcast_shapes(first.shape[1:-2], panel.shape[:-2])
        count, *own, lines, panels = first.shape
        whole = first.reshape(count, *(1,) * (len(batch) - len(own)), *own, lines, panels)
        each = np.broadcast_to(whole, (count, *batch, lines, panels))
        return np.take_along_axis(each, np.broadcast_to(panel, (1, *batch, *panel.shape[-2:])), axis=-1)
    lines, panels = first.shape[-2:]
    return first.reshape(*first.shape[:-2], -1).take(np.arange(lines)[:, None] * panels + panel, axis=-1)


def _shared(panels: NDArray[np.intp]) -> NDArray[np.intp]:
    """Panels (..., m, k) of points as (m, k), where a whole batch has the same."""
    if panels.ndim < 3:
        return panels
    first: NDArray[np.intp] = panels[(0,) * (panels.ndim - 2)]
    return first if np.array_equal(panels, np.broadcast_to(first, panels.shape)) else panels


def _first(coefficients: Array) -> Array:
    """Coefficients (..., n) as (n, ...)."""
    return coefficients.transpose(-1, *range(coefficients.ndim - 1))


def _points(powers: Array, t: Array, order: int) -> Array:
    """Points or derivatives (..., 2) at t (...) of polynomials with coefficients (n, 2, ...)."""
    return np.ascontiguousarray(np.moveaxis(_horner(powers, t, order), 0, -1))


def _horner(powers: Array, t: Array, order: int) -> Array:
    """Values or derivatives (...) at t (...) of polynomials with coefficients (n, ...)."""
    count = len(powers)
    value: Array = np.zeros(np.broadcast_shapes(powers.shape[1:], t.shape), dtype=np.result_type(powers, t))
    for k in range(count - 1, order - 1, -1):
        value = value * t + (perm(k, order) * powers[k] if order else powers[k])
    return value


def _clenshaw(series: Array, x: Array) -> Array:
    """Values (...) at x (...) of Chebyshev series (n, ...)."""
    two = 2.0 * x
    later: Array | float = 0.0
    now: Array | float = 0.0
    for k in range(len(series) - 1, 0, -1):
        later, now = now, series[k] + two * now - later
    return series[0] + x * now - later


def _integration() -> Reals:
    rows = [chebyshev.chebint(np.eye(NODES)[k], lbnd=-1.0) for k in range(NODES)]
    return np.array([np.pad(row, (0, NODES + 1 - len(row))) for row in rows]).T


_NODE_PLACES = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
_TO_SERIES = np.linalg.inv(chebyshev.chebvander(_NODE_PLACES, NODES - 1))
_INTEGRATED = _integration()
