"""Native sides and faces of blunt edges that interpolate the exact blade.

The edges' two derivatives are built into the sides' control points.
"""

from collections.abc import Mapping, Sequence
from itertools import islice
from typing import NamedTuple, Protocol

import numpy as np

from bladewright.blade.native.knots import DEGREE, Knots
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array, concatenated
from bladewright.numerics.solving import solved
from bladewright.nurbs.basis import Reals, basis
from bladewright.nurbs.surface import Surface
from bladewright.section.native import interpolated_along_u
from bladewright.section.outline import EdgeDerivatives

ACROSS_EDGE = np.arange(1, DEGREE) / DEGREE
"""Places across the face of an edge at which it is interpolated, besides its ends."""


class SideStack(Protocol):
    """What sides interpolate along curves of constant v: sections, or curves on other native sides."""

    @property
    def v(self) -> Reals:
        """(m,) places along the span."""

    def points(self, s: Reals) -> tuple[Array, Array]:
        """Points (..., m, len(s), 3) [m] of the upper and the lower side."""

    def leading_edge(self) -> EdgeDerivatives:
        """The upper side at the leading edge, (..., m, 3) each."""

    def trailing_edge(self) -> EdgeDerivatives:
        """The upper side at the trailing edge."""

    def lower_edges(self) -> tuple[EdgeDerivatives | None, EdgeDerivatives | None]:
        """The lower side at both edges; None where it is the upper side's `mirrored`."""

    def faces(self, w: Reals) -> dict[str, Array]:
        """Points (..., m, len(w), 3) of the native faces of blunt edges by name, w from the upper to the lower side."""


def native_sides(sections: SideStack, knots: Knots) -> tuple[Array, Array]:
    """Control nets (..., n_u, n_v, 3) of the upper and the lower side from sections at `knots.sites_v`.

    Across each edge the sides share the row P0, the rows P0 + D and P0 - D and the row of second derivatives E, so
    that curvature is continuous there for every v.
    """
    edges = sections.leading_edge(), sections.trailing_edge()
    return _sides(edges, sections.lower_edges(), sections.points(knots.sites_u), knots)


class InterpolationData(NamedTuple):
    """What native sides interpolate at their sites along the span (m,), for derivatives: the nets are linear in it."""

    leading_edge: EdgeDerivatives
    trailing_edge: EdgeDerivatives
    upper: Array
    """points (..., m, n_u - 6, 3)"""
    lower: Array
    """points (..., m, n_u - 6, 3)"""
    lower_edges: tuple[EdgeDerivatives | None, EdgeDerivatives | None] = (None, None)
    """the lower side at both edges where it does not mirror the upper one"""
    faces: Mapping[str, Array] = FrozenMapping({})
    """points (..., m, 4, 3) of the faces of blunt edges by name"""


def interpolation_data(sections: SideStack, knots: Knots) -> InterpolationData:
    """What the sides interpolate of sections at `knots.sites_v`."""
    edges = sections.leading_edge(), sections.trailing_edge()
    return InterpolationData(
        *edges, *sections.points(knots.sites_u), sections.lower_edges(), sections.faces(ACROSS_EDGE)
    )


def sides_through(data: InterpolationData, knots: Knots) -> tuple[Array, Array]:
    """Control nets (..., n_u, n_v, 3) of the upper and the lower side that interpolate given data."""
    return _sides((data.leading_edge, data.trailing_edge), data.lower_edges, (data.upper, data.lower), knots)


def nets_through(data: InterpolationData, knots: Knots) -> dict[str, Array]:
    """The same with those (..., 6, n_v, 3) of the faces of blunt edges, by name."""
    upper, lower = sides_through(data, knots)
    edges = {name: edge_net(name, (upper, lower), _rows(points, knots)) for name, points in data.faces.items()}
    return {"upper": upper, "lower": lower, **edges}


def _rows(points: Array, knots: Knots) -> Array:
    """Control points (..., k, n_v, 3) of curves along v through points (..., m, k, 3) at their sites."""
    rows = solved(basis(knots.v, DEGREE, knots.sites_v), points.reshape(*points.shape[:-2], -1)).reshape(points.shape)
    return np.swapaxes(rows, -3, -2)


def _sides(
    edges: tuple[EdgeDerivatives, EdgeDerivatives],
    own_lower: Sequence[EdgeDerivatives | None],
    points_of_sides: tuple[Array, Array],
    knots: Knots,
) -> tuple[Array, Array]:
    """The nets through the points of both sides and the upper side's edges; the lower side's where it has its own."""
    matrix = basis(knots.v, DEGREE, knots.sites_v)
    given = [*edges, *(edge for edge in own_lower if edge is not None)]
    ends = solved(matrix, concatenated([part for edge in given for part in edge], axis=-1))
    parts = iter(np.split(ends, 3 * len(given), axis=-1))
    upper = EdgeDerivatives(*islice(parts, 3)), EdgeDerivatives(*islice(parts, 3))
    lower = [None if edge is None else EdgeDerivatives(*islice(parts, 3)) for edge in own_lower]
    sides = []
    for points, at_edges in zip(points_of_sides, (upper, lower_edges(upper, lower)), strict=True):
        sides.append(interpolated_along_u(_rows(points, knots), *at_edges, knots.u))
    return sides[0], sides[1]


def lower_edges(
    upper: Sequence[EdgeDerivatives], lower: Sequence[EdgeDerivatives | None]
) -> tuple[EdgeDerivatives, EdgeDerivatives]:
    """The lower side at both edges: its own, or the upper side's mirrored."""
    first, last = (edge.mirrored() if own is None else own for edge, own in zip(upper, lower, strict=True))
    return first, last


def edge_faces(sections: SideStack, upper: Surface, lower: Surface, knots: Knots) -> dict[str, Surface]:
    """The faces by name, from sections at `knots.sites_v`; u from the upper to the lower side, v along the span.

    They have the control points of both sides' edges. A face is one polynomial of degree 5 along u: it is as short as
    the edge is thick, so its arc about the axis is below rounding from that.
    """
    faces = sections.faces(ACROSS_EDGE)
    return {name: edge_face(name, (upper, lower), _rows(points, knots)) for name, points in faces.items()}


def edge_face(name: str, sides: tuple[Surface, Surface], rows: Array) -> Surface:
    """One of them, through curves along v at ACROSS_EDGE, by their control points (4, m, 3) on the sides' knots."""
    return Surface(
        control_points=edge_net(name, (sides[0].control_points, sides[1].control_points), rows),
        knots_u=np.repeat([0.0, 1.0], DEGREE + 1),
        knots_v=sides[0].knots_v,
        degree_u=DEGREE,
        degree_v=DEGREE,
    )


def edge_net(name: str, sides: tuple[Array, Array], rows: Array) -> Array:
    """Its control points (..., 6, m, 3) from the nets of both sides and those (..., 4, m, 3) of such curves."""
    along = basis(np.repeat([0.0, 1.0], DEGREE + 1), DEGREE, ACROSS_EDGE)
    ends = np.stack([net[..., 0 if name == "leading_edge" else -1, :, :] for net in sides], axis=-3)
    right = rows - np.moveaxis(np.tensordot(along[:, [0, -1]], ends, axes=(1, -3)), 0, -3)
    inner = solved(along[:, 1:-1], right.reshape(*right.shape[:-2], -1)).reshape(right.shape)
    return concatenated([ends[..., :1, :, :], inner, ends[..., 1:, :, :]], axis=-3)
