"""Examples of the camber-angle family."""

from bladewright.section.camber_angle import CamberAngle, CamberAngleSection

CAMBER_ANGLES = {
    "camber-angle": CamberAngle(
        camber_angle=(50.0, 45.0, 30.0, 10.0, -5.0, 0.0), half_thickness=(0.012, 0.02, 0.04, 0.03, 0.008)
    ),
    "camber-angle-blunt": CamberAngle(
        camber_angle=(-60.0, -50.0, -20.0), half_thickness=(0.01, 0.03, 0.035, 0.01), trailing_edge="blunt"
    ),
    "camber-angle-weights": CamberAngle(
        camber_angle=(60.0, 20.0),
        half_thickness=(0.012, 0.03, 0.05, 0.03),
        thickness_places=(0.05, 0.3, 0.7),
        thickness_weights=(1.0, 2.0, 1.5, 0.5),
        trailing_edge="sharp",
    ),
}
"""By a name that says what is particular."""
ANGLES = {
    "camber-angle": (50.0, 0.0),
    "camber-angle-blunt": (-60.0, -20.0),
    "camber-angle-weights": (60.0, 20.0),
}
"""Metal angles at both edges [deg]: the first and the last control point."""


def angle_section_of(part):
    """The part as a 2D design."""
    return CamberAngleSection(name="vane", length_unit="mm", chord=50.0, pitch=60.0, section=part)
