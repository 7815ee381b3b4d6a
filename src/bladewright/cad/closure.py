"""Whether the faces of a body close it: every edge shared by two faces, and the true gap between these along it."""

from dataclasses import dataclass

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopAbs import (
    TopAbs_EDGE,
    TopAbs_FACE,
    TopAbs_FORWARD,
    TopAbs_REVERSED,
    TopAbs_SHELL,
    TopAbs_SOLID,
)
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Face, TopoDS_Shape
from OCP.TopTools import TopTools_IndexedDataMapOfShapeListOfShape, TopTools_IndexedMapOfShape

from bladewright.cad.reading import subshapes
from bladewright.numerics.elementary import Array

POINTS_PER_EDGE = 401
"""Points along an edge at which its gap is measured, both ends included. The gap oscillates within each knot span of
the trimming curve, so that there must be several points in each; the number trades time for the gap's last digits."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredEdge:
    """An edge of a shape with what was measured along it."""

    faces: tuple[int, ...]
    """indices of the faces that meet there, in the order of the file"""
    length: float
    """[mm]"""
    gap: float
    """[mm] largest distance between the faces, or from the edge's own curve, at equal parameters"""
    mean_gap: float
    """[mm] mean of that distance along the edge"""
    tolerance: float
    """[mm] tolerance of the edge in the file"""
    vertex_tolerance: float
    """[mm] larger tolerance of its two vertices"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Closure:
    """How the faces of a shape close it."""

    solids: int
    """number of solids"""
    shells: int
    """number of shells"""
    free_edges: int
    """number of edges that belong to one face only"""
    non_manifold_edges: int
    """number of edges that belong to more than two faces, or to two faces that run the same way along it"""
    valid: bool
    """whether OpenCASCADE's own check finds the shape valid"""
    edges: tuple[MeasuredEdge, ...]
    """all edges that have a length"""


def closure(shape: TopoDS_Shape) -> Closure:
    """How the faces of a shape [mm] close it."""
    faces = subshapes(shape, TopAbs_FACE)
    owners = TopTools_IndexedDataMapOfShapeListOfShape()
    TopExp.MapShapesAndAncestors_s(shape, TopAbs_EDGE, TopAbs_FACE, owners)
    coedges, numbers = _coedge_counts(shape), TopTools_IndexedMapOfShape()
    for face in faces:
        numbers.Add(face)
    edges, free, non_manifold = [], 0, 0
    for index in range(1, owners.Extent() + 1):
        edge = TopoDS.Edge_s(owners.FindKey(index))
        if BRep_Tool.Degenerated_s(edge):
            continue
        forward, backward = coedges.get(index, (0, 0))
        free += forward + backward < 2
        non_manifold += forward + backward > 2 or (forward + backward == 2 and forward != backward)
        neighbours = [TopoDS.Face_s(face) for face in owners.FindFromIndex(index)]
        properties = GProp_GProps()
        BRepGProp.LinearProperties_s(edge, properties)
        distances = _distances(edge, neighbours)
        edges.append(
            MeasuredEdge(
                faces=tuple(sorted({numbers.FindIndex(own) - 1 for own in neighbours})),
                length=properties.Mass(),
                gap=float(distances.max()),
                mean_gap=float(distances.mean()),
                tolerance=BRep_Tool.Tolerance_s(edge),
                vertex_tolerance=_vertex_tolerance(edge),
            )
        )
    return Closure(
        solids=len(subshapes(shape, TopAbs_SOLID)),
        shells=len(subshapes(shape, TopAbs_SHELL)),
        free_edges=free,
        non_manifold_edges=non_manifold,
        valid=BRepCheck_Analyzer(shape).IsValid(),
        edges=tuple(edges),
    )


def _coedge_counts(shape: TopoDS_Shape) -> dict[int, tuple[int, int]]:
    """How many faces run forwards and how many backwards along each edge, by the edge's index in OpenCASCADE's map."""
    owners = TopTools_IndexedDataMapOfShapeListOfShape()
    TopExp.MapShapesAndAncestors_s(shape, TopAbs_EDGE, TopAbs_FACE, owners)
    counts: dict[int, tuple[int, int]] = {}
    walk_faces = TopExp_Explorer(shape, TopAbs_FACE)
    while walk_faces.More():
        walk_edges = TopExp_Explorer(walk_faces.Current(), TopAbs_EDGE)
        while walk_edges.More():
            edge = walk_edges.Current()
            index = owners.FindIndex(edge)
            forward, backward = counts.get(index, (0, 0))
            orientation = edge.Orientation()
            counts[index] = (
                forward + (orientation == TopAbs_FORWARD),
                backward + (orientation == TopAbs_REVERSED),
            )
            walk_edges.Next()
        walk_faces.Next()
    return counts


def _distances(edge: TopoDS_Edge, neighbours: list[TopoDS_Face]) -> Array:
    """(POINTS_PER_EDGE,) [mm] Largest distance at equal parameters between the edge's curve and those on its faces."""
    own = BRepAdaptor_Curve(edge)
    curves = [own, *(BRepAdaptor_Curve(edge, face) for face in neighbours)]
    parameters = np.linspace(own.FirstParameter(), own.LastParameter(), POINTS_PER_EDGE).tolist()
    traces = [np.array([curve.Value(place).Coord() for place in parameters]) for curve in curves]
    squares = [np.zeros(POINTS_PER_EDGE)]
    squares += [np.sum((one - other) ** 2, axis=-1) for index, one in enumerate(traces) for other in traces[:index]]
    return np.sqrt(np.max(squares, axis=0))


def _vertex_tolerance(edge: TopoDS_Edge) -> float:
    ends = (TopExp.FirstVertex_s(edge), TopExp.LastVertex_s(edge))
    return max((BRep_Tool.Tolerance_s(end) for end in ends if not end.IsNull()), default=0.0)
