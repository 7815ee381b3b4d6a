"""Closed solids of native surfaces, with shared edges and vertices, whose tolerances are the measured gaps."""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.Geom import Geom_Surface
from OCP.Geom2d import Geom2d_BSplineCurve, Geom2d_Curve, Geom2d_Line
from OCP.gp import gp_Dir2d, gp_Pnt, gp_Pnt2d
from OCP.TColgp import TColgp_Array1OfPnt2d
from OCP.TopAbs import TopAbs_FORWARD, TopAbs_REVERSED
from OCP.TopoDS import (
    TopoDS,
    TopoDS_Edge,
    TopoDS_Face,
    TopoDS_Shell,
    TopoDS_Solid,
    TopoDS_Vertex,
    TopoDS_Wire,
)

from bladewright.cad.conversion import millimetres, occ_knots, plane_curve, space_curve, space_surface
from bladewright.cad.default_quadrature import volume_error
from bladewright.cad.face_pieces import BodyInPieces, in_fine_pieces, in_pieces, whole_name
from bladewright.cad.native_body import MM, ClosedBody, NativeBody
from bladewright.cad.topology import BodyEdge, Coedge, DegenerateEdge, Topology, topology
from bladewright.cad.trimmed_faces import Known, trimmed_face
from bladewright.errors import CadError
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

if TYPE_CHECKING:
    import cadquery

CONFUSION = 1e-7
"""[mm] OpenCASCADE's smallest tolerance (Precision::Confusion)."""

NEED = 1e-7
"""Error of the body's volume by OpenCASCADE's default quadrature of one face, relative, above which `split` cuts it.
Volumes are to be within 1e-5, and a passage has some forty faces; most sides of blades need it, most walls do not."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OccSolid:
    """A solid of OpenCASCADE [mm], with its faces by name."""

    solid: TopoDS_Solid
    faces: dict[str, TopoDS_Face]
    gap: float
    """[mm] largest tolerance of its edges"""


def solid(built: NativeBody, *, split: bool = False) -> "cadquery.Solid":
    """The closed solid of a blade or passage, in millimetres.

    Untrimmed faces have the native control points; trimmed faces lie on exact planes and surfaces of revolution. Faces
    with a crease are cut there, and with `split` also wherever OpenCASCADE's default quadrature needs it.
    Raises CadError where the surfaces do not close a volume, or where OpenCASCADE finds the solid invalid.
    """
    import cadquery  # as slow to import as OpenCASCADE itself, and not needed for files

    # a shape of its own, which may be changed without changing what is written of this body later
    return cadquery.Solid(BRepBuilderAPI_Copy(cached_occ_solid(built, split=split).solid, False).Shape())


class _ByIdentity:
    """A key for the cache below: bodies are equal only where they are the same object."""

    def __init__(self, built: NativeBody) -> None:
        self.built = built

    def __hash__(self) -> int:
        return id(self.built)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _ByIdentity) and other.built is self.built


def cached_occ_solid(built: NativeBody, *, split: bool = False) -> OccSolid:
    """`occ_solid`, cached for the last body, whose files in several formats are written one after another."""
    return _cached(_ByIdentity(built), split)


@lru_cache(maxsize=1)
def _cached(same: _ByIdentity, split: bool) -> OccSolid:
    return split_occ_solid(same.built) if split else occ_solid(same.built)


def occ_solid(built: ClosedBody) -> OccSolid:
    """The closed solid of a body as OpenCASCADE has it, with its faces by name; raises CadError as `solid` does."""
    _check_numbers(built)
    return occ_solid_in_pieces(in_pieces(built))


def split_occ_solid(built: NativeBody) -> OccSolid:
    """`occ_solid` with its faces also cut where OpenCASCADE's default quadrature needs it.

    An untrimmed face needs it where its own part of the volume is off, or that of a trimmed face beside it, which is
    integrated along their common edges.
    """
    whole = occ_solid(built)
    pieces = in_pieces(built)
    volume, middle = float(built.properties.volume), np.asarray(built.properties.centroid)
    errors: dict[str, float] = defaultdict(float)
    for piece, face in pieces.surfaces.items():
        name = whole_name(piece, built.surfaces) or piece
        errors[name] += volume_error(whole.faces[piece], face, pieces.orientations[piece], middle) / volume
    inexact = {name for name, error in errors.items() if error > NEED}
    for edge in topology(pieces).edges:
        names = {whole_name(coedge.face, built.surfaces) or coedge.face for coedge in edge.coedges}
        if any(name in inexact and isinstance(built.surfaces[name], TrimmedSurface) for name in names):
            inexact = inexact | names
    return occ_solid_in_pieces(in_fine_pieces(built, inexact))


def _check_numbers(built: ClosedBody) -> None:
    for face in built.surfaces.values():
        millimetres(face.control_points if isinstance(face, Surface) else face.surface.control_points)


def occ_solid_in_pieces(body: BodyInPieces) -> OccSolid:
    """The closed solid of the pieces of a body."""
    parts = _SolidBuilder(body.surfaces, topology(body))
    faces = {}
    for name, face in body.surfaces.items():
        outwards = body.orientations[name] > 0
        if isinstance(face, Surface):
            faces[name] = parts.untrimmed_face(name, face, outwards)
        else:
            faces[name] = parts.trimmed_face(name, face, outwards)
    parts.close_edges()
    builder = BRep_Builder()
    shell = TopoDS_Shell()
    builder.MakeShell(shell)
    for face in faces.values():
        builder.Add(shell, face)
    shell.Closed(True)
    whole = TopoDS_Solid()
    builder.MakeSolid(whole)
    builder.Add(whole, shell)
    if not BRepCheck_Analyzer(whole).IsValid():
        raise CadError(
            f"OpenCASCADE finds the solid of {body.name!r} invalid, though its faces share their edges: one crosses "
            "itself or another; look at the blade with `bladewright show`"
        )
    return OccSolid(solid=whole, faces=faces, gap=max(parts.gaps))


class _SolidBuilder:
    """OpenCASCADE's vertices and edges, each made once, and the faces that share them."""

    def __init__(self, surfaces: Mapping[str, Surface | TrimmedSurface], topology: Topology) -> None:
        self.surfaces, self.topology = surfaces, topology
        self.builder = BRep_Builder()
        self.vertices = [TopoDS_Vertex() for _ in topology.vertices]
        self.tolerances = np.full(len(topology.vertices), CONFUSION)
        for vertex, point in zip(self.vertices, topology.vertices, strict=True):
            self.builder.MakeVertex(vertex, gp_Pnt(*(point * MM).tolist()), CONFUSION)
        self.edges = [self._edge(edge) for edge in topology.edges]
        self.gaps = [CONFUSION for _ in topology.edges]
        self.pcurves: Known = {}

    def _edge(self, edge: BodyEdge) -> TopoDS_Edge:
        made = TopoDS_Edge()
        self.builder.MakeEdge(made, space_curve(edge.curve), CONFUSION)
        self._bound(made, edge.start, edge.end)
        self.builder.Range(made, float(edge.curve.knots[0]), float(edge.curve.knots[-1]))
        return made

    def _bound(self, edge: TopoDS_Edge, start: int, end: int) -> None:
        self.builder.Add(edge, self.vertices[start].Oriented(TopAbs_FORWARD))
        self.builder.Add(edge, self.vertices[end].Oriented(TopAbs_REVERSED))

    def untrimmed_face(self, name: str, surface: Surface, outwards: bool) -> TopoDS_Face:
        """An untrimmed face, whose wire runs around the parameter rectangle: along a seam once each way."""
        face = TopoDS_Face()
        self.builder.MakeFace(face, space_surface(surface), CONFUSION)
        wire = self._wire()
        for side in range(4):
            for index, coedge in self._along(name, side):
                edge = self.topology.edges[index]
                # on a seam first the one of which the face lies to the left of the edge
                mine = sorted((each for each in edge.coedges if each.face == name), key=lambda each: not each.along)
                pcurves = [_side_curve(surface, each, edge.curve) for each in mine]
                self.builder.UpdateEdge(self.edges[index], *pcurves, face, CONFUSION)
                self._add(wire, self.edges[index], along=coedge.along)
            for point in self.topology.degenerate_edges:
                if (point.coedge.face, point.coedge.side) == (name, side):
                    self._add(wire, self._degenerate(surface, point, face), along=point.coedge.along)
        return self._closed(face, [wire], outwards)

    def trimmed_face(self, name: str, face: TrimmedSurface, outwards: bool) -> TopoDS_Face:
        """A trimmed face, whose wires run along the edges that its loops follow."""
        chain = [
            (index, self.topology.edges[index], coedge)
            for side in range(len(face.curves))
            for index, coedge in self._along(name, side)
        ]
        shape = trimmed_face(face, [(edge, coedge) for _, edge, coedge in chain], self.pcurves)
        made = TopoDS_Face()
        self.builder.MakeFace(made, shape.geometry, CONFUSION)
        of_side = [wire for loop in face.loops for wire in [self._wire()] * len(loop)]
        for (index, edge, coedge), pcurve in zip(chain, shape.pcurves, strict=True):
            gap = _gap(edge, pcurve, shape.geometry)
            # 5 % more than the measured gap, which may be larger between the samples
            self.gaps[index] = max(self.gaps[index], 1.05 * gap)
            self.builder.UpdateEdge(self.edges[index], plane_curve(pcurve), made, self.gaps[index])
            self._add(of_side[coedge.side], self.edges[index], along=coedge.along != shape.reversed_normal)
        wires = [of_side[side] for side in np.cumsum([len(loop) for loop in face.loops]) - 1]
        return self._closed(made, wires, outwards != shape.reversed_normal)

    def close_edges(self) -> None:
        """Set the tolerances of edges and vertices to the measured gaps."""
        for edge, shape, gap in zip(self.topology.edges, self.edges, self.gaps, strict=True):
            self.builder.UpdateEdge(shape, gap)
            self.builder.SameRange(shape, True)
            self.builder.SameParameter(shape, True)
            for vertex in (edge.start, edge.end):
                self.tolerances[vertex] = max(self.tolerances[vertex], gap)
        for vertex, tolerance in zip(self.vertices, self.tolerances.tolist(), strict=True):
            self.builder.UpdateVertex(vertex, tolerance)

    @cached_property
    def _coedges(self) -> Mapping[tuple[str, int], list[tuple[int, Coedge]]]:
        """Indices and coedges of the edges on each side of each face."""
        found = defaultdict(list)
        for index, edge in enumerate(self.topology.edges):
            for coedge in edge.coedges:
                found[coedge.face, coedge.side].append((index, coedge))
        return found

    def _along(self, name: str, side: int) -> list[tuple[int, Coedge]]:
        """The same of one side, in the direction of its face's wire."""
        trimmed = isinstance(self.surfaces[name], TrimmedSurface)
        backwards = not trimmed and side in {2, 3}
        return sorted(self._coedges.get((name, side), []), key=lambda each: each[1].span, reverse=backwards)

    def _wire(self) -> TopoDS_Wire:
        wire = TopoDS_Wire()
        self.builder.MakeWire(wire)
        return wire

    def _add(self, wire: TopoDS_Wire, edge: TopoDS_Edge, *, along: bool) -> None:
        self.builder.Add(wire, edge.Oriented(TopAbs_FORWARD if along else TopAbs_REVERSED))

    def _closed(self, face: TopoDS_Face, wires: list[TopoDS_Wire], forward: bool) -> TopoDS_Face:
        for wire in wires:
            wire.Closed(True)
            self.builder.Add(face, wire)
        return TopoDS.Face_s(face.Oriented(TopAbs_FORWARD if forward else TopAbs_REVERSED))

    def _degenerate(self, surface: Surface, point: DegenerateEdge, face: TopoDS_Face) -> TopoDS_Edge:
        edge = TopoDS_Edge()
        self.builder.MakeEdge(edge)
        self.builder.UpdateEdge(edge, _side_curve(surface, point.coedge, None), face, CONFUSION)
        self._bound(edge, point.vertex, point.vertex)
        self.builder.Degenerated(edge, True)
        self.builder.Range(edge, face, *point.coedge.span)
        return edge


def _side_curve(surface: Surface, coedge: Coedge, curve: Curve | None) -> Geom2d_Curve:
    """The pcurve of an edge on a side of the parameter rectangle, with the edge's parameter (`curve`) or its own."""
    along_u = coedge.side in {0, 2}
    across = surface.knots_v if along_u else surface.knots_u
    fixed = float(across[0] if coedge.side in {0, 3} else across[-1])
    backwards = curve is not None and coedge.along != (coedge.side in {0, 1})
    start, end = reversed(coedge.span) if backwards else coedge.span
    first, last = coedge.span if curve is None else curve.domain
    slope = (end - start) / (last - first)

    def at(place: float) -> gp_Pnt2d:
        return gp_Pnt2d(place, fixed) if along_u else gp_Pnt2d(fixed, place)

    if abs(abs(slope) - 1.0) <= 1e-15:
        # OpenCASCADE parametrises a line by its length
        step = -1.0 if backwards else 1.0
        return Geom2d_Line(at(start - step * first), gp_Dir2d(step, 0.0) if along_u else gp_Dir2d(0.0, step))
    poles = TColgp_Array1OfPnt2d(1, 2)
    poles.SetValue(1, at(start))
    poles.SetValue(2, at(end))
    return Geom2d_BSplineCurve(poles, *occ_knots(np.array([first, first, last, last])), 1)


def _gap(edge: BodyEdge, pcurve: Curve, geometry: Geom_Surface) -> float:
    """Largest distance [mm] between an edge and its pcurve on a trimmed face, at equal parameters."""
    spans = np.unique(pcurve.knots)
    # the error of an interpolant oscillates within each knot span, and near a knot of the wall the spans are short
    w = np.concatenate([np.linspace(spans[0], spans[-1], 401), *np.linspace(spans[:-1], spans[1:], 11)[1:-1]])
    on_wall = (geometry.Value(*uv) for uv in pcurve(w).tolist())
    points = np.array([(p.X(), p.Y(), p.Z()) for p in on_wall])
    return float(np.sqrt(np.max(np.sum((points - edge.curve(w) * MM) ** 2, axis=-1))))
