"""Stream lines as polynomials on panels of u: position, length or m' along them, and the inverse of these."""

from collections.abc import Callable
from dataclasses import dataclass
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
INVERSE_NODES = 22
"""Chebyshev nodes of the inverse u(a) on a panel, from which Newton's method starts: so many that one step mostly
suffices."""
MANY_PANELS = 5
"""Number of panels from which on all points are evaluated at once with the coefficients of their panels, instead of
panel after panel. It trades memory for calls and changes no result."""
CONVERGED = 3e-8
"""Newton step in u at which the iteration ends: the error left is its square, which is rounding."""


class MeridionalChannel(Protocol):
    """A channel or flow path whose stream lines are piecewise polynomials of one parameter u."""

    def joints(self) -> Reals:
        """Where a stream line loses derivatives."""

    def stream_polynomials(self, v: Reals, centres: Reals) -> Array:
        """Coefficients (..., len(v), len(centres), k, 2) of (x, r) in powers of u - centre, around each centre."""


Panel = int | NDArray[np.intp]
"""a panel by its number, or a number for each point"""


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
        u = np.broadcast_to(u, np.broadcast_shapes((*self.starts.shape[:-1], 1), np.shape(u)))
        return self._by_panel(u, lambda panel, part: self._polynomial(panel, part, order))

    def densities(self, u: Array) -> tuple[Array, Array]:
        """da/du and d2a/du2 (..., m, k) at u (..., m, k) or (k,)."""
        position, slope, bend = (self.position(u, order) for order in range(3))
        return self.mapping.density(position, slope), self.mapping.density_slope(position, slope, bend)

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
        u = np.broadcast_to(u, np.broadcast_shapes((*self.starts.shape[:-1], 1), np.shape(u)))
        return self._by_panel(u, self._panel_abscissa)

    def u_at(self, abscissa: Array) -> Array:
        """u (..., m, k) at an abscissa (..., m, k): Newton in real numbers, its derivative by one more complex step."""
        real = np.real(abscissa)
        if not (np.iscomplexobj(abscissa) or np.iscomplexobj(self.series)):
            return self._inverse(real)
        if real.ndim > 2:
            flat = real.reshape(-1, *real.shape[-2:])
            real = flat[0]
        lines = self.real()
        u = lines.u_at(real)
        moved = -np.imag(abscissa)
        if np.iscomplexobj(self.series):
            moved = moved + lines.batched_abscissa(u, np.imag(self.series), np.imag(self.starts))
        return u - 1j * moved / lines.rate(u)

    def rate(self, u: Array) -> Array:
        """da/du (..., m, k) at u (..., m, k), by its series."""
        return self._by_panel(u, self._panel_rate)

    def batched_abscissa(self, u: Reals, series: Reals, starts: Reals) -> Reals:
        """The abscissa (..., m, k) at u (m, k) that a batch of series (..., m, p, n) and starts (..., m, p + 1) gives.

        All are evaluated at the same u, so that each stream line is one product with Chebyshev polynomials.
        """
        index, count = self._panel_index(u), series.shape[-1]
        own = chebyshev.chebvander(self._local(index, u), count - 1)
        polynomials = np.zeros((*u.shape, len(self.panels) - 1, count))
        np.put_along_axis(polynomials, index[..., None, None], own[..., None, :], axis=-2)
        batch = np.moveaxis(series.reshape(-1, len(u), polynomials.shape[-2] * count), 0, -1)
        found = np.moveaxis(polynomials.reshape(*u.shape, -1) @ batch, -1, 0)
        return found.reshape(*series.shape[:-3], *u.shape) + _of(starts, index)

    def _inverse(self, abscissa: Reals) -> Reals:
        u = self._guess(abscissa)
        for _ in range(30):
            step = self._newton_step(u, abscissa)
            u = u - step
            if np.max(np.abs(step), initial=0.0) < CONVERGED:  # real: a stopping rule
                return u
        raise DesignError(
            "channel: the meridional length along a stream line cannot be inverted, so its control points "
            "make it turn back; spread the inner control points of hub and shroud"
        )

    def _guess(self, abscissa: Reals) -> Reals:
        index = np.sum(abscissa[..., None] >= self.starts[..., None, 1:-1], axis=-1)

        def on_panel(panel: Panel, part: Reals) -> Reals:
            start, end = _of(self.starts, panel), _of(self.starts, panel + 1)
            return _clenshaw(_rows_of(self._rough_inverse, panel), (2.0 * part - start - end) / (end - start))

        return _patched(index, abscissa, on_panel)

    @cached_property
    def _rough_inverse(self) -> Reals:
        """Chebyshev series (m, p, INVERSE_NODES) of u by the abscissa on each panel, by a few Newton steps."""
        extent = np.diff(self.starts)[..., None]
        local = _GUESS_PLACES
        for _ in range(4):
            value = _clenshaw(self.series[..., None, :], local) - extent * (1.0 + _GUESS_PLACES) / 2.0
            step = value / _clenshaw(self.density[..., None, :], local) / (np.diff(self.panels)[:, None] / 2.0)
            local = np.clip(local - step, -1.0, 1.0)
        u = self.panels[:-1, None] + np.diff(self.panels)[:, None] * (1.0 + local) / 2.0
        return u @ _GUESS_SERIES.T

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

    def _newton_step(self, u: Array, abscissa: Array) -> Array:
        index = self._panel_index(u)
        return _patched(index, np.stack([u, abscissa]), lambda panel, part: self._panel_step(panel, part[0], part[1]))

    def _panel_step(self, panel: Panel, u: Array, abscissa: Array) -> Array:
        return (self._panel_abscissa(panel, u) - abscissa) / self._panel_rate(panel, u)

    def _panel_rate(self, panel: Panel, u: Array) -> Array:
        return _clenshaw(_rows_of(self.density, panel), self._local(panel, u))

    def _panel_abscissa(self, panel: Panel, u: Array) -> Array:
        return _clenshaw(_rows_of(self.series, panel), self._local(panel, u)) + _of(self.starts, panel)

    def _local(self, panel: Panel, u: Array) -> Array:
        low, high = self.panels[panel], self.panels[panel + 1]
        return (2.0 * u - low - high) / (high - low)

    def _by_panel(self, u: Array, on_panel: Callable[[Panel, Array], Array]) -> Array:
        return _patched(self._panel_index(u), u, on_panel)

    def _panel_index(self, u: Array) -> Array:
        return np.clip(np.searchsorted(self.panels, np.real(u), side="right") - 1, 0, len(self.panels) - 2)

    def _polynomial(self, panel: Panel, u: Array, order: int) -> Array:
        t = u - (self.panels[panel] + self.panels[panel + 1]) / 2.0
        return np.stack([_horner(_rows_of(self.powers[..., i], panel), t, order) for i in (0, 1)], axis=-1)


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
    return lines


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


def _patched(index: Array, values: Array, on_panel: Callable[[Panel, Array], Array]) -> Array:
    """The functions of the panels at points of each; a panel is evaluated only in the columns where it has points."""
    counts = np.bincount(index.ravel())
    main = int(np.argmax(counts))
    if counts[main] == index.size:
        return on_panel(main, values)
    if np.count_nonzero(counts) >= MANY_PANELS:
        return on_panel(index, values)
    result = np.array(on_panel(main, values))
    for panel in np.flatnonzero(counts):
        if panel == main:
            continue
        inside = index == panel
        columns = np.any(inside.reshape(-1, inside.shape[-1]), axis=0)
        part = on_panel(int(panel), values[..., columns])
        inside = inside[..., columns]
        if part.ndim == result.ndim and result.ndim > index.ndim:
            result[..., columns, :] = np.where(inside[..., None], part, result[..., columns, :])
        else:
            result[..., columns] = np.where(inside, part, result[..., columns])
    return result


def _of(values: Array, panel: Panel) -> Array:
    """Values (..., m, p) of a panel as (..., m, 1), or of each point's panel (..., m, k) as (..., m, k)."""
    return _rows_of(values[..., None], panel)[..., 0]


def _rows_of(coefficients: Array, panel: Panel) -> Array:
    """Coefficients (..., m, p, n) of a panel as (..., m, 1, n), or of each point's (..., m, k) as (..., m, k, n)."""
    if isinstance(panel, int):
        return coefficients[..., panel, None, :]
    count = max(coefficients.ndim, panel.ndim + 1)
    index = panel.reshape((1,) * (count - panel.ndim - 1) + (*panel.shape, 1))
    return np.take_along_axis(coefficients[(None,) * (count - coefficients.ndim)], index, axis=-2)


def _horner(powers: Array, t: Array, order: int) -> Array:
    """Values or derivatives (...) at t (...) of polynomials with coefficients (..., n)."""
    count = powers.shape[-1]
    value: Array = np.zeros(np.broadcast_shapes(powers.shape[:-1], t.shape), dtype=np.result_type(powers, t))
    for k in range(count - 1, order - 1, -1):
        value = value * t + perm(k, order) * powers[..., k]
    return value


def _clenshaw(series: Array, x: Array) -> Array:
    """Values (...) at x (...) of Chebyshev series (..., n)."""
    two = 2.0 * x
    later: Array | float = 0.0
    now: Array | float = 0.0
    for k in range(series.shape[-1] - 1, 0, -1):
        later, now = now, series[..., k] + two * now - later
    return series[..., 0] + x * now - later


def _integration() -> Reals:
    rows = [chebyshev.chebint(np.eye(NODES)[k], lbnd=-1.0) for k in range(NODES)]
    return np.array([np.pad(row, (0, NODES + 1 - len(row))) for row in rows]).T


_NODE_PLACES = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
_TO_SERIES = np.linalg.inv(chebyshev.chebvander(_NODE_PLACES, NODES - 1))
_INTEGRATED = _integration()
_GUESS_PLACES = np.cos(np.pi * (np.arange(INVERSE_NODES) + 0.5) / INVERSE_NODES)
_GUESS_SERIES = np.linalg.inv(chebyshev.chebvander(_GUESS_PLACES, INVERSE_NODES - 1))
