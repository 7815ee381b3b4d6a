"""The families that are one part, as fits know them: by name their designs, starts and growth."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from bladewright.blade.families import BLADE_OF
from bladewright.blade.sectioned import SectionedBlade
from bladewright.designs import Design
from bladewright.fitting.families import (
    camber_angle,
    curvature_meanline,
    profile,
    suction_pressure,
    wedge_diffuser,
)
from bladewright.fitting.families.sampled import Sampled
from bladewright.section.camber_angle import CamberAngleSection
from bladewright.section.curvature_meanline import CurvatureMeanlineSection
from bladewright.section.planar import PlanarSection
from bladewright.section.profiles.kinds import ProfileSection
from bladewright.section.suction_pressure.part import SuctionPressureSection
from bladewright.section.wedge_diffuser import WedgeDiffuserSection


@dataclass(frozen=True, kw_only=True)
class Kind:
    """A family as fits know it."""

    name: str
    section: type[PlanarSection]
    templates: Callable[[Sampled, int | None], Sequence[Any]]
    """parts whose structures are tried for a section where none is given, or so many free parameters"""
    started: Callable[[Sampled, Any], Sequence[Any]]
    """parts of a structure near to a section, nearest first; may raise DesignError"""
    grown: Callable[[Any, Sampled], Sequence[Any]]
    """parts near to one, which stands for a section, each with a control point more; may raise DesignError"""
    outlined: Callable[[Sampled, int], Any] | None = None
    """the part through so many points of a section, where the family has one that follows any outline"""

    @property
    def blade(self) -> type[SectionedBlade]:
        """The blade of the same family."""
        return BLADE_OF[self.section]


def _kind(name: str, section: type[PlanarSection], module: Any) -> Kind:
    return Kind(
        name=name,
        section=section,
        templates=module.templates,
        started=module.started,
        grown=module.grown,
        outlined=getattr(module, "outlined", None),
    )


KINDS = {
    kind.name: kind
    for kind in (
        _kind("curvature-meanline", CurvatureMeanlineSection, curvature_meanline),
        _kind("suction-pressure", SuctionPressureSection, suction_pressure),
        _kind("wedge-diffuser", WedgeDiffuserSection, wedge_diffuser),
        _kind("camber-angle", CamberAngleSection, camber_angle),
        _kind("profile", ProfileSection, profile),
    )
}


def kind_of(design: Design) -> Kind | None:
    """The family of a design; None where it is no such one."""
    return next((kind for kind in KINDS.values() if isinstance(design, (kind.section, kind.blade))), None)
