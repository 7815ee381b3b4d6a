"""Stream lines of a flow path by u: 0 on the blade's leading and 1 on its trailing edge, and on past them."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.flow_path.stream_surface_map import Cascade, StreamSurfaceMap
from bladewright.blade.flow_path.stream_surfaces import StreamSurfaces
from bladewright.blade.flow_path.streamlines import StreamLines, stream_lines
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, length
from bladewright.nurbs.basis import Reals

ROUNDING = 1e-9
"""Share of the stretch by which a section may reach past it, as rounding makes it."""
OVERRUN = 1.0
"""How far stream lines go on past the edges, in meridional extents of the blade, where the flow path reaches so far.
A section whose rounded edge stands farther out is refused."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DiscreteConformalLines:
    """Stream lines (..., m) over [0, 1] of a stretch of a flow path; they answer as `StreamLines` do.

    Their abscissa is the discrete m' of the points of hub, shroud and stream surfaces, as in T-Blade3, and linear in
    the parameter. So no length is integrated, which saves time where stream lines go through hundreds of points.
    """

    surfaces: StreamSurfaces
    v: Reals
    """(m,) span fractions"""
    low: float
    """t at 0"""
    high: float
    """t at 1"""

    @property
    def starts(self) -> Reals:
        """(m, 2) the abscissa at both ends."""
        return np.tile([0.0, 1.0], (len(self.v), 1))

    def position(self, u: Array, order: int = 0) -> Array:
        """(x, r) or derivatives by u (..., m, k, 2) at u (..., m, k) or (k,)."""
        width = self.high - self.low
        places = np.broadcast_to(u, np.broadcast_shapes((len(self.v), 1), np.shape(u)))
        t = self.low + width * real_first(places, 2)
        found = self.surfaces.position(self.v, t, order) * width**order
        if not np.iscomplexobj(places):
            return found
        return found + 1j * np.imag(places)[..., None] * self.surfaces.position(self.v, t, order + 1) * width ** (
            order + 1
        )

    def abscissa(self, u: Array) -> Array:
        """The abscissa (..., m, k) at u (..., m, k) or (k,): u."""
        return np.broadcast_to(u, np.broadcast_shapes((len(self.v), 1), np.shape(u)))

    def u_at(self, abscissa: Array) -> Array:
        """u (..., m, k) at an abscissa (..., m, k): the same."""
        return abscissa

    def rows(self, which: list[int]) -> "DiscreteConformalLines":
        """Some of the stream lines, by their number along the span."""
        return DiscreteConformalLines(surfaces=self.surfaces, v=self.v[which], low=self.low, high=self.high)

    def real(self) -> "DiscreteConformalLines":
        """The same without imaginary parts and batch."""
        return DiscreteConformalLines(surfaces=self.surfaces.real(), v=self.v, low=self.low, high=self.high)


@dataclass(frozen=True, kw_only=True, eq=False)
class BladeStreamlines:
    """Stream lines (..., m) of a flow path; they answer as `StreamLines` do, u linear in t between the edges."""

    surfaces: StreamSurfaces
    low: float
    """t at which the stretch of the flow path around the blade begins"""
    high: float
    """t at which it ends"""
    v: Reals
    """(m,) span fractions"""
    mapping: StreamSurfaceMap
    """the sections' plane"""
    leading: Array
    """(..., m) t on the leading edge"""
    trailing: Array
    """(..., m) t on the trailing edge"""
    rate: Array | None = None
    """(..., m) increase of a discrete m' over the stretch; none in other planes"""

    @cached_property
    def lines(self) -> StreamLines | DiscreteConformalLines:
        """The same stream lines by the share of the stretch, from 0 to 1."""
        if self.rate is None:
            return stream_lines(self, self.mapping, self.v, 0.0, 0.0)
        return DiscreteConformalLines(surfaces=self.surfaces, v=self.v, low=self.low, high=self.high)

    def joints(self) -> Reals:
        """Shares of the stretch at which the polynomials of stream lines end."""
        own = (np.concatenate([self.surfaces.joints(), [0.0, 1.0]]) - self.low) / (self.high - self.low)
        return np.sort(own[(own > ROUNDING) & (own < 1.0 - ROUNDING)])

    def stream_polynomials(self, v: Array, centres: Reals) -> Array:
        """Coefficients (..., len(v), len(centres), k, 2) of (x, r) in powers of the share less each centre."""
        width = self.high - self.low
        powers = self.surfaces.stream_polynomials(v, self.low + width * centres)
        return powers * (width ** np.arange(powers.shape[-2]))[:, None]

    def t(self, u: Array) -> Array:
        """t (..., m, k) on the flow path at u (..., m, k) or (k,)."""
        return self.low + (self.high - self.low) * self._own(u)

    def position(self, u: Array, order: int = 0) -> Array:
        """(x, r) or derivatives by u (..., m, k, 2) at u (..., m, k) or (k,)."""
        return self.lines.position(self._own(u), order) * (self._speed**order)[..., None, None]

    def abscissa(self, u: Array) -> Array:
        """The abscissa (..., m, k) in the plane, 0 on the leading edge, at u (..., m, k) or (k,)."""
        found = self.lines.abscissa(self._own(u)) - self._origin[..., None]
        return found if self.rate is None else found * self.rate[..., None]

    def u_at(self, abscissa: Array) -> Array:
        """u (..., m, k) at an abscissa (..., m, k); DesignError where that is outside the flow path."""
        own = (abscissa if self.rate is None else abscissa / self.rate[..., None]) + self._origin[..., None]
        ends = real_first(self.lines.starts[..., [0, -1]], 2)
        self._check((np.real(own) - ends[:, :1]) / np.diff(ends, axis=1))
        return (self.lines.u_at(own) - self._start[..., None]) / self._speed[..., None]

    def densities(self, u: Array) -> tuple[Array, Array]:
        """da/du and d2a/du2 (..., m, k) at u (..., m, k) or (k,)."""
        position, slope, bend = (self.position(u, order) for order in range(3))
        if self.rate is not None:
            first = (self.rate * self._speed)[..., None] * np.ones(position.shape[:-1])
            return first, np.zeros_like(first)
        return self.mapping.density(position, slope), self.mapping.density_slope(position, slope, bend)

    def extents(self) -> Array:
        """(..., m) extent in the plane: the abscissa on the trailing edge."""
        return self.abscissa(np.array([1.0]))[..., 0]

    def reach(self) -> tuple[Reals, Reals]:
        """Least and greatest abscissa (m,) to which the stream lines are known."""
        ends = self.lines.starts[..., [0, -1]] - self._origin[..., None]
        ends = real_first(ends if self.rate is None else ends * self.rate[..., None], 2)
        return ends[:, 0], ends[:, 1]

    def real(self) -> "BladeStreamlines":
        """The same without imaginary parts and batch."""
        found = replace(
            self,
            surfaces=self.surfaces.real(),
            leading=real_first(self.leading, 1),
            trailing=real_first(self.trailing, 1),
            rate=None if self.rate is None else real_first(self.rate, 1),
        )
        return _known(found, lines=self.lines.real())

    @cached_property
    def lengths(self) -> Array:
        """(..., m) meridional length between the edges [m]."""
        if self.rate is None:
            return self.meridional(np.array([1.0]))[..., 0]
        # to 1e-9 of itself or better, without the panels of all joints of lines through many points
        return np.sum(length(self.position(_GAUSS[0], 1)) * _GAUSS[1], axis=-1)

    def meridional(self, u: Array) -> Array:
        """Meridional length (..., m, k) from the leading edge [m] at u (..., m, k) or (k,)."""
        found = self._by_length.abscissa(self._own(u))
        return found - self._by_length.abscissa(self._start[..., None])

    def u_at_length(self, meridional: Array) -> Array:
        """u (..., m, k) at meridional lengths (..., m, k) from the leading edge [m]."""
        own = meridional + self._by_length.abscissa(self._start[..., None])
        ends = real_first(self._by_length.starts[..., [0, -1]], 2)
        self._check((np.real(own) - ends[:, :1]) / np.diff(ends, axis=1))
        return (self._by_length.u_at(own) - self._start[..., None]) / self._speed[..., None]

    @cached_property
    def _by_length(self) -> StreamLines:
        return stream_lines(self, Cascade(), self.v, 0.0, 0.0)

    def between(self, leading: Array, trailing: Array) -> "BladeStreamlines":
        """The same stream lines by u from 0 at t = `leading` to 1 at t = `trailing`, (..., m) each."""
        return _known(replace(self, leading=leading, trailing=trailing), lines=self.lines, _by_length=self._by_length)

    def rows(self, which: list[int]) -> "BladeStreamlines":
        """Some of the stream lines, by their number along the span."""
        found = replace(
            self,
            v=self.v[which],
            leading=self.leading[..., which],
            trailing=self.trailing[..., which],
            rate=None if self.rate is None else self.rate[..., which],
        )
        return _known(found, lines=self.lines.rows(which))

    @property
    def _start(self) -> Array:
        """The stretch's parameter on the leading edge."""
        return (self.leading - self.low) / (self.high - self.low)

    @property
    def _speed(self) -> Array:
        """Its increase by u."""
        return (self.trailing - self.leading) / (self.high - self.low)

    @cached_property
    def _origin(self) -> Array:
        return self.lines.abscissa(self._start[..., None])[..., 0]

    def _own(self, u: Array) -> Array:
        found = self._start[..., None] + self._speed[..., None] * u
        self._check(np.real(found))
        return found

    def _check(self, share: Reals) -> None:
        """Refuse shares of the stretch (..., m, k) outside of it."""
        past = np.maximum(-share, share - 1.0)
        if np.max(past, initial=-1.0) <= ROUNDING:
            return
        worst = np.unravel_index(int(np.argmax(past)), past.shape)
        row, downstream = int(worst[-2]), bool(share[worst] > 1.0)
        surfaces, v = self.surfaces, self.v[row]
        end = "downstream" if downstream else "upstream"
        margin = ROUNDING * (surfaces.high - surfaces.low)
        if surfaces.high - self.high > margin if downstream else self.low - surfaces.low > margin:
            edge, far = (self.trailing, self.high) if downstream else (self.leading, self.low)
            beside = (far - edge) / (self.trailing - self.leading)
            share_of = 100.0 * float(np.max(np.square(real_first(beside, 1)[row])) ** 0.5)
            raise DesignError(
                f"the section at v = {v:.4g} reaches more than {share_of:.3g}% of its meridional extent {end} of its "
                "edge: a nose must keep beside it; lower the thickness or the stagger there, or move the edge curve"
            )
        much = 100.0 * float(past[worst] / np.broadcast_to(np.real(self._speed)[..., None], past.shape)[worst])
        raise DesignError(
            f"the section at v = {v:.4g} reaches {much:.3g}% of its meridional extent past the {end} end of the flow "
            f"path: hub, shroud and stream surfaces must reach past every section, nose included; lengthen them {end}, "
            "or move or shorten the section"
        )


def blade_streamlines(
    surfaces: StreamSurfaces,
    v: Reals,
    mapping: StreamSurfaceMap,
    leading: Array,
    trailing: Array,
    *,
    before: float = OVERRUN,
    after: float = OVERRUN,
) -> BladeStreamlines:
    """Stream lines at v (m,) by u, 0 at t = `leading` and 1 at t = `trailing`, (..., m) each, in a plane.

    They go on by `before` and `after` in u where the flow path does. Raises DesignError where a trailing edge is not
    downstream of its leading edge.
    """
    leading, trailing = np.broadcast_arrays(leading, trailing)
    start, end = real_first(leading, 1), real_first(trailing, 1)
    behind = end <= start
    if np.any(behind):
        raise DesignError(
            f"leading_edge and trailing_edge cross or are swapped: at v = {v[int(np.argmax(behind))]:.4g} the trailing "
            "edge is not downstream of the leading edge; exchange them, or move them apart"
        )
    low = max(surfaces.low, float(np.min(start - before * (end - start))))
    high = min(surfaces.high, float(np.max(end + after * (end - start))))
    found = BladeStreamlines(
        surfaces=surfaces.along(v),
        low=low,
        high=high,
        v=v,
        mapping=mapping,
        leading=leading,
        trailing=trailing,
        rate=surfaces.counted(v)[1] * (high - low) if mapping.discrete else None,
    )
    # at once, so that stream lines which cannot be are refused here
    return _known(found, lines=found.lines)


def _known(own: BladeStreamlines, **found: StreamLines | DiscreteConformalLines) -> BladeStreamlines:
    """Stream lines with cached properties that are known from others."""
    own.__dict__.update(found)
    return own


def labels(v: Reals) -> list[str]:
    """What stream lines are called in messages."""
    return [f"the stream line at v = {each:.4g}" for each in v]


def _gauss() -> tuple[Reals, Reals]:
    """Places (n,) in [0, 1] and weights of Gauss's rule on equal panels."""
    nodes, weights = np.polynomial.legendre.leggauss(6)
    starts = np.arange(24.0)[:, None]
    return np.ravel(starts + 0.5 * (1.0 + nodes)) / 24.0, np.tile(weights, 24) / 48.0


_GAUSS = _gauss()
