"""The curves of constant v of a blade that is cut off: points and edges on them, as sections have them."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bladewright.blade.exact.family_sections import FlowPathSections
from bladewright.blade.exact.span_cut import Crossing, SpanCut
from bladewright.numerics.elementary import Array, concatenated
from bladewright.nurbs.basis import Reals
from bladewright.section.outline import EdgeDerivatives


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


def cut_sections(uncut: FlowPathSections, v: Reals, cut: SpanCut) -> CutSections:
    """The curves at v (m,) of a blade, from its uncut sections at `spans_of_cut(v, cut)`."""
    return CutSections(v=v, lines=uncut.lines.rows(list(range(len(v)))), uncut=uncut, cut=cut)


def spans_of_cut(v: Reals, cut: SpanCut) -> Reals:
    """Span fractions of the uncut blade that the cut one's curves at v (m,) are made from."""
    beside = np.clip(cut.span(v, np.array([cut.level]))[:, 0], 0.0, 1.0)
    return np.concatenate([np.where(cut.bend(v) > 0.0, beside, v), cut.pieces.places])
