"""Closed solids of native surfaces: shared edges, shared vertices, tolerances as large as the gaps that there are."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from OCP.BRep import BRep_Builder
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
from bladewright.cad.native_body import MM, ClosedBody, NativeBody
from bladewright.cad.topology import Coedge, DegenerateEdge, Edge, Topology, topology
from bladewright.cad.trimmed_faces import trimmed_face
from bladewright.errors import CadError
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

if TYPE_CHECKING:
    import cadquery

CONFUSION = 1e-7
"""[mm] The kernel's own smallest tolerance."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OccSolid:
    """A solid of the kernel [mm] and its faces by name."""

    solid: TopoDS_Solid
    faces: dict[str, TopoDS_Face]
    gap: float
    """[mm] largest tolerance that its edges need"""


def solid(built: NativeBody) -> "cadquery.Solid":
    """The closed solid of a built object, in millimetres: its untrimmed faces pole for pole, its walls exact.

    Raises CadError where the surfaces do not close up, or where OpenCASCADE finds the solid invalid.
    """
    import cadquery  # its own import takes as long as the kernel's, and files need the kernel alone

    return cadquery.Solid(occ_solid(built).solid)


class _ByIdentity:
    """A built object, equal to itself only."""

    def __init__(self, built: NativeBody) -> None:
        self.built = built

    def __hash__(self) -> int:
        return id(self.built)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _ByIdentity) and other.built is self.built


def cached_occ_solid(built: NativeBody) -> OccSolid:
    """The `body` of a built object, kept while the files of the same object are written one after another."""
    return _cached(_ByIdentity(built))


@lru_cache(maxsize=1)
def _cached(same: _ByIdentity) -> OccSolid:
    return occ_solid(same.built)


def occ_solid(built: ClosedBody) -> OccSolid:
    """The same solid in the kernel's own type, with its faces by name."""
    for face in built.surfaces.values():
        millimetres(face.control_points if isinstance(face, Surface) else face.surface.control_points)
    made = topology(built)
    workshop = _SolidBuilder(built.surfaces, made)
    faces = {}
    for name, face in built.surfaces.items():
        outwards = built.orientations[name] > 0
        faces[name] = (
            workshop.patch(name, face, outwards) if isinstance(face, Surface) else workshop.wall(name, face, outwards)
        )
    workshop.close_edges()
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
            f"OpenCASCADE finds the solid of {built.name!r} invalid, though its faces share their edges: one crosses "
            "itself or another; look at the blade with `bladewright show`"
        )
    return OccSolid(solid=whole, faces=faces, gap=max(workshop.gaps))


class _SolidBuilder:
    """Edges and vertices of the kernel, made once and handed to every face that meets there."""

    def __init__(self, surfaces: Mapping[str, Surface | TrimmedSurface], made: Topology) -> None:
        self.surfaces, self.made = surfaces, made
        self.builder = BRep_Builder()
        self.vertices = [TopoDS_Vertex() for _ in made.vertices]
        self.tolerances = np.full(len(made.vertices), CONFUSION)
        for vertex, point in zip(self.vertices, made.vertices, strict=True):
            self.builder.MakeVertex(vertex, gp_Pnt(*(point * MM).tolist()), CONFUSION)
        self.edges = [self._edge(edge) for edge in made.edges]
        self.gaps = [CONFUSION for _ in made.edges]

    def _edge(self, edge: Edge) -> TopoDS_Edge:
        made = TopoDS_Edge()
        self.builder.MakeEdge(made, space_curve(edge.curve), CONFUSION)
        self._bound(made, edge.start, edge.end)
        self.builder.Range(made, float(edge.curve.knots[0]), float(edge.curve.knots[-1]))
        return made

    def _bound(self, edge: TopoDS_Edge, start: int, end: int) -> None:
        self.builder.Add(edge, self.vertices[start].Oriented(TopAbs_FORWARD))
        self.builder.Add(edge, self.vertices[end].Oriented(TopAbs_REVERSED))

    def patch(self, name: str, surface: Surface, outwards: bool) -> TopoDS_Face:
        """An untrimmed face, its wire run around the parameter rectangle."""
        face = TopoDS_Face()
        self.builder.MakeFace(face, space_surface(surface), CONFUSION)
        wire = self._wire()
        for side in range(4):
            for index, use in self._along(name, side):
                trace = _side_trace(surface, use, self.made.edges[index].curve)
                self.builder.UpdateEdge(self.edges[index], trace, face, CONFUSION)
                self._add(wire, self.edges[index], along=use.along)
            for point in self.made.collapsed:
                if (point.use.face, point.use.side) == (name, side):
                    self._add(wire, self._degenerate(surface, point, face), along=point.use.along)
        return self._closed(face, wire, outwards)

    def wall(self, name: str, face: TrimmedSurface, outwards: bool) -> TopoDS_Face:
        """A trimmed face, its wire run along the edges that its boundary follows."""
        chain = [
            (index, self.made.edges[index], use)
            for side in range(len(face.boundary))
            for index, use in self._along(name, side)
        ]
        shape = trimmed_face(face, [(edge, use) for _, edge, use in chain])
        made = TopoDS_Face()
        self.builder.MakeFace(made, shape.geometry, CONFUSION)
        counter_clockwise = _turns_left(face) != shape.swapped
        wire = self._wire()
        for (index, edge, use), trace in zip(chain, shape.traces, strict=True):
            gap = _gap(edge, trace, shape.geometry)
            # a hair more than the gap measured, for what lies between the samples
            self.gaps[index] = max(self.gaps[index], 1.05 * gap)
            self.builder.UpdateEdge(self.edges[index], plane_curve(trace), made, self.gaps[index])
            self._add(wire, self.edges[index], along=use.along == counter_clockwise)
        return self._closed(made, wire, outwards != shape.swapped)

    def close_edges(self) -> None:
        """Give edges and vertices the tolerance that their gaps need."""
        for edge, shape, gap in zip(self.made.edges, self.edges, self.gaps, strict=True):
            self.builder.UpdateEdge(shape, gap)
            self.builder.SameRange(shape, True)
            self.builder.SameParameter(shape, True)
            for vertex in (edge.start, edge.end):
                self.tolerances[vertex] = max(self.tolerances[vertex], gap)
        for vertex, tolerance in zip(self.vertices, self.tolerances.tolist(), strict=True):
            self.builder.UpdateVertex(vertex, tolerance)

    def _along(self, name: str, side: int) -> list[tuple[int, Coedge]]:
        """The edges on a side of a face, by their place, in the order of the face's run along that side."""
        found = [
            (index, use)
            for index, edge in enumerate(self.made.edges)
            for use in edge.uses
            if (use.face, use.side) == (name, side)
        ]
        trimmed = isinstance(self.surfaces[name], TrimmedSurface)
        return sorted(found, key=lambda each: each[1].span, reverse=not trimmed and side in {2, 3})

    def _wire(self) -> TopoDS_Wire:
        wire = TopoDS_Wire()
        self.builder.MakeWire(wire)
        return wire

    def _add(self, wire: TopoDS_Wire, edge: TopoDS_Edge, *, along: bool) -> None:
        self.builder.Add(wire, edge.Oriented(TopAbs_FORWARD if along else TopAbs_REVERSED))

    def _closed(self, face: TopoDS_Face, wire: TopoDS_Wire, forward: bool) -> TopoDS_Face:
        wire.Closed(True)
        self.builder.Add(face, wire)
        return TopoDS.Face_s(face.Oriented(TopAbs_FORWARD if forward else TopAbs_REVERSED))

    def _degenerate(self, surface: Surface, point: DegenerateEdge, face: TopoDS_Face) -> TopoDS_Edge:
        edge = TopoDS_Edge()
        self.builder.MakeEdge(edge)
        self.builder.UpdateEdge(edge, _side_trace(surface, point.use, None), face, CONFUSION)
        self._bound(edge, point.vertex, point.vertex)
        self.builder.Degenerated(edge, True)
        self.builder.Range(edge, face, *point.use.span)
        return edge


def _side_trace(surface: Surface, use: Coedge, curve: Curve | None) -> Geom2d_Curve:
    """The piece of a side of the parameter rectangle at the parameter of an edge's curve, or at its own."""
    along_u = use.side in {0, 2}
    across = surface.knots_v if along_u else surface.knots_u
    fixed = float(across[0] if use.side in {0, 3} else across[-1])
    backwards = curve is not None and use.along != (use.side in {0, 1})
    start, end = reversed(use.span) if backwards else use.span
    first, last = use.span if curve is None else curve.domain
    slope = (end - start) / (last - first)

    def at(place: float) -> gp_Pnt2d:
        return gp_Pnt2d(place, fixed) if along_u else gp_Pnt2d(fixed, place)

    if abs(abs(slope) - 1.0) <= 1e-15:
        # a line of the kernel has its length for a parameter
        step = -1.0 if backwards else 1.0
        return Geom2d_Line(at(start - step * first), gp_Dir2d(step, 0.0) if along_u else gp_Dir2d(0.0, step))
    poles = TColgp_Array1OfPnt2d(1, 2)
    poles.SetValue(1, at(start))
    poles.SetValue(2, at(end))
    return Geom2d_BSplineCurve(poles, *occ_knots(np.array([first, first, last, last])), 1)


def _turns_left(face: TrimmedSurface) -> bool:
    chain = np.concatenate([curve(np.linspace(curve.knots[0], curve.knots[-1], 401))[:-1] for curve in face.boundary])
    ahead = np.roll(chain, -1, axis=0)
    return bool(np.sum(chain[:, 0] * ahead[:, 1] - ahead[:, 0] * chain[:, 1]) > 0.0)


def _gap(edge: Edge, trace: Curve, geometry: Geom_Surface) -> float:
    """Largest distance [mm] of a trace on its wall from its edge at equal parameters."""
    spans = np.unique(trace.knots)
    # an interpolant's error waves inside each span, and beside a wall's joint the spans are short
    w = np.concatenate([np.linspace(spans[0], spans[-1], 401), *np.linspace(spans[:-1], spans[1:], 11)[1:-1]])
    on_wall = (geometry.Value(*uv) for uv in trace(w).tolist())
    points = np.array([(p.X(), p.Y(), p.Z()) for p in on_wall])
    return float(np.sqrt(np.max(np.sum((points - edge.curve(w) * MM) ** 2, axis=-1))))
