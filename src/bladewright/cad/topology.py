"""The edges that the faces of a body share, found from the native boundary curves."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from bladewright.cad.native_body import ClosedBody, extent
from bladewright.errors import CadError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

COINCIDENT = 1e-12
"""Largest distance of equal points, as a fraction of the body's extent. Neighbours share their boundary control points
to the last bit, so that this only allows for the rounding of one more operation, such as a turn by a pitch."""
ON_BOUNDARY = 1e-6
"""Largest distance of a trimmed face's boundary from the edge that it runs along, as a fraction of the body's extent.
It only decides which edge is meant: the distance itself is measured, and becomes the gap of the edge."""

SAME_KNOT = 1e-12
"""Largest difference of equal knots, as a fraction of the edge's parameter range: rounding."""

SIDES = ("v = 0", "u = 1", "v = 1", "u = 0")
"""The sides of an untrimmed face in the order of a counter-clockwise run around its parameter square."""


@dataclass(frozen=True, kw_only=True)
class Coedge:
    """The use of an edge by a face: which side of the face lies on it, and in which direction the face runs there."""

    face: str
    """name of the face"""
    side: int
    """index into SIDES, or into the boundary curves of a trimmed face"""
    along: bool
    """whether the boundary of the face runs in the direction of the edge's parameter"""
    span: tuple[float, float]
    """parameters of the side, or of the boundary curve, between which the edge lies, the smaller one first"""


@dataclass(frozen=True, kw_only=True, eq=False)
class BodyEdge:
    """An edge of the body: its space curve [m], and the faces that meet there."""

    curve: Curve
    coedges: tuple[Coedge, ...]
    start: int
    """index of the vertex at the curve's first parameter"""
    end: int
    """index of the vertex at the curve's last parameter"""


@dataclass(frozen=True, kw_only=True, eq=False)
class DegenerateEdge:
    """A side of a face, or a part of one, that degenerates to a point."""

    coedge: Coedge
    vertex: int
    """index of the point"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Topology:
    """Edges and vertices of a closed body."""

    edges: tuple[BodyEdge, ...]
    degenerate_edges: tuple[DegenerateEdge, ...]
    vertices: Array
    """(n, 3) [m]"""


def topology(built: ClosedBody) -> Topology:
    """The edges that the faces of a body share, and the vertices where those meet.

    A side of an untrimmed face is split where it has a corner (an inner knot of full multiplicity), and each piece is
    an edge of its own. Untrimmed faces are neighbours where two such pieces have the same control points, in either
    direction, and the same knots up to a linear change of the parameter. A trimmed face is a neighbour along the edges
    that its boundary follows. Raises CadError where an edge does not belong to exactly two faces.
    """
    size = extent(built)
    edge_curves: list[tuple[Curve, list[Coedge]]] = []
    points: list[tuple[Array, Coedge]] = []
    for name, face in built.surfaces.items():
        if isinstance(face, Surface):
            for side in range(4):
                whole, along = side_curve(face, side)
                flat = np.ptp(whole.control_points, axis=0).max() <= COINCIDENT * size
                for curve in (whole,) if flat else smooth_pieces(whole):
                    coedge = Coedge(face=name, side=side, along=along, span=curve.domain)
                    net = curve.control_points
                    if np.ptp(net, axis=0).max() <= COINCIDENT * size:
                        points.append((net[0], coedge))
                    else:
                        _add_coedge(edge_curves, curve, coedge, COINCIDENT * size)
    for name, face in built.surfaces.items():
        if isinstance(face, TrimmedSurface):
            for side, boundary in enumerate(face.boundary):
                _add_trimmed_boundary(edge_curves, face, boundary, name, side, ON_BOUNDARY * size)
    _require_pairs(edge_curves)
    vertices: list[Array] = []
    edges = tuple(
        BodyEdge(
            curve=curve,
            coedges=tuple(coedges),
            start=_vertex(vertices, curve.control_points[0], COINCIDENT * size),
            end=_vertex(vertices, curve.control_points[-1], COINCIDENT * size),
        )
        for curve, coedges in edge_curves
    )
    degenerate_edges = tuple(
        DegenerateEdge(coedge=coedge, vertex=_vertex(vertices, point, COINCIDENT * size)) for point, coedge in points
    )
    return Topology(edges=edges, degenerate_edges=degenerate_edges, vertices=np.array(vertices))


def side_curve(face: Surface, side: int) -> tuple[Curve, bool]:
    """The boundary curve of an untrimmed face on one of SIDES, and whether it runs counter-clockwise."""
    along_u = side in {0, 2}
    index = (slice(None), 0 if side == 0 else -1) if along_u else (0 if side == 3 else -1, slice(None))
    curve = Curve(
        control_points=face.control_points[index],
        knots=face.knots_u if along_u else face.knots_v,
        degree=face.degree_u if along_u else face.degree_v,
        weights=None if face.weights is None else face.weights[index],
    )
    return curve, side in {0, 1}


def smooth_pieces(curve: Curve) -> tuple[Curve, ...]:
    """The parts of a curve between its corners (inner knots of full multiplicity), with the same control points."""
    degree = curve.degree
    inner, counts = np.unique(curve.knots[degree + 1 : -degree - 1], return_counts=True)
    cuts = [curve.knots[0], *inner[counts == degree], curve.knots[-1]]
    # index of the control point that the curve passes through at a corner
    places = [0, *(int(np.searchsorted(curve.knots, cut)) - 1 for cut in cuts[1:-1]), len(curve.control_points) - 1]
    return tuple(
        Curve(
            control_points=curve.control_points[first : last + 1],
            knots=np.concatenate([[start], curve.knots[first + 1 : last + degree + 1], [end]]),
            degree=degree,
            weights=None if curve.weights is None else curve.weights[first : last + 1],
        )
        for (start, end), (first, last) in zip(pairwise(cuts), pairwise(places), strict=True)
    )


def _add_coedge(edge_curves: list[tuple[Curve, list[Coedge]]], curve: Curve, coedge: Coedge, tolerance: float) -> None:
    for known, coedges in edge_curves:
        for backwards in (False, True):
            if _same(known, curve, tolerance, backwards=backwards):
                coedges.append(replace(coedge, along=coedge.along != backwards))
                return
    edge_curves.append((curve, [coedge]))


def _same(one: Curve, other: Curve, tolerance: float, *, backwards: bool) -> bool:
    if one.degree != other.degree or one.control_points.shape != other.control_points.shape:
        return False
    step = -1 if backwards else 1
    if np.max(np.abs(one.control_points - other.control_points[::step])) > tolerance:
        return False
    shares = _shares(other.knots)
    if np.max(np.abs(_shares(one.knots) - (1.0 - shares[::-1] if backwards else shares))) > SAME_KNOT:
        return False
    weights = [np.ones(1) if curve.weights is None else curve.weights for curve in (one, other)]
    return bool(np.allclose(weights[0], weights[1][::step], rtol=1e-12, atol=0.0))


def _shares(knots: Array) -> Array:
    return (knots - knots[0]) / (knots[-1] - knots[0])


def _add_trimmed_boundary(
    edge_curves: list[tuple[Curve, list[Coedge]]],
    face: TrimmedSurface,
    boundary: Curve,
    name: str,
    side: int,
    tolerance: float,
) -> None:
    """Add the boundary curve of a trimmed face to the edge that it follows, or to several edges one after another."""
    s = np.linspace(boundary.knots[0], boundary.knots[-1], 2001)
    trace = face.surface(*boundary(s).T)
    found, nearest = [], np.inf
    for curve, coedges in edge_curves:
        first, middle, last = curve(curve.knots[0] + np.array([0.0, 0.5, 1.0]) * (curve.knots[-1] - curve.knots[0]))
        # edge and boundary have different parameters, so that distances are measured to the boundary as a polyline
        distance = _to_polyline(middle, trace)
        for start, end in ((first, last), (last, first)):
            nearest = min(nearest, max(_distance(trace[0], start), _distance(trace[-1], end), distance[0]))
        if max(distance[0], *(_to_polyline(end, trace)[0] for end in (first, last))) <= tolerance:
            found.append((distance[1], coedges, first, last))
    place, reached = trace[0], boundary.knots[0]
    for at, coedges, first, last in sorted(found, key=lambda each: each[0]):
        along = _distance(place, first) <= _distance(place, last)
        start, end = (first, last) if along else (last, first)
        if _distance(place, start) > tolerance:
            break
        past = s[0] + (s[-1] - s[0]) * _to_polyline(end, trace, after=at)[1] / (len(s) - 1)
        coedges.append(Coedge(face=name, side=side, along=along, span=(float(reached), float(past))))
        place, reached = end, past
    if not found or _distance(place, trace[-1]) > tolerance:
        raise CadError(
            f"boundary {side} of face {name!r} runs along no edge of another face: the nearest is {nearest:.3g} m "
            f"away, and at most {tolerance:.3g} m is taken for the same; let the neighbour end on this boundary"
        )


def _distance(a: Array, b: Array) -> float:
    return float(np.sqrt(np.sum((a - b) ** 2)))


def _to_polyline(point: Array, line: Array, after: float = 0.0) -> tuple[float, float]:
    """Distance of a point from a polyline, and where it is nearest, in segments from the start, not before `after`."""
    begin = int(after)
    start, step = line[begin:-1], np.diff(line[begin:], axis=0)
    share = np.clip(np.sum((point - start) * step, axis=-1) / np.sum(step * step, axis=-1), 0.0, 1.0)
    away = np.sum((start + share[:, None] * step - point) ** 2, axis=-1)
    nearest = int(np.argmin(away))
    return float(np.sqrt(away[nearest])), float(begin + nearest + share[nearest])


def _vertex(vertices: list[Array], point: Array, tolerance: float) -> int:
    for index, known in enumerate(vertices):
        if np.max(np.abs(known - point)) <= tolerance:
            return index
    vertices.append(point)
    return len(vertices) - 1


def _require_pairs(edge_curves: list[tuple[Curve, list[Coedge]]]) -> None:
    for curve, coedges in edge_curves:
        where = " and ".join(f"{coedge.face!r} ({coedge.side})" for coedge in coedges)
        if len(coedges) != 2:
            raise CadError(
                f"the edge from {curve.control_points[0]} to {curve.control_points[-1]} m belongs to {where}: an edge "
                "of a closed body belongs to exactly two faces; give the neighbours the same boundary control points"
            )
        if coedges[0].face == coedges[1].face:
            raise CadError(
                f"face {coedges[0].face!r} meets itself along an edge: split it there, so that each edge has two faces"
            )
