"""The blades from sections, one of each family, and the family's section in 2D that belongs to each."""

from dataclasses import dataclass

from bladewright.blade.sectioned import SectionedBlade
from bladewright.section.camber_angle import CamberAngle, CamberAngleSection
from bladewright.section.curvature_meanline import CurvatureMeanline, CurvatureMeanlineSection
from bladewright.section.planar import PlanarSection
from bladewright.section.profiles.kinds import AnyProfile, ProfileSection
from bladewright.section.suction_pressure.part import SuctionPressure, SuctionPressureSection
from bladewright.section.wedge_diffuser import WedgeDiffuser, WedgeDiffuserSection


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


BLADE_OF: dict[type[PlanarSection], type[SectionedBlade]] = {
    CurvatureMeanlineSection: CurvatureMeanlineBlade,
    SuctionPressureSection: SuctionPressureBlade,
    WedgeDiffuserSection: WedgeDiffuserBlade,
    CamberAngleSection: CamberAngleBlade,
    ProfileSection: ProfileBlade,
}
"""The blade of the same family, by the 2D design."""
