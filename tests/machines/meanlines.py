"""Sections on meanlines: by name the design, and what its section must have."""

from bladewright.section.curvature_meanline import CurvatureMeanline, CurvatureMeanlineSection
from bladewright.section.edge_spline import EdgeSpline
from bladewright.section.thickness.modified_naca import ModifiedNaca
from bladewright.section.thickness.quartic import QuarticSpline
from bladewright.section.thickness.wennerstrom import Wennerstrom

NACA = ModifiedNaca(
    leading_edge_index=5.5,
    maximum_thickness=0.08,
    maximum_thickness_at=0.42,
    trailing_edge_thickness=0.014,
    trailing_edge_slope=-0.13,
)
ELLIPTIC = Wennerstrom(
    maximum_thickness=0.09, maximum_thickness_at=0.4, leading_edge_thickness=0.02, trailing_edge_thickness=0.018
)
BLUNT = Wennerstrom(
    maximum_thickness=0.07,
    maximum_thickness_at=0.45,
    leading_edge_thickness=0.015,
    trailing_edge="blunt",
    trailing_edge_thickness=0.012,
)
SHARP = QuarticSpline(
    maximum_thickness=0.09,
    maximum_thickness_at=0.35,
    leading_edge_thickness=0.03,
    trailing_edge_thickness=0.008,
    trailing_edge="sharp",
)


def on_meanline(**numbers):
    part = CurvatureMeanline(**{"metal_angle_in": 48.0, "metal_angle_out": 12.0, **numbers})
    return CurvatureMeanlineSection(name="blade", length_unit="mm", chord=40.0, pitch=60.0, section=part)


MEANLINES = {
    "curvature meanline of a compressor": (
        on_meanline(curvature=(0.2, 0.6, 0.5, 0.2, 0.1), curvature_places=(0.15, 0.5, 0.8), thickness=NACA),
        {"metal_angles": (48.0, 12.0), "maximum_thickness": 0.08},
    ),
    "curvature meanline of a turbine with a thickness multiplier": (
        on_meanline(
            metal_angle_in=40.0,
            metal_angle_out=-62.0,
            curvature=(1.0, 1.6, 1.2, 0.9),
            thickness=ELLIPTIC,
            thickness_multiplier=(0.0, 0.4, 0.5, 0.1, 0.0),
            thickness_multiplier_places=(0.1, 0.35, 0.6),
        ),
        {"metal_angles": (40.0, -62.0)},
    ),
    "curvature meanline that bends back, blunt behind": (
        on_meanline(
            metal_angle_in=60.0,
            metal_angle_out=57.0,
            curvature=(-0.2, -0.1, 0.3, 0.5),
            curvature_places=(0.3, 0.7),
            thickness=BLUNT,
        ),
        {"metal_angles": (60.0, 57.0), "maximum_thickness": 0.07},
    ),
    "curvature meanline without camber, sharp behind": (
        on_meanline(metal_angle_in=-30.0, metal_angle_out=-30.0, curvature=(1.0, 0.5), thickness=SHARP),
        {
            "metal_angles": (-30.0, -30.0),
            "maximum_thickness": 0.09,
            # where nothing is turned, how the turning is spread has no effect
            "dead": ("curvature[0]", "curvature[1]"),
        },
    ),
    "curvature meanline with a leading edge that is a spline": (
        on_meanline(
            curvature=(0.2, 0.6, 0.5, 0.2),
            thickness=ELLIPTIC,
            leading_edge_spline=EdgeSpline(contact=0.17, elongation=0.2, droop=0.15),
        ),
        {},
    ),
    "mixed camber line": (
        on_meanline(metal_angle_in=-60.0, metal_angle_out=-40.0, camber="mixed", thickness=ELLIPTIC),
        {"metal_angles": (-60.0, -40.0), "maximum_thickness": 0.09},
    ),
    "mixed camber line with a sharp leading edge": (
        on_meanline(
            camber="mixed",
            thickness=Wennerstrom(
                maximum_thickness=0.05,
                maximum_thickness_at=0.55,
                leading_edge="sharp",
                trailing_edge_thickness=0.01,
                trailing_edge_ratio=2.0,
            ),
        ),
        {"metal_angles": (48.0, 12.0), "maximum_thickness": 0.05},
    ),
}
