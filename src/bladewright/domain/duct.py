"""The duct: a flow path, or a blade's channel, continued up- and downstream of its ends; and its volume.

A flow path goes on straight. Continued by its own polynomials a channel of the blade alone would curl up within a
fraction of a chord, and the walls of an impeller would cross. So past its ends a stream line goes on by arc length: its
curvature fades to zero, and its direction turns to the one between hub and shroud.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import comb, factorial
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.flow_path.stream_surface_map import Cascade, Conformal, StreamSurfaceMap
from bladewright.blade.flow_path.streamlines import MeridionalChannel, StreamLines, stream_lines
from bladewright.numerics.elementary import Array, cross2
from bladewright.numerics.quadrature import gauss, panels
from bladewright.nurbs.basis import Reals, basis, greville
from bladewright.nurbs.curve import Curve

WALL_DEGREE = 7
"""Degree of a wall's meridian as a B-spline: high, so that few spans reach MERIDIAN_TOLERANCE. With 5 or 9 nothing else
changes (design/passage_constants.md)."""
MERIDIAN_TOLERANCE = 1e-12
"""Largest distance of that B-spline from the stream line, in units of its length: a few thousand roundings. With 1e-13
or 1e-10 no figure of design/passage_constants.md changes."""
MERIDIAN_SPANS = (24, 48, 96, 192, 384)
"""Numbers of its spans that are tried in turn."""
BEND = 0.08
"""Extent, in mean meridional lengths of the blade, over which a continued stream line loses its curvature: short, or
hub and shroud of an impeller would meet, and long enough for the walls' knots to follow. With 0.02 passages have 13 %
more control points, with 0.32 4 % fewer (design/passage_constants.md)."""
FADING = np.array([1.0, 0.0, -3.0, 2.0])
"""Coefficients of 1 - 3 t^2 + 2 t^3, by which curvature fades: 1 at 0 and 0 at 1, with zero slope at both."""
KEPT = 3
"""Coefficients by arc length that a continued stream line keeps: point, direction and curvature."""
LIMIT_SPANS, LIMIT_LINES = 40, 33
"""Steps of an extent, and stream lines, at which it is checked whether the duct folds over or meets the axis. Half or
twice as many change control points by 0.1 % (design/passage_constants.md)."""
LEAST_SINE = 1e-4
"""Jacobian of the duct, over the median product of the lengths of its sides, below which it folds over. Ten times as
much or as little decides nothing in design/passage_constants.md."""
OUTLINE_POINTS = 16
"""Gauss points on each polynomial piece of the duct's outline: exact for r^2 dx up to degree 31."""

HALVINGS = 7
"""Times that the pieces of inlet and outlet may be halved for the volume of the annulus."""
RING_ROUNDING = 1e-12
"""Change of that volume, of itself, by a halving, below which it is not halved further."""


@dataclass(frozen=True, kw_only=True)
class Duct:
    """The channel or flow path from inlet to outlet by its own parameter u, and straight past its ends.

    Below u = `start` and above u = `end`, u is in proportion to arc length along the stream line: `unit` of it is a
    `length`. Over `bend` of it the curvature there, and the difference of the direction from that between the walls,
    fade as FADING; where `bend` is 0 a stream line is straight at once.
    """

    channel: MeridionalChannel
    start: float
    """u, at most 0, down to which stream lines are the channel's own polynomials"""
    end: float
    """u, at least 1, up to which they are"""
    edges: tuple[float, float]
    """mean u of the blade's edges"""
    length: float
    """mean meridional length of the blade [m]"""
    unit: float
    """how much of u such a length takes"""
    bend: float
    """how much of u a stream line takes to lose its curvature past its ends"""
    low: float
    """u of the inlet"""
    high: float
    """u of the outlet"""
    revolved: bool
    """whether it is an annulus; a cascade's duct otherwise"""

    def joints(self) -> Reals:
        """The u at which stream lines lose derivatives, also beyond inlet and outlet."""
        ends = [self.start - self.bend, self.start, self.end, self.end + self.bend]
        own = np.unique([*ends, *self.channel.joints()])
        return own[(own > min(self.low, 0.0)) & (own < max(self.high, 1.0))]

    def joints_within(self) -> Reals:
        """Those of them between inlet and outlet."""
        own = self.joints()
        return own[(own > self.low) & (own < self.high)]

    def stream_polynomials(self, v: Reals, centres: Reals) -> Array:
        """Coefficients (..., len(v), len(centres), k, 2) of the stream lines by powers of u - centre; v from 0 to 1."""
        inner = self.channel.stream_polynomials(v, np.clip(centres, self.start, self.end))
        count = max(inner.shape[-2], KEPT + len(FADING) - 1)
        total = np.zeros((*inner.shape[:-2], count, 2), dtype=inner.dtype)
        total[..., : inner.shape[-2], :] = inner
        for edge, sign in ((self.start, -1.0), (self.end, 1.0)):
            outside = np.flatnonzero(sign * (centres - edge) > 0.0)
            # the slopes of both walls are needed, whichever stream lines are asked for
            all_v = np.concatenate([[0.0], v, [1.0]])
            if outside.size:
                powers = self.channel.stream_polynomials(all_v, np.array([edge]))[..., 0, :, :]
                # a stream line of one wall is real where the other wall alone carries a step
                total = total.astype(np.result_type(total, powers), copy=False)
            for i in outside:
                away = sign * (float(centres[i]) - edge)
                found = _continued(powers, self.length / self.unit, self.bend, all_v, sign, away)
                found = found[..., 1:-1, :, :]
                total[..., i, :, :] = 0.0
                total[..., i, : found.shape[-2], :] = found
        return total

    def limit(self, name: str) -> "DuctLimit | None":
        """Where, `upstream` or `downstream`, the duct folds over or meets the axis; None where it does neither."""
        v = np.linspace(0.0, 1.0, LIMIT_LINES)
        u = np.linspace(
            *((self.edges[0], self.low) if name == "upstream" else (self.edges[1], self.high)), LIMIT_SPANS + 1
        )
        powers = self.stream_polynomials(v, u)
        powers = real_first(powers, 4)
        position, slope = powers[..., 0, :], powers[..., 1, :]
        across = np.diff(position, axis=0)
        turn = np.minimum(cross2(slope[:-1], across), cross2(slope[1:], across))
        size = np.sqrt(np.sum(slope[:-1] ** 2, axis=-1) * np.sum(across**2, axis=-1))
        folded = np.any(turn <= LEAST_SINE * np.median(size), axis=0)
        sunk = np.any(position[..., 1] <= 0.0, axis=0) if self.revolved else np.zeros_like(folded)
        if not np.any(folded | sunk):
            return None
        first = int(np.argmax(folded | sunk))
        return DuctLimit(u=float(u[first]), sunk=bool(sunk[first]), last=float(u[max(first - 1, 0)]))

    def lines(self, v: Reals) -> StreamLines:
        """Stream lines at v (m,) from inlet to outlet, with m' as abscissa, or m in a cascade."""
        return self._lines(Conformal() if self.revolved else Cascade(), v)

    def wall(self, name: str) -> Curve:
        """The meridian (x, r) of `hub` or `shroud` from inlet to outlet, over [0, 1] in proportion to its length.

        It interpolates the stream line, with ever more spans until it lies within MERIDIAN_TOLERANCE of it.
        """
        row = np.array([0.0 if name == "hub" else 1.0])
        along = self._lines(Cascade(), row)
        # evaluated together with the ends, as there may be no joints
        first, *between, last = along.abscissa(np.array([self.low, *self.joints_within(), self.high]))[..., 0, :]
        joints = np.real(np.array(between) - first) / np.real(last - first)
        for spans in MERIDIAN_SPANS:
            inner = np.linspace(0.0, 1.0, spans + 1)[1:-1]
            inner = inner[np.all(np.abs(inner[:, None] - joints) > 0.1 / spans, axis=1)]  # real: knots
            inner = np.sort(np.concatenate([inner, np.repeat(joints, WALL_DEGREE - 1)]))
            knots = np.concatenate([np.zeros(WALL_DEGREE + 1), inner, np.ones(WALL_DEGREE + 1)])
            sites = greville(knots, WALL_DEGREE)
            both = np.concatenate([sites, (sites[1:] + sites[:-1]) / 2.0])
            points = along.position(along.u_at((first + (last - first) * both)[None, :]))[0]
            net = np.linalg.solve(basis(knots, WALL_DEGREE, sites), points[: len(sites)])
            miss = np.real(basis(knots, WALL_DEGREE, both[len(sites) :]) @ net - points[len(sites) :])
            if np.max(np.sum(miss**2, axis=-1)) < (MERIDIAN_TOLERANCE * float(np.real(last - first))) ** 2:
                break
        return Curve(control_points=net, knots=knots, degree=WALL_DEGREE)

    def _lines(self, mapping: StreamSurfaceMap, v: Reals) -> StreamLines:
        """Stream lines at v (m,) over inlet, outlet, 0 and 1."""
        return stream_lines(self, mapping, v, max(-self.low, 0.0), max(self.high - 1.0, 0.0))


class DuctLimit(NamedTuple):
    """Where a duct must end at the latest."""

    u: float
    sunk: bool
    """whether it meets the axis there; otherwise it folds over"""
    last: float
    """u up to which it is possible"""


def _continued(powers: Array, length_of_u: float, bend: float, v: Reals, sign: float, away: float) -> Array:
    """Coefficients (..., m, k, 2) by powers of u - centre of the stream lines given at an end, `away` past it.

    `length_of_u` is the length that one unit of u takes, `bend` the u over which they become straight, or 0 where they
    are at once, and `sign` -1 upstream and +1 downstream.
    """
    by_length = _by_length(powers * (sign ** np.arange(powers.shape[-2]))[:, None])
    own = by_length * (length_of_u ** np.arange(KEPT))[:, None]
    point, slope = own[..., 0, :], own[..., 1, :]
    if bend == 0.0:
        return np.stack([point + away * slope, sign * slope], axis=-2)
    ruled = (1.0 - v)[:, None] * slope[..., :1, :] + v[:, None] * slope[..., -1:, :]
    fading = FADING / bend ** np.arange(len(FADING))
    turning = _integrated(_integrated(_times(_derived(_derived(own)), fading)))
    bowing = _integrated(_times((slope - ruled)[..., None, :], fading))
    terms = [turning, bowing]
    if away >= bend:
        terms = [_tangent(term, bend) for term in terms]
    total = np.zeros((*point.shape[:-1], turning.shape[-2], 2), dtype=powers.dtype)
    total[..., 0, :] = point
    total[..., 1, :] = ruled
    for term in terms:
        total[..., : term.shape[-2], :] += term
    count = total.shape[-2]
    shift = [[comb(j, k) * away ** (j - k) * sign**k if j >= k else 0.0 for j in range(count)] for k in range(count)]
    return np.array(shift) @ total


def _by_length(powers: Array) -> Array:
    """The first KEPT coefficients (..., KEPT, 2) of a curve by arc length, from those by its parameter."""
    wanted = np.zeros((*powers.shape[:-2], KEPT + 1, 2), dtype=powers.dtype)
    kept = powers[..., : KEPT + 1, :]
    wanted[..., : kept.shape[-2], :] = kept
    slope = _derived(wanted)
    square = _product(slope[..., 0], slope[..., 0]) + _product(slope[..., 1], slope[..., 1])
    slowness = _power(square, -0.5)
    derivative, series = wanted, []
    for k in range(KEPT):
        series.append(derivative[..., 0, :] / factorial(k))
        step = _derived(derivative)
        derivative = np.stack([_product(step[..., i], slowness) for i in (0, 1)], axis=-1)
    return np.stack(series, axis=-2)


def _product(first: Array, second: Array) -> Array:
    """Coefficients (..., k) of the product of two power series, as many as the shorter one has."""
    count = min(first.shape[-1], second.shape[-1])
    terms = [np.sum(first[..., : k + 1] * second[..., k::-1], axis=-1) for k in range(count)]
    return np.stack(terms, axis=-1)


def _power(powers: Array, exponent: float) -> Array:
    """Coefficients (..., k) of a power series raised to an exponent."""
    result = [powers[..., 0] ** exponent]
    for n in range(1, powers.shape[-1]):
        terms = [(exponent * k - (n - k)) * powers[..., k] * result[n - k] for k in range(1, n + 1)]
        result.append(sum(terms[1:], terms[0]) / (n * powers[..., 0]))
    return np.stack(result, axis=-1)


def _derived(powers: Array) -> Array:
    return powers[..., 1:, :] * np.arange(1, powers.shape[-2])[:, None]


def _integrated(powers: Array) -> Array:
    raised = powers / np.arange(1, powers.shape[-2] + 1)[:, None]
    return np.concatenate([np.zeros_like(raised[..., :1, :]), raised], axis=-2)


def _times(powers: Array, factor: Reals) -> Array:
    """All coefficients of the product of plane polynomials with a scalar one."""
    count = powers.shape[-2]
    product = np.zeros((*powers.shape[:-2], count + len(factor) - 1, 2), dtype=powers.dtype)
    for k, value in enumerate(factor):
        product[..., k : k + count, :] += value * powers
    return product


def _tangent(powers: Array, bend: float) -> Array:
    """The straight line as which a polynomial of the distance goes on from `bend`."""
    at = bend ** np.arange(powers.shape[-2])
    value, slope = at @ powers, at[:-1] @ _derived(powers)
    return np.stack([value - bend * slope, slope], axis=-2)


def annulus_volume(duct: Duct, span_joints: Reals) -> Array:
    """Volume () [m^3] of the annulus between hub, shroud, inlet and outlet; in a cascade, of one metre of its width.

    The integral of pi r^2 dx around the meridional outline (Pappus and Green). `span_joints` are the v at which inlet
    and outlet lose derivatives.
    """
    ends = np.array([duct.low, duct.high])
    u, along = panels(np.unique([*ends, *duct.edges, *duct.joints_within()]), OUTLINE_POINTS)
    walls = duct.lines(np.array([0.0, 1.0]))
    point, slope = walls.position(u), walls.position(u, 1)
    flux = np.sum(along * _flux_density(duct, point[..., 1]) * slope[..., 0], axis=-1)
    total: Array = flux[..., 0] - flux[..., 1]
    pieces = np.unique([0.0, *span_joints, 1.0])
    passed = _passed(duct, ends, pieces)
    for _ in range(HALVINGS):
        # the ends are no polynomials of v where walls straighten: their directions have length one
        pieces = np.sort(np.concatenate([pieces, 0.5 * (pieces[1:] + pieces[:-1])]))
        finer = _passed(duct, ends, pieces)
        change = np.real(finer - passed).ravel()
        if np.max(np.square(change)) <= (RING_ROUNDING * np.max(np.real(total + passed[..., 1] - passed[..., 0]))) ** 2:
            break
        passed = finer
    total = total + passed[..., 1] - passed[..., 0]
    return -total


def _passed(duct: Duct, ends: Reals, pieces: Reals) -> Array:
    """The flux (..., 2) through inlet and outlet, piece by piece along the span."""
    passed: Array = np.zeros(2)
    for low, high in pairwise(pieces):
        lines = duct.lines(np.concatenate([[0.0], low + (high - low) * _NODES, [1.0]])).position(ends)[..., 1:-1, :, :]
        passed = passed + np.sum(
            _WEIGHTS[:, None] * _flux_density(duct, lines[..., 1]) * (_DERIVATIVE @ lines[..., 0]), axis=-2
        )
    return passed


def _derivative_matrix(nodes: Reals) -> Reals:
    """The matrix from a polynomial's values at nodes to its derivative's there."""
    powers = legendre.legvander(2.0 * nodes - 1.0, len(nodes) - 1)
    slopes = [2.0 * legendre.legval(2.0 * nodes - 1.0, legendre.legder(row)) for row in np.eye(len(nodes))]
    return np.asarray(np.stack(slopes, axis=-1) @ np.linalg.inv(powers))


def _flux_density(duct: Duct, radius: Array) -> Array:
    """What is integrated over dx: pi r^2, or the height in a cascade."""
    return np.pi * radius**2 if duct.revolved else radius


_NODES, _WEIGHTS = gauss(OUTLINE_POINTS)
_DERIVATIVE = _derivative_matrix(_NODES)
