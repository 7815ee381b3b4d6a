"""Segmented airfoils: the reduced and the full form, each kind of joint, open and closed, and a morph."""

from dataclasses import replace

from bladewright.section.segmented.part import Segmented, SegmentedSection
from bladewright.section.segmented.parts import AirfoilSide, Morph, Nose, Segment, SegmentJoint, Skin


def side(sign, camber=0.0):
    """About that of NACA 0012, raised by a camber."""

    def raised(y, x):
        return sign * y + 4.0 * camber * x * (1.0 - x)

    return AirfoilSide(
        front_joint=SegmentJoint(height=raised(0.06, 0.3), angle=sign * 0.1 + 92.0 * camber, curvature=-sign * 0.7),
        rear_joint=SegmentJoint(height=raised(0.0366, 0.7), angle=-sign * 6.8 - 92.0 * camber, curvature=-sign * 0.4),
        leading_edge=Segment(abscissas=(0.094,), ordinates=(raised(0.05, 0.094),), front_scale=0.55, rear_scale=1.1),
        central_box=Segment(abscissas=(0.5,), ordinates=(raised(0.0545, 0.5),), front_scale=0.9, rear_scale=1.2),
        trailing_edge=Segment(abscissas=(0.87,), ordinates=(raised(0.0175, 0.87),), front_scale=0.9),
    )


REDUCED = Segmented(
    stagger_angle=5.0,
    nose=Nose(angle=5.0, radius=0.0158),
    trailing_edge_thickness=0.0025,
    upper=side(1.0, 0.02),
    lower=side(-1.0, 0.02),
)
FULL = Segmented(
    partition=(0.25, 0.75),
    upper=AirfoilSide(
        front_joint=SegmentJoint(height=0.06),
        rear_joint=SegmentJoint(height=0.03),
        leading_edge=Segment(abscissas=(0.0, 0.03, 0.09, 0.15, 0.2), ordinates=(0.015, 0.035, 0.048, 0.055, 0.058)),
        central_box=Segment(abscissas=(0.3, 0.4, 0.5, 0.6, 0.7), ordinates=(0.061, 0.061, 0.056, 0.047, 0.036)),
        trailing_edge=Segment(abscissas=(0.8, 0.87, 0.95), ordinates=(0.025, 0.016, 0.006)),
    ),
    lower=AirfoilSide(
        front_joint=SegmentJoint(height=-0.04),
        rear_joint=SegmentJoint(height=-0.02),
        leading_edge=Segment(abscissas=(0.0, 0.03, 0.09, 0.15, 0.2), ordinates=(-0.015, -0.028, -0.036, -0.039, -0.04)),
        central_box=Segment(abscissas=(0.3, 0.4, 0.5, 0.6, 0.7), ordinates=(-0.04, -0.038, -0.035, -0.03, -0.023)),
        trailing_edge=Segment(abscissas=(0.8, 0.87, 0.95), ordinates=(-0.015, -0.01, -0.004)),
    ),
)
MIXED = replace(
    REDUCED,
    partition=(0.28, 0.72),
    trailing_edge_thickness=None,
    nose=Nose(angle=0.0),
    upper=replace(
        REDUCED.upper,
        front_joint=SegmentJoint(height=0.077, angle=2.0),
        leading_edge=Segment(abscissas=(0.05, 0.15), ordinates=(0.055, 0.075), front_scale=0.6, rear_scale=1.2),
    ),
    lower=replace(
        REDUCED.lower,
        rear_joint=SegmentJoint(height=-0.02),
        trailing_edge=Segment(abscissas=(0.8, 0.9), ordinates=(-0.014, -0.006)),
        central_box=replace(REDUCED.lower.central_box, rear_scale=None),
    ),
)
SKIN = {"abscissas": (0.004,), "ordinates": (0.003,), "front_scale": 0.05, "rear_scale": -0.1}
SKINNED = replace(
    REDUCED,
    upper=replace(
        REDUCED.upper, central_box=replace(REDUCED.upper.central_box, skin=Skin(inner=0.001, outer=0.004, **SKIN))
    ),
    morph=Morph(leading_edge=4.0, trailing_edge=-15.0),
)
AIRFOILS = {
    "segmented": REDUCED,
    "segmented-full": FULL,
    "segmented-mixed": MIXED,
    "segmented-morphed": replace(REDUCED, morph=Morph(leading_edge=4.0, trailing_edge=-15.0)),
    "segmented-skinned": SKINNED,
}
"""By a name that says what is particular."""


BANDS = {"segmented-skinned": ("upper.central_box.skin.inner", "upper.central_box.skin.outer")}
"""parameters that limit an airfoil and move nothing"""


def airfoil_of(part):
    """The airfoil as a 2D design."""
    return SegmentedSection(name="airfoil", length_unit="mm", chord=245.0, section=part)
