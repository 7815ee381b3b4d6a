"""The edges that the faces of a body share, found from the native boundary curves."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import cast

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bladewright.cad.boundary_trace import ON_BOUNDARY, BoundaryTrace
from bladewright.cad.face_pieces import BodyInPieces
from bladewright.cad.native_body import declared_edges, extent
from bladewright.errors import CadError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.closest import closest_on_curve
from bladewright.nurbs.compatible import compatible
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import reversed as run_back
from bladewright.nurbs.domain import split
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

COINCIDENT = 1e-12
"""Largest distance of equal points, as a fraction of the body's extent. Neighbours share their boundary control points
to the last bit, so that this only allows for the rounding of one more operation, such as a turn by a pitch."""
INSERTED = 10.0
"""How many times that equal curves may differ in control points once knots are inserted in both: side and strip of
random part 2, with knots 6e-5 apart, differ by 1.25 times it there, and by 7e-17 m as curves."""
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
    """index into SIDES, or into the curves of a trimmed face"""
    along: bool
    """whether the boundary of the face runs in the direction of the edge's parameter"""
    span: tuple[float, float]
    """parameters of the side, or of the trimmed face's curve, between which the edge lies, the smaller one first"""


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
    direction, and the same knots up to a linear change of the parameter; a face of a whole turn is its own neighbour
    along its seam. Sides that find none so are cut where ends of others lie on them (T-junctions), and neighbours where
    they run through the same points, whatever their knots. Where either of the two is cut the edge is cut too, also
    where a declared edge ends on it, and the pieces of a face share an edge on each cut. A trimmed face is a neighbour
    along the edges, of untrimmed faces or declared, that its loops follow. Raises CadError where an edge does not
    belong to exactly two faces.
    """
    size = extent(body.built)
    sides: list[tuple[Curve, Coedge]] = []
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
                        sides.append((curve, coedge))
    declared = declared_edges(body.built)
    ends = np.array([curve.control_points[end] for curve in declared for end in (0, -1)]).reshape(-1, 3)
    ends, _ = _merged(ends, COINCIDENT * size)
    shared = _at_t_junctions(_shared(sides, COINCIDENT * size), COINCIDENT * size)
    whole_edges = shared + [(curve, list[Coedge]()) for curve in declared]
    edge_curves = [
        part
        for curve, coedges in whole_edges
        for part in _cut_edge(body, curve, coedges, _met(curve, ends, COINCIDENT * size))
    ]
    edge_curves += _edges_on_cuts(body)
    _add_trimmed_faces(edge_curves, body.built.surfaces, ON_BOUNDARY * size)
    _require_pairs(edge_curves)
    corners = [curve.control_points[end] for curve, _ in edge_curves for end in (0, -1)] + [at for at, _ in points]
    vertices, index = _merged(np.array(corners).reshape(-1, 3), COINCIDENT * size)
    edges = tuple(
        BodyEdge(curve=curve, coedges=tuple(coedges), start=int(index[2 * k]), end=int(index[2 * k + 1]))
        for k, (curve, coedges) in enumerate(edge_curves)
    )
    degenerate_edges = tuple(
        DegenerateEdge(coedge=coedge, vertex=int(vertex))
        for (_, coedge), vertex in zip(points, index[2 * len(edges) :], strict=True)
    )
    return Topology(edges=edges, degenerate_edges=degenerate_edges, vertices=vertices)


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
    """The parts of a curve between its corners (inner knots of full multiplicity), with the same control points.

    Where weights vary, the joints of smooth arcs count too: other programs integrate along a whole edge at once.
    """
    degree = curve.degree
    inner, counts = np.unique(curve.knots[degree + 1 : -degree - 1], return_counts=True)
    if curve.weights is not None and np.ptp(curve.weights) > 0.0 and np.any(counts == degree - 1):
        return split(curve, inner[counts >= degree - 1])
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


def _met(curve: Curve, points: Array, tolerance: float) -> list[float]:
    """The parameters at which points lie on a curve between its ends, its own knots to the last bit."""
    hulls = sliding_window_view(curve.control_points, curve.degree + 1, axis=0)
    low, high = hulls.min(axis=-1) - tolerance, hulls.max(axis=-1) + tolerance
    near = points[np.any(np.all((points[:, None] >= low) & (points[:, None] <= high), axis=-1), axis=1)]
    for end in (0, -1):
        near = near[np.max(np.abs(near - curve.control_points[end]), axis=1, initial=0.0) > tolerance]
    if len(near) == 0:
        return []
    found = closest_on_curve(curve, near)
    return [_at_knot(curve, float(u)) for u in found.u[found.distances <= tolerance]]


def _at_knot(curve: Curve, place: float) -> float:
    """The curve's own knot where the place is one but for rounding: two would lie too close for OpenCASCADE."""
    nearest = float(curve.knots[np.argmin(np.abs(curve.knots - place))])
    return nearest if abs(nearest - place) <= SAME_KNOT * (curve.domain[1] - curve.domain[0]) else place


def _cut_edge(
    body: BodyInPieces, curve: Curve, coedges: list[Coedge], met: list[float]
) -> list[tuple[Curve, list[Coedge]]]:
    """An edge of whole faces in its parts, cut where either of its faces is, and where other edges meet it."""
    first, last = curve.domain

    def change(coedge: Coedge, to_edge: bool, at: float) -> float:
        """The parameter of the edge for one of the face's side, or the reverse."""
        backwards = coedge.along != (coedge.side in {0, 1})
        (start, end), (new_start, new_end) = (coedge.span, (first, last))[:: 1 if to_edge else -1]
        share = (at - start) / (end - start)
        return new_start + (1.0 - share if backwards else share) * (new_end - new_start)

    cuts = list(met)
    for coedge in coedges:
        cuts += [_at_knot(curve, change(coedge, True, at)) for at in _own_cuts(body, coedge)[1:-1]]
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


def _shared(sides: list[tuple[Curve, Coedge]], tolerance: float) -> list[tuple[Curve, list[Coedge]]]:
    """Sides of faces as edges: one edge for those that are the same curve, in either direction."""
    if not sides:
        return []
    middles = np.array([curve.control_points.mean(axis=0) for curve, _ in sides])
    neighbours = cKDTree(middles).query_ball_point(middles, 2.0 * tolerance, p=np.inf)
    edges: dict[int, tuple[Curve, list[Coedge]]] = {}
    for index, (curve, coedge) in enumerate(sides):
        known = [
            (edge, backwards)
            for edge in sorted(neighbours[index])
            for backwards in (False, True)
            if edge in edges and _same(edges[edge][0], curve, tolerance, backwards=backwards)
        ]
        if known:
            edge, backwards = known[0]
            edges[edge][1].append(replace(coedge, along=coedge.along != backwards))
        else:
            edges[index] = (curve, [coedge])
    return list(edges.values())


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


def _at_t_junctions(edges: list[tuple[Curve, list[Coedge]]], tolerance: float) -> list[tuple[Curve, list[Coedge]]]:
    """The edges; those of one face only are cut at each other's ends, and joined where they are then the same line.

    Of two that are, the one with fewer knots is the edge.
    """
    single = [(curve, coedges[0]) for curve, coedges in edges if len(coedges) == 1]
    ends, _ = _merged(_end_points(single), tolerance)
    parts: list[tuple[Curve, Coedge]] = []
    for curve, coedge in single:
        cuts = _met(curve, ends, tolerance)
        parts += [(part, replace(coedge, span=part.domain)) for part in (split(curve, cuts) if cuts else (curve,))]
    parts.sort(key=lambda part: len(part[0].knots))
    _, index = _merged(_end_points(parts), tolerance)
    between: dict[tuple[int, ...], list[tuple[Curve, list[Coedge]]]] = {}
    for (curve, coedge), pair in zip(parts, np.sort(index.reshape(-1, 2), axis=1).tolist(), strict=True):
        known = between.setdefault(tuple(pair), [])
        for (edge, coedges), backwards in product(known, (False, True)):
            if _same_line(edge, curve, tolerance, backwards=backwards):
                coedges.append(replace(coedge, along=coedge.along != backwards))
                break
        else:
            known.append((curve, [coedge]))
    return [edge for edge in edges if len(edge[1]) > 1] + [edge for known in between.values() for edge in known]


def _end_points(curves: list[tuple[Curve, Coedge]]) -> Array:
    return np.array([curve.control_points[end] for curve, _ in curves for end in (0, -1)]).reshape(-1, 3)


def _same_line(one: Curve, other: Curve, tolerance: float, *, backwards: bool) -> bool:
    """Whether two curves run through the same points at parameters that are linear in each other's."""
    other = run_back(other) if backwards else other
    if np.max(np.abs(one.control_points[[0, -1]] - other.control_points[[0, -1]])) > tolerance:
        return False
    one, other = compatible([one, other])
    return _same(one, other, INSERTED * tolerance, backwards=False)


def _shares(knots: Array) -> Array:
    return (knots - knots[0]) / (knots[-1] - knots[0])


def _add_trimmed_faces(
    edge_curves: list[tuple[Curve, list[Coedge]]], faces: Mapping[str, Surface | TrimmedSurface], tolerance: float
) -> None:
    """Add the curves of trimmed faces to the edges that they follow."""
    places = [np.linspace(*curve.domain, 5) for curve, _ in edge_curves]
    probes = np.array([curve(at) for (curve, _), at in zip(edge_curves, places, strict=True)]).reshape(-1, 5, 3)
    for name, face in faces.items():
        if isinstance(face, TrimmedSurface):
            labels = [
                f"{f'hole {loop}, curve' if loop else 'boundary'} {number} of face {name!r}"
                for loop, curves in enumerate(face.loops)
                for number in range(len(curves))
            ]
            for side, (boundary, label) in enumerate(zip(face.curves, labels, strict=True)):
                trace = BoundaryTrace(face, boundary, tolerance)
                for edge, along, span in trace.followed(probes, label):
                    edge_curves[edge][1].append(Coedge(face=name, side=side, along=along, span=span))


def _merged(points: Array, tolerance: float) -> tuple[Array, NDArray[np.intp]]:
    """The distinct ones of points (n, 3), and for each point the index of the one that it is."""
    index: dict[int, int] = {}
    near = cKDTree(points).query_ball_point(points, tolerance, p=np.inf) if len(points) else []
    kept = np.zeros(len(points), dtype=bool)
    for place, others in enumerate(near):
        known = sorted(index[other] for other in others if kept[other])
        kept[place] = not known
        index[place] = known[0] if known else int(np.sum(kept[:place]))
    return points[kept], np.array(list(index.values()), dtype=np.intp)


def _require_pairs(edge_curves: list[tuple[Curve, list[Coedge]]]) -> None:
    for curve, coedges in edge_curves:
        where = " and ".join(f"{coedge.face!r} ({coedge.side})" for coedge in coedges)
        if len(coedges) != 2:
            raise CadError(
                f"the edge from {curve.control_points[0]} to {curve.control_points[-1]} m belongs to {where}: an edge "
                "of a closed body belongs to exactly two faces; give the neighbours the same boundary control points"
            )
        one, other = coedges
        if one.face == other.face and ({one.side, other.side} not in ({0, 2}, {1, 3}) or one.along == other.along):
            raise CadError(
                f"face {one.face!r} meets itself along an edge, which only opposite sides of a face of a whole turn "
                "do: split it there, so that each edge has two faces"
            )
