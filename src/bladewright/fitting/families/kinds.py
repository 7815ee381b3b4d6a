"""The families that are one part, as fits know them: designs, starts and growth, by name."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from bladewright.blade.design.families import BLADE_OF
from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.designs import Design
from bladewright.fitting.families import (
    camber_angle,
    curvature_meanline,
    profile,
    suction_pressure,
    wedge_diffuser,
)
from bladewright.fitting.families.section_samples import SampledSection
from bladewright.section.camber_angle import CamberAngleSection
from bladewright.section.curvature_meanline import CurvatureMeanlineSection
from bladewright.section.planar import PlanarSection
from bladewright.section.profiles.kinds import ProfileSection
from bladewright.section.suction_pressure.part import SuctionPressureSection
from bladewright.section.wedge_diffuser import WedgeDiffuserSection


@dataclass(frozen=True, kw_only=True)
class FitFamily:
    """A family as fits know it."""

    name: str
    section: type[PlanarSection]
    templates: Callable[[SampledSection, int | None], Sequence[Any]]
    """parts whose structures are tried for a section where none is given, or for so many free parameters"""
    starts: Callable[[SampledSection, Any], Sequence[Any]]
    """parts of a structure near to a section, nearest first; may raise DesignError"""
    extensions: Callable[[Any, SampledSection], Sequence[Any]]
    """parts near to one that stands for a section, each with one control point more; may raise DesignError"""
    through_points: Callable[[SampledSection, int], Any] | None = None
    """the part through so many points of a section, where the family has one that follows any outline"""

    @property
    def blade(self) -> type[SectionedBlade]:
        """The blade of the same family."""
        return BLADE_OF[self.section]


def _family(name: str, section: type[PlanarSection], module: Any) -> FitFamily:
    return FitFamily(
        name=name,
        section=section,
        templates=module.templates,
        starts=module.starts,
        extensions=module.extensions,
        through_points=getattr(module, "through_points", None),
    )


FAMILIES = {
    kind.name: kind
    for kind in (
        _family("curvature-meanline", CurvatureMeanlineSection, curvature_meanline),
        _family("suction-pressure", SuctionPressureSection, suction_pressure),
        _family("wedge-diffuser", WedgeDiffuserSection, wedge_diffuser),
        _family("camber-angle", CamberAngleSection, camber_angle),
        _family("profile", ProfileSection, profile),
    )
}
"""the families by name"""


def family_of(design: Design) -> FitFamily | None:
    """The family of a design; None for designs of the unified family."""
    return next((kind for kind in FAMILIES.values() if isinstance(design, (kind.section, kind.blade))), None)
