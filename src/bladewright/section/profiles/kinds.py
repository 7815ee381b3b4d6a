"""The kinds of standard profiles, and the 2D design of a section of any of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from bladewright.section.planar import PlanarSection
from bladewright.section.profiles.c4 import C4
from bladewright.section.profiles.circular_arc import DoubleCircularArc, MultipleCircularArc
from bladewright.section.profiles.flat_plate import FlatPlate
from bladewright.section.profiles.naca4 import Naca4
from bladewright.section.profiles.naca5 import Naca5
from bladewright.section.profiles.naca6 import Naca6
from bladewright.section.profiles.naca65 import Naca65
from bladewright.section.profiles.points import PointsProfile
from bladewright.section.segmented.part import Segmented
from bladewright.section.tagged_unions import ByField

AnyProfile = Annotated[
    Naca4
    | Naca5
    | Naca6
    | Naca65
    | C4
    | DoubleCircularArc
    | MultipleCircularArc
    | FlatPlate
    | PointsProfile
    | Segmented,
    ByField("kind"),
]
"""One of the kinds of profiles, chosen by `kind`."""


@dataclass(frozen=True, kw_only=True)
class ProfileSection(PlanarSection):
    """A standard profile in the plane (x, y)."""

    section: AnyProfile
    """the profile: its kind and that kind's parameters"""
