"""The unified section as a 2D design: camber and two thickness laws in the plane (Agromayor et al. 2021, section 3)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from bladewright.designs import ChordwiseLaw, Design, parameter
from bladewright.errors import DesignError
from bladewright.frozen import FrozenMapping
from bladewright.numerics.elementary import Array, radians
from bladewright.nurbs.transform import translated
from bladewright.section import checks
from bladewright.section.camber import camber_line
from bladewright.section.crossing import PLACES, check_outlines, outlines_of, touching
from bladewright.section.laws import Span, check_plain
from bladewright.section.section import Section
from bladewright.section.unified_limits import (
    ANGLE,
    ANGLES,
    POSITIVE,
    RADII,
    RADIUS,
    TANGENT,
    THICKNESS,
    THICKNESSES,
    WEIGHT,
    WEIGHTS,
    check_edges,
    check_labels,
    check_sampling,
)
from bladewright.section.unified_sides import camber_curve, matched, plane_sections, sample_places, side, side_curve

Numbers = tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class UnifiedSection(Design):
    """A section of the unified family in the plane (x, y), x axial and y tangential.

    Thicknesses, radii and tangent proportions are fractions of the axial chord.
    Reference: Agromayor et al. 2021, section 3.
    """

    dimension: ClassVar[int] = 2
    reference_length: ClassVar[str] = "axial chord"
    has_planar_passage: ClassVar[bool] = True

    name: str
    """the part's name, used in files"""
    length_unit: Literal["m", "cm", "mm", "um", "in", "ft"]
    """unit of every length in the design"""
    pitch: float | None = parameter("length", limits=POSITIVE, default=None)
    """tangential distance of neighbours; none: a single section [length]"""
    leading_edge_x: float = parameter("length", default=0.0)
    """axial position of the leading edge [length]"""
    leading_edge_y: float = parameter("length", default=0.0)
    """tangential position of the leading edge [length]"""
    axial_chord: float = parameter("length", limits=POSITIVE)
    """axial distance from leading to trailing edge [length]"""
    stagger: float = parameter("deg", limits=ANGLE)
    """angle of the chord line from the axis [deg]"""
    metal_angle_in: float = parameter("deg", limits=ANGLE)
    """camber angle at the leading edge [deg]"""
    metal_angle_out: float = parameter("deg", limits=ANGLE)
    """camber angle at the trailing edge [deg]"""
    tangent_in: float = parameter("-", limits=TANGENT)
    """length of the camber's tangent at the leading edge, of the axial chord [-]"""
    tangent_out: float = parameter("-", limits=TANGENT)
    """length of the camber's tangent at the trailing edge, of the axial chord [-]"""
    leading_edge_radius: float = parameter("-", limits=RADIUS)
    """radius of curvature at the leading edge, of the axial chord [-]"""
    trailing_edge_radius: float = parameter("-", limits=RADIUS)
    """radius of curvature at the trailing edge, of the axial chord [-]"""
    thickness_upper: Numbers = parameter("-", limits=THICKNESS)
    """half thickness of the upper side, control points along the chord, of the axial chord [-]"""
    thickness_lower: Numbers = parameter("-", limits=THICKNESS)
    """half thickness of the lower side, control points along the chord, of the axial chord [-]"""
    weights_upper: Numbers = parameter("-", limits=WEIGHT, default=())
    """weights of the upper side's control points, a law along the chord; none: a B-spline [-]"""
    weights_lower: Numbers = parameter("-", limits=WEIGHT, default=())
    """weights of the lower side's control points, a law along the chord; none: a B-spline [-]"""
    span: float | None = parameter("length", limits=POSITIVE, default=None)
    """height of the prismatic blade that the section becomes as a solid; none: a section only [length]"""
    samples: int = 16
    """number of places along the chord where the thickness laws are evaluated, edges excluded [-]"""
    clustering: float = 1.0
    """spacing of the samples: 0 uniform, 1 cosine towards both edges [-]"""
    description: str = ""
    """one line for the header of CAD files"""
    author: str = ""
    """for the header of CAD files"""
    organisation: str = ""
    """for the header of CAD files"""

    def __post_init__(self) -> None:
        check_labels(self)
        checks.parameters(self)
        rows = ((name, getattr(self, name)) for name in (*THICKNESSES, *WEIGHTS))
        check_plain((f"{name}[{i}]", law) for name, row in rows for i, law in enumerate(row))
        check_sampling(self)

    @property
    def thickness_laws(self) -> Mapping[str, ChordwiseLaw]:
        """Half-thickness laws along the chord of the `upper` and the `lower` side."""
        return {"upper": self.thickness_upper, "lower": self.thickness_lower}

    def outline(self, *, tentative: bool = False) -> tuple[Array, Array, Array]:
        """Control points [m] of the camber line (..., 1, 4, 2) and of the upper and the lower side (..., 1, n, 2).

        Those of the sides are homogeneous, (w x, w y, w), where one has weights. The leading edge's x is not in them.
        Raises DesignError for an edge radius that the thickness cannot hold, unless the design is tentative.
        """
        metre, span = checks.UNITS[self.length_unit], Span(np.zeros(1))

        def value(name: str) -> Any:
            return np.asarray(getattr(self, name))[..., None]

        chord = value("axial_chord") * metre
        stagger, angle_in, angle_out = (radians(value(name)) for name in ANGLES)
        start, extent = np.broadcast_arrays(value("leading_edge_y") * metre, chord)
        line = camber_line(start, extent, stagger, angle_in, angle_out, value("tangent_in"), value("tangent_out"))
        places = sample_places(self.samples, self.clustering)
        curvatures = [1.0 / (value(name) * chord) for name in RADII]
        sides = []
        for name in ("upper", "lower"):
            thickness = span.chordwise(getattr(self, f"thickness_{name}"), places[2:-2]) * chord[..., None]
            laws = getattr(self, f"weights_{name}")
            weights = span.chordwise(laws, places) if laws else None
            if not tentative:
                check_edges(self, name, line, places, thickness, curvatures, weights, span)
            sides.append(side(line, places, thickness, *curvatures, upper=name == "upper", weights=weights))
        return line, *matched(*sides)

    def build(self) -> Section:
        """The section in metres and radians; raises DesignError where the shape is impossible."""
        metre = checks.UNITS[self.length_unit]
        line, upper, lower = self.outline()
        self._check_outline(line, upper, lower, metre)
        stagger, angle_in, angle_out = (float(np.real(radians(np.asarray(getattr(self, name))))) for name in ANGLES)
        shift = np.array([self.leading_edge_x * metre, 0.0])
        return Section(
            span=0.0,
            plane="x-y",
            curves=FrozenMapping(
                {"upper": translated(side_curve(upper[0]), shift), "lower": translated(side_curve(lower[0]), shift)}
            ),
            camber=translated(camber_curve(line[0]), shift),
            stagger=stagger,
            metal_angle_in=angle_in,
            metal_angle_out=angle_out,
            scale=np.ones_like,
            name=self.name,
            length_unit=self.length_unit,
            pitch=None if self.pitch is None else np.asarray(self.pitch * metre),
        )

    def _check_outline(self, line: Array, upper: Array, lower: Array, metre: float) -> None:
        outlines = outlines_of(*(np.real(points) for points in plane_sections(line, upper, lower).points(PLACES)))
        check_outlines(outlines[:1], [""])
        if self.pitch is not None and touching(outlines[:1], float(np.real(self.pitch)) * metre) is not None:
            raise DesignError(f"pitch is {self.pitch:g}: neighbouring sections intersect; take a larger pitch")
