"""The design families that a file can hold: one entry for each."""

from bladewright.blade.design.families import (
    CamberAngleBlade,
    CurvatureMeanlineBlade,
    ProfileBlade,
    SegmentedBlade,
    SuctionPressureBlade,
    WedgeDiffuserBlade,
)
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.designs import Design
from bladewright.errors import FileError
from bladewright.section.camber_angle import CamberAngleSection
from bladewright.section.curvature_meanline import CurvatureMeanlineSection
from bladewright.section.profiles.kinds import ProfileSection
from bladewright.section.segmented.part import SegmentedSection
from bladewright.section.suction_pressure.part import SuctionPressureSection
from bladewright.section.unified import UnifiedSection
from bladewright.section.wedge_diffuser import WedgeDiffuserSection

FAMILIES: dict[str, type[Design]] = {
    "unified": UnifiedBlade,
    "unified-section": UnifiedSection,
    "curvature-meanline-section": CurvatureMeanlineSection,
    "suction-pressure-section": SuctionPressureSection,
    "wedge-diffuser-section": WedgeDiffuserSection,
    "camber-angle-section": CamberAngleSection,
    "profile-section": ProfileSection,
    "segmented-section": SegmentedSection,
    "curvature-meanline": CurvatureMeanlineBlade,
    "suction-pressure": SuctionPressureBlade,
    "wedge-diffuser": WedgeDiffuserBlade,
    "camber-angle": CamberAngleBlade,
    "profile": ProfileBlade,
    "segmented": SegmentedBlade,
}
"""Design class by the `family` of its files."""


def family_of(design: Design) -> str:
    """The `family` that a design's file states; FileError where its class is not in `FAMILIES`."""
    for family, kind in FAMILIES.items():
        if type(design) is kind:
            return family
    known = ", ".join(kind.__name__ for kind in FAMILIES.values())
    raise FileError(f"a {type(design).__name__} has no file format: designs that files hold are {known}")
