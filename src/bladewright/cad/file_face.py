"""The faces of a CAD file with their trimming loops, ready to be sampled and measured."""

from dataclasses import dataclass

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve2d
from OCP.BRepGProp import BRepGProp
from OCP.BRepTools import BRepTools_WireExplorer
from OCP.Geom2d import Geom2d_BSplineCurve, Geom2d_TrimmedCurve
from OCP.Geom2dConvert import Geom2dConvert
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FORWARD, TopAbs_REVERSED, TopAbs_WIRE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Face

from bladewright.cad.conversion import knot_sequence
from bladewright.cad.reading import subshapes
from bladewright.cad.region import Region, greville_spaced
from bladewright.cad.surface_evaluation import NurbsEvaluator, occ_evaluator
from bladewright.errors import CadError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import reversed as run_backwards
from bladewright.nurbs.measure import area

ON_RECTANGLE = 1e-9
"""Largest distance of a trimming curve from a side of the parameter rectangle, as a fraction of its size, at which it
counts as that side. It allows for the rounding of the file; a face trimmed by so little differs by nothing that the
limits of the round trip would show."""
AREA_ERROR = 1e-10
"""Relative error of OpenCASCADE's quadrature of a trimmed face (design/cad_quadrature.py)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FileFace:
    """A face of a CAD file."""

    region: Region
    outline: Array
    """(n, 3) [mm] points on its boundary"""
    area: float
    """[mm^2] of an untrimmed B-spline surface by native quadrature on the file's poles, else by OpenCASCADE"""
    inside_out: bool
    """whether the face keeps the outside of its boundary"""


def file_face(face: TopoDS_Face) -> FileFace:
    """A face of a file with its trimming loops. Raises CadError where a loop is not closed."""
    forward = TopoDS.Face_s(face.Oriented(TopAbs_FORWARD))
    geometry = BRep_Tool.Surface_s(forward)
    loops = tuple(_loop(TopoDS.Wire_s(wire), forward) for wire in subshapes(forward, TopAbs_WIRE))
    if not loops:
        raise CadError("a face of the file has no boundary: it is not a face of a closed body")
    points = np.concatenate([curve.control_points for curve in _all(loops)])
    low, high = points.min(axis=0), points.max(axis=0)
    evaluator = occ_evaluator(geometry, low, high)
    turned = sum(_enclosed(loop) for loop in loops)
    outline = evaluator.frame(
        np.concatenate([curve(greville_spaced(curve.knots, curve.degree, 40)) for curve in _all(loops)])
    )[0]
    if isinstance(evaluator, NurbsEvaluator):
        surface = evaluator.surface
        start = np.array([surface.knots_u[0], surface.knots_v[0]])
        end = np.array([surface.knots_u[-1], surface.knots_v[-1]])
        rectangle = float(np.prod(end - start))
        if len(loops) == 1 and _on_rectangle(loops[0], start, end) and abs(abs(turned) - rectangle) < 1e-6 * rectangle:
            # OpenCASCADE's quadrature stays 1e-8 off where the normal reverses within a knot span
            region = Region(evaluator=evaluator, loops=(), low=start, high=end)
            return FileFace(region=region, outline=outline, area=float(area(surface)), inside_out=turned < 0.0)
        bounds = (start, end)
    else:
        u_low, u_high, v_low, v_high = geometry.Bounds()
        bounds = (np.array([u_low, v_low]), np.array([u_high, v_high]))
    margin = 0.05 * (high - low)
    if turned < 0.0:
        # a loop that runs clockwise keeps the outside of what it encloses, up to the bounds of the surface
        low, high = np.maximum(bounds[0], low - 10.0 * (high - low)), np.minimum(bounds[1], high + 10.0 * (high - low))
        evaluator = occ_evaluator(geometry, low, high)
        loops = (*loops, _frame(low, high))
    elif not evaluator.period:
        low, high = np.maximum(bounds[0], low - margin), np.minimum(bounds[1], high + margin)
    else:
        low = np.array([low[0] - margin[0], max(bounds[0][1], low[1] - margin[1])])
        high = np.array([high[0] + margin[0], min(bounds[1][1], high[1] + margin[1])])
    properties = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, properties, AREA_ERROR)
    region = Region(evaluator=evaluator, loops=loops, low=low, high=high)
    return FileFace(region=region, outline=outline, area=properties.Mass(), inside_out=turned < 0.0)


def _all(loops: tuple[tuple[Curve, ...], ...]) -> list[Curve]:
    return [curve for loop in loops for curve in loop]


def _loop(wire: object, face: TopoDS_Face) -> tuple[Curve, ...]:
    walk = BRepTools_WireExplorer(wire, face)
    edges = []
    while walk.More():
        edges.append(walk.Current())
        walk.Next()
    count = 0
    explorer = TopExp_Explorer(wire, TopAbs_EDGE)
    while explorer.More():
        count += 1
        explorer.Next()
    if len(edges) != count:
        raise CadError(
            f"a boundary of the file has {count} edges, of which only {len(edges)} follow each other: the face is not "
            "closed; write the file again"
        )
    return tuple(_pcurve(edge, face) for edge in edges)


def _pcurve(edge: TopoDS_Edge, face: TopoDS_Face) -> Curve:
    """The trimming curve of an edge, in the direction of the loop."""
    adaptor = BRepAdaptor_Curve2d(edge, face)
    cut = Geom2d_TrimmedCurve(adaptor.Curve(), adaptor.FirstParameter(), adaptor.LastParameter())
    spline: Geom2d_BSplineCurve = Geom2dConvert.CurveToBSplineCurve_s(cut)
    count = spline.NbPoles()
    poles = (spline.Pole(i) for i in range(1, count + 1))
    curve = Curve(
        control_points=np.array([(p.X(), p.Y()) for p in poles]),
        knots=knot_sequence(spline.Knot, spline.Multiplicity, spline.NbKnots()),
        degree=spline.Degree(),
        weights=np.array([spline.Weight(i) for i in range(1, count + 1)]) if spline.IsRational() else None,
    )
    return run_backwards(curve) if edge.Orientation() == TopAbs_REVERSED else curve


def _enclosed(loop: tuple[Curve, ...]) -> float:
    """Area that a loop encloses in the parameter plane, positive where the loop runs counter-clockwise."""
    points = np.concatenate([curve(greville_spaced(curve.knots, curve.degree, 401))[:-1] for curve in loop])
    ahead = np.roll(points, -1, axis=0)
    return 0.5 * float(np.sum(points[:, 0] * ahead[:, 1] - ahead[:, 0] * points[:, 1]))


def _on_rectangle(loop: tuple[Curve, ...], low: Array, high: Array) -> bool:
    size = high - low
    for curve in loop:
        net = (curve.control_points - low) / size
        borders = [np.max(np.abs(net[:, k] - end)) for k in (0, 1) for end in (0.0, 1.0)]
        if min(borders) > ON_RECTANGLE:
            return False
    return True


def _frame(low: Array, high: Array) -> tuple[Curve, ...]:
    corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]], low])
    return tuple(
        Curve(control_points=corners[k : k + 2], knots=np.array([0.0, 0.0, 1.0, 1.0]), degree=1) for k in range(4)
    )
