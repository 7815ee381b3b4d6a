"""Sections by suction and pressure side, and vanes of wedge diffusers, that look like what they are named after."""

from bladewright.section.suction_pressure.part import SuctionPressure, SuctionPressureSection
from bladewright.section.wedge_diffuser import WedgeDiffuser, WedgeDiffuserSection

STATOR = SuctionPressure(
    stagger_angle=22.0,
    metal_angle_in=42.0,
    metal_angle_out=2.0,
    leading_edge_radius=0.006,
    leading_edge_stretch=2.0,
    leading_edge_skew=0.1,
    leading_edge_wedge=14.0,
    trailing_edge_radius=0.006,
    trailing_edge_wedge=10.0,
    suction_tangent_in=0.09,
    suction_tangent_out=0.1,
    suction_heights=(0.108, 0.136, 0.104),
    pressure_tangent_in=0.1,
    pressure_tangent_out=0.1,
    pressure_heights=(0.044, 0.054, 0.044),
)
FAN_TIP = SuctionPressure(
    stagger_angle=-62.0,
    metal_angle_in=-64.0,
    metal_angle_out=-58.0,
    leading_edge_radius=0.0018,
    leading_edge_stretch=2.5,
    leading_edge_wedge=3.5,
    trailing_edge_radius=0.002,
    trailing_edge_wedge=3.5,
    suction_side="lower",
    edges="C1",
    suction_tangent_in=0.08,
    suction_tangent_out=0.07,
    suction_heights=(-0.0105, -0.0175, -0.0215, -0.0165),
    suction_places=(0.22, 0.42, 0.62, 0.82),
    pressure_thickness=(0.0135, 0.0215, 0.0225, 0.0145),
    pressure_places=(0.2, 0.4, 0.6, 0.8),
)
TURBINE = SuctionPressure(
    stagger_angle=-32.0,
    metal_angle_in=44.0,
    metal_angle_out=-66.0,
    leading_edge_radius=0.05,
    leading_edge_stretch=1.3,
    leading_edge_wedge=34.0,
    trailing_edge_radius=0.012,
    trailing_edge_wedge=5.0,
    skeleton="pseudo",
    suction_tangent_in=0.13,
    suction_tangent_out=0.2,
    suction_heights=(0.165, 0.135),
    suction_places=(0.33, 0.68),
    pressure_tangent_in=0.06,
    pressure_tangent_out=0.25,
    pressure_heights=(-0.075, -0.067),
    pressure_places=(0.3, 0.62),
)
WEDGE = WedgeDiffuser(stagger_angle=65.0, leading_edge_radius=0.008, trailing_edge_radius=0.02, wedge_angle=9.0)
TEARDROP = WedgeDiffuser(stagger_angle=65.0, leading_edge_radius=0.01, trailing_edge_radius=0.08)


def section(part: SuctionPressure) -> SuctionPressureSection:
    """The part as a section of 40 mm chord."""
    return SuctionPressureSection(name="section", length_unit="mm", chord=40.0, section=part)


def vane(part: WedgeDiffuser) -> WedgeDiffuserSection:
    """The part as a vane of 40 mm chord."""
    return WedgeDiffuserSection(name="vane", length_unit="mm", chord=40.0, section=part)
