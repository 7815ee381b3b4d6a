"""A blade cut off by a surface of revolution, or in a cascade by a cylinder along y, whose meridian crosses its span.

With X(s, V) the uncut blade's point at s on the section of span fraction V, and C(s) the V at which the line of
constant s meets the cut, the cut blade is

    W(s, v) = X(s, V(s, v)),   V = v + (C(s) - e) g(v),   g = (max(0, h - h0) / (1 - h0))^p,

e = 0 or 1 the end that is cut off, and h the distance |v - (1 - e)| from the other end. Up to h0 the curves of constant
v are the uncut blade's; from there they bend to the cut.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from bladewright.blade.exact.family_sections import FlowPathSections
from bladewright.blade.exact.span_pieces import SpanPieces
from bladewright.blade.flow_path.channel import ChannelCurve
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.flow_path.stream_surface_map import StreamSurfaceMap, Taylor
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, concatenated, cross2, length, unit
from bladewright.nurbs.basis import Reals
from bladewright.section.outline import EdgeDerivatives

NODES = 12
"""Chebyshev nodes along the span on each piece of the part that bends to the cut."""
LONGEST_PIECE = 0.25
"""Longest piece in span fractions: with twelve nodes laws and stream surfaces are exact to rounding on it."""
BENT = 5.0
"""Length of the part in which curves of constant v bend to the cut, over what is cut off at most: with power 3 they
come no closer than to 1 - 3/5 of their distance."""
POWER = 3
"""Power p with which they bend: two derivatives along the span are continuous where they begin to."""
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
            kept = breaks[height < self.bent_from]
            bent = breaks[height > self.bent_from]
            bent = bent[(bent < self.level) if self.end else (bent > self.level)]
            v = np.linspace(0.0, 1.0, 2001)
            bent = np.interp(bent, self.span(v, np.array([self.level]))[:, 0], v)
            graded = self._graded()
            graded = graded if self.end else 1.0 - graded
            return np.sort(np.concatenate([kept, bent, graded, np.full(degree - self.power + 1, start)]))
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


@dataclass(frozen=True, kw_only=True, eq=False)
class CutSections(FlowPathSections):
    """Curves of constant v (m,) of a cut blade.

    Where they bend to the cut they are no sections, and lie on no stream surface: there `lines`, plane points and
    camber are those of the uncut blade's sections nearby.
    """

    uncut: FlowPathSections
    """of the uncut blade: m beside the curves, then those at the nodes of the cut's pieces"""
    cut: SpanCut

    def plane_points(self, s: Reals) -> tuple[Array, Array]:
        upper, lower = (self._beside(side, -3) for side in self.uncut.plane_points(s))
        return upper, lower

    @property
    def skinning(self) -> Literal["sections", "ruled", "developable"]:
        return self.uncut.skinning

    @property
    def edge_kinds(self) -> tuple[str, str]:
        return self.uncut.edge_kinds

    @property
    def back(self) -> float | None:
        return self.uncut.back

    def camber(self, share: Reals) -> Array:
        return self._beside(self.uncut.camber(share), -3)

    def camber_ends(self) -> tuple[Array, Array]:
        first, last = (self._beside(each, -2) for each in self.uncut.camber_ends())
        return first, last

    def outlines(self) -> Reals:
        return self.uncut.outlines()[: len(self.v)]

    def camber_tangents(self) -> tuple[Array, Array] | None:
        found = self.uncut.camber_tangents()
        return None if found is None else (self._beside(found[0], -2), self._beside(found[1], -2))

    def chord_line(self, u: Array, order: int = 0) -> Array:
        own = np.broadcast_to(u, (*np.shape(u)[:-2], len(self.v), np.shape(u)[-1]))
        more = len(self.uncut.v) - len(self.v)
        padded = concatenated([own, *[own[..., :1, :]] * more], axis=-2)
        return self._beside(self.uncut.chord_line(padded, order), -3)

    def leading_edge(self) -> EdgeDerivatives:
        return self._edge(self.uncut.leading_edge())

    def trailing_edge(self) -> EdgeDerivatives:
        return self._edge(self.uncut.trailing_edge())

    def lower_edges(self) -> tuple[EdgeDerivatives | None, EdgeDerivatives | None]:
        first, last = (None if row is None else self._edge(row) for row in self.uncut.lower_edges())
        return first, last

    def faces(self, w: Reals) -> dict[str, Array]:
        return {name: self._cut(points)[0] for name, points in self.uncut.faces(w).items()}

    def points(self, s: Reals) -> tuple[Array, Array]:
        both, _ = self._cut(concatenated(self.uncut.points(s), axis=-2))
        return both[..., : len(s), :], both[..., len(s) :, :]

    def points_and_normals(self, s: Reals) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Points, and unit normals of the stream surfaces and of the cut; zero between, where there is no surface."""
        points, normals = (concatenated(each, axis=-2) for each in self.uncut.points_and_normals(s))
        both, met = self._cut(points)
        own = self._beside(normals, -3) * (self.cut.bend(self.v) == 0.0)[:, None, None]
        for row in np.flatnonzero(self.v == self.cut.end):
            at_cut = self.cut.normals(both[..., row, :, :], met)[..., None, :, :]
            own = own + at_cut * (np.arange(len(self.v)) == row)[:, None, None]
        first, last = ((each[..., : len(s), :], each[..., len(s) :, :]) for each in (both, own))
        return first, last

    def ends(self, s: Reals) -> tuple[Array, Crossing]:
        """Points (..., 2 k, 3) at which the upper, then the lower side's lines at s (k,) meet the cut, and where."""
        nodes = concatenated(self.uncut.points(s), axis=-2)[..., len(self.v) :, :, :]
        met = self.cut.crossing(nodes)
        return self.cut.at(nodes, met.span[..., None, :])[..., 0, :, :], met

    def _beside(self, rows: Array, axis: int) -> Array:
        return np.asarray(np.take(rows, np.arange(len(self.v)), axis=axis))

    def _cut(self, points: Array) -> tuple[Array, Crossing]:
        """Points (..., m, k, 3) of the cut blade from those of the uncut one at all its rows, and where lines end."""
        own, nodes = self._beside(points, -3), points[..., len(self.v) :, :, :]
        met, bends = self.cut.crossing(nodes), self.cut.bend(self.v) > 0.0
        moved = self.cut.at(nodes, self.cut.span(self.v[bends], met.span))
        found = np.zeros(np.broadcast_shapes(own.shape, (*moved.shape[:-3], 1, 1, 1)), np.result_type(own, moved))
        found[...] = own
        found[..., bends, :, :] = moved
        return found, met

    def _edge(self, row: EdgeDerivatives) -> EdgeDerivatives:
        """Rows (..., m, 3) of the cut blade: W and its derivatives by s, by those of X and of V."""
        nodes = tuple(part[..., len(self.v) :, None, :] for part in row)
        point, first, second = nodes
        cut, bends = self.cut, self.cut.bend(self.v) > 0.0
        met = cut.crossing(point)
        rate, turn = (each[..., None, :, None] for each in cut.rates((point, first, second), met))
        v = self.v[bends]
        span, share = cut.span(v, met.span), cut.bend(v)[:, None, None]
        rate, turn = share * rate, share * turn
        slope = cut.at(point, span, 1)
        moved = (
            cut.at(point, span),
            cut.at(first, span) + slope * rate,
            cut.at(second, span)
            + 2.0 * cut.at(first, span, 1) * rate
            + cut.at(point, span, 2) * rate**2
            + slope * turn,
        )
        parts = []
        for own, new in zip((self._beside(part, -2) for part in row), moved, strict=True):
            whole = np.broadcast_shapes(own.shape, (*new.shape[:-3], 1, 1))
            found = np.zeros(whole, np.result_type(own, new))
            found[...] = own
            found[..., bends, :] = new[..., 0, :]
            parts.append(found)
        return EdgeDerivatives(*parts)


def _solved(across: Array, along: Array, right: Array) -> tuple[Array, Array]:
    """a and b (..., k) of a `across` - b `along` = `right`, (..., k, 2) each."""
    area = cross2(across, along)
    with np.errstate(all="ignore"):
        return cross2(right, along) / area, cross2(right, across) / area


def cut_sections(uncut: FlowPathSections, v: Reals, cut: SpanCut) -> CutSections:
    """The curves at v (m,) of a blade, from its uncut sections at `spans_of_cut(v, cut)`."""
    return CutSections(v=v, lines=uncut.lines.rows(list(range(len(v)))), uncut=uncut, cut=cut)


def spans_of_cut(v: Reals, cut: SpanCut) -> Reals:
    """Span fractions of the uncut blade that the cut one's curves at v (m,) are made from."""
    beside = np.clip(cut.span(v, np.array([cut.level]))[:, 0], 0.0, 1.0)
    return np.concatenate([np.where(cut.bend(v) > 0.0, beside, v), cut.pieces.places])
