"""Blades to test on: axial, radial in both directions, mixed, and a cascade."""

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.section.unified import UnifiedSection

COMMON = {
    "length_unit": "mm",
    "tangent_in": 0.35,
    "tangent_out": 0.4,
    "thickness_upper": (0.02, 0.035, 0.03, 0.015),
    "thickness_lower": (0.02, 0.03, 0.025, 0.015),
}
FAN = UnifiedBlade(
    **COMMON,
    name="fan",
    blade_count=17,
    leading_edge_theta=(0.0, 1.0, -0.5),
    stagger=(15.0, 25.0, 45.0, 55.0, 61.0),
    metal_angle_in=(38.0, 45.0, 58.0, 63.0),
    metal_angle_out=(-10.0, 15.0, 45.0, 56.0),
    leading_edge_radius=(0.003, 0.002, 0.0015),
    trailing_edge_radius=0.0015,
    channel=Channel(
        leading_edge=((-1.0, 95.0), (6.0, 152.0), (17.0, 204.0), (23.0, 255.0)),
        trailing_edge=((89.0, 118.0), (78.0, 201.0), (65.0, 248.0)),
        hub=((23.0, 100.0), (65.0, 116.0)),
        shroud=((30.0, 255.5), (51.0, 250.0)),
    ),
)
IMPELLER = UnifiedBlade(
    **COMMON,
    name="impeller",
    blade_count=9,
    stagger=(-38.0, -46.0),
    metal_angle_in=(-42.0, -57.0),
    metal_angle_out=(-35.0, -35.0),
    leading_edge_radius=0.004,
    trailing_edge_radius=0.005,
    channel=Channel(
        leading_edge=((0.0, 16.0), (0.0, 42.0)),
        trailing_edge=((38.0, 70.0), (32.0, 70.0)),
        hub=((18.0, 17.0), (36.0, 30.0), (38.0, 50.0)),
        shroud=((14.0, 43.0), (28.0, 47.0), (32.0, 58.0)),
    ),
)
INFLOW = UnifiedBlade(
    **COMMON,
    name="inflow",
    blade_count=10,
    stagger=(-14.0, -30.0),
    metal_angle_in=0.0,
    metal_angle_out=(-40.0, -60.0),
    leading_edge_radius=0.006,
    trailing_edge_radius=0.004,
    channel=Channel(
        leading_edge=((0.0, 59.0), (6.5, 59.0)),
        trailing_edge=((39.0, 14.5), (35.0, 36.8)),
        hub=((-0.5, 38.0), (9.0, 20.0), (24.0, 15.0)),
        shroud=((7.0, 48.0), (12.0, 40.0), (24.0, 37.0)),
    ),
)
CASCADE = UnifiedBlade(
    **COMMON,
    name="cascade",
    arrangement="linear",
    pitch=60.0,
    leading_edge_y=(0.0, 2.0),
    stagger=(-35.0, -30.0),
    metal_angle_in=(20.0, 10.0),
    metal_angle_out=-58.0,
    leading_edge_radius=0.01,
    trailing_edge_radius=0.006,
    channel=Channel(
        leading_edge=((0.0, 0.0), (1.0, 100.0)),
        trailing_edge=((60.0, 3.0), (58.0, 96.0)),
        hub=((20.0, 0.0), (40.0, 2.0)),
        shroud=((20.0, 100.0), (40.0, 97.0)),
    ),
)
VANE = UnifiedSection(
    name="vane",
    length_unit="cm",
    description="A prismatic turbine vane",
    pitch=5.75,
    axial_chord=3.6,
    stagger=-52.0,
    metal_angle_in=0.0,
    metal_angle_out=-74.0,
    tangent_in=0.6,
    tangent_out=0.9,
    leading_edge_radius=0.11,
    trailing_edge_radius=0.02,
    thickness_upper=(0.16, 0.26, 0.16, 0.05),
    thickness_lower=(0.1, 0.12, 0.08, 0.03),
    span=6.0,
)
DRAWN_IMPELLER = UnifiedBlade(
    name="drawn-impeller",
    length_unit="mm",
    blade_count=14,
    stagger=(35.0, 45.0),
    metal_angle_in=(32.0, 58.0),
    metal_angle_out=40.0,
    tangent_in=0.3,
    tangent_out=0.3,
    leading_edge_radius=0.005,
    trailing_edge_radius=0.005,
    thickness_upper=(0.015, (0.02, 0.012), 0.012),
    thickness_lower=(0.015, (0.02, 0.012), 0.012),
    channel=Channel(
        leading_edge=((0, 20), (0, 50)),
        trailing_edge=((45, 100), (37, 100)),
        hub=((25, 20), (44, 45)),
        shroud=((22, 52), (36, 66)),
    ),
)
DESIGNS = {design.name: design for design in (FAN, IMPELLER, INFLOW, CASCADE)}
