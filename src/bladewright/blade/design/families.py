"""The blades from sections, one of each family, and the prismatic blade of a 2D section."""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch
from typing import Any, overload

import numpy as np

from bladewright.blade.design.flow_path import Channel, FlowPath
from bladewright.blade.design.meridional_curve import ThroughPoints
from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Point
from bladewright.errors import DesignError
from bladewright.section.camber_angle import CamberAngle, CamberAngleSection
from bladewright.section.curvature_meanline import CurvatureMeanline, CurvatureMeanlineSection
from bladewright.section.laws import Span
from bladewright.section.planar import PlanarSection
from bladewright.section.profiles.kinds import AnyProfile, ProfileSection
from bladewright.section.segmented.part import Segmented, SegmentedSection
from bladewright.section.suction_pressure.part import SuctionPressure, SuctionPressureSection
from bladewright.section.unified import UnifiedSection
from bladewright.section.wedge_diffuser import WedgeDiffuser, WedgeDiffuserSection

WIDE_PITCH = 1e3
"""Pitch of a section that has none, in axial chords: so wide that neighbours never meet."""


@dataclass(frozen=True, kw_only=True)
class CurvatureMeanlineBlade(SectionedBlade):
    """A blade of sections on meanlines of given second derivative."""

    section: CurvatureMeanline
    """meanline and thickness, each number a law along the span"""


@dataclass(frozen=True, kw_only=True)
class SuctionPressureBlade(SectionedBlade):
    """A blade of sections by suction side and pressure side."""

    section: SuctionPressure
    """edges, suction side and pressure side, each number a law along the span"""


@dataclass(frozen=True, kw_only=True)
class WedgeDiffuserBlade(SectionedBlade):
    """A vane of a wedge diffuser."""

    section: WedgeDiffuser
    """radii and wedge angle, each a law along the span"""


@dataclass(frozen=True, kw_only=True)
class CamberAngleBlade(SectionedBlade):
    """A blade of sections whose camber lines have given angles along the meridional distance."""

    section: CamberAngle
    """camber angle and half thickness, each number a law along the span"""


@dataclass(frozen=True, kw_only=True)
class ProfileBlade(SectionedBlade):
    """A blade of standard profiles."""

    section: AnyProfile
    """the profile: its kind and that kind's parameters, each a law along the span"""


@dataclass(frozen=True, kw_only=True)
class SegmentedBlade(SectionedBlade):
    """A blade of segmented airfoils."""

    section: Segmented
    """joints, segments and morph, each number a law along the span"""


BLADE_OF: dict[type[PlanarSection], type[SectionedBlade]] = {
    CurvatureMeanlineSection: CurvatureMeanlineBlade,
    SuctionPressureSection: SuctionPressureBlade,
    WedgeDiffuserSection: WedgeDiffuserBlade,
    CamberAngleSection: CamberAngleBlade,
    ProfileSection: ProfileBlade,
    SegmentedSection: SegmentedBlade,
}
"""The blade of the same family, by the 2D design."""


@overload
def prismatic(section: UnifiedSection, span: float | None = None) -> UnifiedBlade: ...
@overload
def prismatic(section: PlanarSection, span: float | None = None) -> SectionedBlade: ...
def prismatic(section: UnifiedSection | PlanarSection, span: float | None = None) -> UnifiedBlade | SectionedBlade:
    """The design of the blade that a section becomes when drawn along z, `span` high [length].

    Raises DesignError where neither the call nor the section has a span.
    """
    height = section.span if span is None else span
    if height is None:
        raise DesignError("span is missing: a section becomes a solid by its height; set span in the design")
    return _drawn(section, height)


@singledispatch
def _drawn(section: Any, height: float) -> Any:
    """The blade of a kind of 2D design between two planes."""
    raise TypeError(f"a {type(section).__name__} is no 2D section (height {height:g})")


@_drawn.register
def _of_unified(section: UnifiedSection, height: float) -> UnifiedBlade:
    start, end = section.leading_edge_x, section.leading_edge_x + section.axial_chord
    same = {
        name: getattr(section, name)
        for name in (
            "name",
            "length_unit",
            "leading_edge_y",
            "stagger",
            "metal_angle_in",
            "metal_angle_out",
            "tangent_in",
            "tangent_out",
            "leading_edge_radius",
            "trailing_edge_radius",
            "thickness_upper",
            "thickness_lower",
            "weights_upper",
            "weights_lower",
            "samples",
            "clustering",
            "description",
            "author",
            "organisation",
        )
    }
    return UnifiedBlade(
        **same,
        arrangement="linear",
        pitch=WIDE_PITCH * section.axial_chord if section.pitch is None else section.pitch,
        channel=Channel(
            leading_edge=(Point(start, 0.0), Point(start, height)), trailing_edge=(Point(end, 0.0), Point(end, height))
        ),
    )


@_drawn.register
def _of_family(section: PlanarSection, height: float) -> SectionedBlade:
    """The same of a section of a family: hub and shroud are straight, and reach a chord past both edges."""
    stagger = section.section.stagger(Span(np.zeros(1)))[..., 0]
    start: Any = section.leading_edge_x
    end = start + section.chord * np.cos(stagger)
    if np.ndim(end) == 0:
        end = end.item()
    extension = float(np.real(np.ravel(section.chord)[0]))
    x = [float(np.real(np.ravel(each)[0])) for each in (start, end)]

    def line(*ends: tuple[Any, float]) -> ThroughPoints:
        return ThroughPoints(points=tuple(Point(*each) for each in ends))

    hub, shroud = (line((x[0] - extension, z), (x[1] + extension, z)) for z in (0.0, height))
    return BLADE_OF[type(section)](
        name=section.name,
        length_unit=section.length_unit,
        arrangement="linear",
        pitch=WIDE_PITCH * section.chord if section.pitch is None else section.pitch,
        leading_edge_y=section.leading_edge_y,
        flow_path=FlowPath(hub=hub, shroud=shroud),
        leading_edge=line((start, 0.0), (start, height)),
        trailing_edge=line((end, 0.0), (end, height)),
        section=section.section,
        description=section.description,
        author=section.author,
        organisation=section.organisation,
    )
