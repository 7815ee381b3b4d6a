"""What other programs show: volumes by OpenCASCADE's default quadrature, which few points a face leave inexact."""

from OCP.BRepGProp import BRepGProp, BRepGProp_Domain, BRepGProp_Face, BRepGProp_Vinert
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

from bladewright.cad.native_body import MM
from bladewright.numerics.elementary import Array, cross, dot
from bladewright.nurbs.mass_properties import face_moments
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

GAUSS_POINTS = 8
"""On a panel of a trimmed face: exact to degree 15, far below the errors of 1e-7 that are looked for. Rounding
takes ten times as long on a wheel."""


def default_volume(shape: TopoDS_Shape) -> float:
    """Volume [mm^3] of a shape as FreeCAD, CadQuery and others show it, without a bound for its error."""
    whole = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, whole)
    return whole.Mass()


def volume_error(shape: TopoDS_Face, face: Surface | TrimmedSurface, orientation: int, origin: Array) -> float:
    """Error [m^3] that the default quadrature of one face adds to the volume of a body around `origin` (3,) [m].

    OpenCASCADE takes at most 61 Gauss points each way on a face, and at most 61 along each edge that trims one,
    however many knot spans they have. `orientation` is +1 where the native face's normal points out of the body.
    """
    found = BRepGProp_Vinert(BRepGProp_Face(shape), BRepGProp_Domain(shape), gp_Pnt(*(origin * MM).tolist())).Mass()
    return abs(found / MM**3 - orientation * _flux(face, origin))


def _flux(face: Surface | TrimmedSurface, origin: Array) -> float:
    """Flux of x / 3 through a face, with x from `origin`: its part of the volume."""
    if isinstance(face, Surface):
        return float(face_moments(face, origin)[3])
    surface = face.surface

    def density(u: Array, v: Array) -> Array:
        return dot(surface(u, v) - origin, cross(surface.derivative(u, v, 1, 0), surface.derivative(u, v, 0, 1)))

    return float(face.integral(density, GAUSS_POINTS)) / 3.0
