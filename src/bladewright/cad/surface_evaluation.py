"""Points and first derivatives of the surface under a face, native or from a CAD file, at many parameters at once."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from OCP.Geom import (
    Geom_BSplineSurface,
    Geom_Plane,
    Geom_RectangularTrimmedSurface,
    Geom_Surface,
    Geom_SurfaceOfRevolution,
    Geom_TrimmedCurve,
)
from OCP.GeomConvert import GeomConvert
from OCP.gp import gp_Pnt, gp_Vec

from bladewright.cad.conversion import native_curve, native_surface
from bladewright.cad.native_body import MM
from bladewright.numerics.elementary import Array
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface

Frame = tuple[Array, Array, Array]
"""points (n, 3) [mm] and their derivatives by the first and by the second parameter"""


PAST = 1e-9
"""How far a face may reach past a period of its surface, of a parameter range of 1, and count as within it: files round
their knots and trimming curves."""


class SurfaceEvaluator(Protocol):
    """The untrimmed surface under a face, in millimetres."""

    @property
    def period(self) -> float:
        """Period of the first parameter; 0 where the surface is not periodic."""

    def frame(self, uv: Array) -> Frame:
        """Points and first derivatives at parameters (n, 2)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class NurbsEvaluator:
    """A NURBS surface; `scale` turns its unit into millimetres."""

    surface: Surface
    scale: float = 1.0
    period: float = 0.0

    def frame(self, uv: Array) -> Frame:
        """Points and first derivatives at parameters (n, 2)."""
        found = self.surface.derivatives(uv[:, 0], uv[:, 1], 1)
        return self.scale * found[0, 0], self.scale * found[1, 0], self.scale * found[0, 1]


@dataclass(frozen=True, kw_only=True, eq=False)
class RevolutionEvaluator:
    """A surface of revolution: its parameters are the angle and the parameter of the curve that is turned."""

    curve: Curve
    origin: Array
    axis: Array
    period: float = 2.0 * np.pi

    def frame(self, uv: Array) -> Frame:
        """Points and first derivatives at parameters (n, 2)."""
        cosine, sine = np.cos(uv[:, :1]), np.sin(uv[:, :1])

        def turned(vectors: Array) -> Array:
            # Rodrigues' formula
            along = (vectors @ self.axis)[:, None] * self.axis
            return cosine * vectors + sine * np.cross(self.axis, vectors) + (1.0 - cosine) * along

        arms = turned(self.curve(uv[:, 1]) - self.origin)
        return self.origin + arms, np.cross(self.axis, arms), turned(self.curve.derivative(uv[:, 1]))


@dataclass(frozen=True, kw_only=True, eq=False)
class PlaneEvaluator:
    """A plane with two unit vectors in it."""

    origin: Array
    along: Array
    across: Array
    period: float = 0.0

    def frame(self, uv: Array) -> Frame:
        """Points and first derivatives at parameters (n, 2)."""
        points = self.origin + uv[:, :1] * self.along + uv[:, 1:] * self.across
        return points, np.broadcast_to(self.along, points.shape), np.broadcast_to(self.across, points.shape)


@dataclass(frozen=True, kw_only=True, eq=False)
class OccEvaluator:
    """Any other surface, evaluated point by point by OpenCASCADE, which takes ten times as long."""

    geometry: Geom_Surface
    period: float = 0.0

    def frame(self, uv: Array) -> Frame:
        """Points and first derivatives at parameters (n, 2)."""
        rows = []
        point, along, across = gp_Pnt(), gp_Vec(), gp_Vec()
        for u, v in uv.tolist():
            self.geometry.D1(u, v, point, along, across)
            rows.append([[t.X(), t.Y(), t.Z()] for t in (point, along, across)])
        found = np.array(rows).reshape(-1, 3, 3)
        return found[:, 0], found[:, 1], found[:, 2]


def occ_evaluator(geometry: Geom_Surface, low: Array, high: Array) -> SurfaceEvaluator:
    """The fastest evaluator for the surface of a CAD face, valid from parameters `low` (2,) to `high` (2,)."""
    while isinstance(geometry, Geom_RectangularTrimmedSurface):
        geometry = geometry.BasisSurface()
    if isinstance(geometry, Geom_BSplineSurface):
        clamped = _clamped(geometry, low, high)
        return OccEvaluator(geometry=geometry) if clamped is None else NurbsEvaluator(surface=native_surface(clamped))
    if isinstance(geometry, Geom_SurfaceOfRevolution):
        line = Geom_TrimmedCurve(geometry.BasisCurve(), *_extended_range(geometry.BasisCurve(), low[1], high[1]))
        axis = geometry.Axis()
        return RevolutionEvaluator(
            curve=native_curve(GeomConvert.CurveToBSplineCurve_s(line)),
            origin=_coordinates(axis.Location()),
            axis=_coordinates(axis.Direction()),
        )
    if isinstance(geometry, Geom_Plane):
        frame = geometry.Position()
        return PlaneEvaluator(
            origin=_coordinates(frame.Location()),
            along=_coordinates(frame.XDirection()),
            across=_coordinates(frame.YDirection()),
        )
    return OccEvaluator(geometry=geometry, period=2.0 * np.pi if geometry.IsUPeriodic() else 0.0)


def _clamped(geometry: Geom_BSplineSurface, low: Array, high: Array) -> Geom_BSplineSurface | None:
    """The same surface over one period, where a face does not reach past it: else None.

    OpenCASCADE makes faces of a whole turn periodic where it reads STEP and IGES.
    """
    if not (geometry.IsUPeriodic() or geometry.IsVPeriodic()):
        return geometry
    start, end = np.reshape(geometry.Bounds(), (2, 2)).T
    if np.any((low < start - PAST) | (high > end + PAST)):
        return None
    clamped: Geom_BSplineSurface = geometry.Copy()
    clamped.Segment(*geometry.Bounds())
    return clamped


def native_evaluator(surface: Surface) -> NurbsEvaluator:
    """The evaluator of a native surface [m], in millimetres."""
    return NurbsEvaluator(surface=surface, scale=MM)


def _extended_range(curve: object, low: float, high: float) -> tuple[float, float]:
    # a little beyond the trimmed part, so that Newton steps near the boundary stay on the curve
    margin = 0.05 * (high - low)
    first, last = curve.FirstParameter(), curve.LastParameter()  # type: ignore[attr-defined]
    return max(low - margin, first), min(high + margin, last)


def _coordinates(value: object) -> Array:
    return np.array([value.X(), value.Y(), value.Z()])  # type: ignore[attr-defined]
