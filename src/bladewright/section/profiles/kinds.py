"""The kinds of standard profiles, and the 2D design of a section of any of them."""

from dataclasses import dataclass

from bladewright.section.planar import PlanarSection
from bladewright.section.profiles.c4 import C4
from bladewright.section.profiles.naca4 import Naca4
from bladewright.section.profiles.naca5 import Naca5

AnyProfile = Naca4 | Naca5 | C4
"""One of the kinds, told apart by `kind`."""


@dataclass(frozen=True, kw_only=True)
class ProfileSection(PlanarSection):
    """A standard profile in the plane (x, y)."""

    section: AnyProfile
    """the profile: its kind and that kind's parameters"""
