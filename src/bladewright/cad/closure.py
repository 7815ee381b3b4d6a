"""Whether the faces of a body close it: edges shared by two faces, and the true gaps between those."""

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
from OCP.TopTools import TopTools_IndexedDataMapOfShapeListOfShape

from bladewright.cad.reading import subshapes
from bladewright.numerics.elementary import Array

POINTS_PER_EDGE = 401
"""points along an edge at which its gap is measured"""


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredEdge:
    """An edge of the file with what was measured along it."""

    faces: tuple[int, ...]
    """places of the faces that meet there, in the file's order"""
    length: float
    """[mm]"""
    gap: float
    """[mm] largest distance of the faces, and of the edge's own curve, at equal parameters"""
    opening: float
    """[mm] the same, its mean along the edge"""
    tolerance: float
    """[mm] of the edge"""
    vertex_tolerance: float
    """[mm] of its vertices"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Closure:
    """How a body closes."""

    solids: int
    shells: int
    free: int
    """edges that belong to one face only"""
    crowded: int
    """edges that belong to more than two faces, or to two that run the same way"""
    valid: bool
    """the kernel's own opinion"""
    joints: tuple[MeasuredEdge, ...]


def closure(shape: TopoDS_Shape) -> Closure:
    """How the faces of a shape [mm] close it."""
    faces = subshapes(shape, TopAbs_FACE)
    owners = TopTools_IndexedDataMapOfShapeListOfShape()
    TopExp.MapShapesAndAncestors_s(shape, TopAbs_EDGE, TopAbs_FACE, owners)
    uses = _uses(shape)
    joints, free, crowded = [], 0, 0
    for index in range(1, owners.Extent() + 1):
        edge = TopoDS.Edge_s(owners.FindKey(index))
        if BRep_Tool.Degenerated_s(edge):
            continue
        forward, backward = uses.get(index, (0, 0))
        free += forward + backward < 2
        crowded += forward + backward > 2 or (forward + backward == 2 and forward != backward)
        beside = [TopoDS.Face_s(face) for face in owners.FindFromIndex(index)]
        properties = GProp_GProps()
        BRepGProp.LinearProperties_s(edge, properties)
        apart = _distances(edge, beside)
        joints.append(
            MeasuredEdge(
                faces=tuple(k for k, face in enumerate(faces) if any(face.IsSame(own) for own in beside)),
                length=properties.Mass(),
                gap=float(apart.max()),
                opening=float(apart.mean()),
                tolerance=BRep_Tool.Tolerance_s(edge),
                vertex_tolerance=_vertex_tolerance(edge),
            )
        )
    return Closure(
        solids=len(subshapes(shape, TopAbs_SOLID)),
        shells=len(subshapes(shape, TopAbs_SHELL)),
        free=free,
        crowded=crowded,
        valid=BRepCheck_Analyzer(shape).IsValid(),
        joints=tuple(joints),
    )


def _uses(shape: TopoDS_Shape) -> dict[int, tuple[int, int]]:
    """How often faces run along each edge forwards and backwards, by the edge's place in the map of edges."""
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


def _distances(edge: TopoDS_Edge, beside: list[TopoDS_Face]) -> Array:
    """(PLACES,) [mm] Largest distance of the faces' and the edge's own curves at equal parameters."""
    own = BRepAdaptor_Curve(edge)
    curves = [own, *(BRepAdaptor_Curve(edge, face) for face in beside)]
    parameters = np.linspace(own.FirstParameter(), own.LastParameter(), POINTS_PER_EDGE).tolist()
    traces = [np.array([curve.Value(place).Coord() for place in parameters]) for curve in curves]
    squares = [np.zeros(POINTS_PER_EDGE)]
    squares += [np.sum((one - other) ** 2, axis=-1) for index, one in enumerate(traces) for other in traces[:index]]
    return np.sqrt(np.max(squares, axis=0))


def _vertex_tolerance(edge: TopoDS_Edge) -> float:
    ends = (TopExp.FirstVertex_s(edge), TopExp.LastVertex_s(edge))
    return max((BRep_Tool.Tolerance_s(end) for end in ends if not end.IsNull()), default=0.0)
