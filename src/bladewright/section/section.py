"""One section as native curves, and its properties in the plane or on the stream surface where it lies."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from bladewright.display import Shown
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import Array, cross2, dot, length
from bladewright.numerics.quadrature import panels
from bladewright.nurbs.basis import Reals, breaks
from bladewright.nurbs.curve import Curve
from bladewright.section.outline import Outline
from bladewright.section.section_station import SectionStation, section_station

STEP = 1e-30
"""imaginary step by the abscissa that differentiates the scale: so small that its square vanishes"""
PER_SPAN = 12
"""Gauss points in a knot span: chord, area and perimeter of the built-in examples are then within 3e-9, with 8 points
within 1e-7 (design/section_constants.py)"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Section(FrozenRecord, Shown):
    """A closed section between leading and trailing edge.

    Its plane is metric for a 2D section and a cascade. For a blade in an annulus it is the conformal plane
    (m', theta) of a stream surface, where lengths are `scale(m')` times those in the plane; the properties below are
    those on the stream surface. Lengths, area and centroid are complex where the curves are; thickness, camber and
    curvature are searched for on the real section.
    """

    dimension: ClassVar[int] = 2
    shown_as: ClassVar[str] = "section"

    span: float
    """v of the section, 0 for a 2D one"""
    plane: str
    """"x-y", "m-y" or "m'-theta" """
    curves: Mapping[str, Curve]
    """`upper` and `lower`, u from leading to trailing edge; `leading_edge` or `trailing_edge` where one is blunt: its
    face, u from the upper to the lower side"""
    camber: Curve
    stagger: float
    """[rad]"""
    metal_angle_in: float
    """[rad]"""
    metal_angle_out: float
    """[rad]"""
    scale: Callable[[Array], Array]
    """metres in a unit of the plane, by the abscissa"""
    edges: tuple[str, str] = ("round", "round")
    """how the sides meet at the leading and at the trailing edge: "round", "sharp" or "blunt" """
    knots: Any = None
    """the knots that a build can hold; None for the unified family, whose knots are fixed"""
    meanline: Callable[[Array], tuple[Array, Array, Array]] | None = None
    """v and its first two derivatives by u along the chord, in chords, where the section is built on a meanline"""

    outline: Outline | None = None
    """the exact section in chords, unstaggered, where the family has one"""
    name: str = "section"
    """the design's name"""
    length_unit: str = "m"
    """the design's unit of length, in which reports print"""
    reference_chord: Array | None = None
    """() [m] to which a 2D section's coefficients refer: the design's chord, also where a morph moved the edges off its
    ends; None: `chord`"""
    pitch: Array | None = None
    """() tangential distance of neighbours, where a 2D design has one [m]"""

    def sections_at(self, spans: Sequence[float]) -> list["Section"]:  # noqa: ARG002 - a blade has one for each
        """The section alone, where a blade answers with one for each of the span fractions."""
        return [self]

    def report(self) -> SectionStation:
        """The station table of a 2D section, of one station; raises DesignError for a section of a blade."""
        return section_station(self)

    def __repr__(self) -> str:
        chord, stagger = float(np.real(self.chord)), np.degrees(self.stagger)
        where = f"at span {self.span:.6g}, {self.plane}"
        return f"<Section {where}: {', '.join(self.curves)}; chord {chord:.6g} m, stagger {stagger:.6g} deg>"

    @cached_property
    def chord(self) -> Array:
        """Length () of the straight line of the plane from leading to trailing edge [m]."""
        start, end = self.camber.control_points[0], self.camber.control_points[-1]
        along, weight = panels([0.0, 1.0], 4 * PER_SPAN)
        scale: Array = np.asarray(np.sum(weight * self.scale(start[0] + along * (end[0] - start[0]))))
        return scale * length(end - start)

    @cached_property
    def camber_length(self) -> Array:
        """Length () of the camber line [m]."""
        return self._length(self.camber)

    @cached_property
    def perimeter(self) -> Array:
        """Length () of all curves of the outline [m]."""
        return np.asarray(sum(self._length(curve) for curve in self.curves.values()))

    @cached_property
    def area(self) -> Array:
        """Area () inside the sides [m^2], by Green's theorem."""
        return self._moment(0, 0)

    @cached_property
    def centroid(self) -> Array:
        """Centre of area (2,) in the coordinates of the plane."""
        return np.stack([self._moment(1, 0), self._moment(0, 1)]) / self.area

    def _length(self, curve: Curve) -> Array:
        u, weight = panels(breaks(curve.knots), PER_SPAN)
        return np.asarray(np.sum(weight * length(curve.derivative(u)) * self.scale(curve(u)[:, 0])))

    def _moment(self, of_abscissa: int, of_ordinate: int) -> Array:
        """Integral over the section of powers of its coordinates, times the scale squared."""
        total: Array = np.zeros(())
        for name, curve in self.curves.items():
            sign = 1.0 if name in ("upper", "trailing_edge") else -1.0
            u, weight = panels(breaks(curve.knots), PER_SPAN)
            point, slope = curve(u), curve.derivative(u)
            density = point[:, 0] ** of_abscissa * self.scale(point[:, 0]) ** 2
            inner = point[:, 1] ** (of_ordinate + 1) / (of_ordinate + 1)
            total = total + sign * np.sum(weight * density * inner * slope[:, 0])
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
        for end, name in ((0, "leading_edge"), (-1, "trailing_edge")):
            if name in self.curves:
                face = np.real(self.curves[name].control_points)
                total[end] = length(face[-1] - face[0])
        return u, total * np.real(self.scale(point[:, 0]))

    @cached_property
    def maximum_thickness(self) -> tuple[float, float]:
        """Largest thickness across the camber [m], and the camber parameter where it is."""
        u, thickness = self.thickness
        i = int(np.argmax(thickness))
        if i in (0, len(u) - 1):
            return float(thickness[i]), float(u[i])
        parabola = np.polyfit(u[i - 1 : i + 2], thickness[i - 1 : i + 2], 2)
        place = float(-parabola[1] / (2.0 * parabola[0])) if parabola[0] < 0.0 else float(u[i])
        return float(np.polyval(parabola, place)) if parabola[0] < 0.0 else float(thickness[i]), place

    @property
    def maximum_camber(self) -> float:
        """Largest distance in the plane of the camber line from the straight chord line, times the scale there [m]."""
        u = np.linspace(0.0, 1.0, 401)
        point = np.real(self.camber(u))
        along = point[-1] - point[0]
        height = cross2(np.broadcast_to(along, point.shape), point - point[0]) / length(along)
        i = int(np.argmax(height * height))
        return float(height[i] * np.real(self.scale(point[i : i + 1, 0]))[0])

    @cached_property
    def edge_radii(self) -> tuple[float, float]:
        """Radii of curvature at the leading and the trailing edge, geodesic on a stream surface; 0 if not round [m]."""
        bend = self.curvature("upper", np.array([0.0, 1.0]))
        # an edge may be round, and flat at its very point
        with np.errstate(divide="ignore"):
            radii = [
                float(1.0 / np.sqrt(b * b)) if kind == "round" else 0.0
                for b, kind in zip(bend, self.edges, strict=True)
            ]
        return radii[0], radii[1]

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
            "chord": float(np.real(self.chord)),
            "camber_length": float(np.real(self.camber_length)),
            "perimeter": float(np.real(self.perimeter)),
            "area": float(np.real(self.area)),
            "centroid": [float(value) for value in np.real(self.centroid)],
            "maximum_thickness": thickest,
            "maximum_thickness_at": place,
            "maximum_camber": self.maximum_camber,
            "edge_radii": list(self.edge_radii),
            "stagger_deg": float(np.degrees(self.stagger)),
            "metal_angle_in_deg": float(np.degrees(self.metal_angle_in)),
            "metal_angle_out_deg": float(np.degrees(self.metal_angle_out)),
        }


def _ray_lengths(curve: Curve, origins: Reals, directions: Reals) -> Reals:
    """Distances (n,) from origins along directions to a side: the crossing nearest in height, by bisection on u."""
    u = np.linspace(0.0, 1.0, 801)
    points = np.real(curve(u))
    offset = points[None] - origins[:, None]
    cross_products = cross2(directions[:, None], offset)
    ahead = dot(directions[:, None], offset) > 0.0
    crossing = (cross_products[:, :-1] * cross_products[:, 1:] <= 0.0) & (ahead[:, :-1] | ahead[:, 1:])
    height = np.where(crossing, dot(directions[:, None], offset)[:, :-1], np.inf)
    index = np.argmin(height, axis=1)
    low, high = u[index], u[index + 1]
    sign = np.sign(cross_products[np.arange(len(index)), index])  # real: a search on real sections
    for _ in range(48):
        middle = (low + high) / 2.0
        value = cross2(directions, np.real(curve(middle)) - origins)
        left = value * sign > 0.0
        low, high = np.where(left, middle, low), np.where(left, high, middle)
    return dot(directions, np.real(curve((low + high) / 2.0)) - origins)
