"""Native NURBS curves and surfaces [m] converted to OpenCASCADE geometry [mm], and back."""

import numpy as np
from OCP.Geom import Geom_BSplineCurve, Geom_BSplineSurface
from OCP.Geom2d import Geom2d_BSplineCurve
from OCP.gp import gp_Pnt, gp_Pnt2d
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array1OfPnt2d, TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal, TColStd_Array2OfReal

from bladewright.cad.native_body import MM
from bladewright.errors import CadError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface


def space_curve(curve: Curve) -> Geom_BSplineCurve:
    """The same curve in millimetres, pole for pole."""
    points = millimetres(curve.control_points)
    poles = TColgp_Array1OfPnt(1, len(points))
    for i, point in enumerate(points.tolist(), 1):
        poles.SetValue(i, gp_Pnt(*point))
    knots, multiplicities = occ_knots(curve.knots)
    if curve.weights is None:
        return Geom_BSplineCurve(poles, knots, multiplicities, curve.degree)
    return Geom_BSplineCurve(poles, _reals(curve.weights), knots, multiplicities, curve.degree)


def plane_curve(curve: Curve) -> Geom2d_BSplineCurve:
    """The same curve in a parameter plane, pole for pole and without a change of unit."""
    poles = TColgp_Array1OfPnt2d(1, len(curve.control_points))
    for i, point in enumerate(curve.control_points.tolist(), 1):
        poles.SetValue(i, gp_Pnt2d(*point))
    knots, multiplicities = occ_knots(curve.knots)
    if curve.weights is None:
        return Geom2d_BSplineCurve(poles, knots, multiplicities, curve.degree)
    return Geom2d_BSplineCurve(poles, _reals(curve.weights), knots, multiplicities, curve.degree)


def space_surface(surface: Surface) -> Geom_BSplineSurface:
    """The same surface in millimetres, pole for pole."""
    net = millimetres(surface.control_points)
    count_u, count_v = net.shape[:2]
    poles = TColgp_Array2OfPnt(1, count_u, 1, count_v)
    for i, row in enumerate(net.tolist(), 1):
        for j, point in enumerate(row, 1):
            poles.SetValue(i, j, gp_Pnt(*point))
    knots_u, multiplicities_u = occ_knots(surface.knots_u)
    knots_v, multiplicities_v = occ_knots(surface.knots_v)
    shape = (knots_u, knots_v, multiplicities_u, multiplicities_v, surface.degree_u, surface.degree_v)
    if surface.weights is None:
        return Geom_BSplineSurface(poles, *shape)
    weights = TColStd_Array2OfReal(1, count_u, 1, count_v)
    for i, row in enumerate(np.real(surface.weights).tolist(), 1):
        for j, weight in enumerate(row, 1):
            weights.SetValue(i, j, weight)
    return Geom_BSplineSurface(poles, weights, *shape)


def millimetres(points: Array) -> Array:
    """Control points [m] in millimetres. Raises CadError where they are complex or not finite."""
    if np.iscomplexobj(points):
        raise CadError("a solid is made of real surfaces, these carry an imaginary step: build the real design")
    if not np.all(np.isfinite(points)):
        raise CadError("a control point is not a finite number: the surfaces cannot become a solid; check the design")
    return points * MM


def occ_knots(knots: Array) -> tuple[TColStd_Array1OfReal, TColStd_Array1OfInteger]:
    """Distinct knots and their multiplicities."""
    values, counts = np.unique(knots, return_counts=True)
    multiplicities = TColStd_Array1OfInteger(1, len(counts))
    for i, count in enumerate(counts.tolist(), 1):
        multiplicities.SetValue(i, count)
    return _reals(values), multiplicities


def _reals(values: Array) -> TColStd_Array1OfReal:
    array = TColStd_Array1OfReal(1, len(values))
    for i, value in enumerate(np.real(values).tolist(), 1):
        array.SetValue(i, value)
    return array


def native_surface(geometry: Geom_BSplineSurface) -> Surface:
    """A B-spline surface of OpenCASCADE, pole for pole, in its own unit (millimetres)."""
    count_u, count_v = geometry.NbUPoles(), geometry.NbVPoles()
    points = np.array([[geometry.Pole(i, j).Coord() for j in range(1, count_v + 1)] for i in range(1, count_u + 1)])
    weights = None
    if geometry.IsURational() or geometry.IsVRational():
        weights = np.array([[geometry.Weight(i, j) for j in range(1, count_v + 1)] for i in range(1, count_u + 1)])
    return Surface(
        control_points=points,
        knots_u=knot_sequence(geometry.UKnot, geometry.UMultiplicity, geometry.NbUKnots()),
        knots_v=knot_sequence(geometry.VKnot, geometry.VMultiplicity, geometry.NbVKnots()),
        degree_u=geometry.UDegree(),
        degree_v=geometry.VDegree(),
        weights=weights,
    )


def native_curve(geometry: Geom_BSplineCurve) -> Curve:
    """A B-spline curve of OpenCASCADE, pole for pole, in its own unit (millimetres)."""
    poles = (geometry.Pole(i) for i in range(1, geometry.NbPoles() + 1))
    weights = None
    if geometry.IsRational():
        weights = np.array([geometry.Weight(i) for i in range(1, geometry.NbPoles() + 1)])
    return Curve(
        control_points=np.array([pole.Coord() for pole in poles]),
        knots=knot_sequence(geometry.Knot, geometry.Multiplicity, geometry.NbKnots()),
        degree=geometry.Degree(),
        weights=weights,
    )


def knot_sequence(knot: object, multiplicity: object, count: int) -> Array:
    """Knots, each as often as its multiplicity, from OpenCASCADE's two getters."""
    values = [knot(i) for i in range(1, count + 1)]  # type: ignore[operator]
    counts = [multiplicity(i) for i in range(1, count + 1)]  # type: ignore[operator]
    return np.repeat(np.array(values), counts)
