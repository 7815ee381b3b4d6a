"""The families that are one part, as fits know them: their designs and where they begin, by name."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from bladewright.blade.design.families import BLADE_OF
from bladewright.blade.design.row_design import BLADES, FIELDS_OF, Arrangement, LengthUnit
from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.designs import Design
from bladewright.errors import FitError
from bladewright.fitting.checks import check_positive, refusing
from bladewright.fitting.families import segmented
from bladewright.fitting.families.closed_blade import SectionShape
from bladewright.fitting.families.first_parts import (
    CAMBER_ANGLES,
    CURVATURE_MEANLINES,
    PROFILES,
    WEDGE_DIFFUSERS,
    first_part,
    suction_pressures,
)
from bladewright.nurbs.basis import Reals
from bladewright.section import checks
from bladewright.section.camber_angle import CamberAngleSection
from bladewright.section.curvature_meanline import CurvatureMeanlineSection
from bladewright.section.planar import PlanarSection
from bladewright.section.profiles.kinds import ProfileSection
from bladewright.section.segmented.part import SegmentedSection
from bladewright.section.suction_pressure.part import SuctionPressureSection
from bladewright.section.wedge_diffuser import WedgeDiffuserSection


@dataclass(frozen=True, kw_only=True)
class DesignHeader:
    """Name, unit and the row that a blade stands in; None where nobody has said it.

    Raises FitError where a value is none that a design may have, or an arrangement has no such field.
    """

    name: str
    length_unit: LengthUnit
    pitch: float | None = None
    """[m]"""
    arrangement: Arrangement | None = None
    blade_count: int | None = None

    def __post_init__(self) -> None:
        with refusing():
            checks.choice("length_unit", self.length_unit, list(checks.UNITS))
            if self.blade_count is not None:
                low, high = int(BLADES.low), int(BLADES.high)
                checks.integer("blade_count", self.blade_count, low, high, "a whole number of blades is needed")
            if self.arrangement is not None:
                checks.choice("arrangement", self.arrangement, list(FIELDS_OF))
        if self.pitch is not None:
            check_positive("pitch", self.pitch, "a positive length in metres is needed, such as 0.0575")
        for other, (name, _) in FIELDS_OF.items():
            if self.arrangement not in (None, other) and getattr(self, name) is not None:
                raise FitError(
                    f"{name} is {getattr(self, name)}, which a blade of the arrangement {self.arrangement} does not "
                    f"have: leave it out, or give the arrangement {other}"
                )

    def check_place(self, dimension: int, start: Any = None) -> None:
        """Raise FitError for what points of so many coordinates do not have, or what a start has otherwise."""
        for name in ("arrangement", "blade_count"):
            if dimension == 2 and getattr(self, name) is not None:
                raise FitError(
                    f"{name} is {getattr(self, name)}, and the points have two coordinates: a section has a pitch "
                    f"alone; leave {name} out, or give points in space"
                )
        if start is None:
            return
        own = {name: getattr(start, name, None) for name in ("arrangement", "blade_count", "length_unit", "pitch")}
        if own["pitch"] is not None:
            own["pitch"] *= checks.UNITS[start.length_unit]
        for name, value in own.items():
            stated = getattr(self, name)
            same = math.isclose(stated, value) if name == "pitch" and stated and value else stated == value
            if stated is not None and not same:
                unit = " m" if name == "pitch" else ""
                kept = "none" if value is None else f"{value}{unit}"
                raise FitError(
                    f"{name} is {stated}{unit}, and the start has {kept}, which is kept: leave {name} out, or change "
                    "the start"
                )

    def known(self, like: Any = None) -> dict[str, Any]:
        """Its fields; arrangement, blade count and pitch [m] of a given design where they are not stated."""
        if like is None:
            return vars(self)
        pitch = None if like.pitch is None else like.pitch * like.metre
        own = {"arrangement": like.arrangement, "blade_count": like.blade_count, "pitch": pitch}
        return {name: own.get(name) if value is None else value for name, value in vars(self).items()}


@dataclass(frozen=True)
class FitFamily:
    """A family as fits know it."""

    name: str
    section: type[PlanarSection]
    structures: Callable[[SectionShape], Sequence[Any]]
    """parts whose structures are tried near a section where none is given"""
    has_contours: bool = False
    """whether one of its kinds, a contour through points, follows any outline"""
    contour_shape: Callable[[Reals], SectionShape | None] | None = None
    """the section of points (n, 2) in order around it, where the family takes it from the points themselves"""

    @property
    def blade(self) -> type[SectionedBlade]:
        """The blade of the same family."""
        return BLADE_OF[self.section]

    def first_parts(self, shape: SectionShape, like: Any = None) -> list[Any]:
        """The parts nearest to a section: of the structure of a given part, or of every structure that is tried."""
        return [first_part(each, shape) for each in (self.structures(shape) if like is None else (like,))]


FAMILIES = {
    each.name: each
    for each in (
        FitFamily("curvature-meanline", CurvatureMeanlineSection, lambda _: CURVATURE_MEANLINES),
        FitFamily("suction-pressure", SuctionPressureSection, suction_pressures),
        FitFamily("wedge-diffuser", WedgeDiffuserSection, lambda _: WEDGE_DIFFUSERS),
        FitFamily("camber-angle", CamberAngleSection, lambda _: CAMBER_ANGLES),
        FitFamily("profile", ProfileSection, lambda _: PROFILES, has_contours=True),
        FitFamily("segmented", SegmentedSection, segmented.structures, contour_shape=segmented.contour_shape),
    )
}
"""the families by name"""


def family_of(design: Design) -> FitFamily | None:
    """The family of a design; None for designs of the unified family."""
    return next((kind for kind in FAMILIES.values() if isinstance(design, (kind.section, kind.blade))), None)
