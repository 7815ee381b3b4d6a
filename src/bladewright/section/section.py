"""One section as native curves, and the properties it has where it lies."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.numerics.elementary import Array, cross2, dot, length
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve

STEP = 1e-30
"""imaginary step that differentiates the scale"""
PER_SPAN = 12
"""Gauss points in a knot span"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Section:
    """A closed section between leading and trailing edge.

    Its plane is metric for a 2D section and a cascade. For a blade in an annulus it is the conformal plane
    (m', theta) of a stream surface, where lengths are `scale(m')` times those in the plane; the properties below are
    those on the stream surface.
    """

    span: float
    """v of the section, 0 for a 2D one"""
    plane: str
    """"x-y", "m-y" or "m'-theta" """
    curves: Mapping[str, Curve]
    """`upper` and `lower`, u from leading to trailing edge"""
    camber: Curve
    stagger: float
    """[rad]"""
    metal_angle_in: float
    """[rad]"""
    metal_angle_out: float
    """[rad]"""
    scale: Callable[[Array], Array]
    """metres in a unit of the plane, by the abscissa"""

    @cached_property
    def chord(self) -> float:
        """Length of the straight line of the plane from leading to trailing edge [m]."""
        ends = np.real(self.camber.control_points[[0, -1]])
        along = np.linspace(0.0, 1.0, 33)[:, None]
        line = ends[0] + along * (ends[1] - ends[0])
        return float(np.real(np.trapezoid(self.scale(line[:, 0]), along[:, 0])) * length(ends[1] - ends[0]))

    @cached_property
    def camber_length(self) -> float:
        """Length of the camber line [m]."""
        u, w = _gauss(self.camber.knots)
        return float(np.real(np.sum(w * length(self.camber.derivative(u)) * self.scale(self.camber(u)[:, 0]))))

    @cached_property
    def perimeter(self) -> float:
        """Length of both sides [m]."""
        total = 0.0
        for curve in self.curves.values():
            u, w = _gauss(curve.knots)
            total += float(np.real(np.sum(w * length(curve.derivative(u)) * self.scale(curve(u)[:, 0]))))
        return total

    @cached_property
    def area(self) -> float:
        """Area inside the sides [m^2], by Green's theorem."""
        return float(np.real(self._moment(lambda a: np.ones_like(a), 0)))

    @cached_property
    def centroid(self) -> Reals:
        """Centre of area (2,) in the coordinates of the plane."""
        abscissa = self._moment(lambda a: a, 0)
        ordinate = self._moment(lambda a: np.ones_like(a), 1)
        return np.real(np.array([abscissa, ordinate]) / self.area)

    def _moment(self, of_abscissa: Callable[[Array], Array], power: int) -> Array:
        total: Array = np.zeros(())
        for name, sign in (("upper", 1.0), ("lower", -1.0)):
            curve = self.curves[name]
            u, w = _gauss(curve.knots)
            point, slope = curve(u), curve.derivative(u)
            density = of_abscissa(point[:, 0]) * self.scale(point[:, 0]) ** 2
            total = total + sign * np.sum(w * density * point[:, 1] ** (power + 1) / (power + 1) * slope[:, 0])
        return total

    @cached_property
    def thickness(self) -> tuple[Reals, Reals]:
        """Camber parameters (n,) and full thickness across the camber there (n,) [m]."""
        u = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 201))) / 2.0
        point = np.real(self.camber(u))
        tangent = np.real(self.camber.derivative(u))
        normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=-1) / length(tangent)[:, None]
        total = np.zeros(len(u))
        for curve, sign in zip((self.curves["upper"], self.curves["lower"]), (1.0, -1.0), strict=True):
            total[1:-1] += _ray_lengths(curve, point[1:-1], sign * normal[1:-1])
        return u, total * np.real(self.scale(point[:, 0]))

    @cached_property
    def maximum_thickness(self) -> tuple[float, float]:
        """Largest thickness across the camber [m], and the camber parameter where it stands."""
        u, thickness = self.thickness
        i = int(np.clip(np.argmax(thickness), 1, len(u) - 2))
        parabola = np.polyfit(u[i - 1 : i + 2], thickness[i - 1 : i + 2], 2)
        place = float(-parabola[1] / (2.0 * parabola[0])) if parabola[0] < 0.0 else float(u[i])
        return float(np.polyval(parabola, place)) if parabola[0] < 0.0 else float(thickness[i]), place

    @property
    def maximum_camber(self) -> float:
        """Largest distance in the plane of the camber line from the straight chord line, times the scale there [m]."""
        u = np.linspace(0.0, 1.0, 401)
        point = np.real(self.camber(u))
        along = point[-1] - point[0]
        off = cross2(np.broadcast_to(along, point.shape), point - point[0]) / length(along)
        i = int(np.argmax(off * off))
        return float(off[i] * np.real(self.scale(point[i : i + 1, 0]))[0])

    @cached_property
    def edge_radii(self) -> tuple[float, float]:
        """Radii of curvature at the leading and the trailing edge, geodesic on a stream surface [m]."""
        bend = self.curvature("upper", np.array([0.0, 1.0]))
        radii = 1.0 / np.sqrt(bend * bend)
        return float(radii[0]), float(radii[1])

    def curvature(self, name: str, u: Reals) -> Reals:
        """Signed curvature (n,) of a side, geodesic on a stream surface [1/m]; positive where it turns to the left.

        In a plane with the scale e^l it is e^-l (k - dl/dn), k the plane's curvature and n the normal to the left.
        """
        curve = self.curves[name]
        abscissa = np.real(curve(u)[:, 0])
        first, second = np.real(curve.derivative(u)), np.real(curve.derivative(u, 2))
        scale = self.scale(abscissa + STEP * 1j)
        growth = np.imag(scale) / STEP / np.real(scale)
        left = -first[:, 1] / length(first)
        return (cross2(first, second) / length(first) ** 3 - growth * left) / np.real(scale)

    def to_dict(self) -> dict[str, object]:
        """The properties, for JSON."""
        thickest, place = self.maximum_thickness
        return {
            "span": self.span,
            "plane": self.plane,
            "chord": self.chord,
            "camber_length": self.camber_length,
            "perimeter": self.perimeter,
            "area": self.area,
            "centroid": [float(value) for value in self.centroid],
            "maximum_thickness": thickest,
            "maximum_thickness_at": place,
            "maximum_camber": self.maximum_camber,
            "edge_radii": list(self.edge_radii),
            "stagger_deg": float(np.degrees(self.stagger)),
            "metal_angle_in_deg": float(np.degrees(self.metal_angle_in)),
            "metal_angle_out_deg": float(np.degrees(self.metal_angle_out)),
        }


def _gauss(knots: Reals) -> tuple[Reals, Reals]:
    spans = np.unique(knots)
    x, w = np.polynomial.legendre.leggauss(PER_SPAN)
    half = np.diff(spans)[:, None] / 2.0
    return (spans[:-1, None] + half * (x + 1.0)).ravel(), (half * w).ravel()


def _ray_lengths(curve: Curve, origins: Reals, directions: Reals) -> Reals:
    """Distances (n,) from origins along directions to a side: the crossing nearest in height, by bisection on u."""
    u = np.linspace(0.0, 1.0, 801)
    points = np.real(curve(u))
    offset = points[None] - origins[:, None]
    beside = cross2(directions[:, None], offset)
    ahead = dot(directions[:, None], offset) > 0.0
    crossing = (beside[:, :-1] * beside[:, 1:] <= 0.0) & (ahead[:, :-1] | ahead[:, 1:])
    height = np.where(crossing, dot(directions[:, None], offset)[:, :-1], np.inf)
    index = np.argmin(height, axis=1)
    low, high = u[index], u[index + 1]
    sign = np.sign(beside[np.arange(len(index)), index])  # real: a search on real sections
    for _ in range(48):
        middle = (low + high) / 2.0
        value = cross2(directions, np.real(curve(middle)) - origins)
        left = value * sign > 0.0
        low, high = np.where(left, middle, low), np.where(left, high, middle)
    return dot(directions, np.real(curve((low + high) / 2.0)) - origins)
