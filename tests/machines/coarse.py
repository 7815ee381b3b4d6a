"""Small machines, each with something that its parameters do in another way, at few poles."""

from dataclasses import replace

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.section.unified import UnifiedSection

from . import COARSE, unified

COMMON = {
    "length_unit": "mm",
    "tangent_in": 0.35,
    "tangent_out": (0.4, 0.45),
    "thickness_upper": (0.03, (0.05, 0.06, 0.05), 0.03, (0.02, 0.025)),
    "thickness_lower": (0.03, 0.045, 0.03),
    "samples": 6,
    "tolerance": COARSE,
}
ROTOR = UnifiedBlade(
    **COMMON,
    name="rotor",
    blade_count=17,
    leading_edge_theta=(0.0, 1.0, -0.5),
    stagger=(15.0, 30.0, 45.0, 50.0, 55.0),
    metal_angle_in=(38.0, 50.0, 60.0),
    metal_angle_out=(-10.0, 30.0, 50.0),
    leading_edge_radius=(0.005, 0.004),
    trailing_edge_radius=0.004,
    channel=Channel(
        leading_edge=((0.0, 95.0), (6.0, 152.0), (20.0, 250.0)),
        trailing_edge=((89.0, 118.0), (70.0, 248.0)),
        hub=((23.0, 100.0), (65.0, 116.0)),
    ),
)
CLEARED = replace(
    ROTOR,
    name="cleared",
    stagger=(15.0, 40.0, 50.0),
    tip_clearance=(2.0, 3.0),
    weights_upper=(1.0, (1.1, 0.9), 1.2),
    channel=replace(ROTOR.channel, shroud=((40.0, 252.0),)),
)
RADIAL = replace(
    unified.IMPELLER,
    **COMMON,
    name="radial",
    metal_angle_out=-35.0,
    leading_edge_radius=0.006,
    trailing_edge_radius=0.006,
)
CASCADE = replace(unified.CASCADE, **COMMON)
SECTION = UnifiedSection(
    name="section",
    length_unit="mm",
    axial_chord=40.0,
    leading_edge_x=3.0,
    leading_edge_y=-2.0,
    pitch=30.0,
    stagger=-30.0,
    metal_angle_in=10.0,
    metal_angle_out=-60.0,
    tangent_in=0.4,
    tangent_out=0.5,
    leading_edge_radius=0.02,
    trailing_edge_radius=0.01,
    thickness_upper=(0.05, 0.08, 0.03),
    thickness_lower=(0.05, 0.06, 0.03),
    weights_upper=(1.0, 1.2, 1.1),
)
BLADES = {blade.name: blade for blade in (ROTOR, CLEARED, RADIAL, CASCADE)}
