"""The edges that the faces of a body share, found from the native boundary curves."""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import cast

import numpy as np

from bladewright.cad.face_pieces import BodyInPieces
from bladewright.cad.native_body import extent
from bladewright.cad.region import greville_spaced
from bladewright.errors import CadError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import split
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


def topology(body: BodyInPieces) -> Topology:
    """The edges that the faces of a body share, and the vertices where those meet.

    A side of an untrimmed face is split where it has a corner (an inner knot of full multiplicity), and each piece is
    an edge of its own. Untrimmed faces are neighbours where two such pieces have the same control points, in either
    direction, and the same knots up to a linear change of the parameter. Where either of the two is cut the edge is cut
    too, and the pieces of a face share an edge on each cut. A trimmed face is a neighbour along the edges that its
    boundary follows. Raises CadError where an edge does not belong to exactly two faces.
    """
    size = extent(body.built)
    whole_edges: list[tuple[Curve, list[Coedge]]] = []
    points: list[tuple[Array, Coedge]] = []
    for name, face in body.built.surfaces.items():
        if isinstance(face, Surface):
            for side in range(4):
                whole, along = side_curve(face, side)
                flat = np.ptp(whole.control_points, axis=0).max() <= COINCIDENT * size
                for curve in (whole,) if flat else smooth_pieces(whole):
                    coedge = Coedge(face=name, side=side, along=along, span=curve.domain)
                    net = curve.control_points
                    if np.ptp(net, axis=0).max() <= COINCIDENT * size:
                        points += [(net[0], part) for part in _parts(body, coedge, _own_cuts(body, coedge))]
                    else:
                        _add_coedge(whole_edges, curve, coedge, COINCIDENT * size)
    edge_curves = [part for curve, coedges in whole_edges for part in _cut_edge(body, curve, coedges)]
    edge_curves += _edges_on_cuts(body)
    for name, face in body.built.surfaces.items():
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


def _own_cuts(body: BodyInPieces, coedge: Coedge) -> list[float]:
    """Ends of the parts of a coedge of an untrimmed face, by the cuts of that face, in its side's parameter."""
    start, end = coedge.span
    near = SAME_KNOT * (end - start)
    ends = body.cuts[coedge.face][0 if coedge.side in {0, 2} else 1]
    return [start, *(at for at in ends if start + near < at < end - near), end]


def _parts(body: BodyInPieces, coedge: Coedge, ends: list[float]) -> list[Coedge]:
    """The parts of a coedge between ends, each of the piece of the face that it belongs to."""
    names, cuts = body.names(coedge.face), body.cuts[coedge.face]
    along_u = coedge.side in {0, 2}
    line = names[:, 0 if coedge.side == 0 else -1] if along_u else names[0 if coedge.side == 3 else -1]
    inner = cuts[0 if along_u else 1][1:-1]
    return [
        replace(coedge, face=str(line[np.searchsorted(inner, 0.5 * (start + end))]), span=(start, end))
        for start, end in pairwise(ends)
    ]


def _cut_edge(body: BodyInPieces, curve: Curve, coedges: list[Coedge]) -> list[tuple[Curve, list[Coedge]]]:
    """An edge of whole faces in its parts, cut where either of its faces is."""
    first, last = curve.domain

    def change(coedge: Coedge, to_edge: bool, at: float) -> float:
        """The parameter of the edge for one of the face's side, or the reverse."""
        backwards = coedge.along != (coedge.side in {0, 1})
        (start, end), (new_start, new_end) = (coedge.span, (first, last))[:: 1 if to_edge else -1]
        share = (at - start) / (end - start)
        return new_start + (1.0 - share if backwards else share) * (new_end - new_start)

    cuts: list[float] = []
    for coedge in coedges:
        for at in _own_cuts(body, coedge)[1:-1]:
            place = change(coedge, True, at)
            # to the last bit, or two knots would lie too close for OpenCASCADE
            nearest = float(curve.knots[np.argmin(np.abs(curve.knots - place))])
            cuts.append(nearest if abs(nearest - place) <= SAME_KNOT * (last - first) else place)
    if not cuts:
        return [(curve, [part for coedge in coedges for part in _parts(body, coedge, list(coedge.span))])]
    cuts = sorted(set(cuts))
    parts = [(part, list[Coedge]()) for part in split(curve, cuts)]
    for coedge in coedges:
        known = _own_cuts(body, coedge)
        ends = sorted(change(coedge, False, at) for at in (first, *cuts, last))
        # the face's own cuts to the last bit
        near = SAME_KNOT * (coedge.span[1] - coedge.span[0])
        ends = [next((cut for cut in known if abs(cut - end) <= near), end) for end in ends]
        backwards = coedge.along != (coedge.side in {0, 1})
        for (_, own), part in zip(parts[:: -1 if backwards else 1], _parts(body, coedge, ends), strict=True):
            own.append(part)
    return parts


def _edges_on_cuts(body: BodyInPieces) -> list[tuple[Curve, list[Coedge]]]:
    """The edges between pieces of the same face."""
    found = []
    for face in body.cuts:
        names = body.names(face)
        for before, after, sides in ((names[:-1], names[1:], (1, 3)), (names[:, :-1], names[:, 1:], (2, 0))):
            for pair in zip(before.ravel().tolist(), after.ravel().tolist(), strict=True):
                curve, _ = side_curve(cast(Surface, body.surfaces[pair[0]]), sides[0])
                coedges = [
                    Coedge(face=name, side=side, along=side in {0, 1}, span=curve.domain)
                    for name, side in zip(pair, sides, strict=True)
                ]
                found += [(curve, coedges)]
    return found


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
    s = greville_spaced(boundary.knots, boundary.degree, 2001)
    line = face.surface(*boundary(s).T)

    def foot(point: Array, after: float = -np.inf) -> tuple[float, float]:
        """Distance of a point from the boundary, and the boundary's parameter there, not before `after`."""
        begin = max(0, int(np.searchsorted(s, after, side="right")) - 1)
        away, at = _to_polyline(point, line[begin:])
        if away > 100.0 * tolerance:
            return away, float(np.interp(begin + at, np.arange(len(s)), s))
        # the polyline cuts the corner around a nose, a finer one less
        low, high = s[max(begin + int(at) - 1, begin)], s[min(begin + int(at) + 2, len(s) - 1)]
        near = np.linspace(float(low), float(high), 61)
        away, at = _to_polyline(point, face.surface(*boundary(near).T))
        return away, float(np.interp(at, np.arange(len(near)), near))

    found, nearest = [], np.inf
    for curve, coedges in edge_curves:
        first, middle, last = curve(curve.knots[0] + np.array([0.0, 0.5, 1.0]) * (curve.knots[-1] - curve.knots[0]))
        # edge and boundary have different parameters, so that distances are measured
        distance = foot(middle)
        for start, end in ((first, last), (last, first)):
            nearest = min(nearest, max(_distance(line[0], start), _distance(line[-1], end), distance[0]))
        if max(distance[0], *(foot(end)[0] for end in (first, last))) <= tolerance:
            found.append((distance[1], coedges, first, last))
    place, reached = line[0], float(s[0])
    for at, coedges, first, last in sorted(found, key=lambda each: each[0]):
        along = _distance(place, first) <= _distance(place, last)
        start, end = (first, last) if along else (last, first)
        if _distance(place, start) > tolerance:
            break
        past = foot(end, after=at)[1]
        coedges.append(Coedge(face=name, side=side, along=along, span=(reached, past)))
        place, reached = end, past
    if not found or _distance(place, line[-1]) > tolerance:
        raise CadError(
            f"boundary {side} of face {name!r} runs along no edge of another face: the nearest is {nearest:.3g} m "
            f"away, and at most {tolerance:.3g} m is taken for the same; let the neighbour end on this boundary"
        )


def _distance(a: Array, b: Array) -> float:
    return float(np.sqrt(np.sum((a - b) ** 2)))


def _to_polyline(point: Array, line: Array) -> tuple[float, float]:
    """Distance of a point from a polyline, and where it is nearest, in segments from the start."""
    start, step = line[:-1], np.diff(line, axis=0)
    share = np.clip(np.sum((point - start) * step, axis=-1) / np.sum(step * step, axis=-1), 0.0, 1.0)
    away = np.sum((start + share[:, None] * step - point) ** 2, axis=-1)
    nearest = int(np.argmin(away))
    return float(np.sqrt(away[nearest])), float(nearest + share[nearest])


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
