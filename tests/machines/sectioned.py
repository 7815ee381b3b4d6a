"""Blades from sections, one or more of each family, in axial, radial and mixed machines."""

from dataclasses import replace

from bladewright.blade.design.families import (
    CamberAngleBlade,
    CurvatureMeanlineBlade,
    ProfileBlade,
    SegmentedBlade,
    SuctionPressureBlade,
    WedgeDiffuserBlade,
)
from bladewright.blade.design.flow_path import FlowPath
from bladewright.blade.design.meridional_curve import ControlPolygon, ThroughPoints
from bladewright.blade.design.stacking import Stacking
from bladewright.section.camber_angle import CamberAngle
from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.profiles.flat_plate import FlatPlate
from bladewright.section.profiles.naca65 import Naca65
from bladewright.section.segmented.parts import Morph
from bladewright.section.suction_pressure.part import SuctionPressure
from bladewright.section.thickness.modified_naca import ModifiedNaca
from bladewright.section.thickness.wennerstrom import Wennerstrom
from bladewright.section.wedge_diffuser import WedgeDiffuser

from .segmented import REDUCED


def through(*points):
    return ThroughPoints(points=points)


COMPRESSOR = CurvatureMeanlineBlade(
    name="compressor-rotor",
    length_unit="mm",
    blade_count=22,
    flow_path=FlowPath(
        hub=through((-60, 90), (0, 95), (40, 103), (120, 110)),
        shroud=through((-60, 170), (0, 169), (40, 166), (120, 160)),
    ),
    leading_edge=through((0, 80), (2, 130), (6, 180)),
    trailing_edge=through((38, 90), (34, 130), (28, 180)),
    leading_edge_theta=(0.0, 2.0, -1.0),
    section=CurvatureMeanline(
        metal_angle_in=(40.0, 48.0, 58.0),
        metal_angle_out=(5.0, 25.0, 45.0),
        curvature=(0.2, 0.6, 0.5, 0.2, 0.1),
        curvature_places=(0.15, 0.5, 0.8),
        thickness=ModifiedNaca(
            leading_edge_index=5.5,
            maximum_thickness=(0.09, 0.08, 0.07),
            maximum_thickness_at=0.42,
            trailing_edge_thickness=(0.015, 0.013, 0.011),
            trailing_edge_slope=-0.13,
        ),
    ),
)
BLUNT = replace(
    COMPRESSOR,
    name="blunt-rotor",
    section=replace(
        COMPRESSOR.section,
        thickness=Wennerstrom(
            maximum_thickness=(0.08, 0.06),
            maximum_thickness_at=0.45,
            leading_edge_thickness=0.015,
            trailing_edge="blunt",
            trailing_edge_thickness=0.012,
        ),
    ),
)
IMPELLER = CamberAngleBlade(
    name="impeller",
    length_unit="mm",
    blade_count=7,
    flow_path=FlowPath(
        hub=ControlPolygon(control_points=((-30, 20), (0, 20), (35, 22), (48, 40), (50, 70), (50, 110)), degree=4),
        shroud=through((-30, 55), (0, 55), (20, 58), (34, 70), (42, 90), (43, 110)),
        quasi_orthogonals=((0.30, 0.34), (0.62, 0.60)),
    ),
    leading_edge=ControlPolygon(control_points=((2, 19), (0, 40), (4, 56))),
    trailing_edge=through((50.2, 100), (41.5, 101)),
    section=CamberAngle(
        camber_angle=((-20.0, -45.0, -60.0), (-30.0, -40.0, -50.0), (-35.0, -40.0), -30.0),
        half_thickness=((0.012, 0.008), 0.02, 0.02, 0.01),
        trailing_edge="blunt",
    ),
)
DIFFUSER = WedgeDiffuserBlade(
    name="diffuser",
    length_unit="mm",
    blade_count=12,
    flow_path=FlowPath(hub=through((50, 100), (50, 300)), shroud=through((25, 100), (25, 300))),
    leading_edge=through((50, 150), (25, 150)),
    trailing_edge=through((50, 250), (25, 250)),
    section=WedgeDiffuser(
        stagger_angle=(60.0, 62.0), leading_edge_radius=0.008, trailing_edge_radius=0.02, wedge_angle=9.0
    ),
)
STATOR = SuctionPressureBlade(
    name="stator",
    length_unit="mm",
    blade_count=20,
    flow_path=replace(
        COMPRESSOR.flow_path,
        stream_surfaces=(through((-60, 125), (0, 128), (40, 131), (120, 132)),),
        stream_spans=(0.45,),
    ),
    leading_edge=COMPRESSOR.leading_edge,
    trailing_edge=COMPRESSOR.trailing_edge,
    section=SuctionPressure(
        stagger_angle=(20.0, 26.0),
        metal_angle_in=(40.0, 46.0),
        metal_angle_out=(0.0, 6.0),
        leading_edge_radius=0.006,
        leading_edge_stretch=2.0,
        leading_edge_wedge=14.0,
        trailing_edge_radius=0.006,
        trailing_edge_wedge=10.0,
        suction_tangent_in=0.09,
        suction_tangent_out=0.1,
        suction_heights=(0.108, 0.136, 0.104),
        pressure_tangent_in=0.1,
        pressure_tangent_out=0.1,
        pressure_heights=(0.044, 0.054, 0.044),
    ),
)
VANE = ProfileBlade(
    name="inlet-vane",
    length_unit="mm",
    arrangement="linear",
    pitch=40.0,
    plane="x-y",
    flow_path=FlowPath(hub=through((-60, 0), (120, 0)), shroud=through((-60, 50), (120, 60))),
    leading_edge=through((0, 0), (4, 60)),
    trailing_edge=through((40, 0), (36, 60)),
    leading_edge_y=(0.0, 3.0),
    section=Naca65(thickness=(0.1, 0.08), lift_coefficient=(1.2, 0.8), stagger_angle=(30.0, 35.0)),
)
PLATE = ProfileBlade(
    name="plate",
    length_unit="mm",
    arrangement="linear",
    pitch=40.0,
    flow_path=VANE.flow_path,
    leading_edge=VANE.leading_edge,
    trailing_edge=VANE.trailing_edge,
    section=FlatPlate(thickness=0.08, leading_edge="blunt", trailing_edge="blunt", stagger_angle=(20.0, 25.0)),
)
"""with faces at both edges"""
MORPHING = SegmentedBlade(
    name="morphing-vane",
    length_unit="mm",
    blade_count=18,
    flow_path=COMPRESSOR.flow_path,
    stacking=Stacking(chord=(42.0, 40.0), hub_x=18.0),
    section=replace(
        REDUCED,
        stagger_angle=(10.0, 16.0),
        trailing_edge_thickness=0.01,
        morph=Morph(leading_edge=(0.0, 3.0), trailing_edge=(-2.0, -8.0, -4.0)),
    ),
)
"""whose edges bend off the ends of its chord lines, by another angle at every span"""
DESIGNS = {each.name: each for each in (COMPRESSOR, IMPELLER, DIFFUSER, STATOR, VANE, MORPHING)}
