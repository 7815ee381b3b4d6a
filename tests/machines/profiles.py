"""Examples of every kind of profile, for the shared contract tests and for those of the kinds."""

from bladewright.section.profiles.c4 import C4
from bladewright.section.profiles.circular_arc import DoubleCircularArc, MultipleCircularArc
from bladewright.section.profiles.flat_plate import FlatPlate
from bladewright.section.profiles.kinds import ProfileSection
from bladewright.section.profiles.naca4 import Naca4
from bladewright.section.profiles.naca5 import Naca5
from bladewright.section.profiles.naca6 import Naca6
from bladewright.section.profiles.naca65 import Naca65
from bladewright.section.profiles.points import PointsProfile

from .segmented import AIRFOILS

OVAL = [(1.0, 0.0), (0.97, 0.025), (0.8, 0.07), (0.5, 0.11), (0.1, 0.065), (0.0, 0.0), (0.1, -0.035), (0.5, -0.01)]
OVAL += [(0.8, 0.0), (0.97, -0.01)]
CUT = [(0.0, 0.0), (-0.02, 0.04), (0.05, 0.1), (0.3, 0.14), (0.6, 0.12), (1.0, 0.03), (1.01, -0.01), (0.8, 0.01)]
CUT += [(0.5, 0.015), (0.1, -0.02)]
LENS = [(0.0, 0.0), (0.2, 0.04), (0.4, 0.06), (0.6, 0.06), (0.8, 0.04), (1.0, 0.0), (0.8, -0.02), (0.6, -0.03)]
LENS += [(0.4, -0.03), (0.2, -0.02)]


def through(points, **fields):
    """A profile through points (n, 2)."""
    return PointsProfile(abscissas=tuple(x for x, _ in points), ordinates=tuple(y for _, y in points), **fields)


PROFILES = {
    "naca-2412": Naca4(thickness=0.12, camber=0.02, camber_position=0.4, stagger_angle=10.0),
    "naca-0012-round": Naca4(thickness=0.12, trailing_edge="round"),
    "naca-6409-blunt": Naca4(
        thickness=0.09, camber=0.06, camber_position=0.4, trailing_edge="blunt", trailing_edge_thickness=0.03
    ),
    "naca-2410-linear": Naca4(
        thickness=0.1,
        camber=0.02,
        camber_position=0.4,
        trailing_edge="round",
        trailing_edge_thickness=0.06,
        trailing_edge_opening="linear",
    ),
    "naca-65-(8)08-linear": Naca65(
        thickness=0.08,
        lift_coefficient=0.8,
        trailing_edge="blunt",
        trailing_edge_thickness=0.2,
        trailing_edge_opening="linear",
    ),
    "naca-23012": Naca5(thickness=0.12, design_lift=0.3, camber_position=0.15, trailing_edge="blunt"),
    "naca-23112": Naca5(thickness=0.12, design_lift=0.3, camber_position=0.15, reflexed=True),
    "naca-64-212": Naca6(series="64", thickness=0.12, design_lift=0.2, uniform_load=0.8),
    "naca-66-415-round": Naca6(series="66", thickness=0.15, design_lift=0.4, uniform_load=0.5, trailing_edge="round"),
    "naca-65-(12)10": Naca65(thickness=0.1, lift_coefficient=1.2, stagger_angle=30.0, trailing_edge="round"),
    "naca-65-(-4)06": Naca65(thickness=0.06, lift_coefficient=-0.4),
    "c4": C4(thickness=0.1, camber_angle=30.0, stagger_angle=-36.0, trailing_edge="round"),
    "double-circular-arc": DoubleCircularArc(
        thickness=0.08, camber_angle=30.0, leading_edge_radius=0.004, trailing_edge_radius=0.004, stagger_angle=40.0
    ),
    "double-circular-arc-sharp": DoubleCircularArc(thickness=0.05, camber_angle=20.0),
    "multiple-circular-arc": MultipleCircularArc(
        thickness=0.06, camber_angle=40.0, transition=0.6, front_camber=0.2, leading_edge_radius=0.004
    ),
    "points-round": through(OVAL),
    "points-blunt": through(CUT[::-1], stagger_angle=20.0),
    "points-lens": through(LENS),
    "flat-plate": FlatPlate(thickness=0.06),
    "flat-plate-elliptic": FlatPlate(
        thickness=0.05, leading_edge="elliptic", leading_edge_ratio=4.0, trailing_edge="blunt"
    ),
    "segmented-profile": AIRFOILS["segmented-morphed"],
}
"""By a name that says what is particular."""


def section_of(profile):
    """The profile as a 2D design."""
    return ProfileSection(name="profile", length_unit="mm", chord=50.0, pitch=60.0, section=profile)


PROPERTIES = {
    # the form with a closed edge is a little thicker than its name says
    "naca-2412": {"maximum_thickness": 0.12 * 1.000118},
    "double-circular-arc": {"maximum_thickness": 0.08, "metal_angles": (55.0, 25.0)},
    "double-circular-arc-sharp": {"maximum_thickness": 0.05, "metal_angles": (10.0, -10.0)},
    "multiple-circular-arc": {"maximum_thickness": 0.06},
    "flat-plate": {"maximum_thickness": 0.06, "metal_angles": (0.0, 0.0)},
    "flat-plate-elliptic": {"maximum_thickness": 0.05, "metal_angles": (0.0, 0.0)},
    "c4": {"maximum_thickness": 0.1, "metal_angles": (-36.0 + 15.0, -36.0 - 15.0)},
}
"""What their sections must have."""
