"""A blade cut off by a surface of revolution, or in a cascade by a cylinder along y, whose meridian crosses its span.

With X(s, V) the uncut blade's point at s on the section of span fraction V, and C(s) the V at which the line of
constant s meets the cut, the cut blade is

    W(s, v) = X(s, V(s, v)),   V = v + (C(s) - e) g(v),   g = (max(0, h - h0) / (1 - h0))^p,

e = 0 or 1 the end that is cut off, and h the distance |v - (1 - e)| from the other end. Up to h0 the curves of constant
v are the uncut blade's; from there they bend to the cut.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bladewright.blade.exact.span_pieces import SpanPieces
from bladewright.blade.flow_path.channel import ChannelCurve
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.flow_path.stream_surface_map import StreamSurfaceMap, Taylor
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, concatenated, cross2, length, unit
from bladewright.nurbs.basis import JOINT_TOLERANCE, Reals

NODES = 12
"""Chebyshev nodes along the span on each piece of the part that bends to the cut."""
LONGEST_PIECE = 0.25
"""Longest piece in span fractions: with twelve nodes laws and stream surfaces are exact to rounding on it."""
BENT = 5.0
"""Length of the part in which curves of constant v bend to the cut, over what is cut off at most: with power 3 they
come no closer than to 1 - 3/5 of their distance."""
POWER = 3
"""Power p with which they bend: two derivatives along the span are continuous where they begin to."""
APART = 0.1
"""Least distance of a knot that only grades the spans from any other, of its distance from where curves bend: a shorter
span undoes the grading, and OpenCASCADE takes knots 1e-15 apart for one [-]"""
GRADED = 3.0
"""Ratio of neighbouring knot spans below the part that bends."""
STEPS = 30
"""Newton steps after which no crossing is expected any more; mostly four suffice."""
SAMPLES = 201
"""Points of the meridian among which the nearest begins the search."""


class Crossing(NamedTuple):
    """Where lines of constant s meet the cut."""

    span: Array
    """(..., k) span fraction C of the uncut blade"""
    t: Array
    """(..., k) parameter of the meridian"""


@dataclass(frozen=True, kw_only=True, eq=False)
class SpanCut:
    """A meridian that a blade is cut off by, and how curves of constant v come to it."""

    meridian: ChannelCurve
    """in (x, r), along the flow; its knots are over its own parameter"""
    end: int
    """which end is cut off: 0 that at the hub, 1 that at the shroud"""
    level: float
    """mean span fraction at which the uncut blade meets it"""
    straight: bool
    """whether lines of constant s are straight and run by v, and are to stay so"""
    bent_from: float
    """h0 in the formula"""
    breaks: Reals
    """(b,) span fractions at which the uncut blade loses derivatives"""
    mapping: StreamSurfaceMap

    @property
    def power(self) -> int:
        """p in the formula: 1 where the whole blade bends."""
        return POWER if self.bent_from > 0.0 else 1

    @cached_property
    def pieces(self) -> SpanPieces:
        """Of the part of the span that bends, uncut."""
        if self.straight:
            return SpanPieces(ends=np.array([0.0, 1.0]), count=2)
        low, high = (self.bent_from, 1.0) if self.end else (0.0, 1.0 - self.bent_from)
        even = np.linspace(low, high, int(np.ceil((high - low) / LONGEST_PIECE)) + 1)
        inside = self.breaks[(self.breaks > low) & (self.breaks < high)]
        return SpanPieces(ends=np.union1d(even, inside), count=NODES)

    def bend(self, v: Reals) -> Reals:
        """g (m,) at v (m,)."""
        height = v if self.end else 1.0 - v
        return (np.maximum(0.0, height - self.bent_from) / (1.0 - self.bent_from)) ** self.power

    def span(self, v: Reals, met: Array) -> Array:
        """V (..., m, k) at v (m,) on lines that meet the cut at C (..., k)."""
        return v[:, None] + (met[..., None, :] - self.end) * self.bend(v)[:, None]

    def uncut_breaks(self, breaks: Reals, degree: int) -> Reals:
        """Knots v (n,) of sides of a degree, from those of the uncut blade's, each as often as derivatives are lost."""
        if self.power > 1:
            height = breaks if self.end else 1.0 - breaks
            start = self.bent_from if self.end else 1.0 - self.bent_from
            at_start = np.square(breaks - start) < JOINT_TOLERANCE**2
            kept = breaks[(height < self.bent_from) & ~at_start]
            bent = breaks[(height > self.bent_from) & ~at_start]
            bent = bent[(bent < self.level) if self.end else (bent > self.level)]
            v = np.linspace(0.0, 1.0, 2001)
            bent = np.interp(bent, self.span(v, np.array([self.level]))[:, 0], v)
            graded = self._graded()
            graded = graded if self.end else 1.0 - graded
            own = np.concatenate([kept, bent, [0.0, 1.0]])
            clear = APART**2 * np.square(graded - start)
            graded = graded[np.min(np.square(graded[:, None] - own), axis=1) > clear]
            times = max(degree - self.power + 1, int(np.sum(at_start)))
            return np.sort(np.concatenate([kept, bent, graded, np.full(times, start)]))
        own = (breaks - (1 - self.end) * self.level) / (self.level if self.end else 1.0 - self.level)
        return own[(own > 0.0) & (own < 1.0)]

    def _graded(self) -> Reals:
        """Heights (n,) of single knots below where curves bend, with spans that grow from there.

        Beside a much shorter one the error of a span is largest near its end, where it is not looked for.
        """
        found, width = [self.bent_from], 1.0 - self.bent_from
        while found[-1] > (GRADED + 1.0) * width:
            width *= GRADED
            found.append(found[-1] - width)
        return np.array(found[1:])

    def crossing(self, nodes: Array) -> Crossing:
        """Where lines through `nodes` (..., n, k, 3) meet the cut; raises DesignError where one does not."""
        real, meridian = real_first(nodes, 3), self.meridian.real()
        knots = meridian.knots
        samples = np.linspace(knots[0], knots[-1], SAMPLES)
        span = np.full(real.shape[1], self.level)
        place, _ = self._place(real, span)
        t = samples[np.argmin(length(place[:, None] - meridian.values(samples)), axis=1)]
        low, high = self.pieces.ends[[0, -1]]
        for _ in range(STEPS):
            steps = self._steps(real, meridian, span, t)
            span, t = np.clip(span - steps[0], low, high), np.clip(t - steps[1], knots[0], knots[-1])
            if np.max(np.square(steps[0])) < 1e-28:
                break
        if not np.max(np.square(steps[0])) < 1e-18:
            worst = int(np.argmax(np.square(steps[0])))
            x, r = self._place(real, span)[0][worst]
            raise DesignError(
                f"the blade does not reach the surface that cuts it off near (x, r) = ({x:.5g}, {r:.5g}) m, span "
                f"fraction {span[worst]:.3f}: let the surface lie between hub and shroud all along the blade"
            )
        if np.iscomplexobj(nodes) or np.iscomplexobj(self.meridian.points):
            steps = self._steps(nodes, self.meridian, span, t)
            return Crossing(span - 1j * np.imag(steps[0]), t - 1j * np.imag(steps[1]))
        return Crossing(span, t)

    def rates(self, nodes: tuple[Array, Array, Array], met: Crossing) -> tuple[Array, Array]:
        """First and second derivatives (..., k) of C by s, from the nodes' (..., n, k, 3) point and derivatives.

        By differentiating X(s, C(s)) = meridian(t(s)) in (x, r) twice.
        """
        point, slope, bend = (self._at(nodes[0], met.span, order) for order in range(3))
        along, twist = (self._at(nodes[1], met.span, order) for order in range(2))
        curved = self._at(nodes[2], met.span)
        none = np.zeros_like(point)
        across = self._series(Taylor(point, slope, none)).first
        tangent, turn = (self._meridian_at(met.t, order) for order in (1, 2))
        rate, t_rate = _solved(across, tangent, -self._series(Taylor(point, along, none)).first)
        first = along + slope * rate[..., None]
        second = curved + 2.0 * twist * rate[..., None] + bend * rate[..., None] ** 2
        right = turn * t_rate[..., None] ** 2 - self._series(Taylor(point, first, second)).second
        return rate, _solved(across, tangent, right)[0]

    def normals(self, points: Array, met: Crossing) -> Array:
        """Unit normals (..., k, 3) of the cut at points (..., k, 3) on it, towards the shroud."""
        slope = unit(self._meridian_at(met.t, 1))
        if not self.mapping.revolved:
            return np.stack(np.broadcast_arrays(-slope[..., 1], 0.0 * slope[..., 0], slope[..., 0]), axis=-1)
        outward = slope[..., :1] * unit(points[..., 1:])
        return concatenated([-slope[..., 1:] + 0.0 * outward[..., :1], outward], axis=-1)

    def _steps(self, nodes: Array, meridian: ChannelCurve, span: Reals, t: Reals) -> tuple[Array, Array]:
        """Newton's steps (..., k) of the span fraction and of t."""
        place, across = self._place(nodes, span)
        return _solved(across, meridian.values(t, 1), place - meridian.values(t))

    def _place(self, nodes: Array, span: Reals) -> tuple[Array, Array]:
        """(x, r) (..., k, 2) of the lines through nodes at span fractions (k,), and its derivative by those."""
        point, slope = self._at(nodes, span), self._at(nodes, span, 1)
        found = self._series(Taylor(point, slope, np.zeros_like(point)))
        return found.value, found.first

    @staticmethod
    def _weighted(weights: Array, nodes: Array) -> Array:
        return np.asarray(np.einsum("...kn,...nkd->...kd", weights, nodes))

    def _at(self, nodes: Array, span: Array, order: int = 0) -> Array:
        """Points, or derivatives by V (..., k, 3), of lines through nodes (..., n, k, 3) at span fractions (..., k)."""
        return self._weighted(self.pieces.weights(span, order), nodes)

    def at(self, nodes: Array, span: Array, order: int = 0) -> Array:
        """The same (..., m, k, 3) at span fractions (..., m, k)."""
        flat = self.pieces.weights(span.reshape(*span.shape[:-2], -1), order)
        weights = flat.reshape(*flat.shape[:-2], *span.shape[-2:], flat.shape[-1])
        return np.asarray(np.einsum("...mkn,...nkd->...mkd", weights, nodes))

    def _series(self, along: Taylor) -> Taylor:
        """(x, r) (..., k, 2) of points (..., k, 3) with their derivatives along curves."""
        x, y, z = (Taylor(*(part[..., i] for part in along)) for i in range(3))
        if self.mapping.revolved:
            square = Taylor(*(a + b for a, b in zip(y * y, z * z, strict=True)))
            r = np.sqrt(square.value)
            z = square.composed(r, 0.5 / r, -0.25 / r**3)
        return Taylor(*(np.stack(np.broadcast_arrays(a, b), axis=-1) for a, b in zip(x, z, strict=True)))

    def _meridian_at(self, t: Array, order: int) -> Array:
        """Points, or derivatives (..., k, 2), at t (..., k) that may carry an imaginary step."""
        real = real_first(t, 1)
        found = self.meridian.values(real, order)
        return (
            found + 1j * np.imag(t)[..., None] * self.meridian.values(real, order + 1) if np.iscomplexobj(t) else found
        )


def _solved(across: Array, along: Array, right: Array) -> tuple[Array, Array]:
    """a and b (..., k) of a `across` - b `along` = `right`, (..., k, 2) each."""
    area = cross2(across, along)
    with np.errstate(all="ignore"):
        return cross2(right, along) / area, cross2(right, across) / area
