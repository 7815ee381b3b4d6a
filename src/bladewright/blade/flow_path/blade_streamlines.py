"""Stream lines of a flow path by u: 0 on the blade's leading and 1 on its trailing edge, and on past them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from bladewright.blade.flow_path.intersections import Intersection, intersections, nearest_parameters
from bladewright.blade.flow_path.meridional_curve import MeridionalCurve, real_first
from bladewright.blade.flow_path.stream_surface_map import Cascade, DiscreteConformal, StreamSurfaceMap
from bladewright.blade.flow_path.stream_surfaces import StreamSurfaces
from bladewright.blade.flow_path.streamlines import StreamLines, stream_lines
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, length
from bladewright.nurbs.basis import Reals


@dataclass(frozen=True, kw_only=True, eq=False)
class DiscreteConformalLines:
    """Stream lines (..., m) over [0, 1] of a stretch of a flow path; they answer as `StreamLines` do.

    Stream lines through hundreds of points, as flow solvers give them, have as many joints each; a blade asks for
    places on them alone.
    """

    mapping: StreamSurfaceMap
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
        return DiscreteConformalLines(
            mapping=self.mapping, surfaces=self.surfaces, v=self.v[which], low=self.low, high=self.high
        )

    def real(self) -> "DiscreteConformalLines":
        """The same without imaginary parts and batch."""
        return DiscreteConformalLines(
            mapping=self.mapping, surfaces=self.surfaces.real(), v=self.v, low=self.low, high=self.high
        )


ROOM = 1e-9
"""share of the stretch by which a section may reach past it: rounding"""
BESIDE = 1.0
"""how far, in u, stream lines are laid out past the edges where the flow path reaches so far"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Stretch:
    """The part of a flow path around a blade, over [0, 1]; it is `Channelled`."""

    surfaces: StreamSurfaces
    low: float
    """t at 0"""
    high: float
    """t at 1"""

    def joints(self) -> Reals:
        """Where the polynomials of stream lines end."""
        own = (np.concatenate([self.surfaces.joints(), [0.0, 1.0]]) - self.low) / (self.high - self.low)
        return np.sort(own[(own > ROOM) & (own < 1.0 - ROOM)])

    def stream_polynomials(self, v: Array, centres: Reals) -> Array:
        """Coefficients (..., len(v), len(centres), k, 2) of (x, r) in powers of the parameter less each centre."""
        width = self.high - self.low
        powers = self.surfaces.stream_polynomials(v, self.low + width * centres)
        return powers * (width ** np.arange(powers.shape[-2]))[:, None]


@dataclass(frozen=True, kw_only=True, eq=False)
class BladeStreamlines:
    """Stream lines (..., m) of a flow path; they answer as `StreamLines` do, u linear in t between the edges."""

    stretch: Stretch
    v: Reals
    """(m,) span fractions"""
    lines: StreamLines | DiscreteConformalLines
    """the same by the parameter of the stretch"""
    leading: Array
    """(..., m) t on the leading edge"""
    trailing: Array
    """(..., m) t on the trailing edge"""
    rate: Array | None = None
    """(..., m) increase of m' over the stretch, where it is counted in equal steps; none elsewhere"""

    @property
    def mapping(self) -> StreamSurfaceMap:
        """The sections' plane."""
        return self.lines.mapping

    def t(self, u: Array) -> Array:
        """t (..., m, k) on the flow path at u (..., m, k) or (k,)."""
        return self.stretch.low + (self.stretch.high - self.stretch.low) * self._own(u)

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
        """Least and greatest abscissa (m,) that the stream lines are laid out to."""
        ends = self.lines.starts[..., [0, -1]] - self._origin[..., None]
        ends = real_first(ends if self.rate is None else ends * self.rate[..., None], 2)
        return ends[:, 0], ends[:, 1]

    def real(self) -> "BladeStreamlines":
        """The same without imaginary parts and batch."""
        return replace(
            self,
            stretch=replace(self.stretch, surfaces=self.stretch.surfaces.real()),
            lines=self.lines.real(),
            leading=real_first(self.leading, 1),
            trailing=real_first(self.trailing, 1),
            rate=None if self.rate is None else real_first(self.rate, 1),
        )

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
        return stream_lines(self.stretch, Cascade(), self.v, 0.0, 0.0)

    def between(self, leading: Array, trailing: Array) -> "BladeStreamlines":
        """The same stream lines by u from 0 at t = `leading` to 1 at t = `trailing`, (..., m) each."""
        found = replace(self, leading=leading, trailing=trailing)
        # it does not depend on where u counts from
        found.__dict__["_by_length"] = self._by_length
        return found

    def rows(self, which: list[int]) -> "BladeStreamlines":
        """Some of the stream lines, by their number along the span."""
        return replace(
            self,
            v=self.v[which],
            lines=self.lines.rows(which),
            leading=self.leading[..., which],
            trailing=self.trailing[..., which],
            rate=None if self.rate is None else self.rate[..., which],
        )

    def nearest(self, targets: Array) -> Array:
        """u (..., m) at least distance from points (x, r) (..., m, 2), one for each stream line.

        All of the flow path is searched. Raises DesignError where the nearest point is an end of it.
        """
        surfaces = self.stretch.surfaces
        found = nearest_parameters(partial(surfaces.position, self.v), surfaces.extent, targets, labels(self.v))
        return (found - self.leading) / (self.trailing - self.leading)

    @property
    def _start(self) -> Array:
        """The stretch's parameter on the leading edge."""
        return (self.leading - self.stretch.low) / (self.stretch.high - self.stretch.low)

    @property
    def _speed(self) -> Array:
        """Its increase by u."""
        return (self.trailing - self.leading) / (self.stretch.high - self.stretch.low)

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
        if np.max(past, initial=-1.0) <= ROOM:
            return
        worst = np.unravel_index(int(np.argmax(past)), past.shape)
        row, downstream = int(worst[-2]), bool(share[worst] > 1.0)
        surfaces, v = self.stretch.surfaces, self.v[row]
        end = "downstream" if downstream else "upstream"
        room = ROOM * (surfaces.high - surfaces.low)
        if surfaces.high - self.stretch.high > room if downstream else self.stretch.low - surfaces.low > room:
            edge, far = (self.trailing, self.stretch.high) if downstream else (self.leading, self.stretch.low)
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


@dataclass(frozen=True, kw_only=True, eq=False)
class PrescribedEdges:
    """A flow path with the leading- and trailing-edge curves of a blade in it."""

    surfaces: StreamSurfaces
    leading_edge: MeridionalCurve
    trailing_edge: MeridionalCurve
    counted: bool = False
    """whether m' is counted as `spacing` "conformal" does, instead of exact"""

    def edges(self, v: Reals) -> tuple[Array, Array]:
        """t (..., m) where the stream lines at v (m,) meet the leading and the trailing edge.

        Raises DesignError where they do not meet, or not in this order.
        """
        leading, trailing = (meeting.t for meeting in self.meetings(v))
        return leading, trailing

    def meetings(self, v: Reals) -> list[Intersection]:
        """Where the stream lines at v (m,) meet the leading and the trailing edge."""
        new = np.array([each for each in np.unique(v) if each not in self._met])
        if len(new):
            self._met.update(zip(new, zip(*map(_each, self._sought(new)), strict=True), strict=True))
        return [_together([self._met[each][edge] for each in v]) for edge in (0, 1)]

    @cached_property
    def _met(self) -> dict[float, tuple[Intersection, ...]]:
        """Meetings with both edges by v: sections, their edges and their joints ask at many of the same places."""
        return {}

    def _sought(self, v: Reals) -> list[Intersection]:
        position = partial(self.surfaces.position, v)
        return [
            intersections(position, self.surfaces.extent, edge, name, labels(v))
            for edge, name in ((self.leading_edge, "leading_edge"), (self.trailing_edge, "trailing_edge"))
        ]

    def lines(self, v: Reals, mapping: StreamSurfaceMap) -> BladeStreamlines:
        """Stream lines at v (m,) by u between the edges."""
        return blade_streamlines(self.surfaces, v, mapping, *self.edges(v), counted=self.counted)


def prescribed_edges(
    surfaces: StreamSurfaces, leading_edge: MeridionalCurve, trailing_edge: MeridionalCurve, *, counted: bool = False
) -> PrescribedEdges:
    """The flow path with a blade's edge curves in it."""
    return PrescribedEdges(surfaces=surfaces, leading_edge=leading_edge, trailing_edge=trailing_edge, counted=counted)


def blade_streamlines(
    surfaces: StreamSurfaces,
    v: Reals,
    mapping: StreamSurfaceMap,
    leading: Array,
    trailing: Array,
    *,
    counted: bool = False,
    before: float = BESIDE,
    after: float = BESIDE,
) -> BladeStreamlines:
    """Stream lines at v (m,) by u, 0 at t = `leading` and 1 at t = `trailing`, (..., m) each, in a plane.

    They go on by `before` and `after` in u where the flow path does. Where m' is `counted`, the mapping is `Counted`
    whatever is given. Raises DesignError where a trailing edge is not downstream of its leading edge.
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
    stretch = Stretch(surfaces=surfaces.along(v), low=low, high=high)
    rate = surfaces.counted(v)[1] * (high - low) if counted else None
    lines: StreamLines | DiscreteConformalLines
    if counted:
        lines = DiscreteConformalLines(mapping=DiscreteConformal(), surfaces=stretch.surfaces, v=v, low=low, high=high)
    else:
        lines = stream_lines(stretch, mapping, v, 0.0, 0.0)
    return BladeStreamlines(stretch=stretch, v=v, lines=lines, leading=leading, trailing=trailing, rate=rate)


def labels(v: Reals) -> list[str]:
    """What stream lines are called in messages."""
    return [f"at v = {each:.4g}" for each in v]


def _each(meeting: Intersection) -> list[Intersection]:
    """The meetings (...) of each stream line."""
    return [Intersection(meeting.t[..., i], meeting.q[..., i]) for i in range(meeting.t.shape[-1])]


def _together(meetings: Sequence[Intersection]) -> Intersection:
    """Meetings (..., m) of m stream lines."""
    return Intersection(*(np.stack(each, axis=-1) for each in zip(*meetings, strict=True)))


def _gauss() -> tuple[Reals, Reals]:
    """Places (n,) in [0, 1] and weights of Gauss's rule on equal panels."""
    nodes, weights = np.polynomial.legendre.leggauss(6)
    starts = np.arange(24.0)[:, None]
    return np.ravel(starts + 0.5 * (1.0 + nodes)) / 24.0, np.tile(weights, 24) / 48.0


_GAUSS = _gauss()
